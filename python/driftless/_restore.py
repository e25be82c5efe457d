"""How pickled objects come back."""

from __future__ import annotations

from typing import Any

from . import _driftless
from ._driftless import Problem
from ._motion import Motion
from ._task import Task

__all__ = ["experiment_problem", "motion", "task", "task_problem"]


def task(home: str, text: str) -> Task:
    return Task._of(_driftless.Task(home, text), home)


def task_problem(path: str, text: str, formulation: str) -> Problem:
    return _driftless.Task(path, text).problem(formulation)


def experiment_problem(path: str, text: str, instance: int, formulation: str) -> Problem:
    return _driftless.problems(path, text, formulation)[instance]


def motion(
    path: str,
    text: str,
    coefficients: list[float],
    duration: float | None,
    told: dict[str, Any],
    remark: str | None,
) -> Motion:
    return Motion(_driftless.Task(path, text).motion(coefficients, duration), told, remark)
