"""Motions in every format, read by the tools whose formats they are: check.py PROGRAM FOLDER TASK …

The wide table is read by numpy and compared with the others: the MAT-file as SciPy reads it, the messages as PyYAML does and as
ROS 2's message types hold them, and what `plan --json` says. Torques and the base's rate and place are worked out again by MuJoCo from positions, rates and
accelerations of the joints, on the model that the program writes; then its player drives the robot along the motion.
"""
import csv
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys

import mujoco
import numpy as np
import scipy.io
import yaml
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

RATE = 200  # samples per second
QUANTITIES = ["position", "rate", "acceleration", "jerk", "torque"]
BASE = {"base_quaternion": ["base_w", "base_x", "base_y", "base_z"],
        "base_zyx": ["base_yaw [rad]", "base_pitch [rad]", "base_roll [rad]"],
        "base_position": ["base_position_x [m]", "base_position_y [m]", "base_position_z [m]"],
        "base_rate": ["base_rate_x [rad/s]", "base_rate_y [rad/s]", "base_rate_z [rad/s]"]}
SAME_DEG = 1e-3  # how far bases may end from each other


def expect(is_so, text):
    if not is_so:
        raise SystemExit(f"not as expected: {text}")


def call(*command):
    return subprocess.run([str(part) for part in command], check=True, capture_output=True, text=True).stdout


def wide(path):
    """The table by numpy: columns by name."""
    with open(path, newline="", encoding="utf-8") as file:
        names = next(csv.reader(file))
    numbers = np.loadtxt(path, delimiter=",", skiprows=1)
    return dict(zip(names, numbers.T, strict=True))


def of_joints(table, joints, quantity):
    """A column for each joint."""
    found = [[name for name in table if name.startswith(f"{joint}_{quantity} [")] for joint in joints]
    expect(all(len(names) == 1 for names in found), f"one column of {quantity} per joint, found {found}")
    return np.stack([table[name] for [name] in found], axis=1)


def check_times(table, duration):
    time = table["time [s]"]
    expect(np.array_equal(time[:-1], np.arange(len(time) - 1) / RATE), "times at multiples of the step")
    expect(time[-1] == duration, f"the last sample at {duration} s, found {time[-1]}")
    expect(0.1 / RATE <= time[-1] - time[-2] < 1.1 / RATE, "a last step of a tenth of a step at least")


def check_mat(path, table, joints, units):
    mat = scipy.io.loadmat(path)
    texts = {name: [str(cell[0]) for cell in mat[name].ravel()] for name in ("joint_names", "joint_units", "torque_units")}
    expect(texts["joint_names"] == joints, f"names {joints}, found {texts['joint_names']}")
    expect(texts["joint_units"] == units, f"units {units}, found {texts['joint_units']}")
    expect(texts["torque_units"] == ["N" if unit == "m" else "N m" for unit in units], "units of torques")
    expect(np.array_equal(mat["time"].ravel(), table["time [s]"]), "the same times")
    for quantity in QUANTITIES:
        expect(np.array_equal(mat[quantity], of_joints(table, joints, quantity)), f"the same {quantity} in the MAT-file")
    for name, columns in BASE.items():
        expect(np.array_equal(mat[name], np.stack([table[column] for column in columns], axis=1)), f"the same {name}")
    return mat["robot"][0]


def check_octave(path, table, joints):
    """Octave's own reader, where there is one."""
    octave = shutil.which("octave-cli") or shutil.which("octave")
    if octave is None:
        return "not installed"
    code = (f"m = load('{path}'); printf('%s %d %d %.17g\\n', m.joint_names{{end}}, rows(m.position), columns(m.position), "
            "m.position(end, end));")
    name, rows, columns, end = call(octave, "--quiet", "--no-init-file", "--eval", code).split()
    positions = of_joints(table, joints, "position")
    expect((name, int(rows), int(columns)) == (joints[-1], *positions.shape), "the same matrix in Octave")
    expect(float(end) == positions[-1, -1], "the same number in Octave")
    return "read"


