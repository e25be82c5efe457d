"""Planning one task."""

from __future__ import annotations

import logging
import os

from . import _driftless
from ._errors import check_count
from ._motion import Motion
from ._progress import Progress
from ._task import Task

__all__ = ["plan"]

_log = logging.getLogger("driftless")


def plan(
    task: Task | str | os.PathLike[str] | None = None,
    *,
    optimiser: str = "scp",
    seed: int = 1,
    budget: int = 150_000,
    family: str | None = None,
    pieces: int | None = None,
    degree: int | None = None,
    progress: bool = True,
) -> Motion:
    """The best motion of a task, as ``driftless plan`` finds it.

    Parameters
    ----------
    task : Task or path-like, optional
        The task, or its file; without one, the task of Xiao et al. (2023).
    optimiser : str, optional
        The name of an optimiser of the package. Others than ``"scp"`` search sine polynomials unless told otherwise.
    seed : int, optional
        Seed of the random numbers.
    budget : int, optional
        Evaluations to spend at most.
    family : {"spline", "sine-polynomial"}, optional
        Whose motions are searched, instead of what the task says.
    pieces, degree : int, optional
        Pieces and degree of a spline, instead of what the task says.
    progress : bool, optional
        Whether to show a bar.

    Returns
    -------
    Motion

    Raises
    ------
    AlreadyThere
        There is nothing to plan.
    SearchError
        No motion was found.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import driftless
    >>> motion = driftless.plan(optimiser="nelder-mead", budget=2000)
    >>> motion.joints[0], motion.sample(0.1).angle.shape[1]
    ('joint1', 6)
    """
    check_count("seed", seed, 2**64 - 1, least=0)
    check_count("budget", budget, 2**64 - 1, least=0)
    if task is None:
        task = Task()
    elif not isinstance(task, Task):
        task = Task.from_file(task)
    bar = Progress(progress, "planning")
    bar.begin(budget)
    try:
        core = _driftless.plan(task._core, optimiser, seed, budget, family, pieces, degree, bar.update)
    finally:
        bar.end()
    motion = Motion(core)
    if motion.remark is not None:
        _log.log(logging.WARNING if core.is_warned_of else logging.INFO, "%s", motion.remark)
    return motion
