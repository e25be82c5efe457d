"""Running experiments, and what they have found."""

from __future__ import annotations

import html
import io
import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import polars as pl

from . import _driftless
from ._errors import InputError, ResultsError, check_count
from ._experiment import Entrant, Minimised, apart, check_programs, enter, entrants_of, experiment_of, labelled
from ._field import Optimiser
from ._motion import Motion
from ._progress import Progress
from ._task import Task

__all__ = ["Figure", "Figures", "Result", "open_results", "run"]

_log = logging.getLogger("driftless")

# The file or module that a process is loading to take an optimiser from it.
loading: str | None = None


class Figure:
    """A figure of a report, as SVG in a notebook.

    Attributes
    ----------
    name : str
        What it is called.
    svg, pdf, png : pathlib.Path
        Its files.
    """

    def __init__(self, folder: Path, name: str) -> None:
        self.name = name
        self.svg, self.pdf, self.png = (folder / f"{name}.{kind}" for kind in ("svg", "pdf", "png"))

    def _repr_svg_(self) -> str:
        return self.svg.read_text(encoding="utf-8")

    def __repr__(self) -> str:
        # Without its place, which notebooks would store.
        return f"<driftless.Figure {self.name}>"


class Figures(Mapping[str, Figure]):
    """The figures of a report, by name."""

    def __init__(self, folder: Path) -> None:
        self._all = {file.stem: Figure(folder, file.stem) for file in sorted(folder.glob("*.svg"))}

    def __getitem__(self, name: str) -> Figure:
        try:
            return self._all[name]
        except KeyError:
            raise KeyError(f"found no figure {name!r}, expected one of {', '.join(self._all)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    def __repr__(self) -> str:
        return f"<driftless.Figures {', '.join(self._all)}>"


class Result:
    """What an experiment has found: a folder of results. `run` and `open_results` give one.

    Numbers and tables are those that are stored when they are first asked for.
    """

    def __init__(self, core: _driftless.Results) -> None:
        self._core = core
        self._reported: tuple[Path, list[tuple[str, str]]] | None = None
        self._kept: int | None = None

    @property
    def path(self) -> Path:
        """The folder."""
        return Path(self._core.path)

    @property
    def name(self) -> str:
        """The experiment's name."""
        return self._core.name

    @property
    def instances(self) -> tuple[str, ...]:
        """The labels of its instances; an empty one where there is but one."""
        return tuple(self._core.instances)

    @property
    def optimisers(self) -> tuple[str, ...]:
        """The labels of its optimisers."""
        return tuple(self._core.optimisers)

    @property
    def planned(self) -> int:
        """Runs that the experiment asks for."""
        return self._core.counts[0]

    @property
    def stored(self) -> int:
        """Runs that are stored."""
        return self._core.counts[1]

    @property
    def failed(self) -> int:
        """Stored runs that failed."""
        return self._core.counts[2]

    @property
    def tables(self) -> tuple[str, ...]:
        """The names of its tables."""
        return tuple(self._core.names())

    def table(self, name: str) -> pl.DataFrame:
        """A table of the report, such as ``"summary"``, ``"fixed-target"`` or ``"pairs"``; `tables` has all names.

        Parameters
        ----------
        name : str
            The table's name.

        Returns
        -------
        polars.DataFrame
            ``to_pandas()`` makes a table of pandas of it.
        """
        data = self._core.table(name)
        for damage in self._core.damage:
            _log.warning("%s; its runs are left out until `run` does them again", damage)
        if data is None:
            raise KeyError(f"found no table {name!r}, expected one of {', '.join(self.tables)}")
        return pl.read_parquet(io.BytesIO(data))

    def caption(self, name: str) -> str:
        """What a table shows, in words."""
        captions = self._core.captions()
        if name not in captions:
            raise KeyError(f"found no table {name!r}, expected one of {', '.join(captions)}")
        return captions[name]

    def motion(self, instance: str = "", task: Task | None = None) -> Motion:
        """The best motion of an instance that is a task.

        Parameters
        ----------
        instance : str, optional
            The instance's label; the only one without.
        task : Task, optional
            The task that the instance is. Results of several tasks do not hold them, so `open_results` needs it; `run` knows them.
        """
        if not instance and len(self.instances) == 1:
            instance = self.instances[0]
        return self._core.motion(instance, None if task is None else task._core)

    def report(self, out: str | os.PathLike[str] | None = None, *, replace: bool = False) -> Path:
        """Writes tables, figures and a page of all that is stored.

        Parameters
        ----------
        out : path-like, optional
            A folder; without it, that of the results.
        replace : bool, optional
            Whether to replace a report of more runs than are stored now.

        Returns
        -------
        pathlib.Path
            The page.
        """
        told = self._core.report(None if out is None else os.fspath(out), replace)
        self._kept = told["kept"]
        if self._kept is not None:
            _log.warning("%s shows %d runs, more than are stored, and was left as it was", told["page"], self._kept)
        page = Path(told["page"])
        self._reported = page, [(str(question), str(answer)) for question, answer in told["findings"]]
        return page

    @property
    def findings(self) -> list[tuple[str, str]]:
        """What the runs say, in words: questions and answers."""
        return list(self._report()[1])

    @property
    def figures(self) -> Figures:
        """The figures of the report, by name. The report is written first, unless this result has written it before.

        Raises
        ------
        ResultsError
            A report of more runs was left as it was, and its figures are not these.
        """
        page = self._report()[0]
        if self._kept is not None:
            hint = "`report(replace=True)` replaces it, `report(out)` puts the report elsewhere"
            raise ResultsError(f"{page} shows {self._kept} runs, more than are stored, and so do its figures; {hint}")
        return Figures(page.parent / "figures")

    def _report(self) -> tuple[Path, list[tuple[str, str]]]:
        if self._reported is None:
            self.report()
        assert self._reported is not None
        return self._reported

    def __reduce__(self) -> tuple[Any, ...]:
        return open_results, (str(self.path.absolute()),)

    def __repr__(self) -> str:
        failed = f", {self.failed} failed" if self.failed else ""
        return f"<driftless.Result {self.name}: {self.stored} of {self.planned} runs{failed}, in {self.path}>"

    def _repr_html_(self) -> str:
        return f"<p>{html.escape(repr(self)[1:-1])}</p>{self.table('summary')._repr_html_()}"


def open_results(path: str | os.PathLike[str]) -> Result:
    """Opens a folder of results, whoever made it. Nothing is written.

    Parameters
    ----------
    path : path-like
        The folder.

    Raises
    ------
    ResultsError
        There are no results.
    """
    return Result(_driftless.Results.open(os.fspath(path)))


def run(
    experiment: str | os.PathLike[str] | None = None,
    *,
    optimisers: Entrant | Sequence[Entrant] = (),
    problems: Minimised | Sequence[Minimised] | Mapping[str, Minimised] = (),
    name: str | None = None,
    seeds: int | None = None,
    budget: int | None = None,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    retry: bool = False,
    fresh: bool = False,
    trust: bool = False,
    isolation: str | None = None,
    progress: bool = True,
) -> Result:
    """Runs an experiment: every optimiser on every problem, for every seed.

    Runs that are stored are not done again, whether the command or Python has done them. Ctrl-C ends the experiment; the same
    call goes on from there.

    Parameters
    ----------
    experiment : path-like, optional
        An experiment file, as ``driftless run`` takes it. `optimisers` and `problems` are entered beside those of the file.
    optimisers : str, Optimiser, Builtin or a sequence of these, optional
        Names of optimisers of the package, functions decorated by `optimiser`, and those that `builtin`, `scipy`, `cma`,
        `minionpy` and `nevergrad` make.
    problems : Task, Problem, Function, a sequence or a mapping of these, optional
        What is minimised; the keys of a mapping are labels.
    name : str, optional
        The experiment's name, where there is no file.
    seeds : int, optional
        Number of seeds, instead of the file's or 15. They are 1, 2, … for every optimiser and problem.
    budget : int, optional
        Evaluations per run, instead of the file's or 150,000.
    out : path-like, optional
        Folder for the results, instead of ``results/NAME``.
    jobs : int, optional
        Runs at a time; one per processor without.
    retry, fresh : bool, optional
        Whether to do stored runs again that have failed, or all.
    trust : bool, optional
        Whether to start programs that a file of results names, which may come from anybody.
    isolation : {"thread", "process"}, optional
        Where functions run, instead of what each says; see `Optimiser`.
    progress : bool, optional
        Whether to show a bar.

    Returns
    -------
    Result

    Raises
    ------
    InputError
        A file or an argument cannot be used.
    ResultsError
        Results cannot be read or written.
    KeyboardInterrupt
        Ctrl-C.

    Examples
    --------
    >>> import driftless, tempfile
    >>> @driftless.optimiser
    ... def guess(oracle, rng):
    ...     while True:
    ...         oracle.batch(rng.uniform(oracle.lower, oracle.upper, (50, oracle.dimension)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     result = driftless.run(
    ...         problems=driftless.functions("sphere", dimension=3),
    ...         optimisers=[guess, "cma-es"],
    ...         seeds=3, budget=500, out=folder, progress=False,
    ...     )
    ...     result.table("summary")["optimiser"].to_list()
    ['guess', 'cma-es']
    """
    if loading is not None:
        raise RuntimeError(
            f"{loading} runs an experiment when it is imported, which a process of an optimiser does: "
            'write `if __name__ == "__main__":` in front'
        )
    if isolation not in (None, "thread", "process"):
        raise InputError(f'found isolation {isolation!r}, expected "thread" or "process"')
    entrants = entrants_of(optimisers)
    numbers = {"seeds": (seeds, 1_000_000), "budget": (budget, 10**12), "jobs": (jobs, 1024)}
    for what, (number, most) in numbers.items():
        if number is not None:
            check_count(what, number, most)
    if out is not None and not os.fspath(out):
        raise InputError("found an empty path, expected a folder for the results")
    if isolation is not None:
        entrants = [e.replace(isolation=isolation) if isinstance(e, Optimiser) else e for e in entrants]
    core = experiment_of(experiment, name, labelled(problems))
    core = enter(core, apart(entrants))
    if seeds is not None:
        core = core.with_seeds(seeds)
    if budget is not None:
        core = core.with_budget(budget)
    check_programs(core, trust)
    bar = Progress(progress, core.name)
    watched = _Watched(bar)
    again = "all" if fresh else "failed" if retry else None
    folder = None if out is None else os.fspath(out)
    try:
        return Result(core.run(folder, jobs, again, watched.begin, watched.tick))
    finally:
        bar.end()


class _Watched:
    """Shows progress, and logs what becomes of runs."""

    def __init__(self, bar: Progress) -> None:
        self._bar = bar

    def begin(self, folder: Any, missing: int, planned: int, evaluations: int) -> None:
        _log.info("%d of %d runs are to be done, stored in %s", missing, planned, folder)
        self._bar.begin(evaluations)

    def tick(self, evaluations: int, ended: list[tuple[str, str, int, str, str]]) -> None:
        self._bar.update(evaluations)
        for optimiser, instance, seed, found, message in ended:
            level = logging.WARNING if message else logging.INFO
            where = f"{optimiser} {instance}".strip()
            _log.log(level, "%s seed %d: %s%s", where, seed, found, f": {message}" if message else "")
