# SPDX-License-Identifier: MIT
"""The type stubs name what the package has."""
import ast
import inspect
import pathlib
import re

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


def parameters_of(doc, name):
    """The names in the signatures of a docstring that pybind11 wrote, one list for each overload."""
    found = []
    for line in (doc or "").splitlines():
        if signature := re.match(rf"(?:\d+\. )?{name}\((.*)\) -> ", line):
            names = re.findall(r"(?:^|, )(\*?\w+)(?=: )", re.sub(r"\[[^\]]*\]|\([^)]*\)", "", signature[1]))
            found.append([n for n in names if n != "self"])
    return found


def test_functions_take_the_parameters_that_their_stubs_have():
    checked = 0
    for holder, nodes in [(crofton, stub.body), *((getattr(crofton, c.name), c.body) for c in stub.body if isinstance(c, ast.ClassDef))]:
        for node in nodes:
            if not isinstance(node, ast.FunctionDef) or node.args.vararg or not hasattr(holder, node.name):
                continue
            told = [a.arg for a in node.args.args + node.args.kwonlyargs if a.arg != "self"]
            taken = parameters_of(getattr(holder, node.name).__doc__, node.name)
            # Parameters without a name, as those of operators, are arg0, arg1, ….
            taken = [names for names in taken if not any(n.startswith("arg") for n in names)]
            if taken:
                assert told in taken, f"{holder.__name__}.{node.name}"
                checked += 1
    assert checked > 100, checked
