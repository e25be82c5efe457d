"""CMA-ES of the package cma, begun anew with twice the population whenever it stops (IPOP)."""

import cma
import numpy as np

import door

with door.Problem("pycma") as problem:
    lower, upper = np.array(problem.lower), np.array(problem.upper)
    rng = np.random.default_rng(problem.seed)
    size = 4 + int(3 * np.log(problem.dimension))
    while True:
        # In the unit cube one step size serves all variables.
        options = {"bounds": [0, 1], "seed": int(rng.integers(1, 2**31)), "popsize": size, "verbose": -9}
        search = cma.CMAEvolutionStrategy(rng.random(problem.dimension), 0.3, options)
        while not search.stop():
            points = search.ask()
            search.tell(points, problem.batch([lower + (upper - lower) * x for x in points]))
        size *= 2
