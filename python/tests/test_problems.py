"""Problems: calls, batches, derivatives, and what is no point."""

from __future__ import annotations

import math
import pickle
import threading

import numpy as np
import pytest

import driftless

@pytest.fixture(params=["time-free", "scaled", "raw"])
def problem(request: pytest.FixtureRequest) -> driftless.Problem:
    return driftless.Task().problem(request.param)


def points(problem: driftless.Problem, count: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(problem.lower, problem.upper, (count, problem.dimension))


def test_calls_and_batches_agree(problem: driftless.Problem) -> None:
    x = points(problem, 50)
    costs, violations = problem.evaluate_batch(x)
    assert costs.shape == violations.shape == (50,)
    assert [problem(row) for row in x] == costs.tolist() == problem.batch(x).tolist()
    assert [problem.violation(row) for row in x] == violations.tolist()
    assert problem.evaluate(x[0]) == (costs[0], violations[0])


def test_the_best_motion_known_costs_what_is_known() -> None:
    problem = driftless.Task().problem()
    assert problem.best_known == pytest.approx(0.78184858, abs=1e-8)
    motion = driftless.plan(family="sine-polynomial", progress=False)
    assert motion.cost == pytest.approx(problem.best_known, rel=1e-6)
    # The search evaluates less finely than the motion is certified.
    assert problem(motion.coefficients.ravel()) == pytest.approx(motion.cost, rel=1e-5)


def test_subgradients_are_slopes(problem: driftless.Problem) -> None:
    # Far from the middle powers of time leave no digits to differences.
    middle = (problem.lower + problem.upper) / 2
    for x in middle + 0.03 * (points(problem, 5, seed=2) - middle):
        cost, slopes = problem.subgradient(x)
        assert cost == pytest.approx(problem(x), rel=1e-13)
        step = 1e-6 * (problem.upper - problem.lower)
        for k in range(problem.dimension):
            ahead, behind = x.copy(), x.copy()
            ahead[k], behind[k] = x[k] + step[k], x[k] - step[k]
            ratio = (problem(ahead) - problem(behind)) / (2 * step[k])
            assert slopes[k] == pytest.approx(ratio, rel=1e-3, abs=1e-3 * np.abs(slopes).max())


def test_terms_add_up_to_the_cost() -> None:
    problem = driftless.Task().problem("time-free")
    shapes = {
        "norm": np.linalg.norm,
        "max": np.max,
        "hinge": lambda v: np.maximum(v, 0).sum(),
    }
    for x in points(problem, 5):
        found = problem.linearise(x)
        total = sum(term.weight * shapes[term.shape](term.values) for term in found.terms)
        assert found.cost == pytest.approx(total, rel=1e-14)
        assert all(term.gradients.shape == (len(term.values), 12) for term in found.terms)
        assert found.cost == pytest.approx(problem(x), rel=1e-12)


def test_derivatives_that_there_are_not() -> None:
    raw = driftless.Task().problem("raw")
    assert not raw.has_linearise
    with pytest.raises(driftless.NoDerivatives, match="no derivatives of this kind"):
        raw.linearise(raw.lower)
    with pytest.raises(ValueError, match=r"found x\[0\] = .*, expected .* to .*: there are derivatives within the box alone"):
        raw.subgradient(raw.lower - 1)


def test_beyond_the_box_costs_infinitely_much(problem: driftless.Problem) -> None:
    x = points(problem, 4)
    x[1] = problem.upper + 1
    x[2, 0] = math.nan
    costs, violations = problem.evaluate_batch(x)
    assert np.isinf(costs[1:3]).all() and np.isinf(violations[1:3]).all()
    assert np.isfinite(costs[[0, 3]]).all()
    assert [problem(row) for row in x] == costs.tolist()


def test_rounding_beyond_the_box_is_within() -> None:
    problem = driftless.Task().problem()
    assert problem(problem.upper * (1 + 1e-15)) == problem(problem.upper)


@pytest.mark.parametrize(
    ("x", "error", "message"),
    [
        (np.zeros(11), ValueError, r"found a point of shape \(11,\), expected \(12,\)"),
        (np.zeros((2, 12)), ValueError, r"found a point of shape \(2, 12\), expected \(12,\)"),
        (3.0, ValueError, r"found a point of shape \(\), expected \(12,\)"),
        (np.zeros(12, complex), TypeError, "found a point of dtype complex128, expected real numbers"),
        (["a"] * 12, TypeError, "found a point of dtype <U1, expected real numbers"),
        (None, TypeError, "found a point of dtype object, expected real numbers"),
        ([[0], [0, 1]], ValueError, "inhomogeneous shape"),
    ],
)
def test_what_is_no_point(x: object, error: type[Exception], message: str) -> None:
    problem = driftless.Task().problem()
    with pytest.raises(error, match=message):
        problem(x)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("x", "error", "message"),
    [
        (np.zeros(12), ValueError, r"found points of shape \(12,\), expected \(m, 12\)"),
        (np.zeros((3, 11)), ValueError, r"found points of shape \(3, 11\), expected \(m, 12\)"),
        (np.zeros((1, 3, 12)), ValueError, r"found points of shape \(1, 3, 12\), expected \(m, 12\)"),
        (np.zeros((3, 12), object), TypeError, "found points of dtype object, expected real numbers"),
    ],
)
def test_what_are_no_points(x: object, error: type[Exception], message: str) -> None:
    problem = driftless.Task().problem()
    with pytest.raises(error, match=message):
        problem.batch(x)  # type: ignore[arg-type]