ROS = get_typestore(Stores.ROS2_JAZZY)
# The parts of control_msgs/action/FollowJointTrajectory's goal that concern joints.
GOAL = "control_msgs/msg/FollowJointTrajectoryGoal"
ROS.register(get_types_from_msg("string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration\n", "control_msgs/msg/JointTolerance"))
ROS.register(get_types_from_msg(
    "trajectory_msgs/msg/JointTrajectory trajectory\ncontrol_msgs/msg/JointTolerance[] path_tolerance\n"
    "control_msgs/msg/JointTolerance[] goal_tolerance\nbuiltin_interfaces/msg/Duration goal_time_tolerance\n", GOAL))


def to_ros(kind, value):
    """A message of a type, from all of its fields and no others."""
    fields = dict(ROS.fielddefs[kind][1])
    expect(set(value) == set(fields), f"the fields of {kind}, found {sorted(value)}")

    def field(definition, value):
        node, detail = definition
        if node == Nodetype.NAME:
            return to_ros(detail, value)
        if node in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            (inner, name), _ = detail
            if inner == Nodetype.BASE and name[0] != "string":
                return np.array(value, dtype=name[0])
            return [field((inner, name), item) for item in value]
        return value

    return ROS.types[kind](**{name: field(definition, value[name]) for name, definition in fields.items()})


def check_ros(kind, value, joints):
    """What a node would get over the wire."""
    there = ROS.deserialize_cdr(ROS.serialize_cdr(to_ros(kind, value), kind), kind)
    sent = value.get("trajectory", value)
    trajectory = getattr(there, "trajectory", there)
    expect(trajectory.joint_names == joints and len(trajectory.points) == len(sent["points"]), f"all points of a {kind}")
    for point, wanted in zip(trajectory.points, sent["points"], strict=True):
        same = all(np.array_equal(getattr(point, key), wanted[key]) for key in ("positions", "velocities", "accelerations"))
        clock = (point.time_from_start.sec, point.time_from_start.nanosec)
        expect(same and clock == tuple(wanted["time_from_start"].values()), f"the same points in a {kind}")


def check_messages(folder, table, joints):
    message = yaml.safe_load((folder / "m.yaml").read_text())
    goal = yaml.safe_load((folder / "m.goal.yaml").read_text())
    check_ros("trajectory_msgs/msg/JointTrajectory", message, joints)
    check_ros(GOAL, goal, joints)
    expect(goal.pop("trajectory") == message, "the message within the goal")
    no_time = {"sec": 0, "nanosec": 0}
    expect(goal == {"path_tolerance": [], "goal_tolerance": [], "goal_time_tolerance": no_time}, "empty tolerances")
    expect(message["joint_names"] == joints, "the joints' names in the message")
    clocks = [point["time_from_start"] for point in message["points"]]
    times = np.array([clock["sec"] + 1e-9 * clock["nanosec"] for clock in clocks])
    expect(np.abs(times - table["time [s]"]).max() < 1e-9, "the same times in the message")
    for key, quantity in [("positions", "position"), ("velocities", "rate"), ("accelerations", "acceleration")]:
        numbers = np.array([point[key] for point in message["points"]])
        # Numbers of the message are those of whole nanoseconds.
        expect(np.abs(numbers - of_joints(table, joints, quantity)).max() < 1e-8, f"the same {key} in the message")


def check_long(path, table, joints):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    expect([row["joint"] for row in rows[: len(joints)]] == joints, "the joints' order")
    for quantity in QUANTITIES:
        name = "angle" if quantity == "position" else quantity
        numbers = np.array([float(row[name]) for row in rows]).reshape(-1, len(joints))
        expect(np.array_equal(numbers, of_joints(table, joints, quantity)), f"the same {quantity} in the long table")
    for column in sum(BASE.values(), []):
        numbers = np.array([float(row[column.split(" ")[0]]) for row in rows])[:: len(joints)]
        expect(np.array_equal(numbers, table[column]), f"the same {column} in the long table")


