"""Results as JSON on the standard output, warnings on the error output."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["print_json", "print_warnings", "print_written"]


def print_json(value: dict[str, Any]) -> None:
    """Print an object as JSON.

    Parameters
    ----------
    value : dict
        Numbers, texts, lists and arrays; what is not finite becomes null.
    """
    print(json.dumps(_plain(value), indent=1, allow_nan=False))


def print_warnings(path: str, warnings: Iterable[str]) -> None:
    """Tell on the error output what to keep in mind about the results of a file.

    Parameters
    ----------
    path : str
        The file that was asked for.
    warnings : iterable of str
        One line each.
    """
    for warning in warnings:
        print(f"rwmf: {path}: warning: {warning}", file=sys.stderr)


def print_written(paths: Iterable[str | Path | None], *, is_json: bool = False) -> None:
    """Name the files that a command has written.

    Parameters
    ----------
    paths : iterable of str or path, optional
        The files; None for one that was not asked for.
    is_json : bool
        Whether the standard output is one JSON object: the error output then names the files.
    """
    for path in filter(None, paths):
        print(f"written: {path}", file=sys.stderr if is_json else sys.stdout)


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
