"""Reference values for random trees of links on a floating base, computed with Pinocchio.

Independent of the project's own code: momentum maps come from Pinocchio's centroidal algorithms on a
free-flyer model. Derivatives by positions come from an independent recursion over the same tree in
arithmetic of 50 digits (mpmath), by central differences of fourth order with a step of 1e-10, which is
right to about 1e-38; the same recursion's values are compared with Pinocchio's first. Run:

    pip install pin==4.1.0 numpy mpmath && python make_trees.py > trees.json

Conventions: base axes, origin at the base's centre of mass; a link's frame is its joint's frame moved by
the joint; placements are given as origin and quaternion (w, x, y, z); twists are linear above angular;
units m, kg, rad, s. The tool is on the last link.
"""
import json

import mpmath as mp
import numpy as np
import pinocchio as pin

mp.mp.dps = 50
TREES = 64


def unit(v):
    return v / np.linalg.norm(v)


def draw_inertia(rng, mass):
    """Of a solid box, turned."""
    a, b, c = rng.uniform(0.1, 0.8, 3)
    box = mass / 12 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    turn = pin.Quaternion(unit(rng.normal(size=4))).matrix()
    inertia = turn @ box @ turn.T
    return (inertia + inertia.T) / 2


def draw_rotation(rng):
    """General, or of quarter turns, or nearly none."""
    kind = rng.integers(4)
    if kind == 0:
        return np.array([1.0, 0, 0, 0])
    if kind == 1:
        axis = rng.integers(3)
        q = np.array([np.sqrt(0.5), 0, 0, 0])
        q[1 + axis] = rng.choice([-1, 1]) * np.sqrt(0.5)
        return q
    if kind == 2:
        return unit(np.concatenate([[1.0], 0.02 * rng.normal(size=3)]))
    return unit(rng.normal(size=4))


def draw_axis(rng):
    kind = rng.integers(3)
    if kind == 0:
        return np.array([0.0, 0, 1])
    if kind == 1:
        axis = np.zeros(3)
        axis[rng.integers(3)] = rng.choice([-1, 1])
        return axis
    return unit(rng.normal(size=3))


def draw_tree(rng, moving):
    links = []
    left = moving
    while left > 0 or not links:
        fixed = rng.random() < 0.2
        kind = "fixed" if fixed else ("prismatic" if rng.random() < 0.25 else "revolute")
        i = len(links)
        branch = rng.random() < 0.35
        parent = (int(rng.integers(-1, i)) if branch else i - 1) if i else -1
        mass = float(rng.uniform(0.5, 20))
        links.append({
            "parent": None if parent < 0 else parent,
            "translation": (rng.uniform(-0.6, 0.6, 3) * (rng.random(3) < 0.7)).tolist(),
            "rotation": draw_rotation(rng).tolist(),
            "joint": kind,
            "axis": draw_axis(rng).tolist(),
            "mass": mass,
            "centre_of_mass": rng.uniform(-0.3, 0.3, 3).tolist(),
            "inertia": draw_inertia(rng, mass).tolist(),
        })
        left -= kind != "fixed"
    mass = float(rng.uniform(50, 500))
    return {"base": {"mass": mass, "inertia": draw_inertia(rng, mass).tolist()}, "links": links,
            "tool": {"translation": rng.uniform(-0.3, 0.3, 3).tolist(), "rotation": draw_rotation(rng).tolist()}}


def model_of(tree):
    m = pin.Model()
    base = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    b = tree["base"]
    m.appendBodyToJoint(base, pin.Inertia(b["mass"], np.zeros(3), np.array(b["inertia"])), pin.SE3.Identity())
    carried, moving = [], []
    for i, link in enumerate(tree["links"]):
        joint, inner = (base, pin.SE3.Identity()) if link["parent"] is None else carried[link["parent"]]
        place = inner * se3(link)
        if link["joint"] == "fixed":
            carried.append((joint, place))
        else:
            axis = np.array(link["axis"])
            kind = pin.JointModelRevoluteUnaligned if link["joint"] == "revolute" else pin.JointModelPrismaticUnaligned
            own = m.addJoint(joint, kind(axis), place, f"joint{i}")
            carried.append((own, pin.SE3.Identity()))
            moving.append(own)
        own, inner = carried[-1]
        m.appendBodyToJoint(own, pin.Inertia(link["mass"], np.array(link["centre_of_mass"]), np.array(link["inertia"])), inner)
    own, inner = carried[-1]
    m.addFrame(pin.Frame("tool", own, 0, inner * se3(tree["tool"]), pin.FrameType.OP_FRAME))
    # Pinocchio numbers joints of a tree by itself, depth first.
    columns = [m.idx_vs[j] for j in moving]
    return m, columns


def se3(at):
    w, x, y, z = at["rotation"]
    return pin.SE3(pin.Quaternion(w, x, y, z).matrix(), np.array(at["translation"]))


