#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Run by tools/setup/package.sh in a clean root, in /try: installs the packages, uses them as docs/user/c.md, docs/user/python.md and a
# stranger's CMake project do, purges them, and compares the files with those before.
set -euo pipefail
cd /try
export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
packages="libplvo0 libplvo-dev plvo-tools python3-plvo ros-plvo"
files() {
  find / -xdev \( -path /try -o -path /proc -o -path /sys -o -path /tmp -o -path /var/lib/dpkg -o -path /var/log \
    -o -path /var/cache \) -prune -o -print | sort
}
step() { printf '== %s\n' "$*" >&2; }

step "install, with what a program in C and C++ is made with"
apt-get update -qq >&2
apt-get install -y -qq --no-install-recommends gcc g++ cmake make pkg-config >/dev/null 2>&1
apt-get install -y -qq --no-install-recommends ./*.deb >/dev/null
dpkg-query -W $packages >&2
ldconfig -p | grep -q libplvo.so.0
test -s /usr/lib/*/OpenNI2/Drivers/libPlvoFreenectDriver.so.0
test -s /usr/lib/udev/rules.d/60-plvo-rgbd.rules
test -s /usr/lib/systemd/system/plvo-live.service
# The service starts what its file of options says, by words that plvo live takes.
# shellcheck disable=SC1091  # installed just now
. /etc/default/plvo-live
grep -q "EnvironmentFile=-/etc/default/plvo-live" /usr/lib/systemd/system/plvo-live.service
# shellcheck disable=SC2086  # a list of words
if plvo live $PLVO_LIVE_OPTIONS --quiet --seconds 1 2>live.words; then exit 1; else test $? -eq 4; fi  # no sensor, but no wrong usage
# The manual names files that are there.
apt-get install -y -qq --no-install-recommends man-db >/dev/null 2>&1
MANWIDTH=200 man plvo plvo-live | grep -o '^ *\(/usr\|/etc\)/[^ ,]*' | while read -r file; do test -e "$file" || exit 1; done

step "command line"
plvo --version >&2
plvo simulate --out sequence --frames 20 --size 320x240 --quiet
plvo run sequence --quiet --out run.txt
grep -v '^#' run.txt | cut -d' ' -f2- >run.poses
echo "no bag" >no.bag
if plvo run no.bag 2>no.bag.words; then exit 1; fi
grep -q "is not a ROS 1 bag" no.bag.words  # bags were not left out when the packages were built
echo "no recording" >no.mcap
if plvo run no.mcap 2>no.mcap.words; then exit 1; fi
test -s "/usr/$(grep -o 'share/doc/plvo/[a-z_/]*\.md' no.mcap.words)"  # the page that the message names

step "C, by pkg-config: the same poses"
# shellcheck disable=SC2046  # a list of words
gcc -std=c11 -Wall track_folder.c $(pkg-config --cflags --libs plvo) -o track_folder
./track_folder sequence | cut -d' ' -f2- | cmp - run.poses
if ./track_folder no.bag 2>no.bag.words; then exit 1; fi
grep -q "is not a ROS 1 bag" no.bag.words

step "C, with the gyro and the accelerometer of the recording: the poses of plvo run --imu"
plvo run sequence --imu --quiet --out imu.txt
# shellcheck disable=SC2046
gcc -std=c11 -Wall track_with_imu.c $(pkg-config --cflags --libs plvo) -o track_with_imu
grep -v '^#' imu.txt | cut -d' ' -f2- >imu.poses
./track_with_imu sequence | cut -d' ' -f2- | cmp - imu.poses

step "C++, by find_package and by pkg-config"
cmake -S consumer -B consumer-build >/dev/null
cmake --build consumer-build >/dev/null
./consumer-build/consumer
# shellcheck disable=SC2046
g++ -std=c++20 consumer/main.cpp $(pkg-config --cflags --libs plvo-core) -o consumer-by-pkg-config
./consumer-by-pkg-config

step "Python: the page's programs that draw nothing, and the same poses"
python3 - <<'PROGRAM'
import pathlib, re
programs = re.findall(r"^```python\n(.*?)^```$", pathlib.Path("python.md").read_text(), re.M | re.S)
programs = [program for program in programs if "matplotlib" not in program]
assert len(programs) >= 3
for program in programs:
    exec(compile(program, "docs/user/python.md", "exec"), {})
import plvo
poses = [" ".join(f"{x:.9f}" for x in (*r.position, *r.quaternion)) for r in plvo.run("sequence") if r.has_pose]
assert poses == pathlib.Path("run.poses").read_text().splitlines()
PROGRAM

step "ROS 1: roslaunch finds the node and its launch file"
ROS_HOME=/tmp/ros roslaunch --args /plvo plvo plvo.launch | grep -q "/usr/lib/plvo/odometry colour:="
if ldd /usr/lib/plvo/odometry | grep "not found" >&2; then exit 1; fi

step "ROS 2: the sources of the package, and the shared library's part of a node, in C++17"
test -s /usr/src/plvo_ros/package.xml
cat >node.cpp <<'PROGRAM'
#include <plvo/ros/ros_node.hpp>
int main() {
  plvo::RosNodeSettings settings;
  settings.base_camera = "0 0 0";
  return plvo::RosNode(settings, {}).start().find("base_camera must be seven numbers") == 0 ? 0 : 1;
}
PROGRAM
# shellcheck disable=SC2046
g++ -std=c++17 -Wall -Wextra -Werror node.cpp $(pkg-config --cflags --libs plvo) -o node
./node

step "purge, install and use once more, purge: the same files before and after, and none of plvo's"
apt-get purge -y -qq $packages >/dev/null
files >before
apt-get install -y -qq --no-install-recommends ./*.deb >/dev/null
plvo --version >/dev/null
python3 -c "import plvo"
apt-get purge -y -qq $packages >/dev/null
files >after
diff before after >&2
if grep -i plvo after >&2; then exit 1; fi
if dpkg-query -W $packages 2>/dev/null | grep -q '[0-9]'; then exit 1; fi
step "nothing is left"
