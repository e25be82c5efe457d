"""Tasks: what is to be planned."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _driftless
from ._driftless import Problem
from ._errors import made_text
from ._toml import document

__all__ = ["Task"]

_Joints = Sequence[float] | Mapping[str, float]
_Limit = float | _Joints


class Task:
    """A robot that is to turn its base: start, goal, limits, weights, and the family of motions that is searched.

    What is not stated is that of the task which the robot comes with, if it comes with the package; without a robot it is the task of
    Xiao et al. (2023). For a robot of your own, start, goal and limits have to be stated. Joints are listed in the robot's order, or
    given by name. Keywords with ``_deg`` are for robots whose joints all turn; those without take metres of joints that slide.

    Parameters
    ----------
    robot : str or path-like, optional
        A robot that comes with the package, a robot file or a URDF.
    locked : sequence of str or mapping, optional
        Joints that do not move: at zero or the nearest end of their range, or at these positions [° or m].
    follow : mapping, optional
        Joints that follow others: the other joint's name, or ``joint``, ``multiplier``, and ``offset_deg`` or ``offset_m``.
    base : mapping, optional
        A base for a robot without one: ``mass`` [kg], ``inertia`` with ``xx``, ``yy``, ``zz``, ``xy``, ``xz``, ``yz`` [kg m²], ``mount`` [m],
        ``mount_zyx_deg``.
    payload : mapping, optional
        A body that the robot carries: ``mass`` [kg], ``inertia`` [kg m²], ``centre_of_mass`` [m], ``link``; on the tool without one.
    start_joints_deg, goal_joints_deg : sequence of float, shape (joints,), or mapping, optional
        Joint angles at the start and at the goal [°].
    start_joints, goal_joints : sequence of float, shape (joints,), or mapping, optional
        The same in degrees or metres, by joint.
    start_base_zyx_deg, goal_base_zyx_deg : sequence of float, shape (3,), optional
        The base's attitude as ZYX Euler angles, yaw, pitch and roll [°].
    tolerance_deg : float, optional
        How far the base may end from its goal [°].
    rate_limit_deg_s, acceleration_limit_deg_s2, jerk_limit_deg_s3 : float, sequence of float or mapping, optional
        Limits of all joints, or one for each [°/s, °/s², °/s³].
    rate_limit, acceleration_limit, jerk_limit : float, sequence of float or mapping, optional
        The same in degrees or metres, by joint.
    base_turn_deg, base_rate_deg_s, tool_speed_m_s, clearance_m : float, optional
        Limits on the way: the base's turn [°] and angular rate [°/s], the tool's speed [m/s], the distance between bodies [m].
    base_turn_from : {"nearer", "start", "goal"}, optional
        The attitude that turns on the way are measured from.
    base_cone : mapping or sequence of mapping, optional
        Where axes of the base may point: ``axis`` in base axes, ``from`` in inertial axes, ``within_deg`` or ``outside_deg``.
    torque_n_m : float, sequence of float or mapping, optional
        Largest torque of all joints, or one for each [N·m, N where it slides].
    keep_out : mapping, optional
        Solids by name: ``frame``, ``"inertial"`` or ``"base"``, and ``shapes``.
    largest_turn_weight, mean_turn_weight : float, optional
        What a degree of the largest and of the mean turn on the way adds to the cost.
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
        locked: Sequence[str] | Mapping[str, float] | None = None,
        follow: Mapping[str, str | Mapping[str, Any]] | None = None,
        base: Mapping[str, Any] | None = None,
        payload: Mapping[str, Any] | None = None,
        start_joints_deg: _Joints | None = None,
        start_joints: _Joints | None = None,
        start_base_zyx_deg: Sequence[float] | None = None,
        goal_joints_deg: _Joints | None = None,
        goal_joints: _Joints | None = None,
        goal_base_zyx_deg: Sequence[float] | None = None,
        tolerance_deg: float | None = None,
        rate_limit_deg_s: _Limit | None = None,
        rate_limit: _Limit | None = None,
        acceleration_limit_deg_s2: _Limit | None = None,
        acceleration_limit: _Limit | None = None,
        jerk_limit_deg_s3: _Limit | None = None,
        jerk_limit: _Limit | None = None,
        base_turn_deg: float | None = None,
        base_turn_from: str | None = None,
        base_cone: Mapping[str, Any] | Sequence[Mapping[str, Any]] | None = None,
        base_rate_deg_s: float | None = None,
        tool_speed_m_s: float | None = None,
        torque_n_m: _Limit | None = None,
        clearance_m: float | None = None,
        keep_out: Mapping[str, Any] | None = None,
        largest_turn_weight: float | None = None,
        mean_turn_weight: float | None = None,
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
            "locked": ("task.locked", locked),
            "follow": ("task.follow", follow),
            "base": ("task.base", base),
            "payload": ("task.payload", payload),
            "start_joints": ("task.start.joints", start_joints),
            "goal_joints": ("task.goal.joints", goal_joints),
            "rate_limit": ("task.limits.rate", rate_limit),
            "acceleration_limit": ("task.limits.acceleration", acceleration_limit),
            "jerk_limit": ("task.limits.jerk", jerk_limit),
            "start_joints_deg": ("task.start.joints_deg", start_joints_deg),
            "start_base_zyx_deg": ("task.start.base_zyx_deg", start_base_zyx_deg),
            "goal_joints_deg": ("task.goal.joints_deg", goal_joints_deg),
            "goal_base_zyx_deg": ("task.goal.base_zyx_deg", goal_base_zyx_deg),
            "tolerance_deg": ("task.goal.tolerance_deg", tolerance_deg),
            "rate_limit_deg_s": ("task.limits.rate_deg_s", rate_limit_deg_s),
            "acceleration_limit_deg_s2": ("task.limits.acceleration_deg_s2", acceleration_limit_deg_s2),
            "jerk_limit_deg_s3": ("task.limits.jerk_deg_s3", jerk_limit_deg_s3),
            "base_turn_deg": ("task.limits.base_turn_deg", base_turn_deg),
            "base_turn_from": ("task.limits.base_turn_from", base_turn_from),
            "base_cone": ("task.limits.base_cone", base_cone),
            "base_rate_deg_s": ("task.limits.base_rate_deg_s", base_rate_deg_s),
            "tool_speed_m_s": ("task.limits.tool_speed_m_s", tool_speed_m_s),
            "torque_n_m": ("task.limits.torque_n_m", torque_n_m),
            "clearance_m": ("task.limits.clearance_m", clearance_m),
            "keep_out": ("task.keep_out", keep_out),
            "largest_turn_weight": ("task.weights.largest_turn", largest_turn_weight),
            "mean_turn_weight": ("task.weights.mean_turn", mean_turn_weight),
            "base_weight": ("task.weights.base", base_weight),
            "family": ("trajectory.family", family),
            "terms": ("trajectory.terms", terms),
            "pieces": ("trajectory.pieces", pieces),
            "degree": ("trajectory.degree", degree),
        }
        stated = {name: pair for name, pair in keywords.items() if pair[1] is not None}
        # As errors call them.
        keys = {path.removeprefix("task."): name for name, (path, _) in keywords.items()}
        with made_text("Task", stated, keys):
            self._core = _driftless.Task("Task", document(dict(stated.values())))
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
        """Largest rate, acceleration and jerk of every joint, shape (joints, 3) [rad or m, and s]."""
        return np.array(self._core.limits)

    @property
    def ranges(self) -> NDArray[np.float64]:
        """Least and largest position of every joint, shape (joints, 2) [rad or m]."""
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
