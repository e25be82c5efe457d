"""What determines what a function does, in a few letters."""

from __future__ import annotations

import hashlib
import inspect
import textwrap
import types
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

__all__ = ["digest"]

_SIMPLE = (int, float, complex, str, bytes, bool, type(None))


def digest(function: Callable[..., Any]) -> str:
    """A digest of a function's source, and of what it uses of its own module: functions, classes, numbers, texts, tuples and arrays, at
    any depth.

    Lists and dicts, which functions may write to, do not count, nor does what it uses of other modules.
    """
    hashed, seen = hashlib.sha256(), set[int]()
    _add(function, getattr(function, "__module__", None), hashed, seen)
    return hashed.hexdigest()[:16]


def _add(thing: Any, module: str | None, hashed: Any, seen: set[int]) -> None:
    if isinstance(thing, _SIMPLE):
        hashed.update(f"{thing!r}\n".encode())
    elif isinstance(thing, np.ndarray):
        hashed.update(f"{thing.dtype} {thing.shape}".encode() + thing.tobytes())
    elif isinstance(thing, tuple):
        for part in thing:
            _add(part, module, hashed, seen)
    elif (callable(thing) or inspect.isclass(thing)) and getattr(thing, "__module__", None) == module:
        if id(thing) in seen:
            return
        seen.add(id(thing))
        thing = inspect.unwrap(getattr(thing, "function", thing))
        hashed.update(_source(thing).encode())
        for name, part in _used(thing):
            hashed.update(f"{name}=".encode())
            _add(part, module, hashed, seen)


def _source(thing: Any) -> str:
    try:
        return textwrap.dedent(inspect.getsource(thing))
    except (OSError, TypeError):
        code = getattr(thing, "__code__", None)
        return f"{code.co_code!r} {code.co_consts!r}" if code else repr(type(thing))


def _used(thing: Any) -> Iterator[tuple[str, Any]]:
    """Names that a function or the methods of a class use, and their values."""
    functions = [thing] if isinstance(thing, types.FunctionType) else [
        part for part in vars(thing).values() if isinstance(part, types.FunctionType)
    ] if inspect.isclass(thing) else []
    for function in functions:
        for name in sorted(_names(function.__code__)):
            if name in function.__globals__:
                yield name, function.__globals__[name]
        for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
            try:
                yield name, cell.cell_contents
            except ValueError:
                continue


def _names(code: types.CodeType) -> set[str]:
    names = set(code.co_names)
    for part in code.co_consts:
        if isinstance(part, types.CodeType):
            names |= _names(part)
    return names
