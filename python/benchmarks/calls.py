"""What a question costs: from Python, in numpy, and without Python.

    python python/benchmarks/calls.py
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable

import numpy as np

import driftless

ROUNDS = 15


def best(work: Callable[[], object], calls: int) -> float:
    """Median over rounds of the microseconds of one of so many calls."""
    times = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        for _ in range(calls):
            work()
        times.append((time.perf_counter() - began) / calls)
    return 1e6 * statistics.median(times)


def in_numpy(x: np.ndarray) -> np.ndarray:
    """Ackley's function of the rows of x, as the library has it but for shift and rotation, which stand for those here."""
    y = (x - SHIFT) @ ROTATION
    n = y.shape[-1]
    radius = np.sqrt((y * y).sum(axis=-1) / n)
    waves = np.cos(2 * np.pi * y).sum(axis=-1) / n
    return -20 * np.exp(-0.2 * radius) - np.exp(waves) + 20 + np.e


rng = np.random.default_rng(1)
SHIFT = rng.uniform(-1, 1, 12)
ROTATION = np.linalg.qr(rng.normal(size=(12, 12)))[0]

print("| microseconds per point | alone | batch of 64 | batch of 4096 |")
print("|---|---|---|---|")
for name, problem in {"default task": driftless.Task().problem(), "ackley": driftless.functions("ackley", dimension=12)[0]}.items():
    x = rng.uniform(problem.lower, problem.upper, (4096, problem.dimension))
    rows = {"native": [], "Python": [], "numpy": []}
    for count in (1, 64, 4096):
        points = x[:count]
        calls = max(1, 4096 // count)
        native = statistics.median(problem._native_seconds(x if count == 1 else points, count > 1) for _ in range(ROUNDS))
        rows["native"].append(1e6 * native / (4096 if count == 1 else count))
        cycle = iter(())

        def one() -> float:
            global cycle
            row = next(cycle, None)
            if row is None:
                cycle = iter(list(x))
                row = next(cycle)
            return problem(row)

        ask = one if count == 1 else (lambda: problem.batch(points))
        rows["Python"].append(best(ask, calls) / count)
        if name == "ackley":
            rows["numpy"].append(best(lambda: in_numpy(points), calls) / count)
    for kind, times in rows.items():
        if times:
            print(f"| {name}, {kind} | " + " | ".join(f"{t:.3g}" for t in times) + " |")
