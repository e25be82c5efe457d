"""The time-free task as a nonlinear program, in CasADi expressions, solved by IPOPT.

    minimise    K_t t_f                                 over the bump coefficients c and t_f
    subject to  δq_b(c) = 0                             the base ends at its goal: three rows
                |θ'|, |θ''|, |θ'''| ≤ limit · t_f^order     every joint, on a grid of times
                |c| ≤ box

Small pieces are written as expressions in SX: the base's rate at a node, one Magnus step, one limit at
one time. Their first and second derivatives are CasADi's. The chain rule that puts them together is
written out here, so that no derivative is computed that is known to vanish: this makes an iteration
several times faster than the derivatives CasADi finds for the program written as one expression.
All is generated as C and compiled before any clock runs.
"""

import hashlib
import os
import subprocess
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import casadi as ca
import numpy as np
from model import Task, basis, evaluate

STEPS = 24
"""Magnus steps of sixth order, as many as `scp` makes."""

GRID = (41, 81, 161)
"""Intervals of the equal grids on which rates, accelerations and jerks are limited."""

COMPILER = ["gcc", "-O3", "-march=native", "-shared", "-fPIC"]

OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "no_nlp_grad": True,
    "ipopt.max_iter": 500,
}


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
    """Function of the rates at three Gauss nodes: the quaternion of one step (Blanes, Casas, Oteo and
    Ros 2009, doi:10.1016/j.physrep.2008.11.001, section 5.4)."""
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
    multiplier `a` of the attitude after it, that of the rates, the Hessian less the nodes' own, and the
    multiplier of the attitude before it."""
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


class Attitude:
    """The base's error `δq_b` with its Jacobian, and the Hessian of `λ` times it."""

    def __init__(self, task):
        offset = np.sqrt(15) / 10
        nodes = np.add.outer(np.arange(STEPS), [0.5 - offset, 0.5, 0.5 + offset]).ravel() / STEPS
        bumps, sigma = basis(task.terms, nodes)
        self.places = np.vstack([bumps[0], bumps[1], sigma[:2]])
        self.variables = len(task.links) * task.terms
        self.start = task.start_base
        self.node, self.node2 = node(task)
        self.step, self.step2 = step(self.variables)

    def first(self, c):
        """Error and Jacobian; the states before every step, and what each takes in."""
        n = self.variables
        rates, slopes = self.node.map(3 * STEPS)(ca.repmat(c, 1, 3 * STEPS), self.places)
        rates = ca.horzsplit(ca.reshape(rates, 9, STEPS))
        slopes = [ca.vertcat(*ca.horzsplit(block, n)) for block in ca.horzsplit(slopes, 3 * n)]
        states = [(ca.MX(self.start), ca.MX.zeros(4, n))]
        for w, j in zip(rates, slopes):
            states.append(self.step(*states[-1], w, j))
        attitude, along = states[-1]
        return attitude[1:], along[1:, :], states, list(zip(rates, slopes))

    def second(self, c, multiplier):
        """The Hessian."""
        *_, states, steps = self.first(c)
        a = ca.vertcat(0, multiplier)
        total, multipliers = 0, []
        for (q, d), (w, j) in zip(reversed(states[:-1]), reversed(steps)):
            mu, hessian, a = self.step2(q, d, a, w, j)
            total += hessian
            multipliers.insert(0, ca.reshape(mu, 3, 3))
        nodes = self.node2.map(3 * STEPS)
        own = nodes(ca.repmat(c, 1, 3 * STEPS), self.places, ca.horzcat(*multipliers))
        n = self.variables
        return total + ca.reshape(ca.sum2(ca.reshape(own, n * n, 3 * STEPS)), n, n)


class Limits:
    """Rates, accelerations and jerks of one joint as shares of their limits: values, derivatives by
    its coefficients and `t_f`, and the Hessian of `λ` times them."""

    def __init__(self, task, joint):
        self.parts = [self.part(task, joint, order, GRID[order - 1]) for order in (1, 2, 3)]
        self.rows = sum(places.shape[1] for *_, places in self.parts)

    def part(self, task, joint, order, intervals):
        """Functions for one order, and the basis' values on its grid."""
        terms = task.terms
        z, p, lam = ca.SX.sym("z", terms + 1), ca.SX.sym("p", (order + 1) * (terms + 1)), ca.SX.sym("l")
        table = ca.reshape(p, terms + 1, order + 1)
        s = [table[:, k].T @ ca.vertcat(z[:terms], task.phase_change[joint]) for k in range(order + 1)]
        s[0] += task.start_phase[joint]
        sin, cos = ca.sin(s[0]), ca.cos(s[0])
        shape = cos * s[1]
        if order == 2:
            shape = cos * s[2] - sin * s[1] ** 2
        if order == 3:
            shape = cos * (s[3] - s[1] ** 3) - 3 * sin * s[1] * s[2]
        share = task.amplitude[joint] / task.limits[order - 1] * shape / z[terms] ** order
        gradient = ca.densify(ca.gradient(share, z))
        first = ca.Function(f"limit{joint}{order}", [z, p], [share, gradient], {"cse": True})
        hessian = ca.densify(lam * ca.hessian(share, z)[0])
        second = ca.Function(f"bend{joint}{order}", [z, p, lam], [hessian], {"cse": True})
        # At both ends rate and acceleration are zero whatever the coefficients.
        times = np.linspace(0, 1, intervals + 1)
        times = times if order == 3 else times[1:-1]
        bumps, sigma = basis(terms, times)
        places = np.vstack([np.vstack([bumps[k], sigma[k]]) for k in range(order + 1)])
        return first, second, places

    def first(self, z):
        """Shares (rows) and their gradients, one column a row."""
        found = [
            first.map(places.shape[1])(ca.repmat(z, 1, places.shape[1]), places)
            for first, _, places in self.parts
        ]
        return ca.horzcat(*(f[0] for f in found)).T, ca.horzcat(*(f[1] for f in found))

    def second(self, z, multipliers):
        """The Hessian."""
        n, total, begin = z.numel(), 0, 0
        for _, second, places in self.parts:
            count = places.shape[1]
            part = multipliers[begin : begin + count].T
            all_rows = second.map(count)(ca.repmat(z, 1, count), places, part)
            total += ca.reshape(ca.sum2(ca.reshape(all_rows, n * n, count)), n, n)
            begin += count
        return total


