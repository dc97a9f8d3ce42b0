"""Runs of a gradient, in the lanes of one sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf._gradient.held_keys import (
    Parameter,
    changed_entries,
    is_given,
    value_of,
)
from rwmf._gradient.scenes import Scenes
from rwmf._sweep import sweep
from rwmf._sweep.kept_quantities import find_quantities, refuse_missing
from rwmf.quantities import ENDINGS

__all__ = ["Lanes", "Request"]

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
