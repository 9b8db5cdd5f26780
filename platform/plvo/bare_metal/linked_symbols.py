# SPDX-License-Identifier: Apache-2.0
"""Checks the symbols of a linked program for a board: it must not contain code for a heap, exceptions, run-time types, text
output, a mathematics library or an operating system. Usage: linked_symbols.py PROGRAM [--nm NM] [--expect NAME…]"""
import argparse
import re
import subprocess
import sys

FORBIDDEN = {
    "takes memory from a heap": r"_?(?:malloc|calloc|realloc|free|memalign|aligned_alloc|posix_memalign|sbrk)(?:_r)?|_Zn[wa]\w*",
    "gives memory to a heap": r"_Zd[la]\w*",
    "exceptions": r"__cxa_(?!pure_virtual$)\w+|_Unwind_\w+|__gxx_personality\w*|__gnu_unwind\w*|_ZSt9terminatev|_ZSt\d+__throw_\w+",
    "run-time types": r"_ZT[IS]\w+|__dynamic_cast",
    "text output": r"_?\w*printf(?:_\w+)?|_?(?:puts|putchar|fputs|fwrite|fopen)(?:_r)?",
    "mathematics that differ from one library to the next":
        r"(?:__ieee754_|__kernel_)?(?:sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(?:2|10|1p)?|pow|cbrt|hypot|sqrt|fma"
        r"|floor|ceil|round|fmod)f?",
    "an operating system": r"_?(?:abort|exit|raise|kill|getpid|signal|getenv|time|open|close|read|write|lseek|fstat|isatty|__errno)(?:_r)?"
                           r"|_impure_ptr|_global_impure_ptr|atexit",
}


def check(nm, program):
    out = subprocess.run([nm, program], capture_output=True, text=True, check=True).stdout
    names = sorted({line.split()[-1] for line in out.splitlines() if line.strip()})
    if not any("plvo" in name for name in names):
        return [f"{program} has no symbols of plvo: is it stripped?"]
    return [f"{name} is linked: {why}" for name in names for why, pattern in FORBIDDEN.items() if re.fullmatch(pattern, name)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--nm", default="arm-none-eabi-nm")
    parser.add_argument("--expect", nargs="*", help="a bad program: each of these must be found")
    arguments = parser.parse_args()
    errors = check(arguments.nm, arguments.program)
    print("\n".join(errors) if errors else "no heap, no exceptions, no library is linked")
    if arguments.expect is None:
        return 1 if errors else 0
    missed = [name for name in arguments.expect if not any(error.startswith(f"{name} is linked") for error in errors)]
    if missed:
        print("not caught: " + ", ".join(missed))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
