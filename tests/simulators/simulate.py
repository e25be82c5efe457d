"""Drives robots along planned motions in two simulators and compares where their bases end up.

`plan` works out the base's attitude from the conservation of momentum. A simulator knows nothing of that: it is
given the robot as a free body with an arm, at rest and without gravity, damping or contacts, and torques at the
joints; that the base turns, and how far, comes out of its equations of motion. Torques are those that make the
joints follow the motion, worked out from the state that the simulator is in (computed torque), with a spring and
a damper on what is left of the error.

Pinocchio: forward dynamics by the articulated-body algorithm, integrated by SciPy's DOP853. MuJoCo: its own
forward dynamics and fourth-order Runge-Kutta integrator.

Robot files are read by ../reference/make_robots.py, which shares no code with the program.

    python simulate.py PROGRAM [TASK.toml ...]
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib

import mujoco
import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "reference"))
import make_robots  # noqa: E402

TASKS = make_robots.SOURCE.parents[1] / "task" / "shipped"
MISSIONS = pathlib.Path(__file__).resolve().parent / "missions"
TOLERANCE_DEG = 1e-3
STIFFNESS = 100.0  # frequency of the spring on tracking errors times the motion's duration; the damping is critical
STEPS = 2000  # of MuJoCo's integrator


class Motion:
    """A planned motion, between its samples a polynomial of fifth degree with their rates and accelerations."""

    def __init__(self, path, joints):
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        times = [float(row["time"]) for row in rows if row["joint"] == joints[0]]
        samples = np.array([[[float(row[key]) for key in ("angle", "rate", "acceleration")]
                             for row in rows if row["joint"] == joint] for joint in joints])
        self.duration = times[-1]
        # Order: samples, derivatives, joints.
        self.shape = BPoly.from_derivatives(times, samples.transpose(1, 2, 0))
        self.slopes = [self.shape.derivative(k) for k in (1, 2)]
        self.start, self.end = ([float(row[f"base_{key}"]) for key in "wxyz"] for row in (rows[0], rows[-1]))

    def at(self, t):
        t = min(max(t, 0.0), self.duration)
        return self.shape(t), self.slopes[0](t), self.slopes[1](t)


def torques(inertia, bias, wanted):
    """Joint torques for wanted joint accelerations, when no force acts on the base."""
    base = np.linalg.solve(inertia[:6, :6], -bias[:6] - inertia[:6, 6:] @ wanted)
    return inertia[6:, :6] @ base + inertia[6:, 6:] @ wanted + bias[6:]


def wanted(motion, t, positions, rates):
    position, rate, acceleration = motion.at(t)
    frequency = STIFFNESS / motion.duration
    return acceleration + 2 * frequency * (rate - rates) + frequency**2 * (position - positions)


def by_pinocchio(robot, motion):
    """The base's attitude at the end and the largest tracking error."""
    model = make_robots.Model(robot)
    m, data = model.pin, model.data
    m.gravity.setZero()
    # From Pinocchio's order of joints to the file's and back.
    order = model.columns - 6
    back = np.argsort(order)
    worst = 0.0

    def split(x):
        q = x[: m.nq].copy()
        q[3:7] /= np.linalg.norm(q[3:7])
        return q, x[m.nq :]

    def rate(t, x):
        q, v = split(x)
        inertia = pin.crba(m, data, q)
        inertia = np.triu(inertia) + np.triu(inertia, 1).T
        bias = pin.nonLinearEffects(m, data, q, v)
        goal = wanted(motion, t, q[7:][order], v[6:][order])[back]
        acceleration = pin.aba(m, data, q, v, np.concatenate([np.zeros(6), torques(inertia, bias, goal)]))
        turn = pin.Quaternion(q[3:7])
        spin = turn * pin.Quaternion(np.append(v[3:6] / 2, 0.0))
        return np.concatenate([turn.matrix() @ v[:3], spin.coeffs(), v[6:], acceleration])

    w, *vector = motion.start
    q = model.configuration(motion.at(0)[0])
    q[3:7] = [*vector, w]
    times = np.linspace(0, motion.duration, 201)
    # A step must not stride over what the motion does between two samples.
    run = solve_ivp(rate, (0, motion.duration), np.concatenate([q, np.zeros(m.nv)]), method="DOP853",
                    rtol=1e-8, atol=1e-10, max_step=motion.duration / 100, t_eval=times)
    if not run.success:
        raise RuntimeError(run.message)
    for t, x in zip(times, run.y.T, strict=True):
        worst = max(worst, np.abs(split(x)[0][7:][order] - motion.at(t)[0]).max())
    return pin.Quaternion(split(run.y[:, -1])[0][3:7]).matrix(), worst


