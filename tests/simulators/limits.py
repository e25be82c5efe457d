"""Holds limits on the way against what other tools make of the planned motion.

For every task file in limits/: plans it without its limits and with them, and checks the two motions at 20,000
times. The base's attitude is integrated from its rate, which follows from Pinocchio's centroidal momentum map;
torques are those of Pinocchio's recursive Newton-Euler algorithm on a free flyer; the tool's speed comes from its
Jacobian; and distances of capsules and boxes, placed by Pinocchio's kinematics, from Coal. With its limits the motion
must keep them and use at least 0.99 of them; without, it must break them.

The motion is restored from the table that `--motion` writes. Its samples include the ends of all pieces of the
spline, and between these the spline is a polynomial of fourth degree, so that the polynomial of fifth degree through
angles, rates and accelerations at two samples is the motion itself. The check is the jerk, which the table has too:
the third derivative of the polynomial agrees with it to JERK of the largest. Between samples h apart the acceleration
is then off by at most h times that; next to the tolerance it counts for nothing.

    python limits.py PROGRAM [TASK.toml ...]
"""
import functools
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import numpy as np
import pinocchio as pin

import simulate
from simulate import make_robots
from solids import Scene

TASKS = pathlib.Path(__file__).resolve().parent / "limits"
TIMES = 20_000
TOLERANCE = 1e-6  # by what share a limit may be broken
BINDS = 0.99
JERK = 1e-6


class Way:
    """A motion of a floating robot, followed at equal steps."""

    def __init__(self, robot, table, task, motion):
        self.robot, self.table, self.task = robot, table, task
        self.model = make_robots.Model(robot)
        self.model.pin.gravity.setZero()
        self.times = np.linspace(0, motion.duration, TIMES)
        self.states = [motion.shape(self.times)] + [slope(self.times) for slope in motion.slopes]
        self.motion = motion

    @functools.cached_property
    def attitudes(self):
        """The base's attitude at all times, by a Lie group method of fourth order."""
        def rates(times):
            pairs = zip(self.motion.shape(times), self.motion.slopes[0](times), strict=True)
            return np.array([self.model.base_map(x)[3:] @ v for x, v in pairs])

        h = self.times[1]
        early, late = (rates(self.times[:-1] + (0.5 + side * np.sqrt(3) / 6) * h) for side in (-1, 1))
        steps = (early + late) * h / 2 + np.sqrt(3) / 12 * np.cross(early, late) * h**2
        found = [pin.Quaternion(*self.motion.start).normalized().matrix()]
        for step in steps:
            found.append(found[-1] @ pin.exp3(step))
        return found

    def turn(self):
        """Turn of the base from start, goal or the nearer, in degrees."""
        start = [np.linalg.norm(pin.log3(self.attitudes[0].T @ r)) for r in self.attitudes]
        planned = pin.Quaternion(*self.motion.end).normalized().matrix()
        goal = [np.linalg.norm(pin.log3(planned.T @ r)) for r in self.attitudes]
        reference = self.task["limits"].get("base_turn_from", "nearer")
        return np.degrees({"start": start, "goal": goal, "nearer": np.minimum(start, goal)}[reference])

    def angle(self, cone):
        """Of an axis of the base to an inertial one, in degrees."""
        axis, to = (np.array(cone[key], dtype=float) for key in ("axis", "from"))
        pointing = np.array(self.attitudes) @ (axis / np.linalg.norm(axis))
        to /= np.linalg.norm(to)
        return np.degrees(np.arctan2(np.linalg.norm(np.cross(pointing, to), axis=1), pointing @ to))

    def base_rate(self):
        """In degrees per second."""
        angles, rates, _ = self.states
        return np.degrees([np.linalg.norm(self.model.base_map(x)[3:] @ v) for x, v in zip(angles, rates, strict=True)])

    def tool_speed(self):
        angles, rates, _ = self.states
        jacobian = self.model.generalised_jacobian
        return np.array([np.linalg.norm(jacobian(x)[:3] @ v) for x, v in zip(angles, rates, strict=True)])

    def torques(self):
        """Of all joints, in the file's order, at all times."""
        m, data, columns = self.model.pin, self.model.data, self.model.columns
        found = []
        for angles, rates, accelerations in zip(*self.states, strict=True):
            q = self.model.configuration(angles)
            v, a = np.zeros(m.nv), np.zeros(m.nv)
            v[columns], a[columns] = rates, accelerations
            v[:6] = self.model.base_map(angles) @ rates
            inertia = np.triu(pin.crba(m, data, q))
            inertia += np.triu(inertia, 1).T
            # The acceleration of the base that no force acts on.
            a[:6] = -np.linalg.solve(inertia[:6, :6], pin.rnea(m, data, q, v, a)[:6])
            found.append(pin.rnea(m, data, q, v, a)[columns])
        return np.array(found)

    def clearances(self):
        """For each kind of pairs the least distance on the way, and of what."""
        scene = Scene(self.model, self.robot, self.table, self.task)
        found = [(np.inf, ())] * len(scene.kinds)
        # The system's centre of mass rests; inertial axes begin where the base's is at the start.
        rest = None
        for angles, attitude in zip(self.states[0], self.attitudes, strict=True):
            q = self.model.configuration(angles)
            centre = attitude @ pin.centerOfMass(self.model.pin, self.model.data, q)
            rest = centre if rest is None else rest
            q[:3] = rest - centre
            q[3:7] = pin.Quaternion(attitude).coeffs()
            found = [min(one, kind.least(q)) for one, kind in zip(found, scene.kinds, strict=True)]
        return found

    def shares(self):
        """For each limit of the task: see `share`."""
        limits = self.task["limits"]
        if "base_turn_deg" in limits:
            name = f"base turn from {limits.get('base_turn_from', 'nearer')}"
            yield share(name, limits["base_turn_deg"], "°", self.turn().max())
        cones = limits.get("base_cone", [])
        for cone in [cones] if isinstance(cones, dict) else cones:
            angle = self.angle(cone)
            if "within_deg" in cone:
                yield share("cone, within", cone["within_deg"], "°", angle.max())
            else:
                yield share("cone, outside", cone["outside_deg"], "°", angle.min(), least=True)
        if "base_rate_deg_s" in limits:
            yield share("base rate", limits["base_rate_deg_s"], "°/s", self.base_rate().max())
        if "tool_speed_m_s" in limits:
            yield share("tool speed", limits["tool_speed_m_s"], "m/s", self.tool_speed().max())
        if "torque_n_m" in limits:
            yield self.torque_share(limits["torque_n_m"])
        if "clearance_m" in limits:
            (near, names), (apart, touching), (nearby, solids) = self.clearances()
            if apart < 0:  # These need no distance; what overlaps counts.
                near, names = apart, touching
            own = share("clearance, " + " to ".join(names), limits["clearance_m"], "m", near, least=True)
            if not solids:
                yield own
            else:
                yield *own[:-1], False
                yield share("keep-out, " + " to ".join(solids), limits["clearance_m"], "m", nearby, least=True)

    def torque_share(self, limit):
        names = [joint["name"] for joint in self.robot.joints]
        limits = [limit[name] for name in names] if isinstance(limit, dict) else np.broadcast_to(limit, len(names))
        largest = np.abs(self.torques()).max(axis=0)
        worst = int(np.argmax(largest / limits))
        return share(f"torque, {names[worst]}", float(limits[worst]), "N m", largest[worst])


