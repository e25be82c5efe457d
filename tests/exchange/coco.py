"""The COCO files as cocopp reads them."""

import warnings

import numpy as np

from ioh import instance_number
from stored import expected_running_time

with warnings.catch_warnings():
    # It looks for archives of others' results in the net, which are not needed here.
    warnings.simplefilter("ignore")
    import cocopp


class DriftlessTestbed(cocopp.testbedsettings.GECCOBBOBTestbed):
    """Test functions and tasks of this program: one objective, differences from the optimum down to 1e-8."""


cocopp.testbedsettings.DriftlessTestbed = DriftlessTestbed
cocopp.testbedsettings.suite_to_testbed["driftless"] = "DriftlessTestbed"

# Trial numbers of an instance.
SEEDS = 2_000_000

# From 1e4 down to the precision, on the grid that the reader rounds down to.
TARGETS = [float(np.power(10, i / 5)) for i in range(20, -41, -1)]


def compare(folder, table, optima, tally):
    """Numbers of the index, and cocopp's running times, of each trial and expected; gives the data set of
    every group and optimiser."""
    left, found = dict(table), {}
    with warnings.catch_warnings():
        # Fewer or more than 15 trials of a function are worth a warning to cocopp.
        warnings.simplefilter("ignore")
        data_sets = cocopp.pproc.DataSetList([str(path) for path in folder.glob("*/*.info")])
    for data in data_sets:
        group, optimiser = identity(data, left)
        where = f"{group} {optimiser}"
        compare_data_set(data, left.pop((group, optimiser)), optima[group], tally, where)
        found[group, optimiser] = data
    if left:
        raise SystemExit(f"no data set of {sorted(left)}")
    return found


def identity(data, left):
    """Group and optimiser; the comment has `; group GROUP; Fopt: …`."""
    group = data.comment.split("; group ")[1].split("; Fopt: ")[0]
    if (group, data.algId) not in left:
        raise SystemExit(f"unknown data set {data.algId} {data.comment}")
    return group, data.algId


def compare_data_set(data, trials, optimum, tally, where):
    instances = sorted({trial.instance for trial in trials}, key=instance_number)
    place = lambda trial: (instances.index(trial.instance), trial.seed)
    trials = sorted(trials, key=place)
    numbers = [divmod(int(number), SEEDS) for number in data.instancenumbers]
    tally["coco: trials"].compare([seed for _, seed in numbers], [trial.seed for trial in trials], where)
    known = {trial.instance: number for trial, (number, _) in zip(trials, numbers)}
    again = [known[trial.instance] for trial in trials]
    tally["coco: trials"].compare([number for number, _ in numbers], again, where)
    if len(set(known.values())) < len(instances):
        raise SystemExit(f"{where}: two instances have one number")
    spent = [trial.evaluations for trial in trials]
    tally["coco: evaluations spent"].compare(data.readmaxevals, spent, where)
    shifted = [shift(trial, optimum) for trial in trials]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        expected_times, times = data.detERT(TARGETS), data.detEvals(TARGETS)
    for target, expected, row in zip(TARGETS, expected_times, times):
        place = f"{where} at {target}"
        ours = expected_running_time(shifted, target)
        tally["coco: expected running times"].compare(expected, ours, place)
        hits = [trial.hit(target) for trial in shifted]
        tally["coco: running times"].compare(np.where(np.isnan(row), np.inf, row), hits, place)


def shift(trial, optimum):
    """The same trial with differences from the optimum."""
    return type(trial)(trial.instance, trial.seed, trial.evaluations, trial.at, trial.cost - optimum)
