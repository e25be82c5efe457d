"""Races: functions as optimisers and problems, results that the command shares, and solvers that misbehave."""

from __future__ import annotations

import contextlib
import functools
import logging
import math
import os
import pickle
import re
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import driftless

from processes import call, child

Rng = np.random.Generator


@driftless.optimiser
def guess(oracle: driftless.Oracle, rng: Rng, *, size: int = 64) -> None:
    while True:
        oracle.batch(rng.uniform(oracle.lower, oracle.upper, (size, oracle.dimension)))


@driftless.problem(lower=-5, upper=5, dimension=3, least_cost=0, targets=[1.0, 1e-2])
def bowl(x: np.ndarray) -> float:
    return float(x @ x)


def race(
    optimiser: driftless.Optimiser | Callable[..., object],
    tmp_path: Path,
    *,
    problem: driftless.Problem | driftless.Function = bowl,
    budget: int = 200,
    seeds: int = 1,
    **keywords: object,
) -> driftless.Result:
    if not isinstance(optimiser, driftless.Optimiser):
        optimiser = driftless.optimiser(optimiser)
    return driftless.run(
        problems=problem,
        optimisers=optimiser,
        seeds=seeds,
        budget=budget,
        out=tmp_path / "results",
        progress=False,
        **keywords,  # type: ignore[arg-type]
    )


def records(result: driftless.Result) -> pl.DataFrame:
    """The stored records of the runs, in the order of the plan."""
    return pl.read_parquet(result.path / "runs" / "*.parquet").sort("optimiser", "seed")


def record(result: driftless.Result) -> dict[str, object]:
    (only,) = records(result).to_dicts()
    return only


# What runs come to


def test_a_notebook_without_widgets_is_not_warned() -> None:
    code = """
        import sys, types, warnings
        warnings.simplefilter("always")
        # As tqdm tells a notebook.
        sys.modules["ipykernel.zmqshell"] = types.ModuleType("zmqshell")
        sys.modules["IPython"] = types.SimpleNamespace(get_ipython=object)
        sys.modules["ipywidgets"] = None
        import driftless
        driftless.plan(optimiser="nelder-mead", budget=500)
        assert "tqdm.autonotebook" in sys.modules
    """
    done = child(textwrap.dedent(code))
    # That the motion passes through the robot is said, and nothing else.
    assert done.returncode == 0, done.stderr
    told = [line for line in done.stderr.splitlines() if "passes through the robot" not in line]
    assert told == []


def test_a_race_is_counted_and_reported(tmp_path: Path) -> None:
    problems = [bowl, *driftless.functions("rastrigin", dimension=3)]
    result = driftless.run(
        problems=problems, optimisers=[guess, "cma-es", driftless.builtin("de", population=20)],
        seeds=4, budget=1000, out=tmp_path, progress=False,
    )  # fmt: skip
    assert (result.planned, result.stored, result.failed) == (24, 24, 0)
    assert result.optimisers == ("guess", "cma-es", "de")
    assert result.instances == ("bowl", "rastrigin dimension=3 instance=1")
    summary = result.table("summary")
    assert isinstance(summary, pl.DataFrame) and summary.height == 6
    runs = result.table("runs")
    assert runs.height == 24 and runs["evaluations"].to_list() == [1000] * 24
    page = result.report()
    assert page.is_file() and {"convergence", "final-costs"} <= set(result.figures)
    assert result.figures["convergence"]._repr_svg_().startswith("<svg")
    assert repr(result.figures["convergence"]) == "<driftless.Figure convergence>"
    assert all(question.endswith("?") for question, _ in result.findings)
    assert "<table" in result._repr_html_() or "dataframe" in result._repr_html_()
    # Every table is the file that the report has, number by number.
    for name in result.tables:
        file = pl.read_csv(page.parent / "tables" / f"{name}.csv", infer_schema_length=None)
        own = result.table(name)
        assert own.columns == file.columns
        for column in own.columns:
            if own[column].dtype == pl.Float64:
                theirs = file[column].cast(pl.Float64).fill_null(math.nan)
                assert np.array_equal(own[column].fill_null(math.nan).to_numpy(), theirs.to_numpy(), equal_nan=True), (name, column)
    with pytest.raises(KeyError, match="found no table 'nothing', expected one of summary"):
        result.table("nothing")
    with pytest.raises(KeyError, match="found no table 'nothing', expected one of"):
        result.caption("nothing")
    with pytest.raises(KeyError, match="found no figure 'nothing'"):
        result.figures["nothing"]


def test_seeds_determine_runs(tmp_path: Path) -> None:
    one = race(guess, tmp_path / "a", seeds=3, jobs=1)
    two = race(guess, tmp_path / "b", seeds=3, jobs=2)
    assert one.table("runs")["best f"].to_list() == two.table("runs")["best f"].to_list()
    rng = np.random.default_rng(2)
    x = np.concatenate([rng.uniform(-5, 5, (64, 3)) for _ in range(4)])[:200]
    assert one.table("runs")["best f"].to_list()[1] == min(float(row @ row) for row in x)


def test_stored_runs_are_not_done_again(tmp_path: Path) -> None:
    calls = tmp_path / "calls"
    calls.mkdir()

    def counted(oracle: driftless.Oracle, rng: Rng, *, step: float = 0.1) -> None:
        (calls / f"{time.monotonic_ns()}").touch()
        oracle(oracle.lower)

    def count() -> int:
        return len(list(calls.iterdir()))

    solver = driftless.optimiser("counted")(counted)
    race(solver, tmp_path, seeds=3)
    race(solver, tmp_path, seeds=3)
    assert count() == 3
    race(solver, tmp_path, seeds=5)
    assert count() == 5
    race(solver.replace(step=0.2), tmp_path, seeds=5)
    assert count() == 10
    race(solver, tmp_path, seeds=5, fresh=True)
    assert count() == 15
    race(solver.replace(version=2), tmp_path, seeds=2)
    assert count() == 17


def code_of(text: str, name: str = "f") -> str:
    """What tells a function of a text from others."""
    scope: dict[str, object] = {"__name__": "mine", "driftless": driftless, "np": np, "functools": functools}
    exec(compile(textwrap.dedent(text), "<mine>", "exec"), scope)
    found = scope[name]
    if not isinstance(found, driftless.Optimiser):
        found = driftless.Optimiser("f", found)  # type: ignore[arg-type]
    return str(found.identity()["code"])


