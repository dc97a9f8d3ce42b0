"""Results as JSON on the standard output."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np

__all__ = ["print_json"]


def print_json(value: dict[str, Any]) -> None:
    """Print an object as JSON.

    Parameters
    ----------
    value : dict
        Numbers, texts, lists and arrays; what is not finite becomes null.
    """
    print(json.dumps(_plain(value), indent=1, allow_nan=False))


def _plain(value: object) -> object:
    """JSON's own types; what is not finite becomes null."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
