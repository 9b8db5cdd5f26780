# SPDX-License-Identifier: Apache-2.0
"""Checks that a shared library exports exactly the functions that its headers mark, in version PLVO_0.
usage: exports.py LIBRARY HEADER…"""
import pathlib
import re
import subprocess
import sys


def main():
    library, *headers = sys.argv[1:]
    listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    shown = {line.split()[2] for line in listed.splitlines()} - {"PLVO_0"}
    promised = set()
    for header in headers:
        promised |= set(re.findall(r"^PLVO_API [^;]*?(\w+)\(", pathlib.Path(header).read_text(), re.M))
    wanted = {f"{name}@@PLVO_0" for name in promised}
    for name in sorted(shown ^ wanted):
        print(("shown, though no header has it: " if name in shown else "in a header, but not shown: ") + name)
    print(f"{len(shown & wanted)} functions")
    return 1 if shown != wanted or len(wanted) < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
