"""Numbers of the vertical elements of a case: one for all elements of a group, or one for each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    from rwmf.case.group import Group
    from rwmf.case.groups import Cable

__all__ = ["elements_of", "total"]


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
