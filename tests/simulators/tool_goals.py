"""Has `plan` bring tools to random poses that robots can reach, and checks with Pinocchio where they end up.

A pose is that of a random configuration within the joints' ranges, with the base at its goal and the system's
centre of mass where it is at the start, both by Pinocchio. The end of a planned motion is worked out from its
joints: the base's attitude by integrating its rate, which follows from Pinocchio's centroidal momentum map, its
place from the centre of mass. Poses beyond the arm's length must be refused.

    python tool_goals.py PROGRAM [--poses N] [ROBOT ...]
"""
import argparse
import json
import pathlib
import subprocess
import tempfile
import time
import tomllib

import numpy as np
import pinocchio as pin

import simulate
from limits import Way
from simulate import make_robots

ROBOTS = ["ur5e", "xiao2023", "panda"]
TOLERANCE_M = 1e-6
TOLERANCE_DEG = 1e-4


def attitude(zyx_deg):
    yaw, pitch, roll = np.radians(zyx_deg)
    return pin.rpy.rpyToMatrix(roll, pitch, yaw)


def pose(model, joints, base, centre):
    """The tool's pose where the system's centre of mass is at `centre`."""
    q = model.configuration(joints)
    q[3:7] = pin.Quaternion(base).coeffs()
    q[:3] += centre - pin.centerOfMass(model.pin, model.data, q)
    pin.framesForwardKinematics(model.pin, model.data, q)
    return model.data.oMf[model.tool].copy()


def plan(program, robot, goal, folder, options=()):
    task = pathlib.Path(folder) / "task.toml"
    task.write_text(f'[task]\nrobot = "{robot}"\n[task.goal]\n{goal}\n')
    motion = pathlib.Path(folder) / "motion.csv"
    line = [program, "plan", str(task), "--json", "--motion", str(motion), *options]
    began = time.perf_counter()
    done = subprocess.run(line, capture_output=True, text=True)
    return done, motion, time.perf_counter() - began


def check(program, name, poses, folder):
    """Plans to random poses of one robot; prints how many are reached, how exactly, and how long that takes."""
    robot = make_robots.read(make_robots.SOURCE / f"{name}.toml")
    task = tomllib.loads((simulate.TASKS / f"{name}.toml").read_text())["task"]
    model = make_robots.Model(robot)
    start, base = (attitude(task[end].get("base_zyx_deg", [0, 0, 0])) for end in ("start", "goal"))
    at_start = model.configuration(np.radians(task["start"]["joints_deg"]))
    at_start[3:7] = pin.Quaternion(start).coeffs()
    centre = pin.centerOfMass(model.pin, model.data, at_start).copy()
    rng = np.random.default_rng(1)
    lower, upper = np.radians([joint.get("range_deg", [-360, 360]) for joint in robot.joints]).T
    reached, misses, turns, seconds, durations = 0, [], [], [], []
    for _ in range(poses):
        wanted = pose(model, rng.uniform(lower, upper), base, centre)
        zyx = np.degrees(pin.rpy.matrixToRpy(wanted.rotation)[::-1])
        goal = f"tool = {{ position_m = {wanted.translation.tolist()}, zyx_deg = {zyx.tolist()} }}"
        done, file, took = plan(program, name, goal, folder)
        if done.returncode:
            print(f"{name}: {done.stderr}")
            continue
        found = json.loads(done.stdout)
        motion = simulate.Motion(file, [joint["name"] for joint in robot.joints])
        end = Way(robot, None, task, motion).attitudes[-1]
        there = pose(model, motion.at(motion.duration)[0], end, centre)
        misses.append(np.linalg.norm(there.translation - wanted.translation))
        turns.append(np.degrees(np.linalg.norm(pin.log3(there.rotation.T @ wanted.rotation))))
        reached += found["reached"] and misses[-1] < TOLERANCE_M and turns[-1] < TOLERANCE_DEG
        seconds.append(took)
        durations.append(found["t_f"])
    print(f"{name:10} {reached} of {poses} reached, off by {max(misses):.1e} m and {max(turns):.1e}° at most, "
          f"t_f {np.median(durations):.2f} s and {np.median(seconds):.1f} s to plan in the median, "
          f"{max(seconds):.1f} s at most", flush=True)
    done, *_ = plan(program, name, "tool = { position_m = [60, 0, 0] }", folder)
    refused = done.returncode == 2 and "cannot be brought there" in done.stderr
    if not refused:
        print(f"{name}: a tool 60 m away is not refused: {done.stderr}")
    return reached == poses and refused


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("robots", nargs="*")
    parser.add_argument("--poses", type=int, default=100)
    asked = parser.parse_intermixed_args()
    with tempfile.TemporaryDirectory() as folder:
        good = [check(asked.program, name, asked.poses, folder) for name in asked.robots or ROBOTS]
    return not all(good)


if __name__ == "__main__":
    raise SystemExit(main())
