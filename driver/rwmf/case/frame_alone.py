"""Edit of a case that removes the wall and keeps the frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from rwmf import _library

if TYPE_CHECKING:
    from rwmf.case.case import Case

__all__ = ["changes_without_wall", "groups_of_wall"]


def changes_without_wall(case: Case) -> dict[str, dict[str, object] | None]:
    """Return the changes that remove the wall."""
    found: dict[str, dict[str, object] | None] = {
        name: None for name in case.groups if name in groups_of_wall()
    }
    heights = _heights_of_wall(case, found)
    if "spectrum" in case.groups:
        found["spectrum"] = {"gamma": None, "b": None}
    if "output" in case.groups:
        found["output"] = {"friction_limit": None}
    return found | _free_floors(case) | heights | {"frame": {"gamma": None}}


def _free_floors(case: Case) -> dict[str, dict[str, object]]:
    """Choose the modes of storeys without a wall that every floor is linked to."""
    if case.storeys is not None and case.storeys.coupling == "springs":
        return {"storeys": {"coupling": "full", "k_link_over_m_w": None, "k_link": None}}
    if case.storeys is None or case.storeys.coupling != "every_floor":
        return {}
    one_by_one = case.yielding is not None and "storey_u_y" in case.yielding
    return {"storeys": {"coupling": "full" if one_by_one else "reduced"}}


def _heights_of_wall(case: Case, gone: Mapping[str, object]) -> dict[str, dict[str, object]]:
    """Return the keys that default to 2h; storeys have individual heights."""
    if case.wall is None or "storeys" in case.groups:
        return {}
    return {
        row.group: {row.key: 2 * case.wall.h}
        for row in _library.schema()
        if row.default == "2h" and row.group in case.groups and row.group not in gone
        if row.key not in case.groups[row.group].given
    }


def groups_of_wall() -> set[str]:
    """Return the wall and the groups that require it."""
    return {name for name, needs in _library.needs_of_groups().items() if {name, *needs} & {"wall"}}
