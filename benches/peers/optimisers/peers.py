"""The race of race.json run by other packages, beside the results of this crate.

Usage: peers.py race.json ours.json
"""

import json
import statistics
import sys
import warnings

import numpy as np
import scipy
import scipy.optimize

warnings.filterwarnings("ignore")
import cma  # noqa: E402
import minionpy  # noqa: E402
import pygmo  # noqa: E402

LOWER, UPPER = -5.0, 5.0


class Enough(Exception):
    """The target is met or the budget spent."""


def placement(n, instance):
    """Shift and rotation as src/problem/analytic.rs documents them."""
    k = np.arange(n + n * n, dtype=object) + instance * (n + n * n) + 1
    u = np.array([((j * j * 0x9E3779B97F4A7C15 % 2**64 >> 12) + 0.5) / 2**52 for j in k])
    shift, vectors, rotation = 8 * u[:n] - 4, 2 * u[n:].reshape(n, n) - 1, np.eye(n)
    for v in vectors:
        rotation = rotation @ (np.eye(n) - 2 * np.outer(v, v) / (v @ v))
    return shift, rotation


def ellipsoid(z):
    return 1e6 ** (np.arange(len(z)) / (len(z) - 1)) @ (z * z)


def rastrigin(z):
    return np.sum(10 + z * z - 10 * np.cos(2 * np.pi * z))


FUNCTIONS = {
    "sphere": (lambda z: z @ z, 0),
    "ellipsoid": (ellipsoid, 0),
    "rosenbrock": (scipy.optimize.rosen, 1),
    "rastrigin": (rastrigin, 0),
}


class Problem:
    """One run's function: counts, notes when the target is met, and ends the run."""

    def __init__(self, race, name, ends=True):
        self.n, self.budget, self.target = race["dimension"], race["budget"], race["target"]
        self.function, self.own = FUNCTIONS[name]
        self.shift, self.rotation = placement(self.n, race["instance"])
        self.ends, self.evaluations, self.hit = ends, 0, None

    def __call__(self, x):
        if self.ends and (self.hit or self.evaluations == self.budget):
            raise Enough
        self.evaluations += 1
        value = float(self.function(self.rotation @ (np.asarray(x) - self.shift) + self.own))
        if value <= self.target and self.hit is None and self.evaluations <= self.budget:
            self.hit = self.evaluations
        return value

    # What pygmo asks for.
    def fitness(self, x):
        return [self(x)]

    def get_bounds(self):
        return [LOWER] * self.n, [UPPER] * self.n

    def __deepcopy__(self, memo):
        return self


def uniform(problem, rng):
    return rng.uniform(LOWER, UPPER, problem.n)


def pygmo_evolve(problem, seed, algorithm, population):
    pygmo.set_global_rng_seed(seed)
    algorithm = pygmo.algorithm(algorithm)
    algorithm.set_seed(seed)
    population = pygmo.population(pygmo.problem(problem), population, seed=seed)
    while True:
        population = algorithm.evolve(population)


def pygmo_pso(kind):
    def run(problem, seed, settings):
        s = settings["pso"]
        # 1: inertia weight, one neighbourhood, no bound on generations but the budget's.
        swarm = kind(
            gen=10**6, omega=s["inertia"]["first"], eta1=s["cognitive"], eta2=s["social"],
            max_vel=s["velocity_limit"], variant=1, neighb_type=1, seed=seed,
        )
        pygmo_evolve(problem, seed, swarm, s["population"])

    return run


def pygmo_de(problem, seed, settings):
    s = settings["de"]
    # 7: rand/1/bin.
    de = pygmo.de(gen=10**6, F=s["weight"], CR=s["crossover"], variant=7, ftol=0, xtol=0, seed=seed)
    pygmo_evolve(problem, seed, de, s["population"])


def scipy_de(updating):
    def run(problem, seed, settings):
        s = settings["de"]
        start = np.random.default_rng(seed).uniform(LOWER, UPPER, (s["population"], problem.n))
        scipy.optimize.differential_evolution(
            problem, [(LOWER, UPPER)] * problem.n, strategy="rand1bin", init=start,
            mutation=s["weight"], recombination=s["crossover"], updating=updating, tol=0, atol=-1,
            maxiter=10**9, polish=False, rng=seed,
        )

    return run


