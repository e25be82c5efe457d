"""Who competes and on what: optimisers and problems that are functions."""

from __future__ import annotations

import dataclasses
import inspect
import math
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._identity import digest, told
from ._toml import document, value

__all__ = ["Builtin", "Function", "Optimiser", "builtin", "optimiser", "problem"]

_Solver = Callable[..., object]
_Cost = Callable[[NDArray[np.float64]], Any]


@dataclass(frozen=True, eq=False)
class Optimiser:
    """An optimiser that is a function ``f(oracle, rng, **settings)``; the decorator `optimiser` makes one.

    It may be called as the function that it is.

    Attributes
    ----------
    name : str
        What it is called.
    function : callable
        The function. It asks the `Oracle` for costs until that raises `BudgetSpent`, or returns earlier. `rng` is a
        `numpy.random.Generator` seeded by the run's seed.
    settings : dict
        The function's keyword arguments. Two optimisers with different settings have different runs.
    formulation : str or None
        The variables of a task that it searches in: ``"time-free"``, ``"scaled"`` or ``"raw"``. None for the preferred ones.
    needs_derivatives : bool
        Whether it is only for problems with derivatives.
    version : int or str
        Part of what tells its runs from those of earlier versions, beside the function's code.
    label : str or None
        What tables and charts call it, instead of the name.
    seeds, budget : int or None
        Number of seeds, and evaluations per run, instead of the experiment's.
    isolation : {"thread", "process"}
        Where it runs. A process of its own survives crashes and runs beside others, but each question costs some 100 µs.
    """

    name: str
    function: _Solver
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    formulation: str | None = None
    needs_derivatives: bool = False
    version: int | str = 1
    label: str | None = None
    seeds: int | None = None
    budget: int | None = None
    isolation: str = "thread"

    def __post_init__(self) -> None:
        if self.isolation not in ("thread", "process"):
            raise ValueError(f'found isolation {self.isolation!r}, expected "thread" or "process"')
        if self.formulation not in (None, "time-free", "scaled", "raw"):
            raise ValueError(f'found formulation {self.formulation!r}, expected "time-free", "scaled" or "raw"')
        _check_order(self.name, self.function)
        keywords = _keywords(self.function)
        unknown = set[str]() if keywords is None else set(self.settings) - set(keywords)
        if unknown:
            raise TypeError(f"{self.name} has no setting {', '.join(sorted(unknown))}")

    def __call__(self, *arguments: Any, **settings: Any) -> object:
        return self.function(*arguments, **{**self.settings, **settings})

    def replace(self, **changes: Any) -> Optimiser:
        """The same with other attributes; keywords that are no attributes are settings.

        >>> import driftless
        >>> @driftless.optimiser
        ... def walk(oracle, rng, *, step=0.1): ...
        >>> walk.replace(step=0.2, label="long steps")
        <driftless.Optimiser long steps (step=0.2)>
        """
        own = {f.name for f in dataclasses.fields(self)}
        settings = {key: x for key, x in changes.items() if key not in own}
        changes = {key: x for key, x in changes.items() if key in own}
        changes["settings"] = {**changes.get("settings", self.settings), **settings}
        return dataclasses.replace(self, **changes)

    def all_settings(self) -> dict[str, Any]:
        """The settings, those that are left at their defaults included."""
        settings = {**(_keywords(self.function) or {}), **self.settings}
        missing = sorted(name for name, x in settings.items() if x is inspect.Parameter.empty)
        if missing:
            raise TypeError(f"{self.name} needs the setting {', '.join(missing)}")
        return settings

    def identity(self) -> dict[str, Any]:
        """All that determines its runs beside formulation, seed and budget."""
        settings = {f"setting {name}": told(x) for name, x in self.all_settings().items()}
        return {**settings, "version": told(self.version), "code": digest(self.function)}

    def __reduce__(self) -> tuple[Any, ...]:
        state = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "function"}
        return _by_name, (Optimiser, *_place(self.function, self.name), state)

    def __repr__(self) -> str:
        changed = ", ".join(f"{name}={x!r}" for name, x in self.settings.items())
        return f"<driftless.Optimiser {self.label or self.name}{f' ({changed})' if changed else ''}>"


def _check_order(name: str, function: _Solver) -> None:
    """Whether a function takes the oracle first, as far as the names of its parameters tell."""
    first, second, *_ = [*inspect.signature(function).parameters, "", ""]
    if first == "rng" or second == "oracle":
        raise TypeError(f"found {name}({first}, {second}), expected {name}(oracle, rng): the oracle comes first")