@pytest.mark.parametrize(
    ("text", "edit"),
    [
        ("def f(o, r): return 1", ("1", "2")),
        ("def f(o, r, k=1): return k", ("k=1", "k=2")),
        ("STEP = 0.1\ndef f(o, r): return STEP", ("0.1", "0.2")),
        ("STEP = np.float32(1)\ndef f(o, r): return STEP", ("(1)", "(2)")),
        ("DATA = np.zeros(3000)\nDATA[1500] = 1\ndef f(o, r): return DATA", ("= 1", "= 2")),
        ("DATA = {'a': [1, 2]}\ndef f(o, r): return DATA", ("2]", "3]")),
        ("DATA = {1, 2, 3}\ndef f(o, r): return DATA", ("3}", "4}")),
        ("def g(): return 1\ndef f(o, r): return g()", ("1", "2")),
        ("def g(a): return 1\nh = functools.partial(g, 1)\ndef f(o, r): return h()", ("g, 1", "g, 2")),
        ("def g(a): return 1\nh = functools.partial(g, 1)\ndef f(o, r): return h()", ("return 1", "return 2")),
        ("class C:\n  x = 1\ndef f(o, r): return C().x", ("1", "2")),
        ("class B:\n  def g(self): return 1\nclass C(B): pass\ndef f(o, r): return C().g()", ("1", "2")),
        ("class C:\n  def __init__(self): self.x = 1\nc = C()\ndef f(o, r): return c.x", ("= 1", "= 2")),
        ("class C:\n  @property\n  def x(self): return 1\ndef f(o, r): return C().x", ("1", "2")),
        ("@driftless.problem(lower=0, upper=1, dimension=2)\ndef g(x): return 1\ndef f(o, r): return g(1)", ("1\ndef", "2\ndef")),
        ("def d(g):\n  @functools.wraps(g)\n  def h(*a): return 1\n  return h\n@d\ndef f(o, r): pass", ("1", "2")),
        ("def d(k):\n  def e(g):\n    def h(*a): return k\n    return h\n  return e\n@d(1)\ndef f(o, r): pass", ("d(1)", "d(2)")),
        ("def f(o, r): return np.sin(1)", ("sin", "cos")),
        ("g = np.sin\ndef f(o, r): return g(1)", ("sin", "cos")),
        ("def f(o, r): return o.real", ("real", "imag")),
        ("(base,) = driftless.functions('sphere', 2)\ndef f(o, r): return base(1)", ("sphere", "rastrigin")),
        ("base = driftless.Task(jerk_limit_deg_s3=60)\ndef f(o, r): return base", ("60", "70")),
        ("f = lambda o, r: [k for k in (1, 2)]", ("2", "3")),
    ],
)  # fmt: skip
def test_an_edited_function_is_another(text: str, edit: tuple[str, str]) -> None:
    assert code_of(text) == code_of(text)
    assert code_of(text) != code_of(text.replace(*edit))


def test_what_is_no_edit() -> None:
    text = "def g(x): return x\ndef f(o, r): return g(1) + 1"
    assert code_of(text) == code_of("# A remark.\n\n" + text.replace(" + 1", "  +  1  # more"))
    recursive = "def f(o, r): return f(o, r)"
    assert code_of(recursive) == code_of(recursive)


def test_settings_are_told_apart() -> None:
    def of(x: object) -> object:
        return guess.replace(size=x).identity()["setting size"]

    long, other = np.zeros(3000), np.zeros(3000)
    other[1500] = 1e-12
    values = [1, 1.5, "1", None, [1], (1,), {"a": 1}, long, other, np.zeros(3), (lambda: 1), (lambda: 2), np.sin, np.cos]
    assert len({str(type(of(x))) + str(of(x)) for x in values}) == len(values)
    assert all(of(x) == of(x) for x in values)
    assert of(np.int64(3)) == 3 and of(True) == 1


def test_two_settings_of_one_function(tmp_path: Path) -> None:
    result = driftless.run(
        problems=bowl, optimisers=[guess.replace(size=8), guess.replace(size=32), guess.replace(label="own")],
        seeds=2, budget=100, out=tmp_path, progress=False,
    )  # fmt: skip
    assert result.optimisers == ("guess size=8", "guess size=32", "own")
    with pytest.raises(TypeError, match="guess has no setting length"):
        guess.replace(length=3)
    with pytest.raises(TypeError, match="guess has no setting length"):
        guess.replace(settings={"size": 3}, length=3)

    @driftless.optimiser
    def needy(oracle: driftless.Oracle, rng: Rng, *, size: int) -> None:
        oracle(oracle.lower)

    with pytest.raises(TypeError, match="needy needs the setting size"):
        race(needy, tmp_path)
    assert race(needy.replace(size=3), tmp_path / "needy").stored == 1


def test_labels_tell_problems_apart(tmp_path: Path) -> None:
    tasks = {"weak": driftless.Task(jerk_limit_deg_s3=40), "strong": driftless.Task(jerk_limit_deg_s3=80)}
    result = driftless.run(problems=tasks, optimisers=guess, seeds=1, budget=100, out=tmp_path, progress=False)
    assert result.instances == ("weak", "strong")
    assert result.motion("weak").duration > 0
    with pytest.raises(ValueError, match="found two problems 'xiao2023', expected a mapping"):
        driftless.run(problems=list(tasks.values()), optimisers=guess, out=tmp_path)


def test_formulations_of_functions(tmp_path: Path) -> None:
    seen: set[int] = set()

    def look(oracle: driftless.Oracle, rng: Rng) -> None:
        seen.add(oracle.dimension)
        oracle(oracle.lower)

    entrants = [driftless.optimiser(name, formulation=name)(look) for name in ("time-free", "scaled", "raw")]
    result = driftless.run(problems=driftless.Task(), optimisers=entrants, seeds=1, budget=5, out=tmp_path, progress=False)
    assert seen == {12, 13} and result.optimisers == ("time-free/time-free", "scaled/scaled", "raw/raw")


def test_oracles_come_first(tmp_path: Path) -> None:
    def swapped(rng: Rng, oracle: driftless.Oracle) -> None: ...

    def other(random: Rng, oracle: driftless.Oracle) -> None: ...

    def once(rng: Rng) -> None: ...

    for function in (swapped, other, once):
        with pytest.raises(TypeError, match=rf"found {function.__name__}\(.*expected {function.__name__}\(oracle, rng\)"):
            driftless.optimiser(function)

    @driftless.optimiser
    def own_names(problem: driftless.Oracle, generator: Rng) -> None:
        problem(problem.lower)

    assert race(own_names, tmp_path).failed == 0


