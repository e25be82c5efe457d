"""Random tasks of an arm with eight joints on a satellite with a solid nearby, and how many of them are solved.

    python trials.py PROGRAM [COUNT]

The arm is that of `iiwa` on a boom of 0.5 m that turns on the satellite: eight joints. Starts and goals are drawn
within half of all ranges; both are at least 0.05 m from any touch, by Coal. The base is to be at the goal as it was at the
start, all bodies stay 0.02 m apart, and a ball of 0.25 m radius floats 1 m beside the arm's foot.
"""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import tomllib

import numpy as np

from simulate import make_robots
from solids import Scene

BOOM = """[[link]]
name = "boom"
joint = { name = "boom_joint", type = "revolute", axis = [0, 0, 1], range_deg = [-170, 170], rate_deg_s = 60, torque_n_m = 320 }
mass = 8
centre_of_mass = [0, 0, 0.25]
inertia = { xx = 0.19, yy = 0.19, zz = 0.04 }
shapes = [{ capsule = { from = [0, 0, 0.1], to = [0, 0, 0.4], radius = 0.1 } }]
"""
FOOT = 'parent = "boom"\nposition = [0, 0, 0.5]\n'
KEEP_OUT = {"ball": {"shapes": [{"sphere": {"centre": [0.3, 0.8, 1.4], "radius": 0.25}}]}}
START, KEPT = 0.05, 0.02


def robot_text():
    text = (make_robots.SOURCE / "iiwa.toml").read_text().replace('name = "iiwa"', 'name = "boom_iiwa"', 1)
    before, foot, after = text.partition("[[link]]\n")
    name, line, rest = after.partition("\n")
    return before + BOOM + foot + name + line + FOOT + rest


def task_text(start, goal):
    (ball,) = KEEP_OUT["ball"]["shapes"]
    sphere = ball["sphere"]
    rows = [np.round(x, 2).tolist() for x in (start, goal)]
    return f"""[task]
robot = "robot.toml"
[task.start]
joints_deg = {rows[0]}
base_zyx_deg = [0, 0, 0]
[task.goal]
joints_deg = {rows[1]}
base_zyx_deg = [0, 0, 0]
[task.limits]
rate_deg_s = 60
acceleration_deg_s2 = 70
jerk_deg_s3 = 80
clearance_m = {KEPT}
[task.keep_out.ball]
shapes = [{{ sphere = {{ centre = {sphere["centre"]}, radius = {sphere["radius"]} }} }}]
"""


def pairs(file, count):
    """Starts and goals in degrees, all free of touch."""
    robot = make_robots.read(file)
    table = tomllib.loads(file.read_text())
    model = make_robots.Model(robot)
    scene = Scene(model, robot, table, {"limits": {"clearance_m": KEPT}, "keep_out": KEEP_OUT})
    low, high = np.degrees([make_robots.span(joint) for joint in robot.joints]).T / 2
    rng = np.random.default_rng(2017)

    def draw():
        while True:
            posture = rng.uniform(low, high)
            q = model.configuration(np.radians(posture))
            (near, _), (apart, _), (solids, _) = (kind.least(q) for kind in scene.kinds)
            if min(near, solids) > START and apart > 0:
                return posture

    return [(draw(), draw()) for _ in range(count)]


def main():
    program, *count = sys.argv[1:]
    count = int(count[0]) if count else 20
    solved, durations = [], []
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "robot.toml").write_text(robot_text())
        task = folder / "task.toml"
        for k, (start, goal) in enumerate(pairs(folder / "robot.toml", count), 1):
            task.write_text(task_text(start, goal))
            run = subprocess.run([program, "plan", str(task), "--json"], capture_output=True, text=True)
            if not run.stdout:
                print(f"{k}: {run.stderr.strip().splitlines()[0]}", flush=True)
                continue
            found = json.loads(run.stdout)
            kept = found["reached"] and found["within_limits"]
            print(f"{k}: {found['status']}, t_f {found['t_f']:.2f} s, off by {found['residual_deg']:.1e}°, clearance "
                  f"{found['clearance_m']:.4f} m of {' and '.join(found['clearance_between'])}, {found['seconds']:.1f} s", flush=True)
            if kept:
                solved.append(found["seconds"])
                durations.append(found["t_f"])
            so_far = f"solved {len(solved)} of {k}"
    if solved:
        print(f"{so_far}; seconds: median {statistics.median(solved):.1f}, {min(solved):.1f} to {max(solved):.1f}; "
              f"t_f: median {statistics.median(durations):.1f}")


if __name__ == "__main__":
    main()
