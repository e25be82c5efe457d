"""Reference values for the robots that come with the program, computed with Pinocchio.

Independent of the project's own code: robot files are read with tomllib here, momentum maps come from
Pinocchio's centroidal algorithms on a free-flyer model, attitudes from SciPy's DOP853 and, as a check, from a
Lie group method of fourth order. Run:

    pip install pin==4.1.0 numpy scipy && python make_robots.py > robots.json

Conventions: base axes, origin at the base's centre of mass; twists are linear above angular; units m, kg, rad,
s; joints stand in the order of the file. A path runs from one configuration to another, s in 0 to 1, by
10 s³ - 15 s⁴ + 6 s⁵ in all joints; the attitude at its end is that of a base which started at the identity,
as a quaternion (w, x, y, z) with w >= 0 that takes base vectors to the inertial frame.
"""
import json
import pathlib
import tomllib
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "src" / "robot" / "shipped"
STATES = 5


@dataclass
class Link:
    """A body behind a joint. `parent` is the number of a link, None for the base."""

    parent: int | None
    place: pin.SE3
    joint: dict
    inertia: pin.Inertia | None


@dataclass
class Robot:
    """A base, its links in the order of the file, and the tool on one of them."""

    name: str
    base: pin.Inertia
    links: list[Link]
    tool_link: int
    tool: pin.SE3

    @property
    def joints(self):
        return [link.joint for link in self.links if link.joint["type"] != "fixed"]


def euler(zyx_deg):
    yaw, pitch, roll = np.radians(zyx_deg)
    return pin.rpy.rpyToMatrix(roll, pitch, yaw)


def placement(position=(0, 0, 0), zyx_deg=(0, 0, 0)):
    return pin.SE3(euler(zyx_deg), np.array(position, dtype=float))


def inertia_of(table, centre):
    i = table["inertia"]
    xy, xz, yz = (i.get(key, 0) for key in ("xy", "xz", "yz"))
    matrix = np.array([[i["xx"], xy, xz], [xy, i["yy"], yz], [xz, yz, i["zz"]]], dtype=float)
    return pin.Inertia(table["mass"], np.array(centre, dtype=float), matrix)


def read(path):
    """A robot file with a tree of links or with a chain of DH rows."""
    with open(path, "rb") as file:
        table = tomllib.load(file)
    base = table["base"]
    mount = placement(base.get("mount", (0, 0, 0)), base.get("mount_zyx_deg", (0, 0, 0)))
    links, tool_link, tool = (from_tree if "link" in table else from_dh)(table, mount)
    return Robot(table["name"], inertia_of(base, np.zeros(3)), links, tool_link, tool)


def from_tree(table, mount):
    links, number = [], {}
    for row in table["link"]:
        parent = number.get(row.get("parent", "base"))
        place = placement(row.get("position", (0, 0, 0)), row.get("zyx_deg", (0, 0, 0)))
        joint = {"name": row["name"], "type": "fixed"} | row.get("joint", {})
        inertia = inertia_of(row, row.get("centre_of_mass", (0, 0, 0))) if "mass" in row else None
        links.append(Link(parent, mount * place if parent is None else place, joint, inertia))
        number[row["name"]] = len(links) - 1
    tool = table.get("tool", {})
    where = number[tool["link"]] if "link" in tool else len(links) - 1
    return links, where, placement(tool.get("position", (0, 0, 0)), tool.get("zyx_deg", (0, 0, 0)))


def from_dh(table, mount):
    """A link's frame is its joint's frame as the angle has turned it; the row leads on to the next."""
    links, place = [], mount
    for i, row in enumerate(table["joint"]):
        joint = {"name": row.get("name", f"joint{i + 1}"), "type": "revolute", "range_deg": row["range_deg"]}
        links.append(Link(i - 1 if i else None, place, joint, inertia_of(row, row["centre_of_mass"])))
        dh = row["dh"]
        step = pin.SE3(euler((dh.get("offset_deg", 0), 0, 0)), np.zeros(3))
        place = step * pin.SE3(euler((0, 0, dh["alpha_deg"])), np.array([dh["a"], 0.0, dh["d"]]))
    return links, len(links) - 1, place


