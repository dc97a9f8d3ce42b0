"""Runs of a gradient: their scenes and motions, in the lanes of one sweep."""

from __future__ import annotations

import itertools
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._gradient.held_keys import (
    Parameter,
    changed_entries,
    is_given,
    value_of,
)
from rwmf._sweep import sweep
from rwmf._sweep.axes import Axis, Scene, grid_axis, key_of_column, name_axes, record_axis
from rwmf._sweep.intensity import find_quantities, refuse_missing
from rwmf._sweep.points import Points, point_axis
from rwmf._sweep.record_sets import RecordFile, find_records
from rwmf.case import Case, Motion
from rwmf.errors import InputError
from rwmf.quantities import ENDINGS

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


Array = npt.NDArray[np.float64]
_RTOL = "solver.rtol"


@dataclass(frozen=True)
class Request:
    """A run.

    Attributes
    ----------
    row : int
        Number of the scene.
    parameter : int
        Number of the parameter that changes; -1 for none.
    value : float
        Its value; for a whole list the mean.
    rtol : float
        Relative tolerance [-].
    """

    row: int
    parameter: int
    value: float
    rtol: float


class Lanes:
    """Runs with one changed parameter each.

    Attributes
    ----------
    values : numpy.ndarray, shape (rows, parameters)
        Values of the parameters; means of whole lists.
    n_quantities : int
        Number of quantities.
    runs : int
        Number of runs so far.
    """

    def __init__(
        self,
        scenes: Scenes,
        parameters: Sequence[Parameter],
        quantities: Sequence[str],
        threads: int,
    ) -> None:
        self.runs = 0
        self._parameters = parameters
        self._names = [next(iter(find_quantities((name,)))) for name in quantities]
        self.n_quantities = len(self._names)
        self._threads = threads
        numbers = {"rtol": 1e-9, "atol": None, "accuracy": None}
        self._case = scenes.case.replace(solver=numbers)
        self._rows = [dict(row) for row in scenes.rows]
        self.values = np.empty((len(self._rows), len(parameters)))
        # the other keys of a parameter without a column follow it, such as eta_alpha after eta_0
        self._has_column = [
            item.column in scenes.columns or (is_given(scenes.case, item) and not item.is_list)
            for item in parameters
        ]
        for number, row in enumerate(self._rows):
            case = scenes.case_of(number)
            for i, item in enumerate(parameters):
                if item.column in row:
                    self.values[number, i] = row[item.column]
                    continue
                found = value_of(case, item)
                chosen = found[item.element - 1] if item.element else found.mean()
                self.values[number, i] = chosen
                if self._has_column[i]:
                    row[item.column] = float(chosen)
        self._scenes = scenes

    def run(self, requests: Sequence[Request]) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Compute runs."""
        self.runs += len(requests)
        values = np.full((len(requests), len(self._names)), np.nan)
        fallen = np.zeros(len(requests), dtype=bool)
        # a column has one number a row: each change of a list needs another sweep. A default
        # that follows other keys has no column where these change
        groups: dict[tuple[int, float], list[int]] = {}
        for place, request in enumerate(requests):
            number = request.parameter
            label = (-1, 0.0)
            if number >= 0 and not self._has_column[number]:
                is_list = self._parameters[number].is_list
                label = (number, request.value if is_list else 0.0)
            groups.setdefault(label, []).append(place)
        for (number, value), places in groups.items():
            case = self._case
            if number >= 0 and self._parameters[number].is_list:
                item = self._parameters[number]
                case = case.replace(**changed_entries(case, item, value))
            table = self._table([requests[place] for place in places])
            found = sweep(case, points=table, quantities=self._names, threads=self._threads)
            refuse_missing(found, self._names, "quantities")
            for i, name in enumerate(self._names):
                values[places, i] = found[name].values
            names = found["status"].attrs["flag_meanings"].split()
            ends = [names.index(name) for name in ENDINGS if name in names]
            fallen[places] = np.isin(found["status"].values, ends)
        return values, fallen

    def _table(self, requests: Sequence[Request]) -> dict[str, list[Any]]:
        """Make the table of points of some runs."""
        table: dict[str, list[Any]] = {}
        for request in requests:
            row = self._rows[request.row] | {_RTOL: request.rtol}
            if request.parameter >= 0:
                item = self._parameters[request.parameter]
                if not item.is_list:
                    row[item.column] = request.value
            for name, value in row.items():
                table.setdefault(name, []).append(value)
        return table
