"""The pieces of the nonlinear program as small functions of CasADi expressions, with derivatives."""

import casadi as ca
import numpy as np

STEPS = 24
"""Magnus steps of sixth order, as many as `scp` makes."""

NODES = np.add.outer(np.arange(STEPS), 0.5 + np.sqrt(15) / 10 * np.arange(-1, 2)).ravel() / STEPS
"""Times of the three Gauss nodes of every step."""

GRID = (100, 20, 40)
"""Intervals of the equal grids on which rates, accelerations and jerks are limited."""


def limit_times(order):
    """The times at which the derivative of this order is limited."""
    times = np.linspace(0, 1, GRID[order - 1] + 1)
    # At both ends rate and acceleration are zero whatever the coefficients.
    return times if order == 3 else times[1:-1]


def base_rate(task):
    """Function of `y = (angles, rates)`: the base's angular rate at zero momentum (eqs. 5–7)."""
    count = len(task.links)
    y = ca.SX.sym("y", 2 * count)
    turned, place = ca.SX.eye(3), ca.SX(task.mount)
    omega, velocity = ca.SX.zeros(3), ca.SX.zeros(3)
    bodies = [(task.base_mass, ca.SX.zeros(3), velocity, omega, ca.SX(task.base_inertia))]
    for link, angle, rate in zip(task.links, ca.vertsplit(y[:count]), ca.vertsplit(y[count:])):
        c, s = ca.cos(angle), ca.sin(angle)
        omega = omega + turned[:, 2] * rate
        turned = turned @ ca.blockcat([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        arm, step = turned @ link.centre_of_mass, turned @ link.step
        there = turned @ link.inertia @ turned.T
        bodies.append((link.mass, place + arm, velocity + ca.cross(omega, arm), omega, there))
        place, velocity = place + step, velocity + ca.cross(omega, step)
        turned = turned @ ca.sparsify(ca.DM(link.turn), 1e-15)
    mass = sum(body[0] for body in bodies)
    centre = sum(m * r for m, r, *_ in bodies) / mass
    momentum, composite = ca.SX.zeros(3), ca.SX.zeros(3, 3)
    for m, r, v, w, matrix in bodies:
        d = r - centre
        momentum += matrix @ w + m * ca.cross(d, v)
        composite += matrix + m * (ca.dot(d, d) * ca.SX.eye(3) - d @ d.T)
    a, b, c = ca.horzsplit(composite)
    solved = ca.vertcat(*(ca.dot(momentum, ca.cross(*pair)) for pair in ((b, c), (c, a), (a, b))))
    return ca.Function("rate", [y], [-solved / ca.dot(a, ca.cross(b, c))], {"cse": True})


def node(task):
    """Functions of coefficients `c` and the basis' values `p` at a node: the base's rate with its
    Jacobian, and the Hessian of `μ` times it."""
    count, terms = len(task.links), task.terms
    c, p, mu = ca.SX.sym("c", count * terms), ca.SX.sym("p", 2 * terms + 2), ca.SX.sym("mu", 3)
    rows = ca.reshape(c, terms, count).T
    phase = task.start_phase + task.phase_change * p[2 * terms] + rows @ p[:terms]
    slope = task.phase_change * p[2 * terms + 1] + rows @ p[terms : 2 * terms]
    path = ca.vertcat(
        task.amplitude * ca.sin(phase) + task.centre, task.amplitude * ca.cos(phase) * slope
    )
    rate = base_rate(task)
    y, nu = ca.SX.sym("y", 2 * count), ca.SX.sym("nu", 2 * count)
    jacobian = ca.Function("j", [y], [ca.jacobian(rate(y), y)], {"cse": True})
    hessian, gradient = ca.hessian(ca.dot(mu, rate(y)), y)
    second = ca.Function("h", [y, mu], [hessian, gradient], {"cse": True})
    along = ca.jacobian(path, c)
    bend = ca.Function("b", [c, p, nu], [ca.hessian(ca.dot(nu, path), c)[0]], {"cse": True})
    inner, slope_of = second(path, mu)
    curvature = along.T @ inner @ along + bend(c, p, slope_of)
    first = ca.Function(
        "node", [c, p], [rate(path), ca.densify(jacobian(path) @ along)], {"cse": True}
    )
    return first, ca.Function("node2", [c, p, mu], [ca.densify(curvature)], {"cse": True})


def right(q):
    """Matrix of the product with `q` on the right."""
    w, x, y, z = ca.vertsplit(q)
    return ca.blockcat([[w, -x, -y, -z], [x, w, z, -y], [y, -z, w, x], [z, y, -x, w]])


def left(q):
    """Matrix of the product with `q` on the left."""
    w, x, y, z = ca.vertsplit(q)
    return ca.blockcat([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]])


def increment(width):
    """Function of the rates at three Gauss nodes: the quaternion of one step of this width (Blanes,
    Casas, Oteo and Ros 2009, doi:10.1016/j.physrep.2008.11.001, section 5.4)."""
    rates = ca.SX.sym("w", 9)
    w1, w2, w3 = (width * w for w in ca.vertsplit(rates, 3))
    a1, a2, a3 = w2, (w3 - w1) * np.sqrt(15) / 3, (w3 - 2 * w2 + w1) * 10 / 3
    c1 = ca.cross(a2, a1)
    c2 = ca.cross(a1, 2 * a3 + c1) / 60
    turn = a1 + a3 / 12 - ca.cross(c1 - 20 * a1 - a3, a2 + c2) / 240
    # Cosine and sine of half the angle by their series: a step turns by less than a tenth.
    x = ca.dot(turn, turn) / 4
    cosine = 1 - x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56)))
    sine = (1 - x / 6 * (1 - x / 20 * (1 - x / 42))) / 2
    return ca.Function("increment", [rates], [ca.vertcat(cosine, sine * turn)], {"cse": True})


