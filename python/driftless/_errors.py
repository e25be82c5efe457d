"""Exceptions of the package."""

from __future__ import annotations

import contextlib
import operator
from collections.abc import Generator, Iterable, Mapping
from typing import Any

__all__ = [
    "AlreadyThere",
    "BudgetSpent",
    "Error",
    "InputError",
    "Interrupted",
    "NoDerivatives",
    "ResultsError",
    "RunEnded",
    "SearchError",
]


class Error(Exception):
    """Base class of all errors of the package."""


class InputError(Error, ValueError):
    """A file or an argument that cannot be used.

    Attributes
    ----------
    message : str
        What is wrong, and what was expected.
    file : str
        The file, or what stands for one; empty where the error is about an argument.
    line, column : int or None
        Where the mistake begins, counted from one, where that is known.
    hint : str or None
        What was probably meant.
    """

    def __init__(
        self,
        message: str,
        file: str = "",
        line: int | None = None,
        column: int | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message, file, line, column, hint)
        self.message = message
        self.file = file
        self.line = line
        self.column = column
        self.hint = hint

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part)
        hint = f"; {self.hint}" if self.hint else ""
        return f"{place}: {self.message}{hint}" if place else f"{self.message}{hint}"


def check_count(what: str, number: Any, most: int, least: int = 1) -> None:
    """Whether an argument is a whole number within bounds."""
    try:
        found = operator.index(number)
    except TypeError:
        raise TypeError(f"found {what} = {number!r}, expected a whole number") from None
    if not least <= found <= most:
        raise InputError(f"found {what} = {number}, expected {least} to {most}")


@contextlib.contextmanager
def made_text(path: str, lines: Iterable[str], keys: Mapping[str, str] | None = None) -> Generator[None, None, None]:
    """Has errors about a text that the package has made name what it was made from, instead of a place that no file has.

    `lines` are the names for its lines, the last one for all that follow; `keys` those for its keys.
    """
    try:
        yield
    except InputError as error:
        if error.file != path:
            raise
        names, message = list(lines), error.message
        for key, name in (keys or {}).items():
            message = message.replace(f"`{key}`", f"`{name}`")
        name = names[min(error.line or 1, len(names)) - 1]
        raise InputError(f"{name}: {message}", hint=error.hint) from None


class ResultsError(Error):
    """A folder of results that cannot be read, written or used."""


class SearchError(Error, RuntimeError):
    """A search that could not begin or go on."""


class AlreadyThere(SearchError):
    """A task whose robot is where it should be, so that there is nothing to plan."""


class NoDerivatives(Error, RuntimeError):
    """Derivatives of a kind that the problem does not have."""


class RunEnded(Error, RuntimeError):
    """An oracle that was asked when its run was over."""


class BudgetSpent(BaseException):
    """The end of a search: every evaluation of the budget is spent.

    Let it pass. It is no `Exception`, so that ``except Exception`` lets it pass too.
    """


class Interrupted(BaseException):
    """The end of a search: the user has interrupted the experiment."""


for _name in __all__:
    # As users know them.
    globals()[_name].__module__ = "driftless"