def test_any_array_of_numbers_will_do() -> None:
    problem = driftless.Task().problem()
    x = points(problem, 6)
    costs = problem.batch(x).tolist()
    frozen = x.copy()
    frozen.flags.writeable = False
    wide = np.zeros((12, 24))
    wide[::2, ::2] = x
    for same in (np.asfortranarray(x), frozen, wide[::2, ::2], x[::-1][::-1], x.tolist(), x.astype(">f8")):
        assert problem.batch(same).tolist() == costs
        assert problem(same[1]) == costs[1]
    packed = np.zeros((6, 12), [("a", "u1"), ("x", "f8")])
    packed["x"] = x
    assert problem.batch(packed["x"]).tolist() == costs and problem(packed["x"][1]) == costs[1]
    shifted = np.frombuffer(b"." + x.tobytes(), offset=1).reshape(6, 12)
    assert problem.batch(shifted).tolist() == costs and problem(shifted[1]) == costs[1]
    assert problem.batch(np.zeros((2, 12), int)).tolist() == [problem([0] * 12)] * 2
    assert problem(x[0].astype("f4")) == problem(x[0].astype("f4").astype("f8"))
    assert problem.batch(np.zeros((0, 12))).shape == (0,)


def test_an_array_that_is_written_to_meanwhile() -> None:
    problem = driftless.Task().problem()
    x = points(problem, 20_000)
    costs, stop = problem.batch(x).tolist(), threading.Event()
    same = x.copy()

    def write() -> None:
        while not stop.is_set():
            same[:] = 0.0

    writer = threading.Thread(target=write)
    found = problem.batch(same)
    writer.start()
    problem.batch(same)
    stop.set()
    writer.join()
    assert found.tolist() == costs


def test_batches_let_other_threads_run() -> None:
    problem = driftless.Task().problem()
    counted, stop = [0], threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1

    x = points(problem, 30_000)
    other = threading.Thread(target=count)
    other.start()
    before = counted[0]
    problem.batch(x)
    during = counted[0] - before
    stop.set()
    other.join()
    # With the lock held throughout, the other thread could count a few times at both ends alone.
    assert during > 10_000


def test_formulations_and_their_boxes() -> None:
    task = driftless.Task()
    assert task.formulations == ("time-free", "scaled", "raw")
    assert [task.problem(name).dimension for name in task.formulations] == [12, 13, 13]
    assert task.problem().formulation == "time-free"
    with pytest.raises(driftless.InputError, match="found formulation \"other\", expected one of time-free, scaled, raw"):
        task.problem("other")


def test_bounds_belong_to_the_caller() -> None:
    problem = driftless.Task().problem()
    problem.lower[:] = 7.0
    assert (problem.lower < problem.upper).all()


def test_test_functions() -> None:
    found = driftless.functions(["sphere", "rastrigin"], dimension=[3, 5], instances=2)
    assert [(p.name, p.dimension) for p in found][:3] == [("sphere", 3), ("sphere", 3), ("sphere", 5)]
    assert len(found) == 8 and all(p.best_known == 0 for p in found)
    assert found[0].label == "sphere dimension=3 instance=1"
    for arguments, message in [
        (("spere",), "name: unknown variant `spere`, .*did you mean `sphere`"),
        (("sphere", 1), "dimension: found 1, expected a whole number from 2 to 1000"),
        (("sphere", 3, 0), "instances: found 0, expected a whole number from 1 to 10000"),
    ]:
        with pytest.raises(driftless.InputError, match=f"^{message}"):
            driftless.functions(*arguments)  # type: ignore[arg-type]
    with pytest.raises(driftless.InputError, match="the problem is no task"):
        found[0].motion(found[0].lower)


@pytest.mark.parametrize("problem", [driftless.Task().problem("raw"), *driftless.functions("ackley", 4)])
def test_problems_can_be_pickled(problem: driftless.Problem) -> None:
    same = pickle.loads(pickle.dumps(problem))
    x = points(problem, 3)
    assert repr(same) == repr(problem)
    assert same.batch(x).tolist() == problem.batch(x).tolist()
