# SPDX-License-Identifier: Apache-2.0
"""Checks that each measured value is on one page only and that the others link to it: a copy becomes outdated when the value
changes. The README's table repeats values of docs/results/ on purpose: they must be equal, and its best peer must be the best there."""
import pathlib
import re
import sys

import sources

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


# Pages that the bench writes, and the names that the README gives to its systems.
RECORDINGS, TABLE2, LIGHTING = "docs/results/recordings.md", "docs/results/table2.md", "docs/results/lighting.md"
PEERS = {"opencv-rgbd": "OpenCV RgbdOdometry", "opencv-icp": "OpenCV ICPOdometry", "opencv-rgbdicp": "OpenCV RgbdICPOdometry",
         "open3d-hybrid": "Open3D hybrid"}


def all_rows(text, *names):
    return [row for table in with_columns(text, *names) for row in table]


def expected_rows(recordings, lighting):
    """Returns the README's table as computed from docs/results/: name of the sequence -> row."""
    rows, peers = {}, {}
    for row in all_rows(recordings, "sequence", "system", "mm/s"):
        if row["system"] == "plvo-both":
            rows[row["sequence"]] = {"plvo, mm per s": row["mm/s"], "plvo, ° per s": row["°/s"], "time": row["time / RgbdOdometry"]}
        elif row["system"] in PEERS:
            peers.setdefault(row["sequence"], []).append((float(row["mm/s"]), row["mm/s"], PEERS[row["system"]]))
    for row in all_rows(lighting, "site", "light", "zero motion"):
        name = f"{row['site']}, {row['light']}"
        rows[name] = {"plvo, mm per s": row["plvo-both"], "plvo, ° per s": "–", "time": "–"}
        peers[name] = [(float(row[peer]), row[peer], PEERS[peer]) for peer in PEERS if row.get(peer, "–") != "–"]
    for name, row in rows.items():
        _, row["its mm per s"], row["best peer"] = min(peers.get(name, []), default=(0, "–", "–"))
    return rows


def check_copies(root):
    readme, recordings, table2, lighting = ((root / name).read_text(encoding="utf-8")
                                            for name in ("README.md", RECORDINGS, TABLE2, LIGHTING))
    expected, compared = expected_rows(recordings, lighting), 0
    for row in all_rows(readme, "sequence", "best peer"):
        for column, theirs in expected.get(row["sequence"], {}).items():
            compared += 1
            if row[column] != theirs:
                yield f"README.md: {row['sequence']}: {column} is {row[column]}, in docs/results/ {theirs}"
        if row["sequence"] not in expected:
            yield f"README.md: {row['sequence']} is in no table of docs/results/"
    rows = {(row["sequence"], row["system"]): row for row in all_rows(recordings, "sequence", "system", "mm/s")}
    for row in all_rows(table2, "sequence", "system", "mm/s"):
        ours = rows.get((row["sequence"], row["system"]))
        for column in ("mm/frame", "°/frame", "mm/s", "°/s") if ours else ():
            compared += 1
            last_digit = 10.0 ** -len(row[column].partition(".")[2])
            if abs(float(ours[column]) - float(row[column])) > 0.5001 * last_digit:
                yield f"{TABLE2}: {row['sequence']}, {row['system']}: {column} is {row[column]}, {ours[column]} in {RECORDINGS}"
    if compared == 0:
        yield "README.md: none of its figures was found in docs/results/: have the tables moved?"


def check(root):
    root = pathlib.Path(root)
    return [*check_one_page(root), *check_copies(root)]


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "every figure stands on one page"))
