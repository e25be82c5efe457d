"""Tasks and motions, and that they are the command's."""

from __future__ import annotations

import json
import multiprocessing
import pickle
import subprocess
from pathlib import Path

import numpy as np
import polars as pl
import pytest

import driftless

from processes import call, call_json

ROBOTS = Path(__file__).parents[2] / "tests" / "robots"


@pytest.mark.parametrize(
    ("arguments", "keywords"),
    [
        ((), {}),
        (("--seed", "3", "--family", "sine-polynomial"), {"seed": 3, "family": "sine-polynomial"}),
        (("--optimiser", "cma-es", "--budget", "3000"), {"optimiser": "cma-es", "budget": 3000}),
        (("--pieces", "20", "--degree", "5"), {"pieces": 20, "degree": 5}),
    ],
)
def test_a_plan_is_the_commands(command: list[str], arguments: tuple[str, ...], keywords: dict[str, object]) -> None:
    told = call_json(command, "plan", "--json", *arguments)
    found = driftless.plan(**keywords, progress=False).as_dict()  # type: ignore[arg-type]
    for key in ("seconds", "task"):
        del told[key], found[key]
    assert found == told


def test_files_of_a_motion_are_the_commands(command: list[str], tmp_path: Path) -> None:
    motion = driftless.plan(progress=False)
    for kind in ("csv", "wide.csv", "parquet", "mat", "yaml", "goal.yaml"):
        own, theirs = tmp_path / f"own.{kind}", tmp_path / f"theirs.{kind}"
        motion.save(own)
        call(command, "plan", "--motion", theirs)
        assert own.read_bytes() == theirs.read_bytes(), kind
    assert motion.to_polars().equals(pl.read_csv(tmp_path / "own.csv"))
    assert motion.to_polars().equals(pl.read_parquet(tmp_path / "own.parquet"))


