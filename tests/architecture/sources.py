# SPDX-License-Identifier: Apache-2.0
"""Functions shared by the checks of plvo: list the files, extract the code of a C++ file, and report."""
import pathlib
import re

LAYERS = ("core", "hal", "platform", "tools", "tests")
CODE = (".hpp", ".cpp", ".h", ".c")
SCRIPTS = (".py", ".sh", ".cmake")


def files(root, layers=LAYERS, suffixes=CODE):
    """Yields every file below these layers, in a fixed order."""
    root = pathlib.Path(root)
    for layer in layers:
        for path in sorted((root / layer).rglob("*")):
            if path.is_file() and (path.suffix in suffixes or path.name in suffixes):
                yield path


_NOISE = re.compile(
    r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.S)


def code_only(text):
    """Returns the text without comments and literals; line numbers do not change."""
    def blank(match):
        token = match.group(0)
        if token[0] == '"':
            return '""'
        return "\n" * token.count("\n") or " "
    return _NOISE.sub(blank, text)


def includes(text):
    """Yields (line number, 'quote' or 'angle', header) for every #include outside of comments."""
    without_comments = re.sub(r"//[^\n]*|/\*.*?\*/", lambda m: "\n" * m.group(0).count("\n"), text, flags=re.S)
    for number, line in enumerate(without_comments.splitlines(), 1):
        match = re.match(r'\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', line)
        if match:
            yield number, ("quote" if match.group(1) else "angle"), match.group(1) or match.group(2)


def report(errors, kept):
    """Prints the errors, or that the rule is kept; returns the exit code."""
    print("\n".join(errors) if errors else kept)
    return 1 if errors else 0
