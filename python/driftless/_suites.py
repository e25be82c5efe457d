"""Test functions and the problems of experiment files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from . import _driftless
from ._driftless import Problem
from ._errors import InputError, made_text
from ._toml import document

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
    dimensions = np.atleast_1d(dimension).tolist()
    keys = {"name": names, "dimension": dimensions, "instances": instances}
    table = document({f"functions.{key}": x for key, x in keys.items()})
    with made_text("functions", keys):
        return _driftless.problems("functions", f'{table}name = "functions"\n{_FIELD}', "")


def problems(path: str | os.PathLike[str], formulation: str | None = None) -> list[Problem]:
    """The problems that an experiment file asks for, one per instance; in a race they have the file's labels, targets and budgets.

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
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {error}", os.fspath(path)) from error
    return _driftless.problems(os.path.abspath(path), text, formulation or "")
