"""An algorithm of minionpy: settings = { algorithm = "jSO" }, "LSRTDE" and others."""

import minionpy

import door

with door.Problem("minionpy") as problem:
    minionpy.Minimizer(
        lambda points, *_: problem.batch(points),
        list(zip(problem.lower, problem.upper)),
        algo=problem.settings["algorithm"],
        maxevals=problem.budget,
        seed=problem.seed,
    ).optimize()