@pytest.mark.parametrize("evaluations", [0, 3])
def test_runs_that_find_nothing_have_failed(evaluations: int, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    def lost(oracle: driftless.Oracle, rng: Rng) -> None:
        for _ in range(evaluations):
            oracle.batch([oracle.upper + 1])

    with caplog.at_level(logging.INFO, "driftless"):
        result = race(lost, tmp_path)
    assert result.failed == 1 and result.table("summary")["failed"].to_list() == [1]
    warnings = [entry.getMessage() for entry in caplog.records if entry.levelno == logging.WARNING]
    assert len(warnings) == 1 and warnings[0].startswith("lost bowl seed 1: nothing found, finished: ")
    assert evaluations or warnings[0].endswith(": no evaluation had a finite cost")


# Tasks and problems of tasks

UR5 = Path(__file__).parents[2] / "tests" / "robots" / "ur5-turn.toml"


@pytest.mark.parametrize("problem", [driftless.Task(), driftless.Task().problem("time-free")], ids=["task", "problem"])
def test_one_task_is_that_of_the_command(problem: driftless.Task | driftless.Problem, command: list[str], tmp_path: Path) -> None:
    file = tmp_path / "python.toml"
    file.write_text('name = "python"\nseeds = 2\nbudget = { evaluations = 300 }\n[[optimiser]]\nde = {}\n[[optimiser]]\npso = {}\n')
    call(command, "run", file, "--out", tmp_path / "command", "--quiet")
    result = driftless.run(problems=[problem], optimisers=["de", "pso"], seeds=2, budget=300, out=tmp_path / "python", progress=False)
    result.report()
    assert tables(tmp_path / "python") == tables(tmp_path / "command")
    assert result.instances == ("",)
    for found in (result, driftless.open_results(result.path)):
        assert found.motion().cost == found.motion("xiao2023").cost


def test_tasks_have_the_targets_of_the_command(command: list[str], tmp_path: Path) -> None:
    """The best motion is known with the weight 0.9, and not with 0.85."""
    file = tmp_path / "weights.toml"
    file.write_text(
        'name = "weights"\nseeds = 2\nbudget = { evaluations = 300 }\n[sweep]\nweight_base = [0.9, 0.85]\n[[optimiser]]\nde = {}\n'
    )
    call(command, "run", file, "--out", tmp_path / "command", "--quiet")
    theirs = pl.read_csv(tmp_path / "command" / "tables" / "targets.csv")
    weights = {f"weight_base={weight}": driftless.Task(base_weight=weight) for weight in (0.9, 0.85)}
    problems = {label: task.problem() for label, task in weights.items()}
    for k, own in enumerate((weights, problems)):
        result = driftless.run(problems=own, optimisers="de", seeds=2, budget=300, out=tmp_path / f"{k}", progress=False)
        found = result.table("targets")
        assert found["source"].to_list() == theirs["source"].to_list() and "experiment.toml" in found["source"]
        assert found["cost"].to_list() == pytest.approx(theirs["cost"].to_list(), rel=1e-12)
        assert found["target"].to_list() == theirs["target"].to_list()
    # 10 %, 1 % and 0.1 % above the best known cost, to six digits.
    known = driftless.Task().problem().best_known
    assert known is not None
    assert found["cost"].to_list()[:3] == pytest.approx([1.1 * known, 1.01 * known, 1.001 * known], rel=1e-6)


def test_problems_of_a_file_are_those_of_the_command(command: list[str], tmp_path: Path) -> None:
    file = tmp_path / "shared.toml"
    file.write_text(EXPERIMENT.replace('name = "shared"', 'name = "shared"\n').replace("dimension = [4]", "dimension = [4]\ninstances = 2"))
    call(command, "run", file, "--out", tmp_path / "command", "--quiet")
    result = driftless.run(
        name="shared", problems=driftless.problems(file), optimisers=["cma-es", "de"], seeds=3, budget=400, out=tmp_path / "python", progress=False
    )
    result.report()
    assert tables(tmp_path / "python") == tables(tmp_path / "command")
    assert result.table("summary")["group"].unique(maintain_order=True).to_list() == ["sphere dimension=4", "ackley dimension=4"]


def test_motions_of_several_tasks(tmp_path: Path) -> None:
    tasks = {"paper": driftless.Task(), "ur5": driftless.Task.from_file(UR5)}
    result = driftless.run(
        problems={**tasks, "bowl": bowl}, optimisers="de", seeds=1, budget=300, out=tmp_path / "results", progress=False
    )
    again = driftless.open_results(result.path)
    for label, task in tasks.items():
        with pytest.raises(KeyError, match=rf'do not hold the task of \\?"{label}\\?": pass it, as in `motion'):
            again.motion(label)
        assert again.motion(label, task).coefficients.tolist() == result.motion(label).coefficients.tolist()
    with pytest.raises(driftless.InputError, match='found another task than that of "ur5"'):
        again.motion("ur5", tasks["paper"])
    for found in (result, again):
        with pytest.raises(KeyError, match='"bowl" is no task, and has no motion; tasks are "paper", "ur5"'):
            found.motion("bowl")
        with pytest.raises(KeyError, match='found no instance "xiao2023", expected one of "paper", "ur5", "bowl"'):
            found.motion("xiao2023")


def test_formulations_are_the_optimisers_to_choose(tmp_path: Path) -> None:
    with pytest.raises(driftless.InputError, match="found a problem in the formulation 'raw', which is an optimiser's to choose"):
        driftless.run(problems=driftless.Task().problem("raw"), optimisers="de", out=tmp_path)


# Results are shared with the command

EXPERIMENT = """
name = "shared"
seeds = 3
budget = { evaluations = 400 }

[functions]
name = ["sphere", "ackley"]
dimension = [4]

[[optimiser]]
cma-es = {}

[[optimiser]]
de = {}
"""


def tables(folder: Path) -> dict[str, bytes]:
    """All tables as they were written, but for how long runs took."""
    found = {file.name: file.read_bytes() for file in sorted((folder / "tables").iterdir())}
    assert len(found) > 30
    found["summary.csv"] = pl.read_csv(folder / "tables" / "summary.csv").drop("s/run").write_csv().encode()
    del found["summary.md"], found["summary.tex"]
    return found


def test_results_are_those_of_the_command(command: list[str], tmp_path: Path) -> None:
    file = tmp_path / "shared.toml"
    file.write_text(EXPERIMENT)
    call(command, "run", file, "--out", tmp_path / "command", "--quiet")
    driftless.run(file, out=tmp_path / "python", progress=False).report()
    assert tables(tmp_path / "python") == tables(tmp_path / "command")


def test_either_goes_on_from_the_others_results(command: list[str], tmp_path: Path) -> None:
    file = tmp_path / "shared.toml"
    file.write_text(EXPERIMENT)
    call(command, "run", file, "--out", tmp_path / "whole", "--quiet")
    # Python begins, the command ends.
    driftless.run(file, seeds=1, out=tmp_path / "a", progress=False)
    said = subprocess.run([*command, "run", str(file), "--out", str(tmp_path / "a")], capture_output=True, text=True, check=True)
    assert "4 of 12 runs are stored already" in said.stderr
    assert tables(tmp_path / "a") == tables(tmp_path / "whole")
    # The command begins, Python ends.
    call(command, "run", file, "--seeds", "2", "--out", tmp_path / "b", "--quiet")
    done = driftless.run(file, out=tmp_path / "b", progress=False)
    done.report(replace=True)
    assert tables(tmp_path / "b") == tables(tmp_path / "whole")


def test_a_task_that_python_made_is_the_commands_too(command: list[str], tmp_path: Path) -> None:
    task = driftless.Task(jerk_limit_deg_s3=70)
    result = driftless.run(problems=task, optimisers=["de", guess], seeds=2, budget=300, out=tmp_path / "r", progress=False)
    said = call(command, "report", result.path)
    assert "guess" in said and "de/time-free" in said
    kept = result.path / "experiment.toml"
    again = driftless.open_results(result.path)
    assert all(again.table(name).equals(result.table(name)) for name in result.tables)
    missing = subprocess.run(
        [*command, "run", str(kept), "--out", str(result.path), "--seeds", "3"], capture_output=True, text=True, check=False
    )
    assert missing.returncode == 1
    assert "`guess` belongs to the program that made these results" in missing.stderr
    # It has done the run that it could do.
    assert driftless.open_results(result.path).stored == 5


def test_two_experiments_in_one_interpreter_at_once(tmp_path: Path) -> None:
    found: dict[str, driftless.Result] = {}

    def work(name: str) -> None:
        found[name] = driftless.run(problems=bowl, optimisers=[guess, "cma-es"], seeds=4, budget=500, out=tmp_path / name, progress=False)

    both = [threading.Thread(target=work, args=(name,)) for name in ("a", "b")]
    for thread in both:
        thread.start()
    for thread in both:
        thread.join()
    assert found["a"].table("runs").equals(found["b"].table("runs"))


# Solvers that misbehave


def test_a_solver_that_swallows_the_end(tmp_path: Path) -> None:
    after: list[float] = []

    def swallow(oracle: driftless.Oracle, rng: Rng) -> None:
        while True:
            try:
                cost = oracle(rng.uniform(oracle.lower, oracle.upper))
                if oracle.remaining == 0:
                    after.append(cost)
            except:  # noqa: E722
                pass

    result = race(swallow, tmp_path)
    one = record(result)
    assert (one["status"], one["evaluations"]) == ("budget-spent", 200)
    assert one["message"] == "the solver went on after its search was over, and was left behind"
    # The last evaluation of the budget has its cost, those after it cost infinitely much.
    assert math.isfinite(after[0]) and len(after) > 500 and all(math.isinf(cost) for cost in after[1:])


def test_a_solver_that_ends_after_a_swallowed_end(tmp_path: Path) -> None:
    def careless(oracle: driftless.Oracle, rng: Rng) -> None:
        for _ in range(300):
            try:
                oracle(rng.uniform(oracle.lower, oracle.upper))
            except BaseException:
                pass

    one = record(race(careless, tmp_path))
    assert (one["status"], one["evaluations"], one["message"]) == ("budget-spent", 200, "")


def test_a_batch_is_cut_to_the_budget(tmp_path: Path) -> None:
    answers: list[object] = []

    def big(oracle: driftless.Oracle, rng: Rng) -> None:
        try:
            oracle.batch(rng.uniform(oracle.lower, oracle.upper, (1000, 3)))
        except driftless.BudgetSpent as spent:
            answers.append(str(spent))
            raise

    one = record(race(big, tmp_path))
    assert (one["status"], one["evaluations"]) == ("budget-spent", 200)
    assert answers == ["every evaluation of the budget is spent"]
    assert not issubclass(driftless.BudgetSpent, Exception)


def zero(oracle: driftless.Oracle, rng: Rng) -> None:
    oracle(oracle.lower)
    1 / 0


def leave(oracle: driftless.Oracle, rng: Rng) -> None:
    sys.exit(3)


def interrupt(oracle: driftless.Oracle, rng: Rng) -> None:
    raise KeyboardInterrupt


def text(oracle: driftless.Oracle, rng: Rng) -> None:
    oracle("nothing")  # type: ignore[arg-type]


def short(oracle: driftless.Oracle, rng: Rng) -> None:
    oracle([1.0])


def derive(oracle: driftless.Oracle, rng: Rng) -> None:
    oracle.subgradient(oracle.lower)


@pytest.mark.parametrize(
    ("solver", "message", "evaluations"),
    [
        (zero, r"ZeroDivisionError: division by zero \(test_races.py, line \d+\)", 1),
        (leave, r"SystemExit: 3 \(test_races.py, line \d+\)", 0),
        (interrupt, r"KeyboardInterrupt \(test_races.py, line \d+\)", 0),
        (text, r"TypeError: found a point of dtype <U7, expected real numbers \(test_races.py, line \d+\)", 0),
        (short, r"ValueError: found a point of shape \(1,\), expected \(3,\) \(test_races.py, line \d+\)", 0),
        (derive, r"NoDerivatives: the problem has no derivatives of this kind \(test_races.py, line \d+\)", 0),
    ],
)
def test_exceptions_are_told(solver: Callable[..., object], message: str, evaluations: int, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.INFO, "driftless"):
        result = race(solver, tmp_path)
    one = record(result)
    assert (one["status"], one["evaluations"]) == ("failed", evaluations)
    assert re.fullmatch(message, str(one["message"])), one["message"]
    assert result.failed == 1
    warnings = [entry for entry in caplog.records if entry.levelno == logging.WARNING]
    assert len(warnings) == 1 and solver.__name__ in warnings[0].getMessage()


def test_failed_runs_are_done_again_when_asked(tmp_path: Path) -> None:
    state = {"broken": True}

    def flaky(oracle: driftless.Oracle, rng: Rng) -> None:
        if state["broken"]:
            raise RuntimeError("not today")
        oracle(oracle.lower)

    solver = driftless.optimiser("flaky")(flaky)
    assert race(solver, tmp_path).failed == 1
    state["broken"] = False
    # The function is the same, and so are its runs.
    solver = driftless.Optimiser("flaky", flaky, version=7)
    race(solver, tmp_path)
    assert race(solver, tmp_path, retry=True).failed == 0


def test_an_oracle_that_is_kept(tmp_path: Path) -> None:
    kept: list[driftless.Oracle] = []

    def keep(oracle: driftless.Oracle, rng: Rng) -> None:
        kept.append(oracle)
        oracle(oracle.lower)

    one = record(race(keep, tmp_path))
    assert (one["status"], one["evaluations"]) == ("finished", 1)
    (oracle,) = kept
    for question in (lambda: oracle(oracle.lower), lambda: oracle.batch([oracle.lower]), lambda: oracle.remaining, lambda: oracle.best):
        for _ in range(3):
            with pytest.raises(driftless.RunEnded, match="the run of this oracle is over"):
                question()
    assert repr(oracle) == "<driftless.Oracle 3 variables, budget 200>"


def test_threads_share_an_oracle(tmp_path: Path) -> None:
    def threads(oracle: driftless.Oracle, rng: Rng) -> None:
        def work(seed: int) -> None:
            own = np.random.default_rng(seed)
            try:
                while True:
                    oracle(own.uniform(oracle.lower, oracle.upper))
                    oracle.batch(own.uniform(oracle.lower, oracle.upper, (3, 3)))
            except driftless.BudgetSpent:
                pass

        all_ = [threading.Thread(target=work, args=(seed,)) for seed in range(8)]
        for thread in all_:
            thread.start()
        for thread in all_:
            thread.join()

    for problem in (bowl, driftless.functions("sphere", dimension=3)[0]):
        one = record(race(threads, tmp_path / problem.name, problem=problem, budget=2000))
        assert (one["status"], one["evaluations"], one["message"]) == ("budget-spent", 2000, "")


def test_each_thread_learns_of_the_end(tmp_path: Path) -> None:
    def careless(oracle: driftless.Oracle, rng: Rng) -> None:
        def work() -> None:
            with contextlib.suppress(BaseException):
                while True:
                    oracle(oracle.lower)

        helper = threading.Thread(target=work)
        helper.start()
        helper.join()
        while True:
            oracle(oracle.lower)

    one = record(race(careless, tmp_path))
    assert (one["status"], one["evaluations"], one["message"]) == ("budget-spent", 200, "")


def test_a_thread_that_outlives_its_solver(tmp_path: Path) -> None:
    told: list[str] = []

    def leave_behind(oracle: driftless.Oracle, rng: Rng) -> None:
        def work() -> None:
            time.sleep(0.5)
            try:
                oracle(oracle.lower)
            except driftless.RunEnded as error:
                told.append(str(error))

        threading.Thread(target=work).start()

    assert record(race(leave_behind, tmp_path))["status"] == "finished"
    time.sleep(1)
    assert told == ["the run of this oracle is over"]


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_costs_that_are_no_numbers(value: float, tmp_path: Path) -> None:
    @driftless.problem(lower=-1, upper=1, dimension=2)
    def odd(x: np.ndarray) -> float:
        return value if x[0] < 0 else float(x[0])

    result = race(guess, tmp_path, problem=odd)
    one = record(result)
    assert (one["status"], one["evaluations"]) == ("budget-spent", 200)
    assert 0 <= result.table("runs")["best f"][0] < 1


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        ("nothing", r"the problem returned str, expected a number or \(cost, violation\)"),
        (None, r"the problem returned NoneType, expected a number or \(cost, violation\)"),
        ((1, 2, 3), r"the problem returned tuple, expected a number or \(cost, violation\)"),
        (np.zeros(2), r"the problem returned ndarray, expected a number or \(cost, violation\)"),
    ],
)
def test_answers_that_are_no_costs(answer: object, message: str, tmp_path: Path) -> None:
    wrong = driftless.problem(lower=-1, upper=1, dimension=2, name="wrong")(lambda x: answer)
    one = record(race(guess, tmp_path, problem=wrong))
    assert one["status"] == "failed"
    assert re.fullmatch(message, str(one["message"])), one["message"]


