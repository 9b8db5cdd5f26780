# SPDX-License-Identifier: Apache-2.0
"""ran.py RESULTS PRESET NAME…: checks the file of ctest --output-junit RESULTS of a suite that passed. The suite must have run each
NAME and may have skipped only the tests that tests/allowed_skips.txt lists for this preset and this machine. This way a suite cannot
pass because tests were not built or had no data."""
import fnmatch
import os
import pathlib
import re
import sys
import xml.etree.ElementTree

ALLOWED = pathlib.Path(__file__).parent.parent / "allowed_skips.txt"
CAP_SYS_ADMIN = 21


def may_mount():
    status = pathlib.Path("/proc/self/status").read_text(encoding="utf-8")
    return int(re.search(r"^CapEff:\s*(\w+)", status, re.M).group(1), 16) >> CAP_SYS_ADMIN & 1


def circumstances(preset):
    """Returns the conditions of the list's first column that apply to this preset and machine."""
    shared = os.environ.get("PLVO_SHARED") or ALLOWED.parent.parent.parent / "shared"
    here = {"always", preset}
    if not (pathlib.Path(shared) / "data").is_dir():
        here.add("no-shared")
    if os.geteuid() != 0:
        here.add("no-root")
    if not may_mount():
        here.add("no-mount")
    return here


def allowed(text, here):
    rows = [line.split("#")[0].split() for line in text.splitlines()]
    return {name for where, name in filter(None, rows) if where in here}


def skipped(test):
    """Returns the names of the skipped tests of a ctest entry: those of GoogleTest's tests, or else the name of the entry."""
    output = test.findtext("system-out") or ""
    of_pytest = re.search(r"^(?:.*, )?\d+ skipped\b", output, re.M)
    if test.get("status") not in ("notrun", "disabled") and not of_pytest:
        return []
    tests = re.findall(r"^\[  SKIPPED \] (\S+\.\S+)(?: \(\d+ ms\))?$", output, re.M)
    return sorted(set(tests)) or [test.get("name")]


def check(results, may_skip, names):
    tests = xml.etree.ElementTree.fromstring(results).findall("testcase")
    ran = {test.get("name") for test in tests if test.get("status") == "run"}
    for name in names:
        if name not in ran:
            yield f"{name} did not run"
    for test in tests:
        for name in skipped(test):
            if not any(fnmatch.fnmatchcase(name, pattern) for pattern in may_skip):
                yield f"{name} was skipped ({test.get('name')}), and tests/allowed_skips.txt does not name it for this preset"


def main():
    results, preset, *names = sys.argv[1:]
    may_skip = allowed(ALLOWED.read_text(encoding="utf-8"), circumstances(preset))
    errors = list(check(pathlib.Path(results).read_text(encoding="utf-8"), may_skip, names))
    for error in errors:
        print(f"{results}: {error}", file=sys.stderr)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
