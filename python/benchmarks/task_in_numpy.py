"""The cost of the default task in its variables without a duration, worked out by numpy for many points at once.

Written from the equations in the documentation of the library, for comparison; peaks between samples are not sought.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
from numpy.polynomial import Polynomial

ROBOT = Path(__file__).parents[2] / "src" / "robot" / "shipped" / "xiao2023.toml"
START, GOAL = np.radians([[10, 30, 45, -20, -25, 40], [40, 60, 90, -10, -30, 60]])
BASE = np.radians([6, 15, 7])
LIMITS = np.radians([60, 70, 80])
WEIGHT, UNIT = 0.9, np.sin(np.radians(0.5))
STEPS, SAMPLES = 24, 48


def matrix(table: dict[str, float]) -> np.ndarray:
    xy, xz, yz = (table.get(key, 0.0) for key in ("xy", "xz", "yz"))
    return np.array([[table["xx"], xy, xz], [xy, table["yy"], yz], [xz, yz, table["zz"]]])


def turn(axis: int, angle: np.ndarray) -> np.ndarray:
    """Rotations about x (0) or z (2), shape (…, 3, 3)."""
    c, s, o, i = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    rows = [[i, o, o], [o, c, -s], [o, s, c]] if axis == 0 else [[c, -s, o], [s, c, o], [o, o, i]]
    return np.stack([np.stack(row, -1) for row in rows], -2)


def product(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    w, v = p[..., :1], p[..., 1:]
    y, u = q[..., :1], q[..., 1:]
    return np.concatenate([w * y - (v * u).sum(-1, keepdims=True), w * u + y * v + np.cross(v, u)], -1)


class Task:
    """The task; `cost` takes points, shape (m, 12), and returns costs, shape (m,)."""

    def __init__(self) -> None:
        self.robot = tomllib.loads(ROBOT.read_text())
        lower, upper = np.radians([joint["range_deg"] for joint in self.robot["joint"]]).T
        self.half, self.middle = (upper - lower) / 2, (upper + lower) / 2
        self.first, self.last = (np.arcsin((angle - self.middle) / self.half) for angle in (START, GOAL))
        tau, x = Polynomial([0, 1]), Polynomial([-1, 2])
        window = 64 * tau**3 * (1 - tau) ** 3
        basis = [10 * tau**3 - 15 * tau**4 + 6 * tau**5, window, window * np.sqrt(15) * x]
        nodes = (np.arange(STEPS)[:, None] + 0.5 + np.array([-1, 1]) / np.sqrt(12)).ravel() / STEPS
        samples = np.linspace(0, 1, SAMPLES)
        self.tables = [
            [np.array([part.deriv(k)(at) if k else part(at) for part in basis]) for k in range(4)] for at in (nodes, samples)
        ]
        half = BASE / 2
        self.base = np.array([1.0, 0, 0, 0])
        for axis, angle in zip((3, 2, 1), half):
            self.base = product(self.base, np.cos(angle) * np.eye(4)[0] + np.sin(angle) * np.eye(4)[axis])

    def paths(self, x: np.ndarray, tables: list[np.ndarray]) -> list[np.ndarray]:
        """Angles and their derivatives by normalised time, each of shape (m, times, 6)."""
        c = np.concatenate([np.broadcast_to((self.last - self.first)[:, None], (len(x), 6, 1)), x.reshape(-1, 6, 2)], 2)
        s, ds, dds, ddds = (np.einsum("mjk,kt->mtj", c, table) for table in tables)
        s = s + self.first
        sin, cos = self.half * np.sin(s), self.half * np.cos(s)
        return [
            sin + self.middle,
            cos * ds,
            cos * dds - sin * ds**2,
            cos * ddds - 3 * sin * ds * dds - cos * ds**3,
        ]

    def base_rate(self, angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """The base's angular velocity in base axes, shape (…, 3), at zero momentum."""
        shape = angles.shape[:-1]
        frame, place = np.broadcast_to(np.eye(3), (*shape, 3, 3)), np.broadcast_to(self.robot["base"]["mount"], (*shape, 3))
        mass, first = self.robot["base"]["mass"], np.zeros((*shape, 3))
        second = np.broadcast_to(matrix(self.robot["base"]["inertia"]), (*shape, 3, 3)).copy()
        linear, angular = np.zeros((*shape, 3)), np.zeros((*shape, 3))
        w, pivots = np.zeros((*shape, 3)), []
        for k, joint in enumerate(self.robot["joint"]):
            axis = frame[..., 2]
            pivots.append((place, axis * rates[..., k, None]))
            w = w + axis * rates[..., k, None]
            own = frame @ turn(2, angles[..., k])
            r = place + own @ np.array(joint["centre_of_mass"])
            v = sum(np.cross(rate, r - pivot) for pivot, rate in pivots)
            inertia = own @ matrix(joint["inertia"]) @ own.swapaxes(-1, -2)
            m = joint["mass"]
            mass, first = mass + m, first + m * r
            second = second + inertia + m * ((r * r).sum(-1)[..., None, None] * np.eye(3) - r[..., :, None] * r[..., None, :])
            linear = linear + m * v
            angular = angular + (inertia @ w[..., None])[..., 0] + m * np.cross(r, v)
            dh = joint["dh"]
            frame = own @ turn(2, np.radians(float(dh["offset_deg"])))
            place = place + frame @ np.array([dh["a"], 0, dh["d"]])
            frame = frame @ turn(0, np.radians(float(dh["alpha_deg"])))
        centre = first / mass
        about = second - mass * ((centre * centre).sum(-1)[..., None, None] * np.eye(3) - centre[..., :, None] * centre[..., None, :])
        return -np.linalg.solve(about, (angular - np.cross(centre, linear))[..., None])[..., 0]

    def cost(self, x: np.ndarray) -> np.ndarray:
        angles, rates, *_ = self.paths(x, self.tables[0])
        omega = self.base_rate(angles, rates).reshape(len(x), STEPS, 2, 3)
        a, b = omega[:, :, 0], omega[:, :, 1]
        step = (a + b) / (2 * STEPS) + np.sqrt(3) / 12 / STEPS**2 * np.cross(a, b)
        angle = np.linalg.norm(step, axis=-1, keepdims=True)
        steps = np.concatenate([np.cos(angle / 2), np.sinc(angle / (2 * np.pi)) / 2 * step], -1)
        attitude = np.broadcast_to(self.base, (len(x), 4))
        for k in range(STEPS):
            attitude = product(attitude, steps[:, k])
        peaks = [np.abs(part).max(axis=(1, 2)) for part in self.paths(x, self.tables[1])[1:]]
        duration = np.max([(peak / limit) ** (1 / (k + 1)) for k, (peak, limit) in enumerate(zip(peaks, LIMITS))], axis=0)
        error = np.linalg.norm(attitude[:, 1:], axis=-1)
        return WEIGHT * error / UNIT + (1 - WEIGHT) * duration
