"""The paper's task in NumPy: its numbers, both families of paths, and a dense evaluation of a motion.

Equation numbers are those of Xiao et al. (2023). Written apart from the Rust code, from the equations:
the momentum is summed link by link in the base's axes with its centre of mass at the origin, the
attitude composed by the fourth-order Magnus method, the peaks read off a dense grid.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).resolve().parents[3] / "src"

BOX = (1.0, 0.35)
"""Half-widths of the box that `scp` searches on this task, by bump."""


def rotation(axis, angle):
    """Rotation about one of the axes 0, 1, 2."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def inertia(table):
    """Symmetric matrix [kg m²] from its entries in a robot file."""
    xx, yy, zz, xy, xz, yz = (table.get(key, 0.0) for key in ("xx", "yy", "zz", "xy", "xz", "yz"))
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def quaternion(zyx_deg):
    """Quaternion (w, x, y, z) of yaw, pitch and roll [deg]."""
    result = np.array([1.0, 0, 0, 0])
    for axis, angle in zip((2, 1, 0), np.radians(zyx_deg)):
        turn = np.zeros(4)
        turn[0], turn[1 + axis] = np.cos(angle / 2), np.sin(angle / 2)
        result = product(result, turn)
    return result


def product(a, b):
    """Hamilton's product of two quaternions."""
    vector = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[a[0] * b[0] - a[1:] @ b[1:]], vector])


@dataclass
class Link:
    """A link in its proximal frame, and the step from its joint to the next."""

    mass: float
    inertia: np.ndarray
    centre_of_mass: np.ndarray
    step: np.ndarray
    turn: np.ndarray


class Task:
    """Robot, ends, limits and weights; `terms` free coefficients per joint."""

    def __init__(self):
        read = lambda name: tomllib.loads((SOURCE / name).read_text())
        self.terms = read("reorientation/defaults.toml")["trajectory"]["terms"]
        task, robot = read("task/shipped/xiao2023.toml")["task"], read("robot/shipped/xiao2023.toml")
        self.box = np.array(BOX)
        base = robot["base"]
        self.base_mass, self.base_inertia = base["mass"], inertia(base["inertia"])
        self.mount = np.array(base["mount"], float)
        self.links = [link(joint) for joint in robot["joint"]]
        self.ranges = np.radians([joint["range_deg"] for joint in robot["joint"]]).T
        lower, upper = self.ranges
        self.amplitude, self.centre = (upper - lower) / 2, (upper + lower) / 2
        start, goal = (
            np.arcsin((np.radians(task[end]["joints_deg"]) - self.centre) / self.amplitude)
            for end in ("start", "goal")
        )
        self.start_phase, self.phase_change = start, goal - start
        # From the goal's base axes to the start's.
        conjugate = quaternion(task["goal"]["base_zyx_deg"]) * [1, -1, -1, -1]
        self.start_base = product(conjugate, quaternion(task["start"]["base_zyx_deg"]))
        limits = task["limits"]
        self.limits = np.radians(
            [limits["rate_deg_s"], limits["acceleration_deg_s2"], limits["jerk_deg_s3"]]
        )
        self.base_weight = task["weights"]["base"]
        self.time_weight = 1 - self.base_weight


def link(joint):
    """One joint's table of a robot file."""
    dh = joint["dh"]
    alpha, offset = np.radians([dh["alpha_deg"], dh["offset_deg"]])
    return Link(
        mass=joint["mass"],
        inertia=inertia(joint["inertia"]),
        centre_of_mass=np.array(joint["centre_of_mass"], float),
        step=rotation(2, offset) @ [dh["a"], 0, dh["d"]],
        turn=rotation(2, offset) @ rotation(0, alpha),
    )


def basis(terms, tau):
    """The bumps and the step `10τ³ − 15τ⁴ + 6τ⁵`, each with three derivatives, at times `tau`.

    Shapes (4, terms, times) and (4, times). The bumps are `64 τ³(1−τ)³ P_k(2τ−1)`, `P_k` the
    polynomials orthonormal for the weight `(1−x²)⁶`, here by Gram and Schmidt's rule.
    """
    polynomial = np.polynomial.Polynomial
    nodes, weights = np.polynomial.legendre.leggauss(terms + 8)
    weights = weights * (1 - nodes**2) ** 6
    weights /= weights.sum()
    orthonormal = []
    for k in range(terms):
        p = polynomial.basis(k)
        for other in orthonormal:
            p = p - (weights @ (p(nodes) * other(nodes))) * other
        orthonormal.append(p / np.sqrt(weights @ p(nodes) ** 2))
    window = 64 * polynomial([0, 1]) ** 3 * polynomial([1, -1]) ** 3
    bumps = [window * p(polynomial([-1, 2])) for p in orthonormal]
    step = polynomial([0, 0, 0, 10, -15, 6])
    values = np.array([[p.deriv(order)(tau) for p in (*bumps, step)] for order in range(4)])
    return values[:, :-1], values[:, -1]


def joint_path(task, coefficients, tau):
    """Angle and three derivatives by `τ` (eqs. 11–14), shape (4, joints, times)."""
    bumps, step = basis(task.terms, tau)
    s, s1, s2, s3 = task.phase_change[:, None] * step[:, None] + coefficients @ bumps
    s = s + task.start_phase[:, None]
    sin, cos, amplitude = np.sin(s), np.cos(s), task.amplitude[:, None]
    shape = [sin, cos * s1, cos * s2 - sin * s1**2, cos * (s3 - s1**3) - 3 * sin * s1 * s2]
    path = amplitude * np.array(shape)
    path[0] += task.centre[:, None]
    return path


