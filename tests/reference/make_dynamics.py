"""Reference values for torques of joints and speeds of free-floating robots, computed with Pinocchio.

Independent of the project's own code: robots are read from the files that come with the program by make_robots.py, and
some more from trees.json; torques come from Pinocchio's recursive Newton-Euler algorithm on a free-flyer model without
gravity, the base's twist and its derivative from the first six rows of the mass matrix, derivatives by the joints'
motion from Pinocchio's of that algorithm and the chain rule. Run:

    pip install pin==4.1.0 numpy scipy && python make_dynamics.py > dynamics.json

Conventions: as in make_robots.py. `base_acceleration` is the derivative of the base's twist along base axes;
`torques` have one entry per joint that moves, N m or N, and `torque_by` one such row per joint that moves: by
positions, rates and accelerations.
"""
import json
import pathlib

import numpy as np
import pinocchio as pin

from make_robots import SOURCE, STATES, Link, Model, Robot, read, span

HERE = pathlib.Path(__file__).resolve().parent
TREES = range(0, 64, 3)


def place(at):
    w, x, y, z = at["rotation"]
    return pin.SE3(pin.Quaternion(w, x, y, z).matrix(), np.array(at["translation"]))


def robot_of(tree):
    base = pin.Inertia(tree["base"]["mass"], np.zeros(3), np.array(tree["base"]["inertia"]))
    links = []
    for i, link in enumerate(tree["links"]):
        joint = {"name": f"joint{i}", "type": link["joint"], "axis": link["axis"]}
        inertia = pin.Inertia(link["mass"], np.array(link["centre_of_mass"]), np.array(link["inertia"]))
        links.append(Link(link["parent"], place(link), joint, inertia))
    return Robot("tree", base, links, len(links) - 1, place(tree["tool"]))


def state(model, positions, rates, accelerations, with_slopes):
    m, data, joints = model.pin, model.data, model.columns
    base = slice(6)
    q, v, a, none = model.configuration(positions), np.zeros(m.nv), np.zeros(m.nv), np.zeros(m.nv)
    v[joints], a[joints] = rates, accelerations
    mass = pin.crba(m, data, q).copy()
    mass = np.triu(mass) + np.triu(mass, 1).T
    answer = lambda push: -np.linalg.solve(mass[base, base], push)
    v[base] = answer(mass[base] @ v)
    a[base] = answer(pin.rnea(m, data, q, v, a)[base])
    forces = pin.rnea(m, data, q, v, a).copy()
    assert np.abs(forces[base]).max() < 1e-12 * (1 + np.abs(forces).max() + 100 * np.abs(mass[base] * v).max())
    pin.forwardKinematics(m, data, q, v)
    velocity = pin.getFrameVelocity(m, data, model.tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    found = {"positions": list(positions), "rates": list(rates), "accelerations": list(accelerations),
             "base_twist": v[base].tolist(), "base_acceleration": a[base].tolist(),
             "torques": forces[joints].tolist(), "tool_velocity": velocity.linear.tolist()}
    if with_slopes:
        # Momentum is the force that the twists as accelerations would take at rest.
        momentum = pin.computeRNEADerivatives(m, data, q, none, v)[0].copy()
        by_q, by_v, _ = (part.copy() for part in pin.computeRNEADerivatives(m, data, q, v, a))
        twist_by_q, twist_by_v = answer(momentum[base, joints]), answer(mass[base, joints])
        slopes = []
        for own, twist in [(by_q, twist_by_q), (by_v, twist_by_v), (mass, np.zeros((6, len(joints))))]:
            all_forces = own[:, joints] + by_v[:, base] @ twist
            slopes.append(all_forces[joints] + mass[joints, base] @ answer(all_forces[base]))
        found["torque_by"] = [slope.tolist() for slope in slopes]
    return found


def states(robot, low, high, rng):
    model = Model(robot)
    model.pin.gravity = pin.Motion.Zero()
    draw = lambda size: rng.uniform(-size, size, len(low))
    return [state(model, rng.uniform(low, high), draw(1), draw(2), i == 0) for i in range(STATES)]


def of_file(path, rng):
    robot = read(path)
    low, high = np.array([span(joint) for joint in robot.joints]).T
    return {"name": robot.name, "states": states(robot, low, high, rng)}


def of_tree(number, tree, rng):
    robot = robot_of(tree)
    high = np.array([0.5 if joint["type"] == "prismatic" else 3.0 for joint in robot.joints])
    return {"number": number, "states": states(robot, -high, high, rng)}


def main():
    rng = np.random.default_rng(9)
    trees = json.loads((HERE / "trees.json").read_text())["trees"]
    print(json.dumps({"source": f"pinocchio {pin.__version__}",
                      "robots": [of_file(path, rng) for path in sorted(SOURCE.glob("*.toml"))],
                      "trees": [of_tree(number, trees[number], rng) for number in TREES]}))


if __name__ == "__main__":
    main()
