# SPDX-License-Identifier: Apache-2.0
"""Checks that a shared library exports exactly the functions that its headers mark, in version PLVO_0: those of C (.h) by their names,
members of classes of C++ (.hpp) by class and name.
usage: exports.py LIBRARY HEADER…"""
import pathlib
import re
import subprocess
import sys


def names_in(listed):
    """The names that nm -DC lists, without arguments: name@@version."""
    for line in listed.splitlines():
        name, _, version = line.split(maxsplit=2)[2].rpartition("@@")
        yield re.sub(r"\(.*|\[abi:\w+\]", "", name) + f"@@{version}"


def names_of(header):
    text = pathlib.Path(header).read_text()
    if header.endswith(".h"):
        return set(re.findall(r"^PLVO_API [^;]*?(\w+)\(", text, re.M))
    return {f"plvo::{name}::{member}" for name, body in re.findall(r"^class (\w+) \{\n(.*?)^\};", text, re.M | re.S)
            for member in re.findall(r"^  PLVO_API [^;(]*?(~?\w+)\(", body, re.M)}


def main():
    library, *headers = sys.argv[1:]
    listed = subprocess.run(["nm", "-DC", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    shown = set(names_in(listed)) - {"@@PLVO_0"}
    promised = set().union(*map(names_of, headers))
    wanted = {f"{name}@@PLVO_0" for name in promised}
    for name in sorted(shown ^ wanted):
        print(("shown, though no header has it: " if name in shown else "in a header, but not shown: ") + name)
    print(f"{len(shown & wanted)} functions")
    return 1 if shown != wanted or len(wanted) < 20 else 0


if __name__ == "__main__":
    sys.exit(main())
