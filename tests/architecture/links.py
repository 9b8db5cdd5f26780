# SPDX-License-Identifier: Apache-2.0
"""Checks that every relative link of a page leads to an existing file and heading, that pages of docs/ link to nothing outside of it
(docs/ is installed as share/doc/plvo), and that the README is short and links directly to what a new user needs first."""
import pathlib
import re
import sys

import sources

README_LINES = 120  # at most
# (topic, page and heading)
FROM_README = [
    ("a camera driver of one's own", "docs/user/cpp.md#a-camera-driver-of-your-own"),
    ("covariance", "docs/user/cpp.md#pose-and-covariance"),
    ("wheels", "docs/user/cpp.md#wheels-a-gyro-gravity"),
    ("lost frames", "docs/user/cpp.md#lost-frames"),
    ("poses in ROS", "docs/user/robots.md#a-node-for-ros-2"),
    ("a Raspberry Pi", "docs/user/small_board.md#raspberry-pi"),
    ("columns of stats.csv", "docs/user/outputs.md#columns-of-statscsv"),
]


def without_code(text):
    return re.sub(r"^```.*?^```$", lambda block: "\n" * block.group(0).count("\n"), text, flags=re.S | re.M)


def anchors(text):
    """Returns the anchors that GitHub makes from the headings of a page, and the explicit anchors of the page."""
    found = set(re.findall(r'<a id="([^"]+)">', text))
    for heading in re.findall(r"^#+ (.*)$", without_code(text), re.M):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
        anchor = re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")
        number = sum(1 for other in found if re.fullmatch(re.escape(anchor) + r"(-\d+)?", other))
        found.add(f"{anchor}-{number}" if anchor in found else anchor)
    return found


def links(text):
    """Yields (line number, target) for every link of a page outside of code blocks."""
    plain = without_code(text)
    for match in re.finditer(r"\]\(([^()\s]*(?:\([^()\s]*\))?[^()\s]*)\)", plain):
        yield plain.count("\n", 0, match.start()) + 1, match.group(1)


def check_links(root):
    for page in sorted((*root.glob("*.md"), *root.glob("docs/**/*.md"))):
        for line, target in links(page.read_text(encoding="utf-8")):
            if re.match(r"[a-z]+:", target):
                continue
            file, _, anchor = target.partition("#")
            path = page.parent / file if file else page
            if page.parent != root and (root / "docs").resolve() not in path.resolve().parents:
                yield f"{page.relative_to(root)}:{line}: {target}: is outside of docs/, and so not installed"
            elif not path.exists():
                yield f"{page.relative_to(root)}:{line}: {target}: there is no such file"
            elif anchor and anchor not in anchors(path.read_text(encoding="utf-8")):
                yield f"{page.relative_to(root)}:{line}: {target}: {path.name} has no such heading"


def check_readme(root):
    text = (root / "README.md").read_text(encoding="utf-8")
    if text.count("\n") > README_LINES:
        yield f"README.md: has more than {README_LINES} lines"
    targets = {target for _, target in links(text)}
    for what, target in FROM_README:
        if target not in targets:
            yield f"README.md: no link to {target}, where a reader finds {what}"


def check(root):
    root = pathlib.Path(root)
    return [*check_links(root), *check_readme(root)]


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "every link leads to a heading"))
