"""Holds the program's reading of URDF files against Pinocchio's.

Each file is put on a base. The base's twist at zero momentum for random states of the joints, as the example
`base_twist` prints it, must be that of Pinocchio, which reads the file itself, with a free flyer at the root. Prints a
line for each file; fails above 1e-10 (m/s and rad/s).

    python urdfs.py EXAMPLE [FILE.urdf ...]

Without files, those of the PyPI package example-robot-data that ROBOTS names.
"""
import json
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import xml.etree.ElementTree as ET

import numpy as np
import pinocchio as pin

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "reference"))
import make_robots  # noqa: E402

STATES = 10
TOLERANCE = 1e-10
BASE = """[base]
mass = 300.0
inertia = { xx = 50.0, yy = 60.0, zz = 70.0, xy = 1.0, xz = -2.0, yz = 3.0 }
mount = [0.3, -0.2, 0.6]
mount_zyx_deg = [30.0, 20.0, 10.0]
"""
# Arms, hands, arms on wheels, legged robots and humanoids; among them mimic, continuous and prismatic joints, roots
# without mass, links without mass between joints and axes of another length than one.
ROBOTS = [
    "panda_description/urdf/panda.urdf",
    "ur_description/urdf/ur5_robot.urdf",
    "ur_description/urdf/ur10_robot.urdf",
    "kinova_description/robots/kinova.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "z1_description/urdf/z1.urdf",
    "so_arm_description/urdf/so101.urdf",
    "talos_data/robots/talos_left_arm.urdf",
    "talos_data/robots/talos_full_v2.urdf",
    "baxter_description/urdf/baxter.urdf",
    "allegro_hand_description/urdf/allegro_left_hand.urdf",
    "tiago_pro_description/robots/tiago_pro.urdf",
    "pr2_description/urdf/pr2.urdf",
    "go1_description/urdf/go1.urdf",
    "anymal_b_simple_description/robots/anymal-kinova.urdf",
    "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
    "human_description/robots/human.urdf",
    "alex_description/urdf/alex_psyonic_hands.urdf",
    "romeo_description/urdf/romeo_small.urdf",
    "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
]


def followers(path):
    """The mimic joints of a file, which are locked as near to zero as their ranges allow: name to position."""
    found = {}
    for joint in ET.parse(path).getroot().iter("joint"):
        if joint.find("mimic") is not None and joint.get("type") != "fixed":
            limit = joint.find("limit").attrib
            lower, upper = (float(limit.get(end, 0)) for end in ("lower", "upper"))
            found[joint.get("name")] = min(max(0.0, lower), upper)
    return found


def reference(path, locked, seed):
    """Base twists at random joint positions and rates, linear above angular, from Pinocchio, for the file on the base.

    Axes are the base's, with their origin at its centre of mass. Continuous joints are angles.
    """
    m = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
    base = tomllib.loads(BASE)["base"]
    mount = make_robots.placement(base["mount"], base["mount_zyx_deg"])
    m.appendBodyToJoint(1, make_robots.inertia_of(base, np.zeros(3)), mount.inverse())
    data = m.createData()
    columns = {m.names[j]: m.idx_vs[j] for j in range(2, m.njoints)}
    assert all(m.joints[j].nv == 1 for j in range(2, m.njoints)), f"{path} has joints of several degrees of freedom"
    rng, states = np.random.default_rng(seed), []
    for _ in range(STATES):
        positions = {name: rng.uniform(-1.5, 1.5) for name in columns} | locked
        rates = {name: rng.uniform(-1, 1) for name in columns} | dict.fromkeys(locked, 0.0)
        step, v = np.zeros(m.nv), np.zeros(m.nv)
        for name, column in columns.items():
            step[column], v[column] = positions[name], rates[name]
        momentum = pin.computeCentroidalMap(m, data, pin.integrate(m, pin.neutral(m), step))
        twist = mount.act(pin.Motion(-np.linalg.solve(momentum[:, :6], momentum @ v)))
        states.append({"positions": positions, "rates": rates, "base_twist": twist.vector})
    return states


def given(path, locked, folder):
    """A robot file with the URDF on the base."""
    file = pathlib.Path(folder) / "given.toml"
    file.write_text(f'name = "given"\nurdf = "{path}"\nlocked = {json.dumps(list(locked))}\n{BASE}')
    return file


def twists(example, file, states):
    """The same twists by the program's own reading and physics."""
    asked = json.dumps([{key: state[key] for key in ("positions", "rates")} for state in states])
    told = subprocess.run([example, file], input=asked, check=True, stdout=subprocess.PIPE, text=True).stdout
    return np.array(json.loads(told))


def difference(example, path, seed):
    """The largest difference of a twist's component."""
    locked = followers(path)
    states = reference(path, locked, seed)
    with tempfile.TemporaryDirectory() as folder:
        ours = twists(example, given(path, locked, folder), states)
    return np.abs(ours - [state["base_twist"] for state in states]).max()


def main():
    example, *names = sys.argv[1:]
    folder = pathlib.Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
    paths = [pathlib.Path(name).resolve() for name in names] or [folder / name for name in ROBOTS]
    agree = []
    for seed, path in enumerate(paths):
        off = difference(example, path, seed)
        agree.append(off < TOLERANCE)
        print(f"{path.name:36} base's twist off by {off:.1e}", flush=True)
    if not all(agree):
        sys.exit(f"{agree.count(False)} of {len(agree)} disagree (allowed: {TOLERANCE})")


if __name__ == "__main__":
    main()
