# SPDX-License-Identifier: Apache-2.0
"""Every command in the blocks of README.md and docs/user/ runs here, with the simulated camera in the place of a sensor and simulated
recordings; or a test that this file names has it; or a reason stands here why it is in none. docs/user/robots.md has a test of its own
(robots_commands_test)."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from free_port import free_port
from user_pages import ROOT, blocks, missing_options, text_of_test

PLVO = os.environ["PLVO_BINARY"]
PAGES = [ROOT / "README.md", *(page for page in sorted((ROOT / "docs/user").glob("*.md")) if page.name != "robots.md")]

# Commands of plvo that another test runs: those that need a sensor, which that test simulates, or a recording of another kind.
IN_A_TEST = {
    "plvo record DIR": "cli_record_test",
    "plvo record sequence": "cli_record_test",
    "plvo record turns --seconds 30": "cli_record_test",
    "plvo calibrate turns --out camera.yaml --report curves.html": "cli_calibrate_test",
    "plvo run sequence --calibration camera.yaml": "cli_calibrate_test",
    "plvo live --imu": "simulated_kinect_imu_test",
    "plvo tilt -10 --led green": "cli_tilt_test",
    "plvo live --device freenect://1-1.3": "cli_live_test",
    "plvo info recording.mcap": "ros_recordings_test",
    "plvo info recording.mcap --json -": "ros_recordings_test",
    "plvo convert recording.mcap --out sequence": "ros_recordings_test",
    "plvo convert recording.mcap --out sequence --imu": "ros_recordings_test",
}
# What begins with these words is in no test of the suite.
REASONS = {
    "./tools/setup/demo.sh": "it installs packages",
    "./tools/setup/test.sh": "it is the suite",
    "sudo ": "it changes the machine; tools/setup/package.sh tries the packages in a clean root",
    "dpkg-buildpackage": "tools/setup/package.sh runs it",
    "cmake --preset release": "it is the build",
    "cmake --build --preset release": "it is the build",
    "ctest --preset release -L hardware": "it is a part of the suite",
    "cmake --install build/release --prefix ~/plvo": "architecture_install does, into another prefix",
    "LD_LIBRARY_PATH=~/plvo/lib/plvo-openni2": "it needs a sensor; cli_live_test does the same with a virtual one",
    "export LD_LIBRARY_PATH=build/release/tests/virtual_openni2": "of the hardware tests, with the lines after it",
    "build/release/bin/plvo live --view 8080": "of the hardware tests: live_browser_test",
    "build/release/tests/plvo_virtual_frames": "of the hardware tests: virtual_frames_test",
    "PLVO_VIRTUAL_FRAMES=$PWD/raw": "of the hardware tests: virtual_frames_test",
    "folder=/usr/lib/": "it copies the driver of a maker, which is not here",
    "git clone https://github.com/OpenKinect/libfreenect2.git": "it downloads",
    "cmake -S . -B build -DBUILD_OPENNI2_DRIVER=ON": "of a library that is not here",
    "cc -std=c11 track_folder.c": "architecture_install compiles that program by pkg-config",
    "./track_folder sequence": "c_sequence_test runs that program",
    "python3 -m venv --system-site-packages env": "python_pip_test does the same without an index",
}


def commands(page):
    """The commands of a page's blocks, without comments, in their order."""
    for block in blocks(page.read_text(encoding="utf-8")):
        for line in block.splitlines():
            command = " ".join(re.sub(r"(^|\s)#.*", "", line).split())
            if command:
                yield command


def reason(command):
    return next((why for words, why in REASONS.items() if command.startswith(words)), None)


def runs_here(command):
    return command not in IN_A_TEST and reason(command) is None


def test_every_command_is_known():
    everything = [command for page in PAGES for command in commands(page)]
    for command in everything:
        assert not runs_here(command) or re.match(r"(?:build/release/bin/)?plvo ", command), command
    assert set(IN_A_TEST) <= set(everything), "a command that no page has"
    for words in REASONS:
        assert any(command.startswith(words) for command in everything), f"no page has {words}"


def test_the_named_tests_have_the_options():
    for command, name in IN_A_TEST.items():
        text = text_of_test(name)
        assert command.split()[1] in text, f"{command}: {name} has no {command.split()[1]}"
        assert not missing_options(command, text), f"{command}: not in {name}"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Recordings and programs of the names that the pages use."""
    folder = tmp_path_factory.mktemp("pages")
    programs = folder / "programs"
    programs.mkdir()
    (programs / "plvo").write_text(f'#!/bin/sh\nexec {PLVO} "$@"\n')
    (programs / "your_program").write_text("#!/bin/sh\nexec wc -l\n")
    for program in programs.iterdir():
        program.chmod(0o755)
    for name, frames, size in (("DIR", 8, "640x480"), ("sequence", 12, "320x240"), ("monday", 12, "320x240"), ("tuesday", 12, "320x240")):
        subprocess.run([PLVO, "simulate", "--frames", str(frames), "--size", size, "--quiet", "--out", name], cwd=folder, check=True)
    for name in ("plvo.txt", "other.txt", "third.txt"):
        subprocess.run([PLVO, "run", "sequence", "--quiet", "--out", name], cwd=folder, check=True)
    subprocess.run([PLVO, "run", "monday", "--map", "256", "--map-out", "home.map", "--quiet"], cwd=folder, check=True)
    return folder


def adapted(command):
    """The command with what this machine has: the simulated camera, free ports, few frames."""
    command = command.replace("build/release/bin/plvo", "plvo").replace("unix:/run/poses", "unix:poses")
    command = re.sub(r"(--(?:view|stream)) (\d{4})\b", lambda found: f"{found[1]} {free_port()}", command)
    words = command.split()
    if words[1] == "live":
        for option, value in (("--camera", "sim"), ("--size", "320x240"), ("--frames", "12"), ("--quiet", "")):
            if option not in words:
                command += f" {option} {value}"
    if words[1] == "simulate" or "--frames 100" in command:
        command = command.replace("--frames 100", "--frames 12 --size 320x240")
    return re.sub(r"--record sequence\b|--out sequence\b", lambda found: found[0].replace("sequence", "new"), command)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_the_commands_of_a_page_run(folder, page):
    for command in filter(runs_here, commands(page)):
        done = subprocess.run(["bash", "-e", "-o", "pipefail", "-c", adapted(command)], cwd=folder, text=True,
                              env={**os.environ, "PATH": f"{folder / 'programs'}:{os.environ['PATH']}"}, capture_output=True, timeout=300, check=False)
        if command == "plvo doctor":
            assert done.returncode in (0, 4) and done.stderr == "", "with or without a sensor"
        else:
            assert done.returncode == 0, f"{command}: {done.stderr}"
        subprocess.run(["rm", "-rf", folder / "new"], check=True)
