"""The protocol for solvers in Python, without any package.

    with door.Problem("my solver") as problem:
        cost, costs = problem(x), problem.batch(points)
        cost, slopes = problem.subgradient(x)

Once the budget is spent, a call raises `Spent`, which ends the `with` block. It is no `Exception`, so that solvers let it through.
"""

import json
import math
import sys


def numbers(x):
    """A point for JSON, which knows no NaN."""
    return [float(value) if math.isfinite(value) else str(float(value)) for value in x]


class Spent(BaseException):
    """The search is over."""


class Problem:
    """A box to search in (`lower`, `upper`, `dimension`), and the run's `seed`, `budget` and `settings`."""

    def __init__(self, name):
        opening = json.loads(sys.stdin.readline())
        box = opening["problem"]
        self.lower, self.upper, self.dimension, self.has = (box[k] for k in ("lower", "upper", "dimension", "has"))
        self.seed, self.budget, self.settings = opening["seed"], opening["budget"], opening["settings"]
        self._say({"hello": {"name": name}})

    def __call__(self, x):
        return self.batch([x])[0]

    def batch(self, points):
        costs = self._ask("x", [numbers(x) for x in points])["cost"]
        if len(costs) < len(points):
            raise Spent
        return [float(cost) for cost in costs]

    def subgradient(self, x):
        answer = self._ask("subgradient", numbers(x))
        return float(answer["cost"]), [float(slope) for slope in answer["subgradient"]]

    def _ask(self, what, argument):
        self._say({what: argument})
        answer = json.loads(sys.stdin.readline() or '{"stop": "end of input"}')
        if "stop" in answer:
            raise Spent
        return answer

    def _say(self, message):
        print(json.dumps(message), flush=True)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        if kind is None:
            self._say({"done": True})
        return kind is Spent
