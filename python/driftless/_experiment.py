"""What `run` is given, as an experiment."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any, cast

from . import _driftless
from ._driftless import Problem
from ._errors import InputError, made_text
from ._field import Builtin, Function, Optimiser, external_table
from ._suites import _FIELD
from ._task import Task
from ._toml import value

__all__ = ["Entrant", "Minimised", "apart", "check_programs", "enter", "entrants_of", "experiment_of", "labelled"]

_log = logging.getLogger("driftless")

Entrant = Optimiser | Builtin | str
Minimised = Problem | Function | Task


def entrants_of(optimisers: Any) -> list[Entrant]:
    """One optimiser or many, checked."""
    is_one = isinstance(optimisers, (str, Optimiser, Builtin)) or not hasattr(optimisers, "__iter__")
    entrants: list[Any] = [optimisers] if is_one else list(cast(Iterable[Any], optimisers))
    for entrant in entrants:
        if not isinstance(entrant, (str, Optimiser, Builtin)):
            what = getattr(entrant, "__name__", repr(entrant))
            raise TypeError(f"found {what}, expected a name or an optimiser: decorate functions with `driftless.optimiser`")
    return entrants


def labelled(problems: Any) -> dict[str, Minimised]:
    """One problem or many by their labels, checked."""
    if isinstance(problems, Mapping):
        _check_problems(problems.values())
        return dict(problems)
    is_one = isinstance(problems, (str, os.PathLike)) or not hasattr(problems, "__iter__")
    all_: list[Any] = [problems] if is_one else list(cast(Iterable[Any], problems))
    _check_problems(all_)
    found: dict[str, Minimised] = {}
    for one in all_:
        if isinstance(one, Problem):
            # The only one needs no label, as in a file.
            label = one.label or ("" if len(all_) == 1 else one.name)
        else:
            label = one.robot if isinstance(one, Task) else one.name
        if label in found:
            raise InputError(f"found two problems {label!r}, expected a mapping with a label for each")
        found[label] = one
    return found


def _check_problems(problems: Iterable[Any]) -> None:
    for one in problems:
        if isinstance(one, (str, os.PathLike)):
            raise TypeError(
                f"found {os.fspath(one)!r}, expected a task or a problem: "
                "`Task.from_file` reads a task, `driftless.problems` those of an experiment, `driftless.functions` has test functions"
            )
        if not isinstance(one, (Problem, Function, Task)):
            what = getattr(one, "__name__", repr(one))
            raise TypeError(f"found {what}, expected a task or a problem: decorate functions with `driftless.problem`")
        if isinstance(one, Problem) and not one._is_preferred:
            raise InputError(
                f"found a problem in the formulation {one.formulation!r}, which is an optimiser's to choose: "
                "pass the task, and `formulation` to `driftless.optimiser` or `driftless.builtin`"
            )


def experiment_of(
    path: str | os.PathLike[str] | None, name: str | None, problems: dict[str, Minimised]
) -> _driftless.Experiment:
    """An experiment of a file, or of problems."""
    if path is not None:
        if name is not None:
            raise InputError("found a name beside an experiment file, which has one")
        core = _driftless.Experiment.read(os.fspath(path))
        if core.imported is not None:
            raise InputError(f"these results were imported, from {core.imported}, and cannot be run", os.fspath(path))
    else:
        name = name or "python"
        if not problems:
            raise InputError("found neither an experiment file nor problems, expected something to minimise")
        (label, only), *others = problems.items()
        file = None if others else _file(label, only)
        if file is not None:
            # As a file with a task, so that the command can do what is missing, too.
            path, text = file
            with made_text(path, ["name", "problems"]):
                return _driftless.Experiment.parse(path, f"name = {value(name)}\n{text}{_FIELD}").without_optimisers()
        core = _driftless.Experiment(name)
    for label, one in problems.items():
        if isinstance(one, Function):
            box = one.lower.tolist(), one.upper.tolist()
            core = core.with_function(
                label, one.identity(), one.function, one.batched, *box, one.least_cost, list(one.targets)
            )
        else:
            core = core.with_problem(one.problem() if isinstance(one, Task) else one, label)
    return core


def _file(label: str, one: Minimised) -> tuple[str, str] | None:
    """Place and text of a task that has no label of its own."""
    if isinstance(one, Task):
        return (one._core.path, one._core.text) if label == one.robot else None
    return one._file if isinstance(one, Problem) and label == one.label else None


def apart(entrants: list[Entrant]) -> list[Entrant]:
    """Labels by their settings those functions that have a name more than once."""
    names = Counter(e.name for e in entrants if isinstance(e, Optimiser) and e.label is None)
    found: list[Entrant] = []
    for entrant in entrants:
        if isinstance(entrant, Optimiser) and entrant.label is None and names[entrant.name] > 1:
            parts = [f"{key}={x}" for key, x in entrant.settings.items()]
            entrant = entrant.replace(label=" ".join([entrant.name, *parts]))
        found.append(entrant)
    return found


def enter(core: _driftless.Experiment, entrants: list[Entrant]) -> _driftless.Experiment:
    """The experiment with these optimisers, too."""
    for entrant in entrants:
        if isinstance(entrant, str):
            entrant = Builtin(entrant)
        if isinstance(entrant, Optimiser) and entrant.isolation == "thread":
            core = core.with_optimiser(
                entrant.name,
                entrant.label,
                entrant.identity(),
                entrant.function,
                dict(entrant.settings),
                entrant.formulation,
                entrant.needs_derivatives,
                entrant.seeds,
                entrant.budget,
            )
            continue
        what = entrant.label or entrant.name
        if isinstance(entrant, Builtin):
            _driftless.check_optimiser(entrant.name)
            table, settings = entrant.to_toml(), [f"{what}: {key}" for key in entrant.settings]
        else:
            table, settings = external_table(entrant), []
        # Programs are sought from where Python is.
        path, text = os.path.abspath("field"), f'name = "field"\n{table}'
        with made_text(path, [*[what] * (text.count("\n") - len(settings)), *(settings or [what])]):
            core = core.with_optimisers_of(_driftless.Experiment.parse(path, text))
    return core


def check_programs(core: _driftless.Experiment, trust: bool) -> None:
    """Whether the programs that an experiment starts may be started."""
    for program, is_from_results in core.programs:
        if is_from_results and not trust:
            raise InputError(
                f"a file of results, which may come from anybody, starts {program}",
                hint="look at it, and pass trust=True to start it",
            )
        _log.info("this experiment starts %s", program)
