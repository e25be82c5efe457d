"""Runs an optimiser as a process of its own: ``python -m driftless.solve FILE|MODULE NAME``.

It speaks the protocol of external optimisers on standard input and output.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
import math
import os
import random
import sys
from types import SimpleNamespace
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from . import _run
from ._errors import BudgetSpent, NoDerivatives
from ._solver import call

__all__ = ["main"]

_Array = NDArray[np.float64]


class _Stopped(BudgetSpent):
    """The search is over."""


class _Oracle:
    """The oracle of a run, at the other end of a pipe."""

    def __init__(self, lines: TextIO, out: TextIO) -> None:
        self._lines, self._out = lines, out
        opening = json.loads(lines.readline())
        box = opening["problem"]
        self.lower, self.upper = np.array(box["lower"]), np.array(box["upper"])
        self.dimension: int = box["dimension"]
        self.has_subgradient, self.has_linearise = "subgradient" in box["has"], "linearise" in box["has"]
        self.seed: int = opening["seed"]
        self.settings: dict[str, Any] = opening["settings"]
        self.budget: int = opening["budget"]
        self.remaining: int = self.budget
        self.best: tuple[_Array, float] | None = None

    @property
    def evaluations(self) -> int:
        return self.budget - self.remaining

    def say(self, message: object) -> None:
        self._out.write(json.dumps(message) + "\n")
        self._out.flush()

    def __call__(self, x: Any) -> float:
        return self.evaluate(x)[0]

    def evaluate(self, x: Any) -> tuple[float, float]:
        costs, violations = self._costs(self._checked(x, "a point", (self.dimension,))[None])
        return float(costs[0]), float(violations[0])

    def batch(self, x: Any) -> _Array:
        return self.evaluate_batch(x)[0]

    def evaluate_batch(self, x: Any) -> tuple[_Array, _Array]:
        points = self._checked(x, "points", ("m", self.dimension))
        return self._costs(points) if len(points) else (np.empty(0), np.empty(0))

    def subgradient(self, x: Any) -> tuple[float, _Array]:
        answer = self._derived("subgradient", self.has_subgradient, x)
        return float(answer["cost"]), _array(answer["subgradient"])

    def linearise(self, x: Any) -> Any:
        answer = self._derived("linearise", self.has_linearise, x)
        terms: list[SimpleNamespace] = []
        for term in answer["terms"]:
            pieces = term["pieces"]
            floor = -math.inf if term["shape"] == "max" else 0.0
            own = SimpleNamespace(weight=term["weight"], shape=term["shape"], floor=term.get("floor", floor))
            own.tracks, own.places = [piece["track"] for piece in pieces], _array([piece["place"] for piece in pieces])
            own.values = _array([piece["value"] for piece in pieces])
            gradients = [number for piece in pieces for number in piece["gradient"]]
            own.gradients = _array(gradients).reshape(len(pieces), self.dimension)
            terms.append(own)
        return SimpleNamespace(cost=float(answer["cost"]), terms=terms)

    def _checked(self, x: Any, what: str, shape: tuple[int | str, ...]) -> _Array:
        array = np.asarray(x)
        if array.dtype.kind not in "fiub":
            raise TypeError(f"found {what} of dtype {array.dtype}, expected real numbers")
        if array.ndim != len(shape) or array.shape[-1] != self.dimension:
            expected = str(shape).replace("'", "")
            raise ValueError(f"found {what} of shape {array.shape}, expected {expected}")
        return array.astype(float)

    def _costs(self, points: _Array) -> tuple[_Array, _Array]:
        answer = self._ask({"x": [_numbers(row) for row in points]})
        costs, violations = _array(answer["cost"]), _array(answer["violation"])
        for row, cost in zip(points, costs):
            if math.isfinite(cost) and (self.best is None or cost < self.best[1]):
                self.best = row.copy(), float(cost)
        if len(costs) < len(points):
            raise _Stopped("every evaluation of the budget is spent")
        return costs, violations

    def _derived(self, what: str, is_there: bool, x: Any) -> dict[str, Any]:
        if not is_there:
            raise NoDerivatives("the problem has no derivatives of this kind")
        return self._ask({what: _numbers(self._checked(x, "a point", (self.dimension,)))})

    def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        self.say(question)
        answer: dict[str, Any] = json.loads(self._lines.readline() or '{"stop": "end of input"}')
        if "stop" in answer:
            raise _Stopped("every evaluation of the budget is spent")
        self.remaining = int(answer["left"])
        return answer


def _numbers(row: _Array) -> list[float | str]:
    return [float(x) if math.isfinite(x) else str(float(x)) for x in row]


def _array(numbers: list[Any]) -> _Array:
    return np.array([float(number) for number in numbers])


def _load(where: str, name: str) -> Any:
    """What a file or a module has under a name. As with `multiprocessing`, a script is no `__main__` here."""
    _run.loading = where
    try:
        if os.path.isfile(where):
            # Behind the modules that Python brings, whose names the file's neighbours may have.
            sys.path.append(os.path.dirname(os.path.abspath(where)))
            spec = importlib.util.spec_from_file_location("__driftless_main__", where)
            if spec is None or spec.loader is None:
                raise ImportError(f"{where} is no Python module")
            module = importlib.util.module_from_spec(spec)
            sys.modules[module.__name__] = module
            spec.loader.exec_module(module)
        else:
            module = importlib.import_module(where)
    finally:
        _run.loading = None
    found: Any = module
    for part in name.split("."):
        found = getattr(found, part)
    return found


def main(arguments: list[str]) -> None:
    """Runs the optimiser that a file or a module has under a name; further arguments tell its runs from others."""
    if len(arguments) < 2:
        sys.exit("usage: python -m driftless.solve FILE|MODULE NAME: `driftless.run` starts this")
    # What the optimiser prints is its log, and what it reads is nothing.
    lines, out = sys.stdin, sys.stdout
    sys.stdin, sys.stdout = open(os.devnull), sys.stderr
    where, name = arguments[:2]
    found = _load(where, name)
    function, needs_derivatives = getattr(found, "function", found), getattr(found, "needs_derivatives", False)
    oracle = _Oracle(lines, out)
    oracle.say({"hello": {"name": name}})
    if needs_derivatives and not oracle.has_subgradient:
        raise NoDerivatives("the optimiser needs derivatives, and the problem has none")
    # This process has global generators of its own.
    random.seed(oracle.seed)
    np.random.seed(oracle.seed)
    try:
        call(function, oracle, np.random.default_rng(oracle.seed), oracle.settings)
    except _Stopped:
        return
    oracle.say({"done": True})


if __name__ == "__main__":
    main(sys.argv[1:])
