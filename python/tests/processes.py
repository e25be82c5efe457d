"""Commands and interpreters that tests start."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path


def call(command: list[str], *arguments: str | Path, cwd: Path | None = None) -> str:
    """What a command prints."""
    done = subprocess.run(
        [*command, *map(str, arguments)], cwd=cwd, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def call_json(command: list[str], *arguments: str | Path, cwd: Path | None = None) -> dict[str, object]:
    """The JSON that a command prints."""
    return dict(json.loads(call(command, *arguments, cwd=cwd)))


def child(code: str, *, timeout: float = 120) -> subprocess.CompletedProcess[str]:
    """Runs a program in an interpreter of its own."""
    return subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, timeout=timeout)
