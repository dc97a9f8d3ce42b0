"""Runs of designs over a suite, in the lanes of one sweep for many designs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf._design.targets import COLLAPSE, Target, Variable
from rwmf._sweep import sweep
from rwmf._sweep.kept_quantities import default_quantity, refuse_missing
from rwmf._sweep.plan import united
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case
from rwmf.quantities import ENDINGS

__all__ = ["SuiteRuns"]

Array = npt.NDArray[np.float64]
# utilisation above which its logarithm counts, and that of a design that collapses
_LARGE, _COLLAPSED = 10.0, 1e3


class SuiteRuns:
    """Values of the targets for designs; each design is computed once.

    Attributes
    ----------
    values : dict of tuple to numpy.ndarray, each shape (targets,)
        Values of the targets by design.
    """

    def __init__(
        self,
        case: Case,
        variables: Sequence[Variable],
        targets: Sequence[Target],
        records: Sequence[RecordFile],
        threads: int,
    ) -> None:
        self._case = case.without("spectrum") if "spectrum" in case.groups else case
        self._variables, self._targets = variables, targets
        self._records, self._threads = records, threads
        names = [item.quantity for item in targets if item.quantity != COLLAPSE]
        self._names = list(dict.fromkeys(names)) or [default_quantity(case)]
        self.values: dict[tuple[float, ...], Array] = {}
        self.warnings: list[str] = []

    def utilisations(self, designs: Array) -> Array:
        """Compute values over limits."""
        found = self.compute(designs)
        rows = np.array([
            [item.utilisation(float(x)) for item, x in zip(self._targets, row, strict=True)]
            for row in found
        ])  # fmt: skip
        larger = np.where(np.isfinite(rows), np.maximum(rows, _LARGE), _LARGE)
        limited: Array = np.minimum(rows, _LARGE) + np.log(larger / _LARGE)
        return np.where(np.isfinite(rows), limited, _COLLAPSED)

    def compute(self, designs: Array) -> Array:
        """Compute the values of the targets."""
        rows = [tuple(float(x) for x in row) for row in designs]
        missing = list(dict.fromkeys(row for row in rows if row not in self.values))
        if missing:
            for row, values in zip(missing, self._run(missing), strict=True):
                self.values[row] = values
        return np.array([self.values[row] for row in rows])

    def _run(self, designs: Sequence[tuple[float, ...]]) -> Array:
        scales = list(dict.fromkeys(item.scale for item in self._targets))
        table: dict[str, Any] = {
            item.column: [int(row[i]) if item.is_whole else row[i] for row in designs] * len(scales)
            for i, item in enumerate(self._variables)
        }
        table["scale"] = [scale for scale in scales for _ in designs]
        found = sweep(
            self._case,
            None,
            self._records,
            points=table,
            quantities=self._names,
            threads=self._threads,
        )
        refuse_missing(found, self._names, "targets")
        self.warnings = united([*self.warnings, *str(found.attrs["warnings"]).splitlines()])
        names = found["status"].attrs["flag_meanings"].split()
        ends = [names.index(name) for name in ENDINGS if name in names]
        shape = (-1, len(scales), len(designs))
        fallen = np.isin(found["status"].values, ends).reshape(shape)
        values = {name: found[name].values.reshape(shape) for name in self._names}
        results = np.empty((len(designs), len(self._targets)))
        for j, item in enumerate(self._targets):
            k = scales.index(item.scale)
            of = values.get(item.quantity, fallen.astype(float))
            for i in range(len(designs)):
                results[i, j] = item.value_of(of[:, k, i], fallen[:, k, i])
        return results
