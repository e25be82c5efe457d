"""Problems that misbehave, each in a way of its own: problems.py HOW. The sphere in two variables."""

import json
import os
import signal
import socket
import sys
import time

how = sys.argv[1]
if "DRIFTLESS_PORT" in os.environ:
    peer = socket.create_connection(("127.0.0.1", int(os.environ["DRIFTLESS_PORT"])))
    sys.stdin, sys.stdout = peer.makefile("r"), peer.makefile("w")
    print(json.dumps({"token": os.environ["DRIFTLESS_TOKEN"]}), flush=True)
opening = json.loads(sys.stdin.readline())
assert opening["driftless"] == 1 and opening["role"] == "problem"


def say(message):
    print(json.dumps(message), flush=True)


if how == "hangs-at-start":
    time.sleep(1000)
if how == "tells-of-no-box":
    say({"hello": {"lower": [1, 1], "upper": [0, 0]}})
    sys.exit()
if how == "tells-of-too-few-bounds":
    say({"hello": {"dimension": 3, "lower": [-5, -5], "upper": [5, 5]}})
    sys.exit()
say({"hello": {"lower": [-5, -5], "upper": [5, 5], "least_cost": 0}})
asked = 0
for line in sys.stdin:
    question = json.loads(line)
    costs = [x * x + y * y for x, y in question["x"]]
    asked += len(costs)
    answer = {"id": question["id"], "cost": costs}
    # The first question is about the middle of the box, before any run.
    if how == "prints":
        print("simulating", flush=True)
    elif how == "answers-not-finite":
        answer["cost"] = ["nan" if x < 0 else "inf" if y < 0 else x * x + y * y for x, y in question["x"]]
    elif asked <= 5:
        pass
    elif how == "is-killed":
        os.kill(os.getpid(), signal.SIGKILL)
    elif how == "says-why-it-fails":
        answer = {"id": question["id"], "error": "no convergence at this point"}
    elif how == "hangs":
        time.sleep(1000)
    elif how == "answers-below-the-least":
        answer["cost"][0] = -1
    elif how == "is-violated-by-less-than-nothing":
        answer["violation"] = [-1] * len(costs)
    elif how == "answers-too-few":
        answer["cost"] = costs[:-1]
    elif how == "answers-another":
        answer["id"] += 1
    elif how == "sends-no-json":
        print("{oops", flush=True)
        continue
    say(answer)
