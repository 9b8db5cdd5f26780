# SPDX-License-Identifier: Apache-2.0
"""Checks that clang-format, with the .clang-format of plvo, changes no C++ file. Skipped without clang-format."""
import shutil
import subprocess
import sys

import sources

SKIP = 77


def main():
    tool = shutil.which("clang-format-14") or shutil.which("clang-format")
    if not tool:
        print("SKIPPED: clang-format is not installed (apt-get install clang-format)")
        return SKIP
    files = [str(path) for path in sources.files(sys.argv[1], suffixes=(".hpp", ".cpp"))]
    result = subprocess.run([tool, "--dry-run", "-Werror", *files], cwd=sys.argv[1], capture_output=True, text=True)
    wrong = sorted({line.split(":")[0] for line in result.stderr.splitlines() if "clang-format-violations" in line})
    print("\n".join(f"{name}: run clang-format -i on it" for name in wrong) or f"{len(files)} files are in shape")
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
