"""What a question costs: without Python, from Python, and worked out in numpy.

    python python/benchmarks/calls.py
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np
from task_in_numpy import Task

import driftless

ROUNDS = 15
POINTS = 4096

rng = np.random.default_rng(1)
SHIFT = rng.uniform(-1, 1, 12)
ROTATION = np.linalg.qr(rng.normal(size=(12, 12)))[0]


def ackley(x: np.ndarray) -> np.ndarray:
    """Ackley's function of the rows of x; shift and rotation are others than the library's, and as dear."""
    y = (x - SHIFT) @ ROTATION
    radius = np.sqrt((y * y).mean(axis=-1))
    waves = np.cos(2 * np.pi * y).mean(axis=-1)
    return -20 * np.exp(-0.2 * radius) - np.exp(waves) + 20 + np.e


def median(work: Callable[[], object], points: int, rounds: int = ROUNDS) -> float:
    """Median over rounds of the microseconds per point."""
    times = []
    for _ in range(rounds):
        began = time.perf_counter()
        work()
        times.append((time.perf_counter() - began) / points)
    return 1e6 * statistics.median(times)


def each(ask: Callable[[np.ndarray], object], parts: list[np.ndarray]) -> None:
    for part in parts:
        ask(part)


print("| microseconds per point | alone | batches of 64 | batch of 4096 |")
print("|---|---|---|---|")
for problem, in_numpy in ((driftless.Task().problem(), Task().cost), (driftless.functions("ackley", dimension=12)[0], ackley)):
    x = rng.uniform(problem.lower, problem.upper, (POINTS, problem.dimension))
    native, python, numpy = [], [], []
    for size in (1, 64, POINTS):
        parts = list(x) if size == 1 else list(x.reshape(-1, size, problem.dimension))
        pieces = [x] if size == 1 else parts
        seconds = [sum(problem._native_seconds(part, size > 1) for part in pieces) for _ in range(ROUNDS)]
        native.append(1e6 * statistics.median(seconds) / POINTS)
        ask = problem.__call__ if size == 1 else problem.batch
        python.append(median(lambda: each(ask, parts), POINTS))
        some = [part.reshape(-1, problem.dimension) for part in parts[: 20 if size == 1 else len(parts)]]
        numpy.append(median(lambda: each(in_numpy, some), sum(map(len, some)), rounds=3))
    for kind, times in {"native": native, "Python": python, "numpy": numpy}.items():
        print(f"| {problem.name}, {kind} | " + " | ".join(f"{t:.3g}" for t in times) + " |")
