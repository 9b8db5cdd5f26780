# SPDX-License-Identifier: Apache-2.0
"""The commands of the user's pages, and the tests that run them."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def blocks(text):
    """The blocks of shell commands of a page, with joined lines."""
    return [block.replace("\\\n", " ") for block in re.findall(r"^```sh\n(.*?)^```", text, re.S | re.M)]


def text_of_test(name):
    return next(path for path in ROOT.glob(f"tests/*/{name}.*") if path.suffix in (".cpp", ".py")).read_text(encoding="utf-8")


def missing_options(command, text):
    """The options of a command that the text of a test does not have."""
    return [option for option in re.findall(r"--[\w-]+", command) if option not in text]
