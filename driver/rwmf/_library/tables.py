"""Version of the kernel and its tables of keys, groups and quantities."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.marshalling import encode, fetch_text, split_lines, split_table

__all__ = [
    "KeyRow",
    "digits_of",
    "instruction_set",
    "meant_quantity",
    "needs_of_groups",
    "quantities",
    "result_names",
    "schema",
    "strip_under",
    "unusual_record",
    "version",
]


@functools.cache
def version() -> str:
    """Return the version of the compiled kernel."""
    return fetch_text(_kernel.version)


def instruction_set() -> str:
    """Return the instruction set that spectra use on this processor."""
    return fetch_text(_kernel.instruction_set)


class KeyRow(NamedTuple):
    """A row of the kernel's table of keys.

    Attributes
    ----------
    group, key : str
        Names in the namelist.
    kind : str
        'real', 'integer', 'logical', 'choice', 'text' or '... list'.
    unit, default, allowed, meaning : str
        As in the reference of the namelist.
    usual : str
        Range in real buildings.
    gives : str
        Key of the group that may be left out when this one is given; empty for most keys.
    """

    group: str
    key: str
    kind: str
    unit: str
    default: str
    allowed: str
    meaning: str
    usual: str
    gives: str


@functools.cache
def schema() -> tuple[KeyRow, ...]:
    """Return the kernel's table of groups and keys."""
    return tuple(KeyRow(*cells) for cells in split_table(fetch_text(_kernel.schema)))


def needs_of_groups() -> dict[str, list[str]]:
    """Return the groups of a case, each with the groups that it requires."""
    rows = split_table(fetch_text(_kernel.groups))
    found: dict[str, list[str]] = {}
    for name, *needs in rows:
        found.setdefault(name, []).extend(needs)
    return found


def quantities() -> list[list[str]]:
    """Return the kernel's table of output quantities."""
    return split_table(fetch_text(_kernel.quantities))


def digits_of(rtol: float, sensitivity: float) -> int:
    """Count the digits of a peak that hold."""
    return int(_kernel.digits_of(rtol, sensitivity))


def strip_under(
    width: float,
    thickness: float,
    k: float,
    strength: float,
    normal: npt.NDArray[np.float64],
    phi: npt.NDArray[np.float64],
    found: npt.NDArray[np.float64],
) -> None:
    """Compute contact, toe stress, moment and settlement of a strip under a base."""
    _kernel.strip_under(width, thickness, k, strength, normal, phi, found)


def meant_quantity(word: str) -> str:
    """Find the quantity for a technical term or a misspelled key."""
    return fetch_text(_kernel.meant_quantity, encode(word[:80]))


def unusual_record(peak: float, interval: float, duration: float) -> str:
    """Return the warning about a record that is no earthquake in these units."""
    return fetch_text(_kernel.unusual_record, peak, interval, duration)


def result_names(source: str) -> list[str]:
    """Return the names of the files that the batch program may write for a case."""
    return split_lines(fetch_text(_kernel.result_names, encode(source)))
