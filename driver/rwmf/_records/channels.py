"""One component of a recorded motion, and checks that all formats share."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._files.names import shorten
from rwmf._numbers import show
from rwmf.case import Motion
from rwmf.errors import InputError

__all__ = [
    "Channel",
    "Values",
    "check_count",
    "check_peak",
    "fixed_numbers",
    "free_numbers",
    "header_number",
    "in_base_unit",
]

Values = npt.NDArray[np.float64]

_VERTICAL = re.compile(r"\b(up|u-d|ud|vert\w*|down|dn|dwn|z)\b", re.IGNORECASE)
# number of a unit in tables of COSMOS: 'cm/s^2 (4)'
_CODE = re.compile(r"\(\d+\)")
# accepted difference between the stated and the largest sample, beside the printed digits [-]
_PEAK = 2e-3


@dataclass(frozen=True)
class Channel:
    """A component of a record.

    Attributes
    ----------
    motion : Motion
        Its samples.
    direction : str
        Direction as in the file; '' when the file gives none.
    dialect : str
        Name of the file's format.
    is_complete : bool
        True when the file has this channel alone.
    """

    motion: Motion
    direction: str
    dialect: str
    is_complete: bool = True

    @property
    def is_vertical(self) -> bool:
        """True for a vertical component."""
        return _VERTICAL.search(self.direction) is not None


def free_numbers(lines: Sequence[str], first: int) -> Values:
    """Read numbers separated by blanks."""
    words = [line.split() for line in lines]
    return _numbers(words, first)


def fixed_numbers(lines: Sequence[str], first: int, count: int, layout: tuple[int, int]) -> Values:
    """Read numbers in columns of fixed width, which may touch."""
    per_line, width = layout
    used = lines[: -(-count // per_line)]
    cells = [
        [line[i : i + width] for i in range(0, min(len(line.rstrip()), per_line * width), width)]
        for line in used
    ]
    found = sum(map(len, cells))
    if found < count:
        # a line of text ends the numbers earlier than the missing cells of the last line
        _numbers(cells, first)
        raise InputError(f"the file has {found} numbers where its header says {count}")
    return _numbers(cells, first)[:count]


def _numbers(rows: list[list[str]], first: int) -> Values:
    """Convert the words of lines."""
    try:
        values = np.array([float(word) for row in rows for word in row])
    except ValueError:
        values = np.array([math.nan])
    if np.isfinite(values).all() and not any("_" in word for row in rows for word in row):
        return values
    for i, row in enumerate(rows):
        for word in row:
            if not _is_finite(word):
                raise InputError(
                    f"line {first + i}: {shorten(word.strip())!r} is not a finite number"
                )
    return values


def _is_finite(word: str) -> bool:
    try:
        return "_" not in word and math.isfinite(float(word))
    except ValueError:
        return False


def header_number(key: str, text: str | None, *, above: float = 0.0) -> float:
    """Return a number of a header."""
    if text is None:
        raise InputError(f"the header has no {key}")
    if not _is_finite(text) or float(text) <= above:
        raise InputError(
            f"the header has {key} = {show(text.strip())}: must be a number > {above:g}"
        )
    return float(text)


def in_base_unit(values: Values, text: str, key: str) -> tuple[Values, str]:
    """Convert accelerations to a unit of a motion."""
    quantity, base, times, over = _library.unit_named(_CODE.sub("", text))
    if quantity != "acceleration":
        raise InputError(
            f"{key} = {text.strip()!r}: must be a unit of accelerations: g, m/s2, cm/s2 or gal"
        )
    return (values if times == over == 1 else values * times / over), base


def check_count(values: Values, stated: float, key: str) -> None:
    """Compare the number of samples with that of the header."""
    if values.size != stated:
        raise InputError(
            f"the file has {values.size} numbers where its header says {key} = {stated:g}"
        )


def check_peak(values: Values, stated: str | None, key: str) -> None:
    """Compare the largest sample with the peak of the header.

    A file that is damaged, or another dialect of its format, rarely passes.
    """
    if stated is None or not stated.strip():
        return
    peak = abs(header_number(key, stated, above=-math.inf))
    largest = float(np.abs(values).max())
    digits = len(stated.strip().partition(".")[2])
    if abs(largest - peak) > _PEAK * peak + 10.0**-digits:
        raise InputError(
            f"the largest sample is {largest:.6g} where the header says {key} = {stated.strip()}: "
            "the file is damaged, or of another version of its format"
        )
