# SPDX-License-Identifier: Apache-2.0
"""Checks the symbols of the core's archive: its undefined symbols must be on a short list, and it must contain no mutable variable
and no function that a linker may replace. Therefore no path through the core reaches a heap, a file, a platform-dependent libm, or a
copy of an inline function that the user compiled with other options."""
import argparse
import re
import subprocess
import sys

# Functions that any C++ compiler may call, freestanding or not; and sqrt, which IEEE 754 rounds exactly.
ALLOWED = {"memcpy", "memmove", "memset", "bcmp", "memcmp", "strlen", "sqrt", "_GLOBAL_OFFSET_TABLE_"}
# 32-bit ARM: helpers of the compiler's own run-time library for 64-bit integers and block moves.
ALLOWED_PATTERN = re.compile(
    r"__aeabi_(?:u?l(?:div|2d|2f|asr|lsl|lsr|cmp|mul)(?:mod)?|u?ldivmod|u?idiv(?:mod)?|[df]2u?lz|mem(?:cpy|move|set|clr)[48]?"
    r"|unwind_cpp_pr[012])$|__(?:u?div|u?mod)[dst]i3$")
# Debug builds keep their assertions. Builds with the address sanitizer are not checked.
DEBUG_ONLY = {"__assert_fail", "__assert_func"}


def read(nm, archive):
    """Returns (undefined names, mutable variables, weak functions) of all members together."""
    out = subprocess.run([nm, archive], capture_output=True, text=True, check=True).stdout
    defined, undefined, mutable, weak = set(), set(), set(), set()
    for line in out.splitlines():
        match = re.match(r"(?:[0-9a-fA-F]+)?\s+([A-Za-z])\s+(\S+)$", line)
        if not match:
            continue
        kind, name = match.groups()
        if kind in "Uw":
            undefined.add(name)
            continue
        defined.add(name)
        if kind in "VW":
            weak.add(name)
        # Read-only data that needs relocation is also listed as data, but in a section of its own.
        if kind in "bBdDgGsSC" and not re.match(r"(?:\$|DW\.ref\.|_ZTV|_ZTS|_ZTI)", name):
            mutable.add(name)
    return undefined - defined, mutable, weak


def check(nm, archive, debug=False, sealed=False):
    undefined, mutable, weak = read(nm, archive)
    allowed = ALLOWED | (DEBUG_ONLY if debug else set())
    errors = [f"asks for {name}" for name in sorted(undefined)
              if name not in allowed and not ALLOWED_PATTERN.match(name)]
    errors += [f"holds the variable {name}" for name in sorted(mutable)]
    return errors + [f"lets others replace {name}" for name in sorted(weak) if sealed]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("archive")
    parser.add_argument("--nm", default="nm")
    parser.add_argument("--debug", action="store_true", help="allow what assertions need")
    parser.add_argument("--sealed", action="store_true", help="the archive is one that strangers link: no weak functions")
    parser.add_argument("--expect", nargs="*", help="the archive is a bad one: each of these must be found")
    arguments = parser.parse_args()
    errors = check(arguments.nm, arguments.archive, arguments.debug, arguments.sealed)
    print("\n".join(errors) if errors else "the core asks for nothing but block moves and sqrt")
    if arguments.expect is None:
        return 1 if errors else 0
    missed = [name for name in arguments.expect if not any(name in error for error in errors)]
    if missed:
        print("not caught: " + ", ".join(missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
