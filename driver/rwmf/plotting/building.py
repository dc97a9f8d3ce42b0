"""Frame in a film: floor positions, yielded storeys, and lines."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.case.grid import height_of_frame
from rwmf.plotting.levels import levels_of_frame, levels_of_storeys
from rwmf.plotting.response import members
from rwmf.plotting.style import COLOURS, INK

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


Array = npt.NDArray[np.float64]

# points along a column
_COLUMN = np.linspace(0.0, 1.0, 12)
# shape of a column, clamped at the foot and guided at the floor above
_BENT = 3 * _COLUMN**2 - 2 * _COLUMN**3
# separator between parts of a line
_GAP = np.array([[np.nan, np.nan]])
# height of a drawn frame when the case gives none [m]
_NOMINAL = 3.0


@dataclass(frozen=True)
class Building:
    """Floors of a frame over time.

    Attributes
    ----------
    levels : numpy.ndarray, shape (n,)
        Heights of the floors above the ground [m].
    sway : numpy.ndarray, shape (n, times)
        Displacements of the floors, relative to the ground [m].
    has_yielded : numpy.ndarray of bool, shape (n, times)
        True from the first yield of the storey below each floor.
    linked : numpy.ndarray of bool, shape (n,)
        True for a floor linked to the wall.
    """

    levels: Array
    sway: Array
    has_yielded: npt.NDArray[np.bool_]
    linked: npt.NDArray[np.bool_]

    @property
    def angles(self) -> Array:
        """Storey drifts over storey heights, shape (n, times) [rad]."""
        heights = np.diff(self.levels, prepend=0.0)
        drifts: Array = np.diff(self.sway, axis=0, prepend=0.0) / heights[:, np.newaxis]
        return drifts


def find_building(case: Case, dataset: xr.Dataset) -> Building | None:
    """Find the floors of a case."""
    if case.frame is None:
        return None
    if case.storeys is None:
        levels = np.array([(2 * case.wall.h if case.wall else height_of_frame(case)) or _NOMINAL])
        drifts = dataset["u_s"].values[np.newaxis]
        first, heights = levels_of_frame(dataset, case).first_yield, np.ones(1)
    else:
        drifts = np.array([dataset[name].values for name in members(dataset, "storey_{i}_drift")])
        heights = np.broadcast_to(np.array(case.storeys.height, dtype=float), len(drifts))
        levels = np.cumsum(heights)
        first = levels_of_storeys(dataset, case, len(drifts)).first_yield
    sway = np.cumsum(drifts * heights[:, np.newaxis], axis=0)
    has_yielded = np.zeros(drifts.shape, dtype=bool)
    if first.size == len(drifts):
        beyond = np.abs(drifts) > first[:, np.newaxis]
        has_yielded = np.logical_or.accumulate(beyond, axis=1)
    linked = np.full(levels.size, case.wall is not None)
    if case.storeys is None or case.storeys.coupling not in ("every_floor", "springs"):
        linked[:-1] = False
    return Building(levels, sway, has_yielded, linked)


class BuildingLines:
    """Columns, floors, hinges and links of a frame with one bay."""

    def __init__(self, ax: Axes, building: Building, feet: Array, sway: Array) -> None:
        self._building, self._feet, self._sway = building, feet, sway
        (self._columns,) = ax.plot([], [], color=COLOURS[0], linewidth=2.0)
        (self._yielded,) = ax.plot([], [], color=COLOURS[1], linewidth=2.0)
        (self._floors,) = ax.plot([], [], color=COLOURS[0], linewidth=3.0, solid_capstyle="round")
        (self._hinges,) = ax.plot([], [], "o", color=COLOURS[1], markersize=4.5, zorder=4)
        (self._links,) = ax.plot([], [], "o-", color=INK, linewidth=0.9, markersize=2.5)

    def move(self, i: int, ground: float, face: Array | None) -> None:
        """Draw the frame at a sample."""
        building = self._building
        x = ground + np.concatenate(([0.0], self._sway[:, i]))
        z = np.concatenate(([0.0], building.levels))
        left, right = self._feet
        columns: tuple[list[Array], list[Array]] = ([], [])
        hinges: list[Array] = []
        for k, yields in enumerate(building.has_yielded[:, i]):
            column_axis = np.stack(
                (x[k] + (x[k + 1] - x[k]) * _BENT, z[k] + (z[k + 1] - z[k]) * _COLUMN), axis=1
            )
            for foot in (left, right):
                column = column_axis + np.array([foot, 0.0])
                columns[int(yields)].extend((column, _GAP))
                hinges.extend([column[[1, -2]]] if yields else [])
        for line, parts in ((self._columns, columns[0]), (self._yielded, columns[1])):
            line.set_data(*_joined(parts))
        self._hinges.set_data(*_joined(hinges))
        ends = [
            np.array([[left + u, h], [right + u, h]]) for u, h in zip(x[1:], z[1:], strict=True)
        ]
        self._floors.set_data(*_joined([part for end in ends for part in (end, _GAP)]))
        if face is not None:
            along = np.linspace(0.0, z[-1], len(face))
            links = [
                part
                for end, is_linked in zip(ends, building.linked, strict=True)
                if is_linked
                for part in (end[1:], _at_height(face, along, end[1, 1]), _GAP)
            ]
            self._links.set_data(*_joined(links))


def _at_height(face: Array, along: Array, height: float) -> Array:
    """Return the point of a face at a height along the wall [m], shape (1, 2)."""
    return np.array([[np.interp(height, along, values) for values in face.T]])


def _joined(parts: list[Array]) -> Array:
    """Join the points of several parts into one line; shape (2, points)."""
    return np.concatenate(parts).T if parts else np.empty((2, 0))
