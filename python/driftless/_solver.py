"""How a solver is called."""

from __future__ import annotations

import inspect
import threading
from collections.abc import Callable
from typing import Any

__all__ = ["call", "start"]


def call(function: Callable[..., Any], oracle: Any, rng: Any, settings: dict[str, Any]) -> None:
    """Calls a solver, which has to be done when it returns."""
    found = function(oracle, rng, **settings)
    if inspect.isgenerator(found) or inspect.iscoroutine(found) or inspect.isasyncgen(found):
        if not inspect.isasyncgen(found):
            found.close()
        raise TypeError(f"the optimiser returned a {type(found).__name__}, expected a function that searches when it is called")


def start(
    function: Callable[..., Any], oracle: Any, rng: Any, settings: dict[str, Any], ended: Callable[[BaseException | None], None]
) -> None:
    """Calls a solver in a thread of its own, which Python does not wait for when it ends, and tells how it ended."""

    def work() -> None:
        oracle._enter()
        try:
            call(function, oracle, rng, settings)
        except BaseException as error:
            ended(error)
        else:
            ended(None)

    threading.Thread(target=work, name="driftless solver", daemon=True).start()