class Program:
    """The program, built and compiled into a folder, ready to be solved from any start."""

    def __init__(self, task, folder, options=OPTIONS):
        self.task = task
        joints, terms = len(task.links), task.terms
        x, weight = ca.MX.sym("x", joints * terms + 1), ca.MX.sym("lam_f")
        c, duration, empty = x[:-1], x[-1], ca.MX.sym("p", 0)
        attitude, limits = Attitude(task), [Limits(task, joint) for joint in range(joints)]
        own = [ca.vertcat(c[i * terms : (i + 1) * terms], duration) for i in range(joints)]
        error, along, *_ = attitude.first(c)
        shares, slopes = zip(*(limit.first(z) for limit, z in zip(limits, own)))
        rows = ca.vertcat(error, *shares)
        self.rows = rows.numel()
        lam = ca.MX.sym("lam_g", self.rows)
        cost = task.time_weight * duration
        functions = [
            ca.Function("nlp", [x, empty], [cost, rows], ["x", "p"], ["f", "g"]),
            ca.Function("nlp_grad_f", [x, empty], [cost, ca.gradient(cost, x)]),
            ca.Function("nlp_jac_g", [x, empty], [rows, jacobian(along, slopes, terms)]),
            ca.Function(
                "nlp_hess_l",
                [x, empty, weight, lam],
                [hessian(attitude.second(c, lam[:3]), limits, own, lam[3:])],
                ["x", "p", "lam_f", "lam_g"],
                ["hess_gamma_x_x"],
            ),
        ]
        self.functions = functions
        nlp, grad_f, jac_g, hess_lag = compiled(functions, Path(folder))
        f, g = nlp(x, empty)
        custom = {"grad_f": grad_f, "jac_g": jac_g, "hess_lag": hess_lag}
        self.solver = ca.nlpsol("solver", "ipopt", {"x": x, "f": f, "g": g}, {**custom, **options})
        box = np.tile(task.box, joints)
        self.bounds = {
            "lbx": np.append(-box, 0.1),
            "ubx": np.append(box, 1000),
            "lbg": np.append(np.zeros(3), -np.ones(self.rows - 3)),
            "ubg": np.append(np.zeros(3), np.ones(self.rows - 3)),
        }

    def solve(self, start):
        """Solves from coefficients of shape (joints · terms); the clock runs while IPOPT does."""
        shape = (len(self.task.links), self.task.terms)
        duration = evaluate(self.task, np.reshape(start, shape), steps=1).shortest
        guess = np.append(start, duration)
        clock = time.perf_counter()
        solution = self.solver(x0=guess, **self.bounds)
        seconds = time.perf_counter() - clock
        x, stats = np.array(solution["x"]).ravel(), self.solver.stats()
        motion = evaluate(self.task, x[:-1].reshape(shape))
        return {
            "coefficients": x[:-1].tolist(),
            "j": motion.cost(self.task),
            "t_f": motion.shortest,
            "residual_deg": motion.residual_deg(),
            "excess": motion.shortest / x[-1] - 1,
            "seconds": seconds,
            "ending": stats["return_status"],
            "iterations": stats["iter_count"],
        }


def jacobian(along, slopes, terms):
    """The rows' sparse Jacobian: each limit has its own joint's coefficients and `t_f`."""
    values, row, column, begin = [], [], [], 3
    for joint, slope in enumerate(slopes):
        count = slope.shape[1]
        for k in range(terms):
            values += [along[:, joint * terms + k], slope[k, :].T]
            row += [0, 1, 2, *range(begin, begin + count)]
            column += [joint * terms + k] * (3 + count)
        begin += count
    values += [slope[terms, :].T for slope in slopes]
    row += range(3, begin)
    column += [len(slopes) * terms] * (begin - 3)
    pattern = ca.Sparsity.triplet(begin, len(slopes) * terms + 1, row, column)
    return ca.MX(pattern, ca.vertcat(*values))


def hessian(attitude, limits, own, multipliers):
    """The Lagrangian's Hessian, upper triangle."""
    n = attitude.shape[0] + 1
    total, begin = ca.diagcat(attitude, 0), 0
    total = ca.densify(total)
    for joint, (limit, z) in enumerate(zip(limits, own)):
        terms = z.numel() - 1
        places = [*range(joint * terms, (joint + 1) * terms), n - 1]
        select = ca.DM.eye(n)[:, places]
        part = limit.second(z, multipliers[begin : begin + limit.rows])
        total += select @ part @ select.T
        begin += limit.rows
    return ca.triu(total)


def compiled(functions, folder):
    """The functions as generated C, compiled; what was compiled before is taken as it is."""
    generator = ca.CodeGenerator("program.c")
    for function in functions:
        generator.add(function)
    source = generator.dump()
    name = hashlib.sha256((source + " ".join(COMPILER)).encode()).hexdigest()[:16]
    folder.mkdir(parents=True, exist_ok=True)
    library = folder / f"{name}.so"
    if not library.exists():
        (folder / f"{name}.c").write_text(source)
        subprocess.run([*COMPILER, folder / f"{name}.c", "-o", library], check=True)
    return [ca.external(function.name(), str(library)) for function in functions]
