"""Rows of a gradient: combinations of records, points and grid values, with labels."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from rwmf._sweep.axes import Axis, Scene, grid_axis, key_of_column, name_axes, record_axis
from rwmf._sweep.points import Points, point_axis
from rwmf._sweep.record_sets import RecordFile, find_records
from rwmf.case import Case, Motion
from rwmf.errors import InputError

__all__ = ["RECORD", "Scenes"]

RECORD = "record"


class Scenes:
    """Cases between which parameters do not change.

    Attributes
    ----------
    case : Case
        The case without its `&spectrum`.
    sizes : dict of str to int
        Sizes of the dimensions, slowest first.
    rows : list of dict
        Values by columns of a table, one dictionary a scene.
    columns : list of str
        The columns.
    """

    def __init__(
        self,
        case: Case,
        points: Points | None,
        grid: Mapping[str, object] | None,
        records: Sequence[str | os.PathLike[str] | RecordFile | Motion],
        unit: str | None,
        dt: float | None,
    ) -> None:
        self.case = case.without("spectrum") if "spectrum" in case.groups else case
        known = find_records(records, unit=unit, dt=dt) if len(records) else ()
        table = None if points is None else point_axis(points, known, unit, dt)
        named = table is not None and any(scene.record for scene in table.scenes)
        axes = [record_axis(known)] if len(known) and not named else []
        axes += [] if table is None else [table]
        axes += [grid_axis(name, values) for name, values in name_axes(grid or {}).items()]
        self._axes: list[Axis] = axes
        self.sizes = {axis.name: axis.size for axis in axes}
        keys = [key for axis in axes for key in axis.keys]
        twice = [key for key in keys if keys.count(key) > 1]
        if twice:
            raise InputError(f"grid and points: both set {'.'.join(twice[0])}")
        places = itertools.product(*(range(axis.size) for axis in axes))
        self.rows = [self._row(place) for place in places]
        self.columns = list(self.rows[0])
        self._cases: dict[int, Case] = {}

    def _row(self, place: tuple[int, ...]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for axis, position in zip(self._axes, place, strict=True):
            scene: Scene = axis.scene(position)
            if scene.record is not None:
                found[RECORD] = scene.record
            found |= {".".join(key): value for key, value in scene.settings}
            for name, values in axis.columns.items():
                found[name] = float(values[position])
        return found

    def case_of(self, number: int) -> Case:
        """Return the case of a row, with the motion of the common case."""
        if number not in self._cases:
            changes: dict[str, dict[str, object]] = {}
            for column, value in self.rows[number].items():
                group, key = key_of_column(column)
                scales = column in ("T_s", "gamma") and "storeys" in self.case.groups
                if column not in (RECORD, "scale") and not scales:
                    changes.setdefault(group, {})[key] = value
            self._cases[number] = self.case.replace(**changes) if changes else self.case
        return self._cases[number]

    def coordinates(self) -> dict[str, xr.DataArray]:
        """Label the dimensions."""
        return {
            item.name: xr.DataArray(
                np.asarray(
                    item.values
                    if isinstance(item.values, np.ndarray)
                    else [item.values[k] for k in axis.scene_of.tolist()]
                ),
                dims=item.dimension,
                attrs={"units": item.unit, "long_name": item.meaning}
                if item.unit
                else {"long_name": item.meaning},
            )
            for axis in self._axes
            for item in axis.coordinates
        }

    def index_of(self, name: str) -> int:
        """Return the position of a dimension."""
        if name not in self.sizes:
            raise InputError(f"statistic: there is no dimension {name}: give records=[...]")
        return list(self.sizes).index(name)