def _keywords(function: _Solver) -> dict[str, Any] | None:
    """The settings of a function and their defaults, `Parameter.empty` where there is none; None where it takes any."""
    parameters = list(inspect.signature(function).parameters.values())
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return None
    # The first two are the oracle and the generator.
    only, either = inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD
    return {p.name: p.default for k, p in enumerate(parameters) if p.kind is only or k > 1 and p.kind is either}


def _place(function: Any, name: str) -> tuple[str, str]:
    """Module and name under which a function, or what it was made into, is found."""
    module, qualified = getattr(function, "__module__", None), getattr(function, "__qualname__", "")
    found: Any = sys.modules.get(module or "")
    for part in qualified.split("."):
        found = getattr(found, part, None)
    if module is None or getattr(found, "function", found) is not function:
        raise ValueError(f"{name} is not at the top level of a module under its own name, where other processes find it")
    return module, qualified


def _by_name(kind: Any, module: str, qualified: str, state: dict[str, Any]) -> Any:
    found: Any = import_module(module)
    for part in qualified.split("."):
        found = getattr(found, part)
    return kind(function=getattr(found, "function", found), **state)


@overload
def optimiser(function: _Solver, /) -> Optimiser: ...
@overload
def optimiser(
    name: str | None = None,
    /,
    *,
    formulation: str | None = None,
    needs_derivatives: bool = False,
    version: int | str = 1,
    isolation: str = "thread",
) -> Callable[[_Solver], Optimiser]: ...
def optimiser(
    name: _Solver | str | None = None,
    /,
    *,
    formulation: str | None = None,
    needs_derivatives: bool = False,
    version: int | str = 1,
    isolation: str = "thread",
) -> Optimiser | Callable[[_Solver], Optimiser]:
    """Makes an optimiser of a function ``f(oracle, rng, **settings)``.

    Parameters
    ----------
    name : str, optional
        What to call it, instead of the function's name.
    formulation, needs_derivatives, version, isolation
        See `Optimiser`.

    Examples
    --------
    >>> import driftless
    >>> @driftless.optimiser
    ... def guess(oracle, rng, *, size=64):
    ...     while True:
    ...         oracle.batch(rng.uniform(oracle.lower, oracle.upper, (size, oracle.dimension)))
    >>> guess
    <driftless.Optimiser guess>
    """

    def decorate(function: _Solver) -> Optimiser:
        own = name if isinstance(name, str) else str(getattr(function, "__name__", "optimiser"))
        return Optimiser(
            own,
            function,
            formulation=formulation,
            needs_derivatives=needs_derivatives,
            version=version,
            isolation=isolation,
        )

    return decorate if name is None or isinstance(name, str) else decorate(name)


@dataclass(frozen=True)
class Builtin:
    """An optimiser that comes with the package; `builtin` makes one."""

    name: str
    settings: Mapping[str, Any] = field(default_factory=dict[str, Any])
    label: str | None = None

    def to_toml(self) -> str:
        """The table of an experiment file, with a line for every setting at its end."""
        label = f"label = {value(self.label)}\n" if self.label else ""
        settings = {f"{self.name}.{key}": x for key, x in self.settings.items()}
        return f"\n[[optimiser]]\n{label}{document(settings or {self.name: {}})}"


def builtin(name: str, *, label: str | None = None, **settings: Any) -> Builtin:
    """An optimiser that comes with the package, with settings as an experiment file has them.

    >>> import driftless
    >>> driftless.builtin("scp", starts=10)
    Builtin(name='scp', settings={'starts': 10}, label=None)
    """
    return Builtin(name, settings, label)


