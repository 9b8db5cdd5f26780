# SPDX-License-Identifier: Apache-2.0
"""Some sources of the core are compiled for size, the others for speed. Of a function that both kinds emit (a template, an
inline function) the linker keeps one copy, perhaps the slow one: there may be none. Arguments: nm, the archive, how the names
of the sources begin that are compiled for size."""
import subprocess
import sys


def member_of(where):
    return where.split(":")[-2]


def is_there(nm_lines, small):
    """Whether any member's name begins so: without one nothing would be compared."""
    return any(member_of(line.partition(" ")[0]).startswith(small) for line in nm_lines)


def shared(nm_lines, small):
    """Functions in members of both kinds, from lines `archive:member:address W name`."""
    seen = {True: set(), False: set()}
    for line in nm_lines:
        where, _, symbol = line.partition(" ")
        kind, _, name = symbol.partition(" ")
        if kind == "W":
            seen[member_of(where).startswith(small)].add(name)
    return sorted(seen[True] & seen[False])


def main():
    nm, archive, small = sys.argv[1:]
    lines = subprocess.run([nm, "-A", "-C", "--defined-only", archive], capture_output=True, text=True, check=True).stdout.splitlines()
    if not is_there(lines, small):
        print(f"no member of {archive} begins with {small}")
        return 1
    found = shared(lines, small)
    for name in found:
        print(f"compiled for size and for speed: {name}")
    print(f"{len(lines)} functions and objects, {len(found)} of both kinds")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
