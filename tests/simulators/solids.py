"""What robots and keep-outs look like, for Coal: an independent reading of the shapes in robot and task files.

The rules are those of docs/robots.md: a cylinder is taken for a capsule or a box, a robot that states no shape has
derived ones, and bodies that one joint joins, ignored pairs and shapes that always overlap are not watched.
"""
import itertools

import coal
import numpy as np
import pinocchio as pin

from simulate import make_robots

CONFIGURATIONS = 256  # random ones, which tell what always overlaps and what can never be far apart
TOLERANCE = 1e-11  # of Coal's iterations, m


def along(start, end):
    """A placement in the middle of a segment, with z along it."""
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    axis = end - start
    axis = axis / np.linalg.norm(axis) if np.linalg.norm(axis) > 0 else np.array([0.0, 0.0, 1.0])
    if axis[2] < 0:
        axis = -axis
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis)
    return pin.SE3(turn.matrix(), (start + end) / 2)


def solid(table):
    """A shape of a file: what it is for Coal, and where it stands."""
    (kind, shape), = table.items()
    if kind == "sphere":
        return coal.Sphere(shape["radius"]), make_robots.placement(shape.get("centre", (0, 0, 0)))
    if kind == "box":
        place = make_robots.placement(shape.get("centre", (0, 0, 0)), shape.get("zyx_deg", (0, 0, 0)))
        return coal.Box(*map(float, shape["size"])), place
    place, radius = along(shape["from"], shape["to"]), shape["radius"]
    length = float(np.linalg.norm(np.subtract(shape["to"], shape["from"])))
    if kind == "cylinder" and np.pi * (length + 4 / 3 * radius) > 4 * length:
        return coal.Box(2 * radius, 2 * radius, length), place
    return coal.Capsule(radius, length), place


def derived(robot, mount):
    """The shapes of a serial arm whose joints are all at different places: base first, then the links."""
    moments = np.diag(robot.base.inertia)
    half = np.sqrt(6 * (moments.sum() - 2 * moments) / robot.base.mass) / 2
    mount = np.abs(mount)
    face = int(np.argmax(mount / half))
    half = np.maximum(half, mount / 0.9)
    half[face] = mount[face]
    shapes = [[{"box": {"size": 2 * half}}]]
    ends = [link.place.translation for link in robot.links[1:]] + [robot.tool.translation]
    for link, end in zip(robot.links, ends, strict=True):
        length = np.linalg.norm(end)
        least = np.linalg.eigvalsh(link.inertia.inertia)[0]
        radius = min(np.sqrt(2 * least / link.inertia.mass), length / 4)
        if link.joint["type"] == "fixed" or length <= 0.1 * radius:
            raise NotImplementedError("only arms whose joints are all at different places")
        shapes.append([{"capsule": {"from": end / length * radius, "to": end - end / length * radius, "radius": radius}}])
    return shapes


class Scene:
    """All pairs of shapes that are watched, for a robot on a free flyer."""

    def __init__(self, model, robot, table, task):
        self.model, self.robot = model, robot
        m = model.pin
        stated = [table["base"].get("shapes", [])]
        stated += [row.get("shapes", []) for row in table.get("link", table.get("joint", []))]
        if not any(stated):
            stated = derived(robot, table["base"].get("mount", (0, 0, 0)))
        # For base and links: the joint that moves it, its frame there, and the joint's parent.
        bodies = [(1, pin.SE3.Identity())]
        for i, link in enumerate(robot.links):
            joint, inner = bodies[0 if link.parent is None else link.parent + 1]
            if link.joint["type"] == "fixed":
                bodies.append((joint, inner * link.place))
            else:
                bodies.append((m.getJointId(link.joint["name"]), pin.SE3.Identity()))
        names = ["base"] + [link.joint["name"] if "link" not in table else row["name"]
                            for link, row in zip(robot.links, table.get("link", table.get("joint")), strict=True)]
        shapes = [(name, joint, frame, shape) for name, (joint, frame), own in zip(names, bodies, stated, strict=True)
                  for shape in own]
        own = len(shapes)
        for name, keep_out in task.get("keep_out", {}).items():
            joint = 1 if keep_out.get("frame") == "base" else 0
            shapes += [(name, joint, pin.SE3.Identity(), shape) for shape in keep_out["shapes"]]

        geometry = pin.GeometryModel()
        for k, (name, joint, frame, shape) in enumerate(shapes):
            what, place = solid(shape)
            geometry.addGeometryObject(pin.GeometryObject(f"{k}:{name}", joint, 0, frame * place, what))
        self.geometry = geometry
        ignored = [set(pair) for pair in table.get("collision", {}).get("ignore", [])]
        pairs = []
        for (i, a), (k, b) in itertools.combinations(enumerate(shapes), 2):
            joined = m.parents[b[1]] == a[1] or m.parents[a[1]] == b[1]
            watched = (i < own and a[1] != b[1] and {a[0], b[0]} not in ignored and (k >= own or not joined))
            if watched:
                pairs.append((i, k))
        least = task["limits"]["clearance_m"]
        nearby = [pair for pair in pairs if pair[1] >= own]
        near, only_apart = self.split([pair for pair in pairs if pair[1] < own], shapes, least)
        # Bodies that keep a distance, those that must only not overlap, and solids nearby.
        self.kinds = [Checker(m, geometry, kind) for kind in (near, only_apart, nearby)]

    def split(self, pairs, shapes, least):
        """Pairs that keep a distance and those that must only not overlap."""
        rng = np.random.default_rng(1)
        low, high = np.array([make_robots.span(joint) for joint in self.robot.joints]).T
        every = Checker(self.model.pin, self.geometry, pairs)
        found = np.array([every.distances(self.model.configuration(rng.uniform(low, high)))
                          for _ in range(CONFIGURATIONS)])
        of_bodies = {}
        for pair, distances in zip(pairs, found.T, strict=True):
            if distances.max() >= 0:
                of_bodies.setdefault(frozenset(shapes[i][1] for i in pair), []).append((pair, distances))
        near, only_apart = [], []
        for members in of_bodies.values():
            farthest = np.min([distances for _, distances in members], axis=0).max()
            (only_apart if farthest < 2 * least else near).extend(pair for pair, _ in members)
        return near, only_apart


class Checker:
    """Distances of some pairs of shapes."""

    def __init__(self, model, geometry, pairs):
        self.model, self.data = model, model.createData()
        self.geometry = geometry.copy()
        for pair in pairs:
            self.geometry.addCollisionPair(pin.CollisionPair(*pair))
        self.placed = pin.GeometryData(self.geometry)
        for request in self.placed.distanceRequests:
            request.gjk_tolerance = request.epa_tolerance = TOLERANCE
            request.gjk_max_iterations = request.epa_max_iterations = 1000
        self.pairs = pairs

    def least(self, q):
        """The least distance in a configuration and the names of the two shapes."""
        if not self.pairs:
            return np.inf, ()
        nearest = pin.computeDistances(self.model, self.data, self.geometry, self.placed, q)
        names = [self.geometry.geometryObjects[i].name.split(":")[1] for i in self.pairs[nearest]]
        return self.placed.distanceResults[nearest].min_distance, names

    def distances(self, q):
        pin.computeDistances(self.model, self.data, self.geometry, self.placed, q)
        return [result.min_distance for result in self.placed.distanceResults]
