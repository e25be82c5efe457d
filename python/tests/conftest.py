"""What the tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def command() -> list[str]:
    """The command that is built without Python: of the variable DRIFTLESS, or of the workspace."""
    root = Path(__file__).parents[2]
    built = os.environ.get("DRIFTLESS", str(root / "target" / "release" / "driftless"))
    if not Path(built).is_file():
        pytest.skip(f"{built} is not built")
    return [built]
