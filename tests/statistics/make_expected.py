"""Expected values for the statistics of a benchmark, worked out by other libraries, but for `all_signs`.

`make_expected.py` compares them with those in expected.json; `make_expected.py --renew` writes that file.
A null in it is infinite. SciPy is given 1e300 for it: ranks are the same.
"""
import itertools
import json
import math
import sys
import warnings
from collections import defaultdict
from fractions import Fraction
from pathlib import Path

import numpy as np
import pandas as pd
import scikit_posthocs
from optimagic.visualization.profile_plot import _extract_profile_plot_lines
from scikit_posthocs._plotting import _find_maximal_cliques
from scipy import stats
from statsmodels.stats.multitest import multipletests

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # that its archive of other people's data cannot be reached
    from cocopp import toolsstats

FILE = Path(__file__).with_name("expected.json")
HUGE = 1e300
rng = np.random.default_rng(20260)


def plain(value):
    """What JSON can hold, with null for what is infinite or stands for it."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(item) for item in value]
    if isinstance(value, (float, np.floating)):
        assert not math.isnan(value)
        return None if value > HUGE / 1e6 else float(value)
    return int(value) if isinstance(value, np.integer) else value


def costs(shape, infinite=0.0, values=None):
    """Random costs to three digits, some of them infinite; from so few values that there are ties, if asked."""
    drawn = np.round(rng.lognormal(size=shape), 3) if values is None else rng.integers(values, size=shape) * 0.5
    return np.where(rng.random(shape) < infinite, HUGE, drawn)


KINDS = [{}, {"values": 4}, {"infinite": 0.3}, {"values": 6, "infinite": 0.5}]


def quantiles():
    for n in (1, 2, 3, 10, 41):
        sample, at = np.sort(rng.normal(size=n).round(3)), [0, 0.025, 0.25, 1 / 3, 0.5, 0.75, 0.975, 1]
        yield {"sorted": sample, "at": at, "values": np.quantile(sample, at)}


def ranks():
    for n, kind in itertools.product((0, 1, 2, 7, 30), KINDS):
        values = costs(n, **kind)
        yield {"values": values, "ranks": stats.rankdata(values)}


def friedman():
    shapes = [(2, 3), (3, 3), (4, 8), (12, 5), (30, 4), (6, 20), (100, 3)]
    for (n, k), kind in itertools.product(shapes, KINDS):
        blocks = costs((n, k), **kind) + (0.4 * np.arange(k) if n > 10 else 0)
        chi_square, p = stats.friedmanchisquare(*blocks.T)
        with np.errstate(divide="ignore"):  # where all blocks agree
            f = (n - 1) * chi_square / (n * (k - 1) - chi_square)
        mean_ranks = stats.rankdata(blocks, axis=1).mean(axis=0)
        nemenyi = scikit_posthocs.posthoc_nemenyi_friedman(blocks).to_numpy()
        range_ = stats.studentized_range.isf(0.05, k, np.inf)
        yield {
            "blocks": blocks,
            "mean_ranks": mean_ranks,
            "chi_square": chi_square,
            "p": p,
            "f": f,
            "f_p": stats.f.sf(f, k - 1, (k - 1) * (n - 1)),
            "nemenyi": nemenyi,
            "critical_difference": range_ / math.sqrt(2) * math.sqrt(k * (k + 1) / (6 * n)),
        }


def wilcoxon():
    cases = [(costs(n), costs(n)) for n in (1, 2, 5, 12, 49, 50, 51, 300)]
    cases += [(costs(n, **kind), costs(n, **kind)) for n in (2, 6, 15, 50, 120) for kind in KINDS[1:]]
    one = np.arange(1.0, 21.0)
    cases += [(one, one), (one, one + 1), (one, one + np.where(one == 3, 0, one)), (one, HUGE + one)]
    cases += [(one, np.where(one == 20, HUGE, one**1.5 + 1)), (one**2, np.zeros(20))]
    for first, second in cases:
        difference = first - second
        left = difference[difference != 0]
        tied = len(np.unique(np.abs(left))) < len(difference)
        options = {"zero_method": "wilcox", "correction": False}
        if len(left) == 0:
            statistic, p = 0.0, 1.0
        elif len(left) > 50:
            statistic, p = stats.wilcoxon(left, method="asymptotic", **options)
        elif not tied:
            statistic, p = stats.wilcoxon(first, second, method="exact", **options)
        elif len(difference) <= 13:
            # What SciPy does by itself: all permutations.
            statistic, p = stats.wilcoxon(first, second, **options)
        else:
            statistic, _ = stats.wilcoxon(first, second, method="asymptotic", **options)
            p = all_signs(stats.rankdata(np.abs(left)), statistic)
        yield {"first": first, "second": second, "statistic": statistic, "p": p, "exact": len(left) <= 50}


def all_signs(ranks, statistic):
    """Twice the share of all signs with a positive rank sum of at most the statistic, counted in whole numbers:
    SciPy has none for so many tied pairs."""
    counts = {0: 1}
    for rank in (round(2 * rank) for rank in ranks):
        more = defaultdict(int, counts)
        for total, count in counts.items():
            more[total + rank] += count
        counts = more
    below = sum(count for total, count in counts.items() if total <= round(2 * statistic))
    return min(1.0, float(Fraction(2 * below, 2 ** len(ranks))))


def holm():
    for m in (1, 2, 3, 10, 45):
        for p_values in (rng.random(m), rng.random(m) ** 4, np.round(rng.random(m) ** 3, 1)):
            yield {"p_values": p_values, "adjusted": multipletests(p_values, method="holm")[1]}


def vargha_delaney():
    for (m, n), kind in itertools.product([(1, 1), (3, 5), (15, 15), (40, 7)], KINDS):
        first, second = costs(m, **kind), costs(n, **kind)
        # Mann and Whitney's U counts the pairs in which the first is the higher one.
        u = stats.mannwhitneyu(second, first, method="asymptotic").statistic
        yield {"first": first, "second": second, "effect": u / (m * n)}


def studentised_range():
    for k in (2, 3, 5, 10, 23, 100):
        for q in (0.5, 2.0, 3.5, 5.0, 8.0):
            yield {"count": k, "q": q, "sf": max(stats.studentized_range.sf(q, k, np.inf), 0.0)}


def cliques():
    for k, level in itertools.product((2, 3, 6, 10), (0.2, 0.5, 0.8)):
        mean_ranks, upper = rng.permutation(k) + 1.0, np.triu(rng.random((k, k)) < level, 1)
        differ = upper | upper.T
        alike = pd.DataFrame((~differ & ~np.eye(k, dtype=bool)).astype(int))
        groups = [sorted(g, key=lambda i: mean_ranks[i]) for g in _find_maximal_cliques(alike) if len(g) > 1]
        groups.sort(key=lambda group: [mean_ranks[i] for i in group])
        yield {"mean_ranks": mean_ranks, "differ": differ.tolist(), "groups": groups}


class Given(np.random.Generator):
    """A generator whose whole numbers are given."""

    def __init__(self, indices):
        super().__init__(np.random.PCG64(0))
        self.indices = indices

    def integers(self, low, high=None, size=None, **_):
        assert low == 0 and size == self.indices.shape
        return self.indices


def trials(n, solved):
    """Running times of `n` runs; those that failed are negative."""
    return rng.integers(1, 5000, n) * np.where(np.arange(n) < solved, 1.0, -1.0)


def running_time(signed, axis=-1):
    """cocopp's expected running time."""
    one = lambda runs: min(toolsstats.sp(np.abs(runs), issuccessful=runs > 0)[0], HUGE)
    return np.apply_along_axis(one, axis, signed)


