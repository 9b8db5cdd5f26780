# SPDX-License-Identifier: Apache-2.0
"""Frames per second of processor time: a loop over plvo.run beside `plvo run`, which is C++, and beside the C program of
docs/user/c.md; all three do the same with one folder, in turns, whose order goes round. The middle one of the rounds counts.
usage: PYTHONPATH=build/release/python python3 tests/python/throughput.py FOLDER [ROUNDS]"""
import pathlib
import resource
import statistics
import subprocess
import sys

import plvo

BUILD = pathlib.Path(plvo.__file__).parents[2]
PYTHON = "import sys, plvo; print(sum(1 for _ in plvo.run(sys.argv[1])))"


def commands(folder):
    return {
        "C++": [BUILD / "bin/plvo", "run", folder, "--quiet"],
        "C": [BUILD / "tests/plvo_c_example", folder],
        "Python": [sys.executable, "-W", "ignore", "-c", PYTHON, folder],
    }


def processor_s(command):
    """Of a process from its start to its end: all three bear their own start, the interpreter's too."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    output = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, output


def main():
    all_commands = commands(sys.argv[1])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    frames = int(processor_s(all_commands["Python"])[1])
    seconds = {name: [] for name in all_commands}
    for i in range(rounds):
        names = list(all_commands)
        for name in names[i % 3:] + names[:i % 3]:
            seconds[name].append(processor_s(all_commands[name])[0])
    middle = {name: statistics.median(times) for name, times in seconds.items()}
    for name, times in seconds.items():
        print(f"{name:6} {frames / middle[name]:6.1f} frames per second of processor time "
              f"({frames / max(times):.1f} to {frames / min(times):.1f})")
    for name in ("C++", "C"):
        print(f"Python has {100 * middle[name] / middle['Python']:.1f} % of the throughput of {name}")


if __name__ == "__main__":
    main()
