"""Progress of long work."""

from __future__ import annotations

import sys
import time
import warnings
from importlib import import_module
from typing import Any

__all__ = ["Progress"]


class Progress:
    """A bar over evaluations: tqdm's where that is installed, a plain line on a terminal, or nothing."""

    def __init__(self, shown: bool, what: str) -> None:
        self._shown, self._what = shown, what
        self._total, self._began = 0, time.monotonic()
        self._bar: Any = None
        self._line = False

    def begin(self, total: int) -> None:
        self._total, self._began = total, time.monotonic()
        if not self._shown or total == 0:
            return
        try:
            with warnings.catch_warnings():
                # In a notebook without ipywidgets it warns, and draws nothing.
                warnings.simplefilter("ignore")
                tqdm: Any = import_module("tqdm.auto").tqdm
        except ImportError:
            self._line = sys.stderr.isatty()
        else:
            # Without a terminal or a notebook it draws nothing.
            self._bar = tqdm(total=total, desc=self._what, unit="eval", unit_scale=True, leave=False, disable=None)

    def update(self, done: int) -> None:
        done = min(done, self._total)
        if self._bar is not None:
            self._bar.update(done - self._bar.n)
        elif self._line:
            share = done / max(self._total, 1)
            seconds = time.monotonic() - self._began
            print(f"\r{self._what}: {share:4.0%} in {seconds:.0f} s", end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._line:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