def bootstrap():
    statistics = {"mean": np.mean, "median": np.median, "expected_running_time": running_time}
    for (name, statistic), n in itertools.product(statistics.items(), (3, 15)):
        for level in (0.9, 0.95):
            indices = rng.integers(n, size=(199, n))
            sample = trials(n, 2 if n == 3 else 3) if name == "expected_running_time" else costs(n)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about a standard error, which has no meaning with 1e300
                interval = stats.bootstrap(
                    (sample,), statistic, n_resamples=len(indices), confidence_level=level,
                    method="percentile", rng=Given(indices), vectorized=True,
                ).confidence_interval
            yield {"statistic": name, "sample": sample, "level": level, "resamples": len(indices),
                   "indices": indices.flatten(), "interval": list(interval)}


def expected_running_time():
    for n, solved in ((1, 1), (1, 0), (15, 15), (15, 4), (15, 0), (200, 1)):
        signed = trials(n, solved)
        yield {"trials": signed, "expected": float(running_time(signed))}


def simulated_restarts():
    for n, solved, count in ((1, 1, 3), (4, 3, 50), (15, 4, 100), (20, 1, 20)):
        signed = trials(n, solved)
        draws = []
        for _ in range(count):
            draws.append([])
            while not draws[-1] or signed[draws[-1][-1]] < 0:
                draws[-1].append(int(rng.integers(n)))
        # cocopp draws once for every run, then again for every run that failed so far.
        rounds = ([run[i] for run in draws if len(run) > i] for i in itertools.count())
        given = lambda low, high, size: np.array(next(rounds))
        times = toolsstats.simulated_evals(
            np.abs(signed), n - solved, count, randint=given, randintrest=given, return_as=np.asarray)
        yield {"trials": signed, "indices": sum(draws, []), "times": times}