class Model:
    """The robot in Pinocchio, on a free flyer whose frame stands at the base's centre of mass."""

    def __init__(self, robot):
        m = self.pin = pin.Model()
        flyer = m.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
        m.appendBodyToJoint(flyer, robot.base, pin.SE3.Identity())
        joint_of = {}

        def add(i, joint, inner):
            """A link and what it carries, depth first: Pinocchio's algorithms want joints in that order."""
            link = robot.links[i]
            place = inner * link.place
            if link.joint["type"] != "fixed":
                axis = np.array(link.joint.get("axis", (0, 0, 1)), dtype=float)
                prismatic = link.joint["type"] == "prismatic"
                kind = pin.JointModelPrismaticUnaligned if prismatic else pin.JointModelRevoluteUnaligned
                joint = joint_of[i] = m.addJoint(joint, kind(axis / np.linalg.norm(axis)), place, link.joint["name"])
                place = pin.SE3.Identity()
            if link.inertia is not None:
                m.appendBodyToJoint(joint, link.inertia, place)
            if i == robot.tool_link:
                self.tool = m.addFrame(pin.Frame("tool", joint, 0, place * robot.tool, pin.FrameType.OP_FRAME))
            add_all(i, joint, place)

        def add_all(parent, joint, inner):
            for i, link in enumerate(robot.links):
                if link.parent == parent:
                    add(i, joint, inner)

        add_all(None, flyer, pin.SE3.Identity())
        self.columns = np.array([m.idx_vs[joint_of[i]] for i in sorted(joint_of)], dtype=int)
        self.data = m.createData()

    def configuration(self, positions):
        q = pin.neutral(self.pin)
        q[self.columns + 1] = positions
        return q

    def base_map(self, positions):
        """The base's twist for joint rates, at zero momentum."""
        momentum = pin.computeCentroidalMap(self.pin, self.data, self.configuration(positions))
        return -np.linalg.solve(momentum[:, :6], momentum[:, self.columns])

    def tool_pose(self, positions):
        pin.framesForwardKinematics(self.pin, self.data, self.configuration(positions))
        return self.data.oMf[self.tool].copy()

    def generalised_jacobian(self, positions):
        q = self.configuration(positions)
        j = pin.computeFrameJacobian(self.pin, self.data, q, self.tool, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        return j[:, self.columns] + j[:, :6] @ self.base_map(positions)


def span(joint):
    if "range_m" in joint:
        return joint["range_m"]
    return np.radians(joint.get("range_deg", (-180, 180)))


def quintic(s):
    return s**3 * (10 - 15 * s + 6 * s * s), 30 * s * s * (1 - s) ** 2


def attitude_after(model, start, goal):
    def rate(s):
        shape, slope = quintic(s)
        return model.base_map(start + shape * (goal - start))[3:] @ (goal - start) * slope

    def by_quaternion(s, x):
        w, v, omega = x[0], x[1:], rate(s)
        return 0.5 * np.concatenate([[-v @ omega], w * omega + np.cross(v, omega)])

    x = solve_ivp(by_quaternion, (0, 1), [1, 0, 0, 0], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    x = x / np.linalg.norm(x)
    x = x if x[0] >= 0 else -x

    steps, r = 1000, np.eye(3)
    for i in range(steps):
        a, b = (rate((i + 0.5 + side * np.sqrt(3) / 6) / steps) for side in (-1, 1))
        r = r @ pin.exp3((a + b) / (2 * steps) + np.sqrt(3) / 12 * np.cross(a, b) / steps**2)
    turn = pin.log3(r.T @ pin.Quaternion(*x).matrix())
    assert np.linalg.norm(turn) < 1e-11, np.linalg.norm(turn)
    return x


def values(path, rng):
    robot = read(path)
    model = Model(robot)
    low, high = np.array([span(joint) for joint in robot.joints]).T
    states = []
    for _ in range(STATES):
        positions, rates = rng.uniform(low, high), rng.uniform(-1, 1, len(low))
        pose = model.tool_pose(positions)
        states.append({"positions": positions.tolist(), "rates": rates.tolist(),
                       "base_twist": (model.base_map(positions) @ rates).tolist(),
                       "tool_position": pose.translation.tolist(), "tool_rotation": pose.rotation.tolist(),
                       "generalised_jacobian": model.generalised_jacobian(positions).tolist()})
    start, goal = rng.uniform(low, high), rng.uniform(low, high)
    end = attitude_after(model, start, goal)
    return {"name": robot.name, "joints": [joint["name"] for joint in robot.joints], "states": states,
            "path": {"from": start.tolist(), "to": goal.tolist(), "attitude": end.tolist()}}


def main():
    rng = np.random.default_rng(2023)
    files = sorted(SOURCE.glob("*.toml"))
    print(json.dumps({"source": f"pinocchio {pin.__version__}", "robots": [values(path, rng) for path in files]}))


if __name__ == "__main__":
    main()
