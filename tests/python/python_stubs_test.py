# SPDX-License-Identifier: Apache-2.0
"""__init__.pyi says what the package has: every name, every attribute of its classes, every parameter."""
import ast
import inspect
import pathlib
import re

import plvo

STUB = ast.parse((pathlib.Path(plvo.__file__).parent / "__init__.pyi").read_text())


def public(names):
    return {name for name in names if not name.startswith("_")}


def stub_names(body):
    functions = {node.name for node in body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    return functions | {node.target.id for node in body if isinstance(node, ast.AnnAssign)}


def test_the_names_are_those_of_the_package():
    assert public(stub_names(STUB.body)) == set(plvo.__all__)


def test_the_attributes_are_those_of_the_classes():
    for node in STUB.body:
        if isinstance(node, ast.ClassDef) and node.name != "Error":
            known = {"count", "index"} if hasattr(getattr(plvo, node.name), "_fields") else set()
            assert public(stub_names(node.body)) == public(dir(getattr(plvo, node.name))) - known, node.name


def runtime_parameters(function):
    """pybind11 writes a signature into the first line of the documentation."""
    match = re.match(r"\w+\((.*)\)", (function.__doc__ or "").strip().splitlines()[0])
    names = [re.match(r"\*?(\w*)", part.strip()).group(1) for part in re.split(r",(?![^\[(]*[\])])", match.group(1))]
    return [name for name in names if name not in ("", "self")]


def test_the_parameters_are_those_of_the_functions():
    checked = 0
    for node in STUB.body:
        if not isinstance(node, ast.ClassDef) or getattr(plvo, node.name).__module__ == "plvo":  # written in Python
            continue
        for method in node.body:
            if not isinstance(method, ast.FunctionDef) or method.decorator_list or method.name not in ("__init__", "track"):
                continue
            stub = [a.arg for a in method.args.args + method.args.kwonlyargs if a.arg != "self"]
            assert stub == runtime_parameters(getattr(getattr(plvo, node.name), method.name)), (node.name, method.name)
            checked += 1
    assert checked == 8
    for name in ("run", "evaluate", "to_dataframe"):
        node = next(n for n in STUB.body if isinstance(n, ast.FunctionDef) and n.name == name)
        stub = [a.arg for a in node.args.args + node.args.kwonlyargs]
        assert stub == list(inspect.signature(getattr(plvo, name)).parameters)
