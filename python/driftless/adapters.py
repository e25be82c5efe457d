"""Optimisers of other packages, which the user has to have installed, and problems for other packages."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from ._driftless import Oracle, Problem
from ._field import Optimiser

__all__ = ["cma", "ioh_problem", "minionpy", "nevergrad", "pygmo_problem", "scipy"]


def _adapted(name: str, package: str, function: Callable[..., object], **settings: Any) -> Optimiser:
    try:
        return Optimiser(name, function, settings, version=f"{package} {version(package)}")
    except PackageNotFoundError:
        raise ImportError(f"{name} needs the package {package}: pip install {package}") from None


def _module(name: str) -> Any:
    try:
        return import_module(name)
    except ModuleNotFoundError:
        raise ImportError(f"this needs the package {name}: pip install {name}") from None


def scipy(method: str = "COBYQA", **options: Any) -> Optimiser:
    """A local method of ``scipy.optimize.minimize``, from one random start after another.

    Methods that use slopes are given subgradients, where the problem has them. Variables are scaled to the unit cube.

    Parameters
    ----------
    method : str
        ``"COBYQA"``, ``"SLSQP"``, ``"L-BFGS-B"``, ``"Nelder-Mead"``, ``"Powell"``, ``"TNC"``, ``"trust-constr"``, …
    **options
        Passed on as `options`.
    """
    return _adapted(f"{method} (SciPy)", "scipy", _scipy, method=method, **options)


_WITH_SLOPES = ("SLSQP", "L-BFGS-B", "TNC", "trust-constr")
# What each calls its limit, so that none ends before it has converged.
_LIMIT = {"COBYQA": "maxfev", "TNC": "maxfun"}


def _scipy(oracle: Oracle, rng: np.random.Generator, *, method: str, **options: Any) -> None:
    scipy, has_slopes = _module("scipy.optimize"), oracle.has_subgradient and method in _WITH_SLOPES
    low, width = oracle.lower, oracle.upper - oracle.lower

    def cost(x: Any) -> Any:
        x = low + width * np.clip(x, 0, 1)
        if not has_slopes:
            return oracle(x)
        found, slopes = oracle.subgradient(x)
        return found, width * slopes

    options = {_LIMIT.get(method, "maxiter"): oracle.budget, **options}
    while True:
        x = rng.random(oracle.dimension)
        scipy.minimize(cost, x, method=method, jac=has_slopes, bounds=scipy.Bounds(0, 1), options=options)


def cma(sigma: float = 0.3, **options: Any) -> Optimiser:
    """CMA-ES of the package ``cma``, begun anew with twice the population whenever it stops (DOI 10.1109/CEC.2005.1554902).

    Parameters
    ----------
    sigma : float
        First step size, in a box that is scaled to the unit cube.
    **options
        Passed on as options of the package, such as ``CMA_diagonal=True``.
    """
    return _adapted("CMA-ES (pycma)", "cma", _cma, sigma=sigma, **options)


def _normal(rng: np.random.Generator) -> Callable[..., Any]:
    return lambda *shape: rng.standard_normal(shape)


def _cma(oracle: Oracle, rng: np.random.Generator, *, sigma: float, **options: Any) -> None:
    cma = _module("cma")
    low, width, size = oracle.lower, oracle.upper - oracle.lower, 4 + int(3 * np.log(oracle.dimension))
    while True:
        # Without a generator of its own it draws from numpy's global one.
        own = {"bounds": [0, 1], "seed": np.nan, "randn": _normal(rng), "popsize": size, "verbose": -9}
        search = cma.CMAEvolutionStrategy(rng.random(oracle.dimension), sigma, {**own, **options})
        while not search.stop():
            points = search.ask()
            search.tell(points, oracle.batch(low + width * np.asarray(points)).tolist())
        size *= 2


def minionpy(algorithm: str = "jSO", **options: Any) -> Optimiser:
    """An algorithm of ``minionpy``: ``"jSO"``, ``"LSRTDE"``, ``"ARRDE"`` and others.

    Parameters
    ----------
    algorithm : str
        Its name in the package.
    **options
        Passed on as `options`.
    """
    return _adapted(f"{algorithm} (minionpy)", "minionpy", _minionpy, algorithm=algorithm, **options)


def _minionpy(oracle: Oracle, rng: np.random.Generator, *, algorithm: str, **options: Any) -> None:
    box = list(zip(oracle.lower.tolist(), oracle.upper.tolist()))

    def costs(points: Any, *_: Any) -> Any:
        return oracle.batch(points).tolist()

    own = {"algo": algorithm, "maxevals": oracle.budget, "seed": int(rng.integers(2**31)), "x0": [rng.uniform(*zip(*box)).tolist()]}
    _module("minionpy").Minimizer(costs, box, **own, options=options or None).optimize()


def nevergrad(optimizer: str = "NGOpt") -> Optimiser:
    """An optimiser of ``nevergrad``: ``"NGOpt"`` and others of its registry. Variables are scaled to the unit cube.

    It runs in a process of its own, since many of them draw from numpy's global generator.

    Parameters
    ----------
    optimizer : str
        Its name in the registry.
    """
    return _adapted(f"{optimizer} (nevergrad)", "nevergrad", _nevergrad, optimizer=optimizer).replace(isolation="process")


def _nevergrad(oracle: Oracle, rng: np.random.Generator, *, optimizer: str) -> None:
    ng = _module("nevergrad")
    low, width = oracle.lower, oracle.upper - oracle.lower
    space = ng.p.Array(shape=low.shape, lower=0, upper=1)
    space.random_state.seed(int(rng.integers(2**32)))
    search = ng.optimizers.registry[optimizer](space, budget=oracle.budget)
    while True:
        candidate = search.ask()
        search.tell(candidate, oracle(low + width * candidate.value))


def ioh_problem(problem: Problem) -> Any:
    """A problem as one of ``ioh``, to be logged by its loggers.

    Returns
    -------
    ioh.problem.RealSingleObjective
    """
    ioh = _module("ioh")
    found = ioh.wrap_problem(problem.__call__, problem.name, ioh.ProblemClass.REAL, problem.dimension)
    found.bounds.lb, found.bounds.ub = problem.lower.tolist(), problem.upper.tolist()
    return found


class _Pygmo:
    """A user-defined problem of ``pygmo``."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem

    def fitness(self, x: Any) -> list[float]:
        return [self._problem(x)]

    def batch_fitness(self, points: Any) -> Any:
        return self._problem.batch(np.reshape(points, (-1, self._problem.dimension)))

    def get_bounds(self) -> tuple[Any, Any]:
        return self._problem.lower, self._problem.upper

    def get_name(self) -> str:
        return self._problem.name


def pygmo_problem(problem: Problem) -> Any:
    """A problem as one of ``pygmo``.

    Returns
    -------
    pygmo.problem
    """
    return _module("pygmo").problem(_Pygmo(problem))
