"""A particle swarm with a ring of neighbours, in numpy. It asks for a whole swarm at a time."""

import json
import sys

import numpy as np


def ask(points):
    """The costs of the rows of `points`; none once the search is over."""
    print(json.dumps({"x": points.tolist()}), flush=True)
    answer = json.loads(sys.stdin.readline() or '{"stop": "end of input"}')
    return None if "stop" in answer else np.array(answer["cost"], dtype=float)


opening = json.loads(sys.stdin.readline())
lower, upper = (np.array(opening["problem"][side]) for side in ("lower", "upper"))
settings = {"size": 64, "inertia": 0.729844, "pull": 1.496180} | opening["settings"]
rng = np.random.default_rng(opening["seed"])
print(json.dumps({"hello": {"name": "swarm", "version": "1"}}), flush=True)

size, shape = settings["size"], (settings["size"], len(lower))
x = rng.uniform(lower, upper, shape)
velocity = rng.uniform(lower - x, upper - x)
best, least = x.copy(), np.full(size, np.inf)
while (costs := ask(x)) is not None and len(costs) == size:
    better = costs < least
    best[better], least[better] = x[better], costs[better]
    # The best of a particle and its neighbours on the ring.
    ring = np.stack([np.roll(least, 1), least, np.roll(least, -1)])
    leader = (np.arange(size) + ring.argmin(axis=0) - 1) % size
    to_best, to_leader = best - x, best[leader] - x
    velocity = settings["inertia"] * velocity + settings["pull"] * (
        rng.random(shape) * to_best + rng.random(shape) * to_leader
    )
    x = x + velocity
    outside = (x < lower) | (x > upper)
    velocity[outside] *= -0.5
    x = x.clip(lower, upper)
