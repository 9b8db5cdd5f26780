# SPDX-License-Identifier: Apache-2.0
"""layout.py ROOT [ENTRIES]: checks the layout of the tests.

- A folder of tests/ has the name of the module that its tests test, or OTHER_FOLDERS says what it is.
- A test in the folder of a module includes a header of the module, itself or through a helper. Tests of PROGRAMS run them instead.
- A test file lies directly in such a folder. Its name is unique, since the ctest entry has the same name.
- ENTRIES is a file with the names of all ctest entries, one in each line. Then each test file must have an entry of its name. Tests
  that need a process or conditions of their own have entries a_test.DETAIL.
"""
import pathlib
import re
import sys

import dependencies
import sources

OTHER_FOLDERS = {
    "accuracy": "the odometry on rendered and recorded sequences",
    "architecture": "rules for all modules; its scripts are checks, not tests",
    "budget": "sizes and instructions that pages state; its scripts are checks, not tests",
    "cpp": "the programs of the page about C++",
    "fuzz": "fuzzers; fuzz_NAME.cpp is the entry fuzz_NAME",
    "golden": "the same bits from every compiler and processor",
    "hardware": "live cameras: a virtual OpenNI2 device and a simulated Kinect",
    "robot": "the programs of the page about robots",
    "support": "helpers of several folders",
}
CHECKS = ("architecture", "budget")
PROGRAMS = ("bench", "cli")


def test_files(root):
    for path in sorted((root / "tests").rglob("*_test.*")):
        if path.suffix == ".cpp" or (path.suffix in (".py", ".sh") and path.parent.name not in CHECKS):
            yield path


def included_modules(path, helpers, seen=()):
    """Returns the modules whose headers a file includes, itself or through helpers of the tests."""
    found = set()
    for _, kind, header in sources.includes(path.read_text(encoding="utf-8")):
        if header.startswith("plvo/"):
            found.add(header.split("/")[1])
        elif kind == "quote" and header in helpers and header not in seen:
            found |= included_modules(helpers[header], helpers, (*seen, header))
    return found


def check_folders(root):
    modules = dependencies.modules_of(root)
    for folder in sorted(path for path in (root / "tests").iterdir() if path.is_dir()):
        if folder.name not in modules and folder.name not in OTHER_FOLDERS and any(folder.iterdir()):
            yield f"tests/{folder.name}: there is no such module, and OTHER_FOLDERS in tests/architecture/layout.py does not name it"


def check_modules(root):
    modules = dependencies.modules_of(root)
    helpers = {path.name: path for path in sorted((root / "tests").rglob("*.h*"))}
    for path in test_files(root):
        module = path.parent.name
        if path.suffix == ".cpp" and module in modules and module not in PROGRAMS:
            if module not in included_modules(path, helpers):
                yield f"{path.relative_to(root)}: it includes no header of {module}; does it test another module?"


def check_files(root):
    first = {}
    for path in test_files(root):
        name = path.relative_to(root).as_posix()
        if path.parent.parent != root / "tests":
            yield f"{name}: a test file lies directly in tests/MODULE"
        if path.stem in first:
            yield f"{name}: {first[path.stem]} has the same name, so they would have the same ctest entry"
        first.setdefault(path.stem, name)
    for path in sorted((root / "tests").rglob("*.cpp")):
        if not path.stem.endswith("_test") and re.search(r"^TEST(?:_[FP])?\(", path.read_text(encoding="utf-8"), re.M):
            yield f"{path.relative_to(root)}: a file with tests is called *_test.cpp"


def check_entries(root, entries):
    with_entry = {entry.split(".")[0] for entry in entries}
    for path in test_files(root):
        if path.stem not in with_entry:
            yield f"{path.relative_to(root)}: there is no ctest entry {path.stem}"


def check(root, entries=None):
    root = pathlib.Path(root)
    return [*check_folders(root), *check_modules(root), *check_files(root),
            *(check_entries(root, entries) if entries is not None else ())]


def main():
    entries = pathlib.Path(sys.argv[2]).read_text(encoding="utf-8").split() if len(sys.argv) > 2 else None
    return sources.report(check(sys.argv[1], entries), "every test file lies in the folder of a module and has a name of its own")


if __name__ == "__main__":
    sys.exit(main())
