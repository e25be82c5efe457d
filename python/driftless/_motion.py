"""Motions of a task."""

from __future__ import annotations

import html
import os
from copy import deepcopy
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from . import _driftless

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

__all__ = ["Motion", "Samples"]

_Array = NDArray[np.float64]


@dataclass(frozen=True)
class Samples:
    """A motion at ``n`` times.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time since the start [s].
    joints : tuple of str
        The joints' names, from the base outward.
    units : tuple of str
        ``"rad"`` of joints that turn, ``"m"`` of joints that slide.
    angle, rate, acceleration, jerk : ndarray, shape (n, joints)
        Position of every joint and its derivatives, in its unit and seconds.
    torque : ndarray, shape (n, joints)
        Torque of every joint [N m], or force [N] where it slides.
    base : ndarray, shape (n, 4)
        The base's attitude as a unit quaternion (w, x, y, z), base axes into inertial axes.
    base_zyx : ndarray, shape (n, 3)
        The same as ZYX Euler angles: yaw, pitch, roll [rad], without jumps of a full turn.
    base_position : ndarray, shape (n, 3)
        The base's centre of mass in inertial axes, whose origin is where it is at the start [m].
    base_rate : ndarray, shape (n, 3)
        The base's angular velocity in base axes [rad/s].
    """

    time: _Array
    joints: tuple[str, ...]
    units: tuple[str, ...]
    angle: _Array
    rate: _Array
    acceleration: _Array
    jerk: _Array
    torque: _Array
    base: _Array
    base_zyx: _Array
    base_position: _Array
    base_rate: _Array

    def __len__(self) -> int:
        return len(self.time)

    def __repr__(self) -> str:
        end = self.time[-1]
        return f"<driftless.Samples: {len(self)} times from 0 to {end:.3f} s, {len(self.joints)} joints>"

    def to_polars(self) -> pl.DataFrame:
        """The samples as a table with one row per time and joint, as `Motion.save` writes it."""
        joints = len(self.joints)
        columns: dict[str, Any] = {"time": np.repeat(self.time, joints), "joint": list(self.joints) * len(self)}
        if "m" in self.units:
            columns["unit"] = list(self.units) * len(self)
        for name in ("angle", "rate", "acceleration", "jerk"):
            columns[name] = getattr(self, name).ravel()

        def add_base(numbers: _Array, *names: str) -> None:
            for k, name in enumerate(names):
                columns[name] = np.repeat(numbers[:, k], joints)

        add_base(self.base, "base_w", "base_x", "base_y", "base_z")
        columns["torque"] = self.torque.ravel()
        add_base(self.base_zyx, "base_yaw", "base_pitch", "base_roll")
        add_base(self.base_position, "base_position_x", "base_position_y", "base_position_z")
        add_base(self.base_rate, "base_rate_x", "base_rate_y", "base_rate_z")
        return pl.DataFrame(columns)

    def to_pandas(self) -> pd.DataFrame:
        """The same table for pandas, which has to be installed."""
        import pandas as pd

        return pd.DataFrame(self.to_polars().to_dict(as_series=False))


