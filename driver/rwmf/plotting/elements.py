"""Walls side by side and their elements as lines of a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.case.elements import elements_of

# drawn gap between walls, and distance of a column beside a held point, over half the width
_GAP = 0.6
# heights of couplings over that of the wall, without storeys
_SHARES = (0.2, 0.4, 0.6, 0.8)
# colours by their numbers
COLOURS_OF = {"cable": 2, "fuse": 4, "damper": 3, "inerter": 5, "coupling": 4, "restraint": 3}


@dataclass(frozen=True)
class Line:
    """An element, or a part of one, between two points.

    Attributes
    ----------
    kind : str
        Group of the element; 'column' for the support of a restraint.
    ends : tuple
        Of each end the number of the wall that it moves with, or -1 for the ground, and its
        coordinates from the axis of this wall or from that of the first [m].
    """

    kind: str
    ends: tuple[tuple[int, float, float], tuple[int, float, float]]


def axes_of(case: Case) -> list[float]:
    """Return the places of the axes of all walls, as drawn [m]."""
    if case.wall is None:
        return []
    span = 0.0 if case.coupling is None else case.coupling.span
    spacing = 2 * case.wall.b + max(span, _GAP * case.wall.b)
    return [i * spacing for i in range(case.wall.walls)]


def lines_of(case: Case) -> list[Line]:
    """Return the lines of all elements of a case."""
    if case.wall is None:
        return []
    axes, b, top = axes_of(case), case.wall.b, 2 * case.wall.h
    found = []
    for i, axis in enumerate(axes):
        for kind, d, z in _standing(case):
            found.append(Line(kind, ((-1, axis + d, 0.0), (i, d, z))))
    if case.coupling is not None:
        levels = np.array(_SHARES) * top
        if case.storeys is not None:
            levels = np.cumsum(np.broadcast_to(case.storeys.height, len(case.storeys.m_over_m_w)))
        found += [
            Line("coupling", ((i, b, float(z)), (i + 1, -b, float(z))))
            for i in range(len(axes) - 1)
            for z in levels
        ]
    if case.restraint is not None:
        for item in elements_of(case.restraint):
            d, z = item["offset"], item["height"]
            side = math.copysign(1.0, d)
            i = len(axes) - 1 if d > 0 else 0
            column = axes[i] + d + side * _GAP * b
            found += [
                Line("restraint", ((i, d, z), (-1, column, z))),
                Line("column", ((-1, column, 0.0), (-1, column, z))),
            ]
            if abs(d) > b:
                found.append(Line("arm", ((i, side * b, z), (i, d, z))))
    return found


def outermost(case: Case) -> npt.NDArray[np.float64]:
    """Return the ends of walls and columns to the left and to the right [m]."""
    axes, b = axes_of(case), case.wall.b
    at = [x for line in lines_of(case) for number, x, _ in line.ends if number < 0]
    return np.array([min([-b, *at]), max([axes[-1] + b, *at])])


def _standing(case: Case) -> list[tuple[str, float, float]]:
    """Return kind, offset and upper height of the elements that stand on the ground."""
    b, found = case.wall.b, []
    if case.cable is not None:
        for item in elements_of(case.cable, 0.0):
            found.append(("cable", item["offset"], item.get("height", 2 * case.wall.h)))
    for name in ("fuse", "damper", "nl_damper", "inerter"):
        group = getattr(case, name)
        if group is not None:
            kind = name.removeprefix("nl_")
            found += [(kind, item["offset"], 0.0) for item in elements_of(group, -b, b)]
    return found
