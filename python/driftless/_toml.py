"""TOML for values of Python."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["document", "value"]


def value(x: Any) -> str:
    """A value as TOML writes it.

    >>> value({"a": [1, 2.5, True], "b": "x"})
    '{ a = [1, 2.5, true], b = "x" }'
    """
    if hasattr(x, "tolist"):
        x = x.tolist()
    if isinstance(x, bool):
        return "true" if x else "false"
    if isinstance(x, int):
        return str(x)
    if isinstance(x, float):
        return repr(x) if math.isfinite(x) else str(x)
    if isinstance(x, str):
        return json.dumps(x, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(x, Mapping):
        parts = [f"{key if _is_bare(key) else json.dumps(key)} = {value(part)}" for key, part in x.items()]
        return "{ " + ", ".join(parts) + " }" if parts else "{}"
    if isinstance(x, Sequence):
        return "[" + ", ".join(value(part) for part in x) + "]"
    raise TypeError(f"found {type(x).__name__}, expected a number, a text, a list or a dict")


def _is_bare(key: str) -> bool:
    return key.replace("-", "a").replace("_", "a").isalnum() and key.isascii()


def document(keys: Mapping[str, Any]) -> str:
    """Dotted keys and their values, one per line.

    >>> print(document({"task.robot": "iiwa.toml"}))
    task.robot = "iiwa.toml"
    <BLANKLINE>
    """
    return "".join(f"{key} = {value(x)}\n" for key, x in keys.items())
