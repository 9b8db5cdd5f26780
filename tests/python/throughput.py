# SPDX-License-Identifier: Apache-2.0
"""Frames per second of processor time: a loop over plvo.run beside the C program of docs/c.md, which does the same, in
turns. usage: PYTHONPATH=build/release/python python3 tests/python/throughput.py FOLDER [ROUNDS]"""
import pathlib
import resource
import subprocess
import sys
import time

import plvo

NATIVE = pathlib.Path(plvo.__file__).parents[2] / "tests/plvo_c_example"


def children_s():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def main():
    folder = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    native_s = python_s = frames = 0
    for _ in range(rounds):
        before = children_s()
        subprocess.run([NATIVE, folder], check=True, stdout=subprocess.DEVNULL)
        native_s += children_s() - before
        before = time.process_time()
        frames += sum(1 for _ in plvo.run(folder))
        python_s += time.process_time() - before
    print(f"C {frames / native_s:.1f}, Python {frames / python_s:.1f} frames per second of processor time; "
          f"Python has {100 * native_s / python_s:.1f} % of C's throughput")


if __name__ == "__main__":
    main()