@dataclass(frozen=True, eq=False)
class Function:
    """A problem that is a function of a point, or of many; the decorator `problem` makes one.

    It may be called as the function that it is.

    Attributes
    ----------
    name : str
        What it is called.
    function : callable
        Takes a point, shape (n,), and returns its cost, or cost and violation. If `batched`, takes points, shape (m, n), and returns
        arrays of shape (m,).
    lower, upper : ndarray, shape (n,)
        The box.
    batched : bool
        Whether the function takes many points.
    least_cost : float or None
        The least cost that there is, where that is known.
    targets : tuple of float
        Costs that runs are asked to reach.
    version : int or str
        Part of what tells its runs from those of earlier versions, beside the function's code.
    """

    name: str
    function: _Cost
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    batched: bool = False
    least_cost: float | None = None
    targets: tuple[float, ...] = ()
    version: int | str = 1

    def __post_init__(self) -> None:
        lower, upper = np.array(self.lower, dtype=float), np.array(self.upper, dtype=float)
        if lower.ndim != 1 or lower.shape != upper.shape:
            raise ValueError(f"found bounds of shape {lower.shape} and {upper.shape}, expected (n,)")
        targets = tuple(map(float, self.targets))
        numbers = [*targets, *([] if self.least_cost is None else [self.least_cost])]
        if not all(math.isfinite(number) for number in numbers):
            raise ValueError("found a least cost or a target that is infinite or NaN, expected numbers")
        for name, x in (("lower", lower), ("upper", upper), ("targets", targets)):
            object.__setattr__(self, name, x)

    @property
    def dimension(self) -> int:
        """The number of variables."""
        return len(self.lower)

    def __call__(self, x: Any) -> Any:
        return self.function(x)

    def identity(self) -> dict[str, Any]:
        """All that determines its costs."""
        box = [float(x).hex() for x in (*self.lower, *self.upper)]
        return {"box": " ".join(box), "version": told(self.version), "code": digest(self.function)}

    def __reduce__(self) -> tuple[Any, ...]:
        state = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name != "function"}
        return _by_name, (Function, *_place(self.function, self.name), state)

    def __repr__(self) -> str:
        return f"<driftless.Function {self.name}, {self.dimension} variables>"


def problem(
    *,
    lower: ArrayLike,
    upper: ArrayLike,
    dimension: int | None = None,
    name: str | None = None,
    batched: bool = False,
    least_cost: float | None = None,
    targets: float | Sequence[float] = (),
    version: int | str = 1,
) -> Callable[[_Cost], Function]:
    """Makes a problem of a function.

    Parameters
    ----------
    lower, upper : float or array_like, shape (n,)
        The box.
    dimension : int, optional
        The number of variables, where both bounds are the same for all.
    name, batched, least_cost, targets, version
        See `Function`.

    Examples
    --------
    >>> import driftless
    >>> @driftless.problem(lower=-5, upper=5, dimension=3, least_cost=0, targets=[1e-2, 1e-8])
    ... def bowl(x):
    ...     return float(x @ x)
    >>> bowl
    <driftless.Function bowl, 3 variables>
    """
    low, up = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    if dimension is None and low.ndim == 0 and up.ndim == 0:
        raise ValueError("found one number for each bound and no dimension, expected arrays or a dimension")
    shape = np.broadcast_shapes(low.shape, up.shape, () if dimension is None else (dimension,))
    if len(shape) != 1:
        raise ValueError(f"found bounds of shape {shape}, expected (n,)")
    low, up = np.broadcast_to(low, shape).copy(), np.broadcast_to(up, shape).copy()
    asked = tuple(float(target) for target in np.atleast_1d(np.asarray(targets, dtype=float)))

    def decorate(function: _Cost) -> Function:
        own = name or str(getattr(function, "__name__", "problem"))
        return Function(own, function, low, up, batched, least_cost, asked, version)

    return decorate


def external_table(entrant: Optimiser) -> str:
    """The table of an experiment file that runs an optimiser as a process."""
    function = entrant.function
    try:
        module, name = _place(function, entrant.name)
        file = inspect.getsourcefile(function)
    except (TypeError, ValueError):
        module, name, file = "", "", None
    if file is None or not os.path.isfile(file):
        raise ValueError(
            f"{entrant.name} cannot run in a process of its own: expected a function at the top level of a file, under its own name"
        )
    settings = entrant.all_settings()
    # TOML has no None; the function has it by default.
    defaults = _keywords(function) or {}
    settings = {key: x for key, x in settings.items() if not (x is None and defaults.get(key, x) is None)}
    # Modules of a package are imported by their names, since they may import each other.
    where = module if "." in module else os.path.abspath(file)
    table = {
        "name": entrant.name,
        "command": [sys.executable, "-m", "driftless.solve", where, name, f"version={entrant.version}"],
        "files": [os.path.abspath(file)],
        "settings": settings,
    }
    if entrant.formulation:
        table["formulation"] = entrant.formulation
    head = {"label": entrant.label, "seeds": entrant.seeds}
    lines = "".join(f"{key} = {value(x)}\n" for key, x in head.items() if x is not None)
    budget = f"budget = {{ evaluations = {entrant.budget} }}\n" if entrant.budget else ""
    return f"\n[[optimiser]]\n{lines}{budget}external = {value(table)}\n"
