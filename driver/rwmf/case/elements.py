"""Numbers of the vertical elements of a case: one for all elements of a group, or one for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rwmf.errors import InputError

if TYPE_CHECKING:
    from rwmf.case.groups import Cable

__all__ = ["single", "total"]


def single(name: str, value: float | tuple[float, ...]) -> float:
    """Return the number that all elements of a group share; refuse different numbers."""
    numbers = value if isinstance(value, tuple) else (value,)
    if len(set(numbers)) > 1:
        raise InputError(f"{name}: {', '.join(map(str, numbers))}: must be one number here")
    return float(numbers[0])


def total(cable: Cable, value: float | tuple[float, ...]) -> float:
    """Return the sum of a force over all tendons."""
    numbers = value if isinstance(value, tuple) else (value,)
    count = len(cable.offset) if "offset" in cable else 1
    return float(sum(numbers)) * count / len(numbers)