class Motion:
    """A motion of a task: where the joints go, and what is known of it.

    `plan` makes motions, as do `Problem.motion` and `Result.motion`. All numbers are certified: evaluated ever more finely
    until they no longer change.
    """

    def __init__(
        self, core: _driftless.Motion, told: dict[str, Any] | None = None, remark: str | None = None
    ) -> None:
        self._core = core
        self._told: dict[str, Any] = core.json if told is None else told
        self._remark = core.remark if remark is None else remark

    @property
    def cost(self) -> float:
        """The cost J (eq. 25)."""
        return self._core.cost

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return self._core.duration

    @property
    def residual_deg(self) -> float:
        """How far the base ends from its goal [°]."""
        return self._core.residual_deg

    @property
    def reached(self) -> bool:
        """Whether the base ends at its goal, and all limits and ranges are kept."""
        return self._core.reached

    @property
    def within_limits(self) -> bool:
        """Whether all limits and ranges are kept."""
        return bool(self._told["within_limits"])

    @property
    def status(self) -> str:
        """``"reached"``, ``"not-found"`` where another motion may reach the goal, or ``"out-of-reach"`` where none does."""
        return str(self._told["status"])

    @property
    def remark(self) -> str | None:
        """Why the goal is missed, or what may make the motion better."""
        return self._remark

    @property
    def interrupted(self) -> bool:
        """Whether the search was interrupted."""
        return self._core.interrupted

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints' names, from the base outward."""
        return tuple(self._core.joints)

    @property
    def coefficients(self) -> _Array:
        """The motion's coefficients in its family, shape (joints that follow no other, coefficients per joint)."""
        return self._core.coefficients

    @property
    def peaks(self) -> dict[str, _Array]:
        """Largest ``rate_deg_s``, ``acceleration_deg_s2`` and ``jerk_deg_s3`` of every joint, shape (joints,).

        Where a joint slides, ``rate``, ``acceleration`` and ``jerk``, in degrees or metres by joint.
        """
        return {name: np.array(values) for name, values in self._told["peaks"].items() if name != "unit"}

    @property
    def largest_base_turn_deg(self) -> float:
        """How far the base turns from its attitude at the start on the way, at most [°]."""
        return float(self._told["largest_base_turn_deg"])

    def as_dict(self) -> dict[str, Any]:
        """All that is known of it: the fields that ``driftless plan --json`` prints."""
        return deepcopy(self._told)

    def sample(self, dt: float | None = None) -> Samples:
        """The motion at times from its start to its end.

        Parameters
        ----------
        dt : float, optional
            Time between samples [s]. The last sample is always the end; one less than a tenth of `dt` before it is left out. Without it,
            500 equal steps, of splines the next multiple of their pieces.

        Returns
        -------
        Samples
        """
        time, of_joints, of_base = self._core.sample(dt)
        return Samples(time, self.joints, tuple(self._core.units), *of_joints, *of_base)

    def to_polars(self, dt: float | None = None) -> pl.DataFrame:
        """The samples as a table with one row per time and joint; `dt` as for `sample`."""
        return self.sample(dt).to_polars()

    def to_pandas(self, dt: float | None = None) -> pd.DataFrame:
        """The same table for pandas, which has to be installed."""
        return self.sample(dt).to_pandas()

    def save(self, path: str | os.PathLike[str], dt: float | None = None) -> None:
        """Writes the samples into a file.

        Parameters
        ----------
        path : path-like
            A name in ``.csv`` or ``.parquet`` (a row for each time and joint), ``.wide.csv`` (a row for each time), ``.mat`` (MATLAB),
            ``.yaml`` (ROS JointTrajectory), ``.goal.yaml`` (goal of ROS 2's FollowJointTrajectory) or ``.mujoco`` (a folder that plays it
            in MuJoCo); ``docs/motions.md`` has all columns.
        dt : float, optional
            As for `sample`.
        """
        self._core.save(os.fspath(path), dt)

    def save_page(self, path: str | os.PathLike[str]) -> None:
        """Writes a page that shows the motion in three dimensions; it holds all its data and loads nothing."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._core.page())

    def plot(self, dt: float | None = None) -> Figure:
        """Draws joint angles, their rates, accelerations and jerks with the limits, and the base's attitude with its goal.

        Needs matplotlib. The panels are those of Figures 4, 5 and 6 of Xiao et al. (2023).

        Returns
        -------
        matplotlib.figure.Figure
        """
        from ._plot import plot

        return plot(self, dt)

    def __reduce__(self) -> tuple[Any, ...]:
        from ._restore import motion

        if self._core.state is None:
            raise TypeError("a motion of an experiment cannot be pickled; its task's file can, with `coefficients`")
        return (motion, (*self._core.state, self._told, self.remark))

    def __repr__(self) -> str:
        verdict = "reaches its goal" if self.reached else f"misses its goal by {self.residual_deg:.3g}°"
        return f"<driftless.Motion: {self.duration:.4f} s, J {self.cost:.6f}, {verdict}>"

    def _repr_html_(self) -> str:
        page = html.escape(self._core.page(), quote=True)
        return (
            f"<p>{html.escape(repr(self)[1:-1])}</p>"
            f'<iframe srcdoc="{page}" style="width:100%;height:640px;border:0" loading="lazy"></iframe>'
        )
