# SPDX-License-Identifier: Apache-2.0
"""Checks that each page of docs/results begins with its stamp: commit, date, machine, command and what wrote it. README.md there is
written by hand: it says how the tables are read, and names every page."""
import pathlib
import re
import sys

STAMP = {
    "commit": r"[0-9a-f]{40}\b.*",
    "date": r"\d{4}-\d\d-\d\d\b.*",
    "machine": r"\S.*",
    "command": r"`(?:plvo_bench|plvo|sequence_statistics|truth_noise) .*`",
    "written": r"by (?:`tools/plvo/bench/update_results.py`|hand, from .*)",
}


def check(root):
    root = pathlib.Path(root)
    folder = root / "docs/results"
    pages = [path for path in sorted(folder.glob("*.md")) if path.name != "README.md"]
    errors = [] if pages else ["docs/results: there is no page"]
    readme = (folder / "README.md").read_text(encoding="utf-8") if (folder / "README.md").exists() else ""
    for path in pages:
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        for entry, pattern in STAMP.items():
            if not re.search(rf"^- {entry}: {pattern}$", text, re.M):
                errors.append(f"{name}: its stamp has no {entry}; tools/plvo/bench/update_results.py writes it")
        if f"]({path.name})" not in readme:
            errors.append(f"{name}: docs/results/README.md does not name it")
    return errors


def main():
    errors = check(sys.argv[1])
    print("\n".join(errors) if errors else "every page of results has its stamp")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
