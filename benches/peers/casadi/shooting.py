"""A free-form motion as a nonlinear program by multiple shooting, solved by IPOPT.

    minimise    t_f          over the states at all knots, the jerks of all pieces, and t_f
    subject to  the state after piece k is that at knot k + 1
                |θ̇|, |θ̈|, |θ⃛| ≤ limit     at knots and, of rates, in the middle of pieces
                θ within its range           at knots
                rest at both ends, the base at its goal

A state is `(θ, θ̇, θ̈, q)`: angles [rad], rates and accelerations as shares of their limits, and the
quaternion from the goal's base axes to the base's. So are jerks shares of their limits. The variables are
those of knot 0, of piece 0, of knot 1, …, of the last knot, and `t_f` [s].
"""

import casadi as ca
import numpy as np

from derived import compiled
from expressions import base_rate, increment, left
from ipopt import run
from model import Spline, evaluate_path

GAUSS = 0.5 + np.sqrt(15) / 10 * np.arange(-1, 2)
"""Nodes of the one sixth-order Magnus step of a piece."""

OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "ipopt.tol": 1e-8,
    "ipopt.max_iter": 3000,
    "ipopt.max_wall_time": 300.0,
    # Ten times IPOPT's own: a fifth fewer iterations, and no worse motions.
    "ipopt.mu_init": 1.0,
}

CSE = {"cse": True}


class Piece:
    """Functions of a piece's variables `z`, its first state, its jerks and `t_f`; of `w`, the base's rates
    at the nodes; of `d`, these rates' slopes by the angles and rates there; of `h`, their Hessians; and of
    `l`, multipliers."""

    def __init__(self, task, pieces):
        joints = self.joints = len(task.links)
        angle, rate, acceleration, jerk = (ca.SX.sym(name, joints) for name in ("t", "r", "a", "j"))
        q, duration = ca.SX.sym("q", 4), ca.SX.sym("T")
        z = self.z = ca.vertcat(angle, rate, acceleration, q, jerk, duration)
        width, units = duration / pieces, task.limits
        scales = [units[order - 1] * width**order for order in (1, 2, 3)]
        state = (angle, scales[0] * rate, scales[1] * acceleration)

        def at(share):
            """Angles and two derivatives by the share of the piece."""
            return Spline.along(state, scales[2] * jerk, share)[:3]

        y = ca.vertcat(*(part for share in GAUSS for part in at(share)[:2]))
        end, middle = at(1), at(0.5)[1] / scales[0]
        end = ca.vertcat(end[0], end[1] / scales[0], end[2] / scales[1])
        w, turn = ca.SX.sym("w", 9), increment(1)
        self.after = ca.vertcat(end, left(q) @ turn(w))
        rows = ca.vertcat(self.after, middle)
        self.states, self.rows = self.after.numel(), rows.numel()
        self.nodes = ca.Function("nodes", [z], [y], CSE)
        self.rate = base_rate(task)
        self.value = ca.Function("value", [z, w], [rows], CSE)
        self.derive(z, q, y, w, turn, rows)

    def derive(self, z, q, y, w, turn, rows):
        """The first and second derivatives of all rows, exact: the chain rule through the nodes."""
        joints = self.joints
        node, mu = ca.SX.sym("y", 2 * joints), ca.SX.sym("mu", 3)
        slope = ca.densify(ca.jacobian(self.rate(node), node))
        self.slopes = ca.Function("slopes", [node], [self.rate(node), ca.vec(slope)], CSE)
        bend = ca.triu(ca.hessian(ca.dot(mu, self.rate(node)), node)[0])
        self.bends = ca.Function("bends", [node, mu], [ca.vertcat(*bend.nonzeros())], CSE)

        d, h = ca.SX.sym("d", 18 * joints), ca.SX.sym("h", 3 * bend.nnz())
        slopes = ca.diagcat(*(ca.reshape(part, 3, -1) for part in ca.vertsplit(d, 6 * joints)))
        along = ca.jacobian(y, z)
        jacobian = ca.jacobian(rows, z) + ca.jacobian(rows, w) @ slopes @ along
        self.jacobian = jacobian.sparsity()
        self.first = ca.Function("first", [z, w, d], [ca.vertcat(*jacobian.nonzeros())], CSE)

        multipliers, total = ca.SX.sym("l", self.rows), 0
        lagrangian = ca.dot(multipliers, rows)
        by_rates = ca.gradient(lagrangian, w)
        self.adjoint = ca.Function("adjoint", [z, w, multipliers], [by_rates], CSE)
        own = [ca.SX(bend.sparsity(), part) for part in ca.vertsplit(h, bend.nnz())]
        own = ca.diagcat(*(part + part.T - ca.diag(ca.diag(part)) for part in own))
        # What bends in the nodes, in where the nodes are, in the turn, in both together, and in the rest.
        total += along.T @ own @ along
        symbol = ca.SX.sym("s", y.numel())
        bent = ca.hessian(ca.dot(symbol, y), z)[0]
        total += ca.substitute(bent, symbol, slopes.T @ by_rates)
        through = slopes @ along
        symbol = ca.SX.sym("s", 4)
        bent = ca.hessian(ca.dot(symbol, turn(w)), w)[0]
        ends = left(q).T @ multipliers[self.states - 4 : self.states]
        total += through.T @ ca.substitute(bent, symbol, ends) @ through
        mixed = ca.jacobian(by_rates, z).T @ through
        total += mixed + mixed.T + ca.hessian(lagrangian, z)[0]
        hessian = ca.triu(ca.sparsify(total))
        self.hessian = hessian.sparsity()
        arguments = [z, w, d, h, multipliers]
        self.second = ca.Function("second", arguments, [ca.vertcat(*hessian.nonzeros())], CSE)


