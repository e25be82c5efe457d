"""Plan and benchmark the motion of free-floating space robots.

>>> import driftless
>>> task = driftless.Task()
>>> problem = task.problem("time-free")
>>> float(problem((problem.lower + problem.upper) / 2)) > problem.best_known
True
"""

from __future__ import annotations

import atexit

from ._driftless import Linearisation, Oracle, Problem, Term, __version__, end
from ._errors import (
    AlreadyThere,
    BudgetSpent,
    Error,
    InputError,
    Interrupted,
    NoDerivatives,
    ResultsError,
    RunEnded,
    SearchError,
)
from ._field import Builtin, Function, Optimiser, builtin, optimiser, problem
from ._motion import Motion, Samples
from ._planning import plan
from ._run import Figure, Figures, Result, open_results, run
from ._suites import functions, problems
from ._task import Task
from .adapters import cma, ioh_problem, minionpy, nevergrad, pygmo_problem, scipy

__all__ = [
    "AlreadyThere",
    "BudgetSpent",
    "Builtin",
    "Error",
    "Figure",
    "Figures",
    "Function",
    "InputError",
    "Interrupted",
    "Linearisation",
    "Motion",
    "NoDerivatives",
    "Optimiser",
    "Oracle",
    "Problem",
    "Result",
    "ResultsError",
    "RunEnded",
    "Samples",
    "SearchError",
    "Task",
    "Term",
    "__version__",
    "builtin",
    "cma",
    "functions",
    "ioh_problem",
    "minionpy",
    "nevergrad",
    "open_results",
    "optimiser",
    "plan",
    "problem",
    "problems",
    "pygmo_problem",
    "run",
    "scipy",
]

# Work in threads that Python does not wait for is ended before Python is.
atexit.register(end, 10.0)
del atexit, end
