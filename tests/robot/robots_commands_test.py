# SPDX-License-Identifier: Apache-2.0
"""Every command of docs/user/robots.md: the blocks of plvo run here as they stand, with the simulated camera and a program in the place of
the robot; the others are in a test that this file names, or have a reason why they are in none."""
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from free_port import free_port
from user_pages import ROOT, blocks, missing_options, text_of_test

PAGE = (ROOT / "docs/user/robots.md").read_text(encoding="utf-8")
BLOCKS = blocks(PAGE)
PLVO = os.environ["PLVO_BINARY"]

# The blocks, by their first words.
HERE = ("plvo live --base-camera", "plvo run sequence --wheels", "mkfifo wheels")
PACKAGES = "sudo apt install libroscpp-dev"  # those of tools/setup/packages.sh
BLOCKS_OF_TESTS = {  # the test, and the programs that both have
    "roscore &": ("ros1_node_test", ("roscore", "roslaunch", "rosbag")),
    "mkdir -p ws/src": ("ros2_workspace_test", ("colcon build", "cp -r /usr/src/plvo_ros")),
    "ros2 launch": ("ros2_workspace_test", ("ros2 launch plvo_ros plvo.launch.py",)),
}

# Commands within the text: the test that has their options, or why there is none.
IN_THE_TEXT = {
    "plvo run --imu --level": "cli_outputs_test",
    "plvo live --imu --level": "simulated_kinect_imu_test",
    "plvo run DIR --mask bumper.png": "cli_run_test",
    "plvo live --mask bumper.png": "cli_run_test",
    "rosbag play": "ros1_node_test",
    "plvo run --out": "cli_run_test",
    "plvo run --imu": "cli_wheels_test",
    "plvo live --imu": "simulated_kinect_imu_test",
    "plvo run --wheels": "cli_wheels_test",
    "your_robot | plvo live --wheels - …": "cli_live_wheels_test",
    "plvo convert FILE --out sequence --wheels-topic /odom": "ros_recordings_test",
    "plvo simulate --robot": "cli_wheels_test",
}
IN_NO_TEST = {
    "tools/setup/package.sh": "by hand: it makes packages and installs them in a clean root",
    "evo_ape tum groundtruth.txt t.txt -a": "evo is not part of Debian; the page says so",
    "stty -F /dev/ttyUSB0 115200 raw": "it needs a serial port",
    "rosdep install --from-paths src --skip-keys plvo": "rosdep is no part of Debian 12's ROS 2, and reads its list from a server",
    "date +%s.%N": "a form of stamps, which live_wheels_test writes",
}


def commands_in_the_text():
    text = re.sub(r"^```.*?^```$", "", PAGE, flags=re.S | re.M)
    for span in re.findall(r"`([^`]+)`", text):
        command = " ".join(span.split())
        if re.match(r"(?:your_robot \| )?plvo \w+ \S|tools/setup/|(?:rosbag|roslaunch|rosdep|ros2|colcon|evo_\w+|stty|date|sudo|mkfifo) \S", command):
            yield command


def test_every_block_is_known():
    for block in BLOCKS:
        assert block.startswith((*HERE, PACKAGES, *BLOCKS_OF_TESTS)), block
    for first, (name, programs) in BLOCKS_OF_TESTS.items():
        words = " ".join(block for block in BLOCKS if block.startswith(first))
        text = text_of_test(name)
        for program in programs:
            assert program in words and program in text


def test_every_command_in_the_text_is_in_a_test_or_has_a_reason():
    assert set(commands_in_the_text()) == {*IN_THE_TEXT, *IN_NO_TEST}
    for command, name in IN_THE_TEXT.items():
        text = text_of_test(name)
        assert not missing_options(command, text), f"{command}: not in {name}"


def test_the_packages_are_those_of_the_build():
    (block,) = (block for block in BLOCKS if block.startswith(PACKAGES))
    known = (ROOT / "tools/setup/packages.sh").read_text(encoding="utf-8")
    for package in block.split()[3:]:
        assert re.search(rf"\b{re.escape(package)}\b", known), package


@pytest.fixture
def folder(tmp_path):
    """Programs of the names that the page uses: plvo live with the simulated camera, and a robot."""
    programs = tmp_path / "bin"
    programs.mkdir()
    sim = "--camera sim --robot --scene hall --size 320x240 --frames 12 --quiet --json live.json"
    (programs / "plvo").write_text(f'#!/bin/sh\n[ "$1" = live ] || exec {PLVO} "$@" --quiet\nexec {PLVO} "$@" {sim}\n')
    (programs / "your_robot").write_text("#!/bin/sh\nexec cat sequence/wheel_odometry.txt\n")
    for program in programs.iterdir():
        program.chmod(0o755)
    subprocess.run([PLVO, "simulate", *sim.split()[2:-3], "--quiet", "--out", "sequence"], cwd=tmp_path, check=True)
    return tmp_path


@pytest.mark.parametrize("first", HERE)
def test_a_block_of_plvo_runs(folder, first):
    (block,) = (block for block in BLOCKS if block.startswith(first))
    done = subprocess.run(["bash", "-e", "-c", block.replace("--stream 7000", f"--stream {free_port()}")], cwd=folder, text=True,
                          env={**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}"}, capture_output=True, timeout=300, check=False)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    if "--out poses.txt" in block:
        rows = [line for line in (folder / "poses.txt").read_text().splitlines() if not line.startswith("#")]
        assert len(rows) >= 10  # of 12
    if "live" in block and "--wheels" in block:
        assert json.loads((folder / "live.json").read_text())["wheels"]["frames_with"] >= 8
