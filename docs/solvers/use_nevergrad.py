"""An optimiser of nevergrad: settings = { optimizer = "NGOpt" } and others. nevergrad 1.0.12 needs numpy below 2.4."""

import nevergrad as ng
import numpy as np

import door

with door.Problem("nevergrad") as problem:
    lower, upper = np.array(problem.lower), np.array(problem.upper)
    # In the unit cube one step size serves all variables.
    space = ng.p.Array(shape=lower.shape, lower=0, upper=1)
    space.random_state.seed(problem.seed)
    optimizer = ng.optimizers.registry[problem.settings["optimizer"]](space, budget=problem.budget)
    while True:
        candidate = optimizer.ask()
        optimizer.tell(candidate, problem(lower + (upper - lower) * candidate.value))
