# SPDX-License-Identifier: Apache-2.0
"""Checks that each message that docs/user/troubleshooting.md quotes is one of the program's, that each message of a Status is there, and
that each page that a message names is installed and has the heading. A message names a page as share/doc/plvo/...: as it lies below
the prefix, and in a build folder."""
import pathlib
import re
import sys

import links
import sources

PAGE = "docs/user/troubleshooting.md"
LAYERS = ("core", "hal", "platform", "tools")
LITERAL = re.compile(r'"(?:\\.|[^"\\\n])*"(?:\s*"(?:\\.|[^"\\\n])*")*')
PIECE = re.compile(r'"((?:\\.|[^"\\\n])*)"')
OF_A_STATUS = re.compile(r"StatusCode::k\w+,\s*(?:fmt::format\()?\s*$")  # before a literal
APPENDED = re.compile(r"\.append\(\s*$")  # before a literal, which begins a message if it begins with a letter
NAMED = re.compile(r"share/doc/plvo/([\w/]+\.md)(?:#([\w-]+))?")


def literals(text):
    """Yields (line number, text, is it a message of a Status) of every literal of a C++ or Python file; adjacent ones are one."""
    text = re.sub(r"//[^\n]*|^\s*#\s*include.*$", "", text, flags=re.M)
    for match in LITERAL.finditer(text):
        joined = "".join(PIECE.findall(match.group(0)))
        before = text[max(0, match.start() - 80):match.start()]
        of_a_status = bool(OF_A_STATUS.search(before) or APPENDED.search(before) and len(joined.split()) > 2 and joined[0].isalpha())
        yield text.count("\n", 0, match.start()) + 1, joined.replace('\\"', '"').replace("\\n", "\n"), of_a_status


def quotes(text):
    """Yields (line number, message) of the messages in the tables: what stands in backticks and has a space in it, in the columns
    message and cause. In the column cause, options are no messages."""
    header = []
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split(" | ")] if line.startswith("|") else []
        header = header if cells else []
        header = header or cells
        for name, cell in zip(header, cells):
            if name in ("message", "cause"):
                for quote in re.findall(r"`([^`]+)`", cell):
                    if " " in quote and not (name == "cause" and quote.startswith("--")):
                        yield number, quote


def parts(message):
    """The pieces of a message between its placeholders."""
    return [part.strip() for part in re.split(r"…|\{[^{}]*\}", message) if len(part.strip()) > 3]


def check(root):
    root = pathlib.Path(root)
    page = root / PAGE
    quoted = list(quotes(page.read_text(encoding="utf-8"))) if page.exists() else []
    quoted_parts = [part for _, quote in quoted for part in parts(quote)]
    errors, all_literals = [], []
    for path in sources.files(root, LAYERS, suffixes=(".cpp", ".hpp", ".h", ".py")):
        name = path.relative_to(root).as_posix()
        for number, text, of_a_status in literals(path.read_text(encoding="utf-8")):
            all_literals.append(re.sub(r"\{[^{}]*\}", "…", text))
            if of_a_status and parts(text) and not any(q in part or part in q for part in parts(text) for q in quoted_parts):
                errors.append(f"{name}:{number}: \"{text}\": give the message a row in {PAGE}")
            for page, anchor in NAMED.findall(text):
                file = root / "docs" / page
                if not file.is_file():
                    errors.append(f"{name}:{number}: there is no page docs/{page}")
                elif anchor and anchor not in links.anchors(file.read_text(encoding="utf-8")):
                    errors.append(f"{name}:{number}: docs/{page} has no heading #{anchor}")
            if re.search(r"\bdocs/\w+/\w+\.md", text):
                errors.append(f"{name}:{number}: a message names a page as it is installed: share/doc/plvo/..., not docs/...")
    everything = "\n".join(all_literals)
    for number, quote in quoted:
        for part in parts(quote):
            if part not in everything:
                errors.append(f"{PAGE}:{number}: no message has \"{part}\"")
    return errors


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "every message is on the page, and every quoted message is one of the program's"))
