"""A solver in Python, without any package: it samples around the best point; the spread grows where that gains, and shrinks where not."""

import json
import random
import sys


def say(message):
    print(json.dumps(message), flush=True)


def hear():
    """The next line, or nothing once the search is over."""
    line = sys.stdin.readline()
    message = json.loads(line) if line else {"stop": "end of input"}
    return None if "stop" in message else message


def number(cost):
    """Costs that are not finite come as texts: "inf", "-inf" and "nan"."""
    return float(cost)


def main():
    opening = json.loads(sys.stdin.readline())
    problem, settings = opening["problem"], opening["settings"]
    lower, upper = problem["lower"], problem["upper"]
    size = settings.get("size", 32)
    rng = random.Random(opening["seed"])
    say({"hello": {"name": "gaussian-search", "version": "1"}})
    points = [[rng.uniform(a, b) for a, b in zip(lower, upper)] for _ in range(size)]
    best, least = None, float("inf")
    radius = 0.5
    while True:
        say({"id": 1, "x": points})
        answer = hear()
        if answer is None:
            return
        before = least
        for x, cost in zip(points, map(number, answer["cost"])):
            if cost < least:
                best, least = x, cost
        radius = min(0.5, radius * (1.2 if least < before else 0.7))
        centre = best or points[0]
        points = [
            [min(max(c + rng.gauss(0.0, radius) * (b - a), a), b) for c, a, b in zip(centre, lower, upper)]
            for _ in range(size)
        ]


main()
