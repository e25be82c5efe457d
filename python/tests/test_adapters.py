"""Optimisers of other packages, and problems for other packages."""

from __future__ import annotations

import inspect
from importlib.metadata import requires
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import driftless
from driftless import adapters

for package in ("scipy", "cma", "minionpy"):
    pytest.importorskip(package)

# What other packages warn of is theirs.
pytestmark = pytest.mark.filterwarnings("default")

ALL = [
    *(driftless.scipy(m) for m in ("COBYQA", "COBYLA", "SLSQP", "L-BFGS-B", "TNC", "Nelder-Mead", "Powell", "trust-constr")),
    driftless.cma(),
    *(driftless.minionpy(a) for a in ("jSO", "LSRTDE", "ARRDE")),
]
# It is an extra of its own, since it needs an older numpy.
NEVERGRAD = [driftless.nevergrad(o) for o in ("NGOpt", "OnePlusOne")] if find_spec("nevergrad") else []


def records(result: driftless.Result) -> list[dict[str, object]]:
    frames = [pl.read_parquet(file) for file in (result.path / "runs").glob("*.parquet")]
    return pl.concat(frames, how="diagonal_relaxed").to_dicts()


@pytest.mark.parametrize("optimiser", [*ALL, *NEVERGRAD], ids=lambda o: o.name)
def test_adapters_search(optimiser: driftless.Optimiser, tmp_path: Path) -> None:
    problems = [driftless.Task().problem(), *driftless.functions("sphere", dimension=4)]
    result = driftless.run(
        problems=problems, optimisers=[optimiser, "random"], seeds=2, budget=400, out=tmp_path, progress=False
    )
    for record in records(result):
        # Some end by themselves, but not before they have searched.
        assert record["status"] in ("budget-spent", "finished"), record["message"]
        assert 300 < record["evaluations"] <= 400  # type: ignore[operator]
    runs = result.table("runs").filter(pl.col("instance") == "sphere dimension=4 instance=1")
    best = next(column for column in runs.columns if column.startswith("best"))
    own, random = (runs.filter(pl.col("optimiser").str.starts_with(name))[best].median() for name in (optimiser.name, "random"))
    assert own < random  # type: ignore[operator]


def test_seeds_determine_adapters(tmp_path: Path) -> None:
    problem = driftless.functions("ackley", dimension=3)
    one, two = (
        driftless.run(problems=problem, optimisers=ALL, seeds=2, budget=200, out=tmp_path / part, progress=False)
        for part in ("a", "b")
    )
    assert one.table("runs").equals(two.table("runs"))


def test_only_nevergrad_asks_for_an_older_numpy() -> None:
    bounded = [line for line in requires("driftless") or [] if line.startswith("numpy<")]
    assert bounded and all("nevergrad" in line for line in bounded)


def test_adapters_are_short() -> None:
    for name in ("_scipy", "_cma", "_minionpy", "_nevergrad"):
        lines = inspect.getsource(getattr(adapters, name)).splitlines()
        assert sum(bool(line.strip()) for line in lines) < 15, name


def test_identities_have_the_packages_version() -> None:
    import scipy

    assert driftless.scipy("SLSQP").identity()["version"] == f"scipy {scipy.__version__}"
    assert driftless.scipy("SLSQP", ftol=1e-3).identity()["setting ftol"] == 1e-3


def test_problems_of_ioh(tmp_path: Path) -> None:
    ioh = pytest.importorskip("ioh")
    own = driftless.functions("rastrigin", dimension=3)[0]
    problem = driftless.ioh_problem(own)
    assert (problem.bounds.lb == own.lower).all() and (problem.bounds.ub == own.upper).all()
    logger = ioh.logger.Analyzer(root=str(tmp_path), folder_name="data")
    problem.attach_logger(logger)
    x = np.random.default_rng(1).uniform(own.lower, own.upper, (20, 3))
    assert [problem(row) for row in x] == own.batch(x).tolist()
    problem.detach_logger()
    logger.close()
    assert problem.state.evaluations == 20
    assert list((tmp_path / "data").glob("*.json"))


def test_problems_of_pygmo() -> None:
    pygmo = pytest.importorskip("pygmo")
    own = driftless.Task().problem()
    problem = driftless.pygmo_problem(own)
    x = np.random.default_rng(1).uniform(own.lower, own.upper, (5, 12))
    assert problem.fitness(x[0]) == own(x[0])
    assert (problem.get_lb() == own.lower).all() and problem.get_name() == own.name
    population = pygmo.algorithm(pygmo.de(gen=5)).evolve(pygmo.population(problem, 20, seed=1))
    assert population.champion_f[0] == own(population.champion_x)
