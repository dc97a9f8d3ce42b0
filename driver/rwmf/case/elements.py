"""Geometry of a case: heights of storeys, numbers of each vertical element."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from rwmf.case.case import Case
    from rwmf.case.group import Group
    from rwmf.case.groups import Cable


def elements_of(group: Group, *default: float) -> list[dict[str, Any]]:
    """Return the values of each element of a group; `default` are the offsets without `offset`."""
    offsets = group.get("offset", default)
    given = {"offset": offsets} | {key: group[key] for key in group if key != "offset"}
    n = len(cast("tuple[float, ...]", offsets))
    return [
        {
            key: value[i % len(value)] if isinstance(value, tuple) else value
            for key, value in given.items()
        }
        for i in range(n)
    ]


def total(cable: Cable, value: float | tuple[float, ...]) -> float:
    """Return the sum of a force over all tendons."""
    numbers = value if isinstance(value, tuple) else (value,)
    count = len(cable.offset) if "offset" in cable else 1
    return float(sum(numbers)) * count / len(numbers)


def heights_of_storeys(case: Case) -> list[float]:
    """Return the height of each storey, from floor to floor; a frame without storeys has one."""
    if case.storeys is not None:
        return list(case.storeys.height)
    height = height_of_frame(case)
    return [] if height is None else [height]


def heights_of_floors(case: Case) -> list[float]:
    """Return the height of each floor above the base."""
    return list(accumulate(heights_of_storeys(case)))


def height_of_frame(case: Case) -> float | None:
    """Return the height of a frame with one degree of freedom."""
    if case.p_delta is not None and "h_f" in case.p_delta.given:
        return case.p_delta.h_f
    return None if case.wall is None else 2 * case.wall.h