class Program:
    """The program of so many pieces."""

    def __init__(self, task, pieces):
        self.pieces, self.piece = pieces, Piece(task, pieces)
        self.own = self.piece.z.numel() - 1
        self.variables = pieces * self.own + self.piece.states + 1
        self.x = ca.MX.sym("x", self.variables)
        knots = ca.reshape(self.x[: pieces * self.own], self.own, pieces)
        last = self.x[pieces * self.own : -1]
        self.z = ca.vertcat(knots, ca.repmat(self.x[-1], 1, pieces))
        states = self.piece.states
        self.next = ca.horzcat(knots[:states, 1:], last)

    def defects(self, values):
        """All rows: the states after the pieces less those at the next knots, and what is limited."""
        zeros = ca.MX(self.piece.rows - self.piece.states, self.pieces)
        return ca.vec(values - ca.vertcat(self.next, zeros))

    def plain(self):
        """As one writes it with CasADi: one SX function for a piece, mapped, and no derivatives."""
        piece = self.piece
        nodes = ca.vertsplit(piece.nodes(piece.z), 2 * piece.joints)
        rows = piece.value(piece.z, ca.vertcat(*(piece.rate(node) for node in nodes)))
        values = ca.Function("piece", [piece.z], [rows]).map(self.pieces)(self.z)
        return {"x": self.x, "f": self.x[-1], "g": self.defects(values)}, {"expand": True}

    def derived(self, folder):
        """With exact derivatives put together by hand, compiled."""
        x, none = self.x, ca.MX.sym("p", 0)
        weight, multipliers = ca.MX.sym("w"), ca.MX.sym("l", self.piece.rows * self.pieces)
        cost, rows = x[-1], self.defects(self.piece.value.map(self.pieces)(self.z, self.rates()[1]))
        functions = [
            ca.Function("nlp", [x, none], [cost, rows], ["x", "p"], ["f", "g"]),
            ca.Function("nlp_grad_f", [x, none], [cost, ca.gradient(cost, x)]),
            ca.Function("nlp_jac_g", [x, none], [rows, self.jacobian()]),
            ca.Function("nlp_hess_l", [x, none, weight, multipliers], [self.hessian(multipliers)]),
        ]
        nlp, grad_f, jac_g, hess_lag = compiled(functions, folder)
        cost, rows = nlp(x, [])
        derivatives = {"grad_f": grad_f, "jac_g": jac_g, "hess_lag": hess_lag, "no_nlp_grad": True}
        return {"x": x, "f": cost, "g": rows}, derivatives

    def rates(self):
        """Angles and rates at all nodes, and the base's rates there, one column per piece."""
        nodes = ca.reshape(self.piece.nodes.map(self.pieces)(self.z), -1, 3 * self.pieces)
        return nodes, ca.reshape(self.piece.rate.map(3 * self.pieces)(nodes), 9, self.pieces)

    def slopes(self):
        """The same with the rates' slopes."""
        nodes, _ = self.rates()
        w, d = self.piece.slopes.map(3 * self.pieces)(nodes)
        return nodes, ca.reshape(w, 9, self.pieces), ca.reshape(d, -1, self.pieces)

    def jacobian(self):
        """The rows' sparse Jacobian."""
        _, w, d = self.slopes()
        values = ca.vec(self.piece.first.map(self.pieces)(self.z, w, d))
        row, column = self.spread(self.piece.jacobian, self.piece.rows)
        states = np.arange(self.piece.states)
        for k in range(self.pieces):
            row.append(states + k * self.piece.rows)
            column.append(states + (k + 1) * self.own)
        ones = ca.MX.ones(self.piece.states * self.pieces)
        shape = (self.piece.rows * self.pieces, self.variables)
        return sparse(row, column, shape, ca.vertcat(values, -ones))

    def hessian(self, multipliers):
        """The Lagrangian's sparse Hessian, upper triangle."""
        nodes, w, d = self.slopes()
        parts = ca.reshape(multipliers, self.piece.rows, self.pieces)
        mu = self.piece.adjoint.map(self.pieces)(self.z, w, parts)
        bends = self.piece.bends.map(3 * self.pieces)(nodes, ca.reshape(mu, 3, -1))
        bends = ca.reshape(bends, -1, self.pieces)
        values = self.piece.second.map(self.pieces)(self.z, w, d, bends, parts)
        # The last entry is that of `t_f` twice, the same for all pieces.
        assert self.piece.hessian.get_triplet()[1][-1] == self.own
        row, column = self.spread(self.piece.hessian, self.own, without=1)
        values = ca.vertcat(ca.vec(values[:-1, :]), ca.sum2(values[-1, :]))
        last = [self.variables - 1]
        return sparse([*row, last], [*column, last], (self.variables, self.variables), values)

    def spread(self, pattern, step, without=0):
        """Where the entries of every piece's matrix belong, but for so many last ones."""
        row, column = (np.array(part)[: pattern.nnz() - without] for part in pattern.get_triplet())
        pieces = range(self.pieces)
        columns = [
            np.where(column == self.own, self.variables - 1, column + k * self.own) for k in pieces
        ]
        return [row + k * step for k in pieces], columns


