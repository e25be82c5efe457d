"""The command: ``driftless``, or ``python -m driftless``."""

from __future__ import annotations

import signal
import sys

from ._driftless import command

__all__ = ["main"]


def main() -> None:
    """Does what the arguments ask, as the command does that is built without Python."""
    # The command has a handler of its own; that of Python would raise an exception when all is done.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(command(["driftless", *sys.argv[1:]]))


if __name__ == "__main__":
    main()
