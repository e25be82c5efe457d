"""Figures of one motion, from the table that `driftless plan --motion` writes."""

import numpy as np
import polars as pl
from matplotlib import pyplot as plt

from driftless_results import TWO_COLUMNS

KINDS = {"rate": "°/s", "acceleration": "°/s²", "jerk": "°/s³"}


def read_motion(path):
    """Times [s]; angle, rate, acceleration and jerk, a row per time and a column per joint [rad, s]; and the
    base's quaternion w, x, y, z, a row per time."""
    rows = pl.read_csv(path)
    joints = rows["joint"].n_unique()
    columns = {kind: rows[kind].to_numpy().reshape(-1, joints) for kind in ["angle", *KINDS]}
    once = rows.gather_every(joints)
    base = once.select("base_w", "base_x", "base_y", "base_z").to_numpy()
    return {"time": once["time"].to_numpy(), **columns, "base": base}


def zyx_deg(base):
    """Yaw, pitch and roll [°] of quaternions w, x, y, z."""
    w, x, y, z = base.T
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    pitch = np.arcsin(2 * (w * y - z * x))
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    return np.degrees([yaw, pitch, roll]).T


def draw_angles(axes, motion):
    """Joint angles over time, a line per joint."""
    axes.plot(motion["time"], np.degrees(motion["angle"]))
    axes.set(xlabel="time [s]", ylabel="joint angle [°]")


def draw_attitude(axes, motion):
    """Yaw, pitch and roll of the base over time."""
    lines = axes.plot(motion["time"], zyx_deg(motion["base"]))
    axes.set(xlabel="time [s]", ylabel="base attitude [°]")
    axes.legend(lines, ["yaw", "pitch", "roll"])


def derivatives_figure(motion, limits):
    """Rates, accelerations and jerks, with their limits [°, s] as dotted lines."""
    figure, axes = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.6))
    for panel, (kind, unit), limit in zip(axes, KINDS.items(), limits):
        lines = panel.plot(motion["time"], np.degrees(motion[kind]))
        for bound in (-limit, limit):
            panel.axhline(bound, color="black", linewidth=0.8, linestyle=":")
        panel.set(xlabel="time [s]", ylabel=f"{kind} [{unit}]")
    names = [f"joint {i}" for i in range(1, len(lines) + 1)]
    figure.legend(lines, names, loc="outside upper center", ncols=len(names))
    return figure
