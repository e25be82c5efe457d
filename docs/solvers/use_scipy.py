"""A local method of SciPy, from one random start after another: settings = { method = "COBYQA" }, or "SLSQP", which is given slopes."""

import numpy as np
from scipy.optimize import Bounds, minimize

import door

with door.Problem("SciPy") as problem:
    method = problem.settings["method"]
    lower, upper = np.array(problem.lower), np.array(problem.upper)
    rng = np.random.default_rng(problem.seed)
    has_slopes = method == "SLSQP" and "subgradient" in problem.has

    # In the unit cube one step size serves all variables.
    def scaled(x):
        return lower + (upper - lower) * np.clip(x, 0, 1)

    def cost_and_slopes(x):
        cost, slopes = problem.subgradient(scaled(x))
        return cost, (upper - lower) * slopes

    # Neither method is to end before it has converged.
    options = {"maxiter": 1000} if method == "SLSQP" else {"maxfev": problem.budget}
    while True:
        minimize(
            cost_and_slopes if has_slopes else lambda x: problem(scaled(x)),
            rng.random(problem.dimension),
            jac=has_slopes or None,
            method=method,
            bounds=Bounds(0, 1),
            options=options,
        )
