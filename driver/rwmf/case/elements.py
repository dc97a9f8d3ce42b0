"""Numbers of the vertical elements of a case: one for all elements of a group, or one for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rwmf.errors import InputError

if TYPE_CHECKING:
    from rwmf.case.groups import Cable

__all__ = ["each", "single", "total"]


def each(value: float | tuple[float, ...], n: int) -> list[float]:
    """Return the numbers of n elements."""
    numbers = value if isinstance(value, tuple) else (value,)
    return [float(number) for number in numbers] * (n // len(numbers))


def single(name: str, value: float | tuple[float, ...]) -> float:
    """Return the number that all elements of a group share; refuse different numbers."""
    numbers = value if isinstance(value, tuple) else (value,)
    if len(set(numbers)) > 1:
        raise InputError(f"{name}: {', '.join(map(str, numbers))}: must be one number here")
    return float(numbers[0])


def total(cable: Cable, value: float | tuple[float, ...]) -> float:
    """Return the sum of a force over all tendons."""
    return sum(each(value, len(cable.offset) if "offset" in cable else 1))
