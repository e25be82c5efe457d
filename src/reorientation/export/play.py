"""Plays a planned motion of a free-floating robot in MuJoCo.

    python play.py          prints where the base ends; fails where that is not as planned
    python play.py --view   shows the motion, too

The robot of robot.xml floats without gravity. Torques at its joints make them follow motion.wide.csv; they are worked out from
the simulator's inertia matrix and state (computed torque), with a spring and a damper on what is left of the error. Nothing
acts on the base: how it turns comes out of MuJoCo's equations of motion. Needs the packages mujoco and numpy.
"""
import argparse
import csv
import pathlib
import sys
import time

import mujoco
import numpy as np

FOLDER = pathlib.Path(__file__).resolve().parent
STIFFNESS = 100.0  # frequency of the spring on tracking errors times the motion's duration; the damping is critical


class Motion:
    """The samples in the order of the model's joints; between them polynomials of fifth degree."""

    def __init__(self, path, model):
        with open(path, newline="", encoding="utf-8") as file:
            names, *rows = csv.reader(file)
        table = dict(zip(names, np.array(rows, dtype=float).T, strict=True))
        self.time = table["time [s]"]
        self.duration = self.time[-1]
        # The first joint of the model is the base's.
        joints = [model.joint(i) for i in range(1, model.njnt)]
        slides = [joint.type[0] == mujoco.mjtJoint.mjJNT_SLIDE for joint in joints]

        def of_joints(quantity, units):
            columns = [f"{joint.name}_{quantity} [{units[slide]}]" for joint, slide in zip(joints, slides, strict=True)]
            return np.stack([table[column] for column in columns], axis=1)

        self.position = of_joints("position", ("rad", "m"))
        self.rate = of_joints("rate", ("rad/s", "m/s"))
        self.acceleration = of_joints("acceleration", ("rad/s^2", "m/s^2"))
        self.torque = of_joints("torque", ("N m", "N"))
        self.attitude = np.stack([table[f"base_{key}"] for key in "wxyz"], axis=1)
        self.base_position = np.stack([table[f"base_position_{key} [m]"] for key in "xyz"], axis=1)
        self.base_rate = np.stack([table[f"base_rate_{key} [rad/s]"] for key in "xyz"], axis=1)

    def at(self, t):
        """Positions, rates and accelerations."""
        t = min(max(t, 0.0), self.duration)
        i = min(int(np.searchsorted(self.time, t, side="right")) - 1, len(self.time) - 2)
        width = self.time[i + 1] - self.time[i]
        s = (t - self.time[i]) / width
        p, q = self.position[i : i + 2]
        v, w = self.rate[i : i + 2] * width
        a, b = self.acceleration[i : i + 2] * width**2
        rise, slope, bend = q - p - v - a / 2, w - v - a, b - a
        c3, c4, c5 = 10 * rise - 4 * slope + bend / 2, -15 * rise + 7 * slope - bend, 6 * rise - 3 * slope + bend / 2
        return (
            p + s * (v + s * (a / 2 + s * (c3 + s * (c4 + s * c5)))),
            (v + s * (a + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))) / width,
            (a + s * (6 * c3 + s * (12 * c4 + s * 20 * c5))) / width**2,
        )


def load():
    """The model, with the moments of inertia that the robot states, and its motion."""
    model = mujoco.MjModel.from_xml_path(str(FOLDER / "robot.xml"))
    for i in range(model.nnumeric):
        numeric = model.numeric(i)
        if numeric.name.startswith("inertia of "):
            model.body(numeric.name.removeprefix("inertia of ")).inertia[:] = numeric.data
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return model, Motion(FOLDER / "motion.wide.csv", model)


def times_inertia(model, data, vector):
    product = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, product, vector)
    return product


def base_inertia(model, data):
    return np.array([times_inertia(model, data, row) for row in np.eye(6, model.nv)])[:, :6]


