# SPDX-License-Identifier: Apache-2.0
"""__init__.pyi says what the package has: every name, every attribute of its classes, every parameter, with their docstrings."""
import ast
import inspect
import pathlib
import re
import types

import pytest

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


def functions():
    """Name, what it is in the package, and its stub, of each function that is no property."""
    for node in STUB.body:
        if isinstance(node, ast.FunctionDef):
            yield node.name, getattr(plvo, node.name), node
        for method in node.body if isinstance(node, ast.ClassDef) else ():
            if isinstance(method, ast.FunctionDef) and decorators(method) != ["property"]:
                yield f"{node.name}.{method.name}", getattr(getattr(plvo, node.name), method.name), method


def decorators(node):
    return [decorator.id for decorator in node.decorator_list]


def stub_parameters(node):
    return [argument.arg for argument in node.args.args + node.args.kwonlyargs if argument.arg != "self"]


def test_the_parameters_are_those_of_the_functions():
    checked = 0
    for name, function, node in functions():
        if isinstance(function, types.FunctionType):  # written in Python
            assert stub_parameters(node) == [n for n in inspect.signature(function).parameters if n != "self"], name
        elif not re.search(r"\.__(enter|exit|iter|len|next)__$", name):
            assert stub_parameters(node) == runtime_parameters(function), name
        checked += 1
    assert checked > 30


def documented():
    """Name, what it is in the package, and its stub, of each public class, function, property and field."""
    for node in STUB.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            yield node.name, getattr(plvo, node.name), node
        for member in node.body if isinstance(node, ast.ClassDef) and node.name != "Error" else ():
            name = member.name if isinstance(member, ast.FunctionDef) else getattr(getattr(member, "target", None), "id", "_")
            if not name.startswith("_"):
                yield f"{node.name}.{name}", getattr(getattr(plvo, node.name), name), member


def test_every_public_name_has_a_docstring():
    names = set()
    for name, thing, _ in documented():
        docstring = inspect.getdoc(thing)
        # pybind11 puts the signature before it.
        summary = re.sub(r"^\w+\(.*\) -> .*\n\n", "", docstring).partition("\n")[0]
        assert summary and (summary.endswith(".") or len(docstring) > len(summary)), name
        assert docstring.strip().endswith(inspect.cleandoc(plvo._plvo._docstring(name)).strip()), name
        names.add(name)
    assert names >= {*plvo.__all__, "Camera.K", "Camera.read", "Odometry.track", "Features.keypoints", "Trajectory.save"}


SECTIONS = ["Parameters", "Attributes", "Returns", "Raises"]


def sections(docstring):
    """The sections of numpydoc, each with the names or types before its texts."""
    parts = re.split(r"^(\w+)\n-+\n", docstring, flags=re.M)
    assert parts[1::2] == sorted(parts[1::2], key=SECTIONS.index), docstring
    return {title: re.findall(r"^(\S.*)\n    \S", text, re.M) for title, text in zip(parts[1::2], parts[2::2])}


def test_the_docstrings_are_numpydoc():
    for name, thing, node in documented():
        found = sections(plvo._plvo._docstring(name))
        assert all(entries for entries in found.values()), name
        function = node
        if isinstance(node, ast.ClassDef):
            function = next((part for part in node.body if getattr(part, "name", "") == "__init__"), None)
        parameters = []
        if isinstance(function, ast.FunctionDef) and decorators(function) != ["property"]:
            parameters = stub_parameters(function)
            nothing = isinstance(function.returns, ast.Constant) and function.returns.value is None
            assert ("Returns" in found) == (not nothing), name
        described = [entry.split(" : ") for entry in found.get("Parameters", [])]
        assert all(len(entry) == 2 for entry in described), name
        assert [parameter for names, _ in described for parameter in names.split(", ")] == parameters, name
        # An array has a shape.
        type_ = ast.unparse(getattr(node, "returns", None) or getattr(node, "annotation", None) or ast.Constant(""))
        assert "NDArray" not in type_ or re.search(r"\((\w+, ?)+\w*\)", plvo._plvo._docstring(name)), name


def test_a_name_without_a_docstring_is_refused():
    with pytest.raises(RuntimeError, match="plvo.Camera.colour has no docstring in __init__.pyi"):
        plvo._plvo._docstring("Camera.colour")
