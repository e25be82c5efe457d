"""A problem in Python, without any package: Rosenbrock's valley in as many variables as the settings say."""

import json
import sys


def valley(x):
    return sum(100.0 * (b - a * a) ** 2 + (1.0 - a) ** 2 for a, b in zip(x, x[1:]))


opening = json.loads(sys.stdin.readline())
dimension = opening["settings"].get("dimension", 2)
box = {"lower": [-2.0] * dimension, "upper": [2.0] * dimension}
print(json.dumps({"hello": {"dimension": dimension, **box, "least_cost": 0.0}}), flush=True)
for line in sys.stdin:
    question = json.loads(line)
    print(json.dumps({"id": question["id"], "cost": [valley(x) for x in question["x"]]}), flush=True)