def minion_l_shade(problem, seed, settings):
    # It cannot be interrupted; its defaults are the paper's settings but for the population.
    minionpy.LSHADE(
        lambda points: [problem(x) for x in points], bounds=[(LOWER, UPPER)] * problem.n,
        maxevals=problem.budget, seed=seed,
        options={"population_size": 18 * problem.n, "memory_size": 6, "archive_size_ratio": 2.6},
    ).optimize()


def scipy_nelder_mead(problem, seed, settings):
    s, rng = settings["nelder-mead"], np.random.default_rng(seed)
    width, edge = UPPER - LOWER, s["simplex"] * (UPPER - LOWER)
    while True:
        start = uniform(problem, rng)
        inwards = np.where(start + edge > UPPER, -edge, edge)
        scipy.optimize.minimize(
            problem, start, method="Nelder-Mead", bounds=[(LOWER, UPPER)] * problem.n,
            options={
                "initial_simplex": np.vstack([start, start + np.diag(inwards)]),
                "xatol": 1e-8 * width, "fatol": 1e-9,
                "maxiter": 10**9, "maxfev": 10**9,
            },
        )


def pycma(problem, seed, settings):
    rng, step = np.random.default_rng(seed), settings["cma-es"]["step"] * (UPPER - LOWER)
    options = {"bounds": [LOWER, UPPER], "verbose": -9, "seed": seed, "maxfevals": problem.budget}
    cma.fmin2(problem, lambda: uniform(problem, rng), step, options, restarts=9, incpopsize=2)


def pycma_unbounded(problem, seed, settings):
    rng, step = np.random.default_rng(seed), settings["cma-es"]["step"] * (UPPER - LOWER)
    options = {"verbose": -9, "seed": seed, "maxfevals": problem.budget}
    cma.fmin2(problem, lambda: uniform(problem, rng), step, options, restarts=9, incpopsize=2)


PEERS = {
    "pso": {"pygmo pso_gen": pygmo_pso(pygmo.pso_gen), "pygmo pso": pygmo_pso(pygmo.pso)},
    "de": {
        "scipy, deferred": scipy_de("deferred"),
        "scipy, immediate": scipy_de("immediate"),
        "pygmo de": pygmo_de,
    },
    "l-shade": {"minionpy LSHADE": minion_l_shade},
    "nelder-mead": {"scipy": scipy_nelder_mead},
    "cma-es": {"pycma": pycma, "pycma, no bounds": pycma_unbounded},
}


def peer_hits(race, name, run, settings):
    hits = []
    for seed in range(1, race["seeds"] + 1):
        problem = Problem(race, name, ends=run is not minion_l_shade)
        try:
            run(problem, seed, settings)
        except Exception as error:
            # pygmo passes exceptions on as its own.
            if not isinstance(error, Enough) and "Enough" not in str(error):
                raise
        hits.append(problem.hit)
    return hits


def median(hits):
    return statistics.median([hit for hit in hits if hit is not None])


def ratio(mine, theirs):
    """Of the medians, where either side gets there in at least half of its runs."""
    often = all(2 * sum(hit is not None for hit in hits) >= len(hits) for hits in (mine, theirs))
    return f"{median(mine) / median(theirs):.2f}" if often else "–"


def shown(hits):
    solved = sum(hit is not None for hit in hits)
    return f"{median(hits):.0f} ({solved}/{len(hits)})" if solved else f"– (0/{len(hits)})"


def main():
    race, ours = (json.load(open(path)) for path in sys.argv[1:3])
    versions = [f"{m.__name__} {m.__version__}" for m in (scipy, cma, pygmo)]
    print(", ".join([*versions, "minionpy 1.9.1"]), "\n")
    print("| optimiser | function | ours | peer | of the peer | ratio |\n|---|---|---|---|---|---|")
    for label, settings in race["optimisers"].items():
        for name in race["functions"]:
            mine = ours[label][name]
            for peer, run in PEERS[label].items():
                theirs = peer_hits(race, name, run, settings)
                cells = [label, name, shown(mine), peer, shown(theirs), ratio(mine, theirs)]
                print(f"| {' | '.join(cells)} |")
                sys.stdout.flush()


main()
