"""Figures of one motion."""

from collections.abc import Sequence

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from driftless import Samples
from driftless_results import TWO_COLUMNS


def draw_angles(axes: Axes, motion: Samples) -> None:
    """Joint angles over time, a line per joint."""
    axes.plot(motion.time, np.degrees(motion.angle))
    axes.set(xlabel="time [s]", ylabel="joint angle [°]")


def draw_attitude(axes: Axes, motion: Samples) -> None:
    """Yaw, pitch and roll of the base over time."""
    lines = axes.plot(motion.time, np.degrees(motion.base_zyx))
    axes.set(xlabel="time [s]", ylabel="base attitude [°]")
    axes.legend(lines, ["yaw", "pitch", "roll"])


def derivatives_figure(motion: Samples, limits: Sequence[float]) -> Figure:
    """Rates, accelerations and jerks, with their limits [°, s] as dotted lines."""
    figure, axes = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.6))
    kinds = [("rate", "°/s", motion.rate), ("acceleration", "°/s²", motion.acceleration), ("jerk", "°/s³", motion.jerk)]
    for panel, (kind, unit, values), limit in zip(axes, kinds, limits):
        panel.plot(motion.time, np.degrees(values))
        for bound in (-limit, limit):
            panel.axhline(bound, color="black", linewidth=0.8, linestyle=":")
        panel.set(xlabel="time [s]", ylabel=f"{kind} [{unit}]")
    names = [f"joint {i}" for i in range(1, len(motion.joints) + 1)]
    figure.legend(axes[0].lines[: len(names)], names, loc="outside upper center", ncols=len(names))
    return figure
