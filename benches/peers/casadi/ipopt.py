"""The time-free task as a nonlinear program, solved by IPOPT.

    minimise    K_t t_f                                     over the bump coefficients c and t_f
    subject to  δq_b(c) = 0                                 the base ends at its goal: three rows
                |θ'|, |θ''|, |θ'''| ≤ limit · t_f^order     of every joint, on grids of times
                |c| ≤ box

`derived.py` and `plain.py` write it down, with derivatives put together by hand and without.
"""

import time

import casadi as ca
import numpy as np

from model import evaluate

OPTIONS = {
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "print_time": False,
    "no_nlp_grad": True,
    "ipopt.max_iter": 500,
    # The program is well scaled. Without scaling and with minimum-degree ordering MUMPS is the faster,
    # by a few per cent on this grid and by much more on finer ones, through as many iterations.
    "ipopt.linear_system_scaling": "none",
    "ipopt.mumps_scaling": 0,
    "ipopt.mumps_permuting_scaling": 0,
    "ipopt.mumps_pivot_order": 0,
}


class Solver:
    """IPOPT with the program in one of its forms, built."""

    def __init__(self, task, program, derivatives, options=OPTIONS):
        self.task, self.shape = task, (len(task.links), task.terms)
        self.ipopt = ca.nlpsol("solver", "ipopt", program, {**derivatives, **options})
        box, limits = np.tile(task.box, self.shape[0]), np.ones(program["g"].numel() - 3)
        self.bounds = {
            "lbx": np.append(-box, 0.1),
            "ubx": np.append(box, 1000),
            "lbg": np.append(np.zeros(3), -limits),
            "ubg": np.append(np.zeros(3), limits),
        }

    def solve(self, start):
        """Solves from the given coefficients and their shortest duration. What is found is evaluated
        densely, at the shortest duration within the limits."""
        duration = evaluate(self.task, np.reshape(start, self.shape), steps=1).shortest
        guess = np.append(start, duration)
        x, multipliers, told = run(self.ipopt, guess, self.bounds)
        motion = evaluate(self.task, x[:-1].reshape(self.shape))
        return {
            "coefficients": x[:-1].tolist(),
            "j": motion.cost(self.task),
            "t_f": motion.shortest,
            "residual_deg": motion.residual_deg(),
            # By how much the duration found is too short for the limits at all times.
            "excess": motion.shortest / x[-1] - 1,
            "multiplier": float(np.linalg.norm(multipliers[:3])),
            **told,
        }


def run(ipopt, guess, bounds):
    """Solves from a guess: the point found, the rows' multipliers, and what is told of any solution. The
    clock runs while IPOPT does."""
    clock, busy = time.perf_counter(), time.process_time()
    solution = ipopt(x0=guess, **bounds)
    seconds, busy = time.perf_counter() - clock, time.process_time() - busy
    stats = ipopt.stats()
    told = {
        "seconds": seconds,
        "processor_seconds": busy,
        "ending": stats["return_status"],
        "iterations": stats["iter_count"],
    }
    return solution["x"].full().ravel(), solution["lam_g"].full().ravel(), told
