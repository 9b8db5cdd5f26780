# SPDX-License-Identifier: Apache-2.0
"""Every path of the repository that a page names in backticks exists. Globs match at least one file; {a,b} stands for both. So does
every page of docs/ that a comment, a script or a CMakeLists.txt names."""
import pathlib
import re
import sys

import sources

FOLDERS = ("core", "hal", "platform", "tools", "tests", "docs")


def expand(pattern):
    """The paths that a name with {a,b} stands for."""
    match = re.search(r"\{([^{}]*)\}", pattern)
    if not match:
        return [pattern]
    return [path for part in match.group(1).split(",")
            for path in expand(pattern[:match.start()] + part.strip() + pattern[match.end():])]


def spans(text):
    """(line number, text) of everything in single backticks, outside of blocks of code."""
    plain = re.sub(r"^```.*?^```$", lambda block: "\n" * block.group(0).count("\n"), text, flags=re.S | re.M)
    for match in re.finditer(r"`([^`\n]+)`", plain):
        yield plain.count("\n", 0, match.start()) + 1, match.group(1)


def exists(root, path):
    """Placeholders in capitals (tools/plvo/cli/NAME/NAME.cpp) stand for any name."""
    path = re.sub(r"NAME|\bX\b|…", "*", path.rstrip("/"))
    return any(root.glob(path)) if re.search(r"[*?\[]", path) else (root / path).exists()


def check(root):
    root = pathlib.Path(root)
    errors = []
    for page in sorted((*root.glob("*.md"), *root.glob("docs/**/*.md"))):
        if page.name == "CHANGELOG.md":  # it names what was there
            continue
        for line, text in spans(page.read_text(encoding="utf-8")):
            for word in text.split():
                if not re.match(rf"(?:{'|'.join(FOLDERS)})/\S", word):
                    continue
                for path in expand(re.sub(r"(?::\d+)?[,;:.)]*$", "", word)):
                    if not exists(root, path):
                        errors.append(f"{page.relative_to(root)}:{line}: {path}: there is no such file")
    for path in sources.files(root, suffixes=(*sources.CODE, *sources.SCRIPTS, ".txt", ".ld", ".in")):
        name = path.relative_to(root).as_posix()
        text = "" if name == "tests/architecture/self_test.py" else path.read_text(encoding="utf-8", errors="replace")
        for match in re.finditer(r"(?<![\w/])docs/[\w/]+\.md\b", text):
            if not (root / match.group(0)).exists():
                errors.append(f"{name}:{text.count(chr(10), 0, match.start()) + 1}: {match.group(0)}: there is no such page")
    return errors


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "every path on the pages exists"))
