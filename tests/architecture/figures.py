# SPDX-License-Identifier: Apache-2.0
"""A figure stands on one page, and the others refer to it: a copy stays behind when the figure changes. Where the README repeats rows
of the bench's page on purpose, they must be equal."""
import pathlib
import re
import sys

# (what, how a page would state it, the page that may)
ONE_PAGE = [
    ("bytes of stack", r"\d[\d.,]* ?(?:KiB|kB|bytes) (?:of |for the )?stack|\bstack\b[^.|]{0,60}?\d[\d.,]* ?(?:KiB|kB)\b", "docs/memory.md"),
    ("bytes of code", r"\d ?(?:KiB|kB)\b[^.|]{0,40}\b(?:flash|code)\b|\b(?:flash|code size)\b[^.|]{0,30}?\d+ ?(?:KiB|kB)\b", "docs/memory.md"),
    ("bytes of the smaller limits", r"\b(?:tiny|qvga|QVGA)\b[^.|]{0,40}?\b(?!512)\d+ ?KiB", "docs/memory.md"),
    ("what NEON spares", r"\b0\.\d+ of (?:what `?armhf|the instructions)", "docs/performance.md"),
    ("instructions of a board's frame", r"\b320×240 is \d+ million", "docs/performance.md"),
    ("how true covariances are", r"covariances? (?:is|are|stays?) honest\b|honest covariance|normalised error squared[^.|]{0,20}is \d",
     "docs/evaluation.md"),
]


def pages(root):
    return [path for path in (*root.glob("*.md"), *root.glob("docs/*.md"))]


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
    """The tables of a page, each a list of rows, a row by its columns' names."""
    plain = text.replace("*", "").replace("`", "")
    for block in re.findall(r"(?:^\|.*\n)+", plain, re.M):
        head, _, *rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in block.splitlines()]
        yield [dict(zip(head, row)) for row in rows]


def with_columns(text, *names):
    return [rows for rows in tables(text) if rows and all(name in rows[0] for name in names)]


# Of the recordings: the README's columns, and those of the bench's page, with fewer decimals.
COLUMNS = {"mm per frame": "mm/frame", "° per frame": "°/frame", "mm per s": "mm/s", "° per s": "°/s"}


def check_copies(root):
    readme, bench = ((root / name).read_text(encoding="utf-8") for name in ("README.md", "docs/bench.md"))
    copied = 0
    for ours, theirs in zip(with_columns(readme, "site", "light"), with_columns(bench, "site", "light"), strict=True):
        rows = {(row["site"], row["light"]): row for row in theirs}
        for row in ours:
            other = rows[row["site"], row["light"]]
            for column in set(row) & set(other):
                copied += 1
                if row[column] != other[column]:
                    yield f"README.md: {row['site']}, {row['light']}: {column} is {row[column]}, on docs/bench.md {other[column]}"
    rows = {(row["sequence"], row["system"]): row for table in with_columns(readme, "sequence", "system") for row in table}
    for table in with_columns(bench, "sequence", "system", *COLUMNS.values()):
        for row in table:
            ours = rows.get((row["sequence"], row["system"].replace("plvo-", "plvo, ")))
            for column, theirs in COLUMNS.items() if ours else ():
                copied += 1
                last_digit = 10.0 ** -len(row[theirs].partition(".")[2])
                if abs(float(ours[column]) - float(row[theirs])) > 0.5001 * last_digit:
                    yield f"docs/bench.md: {row['sequence']}, {row['system']}: {theirs} is {row[theirs]}, in README.md {ours[column]}"
    if copied == 0:
        yield "README.md: none of its figures was found on docs/bench.md: have the tables moved?"


def check(root):
    root = pathlib.Path(root)
    return [*check_one_page(root), *check_copies(root)]


def main():
    errors = check(sys.argv[1])
    print("\n".join(errors) if errors else "every figure stands on one page")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
