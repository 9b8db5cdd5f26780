# SPDX-License-Identifier: Apache-2.0
"""release.py ROOT: checks what a release says twice: the version of CMakeLists.txt is the latest one of debian/changelog and of
CHANGELOG.md (beside what is unreleased), with one date, and that of the package of ROS 2; debian/control needs the packages of tools/setup/packages.sh for a build."""
import email.utils
import pathlib
import re
import sys

import sources

LISTS = ("BUILD", "PYTHON", "ROS")
OF_EVERY_PACKAGE = {"debhelper-compat", "dh-sequence-python3"}
BUILD_ESSENTIAL = {"g++"}


def check_versions(root):
    version = re.search(r"^project\(plvo VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.M).group(1)
    debian = (root / "debian/changelog").read_text(encoding="utf-8")
    packaged = re.match(r"plvo \((\S+)\)", debian).group(1)
    date = email.utils.parsedate_to_datetime(re.search(r"^ -- .*>  (.*)$", debian, re.M).group(1)).date().isoformat()
    released = re.search(r"^## (?!Unreleased)(.*)$", (root / "CHANGELOG.md").read_text(encoding="utf-8"), re.M).group(1)
    if packaged != version:
        yield f"debian/changelog: the latest version is {packaged}, that of CMakeLists.txt is {version}"
    if released != f"{version} ({date})":
        yield f"CHANGELOG.md: the latest version is {released}, that of debian/changelog is {version} ({date})"


def check_ros_2(root):
    version = re.search(r"^project\(plvo VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.M).group(1)
    package = re.search(r"<version>(.*)</version>", (root / "platform/plvo/ros2/package.xml").read_text(encoding="utf-8")).group(1)
    wanted = re.search(r"^find_package\(plvo ([\d.]+)", (root / "platform/plvo/ros2/CMakeLists.txt").read_text(encoding="utf-8"), re.M).group(1)
    if package != version:
        yield f"platform/plvo/ros2/package.xml: the version is {package}, that of CMakeLists.txt is {version}"
    if wanted != version.rpartition(".")[0]:
        yield f"platform/plvo/ros2/CMakeLists.txt: it takes plvo {wanted}, and this is {version}"


def check_packages(root):
    lists = dict(re.findall(r'^PLVO_PACKAGES_(\w+)="([^"]*)"', (root / "tools/setup/packages.sh").read_text(encoding="utf-8"), re.M))
    wanted = {name for which in LISTS for name in lists[which].split()} - BUILD_ESSENTIAL
    field = re.search(r"^Build-Depends:((?:.*\n)(?:[ \t].*\n)*)", (root / "debian/control").read_text(encoding="utf-8"), re.M).group(1)
    named = {word.split()[0] for word in field.replace("\n", " ").split(",")} - OF_EVERY_PACKAGE
    for name in sorted(wanted - named):
        yield f"debian/control: Build-Depends lacks {name}, which tools/setup/packages.sh names"
    for name in sorted(named - wanted):
        yield f"tools/setup/packages.sh: the lists of a build lack {name}, which debian/control names"


def check(root):
    root = pathlib.Path(root)
    return [*check_versions(root), *check_ros_2(root), *check_packages(root)]


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "the version and the packages that a build needs are the same wherever they stand"))
