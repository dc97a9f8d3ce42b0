"""JSON results on the standard output, warnings on the error output."""

from __future__ import annotations

import json
import math
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from rwmf.errors import RwmfWarning

__all__ = ["print_json", "print_warnings", "print_written", "printed_warnings"]


def print_json(value: dict[str, Any]) -> None:
    """Print an object as JSON."""
    print(json.dumps(_plain(value), indent=1, allow_nan=False))


def print_warnings(path: str, lines: Iterable[str]) -> None:
    """Print the warnings about the results of a file on the error output."""
    for line in lines:
        print(f"rwmf: {path}: warning: {line}", file=sys.stderr)


@contextmanager
def printed_warnings(path: str) -> Iterator[None]:
    """Print the warnings about the inputs that a block reads."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RwmfWarning)
        yield
    print_warnings(path, (str(item.message) for item in caught))


def print_written(paths: Iterable[str | Path | None], *, is_json: bool = False) -> None:
    """Print the paths of written files."""
    for path in filter(None, paths):
        print(f"written: {path}", file=sys.stderr if is_json else sys.stdout)


def _plain(value: object) -> object:
    """Convert to JSON types; values that are not finite become null."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
