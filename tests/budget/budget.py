# SPDX-License-Identifier: Apache-2.0
"""Compares figures with the tables of a page of docs/: a row that differs by more than 3 % fails, and so does a figure above
its ceiling. With PLVO_UPDATE_DOCS=1 in the environment the row is written anew instead."""
import os
import pathlib
import re
import subprocess
import sys

TOLERANCE = 0.03


def committed(page, row):
    """The figure of the row whose first cell is `row`."""
    match = re.search(rf"^\| {re.escape(row)} \| ([\d,]+) \|", page, re.M)
    return int(match.group(1).replace(",", "")) if match else None


def judge(page, row, value, ceiling=None, unit="bytes"):
    """What is wrong, or None."""
    known = committed(page, row)
    if known is None:
        return f"no row '{row}' in the page"
    if abs(value - known) > TOLERANCE * known:
        return f"{row}: {value:,} {unit}, the page says {known:,}; PLVO_UPDATE_DOCS=1 writes it anew, if that is meant"
    if ceiling is not None and value > ceiling:
        return f"{row}: {value:,} {unit}, more than the ceiling of {ceiling:,}"
    return None


def check(path, figures, unit="bytes"):
    """figures: (row, value, ceiling or None). The number of those that are wrong."""
    path, wrong = pathlib.Path(path), 0
    for row, value, ceiling in figures:
        if os.environ.get("PLVO_UPDATE_DOCS"):
            text = path.read_text(encoding="utf-8")
            path.write_text(re.sub(rf"^(\| {re.escape(row)} \|) [\d,]+ \|", rf"\1 {value:,} |", text, flags=re.M), encoding="utf-8")
        error = judge(path.read_text(encoding="utf-8"), row, value, ceiling, unit)
        print(error or f"{row}: {value:,} {unit}")
        wrong += error is not None
    return wrong


def text_bytes(size_tool, binary):
    """Instructions and constants: the column `text` of size, over all members."""
    out = subprocess.run([size_tool, "-t", binary], capture_output=True, text=True, check=True).stdout
    return int(out.splitlines()[-1].split()[0])


def main():
    page, row, size_tool, binary = sys.argv[1:5]
    ceiling = int(sys.argv[5]) if len(sys.argv) > 5 else None
    return 1 if check(page, [(row, text_bytes(size_tool, binary), ceiling)]) else 0


if __name__ == "__main__":
    sys.exit(main())
