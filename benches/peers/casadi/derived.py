"""The program with its derivatives put together by hand, compiled.

The derivatives of the pieces are CasADi's. The chain rule that puts them together is written out here,
so that nothing is computed that is known to vanish. All is generated as C and compiled before any
clock runs.
"""

import hashlib
import subprocess

import casadi as ca
import numpy as np

from expressions import NODES, STEPS, limit, limit_times, node, step
from model import basis

COMPILER = ["gcc", "-O3", "-march=native", "-shared", "-fPIC"]


def derived(task, folder):
    """The program for `nlpsol`, and the derivatives that it is to use."""
    nlp, grad_f, jac_g, hess_lag = compiled(program(task), folder)
    x = ca.MX.sym("x", len(task.links) * task.terms + 1)
    cost, rows = nlp(x, [])
    derivatives = {"grad_f": grad_f, "jac_g": jac_g, "hess_lag": hess_lag}
    return {"x": x, "f": cost, "g": rows}, derivatives


class Attitude:
    """The base's error `δq_b` with its Jacobian, and the Hessian of `λ` times it."""

    def __init__(self, task):
        bumps, sigma = basis(task.terms, NODES)
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
        self.parts = []
        for order in (1, 2, 3):
            bumps, sigma = basis(task.terms, limit_times(order))
            places = np.vstack([np.vstack([bumps[k], sigma[k]]) for k in range(order + 1)])
            self.parts.append((*limit(task, joint, order), places))
        self.rows = sum(places.shape[1] for *_, places in self.parts)

    def first(self, z):
        """Shares (rows) and their gradients, one column per row."""
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


def program(task):
    """The program as CasADi's interface to IPOPT wants it: cost and rows, the cost's gradient, the
    rows' Jacobian, the Lagrangian's Hessian."""
    joints, terms = len(task.links), task.terms
    x, weight, none = ca.MX.sym("x", joints * terms + 1), ca.MX.sym("w"), ca.MX.sym("p", 0)
    c, duration = x[:-1], x[-1]
    attitude, limits = Attitude(task), [Limits(task, joint) for joint in range(joints)]
    own = [ca.vertcat(part, duration) for part in ca.vertsplit(c, terms)]
    error, along, *_ = attitude.first(c)
    shares, slopes = zip(*(limits_of.first(z) for limits_of, z in zip(limits, own)))
    cost, rows = task.time_weight * duration, ca.vertcat(error, *shares)
    multipliers = ca.MX.sym("l", rows.numel())
    bend = hessian(attitude.second(c, multipliers[:3]), limits, own, multipliers[3:])
    return [
        ca.Function("nlp", [x, none], [cost, rows], ["x", "p"], ["f", "g"]),
        ca.Function("nlp_grad_f", [x, none], [cost, ca.gradient(cost, x)]),
        ca.Function("nlp_jac_g", [x, none], [rows, jacobian(along, slopes, terms)]),
        ca.Function("nlp_hess_l", [x, none, weight, multipliers], [bend]),
    ]


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
    n, begin = attitude.shape[0] + 1, 0
    total = ca.densify(ca.diagcat(attitude, 0))
    for joint, (limits_of, z) in enumerate(zip(limits, own)):
        terms = z.numel() - 1
        select = ca.DM.eye(n)[:, [*range(joint * terms, (joint + 1) * terms), n - 1]]
        part = limits_of.second(z, multipliers[begin : begin + limits_of.rows])
        total += select @ part @ select.T
        begin += limits_of.rows
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
