"""Nothing leaks."""

from __future__ import annotations

import gc
import itertools
import os
import statistics
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import driftless

PAGE = os.sysconf("SC_PAGE_SIZE")


def resident() -> int:
    """Resident memory of this process [bytes]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE


def growth(work: Callable[[], object], times: int) -> float:
    """By how much resident memory grows while something is done so many times, once it has been done as often before.

    The median of five rounds: what leaks does so in each of them, while the allocator takes and returns pages as threads
    come and go.
    """

    def repeat() -> int:
        for _ in range(times):
            work()
        gc.collect()
        return resident()

    sizes = [repeat() for _ in range(6)]
    return statistics.median(after - before for before, after in itertools.pairwise(sizes))


@pytest.fixture(scope="module")
def problem() -> driftless.Problem:
    (only,) = driftless.functions("sphere", dimension=4)
    return only


def test_a_million_calls(problem: driftless.Problem) -> None:
    x = np.zeros(4)
    # Eight bytes per call would be 1.6 MB.
    assert growth(lambda: problem(x), 200_000) < 400_000


def test_calls_of_every_kind() -> None:
    problem = driftless.Task().problem()
    x = problem.upper / 3
    many = np.tile(x, (64, 1))
    kinds: list[tuple[Callable[[], object], int]] = [
        (lambda: problem.batch(many), 1_000),
        (lambda: problem.evaluate_batch(many.tolist()), 400),
        (lambda: problem.subgradient(x), 4_000),
        (lambda: problem.linearise(x), 4_000),
        (lambda: pytest.raises(ValueError, problem, x[1:]), 1_000),
    ]
    for work, times in kinds:
        assert growth(work, times) < 600_000


def test_runs_leave_nothing(problem: driftless.Problem, tmp_path: Path) -> None:
    kept: list[int] = []

    @driftless.optimiser
    def guess(oracle: driftless.Oracle, rng: np.random.Generator) -> None:
        while True:
            oracle.batch(rng.uniform(oracle.lower, oracle.upper, (10, 4)))

    def work() -> None:
        kept.append(1)
        driftless.run(
            problems=problem, optimisers=guess.replace(version=len(kept)), seeds=20, budget=30, out=tmp_path / str(len(kept)), progress=False
        )

    threads, files = threading.active_count(), len(os.listdir("/proc/self/fd"))
    assert growth(work, 20) < 2_500_000
    assert threading.active_count() == threads and len(os.listdir("/proc/self/fd")) <= files + 2
