"""Heights of a frame and its storeys."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rwmf.case.case import Case

__all__ = ["height_of_frame", "heights_of_storeys"]


def heights_of_storeys(case: Case, n: int) -> list[float]:
    """Return the height of each storey, from floor to floor; a frame without storeys has one."""
    if case.storeys is None:
        height = height_of_frame(case)
        return [] if height is None else [height]
    given = case.storeys.height
    return list(given) * (n if len(given) == 1 else 1)


def height_of_frame(case: Case) -> float | None:
    """Return the height of a frame with one degree of freedom."""
    if case.p_delta is not None and "h_f" in case.p_delta.given:
        return case.p_delta.h_f
    return None if case.wall is None else 2 * case.wall.h
