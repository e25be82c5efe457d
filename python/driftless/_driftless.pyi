"""The compiled part of the package."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._motion import Motion as _Shown

__version__: str

@final
class Problem:
    """A cost to minimise in a box.

    `Task.problem`, `functions` and `problems` make problems. Calls beyond the box cost infinitely much, as they do in a run; so does NaN.
    """

    @property
    def name(self) -> str:
        """What it is called."""
    @property
    def label(self) -> str:
        """What tells it from others of its experiment; empty where there is but one."""
    @property
    def formulation(self) -> str | None:
        """The variables that it is searched in, where there are several."""
    @property
    def dimension(self) -> int:
        """The number of variables, n."""
    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower bounds, shape (n,)."""
    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper bounds, shape (n,)."""
    @property
    def best_known(self) -> float | None:
        """The least cost that anybody has found."""
    @property
    def has_subgradient(self) -> bool:
        """Whether there are subgradients."""
    @property
    def has_linearise(self) -> bool:
        """Whether the cost is a sum of terms with smooth pieces."""
    def __call__(self, x: ArrayLike) -> float:
        """The cost of a point, shape (n,)."""
    def violation(self, x: ArrayLike) -> float:
        """By how much a point violates limits; zero within."""
    def evaluate(self, x: ArrayLike) -> tuple[float, float]:
        """Cost and violation of a point."""
    def batch(self, x: ArrayLike) -> NDArray[np.float64]:
        """Costs of points, shape (m, n) to shape (m,). Other threads of Python run meanwhile."""
    def evaluate_batch(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Costs and violations of points, shape (m, n) to shape (m,) each."""
    def subgradient(self, x: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """The cost of a point within the box, with a subgradient, shape (n,).

        Raises
        ------
        NoDerivatives
            There are none.
        """
    def linearise(self, x: ArrayLike) -> Linearisation:
        """The cost of a point within the box as a sum of terms.

        Raises
        ------
        NoDerivatives
            The cost is no such sum.
        """
    def _native_seconds(self, x: ArrayLike, is_batch: bool) -> float: ...
    @property
    def _file(self) -> tuple[str, str] | None:
        """Where the task that it is stands, and its text; none of other problems."""
    @property
    def _is_preferred(self) -> bool:
        """Whether its variables are those that its subject is searched in unless an optimiser asks for others."""
    def motion(self, x: ArrayLike) -> _Shown:
        """The motion that a point stands for, evaluated finely. Of tasks alone."""
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Linearisation:
    """Terms of a cost at a point, with values and slopes of their smooth pieces."""

    @property
    def cost(self) -> float:
        """The sum of the terms."""
    @property
    def terms(self) -> list[Term]:
        """The terms."""

@final
class Term:
    """One term of a cost: a weight times a convex function of smooth pieces."""

    @property
    def weight(self) -> float:
        """The weight."""
    @property
    def shape(self) -> str:
        """The convex function: ``"norm"``, ``"max"``, or ``"hinge"``, which is the sum of what is above zero."""
    @property
    def floor(self) -> float:
        """What the convex function never falls below."""
    @property
    def tracks(self) -> list[int]:
        """What tells pieces from each other at different points, k numbers."""
    @property
    def places(self) -> NDArray[np.float64]:
        """Where on its track each piece is, shape (k,)."""
    @property
    def values(self) -> NDArray[np.float64]:
        """Values of the pieces, shape (k,)."""
    @property
    def gradients(self) -> NDArray[np.float64]:
        """Gradients of the pieces, shape (k, n)."""

@final
class Oracle:
    """The only door from an optimiser to its problem: it counts evaluations and keeps the best.

    Once the budget is spent, the next question raises `BudgetSpent`. After that every cost is infinite; a solver that goes on asking is
    abandoned. Threads of a solver may share an oracle.
    """

    @property
    def dimension(self) -> int:
        """The number of variables, n."""
    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower bounds, shape (n,)."""
    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper bounds, shape (n,)."""
    @property
    def budget(self) -> int:
        """Evaluations that the run may spend."""
    @property
    def remaining(self) -> int:
        """Evaluations that are left."""
    @property
    def evaluations(self) -> int:
        """Evaluations made."""
    @property
    def best(self) -> tuple[NDArray[np.float64], float] | None:
        """The best point so far, shape (n,), and its cost."""
    @property
    def has_subgradient(self) -> bool:
        """Whether there are subgradients."""
    @property
    def has_linearise(self) -> bool:
        """Whether the cost is a sum of terms with smooth pieces."""
    def __call__(self, x: ArrayLike) -> float:
        """The cost of a point, shape (n,): one evaluation."""
    def evaluate(self, x: ArrayLike) -> tuple[float, float]:
        """Cost and violation of a point: one evaluation."""
    def batch(self, x: ArrayLike) -> NDArray[np.float64]:
        """Costs of points, shape (m, n) to shape (m,): m evaluations."""
    def evaluate_batch(self, x: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Costs and violations of points: m evaluations."""
    def subgradient(self, x: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """The cost of a point within the box, with a subgradient: one evaluation."""
    def linearise(self, x: ArrayLike) -> Linearisation:
        """The cost of a point within the box as a sum of terms: one evaluation."""
    def _enter(self) -> None: ...

@final
class Task:
    def __new__(cls, path: str, text: str) -> Task: ...
    @staticmethod
    def read(path: str) -> Task: ...
    @property
    def path(self) -> str: ...
    @property
    def text(self) -> str: ...
    @property
    def robot(self) -> str: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def ranges(self) -> list[list[float]]: ...
    @property
    def limits(self) -> list[list[float]]: ...
    def to_toml(self) -> str: ...
    def formulations(self) -> list[str]: ...
    def problem(self, formulation: str) -> Problem: ...
    def motion(self, coefficients: list[float], duration: float | None) -> Motion: ...

@final
class Motion:
    @property
    def cost(self) -> float: ...
    @property
    def duration(self) -> float: ...
    @property
    def residual_deg(self) -> float: ...
    @property
    def reached(self) -> bool: ...
    @property
    def interrupted(self) -> bool: ...
    @property
    def remark(self) -> str | None: ...
    @property
    def is_warned_of(self) -> bool: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def units(self) -> list[str]: ...
    @property
    def limits(self) -> list[list[float]]: ...
    @property
    def goal_zyx(self) -> list[float]: ...
    @property
    def coefficients(self) -> NDArray[np.float64]: ...
    @property
    def json(self) -> dict[str, Any]: ...
    @property
    def state(self) -> tuple[str, str, list[float], float | None] | None: ...
    def sample(
        self, dt: float | None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], list[NDArray[np.float64]]]: ...
    def save(self, path: str, dt: float | None) -> None: ...
    def page(self) -> str: ...

@final
class Experiment:
    def __new__(cls, name: str) -> Experiment: ...
    @staticmethod
    def read(path: str) -> Experiment: ...
    @staticmethod
    def parse(path: str, text: str) -> Experiment: ...
    @property
    def name(self) -> str: ...
    @property
    def imported(self) -> str | None: ...
    @property
    def programs(self) -> list[tuple[str, bool]]: ...
    def with_seeds(self, seeds: int) -> Experiment: ...
    def with_budget(self, evaluations: int) -> Experiment: ...
    def without_optimisers(self) -> Experiment: ...
    def with_optimisers_of(self, other: Experiment) -> Experiment: ...
    def with_optimiser(
        self,
        name: str,
        label: str | None,
        identity_of: dict[str, Any],
        function: Callable[..., object],
        settings: dict[str, Any],
        formulation: str | None,
        needs_derivatives: bool,
        seeds: int | None,
        budget: int | None,
    ) -> Experiment: ...
    def with_function(
        self,
        name: str,
        identity_of: dict[str, Any],
        function: Callable[..., Any],
        is_batched: bool,
        lower: list[float],
        upper: list[float],
        least_cost: float | None,
        targets: list[float],
    ) -> Experiment: ...
    def with_problem(self, problem: Problem, label: str) -> Experiment: ...
    def run(
        self,
        out: str | None,
        jobs: int | None,
        again: str | None,
        begin: Callable[[Any, int, int, int], None],
        tick: Callable[[int, list[tuple[str, str, int, str, str]]], None],
    ) -> Results: ...

@final
class Results:
    @staticmethod
    def open(path: str) -> Results: ...
    @property
    def path(self) -> Path: ...
    @property
    def name(self) -> str: ...
    @property
    def instances(self) -> list[str]: ...
    @property
    def optimisers(self) -> list[str]: ...
    @property
    def counts(self) -> list[int]: ...
    @property
    def damage(self) -> list[str]: ...
    def captions(self) -> dict[str, str]: ...
    def names(self) -> list[str]: ...
    def table(self, name: str) -> bytes | None: ...
    def report(self, out: str | os.PathLike[str] | None, replace: bool) -> dict[str, Any]: ...
    def motion(self, label: str, task: Task | None) -> _Shown: ...

def end(seconds: float) -> None: ...
def command(arguments: list[str]) -> int: ...
def check_optimiser(name: str) -> None: ...
def problems(path: str, text: str, formulation: str) -> list[Problem]: ...
def plan(
    task: Task,
    by: str,
    seed: int,
    budget: int,
    family_name: str | None,
    pieces: int | None,
    degree: int | None,
    progress: Callable[[int], None],
) -> Motion: ...
