"""Test functions and the problems of experiment files."""

from __future__ import annotations

import os
from collections.abc import Sequence

from . import _driftless
from ._driftless import Problem
from ._toml import value

__all__ = ["functions", "problems"]

_FIELD = "\n[[optimiser]]\nrandom = {}\n"


def functions(
    name: str | Sequence[str], dimension: int | Sequence[int] = 10, instances: int = 1
) -> list[Problem]:
    """Test functions, shifted and rotated, with a least value of zero.

    Parameters
    ----------
    name : str or sequence of str
        ``"sphere"``, ``"rosenbrock"``, ``"rastrigin"``, ``"ackley"`` and others; `driftless list` shows them.
    dimension : int or sequence of int, optional
        Numbers of variables.
    instances : int, optional
        How many shifts and rotations of each.

    Returns
    -------
    list of Problem

    Examples
    --------
    >>> import driftless
    >>> for problem in driftless.functions(["sphere", "ackley"], dimension=5):
    ...     problem
    <driftless.Problem sphere dimension=5 instance=1, 5 variables>
    <driftless.Problem ackley dimension=5 instance=1, 5 variables>
    """
    names = [name] if isinstance(name, str) else list(name)
    dimensions = [dimension] if isinstance(dimension, int) else list(dimension)
    table = f"name = {value(names)}\ndimension = {value(dimensions)}\ninstances = {value(instances)}\n"
    text = f'name = "functions"\n\n[functions]\n{table}{_FIELD}'
    return _driftless.problems(os.path.abspath("functions"), text, "")


def problems(path: str | os.PathLike[str], formulation: str | None = None) -> list[Problem]:
    """The problems that an experiment file asks for, one per instance.

    Parameters
    ----------
    path : path-like
        The file.
    formulation : str, optional
        As for `Task.problem`.

    Returns
    -------
    list of Problem
    """
    with open(path, encoding="utf-8") as file:
        return _driftless.problems(os.path.abspath(path), file.read(), formulation or "")