def lines(times, normalise):
    """optimagic's profiles: abscissae, and at each the share of every solver. It adds 1e-10 to each switch."""
    names = dict(index=pd.Index(range(len(times)), name="problem"),
                 columns=pd.Index(range(times.shape[1]), name="algorithm"))
    solved = pd.DataFrame(times < HUGE, **names)
    frame = pd.DataFrame(np.where(times < HUGE, times, np.inf), **names)
    with np.errstate(invalid="ignore"):
        drawn = _extract_profile_plot_lines(frame, normalise, solved, itertools.cycle(["black"]))
    return {"at": drawn[0].x, "shares": [line.y for line in sorted(drawn, key=lambda line: int(line.name))]}


def profiles():
    for (problems, solvers), infinite in itertools.product([(1, 2), (4, 3), (20, 3)], (0, 0.4)):
        times = rng.integers(10, 60, (problems, solvers)) * 1.0
        times = np.where(rng.random(times.shape) < infinite, HUGE, times)
        times[0, 0] = 7.0
        if problems > 1 and infinite:
            times[1] = HUGE
        dimensions = rng.integers(1, 20, problems)
        gradients = np.where(times < HUGE, times / (dimensions[:, None] + 1), HUGE)
        yield {"times": times, "dimensions": dimensions,
               "performance": lines(times, True), "data": lines(gradients, False)}


def differences(old, new, where="expected"):
    """Places where two files are not the same to 1e-9."""
    if isinstance(old, dict) and isinstance(new, dict) and old.keys() == new.keys():
        return sum((differences(old[key], new[key], f"{where}.{key}") for key in old), [])
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return sum((differences(*pair, f"{where}[{i}]") for i, pair in enumerate(zip(old, new))), [])
    if isinstance(old, float) and isinstance(new, (int, float)):
        same = abs(old - new) <= 1e-9 * max(1.0, abs(old))
    else:
        same = type(old) is type(new) and old == new
    return [] if same else [f"{where}: {old} in the file, now {new}"]


SUBJECTS = [quantiles, ranks, friedman, wilcoxon, holm, vargha_delaney, studentised_range, cliques,
            bootstrap, expected_running_time, simulated_restarts, profiles]

expected = {subject.__name__: plain(list(subject())) for subject in SUBJECTS}
if sys.argv[1:] == ["--renew"]:
    text = ",\n".join(f'"{name}": [\n' + ",\n".join(json.dumps(case, separators=(",", ":")) for case in cases) + "]"
                      for name, cases in expected.items())
    FILE.write_text("{" + text + "}\n")
else:
    found = differences(json.loads(FILE.read_text()), expected)
    print(*found[:20], sep="\n")
    sys.exit(f"{len(found)} values differ from {FILE}" if found else 0)