def torques(model, data, wanted):
    """Torques for wanted accelerations of the joints where no force acts on the base."""
    acceleration = np.concatenate([np.zeros(6), wanted])
    force = times_inertia(model, data, acceleration) + data.qfrc_bias
    acceleration[:6] = np.linalg.solve(base_inertia(model, data), -force[:6])
    return (times_inertia(model, data, acceleration) + data.qfrc_bias)[6:]


def place(model, data, attitude, base_position, base_rate, position, rate):
    """Puts the robot there; its centre of mass stands still."""
    data.qpos[:] = np.concatenate([base_position, attitude, position])
    data.qvel[:] = np.concatenate([np.zeros(3), base_rate, rate])
    mujoco.mj_forward(model, data)
    data.qvel[:3] = -times_inertia(model, data, data.qvel)[:3] / base_inertia(model, data)[0, 0]
    mujoco.mj_forward(model, data)


def play(model, motion, steps, each=lambda data: None):
    """The state at the end, and the largest error of a joint's position on the way."""
    data = mujoco.MjData(model)
    model.opt.timestep = motion.duration / steps
    place(model, data, motion.attitude[0], motion.base_position[0], motion.base_rate[0], motion.position[0], motion.rate[0])
    frequency = STIFFNESS / motion.duration

    def drive(model, data):
        position, rate, acceleration = motion.at(data.time)
        spring = frequency**2 * (position - data.qpos[7:]) + 2 * frequency * (rate - data.qvel[6:])
        data.qfrc_applied[6:] = torques(model, data, acceleration + spring)

    worst = 0.0
    mujoco.set_mjcb_control(drive)
    try:
        for _ in range(steps):
            mujoco.mj_step(model, data)
            worst = max(worst, np.abs(data.qpos[7:] - motion.at(data.time)[0]).max())
            each(data)
    finally:
        mujoco.set_mjcb_control(None)
    return data, worst


def play_in_view(model, motion, steps):
    import mujoco.viewer

    shown = mujoco.MjData(model)
    mujoco.mj_forward(model, shown)
    with mujoco.viewer.launch_passive(model, shown) as viewer:
        start = time.monotonic()

        def show(data):
            if viewer.is_running():
                time.sleep(max(0.0, start + data.time - time.monotonic()))
                shown.qpos[:] = data.qpos
                mujoco.mj_kinematics(model, shown)
                viewer.sync()

        end = play(model, motion, steps, show)
        while viewer.is_running():
            time.sleep(0.05)
    return end


def angle_deg(a, b):
    """Between two attitudes."""
    conjugate, difference = np.zeros(4), np.zeros(4)
    mujoco.mju_negQuat(conjugate, a)
    mujoco.mju_mulQuat(difference, conjugate, b)
    return np.degrees(2 * np.arctan2(np.linalg.norm(difference[1:]), abs(difference[0])))


def main():
    parser = argparse.ArgumentParser(description="Plays a planned motion of a free-floating robot in MuJoCo.")
    parser.add_argument("--view", action="store_true", help="show the motion")
    parser.add_argument("--steps", type=int, default=2000, help="steps of the integrator [default: 2000]")
    parser.add_argument("--tolerance-deg", type=float, default=0.01, help="how far the base may end from the plan [default: 0.01]")
    asked = parser.parse_args()
    model, motion = load()
    data, worst = (play_in_view if asked.view else play)(model, motion, asked.steps)
    attitude, planned = data.qpos[3:7], motion.attitude[-1]
    attitude = attitude * np.sign(attitude @ planned)
    apart = angle_deg(attitude, planned)
    moved = np.linalg.norm(data.qpos[:3] - motion.base_position[-1])

    def shown(quaternion):
        return ", ".join(f"{key} {value:.9f}" for key, value in zip("wxyz", quaternion, strict=True))

    print(f"base ends at   {shown(attitude)}")
    print(f"planned        {shown(planned)}")
    print(f"difference     {apart:.6f} deg, {moved:.1e} m")
    print(f"joints         within {worst:.1e} rad or m of the motion")
    if not apart <= asked.tolerance_deg:
        sys.exit(f"the base ends {apart:.6f} deg from the plan (allowed: {asked.tolerance_deg})")


if __name__ == "__main__":
    main()