def test_problems_that_raise(tmp_path: Path) -> None:
    @driftless.problem(lower=-1, upper=1, dimension=2)
    def broken(x: np.ndarray) -> float:
        raise ValueError("too far")

    result = driftless.run(problems=broken, optimisers=[guess, "de", "cma-es"], seeds=1, budget=50, out=tmp_path, progress=False)
    assert result.failed == 3
    for message in records(result)["message"]:
        assert message.startswith("ValueError: too far (test_races.py, line ")


def test_costs_and_violations_in_batches(tmp_path: Path) -> None:
    shapes: list[tuple[int, ...]] = []

    @driftless.problem(lower=[-1, -2], upper=[1, 2], batched=True)
    def many(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        shapes.append(x.shape)
        return (x**2).sum(axis=1), np.maximum(0, 0.5 - x[:, 0])

    one = record(race(guess, tmp_path, problem=many))
    assert (one["status"], one["evaluations"]) == ("budget-spent", 200)
    # The first question is what the middle of the box costs, for targets.
    assert shapes == [(1, 2), *[(64, 2)] * 3, (8, 2)]
    wrong = driftless.problem(lower=-1, upper=1, dimension=2, batched=True, name="wrong")(lambda x: np.zeros(3))
    message = str(record(race(guess, tmp_path / "w", problem=wrong))["message"])
    assert message == "the problem returned no costs: found a point of shape (3,), expected (64,)"


def test_what_is_no_box() -> None:
    for keywords, message in [
        ({"lower": 0, "upper": 1}, "expected arrays or a dimension"),
        ({"lower": [0, 1], "upper": [1, 2, 3]}, "shape mismatch"),
        ({"lower": np.zeros((2, 2)), "upper": 1}, r"found bounds of shape \(2, 2\), expected \(n,\)"),
    ]:
        with pytest.raises(ValueError, match=message):
            driftless.problem(**keywords)  # type: ignore[arg-type]
    reversed_ = driftless.problem(lower=[0, 2], upper=[1, 1])(lambda x: 0.0)
    with pytest.raises(driftless.InputError, match=r"found bounds 2 and 1 of x\[1\], expected the lower bound first"):
        driftless.run(problems=reversed_, optimisers=guess)


def test_points_outside_the_box_are_remarked(tmp_path: Path) -> None:
    def outside(oracle: driftless.Oracle, rng: Rng) -> None:
        assert math.isinf(oracle(oracle.upper + 1))
        assert np.isinf(oracle.batch([oracle.upper, oracle.lower - 1])).tolist() == [False, True]
        assert oracle.evaluations == 3 and oracle.best is not None

    one = record(race(outside, tmp_path))
    assert (one["status"], one["evaluations"]) == ("finished", 3)
    assert one["message"] == "2 points outside the box cost infinitely much"


def test_what_an_oracle_says(tmp_path: Path) -> None:
    def look(oracle: driftless.Oracle, rng: Rng) -> None:
        assert (oracle.dimension, oracle.budget, oracle.remaining, oracle.evaluations) == (3, 200, 200, 0)
        assert oracle.lower.tolist() == [-5] * 3 and oracle.best is None
        assert not oracle.has_subgradient and not oracle.has_linearise
        assert oracle.evaluate([1, 1, 1]) == (3.0, 0.0)
        costs, violations = oracle.evaluate_batch(np.eye(3))
        assert costs.tolist() == [1, 1, 1] and violations.tolist() == [0, 0, 0]
        assert oracle.batch(np.zeros((0, 3))).shape == (0,)
        assert oracle.best is not None and oracle.best[0].tolist() == [1, 0, 0] and oracle.best[1] == 1

    one = record(race(look, tmp_path))
    assert (one["status"], one["message"], one["evaluations"]) == ("finished", "", 4)


def test_derivatives_through_an_oracle(tmp_path: Path) -> None:
    problem = driftless.Task().problem()

    def slopes(oracle: driftless.Oracle, rng: Rng) -> None:
        x = oracle.upper / 3
        cost, slopes = oracle.subgradient(x)
        assert (cost, slopes.tolist()) == (problem.subgradient(x)[0], problem.subgradient(x)[1].tolist())
        assert oracle.linearise(x).cost == problem.linearise(x).cost
        assert oracle.evaluations == 2

    one = record(race(slopes, tmp_path, problem=problem))
    assert (one["status"], one["message"]) == ("finished", "")


# Interruptions, processes


INTERRUPTED = """
import os, signal, threading, time, driftless

@driftless.problem(lower=-1, upper=1, dimension=2)
def slow(x):
    time.sleep(0.002)
    return float(x @ x)

@driftless.optimiser
def guess(oracle, rng):
    {solver}

threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    driftless.run(problems=slow, optimisers={optimisers}, seeds=50, budget=100, out={out!r}, jobs=2, progress=False)
except KeyboardInterrupt:
    print("interrupted", driftless.open_results({out!r}).stored)
"""

POLITE = "while True: oracle(rng.uniform(oracle.lower, oracle.upper))"


@pytest.mark.parametrize(("solver", "optimisers"), [(POLITE, "guess"), (POLITE, "'de'")])
def test_ctrl_c_ends_an_experiment(solver: str, optimisers: str, tmp_path: Path) -> None:
    out = str(tmp_path / "results")
    done = child(INTERRUPTED.format(solver=solver, optimisers=optimisers, out=out))
    assert done.stdout.startswith("interrupted "), done.stderr
    stored = int(done.stdout.split()[1])
    assert 0 < stored < 50
    result = driftless.open_results(out)
    assert result.failed == 0 and records(result)["evaluations"].to_list() == [100] * stored


def test_ctrl_c_ends_a_solver_that_asks_nothing(tmp_path: Path) -> None:
    out = str(tmp_path / "results")
    done = child(INTERRUPTED.format(solver="while True: time.sleep(0.01)", optimisers="guess", out=out))
    assert done.stdout == "interrupted 0\n", done.stderr


def test_ctrl_c_ends_a_plan() -> None:
    done = child(
        "import os, signal, threading, driftless\n"
        "threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "motion = driftless.plan(family='spline', pieces=400, budget=10**7, progress=False)\n"
        "print(motion.interrupted)\n"
    )
    assert "KeyboardInterrupt" in done.stderr


def test_an_interpreter_ends_with_a_solver_left_behind(tmp_path: Path) -> None:
    done = child(
        "import driftless\n"
        "@driftless.optimiser\n"
        "def swallow(oracle, rng):\n"
        "    while True:\n"
        "        try: oracle(oracle.lower)\n"
        "        except BaseException: pass\n"
        "problem = driftless.problem(lower=0, upper=1, dimension=2)(lambda x: 1.0)\n"
        f"result = driftless.run(problems=problem, optimisers=swallow, seeds=3, budget=20, out={str(tmp_path)!r}, progress=False)\n"
        "print(result.stored)\n"
    )
    assert (done.returncode, done.stdout) == (0, "3\n"), done.stderr


SOLVERS = """
import numpy as np
import driftless

@driftless.optimiser
def guess(oracle, rng, *, size=16):
    print("begun with", size)
    while True:
        oracle.batch(rng.uniform(oracle.lower, oracle.upper, (size, oracle.dimension)))

@driftless.optimiser
def crash(oracle, rng):
    oracle(oracle.lower)
    import os
    os.abort()

@driftless.optimiser
def fail(oracle, rng):
    oracle(oracle.lower)
    raise ValueError("not mine")

@driftless.optimiser
def slopes(oracle, rng, *, nothing=None):
    assert oracle.has_subgradient and oracle.has_linearise and nothing is None
    found = oracle.linearise(oracle.upper / 3)
    assert found.cost == sum(
        term.weight * {"norm": np.linalg.norm, "max": np.max}[term.shape](term.values) for term in found.terms
    ) and all(term.gradients.shape == (len(term.values), oracle.dimension) for term in found.terms)
    for wrong in (["1"] * oracle.dimension, np.zeros(oracle.dimension, complex)):
        try:
            oracle(wrong)
        except TypeError:
            continue
        raise AssertionError("no error")
    while True:
        cost, found = oracle.subgradient(rng.uniform(oracle.lower, oracle.upper))
        assert found.shape == (oracle.dimension,)
"""


def test_functions_run_in_processes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "solvers_of_a_test.py").write_text(SOLVERS)
    monkeypatch.syspath_prepend(tmp_path)
    import solvers_of_a_test as solvers  # type: ignore[import-not-found]

    entrants = [solvers.guess, solvers.guess.replace(size=4), solvers.crash, solvers.fail, solvers.slopes]
    problems = driftless.functions("sphere", dimension=3)
    here = driftless.run(problems=problems, optimisers=entrants[:2], seeds=2, budget=100, out=tmp_path / "here", progress=False)
    there = driftless.run(
        problems=driftless.Task(), optimisers=entrants, isolation="process", seeds=2, budget=100, out=tmp_path / "task", progress=False
    )
    outcomes = {(row["optimiser"], row["status"]) for row in records(there).to_dicts()}
    assert {status for name, status in outcomes if name == "guess"} == {"budget-spent"}
    messages = records(there).filter(pl.col("status") == "failed")["message"].to_list()
    assert len(messages) == 4 and sum("not mine" in message for message in messages) == 2
    same = driftless.run(
        problems=problems, optimisers=entrants[:2], isolation="process", seeds=2, budget=100, out=tmp_path / "there", progress=False
    )
    # Another version is another optimiser; slopes and terms are there as in a thread.
    versions = driftless.run(
        problems=problems, optimisers=[solvers.guess, solvers.guess.replace(version=2, label="two")], isolation="process",
        seeds=1, budget=20, out=tmp_path / "versions", progress=False,
    )  # fmt: skip
    assert versions.stored == 2
    # One function searches alike in either place.
    assert same.table("runs")["best f"].to_list() == here.table("runs")["best f"].to_list()
    with pytest.raises(ValueError, match="expected a function at the top level of a file"):
        race(lambda oracle, rng: None, tmp_path / "lambda", isolation="process")