def sparse(rows, columns, shape, values):
    """A matrix of these entries, each of which is given once."""
    row, column = (np.concatenate(part).tolist() for part in (rows, columns))
    places = ca.DM.triplet(row, column, ca.DM(np.arange(len(row))), *shape)
    assert places.nnz() == len(row)
    return ca.MX(places.sparsity(), values[[int(place) for place in places.nonzeros()]])


class Shooting:
    """IPOPT with the program in one of its forms, built."""

    def __init__(self, task, program, form):
        nlp, more = form
        self.task, self.program = task, program
        self.ipopt = ca.nlpsol("solver", "ipopt", nlp, {**more, **OPTIONS})

    def solve(self, points):
        """Solves from the spline with these control points and its shortest duration. What is found is
        evaluated densely, at the shortest duration within the limits."""
        spline = Spline.of_points(points)
        guess = self.guess(spline)
        x, _, told = run(self.ipopt, guess, self.bounds(guess))
        joints, own, duration = self.program.piece.joints, self.program.own, x[-1]
        jerks = x[: self.program.pieces * own].reshape(-1, own)[:, -joints:]
        found = Spline(spline.states[0, 0], self.task.limits[2] * duration**3 * jerks)
        goal = np.abs(found.states[-1] - spline.states[-1]).max()
        motion = densely(self.task, found)
        return {
            "t_f": motion.shortest,
            "residual_deg": motion.residual_deg(),
            # By how much joints miss their goal, and the duration found the limits at all times.
            "joints_miss": goal,
            "excess": motion.shortest / duration - 1,
            **told,
        }

    def defects(self, guess):
        """By how much a guess misses the rows that are equalities."""
        rows = self.ipopt.oracle()(guess, [])[1].full().reshape(self.program.pieces, -1)
        return rows[:, : self.program.piece.states]

    def guess(self, spline):
        """The variables of a spline at its shortest duration, without a defect."""
        piece, task = self.program.piece, self.task
        duration = densely(task, spline, 1).shortest
        units = task.limits * duration ** np.arange(1, 4)
        attitude, parts = task.start_base, []
        states = spline.states / np.array([1, *units[:2]])[:, None]
        for state, jerk in zip(states, spline.jerks):
            z = np.concatenate([state.ravel(), attitude, jerk / units[2], [duration]])
            nodes = np.split(piece.nodes(z).full().ravel(), 3)
            w = np.concatenate([piece.rate(node).full().ravel() for node in nodes])
            attitude = piece.value(z, w).full().ravel()[piece.states - 4 : piece.states]
            parts.append(z[:-1])
        return np.concatenate([*parts, states[-1].ravel(), attitude, [duration]])

    def bounds(self, guess):
        """The bounds of all variables and rows; both ends are those of the guess, the base's its goal."""
        joints, states, pieces = (
            self.program.piece.joints, self.program.piece.states, self.program.pieces
        )
        limited, own = np.ones(2 * joints), self.program.own
        sides = []
        for side, ends, duration in zip((-1, 1), self.task.ranges, (0.1, 1000)):
            knot = np.concatenate([ends, side * limited, side * np.full(4, 2)])
            every = np.tile(np.append(knot, side * np.ones(joints)), pieces)
            sides.append(np.concatenate([every, knot, [duration]]))
        last = pieces * own
        for side in sides:
            side[:states] = guess[:states]
            side[last : last + states - 4] = guess[last : last + states - 4]
            side[last + states - 3 : last + states] = 0
        rows = np.tile(np.append(np.zeros(states), np.ones(joints)), pieces)
        return {"lbx": sides[0], "ubx": sides[1], "lbg": -rows, "ubg": rows}


def densely(task, spline, steps=100):
    """The dense evaluation of a spline, with so many steps for each piece."""
    return evaluate_path(task, spline.path, steps * len(spline.jerks))
