"""Targets of a design, its variables and its cost; requests of cases and runs of the suite."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.kernel.numbers import show, to_array, to_items, to_number
from rwmf.kernel.progress import Progress
from rwmf.motion.record_sets import RecordFile
from rwmf.run.checks import Limit, limits_of
from rwmf.run.quantities import default_quantity, fallen, find_quantities, refuse_missing
from rwmf.sweeps.axes import PAIRS, SCALE, SETTINGS, column_in, key_of_column, kind_of
from rwmf.sweeps.computation import sweep
from rwmf.sweeps.plan import united
from rwmf.sweeps.sweep_file import located

# designs of the first stage without the group
DESIGNS = 300
_PERCENTILE = 84.0


def request_of(case: Case) -> dict[str, Any]:
    """Return the arguments of `rwmf.design` that `&design` of a case gives."""
    group = case.design
    found: dict[str, Any] = {"bounds": {}, "targets": (), "cost": {}, "records": ()}
    found |= {"left_out": None, "unit": None, "designs": DESIGNS}
    if group is None:
        return found
    names = group.parameters
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"parameters: {twice[0]}: is given twice")
    targets: list[dict[str, Any]] = []
    if case.limits is not None:
        share: dict[str, Any] = {"percentile": group.get("percentile", _PERCENTILE)}
        if "probability" in group:
            share = {"probability": group.probability}
        targets.append({"quantity": "limits"} | share)
    if "collapse_probability" in group:
        targets.append(
            {"quantity": "collapse", "probability": group.collapse_probability}
            | {"scale": group.collapse_scale}
        )
    folder = Path(case.source or "").parent
    # files or patterns of records, as seen from the current folder
    for name in ("records", "left_out"):
        if name in group:
            found[name] = tuple(located(folder, word) for word in getattr(group, name))
    return found | {
        "bounds": dict(zip(names, zip(group.low, group.high, strict=True), strict=True)),
        "targets": targets,
        "cost": dict(zip(names, group.cost, strict=True)),
        "unit": group.unit if "unit" in group else None,
        "designs": group.designs,
    }


Array = npt.NDArray[np.float64]
Cost = Mapping[str, float] | Callable[[dict[str, float]], float]
# word for overturning or collapse as the quantity of a target
COLLAPSE = "collapse"
# word for all limits of the case as the quantity of a target
_LIMITS = "limits"
_ALLOWED = ("quantity", "limit", "percentile", "probability", "scale")


@dataclass(frozen=True)
class Variable:
    """A number that the design chooses.

    Attributes
    ----------
    name : str
        Name in the request.
    column : str
        Column of a table of points.
    low, high : float
        Bounds, included.
    is_whole : bool
        True for whole numbers.
    """

    name: str
    column: str
    low: float
    high: float
    is_whole: bool


@dataclass(frozen=True)
class Target:
    """A limit of a design.

    Attributes
    ----------
    quantity : str
        Quantity of a sweep, or 'collapse'.
    limit : float
        Limit in its unit; NaN for a collapse.
    share : float
        Share of the records that must stay below the limit.
    scale : float
        Factor on the motions.
    is_least : bool
        True when the quantity must not be smaller than the limit.
    """

    quantity: str
    limit: float
    share: float
    scale: float
    is_least: bool = False

    @property
    def text(self) -> str:
        """The target in words."""
        sign = ">=" if self.is_least else "<="
        goal = f"{self.quantity} {sign} {self.limit:g}"
        goal = goal if self.quantity != COLLAPSE else "no collapse"
        factor = f", motions times {self.scale:g}" if self.scale != 1 else ""
        return f"{goal} in {100 * self.share:g} % of the motions{factor}"

    def value_of(self, values: Array, down: npt.NDArray[np.bool_]) -> float:
        """Return the quantile that the limit is for, or the share of collapses."""
        if self.quantity == COLLAPSE:
            return float(down.mean())
        # larger is worse; residuals have a sign
        ranked = np.where(down, np.inf, -values if self.is_least else np.abs(values))
        # a rank that round-off moves past the next whole number
        share = max(self.share - 1e-12, 0.0)
        worst = float(np.quantile(ranked, share, method="inverted_cdf"))
        return max(-worst, 0.0) if self.is_least else worst

    def utilisation(self, value: float) -> float:
        """Return value over limit: the target is met up to 1."""
        if self.quantity == COLLAPSE:
            return 1.0 + value - (1.0 - self.share) - 1e-12
        if self.is_least:
            return np.inf if value <= 0 else self.limit / value
        return value / self.limit


def variables_of(
    bounds: Mapping[str, Sequence[float]], case: Case, has_records: bool = False
) -> list[Variable]:
    """Look up the variables of a design."""
    if not isinstance(bounds, Mapping) or not bounds:
        raise InputError(
            f"bounds = {show(bounds)}: must be keys with (low, high); the default is &design"
        )
    columns = [column_in(case.groups, name, "bounds") for name in bounds]
    named = dict(zip(columns, bounds, strict=True))
    for name, column in zip(bounds, columns, strict=True):
        if named[column] != name:
            raise InputError(f"bounds: {name} and {named[column]}: are the same number")
    found = []
    for (name, ends), column in zip(bounds.items(), columns, strict=True):
        if column in PAIRS:
            raise InputError(f"bounds: {name}: is two keys; give {' and '.join(PAIRS[column])}")
        group, _ = key_of_column(column)
        if group in SETTINGS:
            raise InputError(
                f"bounds: {name}: {SETTINGS[group]}, no number of the structure or the motion"
            )
        if column == SCALE:
            raise InputError(f"bounds: {name}: is the factor on the motions, which targets have")
        if has_records and group == "motion":
            raise InputError(f"bounds: {name}: the records replace &motion")
        kind = kind_of(column)
        if kind not in ("real", "integer", "real list"):
            raise InputError(f"bounds: {name}: is a {kind}: a design chooses numbers")
        low, high = (float(end) for end in _two(name, ends))
        is_whole = kind == "integer"
        if not low < high or (is_whole and not (low.is_integer() and high.is_integer())):
            wanted = "two increasing whole numbers" if is_whole else "two increasing numbers"
            raise InputError(f"bounds: {name} = {show(ends)}: must be {wanted}")
        found.append(Variable(name, column, low, high, is_whole))
    return found


def _two(name: str, ends: object) -> Array:
    items = to_array(f"bounds: {name}", ends)
    if items.size != 2:
        raise InputError(f"bounds: {name} = {show(ends)}: must be (low, high)")
    return items


def targets_of(targets: Sequence[Mapping[str, Any]], case: Case) -> list[Target]:
    """Read the targets of a design."""
    items = [targets] if isinstance(targets, Mapping) else to_items(targets)
    if items is not None and not items:
        raise InputError(
            "targets: none is given: give quantity and limit; the default are &limits and &design"
        )
    if not items or not all(isinstance(item, Mapping) for item in items):
        raise InputError(f"targets = {show(targets)}: must be mappings with quantity and limit")
    limits = limits_of(case)
    return [target for item in items for target in _targets(item, limits)]


def _targets(item: Mapping[str, Any], limits: Sequence[Limit]) -> list[Target]:
    """Read one entry; that of all limits gives a target for each."""
    if item.get("quantity") != _LIMITS:
        return [_target(item)]
    if "limit" in item:
        raise InputError("targets: limits: has no limit; those of &limits apply")
    if not limits:
        raise InputError("targets: limits: the case has no &limits")
    found = [_target({**item, "quantity": x.key, "limit": x.value}) for x in limits]
    return [replace(target, is_least=x.is_least) for target, x in zip(found, limits, strict=True)]


def _target(item: Mapping[str, Any]) -> Target:
    unknown = [str(key) for key in item if key not in _ALLOWED]
    if unknown:
        raise InputError(f"targets: {unknown[0]}: unknown; allowed are {', '.join(_ALLOWED)}")
    quantity = item.get("quantity")
    if not isinstance(quantity, str):
        raise InputError(f"targets: quantity = {show(quantity)}: must be a text")
    if quantity == COLLAPSE and ("limit" in item or "percentile" in item):
        raise InputError("targets: collapse: has a probability only, no limit and no percentile")
    if ("percentile" in item) == ("probability" in item):
        raise InputError(f"targets: {quantity}: give one of percentile and probability")
    if "percentile" in item:
        share = to_number("targets: percentile", item["percentile"], above=0.0) / 100
    else:
        share = 1 - to_number("targets: probability", item["probability"], below=1.0)
    if not 0 < share <= 1:
        raise InputError(f"targets: {quantity}: percentile in (0, 100], probability in [0, 1)")
    scale = to_number("targets: scale", item.get("scale", 1.0), above=0.0)
    if quantity == COLLAPSE:
        return Target(COLLAPSE, math.nan, share, scale)
    name = next(iter(find_quantities((quantity,))))
    limit = to_number(f"targets: {quantity}: limit", item.get("limit"), above=0.0)
    return Target(name, limit, share, scale)


def cost_of(cost: Cost, variables: Sequence[Variable]) -> Callable[[Array], float]:
    """Make the cost of a design a function of its numbers."""
    names = [item.name for item in variables]
    if isinstance(cost, Mapping):
        unknown = [str(key) for key in cost if key not in names]
        if not cost:
            raise InputError(f"cost: has no weights; known: {', '.join(names)}")
        if unknown:
            raise InputError(
                f"cost: {', '.join(unknown)}: has no bounds; known: {', '.join(names)}"
            )
        weights = np.array([to_number(f"cost: {name}", cost.get(name, 0.0)) for name in names])
        return lambda x: float(weights @ x)
    if not callable(cost):
        raise InputError(f"cost = {show(cost)}: must be weights by key or a function")
    function = cost
    return lambda x: to_number("cost", function(dict(zip(names, x.tolist(), strict=True))))


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
        progress: Progress | None = None,
    ) -> None:
        self._progress = progress
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

        def report(done: int, total: int) -> None:
            if self._progress is not None:
                known = len(self.values)
                self._progress(known + len(designs) * done // total, known + len(designs))

        found = sweep(
            self._case,
            None,
            self._records,
            points=table,
            quantities=self._names,
            threads=self._threads,
            progress=report,
        )
        refuse_missing(found, self._names, "targets")
        self.warnings = united([*self.warnings, *str(found.attrs["warnings"]).splitlines()])
        shape = (-1, len(scales), len(designs))
        down = fallen(found).reshape(shape)
        values = {name: found[name].values.reshape(shape) for name in self._names}
        results = np.empty((len(designs), len(self._targets)))
        for j, item in enumerate(self._targets):
            k = scales.index(item.scale)
            of = values.get(item.quantity, down.astype(float))
            for i in range(len(designs)):
                results[i, j] = item.value_of(of[:, k, i], down[:, k, i])
        return results
