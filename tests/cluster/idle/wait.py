"""A search that waits for 0.1 to 10 seconds, log-uniformly by its seed, and asks for one cost."""

import json
import random
import sys
import time

first = json.loads(sys.stdin.readline())
print(json.dumps({"hello": {"name": "wait"}}))
time.sleep(10 ** random.Random(first["seed"]).uniform(-1, 1))
print(json.dumps({"x": first["problem"]["lower"]}))
sys.stdin.readline()
print(json.dumps({"done": True}))