def step(variables):
    """Functions of one step. `step`: attitude `q` and its Jacobian `d` after it. `step2`: with the
    multiplier `a` of the attitude after it, the multipliers of the rates, the Hessian less the nodes'
    own, and the multiplier of the attitude before it."""
    q, d, a = ca.SX.sym("q", 4), ca.SX.sym("d", 4, variables), ca.SX.sym("a", 4)
    w, j = ca.SX.sym("w", 9), ca.SX.sym("j", 9, variables)
    turn = increment(1 / STEPS)(w)
    turn_of = ca.jacobian(turn, w)
    along = turn_of @ j
    first = ca.Function(
        "step", [q, d, w, j], [right(turn) @ q, right(turn) @ d + left(q) @ along], {"cse": True}
    )
    inner = left(q).T @ a
    symbol = ca.SX.sym("b", 4)
    own = ca.Function("own", [w, symbol], [ca.hessian(ca.dot(symbol, turn), w)[0]], {"cse": True})
    mixed = ca.jacobian(ca.jacobian(ca.dot(a, left(q) @ symbol), q), symbol)
    cross = d.T @ mixed @ along
    hessian = j.T @ own(w, inner) @ j + cross + cross.T
    outputs = [turn_of.T @ inner, ca.densify(hessian), right(turn).T @ a]
    return first, ca.Function("step2", [q, d, a, w, j], outputs, {"cse": True})


def limit(task, joint, order):
    """Functions of `z`, a joint's coefficients and `t_f`, and the basis' values `p` at one time: the
    derivative of this order as a share of its limit with its gradient, and `λ` times its Hessian."""
    terms = task.terms
    z, p = ca.SX.sym("z", terms + 1), ca.SX.sym("p", (order + 1) * (terms + 1))
    table = ca.reshape(p, terms + 1, order + 1)
    moves = ca.vertcat(z[:terms], task.phase_change[joint])
    s = [table[:, k].T @ moves for k in range(order + 1)]
    sin, cos = (f(s[0] + task.start_phase[joint]) for f in (ca.sin, ca.cos))
    shape = cos * s[1]
    if order == 2:
        shape = cos * s[2] - sin * s[1] ** 2
    if order == 3:
        shape = cos * (s[3] - s[1] ** 3) - 3 * sin * s[1] * s[2]
    share = task.amplitude[joint] / task.limits[order - 1] * shape / z[terms] ** order
    gradient = ca.densify(ca.gradient(share, z))
    multiplier = ca.SX.sym("l")
    hessian = ca.densify(multiplier * ca.hessian(share, z)[0])
    first = ca.Function(f"limit{joint}{order}", [z, p], [share, gradient], {"cse": True})
    second = ca.Function(f"bend{joint}{order}", [z, p, multiplier], [hessian], {"cse": True})
    return first, second
