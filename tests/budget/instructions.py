# SPDX-License-Identifier: Apache-2.0
"""The instructions of a frame on an emulated processor, in thousands, against the table of docs/developer/performance.md.
usage: instructions.py PAGE PROCESSOR PLUGIN EMULATOR… PROGRAM
The program writes a line for each sequence: its name, and marks its frames for the plugin (count_instructions.c); or where the plugin
is "-", the name and the instructions, counted by itself."""
import statistics
import subprocess
import sys

import budget


def of_marks(names, marks):
    """(name, instructions): the medians over the frames between every two marks, as many for each name."""
    taken = [end - begin for begin, end in zip(marks[::2], marks[1::2])]
    each = len(taken) // len(names)
    return [(name, statistics.median_low(taken[i * each:(i + 1) * each])) for i, name in enumerate(names)]


def of_words(lines):
    return [(name, int(count)) for name, count in (line.rsplit(" ", 1) for line in lines)]


def main():
    page, processor, plugin, emulator, *rest = sys.argv[1:]
    how = ["-icount", "shift=0"] if plugin == "-" else ["-plugin", plugin]
    run = subprocess.run([emulator, *how, *rest], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(run.stdout, run.stderr, f"the program ended with {run.returncode}", sep="\n")
        return 1
    lines = run.stdout.splitlines()
    counts = of_words(lines) if plugin == "-" else of_marks(
        lines, [int(line.split()[1]) for line in run.stderr.splitlines() if line.startswith("executed ")])
    figures = [(f"{processor}, {name}", (count + 500) // 1000, None) for name, count in counts]
    return 1 if budget.check(page, figures, "thousand instructions") else 0


if __name__ == "__main__":
    sys.exit(main())
