"""Two experiments put together: iohinspector, cocopp and `driftless report` agree on which function, dimension and instance
every run is of, and on what it found; so do the exports once they are imported: together.py FOLDER.
"""

import sys
import warnings
from collections import Counter, defaultdict
from pathlib import Path

import iohinspector
import polars as pl

from coco import SEEDS, cocopp


def main(folder):
    folder = Path(folder)
    ioh, names = of_iohinspector(folder / "ioh")
    coco = of_cocopp(folder / "coco", names)
    runs = of_report(folder / "ours")
    ours = Counter((optimiser, *instance) for instance, optimiser, _, _ in runs)
    for tool, found in [("iohinspector", ioh), ("cocopp", coco)]:
        if found != ours:
            raise SystemExit(f"{tool} and the report differ: {found - ours} {ours - found}")
    instances = {key[1:] for key in ours}
    shared = {key[1:] for key in ours if key[0] in ("pso", "cma-es of twelve")}
    shared &= {key[1:] for key in ours if key[0] not in ("pso", "cma-es of twelve")}
    print(
        f"{ours.total()} runs on {len(instances)} instances of {len(names)} functions, {len(shared)} of them in both "
        "experiments: iohinspector, cocopp and the report agree on each"
    )
    imported(folder / "all", runs, instances)


def of_iohinspector(folder):
    """How many runs of each algorithm, function, dimension and instance, and the functions' names by number."""
    manager = iohinspector.DataManager()
    manager.add_folder(str(folder))
    counts, names = Counter(), {}
    for run in manager.overview.iter_rows(named=True):
        number, name = run["function_id"], run["function_name"]
        if names.setdefault(number, name) != name:
            raise SystemExit(f"function {number} is {names[number]} and {name}")
        counts[run["algorithm_name"], name, run["dimension"], run["instance"]] += 1
    return counts, names


def of_cocopp(folder, names):
    """The same."""
    counts = Counter()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        data_sets = cocopp.pproc.DataSetList([str(path) for path in folder.glob("*/*/*.info")])
    for data in data_sets:
        for number in data.instancenumbers:
            counts[data.algId, names[data.funcId], data.dim, int(number) // SEEDS] += 1
    return counts


def of_report(folder):
    """Instance, optimiser, seed and best cost of every run."""
    table = pl.read_csv(folder / "tables" / "runs.csv")
    runs = []
    for run in table.iter_rows(named=True):
        name, dimension, instance = run["instance"].split(" ")
        place = (name, int(dimension.removeprefix("dimension=")), int(instance.removeprefix("instance=")))
        runs.append((place, run["optimiser"], run["seed"], run["best f"]))
    return runs


def imported(folder, ours, instances):
    """Imported runs stand on the instances that they were exported from, and have found the same."""
    found = defaultdict(list)
    for place, optimiser, seed, cost in of_report(folder):
        # Behind an optimiser's name stands that of its folder.
        found[place, optimiser.rpartition(" (")[0] or optimiser, seed].append(cost)
    if {place for place, _, _ in found} != instances:
        raise SystemExit("imported runs have instances of their own")
    for place, optimiser, seed, cost in ours:
        if found[place, optimiser, seed] != [cost] * 3:
            raise SystemExit(f"{optimiser} on {place} with seed {seed}: {found[place, optimiser, seed]} instead of {cost}")
    print(f"{3 * len(ours)} runs, ours and imported from both formats, on the same {len(instances)} instances with the same costs")


if __name__ == "__main__":
    main(*sys.argv[1:])