def test_programs_of_results_are_not_started_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "more_solvers_of_a_test.py").write_text(SOLVERS)
    monkeypatch.syspath_prepend(tmp_path)
    import more_solvers_of_a_test as solvers  # type: ignore[import-not-found]

    result = race(solvers.guess, tmp_path, problem=driftless.functions("sphere", dimension=3)[0], isolation="process")
    kept = result.path / "experiment.toml"
    with pytest.raises(driftless.InputError, match="which may come from anybody, starts .*pass trust=True"):
        driftless.run(kept, out=result.path, seeds=1, progress=False)


def test_a_problem_cannot_ask_its_own_oracle(tmp_path: Path) -> None:
    kept: list[driftless.Oracle] = []
    told: list[str] = []

    class Watcher:
        def __del__(self) -> None:
            try:
                kept[0].evaluations  # noqa: B018
            except driftless.SearchError as error:
                told.append(str(error))

    @driftless.problem(lower=0, upper=1, dimension=2)
    def asks(x: np.ndarray) -> float:
        if kept:
            Watcher()
            for question in (lambda: kept[0].remaining, lambda: kept[0].best, lambda: kept[0](x), lambda: kept[0].batch([x])):
                with pytest.raises(driftless.SearchError, match="a problem cannot ask the oracle that asks it"):
                    question()
        return float(x @ x)

    def solver(oracle: driftless.Oracle, rng: Rng) -> None:
        kept.append(oracle)
        while True:
            oracle(rng.random(2))

    one = record(race(solver, tmp_path, problem=asks, budget=20))
    assert (one["status"], one["evaluations"], len(told)) == ("budget-spent", 20, 20), one["message"]


