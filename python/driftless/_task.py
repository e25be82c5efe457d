"""Tasks: what is to be planned."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _driftless
from ._driftless import Problem
from ._errors import InputError
from ._toml import document

__all__ = ["Task"]

_Limit = float | Sequence[float]


class Task:
    """A robot that is to turn its base: start, goal, limits, weights, and the family of motions that is searched.

    What is not stated is taken from the task of Xiao et al. (2023), as in the files of the command. For another robot than theirs,
    start, goal and limits have to be stated. Angles are in degrees, joints in their order from the base outward.

    Parameters
    ----------
    robot : str or path-like, optional
        A robot that comes with the package, or a file.
    start_joints_deg, goal_joints_deg : sequence of float, shape (joints,), optional
        Joint angles at the start and at the goal [°].
    start_base_zyx_deg, goal_base_zyx_deg : sequence of float, shape (3,), optional
        The base's attitude as ZYX Euler angles, yaw, pitch and roll [°].
    tolerance_deg : float, optional
        How far the base may end from its goal [°].
    rate_limit_deg_s, acceleration_limit_deg_s2, jerk_limit_deg_s3 : float or sequence of float, optional
        Limits of all joints, or one for each [°/s, °/s², °/s³].
    base_weight : float, optional
        Weight of the base's error in the cost, 0 to 1; that of time is what is left.
    family : {"spline", "sine-polynomial"}, optional
        Whose motions are searched.
    terms : int, optional
        Free coefficients per joint of a sine polynomial.
    pieces, degree : int, optional
        Pieces and degree of a spline.

    Examples
    --------
    >>> import driftless
    >>> task = driftless.Task(jerk_limit_deg_s3=80)
    >>> task
    <driftless.Task of xiao2023, 6 joints>
    >>> task.problem("time-free").dimension
    12
    """

    _core: _driftless.Task
    # What robots are sought beside, wherever the process is later.
    _home: str

    def __init__(
        self,
        *,
        robot: str | os.PathLike[str] | None = None,
        start_joints_deg: Sequence[float] | None = None,
        start_base_zyx_deg: Sequence[float] | None = None,
        goal_joints_deg: Sequence[float] | None = None,
        goal_base_zyx_deg: Sequence[float] | None = None,
        tolerance_deg: float | None = None,
        rate_limit_deg_s: _Limit | None = None,
        acceleration_limit_deg_s2: _Limit | None = None,
        jerk_limit_deg_s3: _Limit | None = None,
        base_weight: float | None = None,
        family: str | None = None,
        terms: int | None = None,
        pieces: int | None = None,
        degree: int | None = None,
    ) -> None:
        if robot is not None:
            robot = os.path.abspath(robot) if os.path.exists(robot) else os.fspath(robot)
        keywords = {
            "robot": ("task.robot", robot),
            "start_joints_deg": ("task.start.joints_deg", start_joints_deg),
            "start_base_zyx_deg": ("task.start.base_zyx_deg", start_base_zyx_deg),
            "goal_joints_deg": ("task.goal.joints_deg", goal_joints_deg),
            "goal_base_zyx_deg": ("task.goal.base_zyx_deg", goal_base_zyx_deg),
            "tolerance_deg": ("task.goal.tolerance_deg", tolerance_deg),
            "rate_limit_deg_s": ("task.limits.rate_deg_s", rate_limit_deg_s),
            "acceleration_limit_deg_s2": ("task.limits.acceleration_deg_s2", acceleration_limit_deg_s2),
            "jerk_limit_deg_s3": ("task.limits.jerk_deg_s3", jerk_limit_deg_s3),
            "base_weight": ("task.weights.base", base_weight),
            "family": ("trajectory.family", family),
            "terms": ("trajectory.terms", terms),
            "pieces": ("trajectory.pieces", pieces),
            "degree": ("trajectory.degree", degree),
        }
        stated = {name: pair for name, pair in keywords.items() if pair[1] is not None}
        try:
            self._core = _driftless.Task("Task", document(dict(stated.values())))
        except InputError as error:
            if error.line is None or error.file != "Task":
                raise
            # One line per keyword.
            name = list(stated)[error.line - 1]
            raise InputError(f"{name}: {error.message}", hint=error.hint) from None
        self._home = "Task"

    @classmethod
    def _of(cls, core: _driftless.Task, home: str) -> Task:
        task = cls.__new__(cls)
        task._core, task._home = core, home
        return task

    @classmethod
    def from_file(cls, path: str | os.PathLike[str]) -> Task:
        """A task from a file, as `driftless plan` takes it.

        Parameters
        ----------
        path : path-like
            The file. Robots that it names are sought beside it.

        Raises
        ------
        InputError
            The file cannot be read or used.
        """
        return cls._of(_driftless.Task.read(os.fspath(path)), os.path.abspath(path))

    @classmethod
    def from_toml(cls, text: str, path: str | os.PathLike[str] = "task.toml") -> Task:
        """A task from the text of a file.

        Parameters
        ----------
        text : str
            TOML.
        path : path-like, optional
            What errors call it, and beside what robots are sought. The file need not exist.

        Raises
        ------
        InputError
            The text cannot be used.
        """
        return cls._of(_driftless.Task(os.fspath(path), text), os.path.abspath(path))

    @property
    def robot(self) -> str:
        """The robot's name."""
        return self._core.robot

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints' names, from the base outward."""
        return tuple(self._core.joints)

    @property
    def limits(self) -> NDArray[np.float64]:
        """Largest rate, acceleration and jerk of every joint, shape (joints, 3) [rad/s, rad/s², rad/s³]."""
        return np.array(self._core.limits)

    @property
    def ranges(self) -> NDArray[np.float64]:
        """Least and largest angle of every joint, shape (joints, 2) [rad]."""
        return np.array(self._core.ranges)

    @property
    def formulations(self) -> tuple[str, ...]:
        """The variables that it can be searched in, the preferred ones first."""
        return tuple(self._core.formulations())

    def problem(self, formulation: str | None = None) -> Problem:
        """The task as a cost to minimise in a box.

        Parameters
        ----------
        formulation : {"time-free", "scaled", "raw"}, optional
            The variables: the shape alone, in the shortest time within the limits; shape and duration; the paper's powers of time
            and duration. Without one, the first of `formulations`.

        Returns
        -------
        Problem
        """
        return self._core.problem(formulation or "")

    def to_toml(self) -> str:
        """The task as a file, with every default written out."""
        return self._core.to_toml()

    def __reduce__(self) -> tuple[Any, ...]:
        from ._restore import task

        return (task, (self._home, self._core.text))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Task):
            return NotImplemented
        return (self._home, self._core.text) == (other._home, other._core.text)

    def __hash__(self) -> int:
        return hash((self._home, self._core.text))

    def __repr__(self) -> str:
        return f"<driftless.Task of {self.robot}, {len(self.joints)} joints>"
