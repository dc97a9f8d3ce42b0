"""Edits of a case that change numbers only, which the kernel makes without text."""

from __future__ import annotations

import functools
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._numbers import is_whole, to_array, to_number
from rwmf.errors import InputError

__all__ = ["numbers_of"]


def numbers_of(
    groups: Mapping[str, object],
) -> tuple[_library.Changes, npt.NDArray[np.float64]] | None:
    """Split an edit into keys and numbers."""
    kinds = _kinds()
    names: list[str] = []
    values: list[npt.NDArray[np.float64]] = []
    for group, changes in groups.items():
        if not isinstance(changes, Mapping) or not changes:
            return None
        for key, value in changes.items():
            name = f"{group}.{key}".lower()
            found = _numbers(name, kinds.get(name, ""), value)
            if found is None or name in names:
                return None
            names.append(name)
            values.append(found)
    sizes = tuple(array.size for array in values)
    numbers = np.concatenate(values) if values else np.zeros(0)
    return _library.Changes(tuple(names), sizes), numbers


def _numbers(name: str, kind: str, value: object) -> npt.NDArray[np.float64] | None:
    """Return the value of a key as numbers; no numbers for None, which removes the key."""
    if value is None and kind:
        return np.zeros(0)
    try:
        if kind == "real list":
            return to_array(name, value, least=1)
        if kind == "logical" and isinstance(value, bool | np.bool_):
            return np.array([value], dtype=np.float64)
        if kind == "real" or (kind == "integer" and is_whole(value)):
            return np.array([to_number(name, value)])
    except InputError:
        # the parser of the whole text gives the message
        return None
    return None


@functools.cache
def _kinds() -> dict[str, str]:
    """Return the type of each key by ``group.key`` in lower case."""
    return {f"{row.group}.{row.key}".lower(): row.kind for row in _library.schema()}
