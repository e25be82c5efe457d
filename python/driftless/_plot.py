"""Figures of a motion by matplotlib."""

from __future__ import annotations

import sys
from importlib import import_module
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._motion import Motion

__all__ = ["plot"]


def plot(motion: Motion, dt: float | None) -> Figure:
    """Joint angles, their derivatives with the limits, and the base's attitude with its goal."""
    if "IPython" in sys.modules:
        # With pyplot a notebook learns how to show figures.
        import_module("matplotlib.pyplot")
    from matplotlib.figure import Figure

    samples = motion.sample(dt)
    # Joints that slide keep their metres.
    slides = np.array([unit == "m" for unit in motion._core.units])
    scale = np.where(slides, 1.0, np.degrees(1.0))
    limits = np.asarray(motion._core.limits) * scale[:, None]
    unit = "m" if slides.all() else "° or m" if slides.any() else "°"
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    panels = figure.subplots(3, 2, sharex=True).flat
    rows = [
        (f"{'position' if slides.any() else 'angle'} [{unit}]", samples.angle, None),
        (f"rate [{unit}/s]", samples.rate, 0),
        (f"acceleration [{unit}/s²]", samples.acceleration, 1),
        (f"jerk [{unit}/s³]", samples.jerk, 2),
    ]
    for (label, values, order), axes in zip(rows, panels):
        for joint, (name, line) in enumerate(zip(samples.joints, (values * scale).T)):
            axes.plot(samples.time, line, color=f"C{joint}", label=name)
        if order is not None:
            for limit in sorted(set(limits[:, order])):
                axes.axhline(limit, color="0.4", lw=0.8, ls=":")
                axes.axhline(-limit, color="0.4", lw=0.8, ls=":")
        axes.set_ylabel(label)
    axes = next(panels)
    goal = np.degrees(motion._core.goal_zyx)
    for k, name in enumerate(("yaw", "pitch", "roll")):
        angles = np.degrees(samples.base_zyx[:, k])
        axes.plot(samples.time, angles, color=f"C{k}", label=name)
        axes.axhline(goal[k], color=f"C{k}", lw=0.8, ls=":")
    axes.set_ylabel("base [°]")
    axes.legend(fontsize="small")
    legend = next(panels)
    legend.axis("off")
    legend.legend(*figure.axes[0].get_legend_handles_labels(), loc="center", ncols=2, title="joints")
    for axes in figure.axes[3:5]:
        axes.set_xlabel("time [s]")
        axes.tick_params(labelbottom=True)
    figure.suptitle(f"{motion.duration:.3f} s, base {motion.residual_deg:.2g}° from its goal")
    return figure
