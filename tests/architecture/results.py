# SPDX-License-Identifier: Apache-2.0
"""Checks that each page of docs/results begins with its stamp (commit, date, machine, command and what wrote it), that a page of
docs/decisions is short, and that README.md of either folder, which is written by hand, names every page."""
import pathlib
import re
import sys

import sources

STAMP = {
    "commit": r"[0-9a-f]{40}\b.*",
    "date": r"\d{4}-\d\d-\d\d\b.*",
    "machine": r"\S.*",
    "command": r"`(?:plvo_bench|plvo|sequence_statistics|truth_noise|moving_world\.py|map\.py) .*`",
    "written": r"by `tools/plvo/bench/update_results.py`",
}
MOST_LINES = 25  # of a decision


def pages(folder):
    """Yields (page, text, whether README.md names it) of a folder."""
    readme = (folder / "README.md").read_text(encoding="utf-8") if (folder / "README.md").exists() else ""
    for path in sorted(folder.glob("*.md")):
        if path.name != "README.md":
            yield path, path.read_text(encoding="utf-8"), f"]({path.name})" in readme


def check(root):
    root = pathlib.Path(root)
    errors = []
    for folder in ("docs/results", "docs/decisions"):
        found = list(pages(root / folder))
        if not found:
            errors.append(f"{folder}: there is no page")
        for path, text, named in found:
            name = path.relative_to(root).as_posix()
            if not named:
                errors.append(f"{name}: README.md of {folder} does not name it")
            if folder == "docs/decisions" and text.count("\n") > MOST_LINES:
                errors.append(f"{name}: has more than {MOST_LINES} lines")
            for entry, pattern in STAMP.items() if folder == "docs/results" else ():
                if not re.search(rf"^- {entry}: {pattern}$", text, re.M):
                    errors.append(f"{name}: its stamp has no {entry}; tools/plvo/bench/update_results.py writes it")
    return errors


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "every page of results has its stamp, and decisions are short"))