class Spline:
    """A path of degree 3 over equal pieces, the third derivative by `τ` constant on each: `states`, angle
    and two derivatives at every knot, of shape (pieces + 1, 3, joints), and `jerks` of (pieces, joints)."""

    def __init__(self, start, jerks):
        self.jerks, self.width = np.array(jerks), 1 / len(jerks)
        state = np.array([start, np.zeros_like(start), np.zeros_like(start)])
        states = [state]
        for jerk in self.jerks:
            state = np.array(self.along(state, jerk, self.width)[:3])
            states.append(state)
        self.states = np.array(states)

    @classmethod
    def of_points(cls, points):
        """With the control points of a clamped B-spline, one row per joint, differentiated three times
        (de Boor 2001, doi:10.1007/978-1-4612-6333-3, chapter X)."""
        points = np.array(points).T
        start, pieces = points[0], len(points) - 3
        knots = np.concatenate([np.zeros(3), np.linspace(0, 1, pieces + 1), np.ones(3)])
        for order in (1, 2, 3):
            spans = knots[4 : pieces + 7 - order] - knots[order : pieces + 3]
            points = (4 - order) * np.diff(points, axis=0) / spans[:, None]
        return cls(start, points)

    @staticmethod
    def along(state, jerk, s):
        """Angle and three derivatives a time `s` after a knot."""
        angle, rate, acceleration = state
        return [
            angle + s * (rate + s * (acceleration / 2 + s * jerk / 6)),
            rate + s * (acceleration + s * jerk / 2),
            acceleration + s * jerk,
            jerk + 0 * s,
        ]

    def path(self, tau):
        """Angle and three derivatives by `τ`, shape (4, joints, times)."""
        piece = np.minimum((tau / self.width).astype(int), len(self.jerks) - 1)
        state = self.states[piece].transpose(1, 2, 0)
        return np.array(self.along(state, self.jerks[piece].T, tau - piece * self.width))


def base_rate(task, angles, rates):
    """Angular rate of the base at zero momentum (eqs. 5–7), base axes; all of shape (…, times)."""
    times = angles.shape[1]
    turned, place = np.broadcast_to(np.eye(3), (times, 3, 3)), np.tile(task.mount, (times, 1))
    omega, velocity = np.zeros((times, 3)), np.zeros((times, 3))
    bodies = [(task.base_mass, np.zeros((times, 3)), velocity, omega, task.base_inertia)]
    for link, angle, rate in zip(task.links, angles, rates):
        omega = omega + turned[:, :, 2] * rate[:, None]
        turned = turned @ np.array([rotation(2, a) for a in angle])
        arm, step = turned @ link.centre_of_mass, turned @ link.step
        there = turned @ link.inertia @ turned.transpose(0, 2, 1)
        bodies.append((link.mass, place + arm, velocity + np.cross(omega, arm), omega, there))
        place, velocity = place + step, velocity + np.cross(omega, step)
        turned = turned @ link.turn
    mass = sum(body[0] for body in bodies)
    centre = sum(m * r for m, r, *_ in bodies) / mass
    momentum, composite = np.zeros((times, 3)), np.zeros((times, 3, 3))
    for m, r, v, w, matrix in bodies:
        d = r - centre
        momentum += (matrix @ w[:, :, None])[:, :, 0] + m * np.cross(d, v)
        square = np.einsum("ti,ti->t", d, d)[:, None, None] * np.eye(3)
        composite += matrix + m * (square - d[:, :, None] * d[:, None, :])
    return -np.linalg.solve(composite, momentum[:, :, None])[:, :, 0]


@dataclass
class Motion:
    """What the dense evaluation says of a motion."""

    error: float
    shortest: float
    """Shortest duration within the limits [s]."""

    def cost(self, task):
        """`J` (eq. 25) at the shortest duration."""
        unit = np.sin(np.radians(0.5))
        return task.base_weight * self.error / unit + task.time_weight * self.shortest

    def residual_deg(self):
        """The base's error angle [deg]."""
        return np.degrees(2 * np.arcsin(min(self.error, 1.0)))


def evaluate(task, coefficients, steps=2000):
    """Evaluates the path with coefficients of shape (joints, terms), independent of any solver."""
    return evaluate_path(task, lambda tau: joint_path(task, coefficients, tau), steps)


def evaluate_path(task, path, steps, samples=20_001):
    """Evaluates a path, a function of times that says angles and three derivatives by `τ`."""
    offset, width = np.sqrt(3) / 6, 1 / steps
    tau = np.add.outer(np.arange(steps), [0.5 - offset, 0.5 + offset]).ravel() * width
    angles, rates, *_ = path(tau)
    nodes = base_rate(task, angles, rates).reshape(steps, 2, 3)
    attitude = task.start_base
    for first, second in nodes:
        turn = width / 2 * (first + second) + np.sqrt(3) / 12 * width**2 * np.cross(first, second)
        angle = np.linalg.norm(turn)
        half = np.sinc(angle / 2 / np.pi) / 2 * turn
        attitude = product(attitude, np.concatenate([[np.cos(angle / 2)], half]))
    derivatives = path(np.linspace(0, 1, samples))[1:]
    peaks = np.abs(derivatives).max(axis=(1, 2)) / task.limits
    return Motion(np.linalg.norm(attitude[1:]), max(peaks ** (1 / np.arange(1, 4))))