def test_functions_that_only_promise_to_search(tmp_path: Path) -> None:
    def generator(oracle: driftless.Oracle, rng: Rng) -> Iterator[float]:
        yield oracle(oracle.lower)

    async def coroutine(oracle: driftless.Oracle, rng: Rng) -> None:
        oracle(oracle.lower)

    for solver in (generator, coroutine):
        message = str(record(race(solver, tmp_path / solver.__name__))["message"])
        assert message.startswith(f"TypeError: the optimiser returned a {solver.__name__}, expected")


def test_results_that_are_gone(tmp_path: Path) -> None:
    result = race(guess, tmp_path)
    result.path.rename(tmp_path / "elsewhere")
    for look in (lambda: result.stored, lambda: result.table("summary"), result.report, lambda: result.motion("x")):
        with pytest.raises(driftless.ResultsError, match="the results in .* are gone: found no experiment.toml there"):
            look()
    assert not result.path.exists()
    assert driftless.open_results(tmp_path / "elsewhere").stored == 1


def test_figures_are_of_the_result_itself(tmp_path: Path) -> None:
    race(guess, tmp_path, seeds=3).report()
    fewer = race(guess, tmp_path, seeds=2)
    with pytest.raises(driftless.ResultsError, match=r"shows 3 runs, more than are stored.*`report\(replace=True\)` replaces it"):
        fewer.figures  # noqa: B018
    fewer.report(replace=True)
    assert "final-costs" in fewer.figures
    other = race(guess, tmp_path, seeds=1)
    other.report(tmp_path / "elsewhere")
    assert other.figures["final-costs"].svg.parent == tmp_path / "elsewhere" / "figures"