def player(folder):
    spec = importlib.util.spec_from_file_location("play", folder / "play.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def check_physics(play):
    """Torques, rate and place of the base by MuJoCo, at every tenth time: largest differences, by the largest value."""
    model, motion = play.load()
    data = mujoco.MjData(model)
    found = {"torque": [], "base_rate": [], "base_position": []}
    mass = model.body_subtreemass[0]
    start = None
    times = range(0, len(motion.time), 10)
    for i in times:
        play.place(model, data, motion.attitude[i], np.zeros(3), np.zeros(3), motion.position[i], motion.rate[i])
        # The base's twist with which the whole has no momentum.
        of_joints = -play.times_inertia(model, data, data.qvel)[:6]
        data.qvel[:6] += np.linalg.solve(play.base_inertia(model, data), of_joints)
        mujoco.mj_forward(model, data)
        found["torque"].append(play.torques(model, data, motion.acceleration[i]))
        found["base_rate"].append(data.qvel[3:6].copy())
        # What stays where it is, is the centre of all masses.
        centre = model.body_mass @ data.xipos / mass
        start = centre if start is None else start
        found["base_position"].append(start - centre)
    off = {}
    for name, values in found.items():
        own = getattr(motion, name)[times]
        off[name] = np.abs(np.array(values) - own).max() / np.abs(own).max()
        expect(off[name] < 1e-6, f"the same {name} by MuJoCo, off by {off[name]:.1e} of the largest")
    return max(off.values())


def check(program, task, folder):
    folder.mkdir(parents=True)
    plan = [program, "plan", task, "--json", "--budget", "300"]
    for name in ["m.csv", "m.wide.csv", "m.mat", "m.yaml", "m.goal.yaml", "m.mujoco"]:
        planned = json.loads(call(*plan, "--rate", RATE, "--motion", folder / name))
    table = wide(folder / "m.wide.csv")
    joints = [name.split("_position [")[0] for name in table if "_position [" in name]
    units = ["m" if unit == "m" else "rad" for unit in planned["peaks"].get("unit", ["deg"] * len(joints))]
    check_times(table, planned["t_f"])
    robot = check_mat(folder / "m.mat", table, joints, units)
    octave = check_octave(folder / "m.mat", table, joints)
    check_messages(folder, table, joints)
    check_long(folder / "m.csv", table, joints)
    expect((folder / "m.mujoco" / "motion.wide.csv").read_bytes() == (folder / "m.wide.csv").read_bytes(), "the same motion for MuJoCo")
    for name in ["m.csv", "m.wide.csv", "m.yaml", "m.goal.yaml"]:
        replayed = json.loads(call(program, "replay", folder / name, "--task", task, "--json"))
        expect(abs(replayed["t_f"] - planned["t_f"]) < 1e-9, f"the same duration from {name}")
        expect(abs(replayed["residual_deg"] - planned["residual_deg"]) < SAME_DEG, f"the same end from {name}")
        expect(not replayed["ignored_columns"], f"all columns of {name} known")
    off = check_physics(player(folder / "m.mujoco"))
    told = call(sys.executable, folder / "m.mujoco" / "play.py", "--tolerance-deg", SAME_DEG)
    [difference] = [line for line in told.splitlines() if line.startswith("difference")]
    print(f"{robot:10} {len(joints):2} joints, {len(table['time [s]'])} samples: formats agree (Octave: {octave}), MuJoCo's torques and base "
          f"within {off:.0e}, its end within {' '.join(difference.split()[1:])}", flush=True)


def main(program, folder, *tasks):
    for task in tasks:
        check(program, task, pathlib.Path(folder) / pathlib.Path(task).stem)


if __name__ == "__main__":
    main(*sys.argv[1:])