def mjcf(robot):
    """The robot for MuJoCo, and the principal moments of each body.

    MuJoCo refuses moments that no rigid body can have, where one exceeds the sum of the others; a few printed ones
    are such. A body of that kind gets sound moments about the same principal axes here; the printed ones are
    written into the compiled model.
    """
    def numbers(values):
        return " ".join(repr(float(x)) for x in values)

    def frame(place):
        x, y, z, w = pin.Quaternion(place.rotation).coeffs()
        return f'pos="{numbers(place.translation)}" quat="{numbers((w, x, y, z))}"'

    moments = {}

    def inertial(name, inertia):
        principal, axes = np.linalg.eigh(inertia.inertia)
        axes *= np.sign(np.linalg.det(axes))
        moments[name] = principal
        sound = principal if principal[0] + principal[1] >= principal[2] else np.full(3, principal.mean())
        at = frame(pin.SE3(axes, inertia.lever))
        return f'<inertial {at} mass="{inertia.mass!r}" diaginertia="{numbers(sound)}"/>'

    def body(i):
        link = robot.links[i]
        lines = [f'<body name="link{i}" {frame(link.place)}>']
        if link.joint["type"] != "fixed":
            kind = "slide" if link.joint["type"] == "prismatic" else "hinge"
            lines.append(f'<joint name="joint{i}" type="{kind}" axis="{numbers(link.joint.get("axis", (0, 0, 1)))}"/>')
        if link.inertia is not None:
            lines.append(inertial(f"link{i}", link.inertia))
        lines += [body(k) for k, other in enumerate(robot.links) if other.parent == i]
        return "\n".join([*lines, "</body>"])

    arms = "\n".join(body(k) for k, link in enumerate(robot.links) if link.parent is None)
    text = f"""<mujoco>
    <compiler angle="radian"/>
    <option gravity="0 0 0" integrator="RK4"/>
    <worldbody><body name="base"><freejoint/>{inertial("base", robot.base)}
    {arms}
    </body></worldbody>
    </mujoco>"""
    return text, moments


def by_mujoco(robot, motion):
    """The base's attitude at the end and the largest tracking error."""
    text, moments = mjcf(robot)
    m = mujoco.MjModel.from_xml_string(text)
    for name, principal in moments.items():
        m.body(name).inertia[:] = principal
    d = mujoco.MjData(m)
    mujoco.mj_setConst(m, d)
    m.opt.timestep = motion.duration / STEPS
    moving = [i for i, link in enumerate(robot.links) if link.joint["type"] != "fixed"]
    # From MuJoCo's order of joints to the file's and back.
    order = np.array([m.joint(f"joint{i}").dofadr[0] for i in moving]) - 6
    back = np.argsort(order)
    inertia = np.zeros((m.nv, m.nv))

    def drive(m, d):
        mujoco.mj_fullM(m, d, inertia)
        goal = wanted(motion, d.time, d.qpos[7:][order], d.qvel[6:][order])[back]
        d.qfrc_applied[6:] = torques(inertia, d.qfrc_bias, goal)

    d.qpos[3:7] = motion.start
    d.qpos[7:] = motion.at(0)[0][back]
    worst = 0.0
    mujoco.set_mjcb_control(drive)
    try:
        for _ in range(STEPS):
            mujoco.mj_step(m, d)
            worst = max(worst, np.abs(d.qpos[7:][order] - motion.at(d.time)[0]).max())
    finally:
        mujoco.set_mjcb_control(None)
    w, x, y, z = d.qpos[3:7]
    return pin.Quaternion(w, x, y, z).normalized().matrix(), worst


def robot_of(task):
    """The robot of a task file."""
    changed = {"locked", "base", "payload"} & tomllib.loads(task.read_text())["task"].keys()
    if changed:
        sys.exit(f"{task}: `{changed.pop()}` is not known here: convert the robot first")
    name = tomllib.loads(task.read_text())["task"]["robot"]
    if name.endswith(".toml"):
        return make_robots.read(task.parent / name)
    return make_robots.read(make_robots.SOURCE / f"{name}.toml")


def check(program, task):
    """Prints a line for each simulator; whether both agree with the plan."""
    robot = robot_of(task)
    with tempfile.TemporaryDirectory() as folder:
        file = f"{folder}/motion.csv"
        line = [program, "plan", str(task), "--json", "--motion", file]
        plan = json.loads(subprocess.run(line, check=True, stdout=subprocess.PIPE).stdout)
        motion = Motion(file, [joint["name"] for joint in robot.joints])
    agree = plan["reached"] and plan["within_limits"]
    if not agree:
        print(f"{robot.name}: the plan misses its goal by {plan['residual_deg']:.3g}° or breaks limits")
    planned = pin.Quaternion(*motion.end).normalized().matrix()
    for simulator, run in (("pinocchio", by_pinocchio), ("mujoco", by_mujoco)):
        began = time.perf_counter()
        attitude, tracking = run(robot, motion)
        difference = np.degrees(np.linalg.norm(pin.log3(planned.T @ attitude)))
        agree &= bool(difference < TOLERANCE_DEG)
        print(f"{task.stem:12} {simulator:10} t_f {motion.duration:7.3f} s  base off by {difference:.1e}°  "
              f"joints by {tracking:.1e} rad or m  {time.perf_counter() - began:5.1f} s", flush=True)
    return agree


def main():
    program, *tasks = sys.argv[1:]
    tasks = [pathlib.Path(task) for task in tasks] or sorted(TASKS.glob("*.toml")) + sorted(MISSIONS.glob("*.toml"))
    agree = [check(program, task) for task in tasks]
    if not all(agree):
        sys.exit(f"{agree.count(False)} of {len(agree)} disagree (allowed: {TOLERANCE_DEG}°)")


if __name__ == "__main__":
    main()