@pytest.mark.parametrize("file", [None, "ur5-turn", "iiwa-turn"])
@pytest.mark.parametrize("formulation", ["time-free", "scaled", "raw"])
def test_costs_and_slopes_are_those_of_the_command(command: list[str], file: str | None, formulation: str) -> None:
    path = None if file is None else ROBOTS / f"{file}.toml"
    task = driftless.Task() if path is None else driftless.Task.from_file(path)
    problem = task.problem(formulation)
    arguments = [] if path is None else [str(path)]
    server = subprocess.Popen(
        [*command, "serve", *arguments, "--formulation", formulation], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    assert server.stdin is not None and server.stdout is not None

    def ask(question: dict[str, object]) -> dict[str, object]:
        assert server.stdin is not None and server.stdout is not None
        server.stdin.write(json.dumps(question) + "\n")
        server.stdin.flush()
        return dict(json.loads(server.stdout.readline()))

    with server:
        box = json.loads(server.stdout.readline())["problem"]
        assert (problem.lower.tolist(), problem.upper.tolist()) == (box["lower"], box["upper"])
        x = np.random.default_rng(5).uniform(problem.lower, problem.upper, (20, problem.dimension))
        server.stdin.write('{"hello": {}}\n')
        told = ask({"x": x.tolist()})
        costs, violations = problem.evaluate_batch(x)
        assert (costs.tolist(), violations.tolist()) == (told["cost"], told["violation"])
        for row in x[:5]:
            told = ask({"subgradient": row.tolist()})
            cost, slopes = problem.subgradient(row)
            assert (cost, slopes.tolist()) == (told["cost"], told["subgradient"])
        server.stdin.write('{"done": true}\n')
        server.stdin.close()
        server.stdout.read()


def test_tasks_of_files(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    path.write_text("[task.limits]\njerk_deg_s3 = 60\n")
    task = driftless.Task.from_file(path)
    assert np.degrees(task.limits[:, 2]) == pytest.approx(60)
    same = driftless.Task.from_toml(path.read_text(), path)
    assert same == task and hash(same) == hash(task)
    assert task.problem().lower.tolist() == driftless.Task(jerk_limit_deg_s3=60).problem().lower.tolist()
    again = driftless.Task.from_toml(task.to_toml())
    x = task.problem().lower / 3
    assert again.problem()(x) == task.problem()(x)


def test_every_keyword_is_in_the_task() -> None:
    task = driftless.Task(
        start_joints_deg=[0, 10, 20, 30, 40, 50],
        goal_joints_deg=np.array([5.0, 15, 25, 35, 45, 55]),
        start_base_zyx_deg=(1, 2, 3),
        goal_base_zyx_deg=(4, 5, 6),
        tolerance_deg=0.01,
        rate_limit_deg_s=50,
        acceleration_limit_deg_s2=[60, 61, 62, 63, 64, 65],
        jerk_limit_deg_s3=70,
        base_weight=0.8,
        terms=3,
    )
    text = task.to_toml()
    for part in ("[0.0, 10.0, 20.0", "[5.0, 15.0", "[1.0, 2.0, 3.0]", "[4.0, 5.0, 6.0]", "tolerance_deg = 0.01", "base = 0.8"):
        assert part in text, part
    assert np.degrees(task.limits) == pytest.approx(np.array([[50, a, 70] for a in range(60, 66)]))
    assert task.problem().dimension == 18
    spline = driftless.Task(family="spline", pieces=10, degree=5)
    assert spline.formulations == ("time-free", "scaled")


@pytest.mark.parametrize(
    ("keywords", "message", "hint"),
    [
        ({"jerk_limit_deg_s3": -1}, "found -1, expected a finite number above zero", None),
        ({"robot": "xiao2032"}, "no robot `xiao2032`", "did you mean `xiao2023`?"),
        ({"start_joints_deg": [1, 2]}, "found 2 values, expected 6", None),
        ({"base_weight": 2}, "expected", None),
        ({"terms": 99}, "found 99, expected 1 to 16 terms", None),
    ],
)
def test_mistakes_name_their_keyword(keywords: dict[str, object], message: str, hint: str | None) -> None:
    with pytest.raises(driftless.InputError) as caught:
        driftless.Task(**keywords)  # type: ignore[arg-type]
    (name,) = keywords
    assert str(caught.value).startswith(f"{name}: ") and message in caught.value.message
    assert caught.value.hint == hint
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, driftless.Error)


def test_what_another_robot_needs_is_told_by_keyword() -> None:
    with pytest.raises(driftless.InputError) as caught:
        driftless.Task(robot=ROBOTS.parents[1] / "experiments" / "robots" / "iiwa.toml", base_weight=0.8)
    told = str(caught.value)
    assert told.startswith("robot: the task does not state `start_joints_deg`, `start_base_zyx_deg`, `goal_joints_deg`")
    assert "`jerk_limit_deg_s3`" in told and "limits." not in told


def test_a_robot_is_no_task() -> None:
    with pytest.raises(driftless.InputError, match="found the file of a robot, expected that of a task") as caught:
        driftless.plan(ROBOTS.parents[1] / "experiments" / "robots" / "iiwa.toml", progress=False)
    assert caught.value.hint == "a task names its robot's file as `robot` in `[task]`"


def test_a_mistake_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    path.write_text('[task]\nrobot = "xiao2023"\n\n[task.limits]\njerk_deg = 60\n')
    with pytest.raises(driftless.InputError) as caught:
        driftless.Task.from_file(path)
    error = caught.value
    assert (error.file, error.line, error.column) == (str(path), 5, 1)
    assert str(error).startswith(f"{path}:5:1: unknown field `jerk_deg`")
    assert error.hint == "did you mean `jerk_deg_s3`?"
    same = pickle.loads(pickle.dumps(error))
    assert (str(same), same.line) == (str(error), error.line)
    with pytest.raises(driftless.InputError, match="cannot be read: No such file"):
        driftless.Task.from_file(tmp_path / "none.toml")


def test_samples() -> None:
    motion = driftless.plan(family="sine-polynomial", optimiser="nelder-mead", budget=500, progress=False)
    samples = motion.sample(dt=0.01)
    n = len(samples)
    assert samples.time[0] == 0 and samples.time[-1] == motion.duration
    assert samples.time[:-1] == pytest.approx(0.01 * np.arange(n - 1)) and 0.001 <= samples.time[-1] - samples.time[-2] < 0.011
    assert samples.torque.shape == (n, 6) and samples.base_position.shape == samples.base_rate.shape == (n, 3)
    assert samples.angle.shape == samples.jerk.shape == (n, 6)
    assert samples.base.shape == (n, 4) and samples.base_zyx.shape == (n, 3)
    # Rates are slopes of angles.
    assert np.gradient(samples.angle, samples.time, axis=0)[1:-1] == pytest.approx(samples.rate[1:-1], abs=1e-3)
    assert np.linalg.norm(samples.base, axis=1) == pytest.approx(1)
    for order, name in enumerate(("rate_deg_s", "acceleration_deg_s2", "jerk_deg_s3")):
        values = (samples.rate, samples.acceleration, samples.jerk)[order]
        assert np.degrees(np.abs(values)).max(axis=0) == pytest.approx(motion.peaks[name], rel=1e-3)
    for dt in (0, -1, float("nan"), 1e-9):
        with pytest.raises(ValueError, match="found dt = .* s, expected a time above zero"):
            motion.sample(dt)


def test_formats_that_there_are_not(tmp_path: Path) -> None:
    motion = driftless.plan(optimiser="nelder-mead", budget=100, progress=False)
    with pytest.raises(ValueError, match=r"expected a name in \.csv, \.wide\.csv, \.parquet, .* or \.mujoco"):
        motion.save(tmp_path / "motion.xlsx")
    with pytest.raises(driftless.ResultsError, match="cannot"):
        motion.save(tmp_path / "none" / "motion.csv")


def test_motions_are_drawn(tmp_path: Path) -> None:
    motion = driftless.plan(optimiser="nelder-mead", budget=500, progress=False)
    figure = motion.plot()
    labels = [axes.get_ylabel() for axes in figure.axes]
    assert labels[:5] == ["angle [°]", "rate [°/s]", "acceleration [°/s²]", "jerk [°/s³]", "base [°]"]
    assert len(figure.axes[0].lines) == 6
    figure.savefig(tmp_path / "motion.pdf")
    page = motion._repr_html_()
    assert "<iframe srcdoc=" in page and "motions" in page
    motion.save_page(tmp_path / "motion.html")
    assert "<canvas" in (tmp_path / "motion.html").read_text(encoding="utf-8")
    assert motion.to_pandas().shape == (501 * 6, 20)


def test_there_is_nothing_to_plan() -> None:
    same = {"start_joints_deg": [0] * 6, "goal_joints_deg": [0] * 6}
    with pytest.raises(driftless.AlreadyThere, match="there is nothing to plan"):
        driftless.plan(driftless.Task(**same, start_base_zyx_deg=[0] * 3, goal_base_zyx_deg=[0] * 3), progress=False)


def test_arguments_of_plan() -> None:
    with pytest.raises(driftless.InputError, match='found no optimiser "cma", expected one of .*did you mean "cma-es"'):
        driftless.plan(optimiser="cma", progress=False)
    with pytest.raises(driftless.InputError, match='found family "splines", expected "spline" or "sine-polynomial"'):
        driftless.plan(family="splines", progress=False)
    for keywords, message in [({"budget": 2e3}, "found budget = 2000.0"), ({"seed": "one"}, "found seed = 'one'")]:
        with pytest.raises(TypeError, match=f"{message}, expected a whole number"):
            driftless.plan(**keywords, progress=False)  # type: ignore[arg-type]
    with pytest.raises(driftless.InputError, match='found `pieces`, which is for family="spline" alone'):
        driftless.plan(family="sine-polynomial", pieces=20, progress=False)


def plan_of(task: driftless.Task) -> driftless.Motion:
    return driftless.plan(task, optimiser="nelder-mead", budget=300, progress=False)


def test_tasks_and_motions_go_to_other_processes_and_back() -> None:
    tasks = [driftless.Task(jerk_limit_deg_s3=limit) for limit in (60, 80)]
    here = [plan_of(task) for task in tasks]
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        there = pool.map(plan_of, tasks)
    for one, other in zip(here, there):
        own, theirs = one.as_dict(), other.as_dict()
        del own["seconds"], theirs["seconds"]
        assert own == theirs
        assert one.sample().angle.tolist() == other.sample().angle.tolist()


@pytest.mark.parametrize("name", ["ur5-turn", "iiwa-turn"])
def test_plans_of_other_robots(command: list[str], name: str) -> None:
    file = ROBOTS / f"{name}.toml"
    told = call_json(command, "plan", file, "--json", "--budget", "5000")
    found = driftless.plan(file, budget=5000, progress=False).as_dict()
    assert found["j"] == told["j"] and found["coefficients"] == told["coefficients"]


@pytest.mark.parametrize("name", ["panda", "canadarm2", "dual_arm"])
def test_robots_come_with_tasks(command: list[str], name: str) -> None:
    told = call_json(command, "plan", name, "--json", "--budget", "300")
    found = driftless.plan(driftless.Task(robot=name), budget=300, progress=False).as_dict()
    assert found["j"] == told["j"] and found["coefficients"] == told["coefficients"]


URDF = """<robot name="arm">
<link name="foot"/>
<link name="upper"><inertial><origin xyz="0 0 0.4"/><mass value="8"/><inertia ixx="0.4" iyy="0.4" izz="0.1"/></inertial></link>
<link name="slider"><inertial><origin xyz="0 0 0.3"/><mass value="5"/><inertia ixx="0.2" iyy="0.2" izz="0.1"/></inertial></link>
<link name="wrist"><inertial><origin xyz="0.2 0 0"/><mass value="3"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
<joint name="turn" type="continuous"><parent link="foot"/><child link="upper"/><axis xyz="1 0 0"/></joint>
<joint name="slide" type="prismatic"><parent link="upper"/><child link="slider"/><origin xyz="0 0 0.5"/><axis xyz="0 1 1"/>
<limit lower="0" upper="0.6" velocity="0.2" effort="9"/></joint>
<joint name="bend" type="revolute"><parent link="slider"/><child link="wrist"/><axis xyz="0 0 1"/>
<limit lower="-2" upper="2" velocity="1" effort="9"/></joint>
</robot>
"""


def test_a_urdf_is_planned_for(command: list[str], tmp_path: Path) -> None:
    urdf = tmp_path / "arm.urdf"
    urdf.write_text(URDF)
    task = driftless.Task(
        robot=urdf,
        base={"mass": 100, "inertia": {"xx": 10, "yy": 12, "zz": 14}, "mount": [0, 0, 0.5]},
        start_joints={"turn": 0, "slide": 0.1, "bend": -20},
        goal_joints=[30, 0.4, 20],
        start_base_zyx_deg=[0, 0, 0],
        goal_base_zyx_deg=[0, 0, 0],
        rate_limit=[50, 0.15, 50],
        acceleration_limit=[70, 0.2, 70],
        jerk_limit=[80, 0.3, 80],
    )
    motion = driftless.plan(task, budget=500, progress=False)
    samples = motion.sample()
    assert samples.units == ("rad", "m", "rad")
    assert samples.angle[-1] == pytest.approx([np.radians(30), 0.4, np.radians(20)])
    assert motion.peaks["rate"][1] <= 0.15 * (1 + 1e-6)
    assert samples.to_polars()["unit"][:3].to_list() == ["rad", "m", "rad"]
    file = tmp_path / "task.toml"
    file.write_text("""[task]
robot = "arm.urdf"
base = { mass = 100, inertia = { xx = 10, yy = 12, zz = 14 }, mount = [0, 0, 0.5] }
start = { joints = [0, 0.1, -20], base_zyx_deg = [0, 0, 0] }
goal = { joints = { turn = 30, slide = 0.4, bend = 20 }, base_zyx_deg = [0, 0, 0] }
limits = { rate = [50, 0.15, 50], acceleration = [70, 0.2, 70], jerk = [80, 0.3, 80] }
""")
    motion.save(tmp_path / "ours.csv")
    call(command, "plan", file, "--budget", "500", "--motion", tmp_path / "theirs.csv")
    assert (tmp_path / "ours.csv").read_bytes() == (tmp_path / "theirs.csv").read_bytes()
    pytest.importorskip("matplotlib")
    labels = [axes.get_ylabel() for axes in motion.plot().axes]
    assert labels[:2] == ["position [° or m]", "rate [° or m/s]"]


def test_joints_follow_others() -> None:
    whole = driftless.Task(robot="panda")
    task = driftless.Task(robot="panda", follow={"panda_joint6": {"joint": "panda_joint4", "multiplier": -1}})
    assert task.limits[5].tolist() == task.limits[3].tolist()
    assert len(task.limits) == len(whole.limits)
    with pytest.raises(driftless.InputError, match="panda_joint4x"):
        driftless.Task(robot="panda", follow={"panda_joint6": "panda_joint4x"})


def test_joints_are_locked_and_a_payload_is_carried() -> None:
    whole = driftless.Task(robot="panda")
    locked = driftless.Task(robot="panda", locked={"panda_joint3": 10})
    assert locked.limits.tolist() == np.delete(whole.limits, 2, axis=0).tolist()
    carrying = driftless.Task(robot="panda", payload={"mass": 20, "centre_of_mass": [0, 0, 0.1]})
    x = whole.problem().lower / 3
    assert carrying.problem()(x) != whole.problem()(x)
    with pytest.raises(driftless.InputError, match="no joint `panda_jont3` that moves"):
        driftless.Task(robot="panda", locked=["panda_jont3"])
