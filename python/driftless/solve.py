"""Runs an optimiser as a process of its own: ``python -m driftless.solve FILE NAME``.

It speaks the protocol of external optimisers on standard input and output.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import sys
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from . import BudgetSpent, Optimiser
from ._errors import NoDerivatives

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
        self.has_subgradient, self.has_linearise = "subgradient" in box["has"], False
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
        return float(self.batch(np.asarray(x, dtype=float)[None])[0])

    def evaluate(self, x: Any) -> tuple[float, float]:
        costs, violations = self.evaluate_batch(np.asarray(x, dtype=float)[None])
        return float(costs[0]), float(violations[0])

    def batch(self, x: Any) -> _Array:
        return self.evaluate_batch(x)[0]

    def evaluate_batch(self, x: Any) -> tuple[_Array, _Array]:
        points = np.asarray(x, dtype=float)
        if points.ndim != 2 or points.shape[1] != self.dimension:
            raise ValueError(f"found points of shape {points.shape}, expected (m, {self.dimension})")
        if len(points) == 0:
            return np.empty(0), np.empty(0)
        answer = self._ask({"x": [_numbers(row) for row in points]})
        costs = np.array([float(cost) for cost in answer["cost"]])
        violations = np.array([float(violation) for violation in answer["violation"]])
        for row, cost in zip(points, costs):
            if math.isfinite(cost) and (self.best is None or cost < self.best[1]):
                self.best = row.copy(), float(cost)
        if len(costs) < len(points):
            raise _Stopped("every evaluation of the budget is spent")
        return costs, violations

    def subgradient(self, x: Any) -> tuple[float, _Array]:
        if not self.has_subgradient:
            raise NoDerivatives("the problem has no derivatives of this kind")
        answer = self._ask({"subgradient": _numbers(np.asarray(x, dtype=float))})
        return float(answer["cost"]), np.array([float(slope) for slope in answer["subgradient"]])

    def _ask(self, question: dict[str, Any]) -> dict[str, Any]:
        self.say(question)
        answer: dict[str, Any] = json.loads(self._lines.readline() or '{"stop": "end of input"}')
        if "stop" in answer:
            raise _Stopped("every evaluation of the budget is spent")
        self.remaining = int(answer["left"])
        return answer


def _numbers(row: _Array) -> list[float | str]:
    return [float(x) if math.isfinite(x) else str(float(x)) for x in row]


def _load(file: str, name: str) -> Any:
    sys.path.insert(0, os.path.dirname(os.path.abspath(file)))
    spec = importlib.util.spec_from_file_location(os.path.splitext(os.path.basename(file))[0], file)
    if spec is None or spec.loader is None:
        raise ImportError(f"{file} is no Python module")
    module = importlib.util.module_from_spec(spec)
    sys.modules[module.__name__] = module
    spec.loader.exec_module(module)
    found: Any = module
    for part in name.split("."):
        found = getattr(found, part)
    return found


def main(file: str, name: str) -> None:
    """Runs the optimiser that a file has under a name."""
    # What the optimiser prints is its log.
    out, sys.stdout = sys.stdout, sys.stderr
    found = _load(file, name)
    function = found.function if isinstance(found, Optimiser) else found
    oracle = _Oracle(sys.stdin, out)
    oracle.say({"hello": {"name": name}})
    try:
        function(oracle, np.random.default_rng(oracle.seed), **oracle.settings)
    except _Stopped:
        return
    oracle.say({"done": True})


if __name__ == "__main__":
    main(*sys.argv[1:])