def share(name, limit, unit, value, least=False):
    """What is limited, to how much, the extreme value, the share of the limit that it is, whether that is meant to be all."""
    used = (limit / value if value > 0 else np.inf) if least else value / limit
    return name, limit, unit, float(value), float(used), True


def robot_of(task):
    path = make_robots.SOURCE / f"{task['robot']}.toml"
    return make_robots.read(path), tomllib.loads(path.read_text())


def jerk_off(path, motion, joints):
    """By what share of the largest jerk that of the restored motion differs from the table's, at the samples."""
    rows = np.genfromtxt(path, delimiter=",", names=True, dtype=None, encoding=None)
    third = motion.shape.derivative(3)
    off = largest = 0.0
    for k, joint in enumerate(joints):
        own = rows[rows["joint"] == joint]
        off = max(off, np.abs(third(own["time"])[:-1, k] - own["jerk"][:-1]).max())
        largest = max(largest, np.abs(own["jerk"]).max())
    return off / largest


@functools.cache
def plan(program, text, robot):
    """What the program says of a task, and the motion that it wrote."""
    joints = [joint["name"] for joint in make_robots.read(make_robots.SOURCE / f"{robot}.toml").joints]
    with tempfile.TemporaryDirectory() as folder:
        file, table = (pathlib.Path(folder) / name for name in ("task.toml", "motion.csv"))
        file.write_text(text)
        line = [program, "plan", str(file), "--json", "--motion", str(table)]
        run = subprocess.run(line, capture_output=True, text=True)
        if run.returncode:
            raise RuntimeError(next((line for line in run.stderr.splitlines() if line.strip()), "no message"))
        motion = simulate.Motion(table, joints)
        off = jerk_off(table, motion, joints)
    if off > JERK:
        raise RuntimeError(f"the table does not hold the motion: its jerk is off by {off:.1e}")
    return json.loads(run.stdout), motion


def check(program, file):
    """Prints a line for each limit of a task; whether all are as they should be."""
    text = file.read_text()
    task = tomllib.loads(text)["task"]
    robot, table = robot_of(task)
    free, free_motion = plan(program, f'[task]\nrobot = "{task["robot"]}"\n', robot.name)
    kept, kept_motion = plan(program, text, robot.name)
    before, after = (list(Way(robot, table, task, motion).shares()) for motion in (free_motion, kept_motion))
    fine = kept["reached"] and kept["within_limits"]
    for (*_, was, broken, _), (name, limit, unit, value, used, binds) in zip(before, after, strict=True):
        good = used <= 1 + TOLERANCE and (not binds or (used >= BINDS and broken > 1 + TOLERANCE))
        fine &= good
        print(f"| `{file.stem}` | `{task['robot']}` | {name} | {limit:g} {unit} | {free['t_f']:.3f} → {kept['t_f']:.3f} | "
              f"{was:.6g} → {value:.9g} | {used:.8f} | {kept['seconds']:.0f} |{'' if good else ' WRONG'}", flush=True)
    if not (kept["reached"] and kept["within_limits"]):
        print(f"{file.stem}: {kept['status']}, misses its goal by {kept['residual_deg']:.3g}°", flush=True)
    return fine


def main():
    program, *tasks = sys.argv[1:]
    tasks = [pathlib.Path(task) for task in tasks] or sorted(TASKS.glob("*.toml"))
    print("| task | robot | what is limited | limit | t_f [s] | extreme, without → with | share used | plan [s] |")
    print("|---|---|---|---|---|---|---|---|")
    wrong = []
    for task in tasks:
        try:
            if not check(program, task):
                wrong.append(task.stem)
        except RuntimeError as error:
            print(f"{task.stem}: {error}", flush=True)
            wrong.append(task.stem)
    if wrong:
        sys.exit(f"{len(wrong)} of {len(tasks)} tasks are not as they should be: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
