# SPDX-License-Identifier: Apache-2.0
"""Checks that each measured value is on one page only and that the others link to it: a copy becomes outdated when the value
changes. The README's table repeats values of docs/results/ on purpose: they must be equal, and its best peer must be the best there."""
import pathlib
import re
import sys

# (the value, a pattern of its statement, the page that may state it)
ONE_PAGE = [
    ("bytes of stack", r"\d[\d.,]* ?(?:KiB|kB|bytes) (?:of |for the )?stack|\bstack\b[^.|]{0,60}?\d[\d.,]* ?(?:KiB|kB)\b", "docs/developer/memory.md"),
    ("bytes of code", r"\d ?(?:KiB|kB)\b[^.|]{0,40}\b(?:flash|code)\b|\b(?:flash|code size)\b[^.|]{0,30}?\d+ ?(?:KiB|kB)\b", "docs/developer/memory.md"),
    ("bytes of the smaller limits", r"\b(?:tiny|qvga|QVGA)\b[^.|]{0,40}?\b(?!512)\d+ ?KiB", "docs/developer/memory.md"),
    ("what NEON spares", r"\b0\.\d+ of (?:what `?armhf|the instructions)", "docs/developer/performance.md"),
    ("instructions of a board's frame", r"\b320×240 is \d+ million", "docs/developer/performance.md"),
    ("how true covariances are", r"covariances? (?:is|are|stays?) honest\b|honest covariance|normalised error squared[^.|]{0,20}is \d",
     "docs/user/accuracy.md"),
]


def pages(root):
    return [path for path in (*root.glob("*.md"), *root.glob("docs/**/*.md"))]


def check_one_page(root):
    for path in sorted(pages(root)):
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        for what, pattern, owner in ONE_PAGE:
            for match in re.finditer(pattern, text.replace("\n", " ")):
                if name != owner:
                    line = text.count("\n", 0, match.start()) + 1
                    yield f"{name}:{line}: \"{match.group(0)}\": {what}: state it in {owner} alone, and refer to it here"


def tables(text):
    """Yields the tables of a page. A table is a list of rows; a row is a dictionary with the names of the columns as keys."""
    plain = text.replace("*", "").replace("`", "")
    for block in re.findall(r"(?:^\|.*\n)+", plain, re.M):
        head, _, *rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in block.splitlines()]
        yield [dict(zip(head, row)) for row in rows]


def with_columns(text, *names):
    return [rows for rows in tables(text) if rows and all(name in rows[0] for name in names)]


# Columns of docs/results/recordings.md -> columns of its comparison with the paper, which has fewer decimals.
COLUMNS = {"mm per frame": "mm/frame", "° per frame": "°/frame", "mm per s": "mm/s", "° per s": "°/s"}
RECORDINGS, LIGHTING = "docs/results/recordings.md", "docs/results/lighting.md"


def expected_rows(recordings, lighting):
    """Returns the README's table as computed from docs/results/: name of the sequence -> row."""
    rows, peers = {}, {}
    for row in (row for table in with_columns(recordings, "sequence", "system", "mm per s") for row in table):
        if row["system"] == "plvo, both":
            rows[row["sequence"]] = {"plvo, mm per s": row["mm per s"], "plvo, ° per s": row["° per s"], "time": row["time"]}
        elif not row["system"].startswith(("plvo", "never moves")):
            peers.setdefault(row["sequence"], []).append((float(row["mm per s"]), row["mm per s"], row["system"]))
    for row in (row for table in with_columns(lighting, "site", "light", "never moves") for row in table):
        name = f"{row['site']}, {row['light']}"
        rows[name] = {"plvo, mm per s": row["plvo, both"], "plvo, ° per s": "–", "time": "–"}
        others = [column for column in row if column not in ("site", "light", "never moves") and not column.startswith("plvo")]
        peers[name] = [(float(row[column]), row[column], column) for column in others if row[column] != "–"]
    for name, row in rows.items():
        _, row["its mm per s"], row["best peer"] = min(peers.get(name, []), default=(0, "–", "–"))
    return rows


def check_copies(root):
    readme, recordings, lighting = ((root / name).read_text(encoding="utf-8") for name in ("README.md", RECORDINGS, LIGHTING))
    expected, compared = expected_rows(recordings, lighting), 0
    for row in (row for table in with_columns(readme, "sequence", "best peer") for row in table):
        for column, theirs in expected.get(row["sequence"], {}).items():
            compared += 1
            ours = row[column].removeprefix("OpenCV ") if column == "best peer" else row[column]
            if ours != theirs.removeprefix("OpenCV "):
                yield f"README.md: {row['sequence']}: {column} is {row[column]}, in docs/results/ {theirs}"
        if row["sequence"] not in expected:
            yield f"README.md: {row['sequence']} is in no table of docs/results/"
    rows = {(row["sequence"], row["system"]): row for table in with_columns(recordings, "sequence", "system", "mm per s") for row in table}
    for row in (row for table in with_columns(recordings, "sequence", "system", *COLUMNS.values()) for row in table):
        ours = rows.get((row["sequence"], row["system"].replace("plvo-", "plvo, ")))
        for column, theirs in COLUMNS.items() if ours else ():
            compared += 1
            last_digit = 10.0 ** -len(row[theirs].partition(".")[2])
            if abs(float(ours[column]) - float(row[theirs])) > 0.5001 * last_digit:
                yield f"{RECORDINGS}: {row['sequence']}, {row['system']}: {theirs} is {row[theirs]}, {ours[column]} in the table above"
    if compared == 0:
        yield "README.md: none of its figures was found in docs/results/: have the tables moved?"


def check(root):
    root = pathlib.Path(root)
    return [*check_one_page(root), *check_copies(root)]


def main():
    errors = check(sys.argv[1])
    print("\n".join(errors) if errors else "every figure stands on one page")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
