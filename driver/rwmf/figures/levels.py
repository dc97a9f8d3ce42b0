"""Levels of a frame or its storeys, walls side by side, and elements as lines of a picture."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.case.elements import elements_of, height_of_frame
from rwmf.figures.styles import LIMIT, YIELD
from rwmf.kernel.numbers import Array

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


# kappa of a rectangular section [-]
_SHEAR_FACTOR = 5 / 6


def mode_shapes(case: Case, share: npt.ArrayLike) -> Array:
    """Compute the deflections of the modes of a wall at heights."""
    x = np.asarray(share, dtype=float)
    modes = 0 if case.bending is None else int(case.bending.modes)
    columns = [_shape(number, _shear_flexibility(case), x) for number in range(1, modes + 1)]
    return np.stack(columns, axis=-1) if columns else np.empty((x.size, 0))


def _shear_flexibility(case: Case) -> float:
    """Return EI/(kappa G A L**2) [-], 0 without shear."""
    if "nu" not in case.bending:
        return 0.0
    # without E the stiffness contains the cracking; the kernel takes 1
    share = case.bending.cracking if "E" in case.bending.given else 1.0
    slenderness = float(case.wall.b / case.wall.h)
    return float(share) * slenderness**2 * (1 + float(case.bending.nu)) / (6 * _SHEAR_FACTOR)


def _shape(number: int, epsilon: float, x: Array) -> Array:
    """Compute one mode; growing exponentials are written from the tip."""
    c = _wave_number(number, epsilon)
    a = c / math.sqrt(1 + epsilon * c * c)
    decay = math.exp(-a)
    # bending moment and shear vanish at the tip
    cosine_end, sine_end = (a / c) ** 2 * math.cos(c), c / a * math.sin(c)

    def deflection(at: npt.ArrayLike) -> Array:
        z = np.asarray(at, dtype=float)
        return (
            (sine_end - cosine_end - decay) * np.exp(a * (z - 1))
            + (1 + decay * (sine_end + cosine_end)) * np.exp(-a * z)
            - (1 - decay**2 + 2 * decay * sine_end) * np.cos(c * z)
            + (c / a) ** 3 * (1 + decay**2 + 2 * decay * cosine_end) * np.sin(c * z)
        )

    return deflection(x) / deflection(1.0)


def _wave_number(number: int, epsilon: float) -> float:
    """Find the root of the frequency equation between (number - 1) pi and number pi [-]."""
    low, high = (number - 1) * math.pi, number * math.pi
    while low < (c := (low + high) / 2) < high:
        ratio = math.sqrt(1 + epsilon * c * c)
        decay = math.exp(-c / ratio)
        value = (
            2 * decay
            + (1 + decay**2) / 2 * math.cos(c) * (ratio**2 + 1 / ratio**2)
            - (1 - decay**2) / 2 * math.sin(c) * (ratio - 1 / ratio)
        )
        low, high = (c, high) if (value > 0) == (number % 2 == 1) else (low, c)
    return c


# a level is drawn up to this multiple of the largest value
_IN_REACH = 1.5


@dataclass(frozen=True)
class Levels:
    """Levels of drift or displacement, one per storey.

    Attributes
    ----------
    first_yield : numpy.ndarray, shape (n,) or (0,)
        Levels of first yield; empty for a linear frame.
    limit : numpy.ndarray, shape (n,) or (0,)
        Levels of collapse; empty without a limit.
    """

    first_yield: Array
    limit: Array


def levels_of_storeys(dataset: xr.Dataset, case: Case, n: int) -> Levels:
    """Determine the levels of the storeys' drifts."""
    law = case.yielding
    first: Array = np.empty(0)
    # given, or derived from forces, whichever key the case uses
    if law is not None and "storey_u_y" in law:
        first = np.broadcast_to(law.storey_u_y, n) / case.storeys.height
    elif law is not None:
        # storeys of one spring share its ductility
        largest = [float(dataset[f"storey_{i + 1}_drift_max"]) for i in range(n)]
        first = np.array(largest) * _first_share(dataset)
    return _with_limits(first, case, n, 1.0)


def levels_of_frame(dataset: xr.Dataset, case: Case) -> Levels:
    """Determine the levels of displacement for a frame with one degree of freedom."""
    first: Array = np.empty(0)
    if case.yielding is not None:
        first = np.array([float(dataset["u_s_max"]) * _first_share(dataset)])
    return _with_limits(first, case, 1, height_of_frame(case) or np.nan)


def _first_share(dataset: xr.Dataset) -> float:
    """Return first yield over the largest displacement; NaN without displacement."""
    ductility = float(dataset["ductility"])
    return 1 / ductility if ductility > 0 else np.nan


def _with_limits(first: Array, case: Case, n: int, height: float) -> Levels:
    """Return levels with the smaller limit of drift and ductility."""
    limits = np.full(n, np.inf)
    if case.p_delta is not None:
        limits = np.minimum(limits, float(case.p_delta.drift_limit) * height)
    if first.size and "ultimate" in case.yielding:
        limits = np.minimum(limits, first * float(case.yielding.ultimate))
    return Levels(first[np.isfinite(first)], limits[np.isfinite(limits)])


def draw_levels(ax: Axes, levels: Levels, factor: float, unit: str) -> None:
    """Draw labelled levels on both sides of zero behind the lines of axes."""
    from matplotlib.lines import Line2D

    lines = []
    largest = max(
        (np.nanmax(np.abs(line.get_ydata()), initial=0.0) for line in ax.lines), default=0
    )
    for name, values, line_style in (
        ("yield", levels.first_yield, YIELD),
        ("limit", levels.limit, LIMIT),
    ):
        sizes = np.unique((factor * values).round(9))
        if not sizes.size:
            continue
        ends = " to ".join(f"{size:.3g}" for size in sorted({sizes[0], sizes[-1]}))
        lines.append(Line2D([], [], label=f"{name} {ends} {unit}", **line_style))
        if sizes[0] > _IN_REACH * largest:
            continue
        for size in {sizes[0], sizes[-1], -sizes[0], -sizes[-1]}:
            ax.axhline(size, **line_style)
    if lines:
        legend = ax.legend(
            handles=lines, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderpad=0.0
        )
        # added directly, so that another legend does not replace it; not clipped
        ax.add_artist(legend)
        legend.set_clip_on(False)


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
            levels = np.cumsum(case.storeys.height)
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


def outermost(case: Case) -> Array:
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
