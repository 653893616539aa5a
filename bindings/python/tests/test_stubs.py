# SPDX-License-Identifier: MIT
"""The type stubs name what the package has."""
import ast
import inspect
import pathlib

import crofton

stub = ast.parse((pathlib.Path(crofton.__file__).parent / "__init__.pyi").read_text())


def names_of(body):
    names = set()
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            names.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            names.add(node.target.id)
    return names


def public(thing):
    return {n for n in vars(thing) if not n.startswith("_")}


def test_the_module_has_what_its_stub_has():
    assert names_of(stub.body) - {"__version__"} == public(crofton)


def test_classes_have_what_their_stubs_have():
    for node in stub.body:
        if isinstance(node, ast.ClassDef) and node.name != "Error":
            members = {n for n in names_of(node.body) if not n.startswith("_")}
            assert members == public(getattr(crofton, node.name)), node.name


def test_everything_has_a_docstring():
    for name in public(crofton):
        thing = getattr(crofton, name)
        if inspect.isclass(thing) or callable(thing):
            assert thing.__doc__, name
