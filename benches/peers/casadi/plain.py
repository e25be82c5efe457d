"""The program as one writes it with CasADi: its cost and its rows, and no word of derivatives.

All is one SX expression. CasADi differentiates it twice and evaluates what comes out by its virtual
machine.
"""

import casadi as ca

from expressions import NODES, STEPS, base_rate, increment, left, limit_times
from model import basis


def plain(task):
    """The program for `nlpsol`, and no derivatives of its own."""
    joints, terms = len(task.links), task.terms
    x = ca.SX.sym("x", joints * terms + 1)
    own, duration = ca.vertsplit(x[:-1], terms), x[-1]
    rows = [error(task, own)]
    for joint, c in enumerate(own):
        for order in (1, 2, 3):
            derivative = path(task, joint, c, limit_times(order))[order]
            rows.append(derivative / (task.limits[order - 1] * duration**order))
    return {"x": x, "f": task.time_weight * duration, "g": ca.vertcat(*rows)}, {}


def path(task, joint, c, tau):
    """A joint's angle and three derivatives by `τ` (eqs. 11–14), one row per time."""
    bumps, step = basis(task.terms, tau)
    change = task.phase_change[joint]
    s, s1, s2, s3 = (ca.DM(b.T) @ c + change * f for b, f in zip(bumps, step))
    s += task.start_phase[joint]
    sin, cos, amplitude = ca.sin(s), ca.cos(s), task.amplitude[joint]
    shape = [sin, cos * s1, cos * s2 - sin * s1**2, cos * (s3 - s1**3) - 3 * sin * s1 * s2]
    angle, *derivatives = (amplitude * f for f in shape)
    return [angle + task.centre[joint], *derivatives]


def error(task, own):
    """The base's error `δq_b` at the end of the paths with these coefficients, one column per joint."""
    paths = [path(task, joint, c, NODES) for joint, c in enumerate(own)]
    angles, rates, *_ = zip(*paths)
    y = ca.horzcat(*angles, *rates).T
    base_rates = ca.reshape(base_rate(task).map(len(NODES))(y), 9, STEPS)
    attitude, turn = ca.SX(task.start_base), increment(1 / STEPS)
    for three in ca.horzsplit(base_rates):
        attitude = left(attitude) @ turn(three)
    return attitude[1:]
