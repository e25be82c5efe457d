"""What determines what a function does, in a few letters."""

from __future__ import annotations

import enum
import functools
import hashlib
import inspect
import logging
import pickle
import types
from collections.abc import Callable
from typing import Any

import numpy as np

__all__ = ["digest"]

_log = logging.getLogger("driftless")

_SIMPLE = (int, float, complex, str, bytes, bool, type(None), type(...), range)
_NAMED = (types.ModuleType, types.BuiltinFunctionType, np.ufunc, types.MethodWrapperType, types.WrapperDescriptorType)


def digest(thing: Any) -> str:
    """A digest of a function as it is now: its code and defaults, and the values of all names that it uses.

    Functions and classes of its own module are looked into, and so are objects, at any depth; those of other modules count by their
    names.
    """
    walk = _Walk(getattr(thing, "__module__", None))
    walk.add(thing)
    return walk.hashed.hexdigest()[:16]


class _Walk:
    def __init__(self, module: str | None) -> None:
        self.hashed = hashlib.sha256()
        self._module = module
        self._seen: dict[int, int] = {}
        # Kept alive, so that no other object gets the same address.
        self._kept: list[Any] = []

    def say(self, *words: object) -> None:
        self.hashed.update(("\0".join(map(str, words)) + "\n").encode("utf-8", "surrogatepass"))

    def add(self, thing: Any) -> None:
        if isinstance(thing, _SIMPLE):
            self.say(type(thing).__name__, repr(thing))
            return
        if id(thing) in self._seen:
            self.say("again", self._seen[id(thing)])
            return
        self._seen[id(thing)] = len(self._seen)
        self._kept.append(thing)
        if isinstance(thing, types.CodeType):
            self._add_code(thing)
        elif isinstance(thing, types.FunctionType):
            self._add_function(thing)
        elif isinstance(thing, types.MethodType):
            self.say("method")
            self.add(thing.__func__)
            self.add(thing.__self__)
        elif isinstance(thing, functools.partial):
            self.say("partial")
            self.add((thing.func, thing.args, thing.keywords))  # pyright: ignore
        elif isinstance(thing, (np.ndarray, np.generic)):
            array = np.asarray(thing)
            self.say("array", array.dtype, array.shape)
            self.add(array.tolist()) if array.dtype.hasobject else self.hashed.update(array.tobytes())
        elif isinstance(thing, (list, tuple)):
            self._add_all(type(thing).__name__, thing)
        elif isinstance(thing, dict):
            self._add_all("dict", [part for item in thing.items() for part in item])
        elif isinstance(thing, (set, frozenset)):
            parts = sorted(_alone(part, self._module) for part in thing)
            self._add_all(type(thing).__name__, parts)
        elif isinstance(thing, enum.Enum):
            self.say("enum", type(thing).__qualname__, thing.name)
            self.add(thing.value)
        elif isinstance(thing, (staticmethod, classmethod)):
            self.add(thing.__func__)
        elif isinstance(thing, property):
            self.add((thing.fget, thing.fset))
        elif inspect.isclass(thing):
            self._add_class(thing)
        elif isinstance(thing, _NAMED):
            self.say("named", getattr(thing, "__module__", ""), getattr(thing, "__name__", repr(type(thing))))
        else:
            self._add_object(thing)

    def _add_all(self, kind: str, parts: Any) -> None:
        self.say(kind, len(parts))
        for part in parts:
            self.add(part)

    def _add_code(self, code: types.CodeType) -> None:
        # The code that runs, whatever its file has come to. Its first constant may be its documentation, which counts as well.
        self.say("code", code.co_argcount, code.co_kwonlyargcount, code.co_flags, *code.co_names, *code.co_varnames)
        self.hashed.update(code.co_code + getattr(code, "co_exceptiontable", b""))
        self._add_all("constants", code.co_consts)

    def _add_function(self, function: types.FunctionType) -> None:
        if function.__module__ != self._module:
            self.say("function", function.__module__, function.__qualname__)
            return
        self.add(function.__code__)
        self.add((function.__defaults__, function.__kwdefaults__))
        for name, cell in zip(function.__code__.co_freevars, function.__closure__ or ()):
            self.say("closed over", name)
            try:
                self.add(cell.cell_contents)
            except ValueError:
                self.say("empty")
        for name in sorted(_names(function.__code__)):
            if name in function.__globals__:
                self.say("global", name)
                self.add(function.__globals__[name])

    def _add_class(self, thing: type) -> None:
        self.say("class", thing.__module__, thing.__qualname__)
        if thing.__module__ != self._module:
            return
        self._add_all("bases", thing.__bases__)
        for name, part in sorted(vars(thing).items()):
            if name not in ("__dict__", "__weakref__", "__module__", "__firstlineno__", "__static_attributes__"):
                self.say("attribute", name)
                self.add(part)

    def _add_object(self, thing: Any) -> None:
        self.add(type(thing))
        state = getattr(thing, "__dict__", None)
        if isinstance(state, dict) and state:
            self.add(state)
            return
        try:
            # What is compiled says what it is made of, if anything does.
            self.hashed.update(pickle.dumps(thing, protocol=4))
        except Exception:
            kind = type(thing).__qualname__
            _log.warning("a %s does not say what it is made of, so that runs are not done again when it changes", kind)


def _alone(thing: Any, module: str | None) -> str:
    walk = _Walk(module)
    walk.add(thing)
    return walk.hashed.hexdigest()


def _names(code: types.CodeType) -> set[str]:
    names = set(code.co_names)
    for part in code.co_consts:
        if isinstance(part, types.CodeType):
            names |= _names(part)
    return names


def told(x: Any) -> int | float | str | None:
    """A setting as an identity has it: itself where it is plain, or else its type and a digest."""
    if isinstance(x, (np.integer, np.floating)):
        x = x.item()
    if isinstance(x, bool):
        return int(x)
    if isinstance(x, (int, float, str, type(None))):
        return x
    if isinstance(x, Callable):  # type: ignore[arg-type]
        return f"{type(x).__name__}: {digest(x)}"
    return f"{type(x).__name__}: {_alone(x, None)[:16]}"
