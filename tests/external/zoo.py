"""Solvers that misbehave, each in a way of its own: zoo.py HOW. Asks for costs of a problem of two variables."""

import json
import os
import signal
import socket
import subprocess
import sys
import time

how = sys.argv[1]
if "DRIFTLESS_PORT" in os.environ:
    peer = socket.create_connection(("127.0.0.1", int(os.environ["DRIFTLESS_PORT"])))
    sys.stdin, sys.stdout = peer.makefile("r"), peer.makefile("w")
    print(json.dumps({"token": os.environ["DRIFTLESS_TOKEN"]}), flush=True)
opening = json.loads(sys.stdin.readline())
budget = opening["budget"]
assert opening["driftless"] == 1 and opening["role"] == "optimiser"


def say(message):
    print(json.dumps(message), flush=True)


def ask(points):
    say({"id": 1, "x": points})
    return json.loads(sys.stdin.readline())


def point(i):
    return [0.01 * i % 1.0, 0.5]


def ask_all(count):
    for i in range(count):
        if "stop" in ask(point(i)):
            break


if how == "hangs-at-start":
    time.sleep(1000)
if how == "says-no-hello":
    ask(point(0))
say({"hello": {"name": how}})
if how == "behaves":
    ask_all(10)
elif how == "does-not-read":
    while True:
        say({"id": "k" * 900, "x": point(0)})
elif how == "fails-once":
    ask_all(5)
    if not os.path.exists("failed-once"):
        open("failed-once", "w").close()
        sys.exit(3)
elif how == "takes-its-time":
    for i in range(10):
        time.sleep(0.03)
        ask(point(i))
elif how == "overruns-by-one":
    ask_all(budget + 1)
    ask_all(1)
elif how == "overruns-by-a-batch":
    answer = ask([point(i) for i in range(budget - 3)])
    assert answer["left"] == 3
    answer = ask([point(i) for i in range(10)])
    assert len(answer["cost"]) == 3 and answer["left"] == 0, answer
    assert json.loads(sys.stdin.readline()) == {"stop": "budget"}
elif how == "prints":
    print("generation 1")
    ask_all(10)
    print("generation 2")
elif how == "exits-with-3":
    ask_all(5)
    print("no licence", file=sys.stderr)
    sys.exit(3)
elif how == "is-killed":
    ask_all(5)
    os.kill(os.getpid(), signal.SIGKILL)
elif how == "hangs-between":
    ask_all(5)
    time.sleep(1000)
elif how == "ignores-signals":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    ask_all(5)
    say({"done": True})
    while True:
        time.sleep(1)
elif how == "hangs-at-the-end":
    ask_all(5)
    say({"done": True})
    time.sleep(1000)
elif how == "leaves-grandchildren":
    subprocess.Popen(["sleep", "1000"])
    ask_all(5)
elif how == "floods-stderr":
    for _ in range(1000):
        print("e" * 10_000, file=sys.stderr)
    ask_all(5)
elif how == "floods-stdout":
    for _ in range(1000):
        print("o" * 10_000)
    ask_all(5)
elif how == "sends-nan":
    assert ask(["nan", 0.5])["cost"] == "inf"
elif how == "sends-a-bare-nan":
    print('{"id": 1, "x": [NaN, 0.5]}', flush=True)
    time.sleep(1000)
elif how == "sends-a-wrong-length":
    ask([0.1, 0.2, 0.3])
elif how == "goes-outside":
    answer = ask([[0.5, 0.5], [100.0, 0.5], [0.5, -100.0], [0.1, 0.1]])
    assert answer["cost"][1:3] == ["inf", "inf"] and answer["left"] == budget - 4, answer
    outside = opening["problem"]["upper"][0] * (1 + 1e-15)
    assert ask([outside, 0.5])["cost"] != "inf"
elif how == "sends-no-utf-8":
    sys.stdout.buffer.write(b'{"id": 1, "x": [\xff]}\n')
    sys.stdout.flush()
    time.sleep(1000)
elif how == "sends-a-long-line":
    sys.stdout.write('{"x": [' + "1" * 100_000_000 + "]}\n")
    sys.stdout.flush()
    time.sleep(1000)
elif how == "sends-no-json":
    print("{oops", flush=True)
    time.sleep(1000)
elif how == "asks-after-stop":
    ask_all(budget + 1)
    for i in range(100):
        say({"id": 2, "x": point(i)})
    time.sleep(1000)
elif how == "never-listens":
    for i in range(10 * budget):
        say({"id": i, "x": [point(i)] * 10})
    time.sleep(1000)
elif how == "asks-for-derivatives":
    say({"id": 1, "linearise": point(1)})
    time.sleep(1000)
elif how == "edits-itself":
    ask_all(5)
    with open(__file__, "a") as own:
        own.write("# edited\n")
elif how == "asks-for-nothing":
    ask([])
elif how == "searches-too-long":
    for i in range(budget):
        time.sleep(0.3)
        ask(point(i))
elif how == "ends-without-done":
    ask_all(5)
    sys.exit(0)
else:
    sys.exit(f"unknown: {how}")
say({"done": True})
