"""The package as such."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import driftless
from driftless import _driftless

FOLDER = Path(inspect.getfile(driftless)).parent
STUB = ast.parse((FOLDER / "_driftless.pyi").read_text())


def test_everything_public_is_documented() -> None:
    for name in driftless.__all__:
        thing = getattr(driftless, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for own, part in vars(thing).items():
                if not own.startswith("_") and (callable(part) or isinstance(part, property)):
                    assert inspect.getdoc(part), f"{name}.{own}"


def test_the_stub_says_what_the_extension_says() -> None:
    for node in STUB.body:
        if not isinstance(node, ast.ClassDef):
            continue
        own = getattr(_driftless, node.name)
        if ast.get_docstring(node):
            assert inspect.cleandoc(own.__doc__) == ast.get_docstring(node), node.name
        stubbed = {part.name for part in node.body if isinstance(part, ast.FunctionDef)}
        there = {name for name, part in vars(own).items() if not name.startswith("__")}
        assert there == {name for name in stubbed if not name.startswith("__")}, node.name
        for part in node.body:
            # What stands for `__call__` has the documentation that Python gives it.
            if isinstance(part, ast.FunctionDef) and ast.get_docstring(part) and part.name != "__call__":
                assert inspect.cleandoc(getattr(own, part.name).__doc__) == ast.get_docstring(part), part.name


def test_functions_of_the_extension_are_stubbed() -> None:
    stubbed = {node.name for node in STUB.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert {name for name in vars(_driftless) if not name.startswith("_")} == stubbed


def test_all_names_are_there() -> None:
    assert driftless.__all__ == sorted(driftless.__all__)
    assert all(hasattr(driftless, name) for name in driftless.__all__)


def test_types_come_along() -> None:
    assert (FOLDER / "py.typed").is_file()