def test_showing_a_result_writes_nothing(tmp_path: Path) -> None:
    result = driftless.open_results(race(guess, tmp_path).path)
    before = sorted(result.path.rglob("*"))
    assert "dataframe" in result._repr_html_() and result.table("summary").height == 1
    assert sorted(result.path.rglob("*")) == before


def test_damage_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    result = race(guess, tmp_path)
    (file,) = (result.path / "runs").glob("*.parquet")
    file.write_bytes(file.read_bytes()[:-100])
    again = driftless.open_results(result.path)
    assert again.table("runs").height == 0
    assert str(file) in caplog.text and "its runs are left out" in caplog.text


def test_what_goes_to_other_processes() -> None:
    for entrant in (guess, guess.replace(size=3, label="three")):
        same = pickle.loads(pickle.dumps(entrant))
        assert (repr(same), same.identity(), same.label) == (repr(entrant), entrant.identity(), entrant.label)
    same = pickle.loads(pickle.dumps(bowl))
    assert same.identity() == bowl.identity() and same(np.ones(3)) == 3
    with pytest.raises(ValueError, match="is not at the top level of a module under its own name"):
        pickle.dumps(driftless.optimiser("local")(lambda oracle, rng: None))
    assert guess == guess and len({guess, guess.replace(size=3)}) == 2 and bowl == bowl


def test_what_is_no_entrant(tmp_path: Path) -> None:
    def plain(oracle: driftless.Oracle, rng: Rng) -> None: ...

    for optimisers in (plain, [plain], None, [3]):
        with pytest.raises(TypeError, match="expected a name or an optimiser: decorate functions with `driftless.optimiser`"):
            driftless.run(problems=bowl, optimisers=optimisers)  # type: ignore[arg-type]
    for problems in (plain, [plain], {"a": 3}):
        with pytest.raises(TypeError, match="expected a task or a problem: decorate functions with `driftless.problem`"):
            driftless.run(problems=problems, optimisers=guess)  # type: ignore[arg-type]
    for problems in ("my.toml", [Path("my.toml")], {"a": "my.toml"}):
        with pytest.raises(TypeError, match="found 'my.toml', expected a task or a problem: `Task.from_file` reads a task"):
            driftless.run(problems=problems, optimisers=guess)  # type: ignore[arg-type]
    for what, number in (("seeds", [1, 2]), ("budget", 2e3), ("jobs", "two")):
        with pytest.raises(TypeError, match=re.escape(f"found {what} = {number!r}, expected a whole number")):
            driftless.run(problems=bowl, optimisers=guess, **{what: number})  # type: ignore[arg-type]
    for keywords in ({"seeds": -1}, {"budget": 0}, {"jobs": -1}, {"seeds": 10**7}):
        with pytest.raises(ValueError, match=r"found \w+ = -?\d+, expected 1 to"):
            driftless.run(problems=bowl, optimisers=guess, **keywords)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="found an empty path"):
        driftless.run(problems=bowl, optimisers=guess, out="")
    with pytest.raises(ValueError, match='found isolation \'space\', expected "thread" or "process"'):
        driftless.run(problems=bowl, optimisers="de", isolation="space")
    with pytest.raises(ValueError, match="found a least cost or a target that is infinite or NaN"):
        driftless.problem(lower=0, upper=1, dimension=2, least_cost=math.nan)(lambda x: 0.0)


def test_a_label_of_one_task(tmp_path: Path) -> None:
    result = driftless.run(problems={"weak": driftless.Task()}, optimisers=guess, seeds=1, budget=20, out=tmp_path, progress=False)
    assert result.instances == ("weak",) and result.motion("weak").duration > 0


UNGUARDED = """
import driftless

@driftless.optimiser
def guess(oracle, rng):
    while True:
        oracle(rng.uniform(oracle.lower, oracle.upper))

result = driftless.run(
    problems=driftless.functions("sphere", dimension=2), optimisers=guess, isolation="process",
    seeds=1, budget=20, out={out!r}, progress=False,
)
print(result.failed)
"""


