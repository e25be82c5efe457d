"""Reference values for trajectories of other programs, computed with Pinocchio and SciPy.

Independent of the project's own code: the momentum maps are those of make_reference.py, the
polynomials SciPy's, and the base's attitude is the solution of its differential equation by an
explicit Runge-Kutta method of eighth order, point to point. Run:

    pip install pin==4.1.0 numpy scipy==1.17.1 pyyaml && python make_replay.py > replay.json

It reads what stands in replay/, which was made by

    driftless plan --motion plan.yaml && python make_replay.py --cut plan.yaml

as a planner would give the default motion: 20 points, with positions alone, also as a table in
degrees with joints in another order; with rates; with rates and accelerations; and once more with
positions alone at times that are far from evenly spaced.
"""
import csv
import json
import sys
from pathlib import Path

import numpy as np
import yaml
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly, CubicSpline

from make_reference import Q0, base_map, deg

HERE = Path(__file__).parent / "replay"
NAMES = [f"joint{i + 1}" for i in range(6)]
START = np.array([6, 15, 7]) * deg  # yaw, pitch, roll; the goal is none of each


def read_yaml(path):
    message = yaml.load(path.read_text(), Loader=yaml.CSafeLoader)
    order = [message["joint_names"].index(name) for name in NAMES]
    clock = lambda t: t["sec"] + 1e-9 * t["nanosec"]
    times = np.array([clock(p["time_from_start"]) for p in message["points"]])
    lists = [np.array([p.get(key) or [] for p in message["points"]]) for key in ("positions", "velocities", "accelerations")]
    return times, [values[:, order] for values in lists if values.size]


def read_csv(path):
    rows = list(csv.DictReader(path.read_text().splitlines()))
    times = np.array([float(row["time [s]"]) for row in rows])
    return times, [np.array([[float(row[f"{name} [deg]"]) * deg for name in NAMES] for row in rows])]


def segments(times, values, reading):
    """For every two points the polynomial between them, by the time since the first of them."""
    if reading == "spline":
        spline = CubicSpline(times, values[0], bc_type="clamped")
        given = [values[0], spline(times, 1)]
    else:
        given = values[: {"linear": 1, "cubic": 2, "quintic": 3}[reading]]
    for i, width in enumerate(np.diff(times)):
        ends = [[v[i + k] for v in given] for k in (0, 1)]
        yield BPoly.from_derivatives([0, width], ends), width


def product(p, q):
    (a, u), (b, v) = (p[0], p[1:]), (q[0], q[1:])
    return np.concatenate([[a * b - u @ v], a * v + b * u + np.cross(u, v)])


def start_attitude():
    half = START / 2
    about = lambda axis, angle: np.concatenate([[np.cos(angle)], np.sin(angle) * np.eye(3)[axis]])
    return product(product(about(2, half[0]), about(1, half[1])), about(0, half[2]))


def evaluate(times, values, reading):
    attitude, rest = start_attitude(), np.zeros(6)
    peaks, before, jumps, base_rate = np.zeros((3, 6)), [rest, rest], np.zeros((2, 6)), 0.0
    for polynomial, width in segments(times, values, reading):
        rate = polynomial.derivative()

        def slope(t, q):
            return product(q, np.concatenate([[0], base_map(polynomial(t))[3:] @ rate(t)])) / 2

        found = solve_ivp(slope, (0, width), attitude, method="DOP853", rtol=3e-14, atol=1e-15)
        attitude = found.y[:, -1] / np.linalg.norm(found.y[:, -1])
        for order in range(3):
            derivative = polynomial.derivative(order + 1)
            # A linear polynomial's derivatives are none from the second on.
            sampled = np.abs(derivative(np.linspace(0, width, 2001)))
            peaks[order] = np.maximum(peaks[order], sampled.max(axis=0))
        for order in range(2):
            derivative = polynomial.derivative(order + 1)
            jumps[order] = np.maximum(jumps[order], np.abs(derivative(0.0) - before[order]))
            before[order] = derivative(width)
        for t in np.linspace(0, width, 101):
            base_rate = max(base_rate, np.linalg.norm(base_map(polynomial(t))[3:] @ rate(t)))
    jumps = np.maximum(jumps, np.abs(before))
    return {
        "base_quaternion": list(attitude * np.sign(attitude[0])),
        "residual_deg": 2 * np.arcsin(np.linalg.norm(attitude[1:])) / deg,
        "peaks": [list(p / deg) for p in peaks],
        "jumps": [list(j / deg) for j in jumps],
        "base_rate_deg_s": base_rate / deg,
    }


def cut(path):
    """Makes the files of replay/ from a motion with positions, rates and accelerations."""
    times, values = read_yaml(Path(path))
    motion = BPoly.from_derivatives(times, [list(ends) for ends in zip(*values)])
    even = np.linspace(0, times[-1], 20)
    uneven = times[-1] * (0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 20))) ** 1.5

    def write(name, times, orders, names):
        points = []
        for t in np.round(times, 9):
            lists = [[float(np.round(motion.derivative(k)(t)[NAMES.index(n)], 6)) for n in names] for k in range(orders)]
            keys = ("positions", "velocities", "accelerations", "effort")
            point = dict(zip(keys, lists + [[]] * (4 - orders)))
            point["time_from_start"] = {"sec": int(t), "nanosec": int(round(t % 1 * 1e9))}
            points.append(point)
        header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
        message = {"header": header, "joint_names": names, "points": points}
        (HERE / name).write_text(yaml.dump(message, sort_keys=False, default_flow_style=None, width=200))

    HERE.mkdir(exist_ok=True)
    backwards = NAMES[::-1]
    write("positions.yaml", even, 1, NAMES)
    write("rates.yaml", even, 2, backwards)
    write("accelerations.yaml", even, 3, NAMES)
    write("uneven.yaml", uneven, 1, NAMES)
    with open(HERE / "degrees.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time [s]"] + [f"{name} [deg]" for name in backwards])
        for t in even:
            table.writerow([f"{t:.6f}"] + [f"{motion(t)[NAMES.index(n)] / deg:.5f}" for n in backwards])


def main():
    found = {}
    for path in sorted(HERE.iterdir()):
        times, values = (read_csv if path.suffix == ".csv" else read_yaml)(path)
        assert np.abs(values[0][0] - Q0).max() < 1e-6
        readings = ["linear", "cubic", "quintic"][: len(values)]
        found[path.name] = {
            "points": len(times),
            "played": readings[-1],
            "readings": {reading: evaluate(times, values, reading) for reading in readings + ["spline"]},
        }
    print(json.dumps(found, indent=1))


if __name__ == "__main__":
    cut(sys.argv[2]) if sys.argv[1:2] == ["--cut"] else main()
