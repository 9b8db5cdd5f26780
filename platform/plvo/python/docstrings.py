# SPDX-License-Identifier: Apache-2.0
"""Writes the docstrings of a stub as a source of C++, so that they stand in one place.

usage: docstrings.py STUB.pyi OUT.cpp
"""
import ast
import inspect
import pathlib
import sys


def docstrings(body, prefix=""):
    """Names and docstrings of classes, functions, properties, and of attributes that a string follows."""
    for node, after in zip(body, [*body[1:], None]):
        text = None
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            text, name = ast.get_docstring(node), prefix + node.name
        elif isinstance(node, ast.AnnAssign) and isinstance(after, ast.Expr):
            text, name = inspect.cleandoc(after.value.value), prefix + node.target.id
        if text:
            yield name, text
        if isinstance(node, ast.ClassDef):
            yield from docstrings(node.body, name + ".")


def main():
    stub, out = map(pathlib.Path, sys.argv[1:])
    entries = "".join(f'{{"{name}", R"doc({text}\n)doc"}},\n' for name, text in docstrings(ast.parse(stub.read_text("utf-8")).body))
    out.write_text(f"""#include "plvo/python/bindings.hpp"
const std::map<std::string, const char*> plvo::python::kDocstrings{{
{entries}}};
""", "utf-8")


if __name__ == "__main__":
    main()