def test_a_script_without_a_guard_is_refused(tmp_path: Path) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(UNGUARDED.format(out=str(tmp_path / "results")))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    assert done.stdout == "1\n", done.stderr
    message = str(record(driftless.open_results(tmp_path / "results"))["message"])
    assert 'write `if __name__ == "__main__":` in front' in message
    guarded = script.read_text().replace("result = driftless", 'if __name__ == "__main__":\n  result = driftless').replace("print(", "  print(")
    script.write_text(guarded.replace("/results", "/guarded"))
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120)
    assert done.stdout == "0\n", done.stderr


@pytest.mark.parametrize("optimiser", ["guess", "'de'", "busy"])
def test_python_ends_in_the_midst_of_a_run(optimiser: str, tmp_path: Path) -> None:
    """In a thread that Python does not wait for, and with a solver that never ends."""
    done = child(
        "import driftless, threading, time\n"
        "@driftless.optimiser\n"
        "def guess(oracle, rng):\n"
        "    while True: oracle(rng.uniform(oracle.lower, oracle.upper))\n"
        "@driftless.optimiser\n"
        "def busy(oracle, rng):\n"
        "    while True: pass\n"
        "@driftless.problem(lower=0, upper=1, dimension=2)\n"
        "def slow(x):\n"
        "    time.sleep(0.001)\n"
        "    return float(x @ x)\n"
        f"work = lambda: driftless.run(problems=slow, optimisers={optimiser}, seeds=100, budget=10**6, out={str(tmp_path)!r}, progress=False)\n"
        "threading.Thread(target=work, daemon=True).start()\n"
        "time.sleep(1)\n"
        "print('end')\n"
    )
    assert (done.returncode, done.stdout) == (0, "end\n"), done.stderr


def test_ctrl_c_within_a_large_batch(tmp_path: Path) -> None:
    began = time.monotonic()
    done = child(
        "import os, signal, threading, time, driftless\n"
        "@driftless.problem(lower=0, upper=1, dimension=2)\n"
        "def slow(x):\n"
        "    time.sleep(0.001)\n"
        "    return float(x @ x)\n"
        "@driftless.optimiser\n"
        "def big(oracle, rng): oracle.batch(rng.random((10**6, 2)))\n"
        "threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        f"driftless.run(problems=slow, optimisers=big, seeds=1, budget=10**6, out={str(tmp_path)!r}, progress=False)\n"
    )
    assert "KeyboardInterrupt" in done.stderr and time.monotonic() - began < 60


def test_the_command_of_the_package(tmp_path: Path) -> None:
    done = subprocess.run([sys.executable, "-m", "driftless", "plan", "--json", "--budget", "50"], capture_output=True, text=True)
    assert done.returncode == 0 and '"evaluations": 50' in done.stdout
    done = subprocess.run([sys.executable, "-m", "driftless", "plan", "none.toml"], capture_output=True, text=True)
    assert done.returncode == 2 and "cannot read none.toml" in done.stderr
    running = subprocess.Popen(
        [sys.executable, "-m", "driftless", "run", "--seeds", "500", "--out", str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    time.sleep(3)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=60)
    assert running.returncode == 1 and "interrupted" in said and "Traceback" not in said


def test_processes_that_fork_have_no_oracle(tmp_path: Path) -> None:
    def forks(oracle: driftless.Oracle, rng: Rng) -> None:
        read, write = os.pipe()
        child_ = os.fork()
        if child_ == 0:
            try:
                oracle(oracle.lower)
            except BaseException as error:
                os.write(write, repr(error).encode())
            os._exit(0)
        os.close(write)
        os.waitpid(child_, 0)
        raise RuntimeError(os.read(read, 1000).decode())

    with pytest.warns() if sys.version_info >= (3, 12) else _nothing():
        one = record(race(forks, tmp_path))
    assert "this oracle belongs to a run of another process" in str(one["message"])


class _nothing:
    def __enter__(self) -> None: ...
    def __exit__(self, *_: object) -> None: ...


def test_experiments_that_cannot_be_run(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected something to minimise"):
        driftless.run(optimisers=guess)
    with pytest.raises(driftless.InputError, match="cannot be read: No such file"):
        driftless.run(tmp_path / "none.toml")
    with pytest.raises(driftless.InputError, match="optimiser"):
        driftless.run(problems=bowl, out=tmp_path)
    for optimiser, message in [
        ("cma", 'found no optimiser "cma", expected one of cma-es, .*; did you mean "cma-es"'),
        (driftless.builtin("de", population=-3), "de: population: found -3, expected a whole number"),
        (driftless.builtin("de", label="mine", populatoin=30), "mine: populatoin: unknown field `populatoin`, .*did you mean `population`"),
    ]:
        with pytest.raises(driftless.InputError, match=f"^{message}") as caught:
            driftless.run(problems=bowl, optimisers=["random", optimiser], out=tmp_path)
        assert (caught.value.file, caught.value.line) == ("", None)
    # Nothing of the optimiser stands in the file.
    file = tmp_path / "bowls.toml"
    file.write_text('name = "bowls"\n[functions]\nname = ["sphere"]\n[[optimiser]]\nde = {}\n')
    with pytest.raises(driftless.InputError, match="`scp` needs derivatives") as caught:
        driftless.run(file, optimisers="scp", out=tmp_path)
    assert caught.value.line is None
    with pytest.raises(ValueError, match="found seeds = 0, expected 1 to 1000000"):
        race(guess, tmp_path, seeds=0)
    for jobs in (0, 1025):
        with pytest.raises(ValueError, match=f"found jobs = {jobs}, expected 1 to 1024"):
            race(guess, tmp_path, jobs=jobs)
    with pytest.raises(driftless.InputError, match='^name: found name "a b", expected letters'):
        driftless.run(name="a b", problems=driftless.Task(), optimisers="de", out=tmp_path)
    with pytest.raises(driftless.ResultsError, match="found no experiment.toml in"):
        driftless.open_results(tmp_path / "none")


def test_files_of_experiments_need_no_optimisers(tmp_path: Path) -> None:
    file = tmp_path / "bare.toml"
    file.write_text('name = "bare"\nseeds = 2\nbudget = { evaluations = 50 }\n[functions]\nname = ["sphere"]\ndimension = [2]\n')
    result = driftless.run(file, optimisers=guess, out=tmp_path / "r", progress=False)
    assert result.optimisers == ("guess",) and result.stored == 2


def test_signals_are_as_before(tmp_path: Path) -> None:
    before = signal.getsignal(signal.SIGINT)
    race(guess, tmp_path)
    assert signal.getsignal(signal.SIGINT) is before