def by_pinocchio(tree, positions):
    m, columns = model_of(tree)
    data = m.createData()
    q = pin.neutral(m)
    for column, position in zip(columns, positions):
        q[column + 1] = position
    ag = pin.computeCentroidalMap(m, data, q).copy()
    base_map = -np.linalg.solve(ag[:, :6], ag[:, columns])
    pin.framesForwardKinematics(m, data, q)
    frame = m.getFrameId("tool")
    jac = pin.computeFrameJacobian(m, data, q, frame, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
    pose = data.oMf[frame]
    return base_map, jac[:, columns] + jac[:, :6] @ base_map, pose


# The independent recursion, in many digits.

def vec(v):
    return mp.matrix([mp.mpf(x) for x in v])


def cross(a):
    return mp.matrix([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def quaternion_matrix(q):
    w, x, y, z = vec(q) / mp.norm(vec(q))
    v = cross(mp.matrix([x, y, z]))
    return mp.eye(3) + 2 * w * v + 2 * v * v


def turn(axis, angle):
    k = cross(axis)
    return mp.eye(3) + mp.sin(angle) * k + (1 - mp.cos(angle)) * k * k


def exact_rate(tree, positions, rates):
    """Angular velocity of the base, from total momentum written out body by body."""
    frames, velocities = [], []
    mass_all, first, inertia_all = mp.mpf(tree["base"]["mass"]), mp.zeros(3, 1), mp.matrix(tree["base"]["inertia"])
    linear, angular = mp.zeros(3, 1), mp.zeros(3, 1)
    state = iter(zip(positions, rates))
    for link in tree["links"]:
        if link["parent"] is None:
            r, p, v, w = mp.eye(3), mp.zeros(3, 1), mp.zeros(3, 1), mp.zeros(3, 1)
        else:
            (r, p), (v, w) = frames[link["parent"]], velocities[link["parent"]]
        origin = p + r * vec(link["translation"])
        v = v + cross(w) * (origin - p)
        r = r * quaternion_matrix(link["rotation"])
        if link["joint"] != "fixed":
            axis = vec(link["axis"]) / mp.norm(vec(link["axis"]))
            position, rate = next(state)
            if link["joint"] == "revolute":
                r = r * turn(axis, position)
                w = w + r * axis * rate
            else:
                shift = r * axis * position
                v = v + cross(w) * shift + r * axis * rate
                origin = origin + shift
        frames.append((r, origin))
        velocities.append((v, w))
        m, lever = mp.mpf(link["mass"]), r * vec(link["centre_of_mass"])
        c, own = origin + lever, r * mp.matrix(link["inertia"]) * r.T
        momentum = m * (v + cross(w) * lever)
        mass_all += m
        first += m * c
        inertia_all += own - m * cross(c) * cross(c)
        linear += momentum
        angular += own * w + cross(c) * momentum
    system = mp.zeros(6, 6)
    system[:3, :3] = mass_all * mp.eye(3)
    system[:3, 3:] = -cross(first)
    system[3:, :3] = cross(first)
    system[3:, 3:] = inertia_all
    right = mp.matrix(list(linear) + list(angular))
    return -mp.lu_solve(system, right)


def slopes(tree, positions, rates):
    h = mp.mpf(10) ** -10
    here = [mp.mpf(float(x)) for x in positions]
    rates = [mp.mpf(float(x)) for x in rates]
    columns = []
    for j in range(len(here)):
        def at(step):
            there = list(here)
            there[j] += step
            return exact_rate(tree, there, rates)[3:6]
        d = [(8 * (a - b) - (c - e)) / (12 * h) for a, b, c, e in zip(at(h), at(-h), at(2 * h), at(-2 * h))]
        columns.append([float(x) for x in d])
    return columns, [float(x) for x in exact_rate(tree, here, rates)]


def main():
    rng = np.random.default_rng(14)
    out = {"source": f"pinocchio {pin.__version__}, mpmath {mp.__version__}", "trees": []}
    for k in range(TREES):
        moving = 1 + k % 14
        tree = draw_tree(rng, moving)
        sliding = [link["joint"] == "prismatic" for link in tree["links"] if link["joint"] != "fixed"]
        positions = np.where(sliding, rng.uniform(-0.5, 0.5, moving), rng.uniform(-3, 3, moving))
        rates = rng.uniform(-1, 1, moving)
        base_map, generalised, pose = by_pinocchio(tree, positions)
        by_position, twist = slopes(tree, positions, rates)
        difference = np.abs(base_map @ rates - twist).max()
        assert difference < 1e-13 * max(1, np.abs(base_map).max()), (k, difference)
        out["trees"].append({**tree, "positions": positions.tolist(), "rates": rates.tolist(),
                             "base_twist": twist, "base_map": base_map.tolist(),
                             "generalised_jacobian": generalised.tolist(),
                             "tool_position": pose.translation.tolist(), "tool_rotation": pose.rotation.tolist(),
                             "rate_by_position": by_position})
    print(json.dumps(out))


if __name__ == "__main__":
    main()
