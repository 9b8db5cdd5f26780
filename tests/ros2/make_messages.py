# SPDX-License-Identifier: Apache-2.0
"""Makes the C++ headers of the messages of ROS 2 that the node uses, with the generators of ROS 2 that Debian has (rosidl).
usage: make_messages.py FOLDER — the headers are then FOLDER/include/PACKAGE/msg/NAME.hpp.

Debian has no definitions of ROS 2's messages, but those of ROS 1. They become ROS 2's by what ROS 2 changed in these messages: Header
is std_msgs/Header and has no counter, a time is builtin_interfaces/Time, and the names of fields are in small letters."""
import json
import pathlib
import re
import subprocess
import sys

SHARE = pathlib.Path("/usr/share")
MESSAGES = {
    "builtin_interfaces": ["msg/Time"],
    "std_msgs": ["msg/Header"],
    "geometry_msgs": ["msg/Point", "msg/Quaternion", "msg/Pose", "msg/PoseWithCovariance", "msg/PoseWithCovarianceStamped", "msg/Vector3",
                      "msg/Twist", "msg/TwistWithCovariance", "msg/Transform", "msg/TransformStamped"],
    "sensor_msgs": ["msg/Image", "msg/RegionOfInterest", "msg/CameraInfo", "msg/Imu"],
    "nav_msgs": ["msg/Odometry"],
    "diagnostic_msgs": ["msg/KeyValue", "msg/DiagnosticStatus", "msg/DiagnosticArray"],
    "std_srvs": ["srv/Trigger"],
}
OF_ROS_2 = {"builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n"}


def definition(package, name):
    """The text of a message of ROS 2."""
    if f"{package}/{name}" in OF_ROS_2:
        return OF_ROS_2[f"{package}/{name}"]
    lines = []
    for line in (SHARE / package / name).with_suffix(f".{name[:3]}").read_text(encoding="utf-8").splitlines():
        line = line.partition("#")[0].strip()
        if re.fullmatch(r"uint32\s+seq", line):
            continue
        line = re.sub(r"^Header\b", "std_msgs/Header", line)
        line = re.sub(r"^time\b", "builtin_interfaces/Time", line)
        if "=" not in line:
            line = re.sub(r"\w+$", lambda word: word[0].lower(), line)
        lines.append(line)
    return "\n".join(lines) + "\n"


def make(folder, package, names):
    sources, idl = folder / "definitions" / package, folder / "idl" / package
    for name in names:
        file = (sources / name).with_suffix(f".{name[:3]}")
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(definition(package, name), encoding="utf-8")
    arguments = folder / "idl" / f"{package}.json"
    arguments.parent.mkdir(exist_ok=True)
    arguments.write_text(json.dumps({"non_idl_tuples": [f"{sources}:{name}.{name[:3]}" for name in names]}))
    subprocess.run([sys.executable, "-m", "rosidl_adapter", "--package-name", package, "--arguments-file", arguments, "--output-dir", idl,
                    "--output-file", idl.with_suffix(".idls")], stdout=subprocess.DEVNULL, check=True)
    arguments.write_text(json.dumps({
        "package_name": package, "output_dir": str(folder / "include" / package), "template_dir": str(SHARE / "rosidl_generator_cpp/resource"),
        "idl_tuples": [f"{idl}:{name}.idl" for name in names], "ros_interface_dependencies": [], "target_dependencies": [__file__]}))
    subprocess.run([sys.executable, "/usr/libexec/rosidl/rosidl_generator_cpp", "--generator-arguments-file", arguments], check=True)


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    for package, names in MESSAGES.items():
        make(folder, package, names)


if __name__ == "__main__":
    main()
