"""Runs of a gradient in the lanes of one sweep: scenes, steps between them, statistics."""

from __future__ import annotations

import itertools
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from rwmf.case import Case, Motion
from rwmf.errors import InputError, without_lines
from rwmf.kernel import tables
from rwmf.kernel.numbers import Array, Truths, float_of, show
from rwmf.kernel.progress import Progress
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.run.quantities import fallen, find_quantities, refuse_missing
from rwmf.run.simulation import NO_ACCURACY
from rwmf.sweeps.axes import (
    SCALE,
    SETTINGS,
    Axis,
    Scene,
    column_in,
    grid_axis,
    key_of_column,
    kind_of,
    name_axes,
    record_axis,
)
from rwmf.sweeps.computation import sweep
from rwmf.sweeps.points import Points, point_axis

# relative steps of the central differences; one-sided differences add half the smallest
NEAR = (2e-4, 1e-4, 5e-5)
# lanes of a central derivative
LANES = 2 * len(NEAR)
# relative changes at which the linear prediction is tried
FAR = (1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3)
# the error of a linear prediction over the change, up to which a derivative is valid
_VALID = 0.1
# part of a line between two lanes that is used, because the share may grow faster at first
_CAUTION = 0.9
# quotients of two lanes that follow one another are a kink above, a curvature at 1/2
_SAME = 0.8


@dataclass(frozen=True)
class Estimate:
    """A derivative from the lanes of one step.

    Attributes
    ----------
    derivative : float
        Derivative with respect to the relative change.
    spread : float
        Disagreement of the differences, which a smooth function without round-off does not have.
    jump : float
        Difference of the slopes on both sides; 0 for one-sided differences.
    is_kink : bool
        True when the slopes on both sides differ as much at half the step.
    """

    derivative: float
    spread: float
    jump: float
    is_kink: bool


def offsets_of(sides: tuple[bool, bool], factor: float = 1.0) -> Array:
    """Return the relative changes of the lanes for one derivative."""
    if all(sides):
        return factor * np.array([sign * step for step in NEAR for sign in (1.0, -1.0)])
    sign = 1.0 if sides[1] else -1.0
    return factor * sign * np.array([*NEAR, NEAR[-1] / 2])


def derivative_at(offsets: Array, values: Array, centre: float) -> Estimate:
    """Compute a derivative by Richardson steps."""
    with np.errstate(invalid="ignore"):
        # values may be infinite
        slopes = (values - centre) / offsets
    if offsets.size < LANES:
        linear = 2 * slopes[1:] - slopes[:-1]
        jump, twice = 0.0, 0.0
    else:
        jumps = slopes[::2] - slopes[1::2]
        jump, twice = float(jumps[2]), float(jumps[1])
        linear = (slopes[::2] + slopes[1::2]) / 2
    # two Richardson steps: the one with the larger steps has less round-off
    large, small = (4 * linear[1:] - linear[:-1]) / 3
    # curvature halves the jump with the step
    spread = max(abs(small - large), abs(jump - twice / 2))
    is_kink = _SAME * abs(twice) < abs(jump) < abs(twice) / _SAME
    return Estimate(float(large), float(spread), jump, is_kink)


def resolution(values: Array) -> float:
    """Return the smallest difference that values can have."""
    kept = values[np.isfinite(values) & (values != 0)]
    if kept.size == 0 or (kept == kept[0]).all():
        return 0.0
    mantissas, exponents = np.frexp(kept)
    whole = (mantissas * 2.0**53).astype(np.int64)
    # the lowest bit of a whole number
    return float((np.ldexp(1.0, exponents - 53) * (whole & -whole)).min())


def valid_range(offsets: Array, changes: Array, derivative: float, floor: float) -> float:
    """Find the largest relative change up to which a linear prediction holds on every side."""
    if not np.isfinite(derivative):
        return 0.0
    predicted = derivative * offsets
    wrong = np.abs(changes - predicted)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(wrong <= floor, 0.0, wrong / np.minimum(abs(changes), abs(predicted)))
    share = np.where(np.isnan(share), np.inf, share)
    ends = []
    for side in (offsets > 0, offsets < 0):
        if side.any():
            order = np.argsort(abs(offsets[side]))
            ends.append(_first_end(abs(offsets[side])[order], share[side][order]))
    return min(ends)


def _first_end(steps: Array, share: Array) -> float:
    """Return the step at which the share first exceeds the limit, between two lanes by a line."""
    above = np.flatnonzero(share > _VALID)
    if above.size == 0:
        return float(steps[-1])
    i = int(above[0])
    if i == 0:
        return 0.0
    if not np.isfinite(share[i]):
        return float(steps[i - 1])
    part = _CAUTION * (_VALID - share[i - 1]) / (share[i] - share[i - 1])
    return float(steps[i - 1] + part * (steps[i] - steps[i - 1]))


# an element of a list, as in a namelist: storey_F_y(2)
_ELEMENT = re.compile(r"(.+)\((\d+)\)")


@dataclass(frozen=True)
class Parameter:
    """A number of the case.

    Attributes
    ----------
    name : str
        Name in the request.
    column : str
        Column of a table of points.
    element : int
        Number of the element of a list, from 1; 0 for a number or a whole list.
    is_list : bool
        True where the numbers of a list change, which no column of a table can.
    """

    name: str
    column: str
    element: int = 0
    is_list: bool = False

    @property
    def key(self) -> tuple[str, str]:
        """Group and key."""
        return key_of_column(self.column)

    @property
    def unit(self) -> str:
        """Unit of the number."""
        if self.column == SCALE:
            return "1"
        return tables.rows_of_keys()[self.key].unit.replace("-", "1")


def find_parameters(
    case: Case, names: Sequence[str], columns: Sequence[str] = ()
) -> list[Parameter]:
    """Look up the parameters of a request."""
    if not names:
        raise InputError("parameters: none is given")
    found = [_find(case, name, columns) for name in names]
    taken: dict[tuple[str, int], str] = {}
    for item in found:
        same = taken.setdefault((item.column, item.element), item.name)
        if same is not item.name or list(names).count(item.name) > 1:
            raise InputError(f"parameters: {same} and {item.name}: are the same number")
    return found


def _find(case: Case, name: str, columns: Sequence[str]) -> Parameter:
    part = _ELEMENT.fullmatch(name.strip())
    word, element = (part[1].strip(), int(part[2])) if part else (name.strip(), 0)
    physics = {group: keys for group, keys in case.groups.items() if group not in SETTINGS}
    column = column_in(physics, word, "parameters")
    kind = kind_of(column)
    if kind not in ("real", "real list"):
        wanted = "whole number" if kind.startswith("integer") else kind.removesuffix(" list")
        raise InputError(f"parameters: {name}: is a {wanted}: a derivative needs a real number")
    has_records = "record" in columns
    if column == SCALE and not has_records and "scale" in (case.motion or {}):
        column = "motion.scale"
    item = Parameter(name, column, element)
    reason = SETTINGS.get(item.key[0])
    if reason and item.key != ("solver", "t_end"):
        raise InputError(f"parameters: {name}: {reason}, no number of the structure or the motion")
    if has_records and item.key[0] == "motion" and column != SCALE:
        raise InputError(f"parameters: {name}: the records replace &motion: use scale")
    if column in columns:
        return item
    numbers = value_of(case, item)
    is_list = numbers.size > 1
    takes_list = is_list or kind == "real list"
    if element and not (takes_list and 1 <= element <= numbers.size):
        size = f"has {numbers.size} number{'s' * is_list}" if takes_list else "is no list"
        raise InputError(f"parameters: {name}: {word} {size}")
    return Parameter(name, column, element if is_list else 0, is_list)


def value_of(case: Case, item: Parameter) -> Array:
    """Return the value of a parameter in a case."""
    if item.column == SCALE:
        return np.ones(1)
    name, key = item.key
    group = case.groups.get(name)
    axes = case.kernel.axes()
    if item.column in axes and (group is None or key not in group or key in group.derived):
        value = axes[item.column].value
        if value is not None and "storeys" in case.groups:
            # period and mass ratio of storeys scale all stiffnesses and masses
            return np.array([value])
    if group is None:
        raise InputError(
            f"parameters: {item.name}: the case has no &{name}, so nothing depends on {key}; add "
            f"the group, with {key} = 0 where that is allowed"
        )
    givers = ", ".join(_givers(case, name, key) or sorted(group.given))
    if key not in group:
        raise InputError(
            f"parameters: {item.name}: has no value in this case, whose &{name} gives {givers}"
        )
    if key in group.derived:
        raise InputError(
            f"parameters: {item.name}: follows from the given keys of &{name}: use one of {givers}"
        )
    given = group.as_given()
    # a list given as one number for all stays one number
    return np.atleast_1d(np.asarray(given.get(key, group[key]), dtype=np.float64))


def is_given(case: Case, item: Parameter) -> bool:
    """Return whether the case states a parameter, so that no other key changes it."""
    name, key = item.key
    return item.column == SCALE or key in getattr(case.groups.get(name), "given", ())


def _givers(case: Case, group: str, key: str) -> list[str]:
    """List the given keys that replace a key."""
    given = case.groups[group].given
    return [row.key for row in tables.schema()
            if row.group == group and row.gives == key and row.key in given]  # fmt: skip


def scale_of(item: Parameter, value: float) -> float:
    """Return the change of a parameter that counts as one."""
    if value != 0:
        return abs(value)
    ends = re.findall(
        r"[-+.\deE]+", "" if item.column == SCALE else tables.rows_of_keys()[item.key].usual
    )
    if len(ends) != 2:
        return 1.0
    return math.sqrt(float(ends[0]) * float(ends[1]))


def allowed_changes(case: Case, item: Parameter, value: float, scale: float) -> dict[bool, float]:
    """Find the allowed decrease and increase of a parameter."""
    found: dict[bool, float] = {}
    reasons: list[str] = []
    for is_up in (False, True):
        found[is_up] = 0.0
        for change in (*FAR[::-1], NEAR[0]):
            other = _accepted(case, item, value + (change if is_up else -change) * scale)
            if not isinstance(other, str):
                found[is_up] = change
                break
        if isinstance(other, str):
            reasons.append(other)
    if not any(found.values()):
        # beside a bound, the other side has the reason
        text = min(reasons, key=lambda reason: "must be a number" in reason)
        raise InputError(f"parameters: {item.name} = {show(value)} cannot change: {text}")
    return found


def _accepted(case: Case, item: Parameter, value: float) -> Case | str:
    """Return the case with this value, or the kernel's message if it refuses the value."""
    if item.column == SCALE:
        return case
    try:
        return case.replace(**changed_entries(case, item, value))
    except InputError as error:
        text = without_lines(str(error))
        if "storeys" in case.groups and item.column in ("T_s", "gamma"):
            # only a sweep scales storeys; these have no other bound than zero
            return case if value > 0 else text
        return text


def changed_entries(case: Case, item: Parameter, value: float) -> Mapping[str, dict[str, object]]:
    """Return the groups that give a parameter another value."""
    name, key = item.key
    if not item.is_list:
        is_list = tables.rows_of_keys()[item.key].kind.endswith("list")
        return {name: {key: [value] if is_list else value}}
    numbers = value_of(case, item)
    if item.element:
        numbers[item.element - 1] = value
    else:
        numbers *= value / numbers.mean()
    return {name: {key: numbers.tolist()}}


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
                attrs=item.attributes,
            )
            for axis in self._axes
            for item in axis.coordinates
        }

    def index_of(self, name: str) -> int:
        """Return the position of a dimension."""
        if name not in self.sizes:
            raise InputError(f"statistic: there is no dimension {name}: give records=[...]")
        return list(self.sizes).index(name)


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
        progress: Progress | None = None,
    ) -> None:
        self.runs = 0
        self._progress = progress
        self._parameters = parameters
        self._names = [next(iter(find_quantities((name,)))) for name in quantities]
        self.n_quantities = len(self._names)
        self._threads = threads
        self._case = scenes.case.replace(solver={"rtol": 1e-9, "atol": None, **NO_ACCURACY})
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

    def run(self, requests: Sequence[Request]) -> tuple[Array, Truths]:
        """Compute runs."""
        finished = self.runs
        self.runs += len(requests)

        def report(done: int, _: int) -> None:
            if self._progress is not None:
                self._progress(finished + done, self.runs)

        values = np.full((len(requests), len(self._names)), np.nan)
        has_fallen = np.zeros(len(requests), dtype=bool)
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
            found = sweep(
                case, points=table, quantities=self._names, threads=self._threads, progress=report
            )
            finished += len(places)
            refuse_missing(found, self._names, "quantities")
            for i, name in enumerate(self._names):
                values[places, i] = found[name].values
            has_fallen[places] = fallen(found)
        return values, has_fallen

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


Statistic = float | Callable[[Array], float]
# resampled suites, with a fixed seed so that results repeat
_SUITES, _SEED = 200, 1963


class SuiteStatistic:
    """A statistic over dimensions of the scenes, of which the first are the records."""

    def __init__(self, statistic: Statistic, axes: tuple[int, ...], sizes: tuple[int, ...]) -> None:
        share = float_of(statistic)
        if not callable(statistic) and not (share is not None and 0 <= share <= 1):
            wanted = "a share in [0, 1] or a function of an array"
            raise InputError(f"statistic = {show(statistic)}: must be {wanted}")
        self._statistic = statistic
        self._axes, self._sizes = axes, sizes

    def of(self, values: Array) -> Array:
        """Compute the statistic."""
        return self._reduce(self._records_first(values))

    def first(self, values: Array) -> Array:
        """Return the values of the first record."""
        known = self._records_first(values)
        return np.asarray(known[(0,) * len(self._axes)])

    def of_resampled(self, values: Array) -> Iterator[Array]:
        """Compute the statistic of suites drawn with replacement."""
        known = self._records_first(values)
        random = np.random.default_rng(_SEED)
        for _ in range(_SUITES):
            yield self._reduce(known[random.integers(0, len(known), len(known))])

    def _records_first(self, values: Array) -> Array:
        """Return the values over the dimensions of the statistic, cells, and the others."""
        shaped = values.reshape((*self._sizes, *values.shape[1:]))
        n = len(self._axes)
        moved = np.moveaxis(shaped, self._axes, range(n))
        return moved.reshape((*moved.shape[:n], -1, *values.shape[1:]))

    def _reduce(self, values: Array) -> Array:
        n = len(self._axes)
        shape = values.shape[n:]
        if callable(self._statistic):
            columns = np.moveaxis(values.reshape((*values.shape[:n], -1)), -1, 0)
            # lanes that were not run have no statistic
            found = [
                math.nan if np.isnan(column).any() else _number(self._statistic(column))
                for column in columns
            ]
            return np.array(found, dtype=float).reshape(shape)
        # by ranks; between two ranks their mean, so the median of an even suite is the usual one
        flat = values.reshape((-1, *shape))
        with np.errstate(invalid="ignore"):
            ranked = np.quantile(flat, self._statistic, axis=0, method="averaged_inverted_cdf")
        # a rank among collapses
        return np.where(np.isnan(ranked) & ~np.isnan(flat).any(axis=0), np.inf, ranked)


def _number(value: object) -> float:
    """Return the result of a user's statistic."""
    number = float_of(value)
    if number is None:
        raise InputError(f"statistic: returns {show(value)}: must be one number")
    return number


# factors on the steps, with the relative tolerances of their lanes: smaller steps follow only
# where the differences disagree
_LEVELS = ((1.0, 1e-9), (1.0, 1e-12), (0.1, 1e-13), (0.01, 1e-13), (1e-3, 1e-13))
# ranks of a suite change with the steps, so a statistic has one set, ten times larger
_OF_STATISTIC = ((5.0, 1e-9),)
# disagreement over the largest p dq/dp above which smaller steps follow
_SETTLED = 1e-9
# error over disagreement: covers the truth in 99 % of runs
_SAFETY = 3.0
# error of a value over its tolerance, and round-off
_OF_TOLERANCE, _ROUND_OFF = 3e-3, 2e-16
# least error over the largest p dq/dp
_LEAST = 3e-9
# error over the derivative, and over the largest p dq/dp, above which there is no derivative
_NO_DERIVATIVE, _NOTICED = 0.1, 1e-4
# relative difference between jumps of one kink, and number of smaller steps that confirm it
_SAME_JUMP, _CONFIRMED = 0.2, 2
# change of a value over the largest p dq/dp that is left to the integration
_UNSEEN = 1e-7


class Steps:
    """Derivatives of all quantities of all scenes with respect to all parameters.

    Attributes
    ----------
    scales : numpy.ndarray, shape (rows, parameters)
        Changes of the parameters that count as one.
    value : numpy.ndarray, shape (cells, quantities)
        The values.
    derivative, error : numpy.ndarray, shape (cells, parameters, quantities)
        Derivatives and their errors.
    is_kink : numpy.ndarray of bool, shape (cells, parameters, quantities)
        Where slopes differ, or no derivative is found.
    valid_within : numpy.ndarray, shape (cells, parameters, quantities)
        Largest relative changes for which the derivative holds.
    bootstrap_error : numpy.ndarray, shape (cells, parameters, quantities), optional
        Scatter of the derivative over resampled suites.
    """

    def __init__(
        self,
        scenes: Scenes,
        lanes: Lanes,
        parameters: Sequence[Parameter],
        statistic: SuiteStatistic | None = None,
    ) -> None:
        self.bootstrap_error: Array | None = None
        self._lanes = lanes
        self._statistic = statistic
        n_rows, n_parameters = lanes.values.shape
        self.scales = np.empty((n_rows, n_parameters))
        self._allowed: list[list[dict[bool, float]]] = []
        known: dict[tuple[int, int], dict[bool, float]] = {}
        for row in range(n_rows):
            case = scenes.case_of(row)
            for i, item in enumerate(parameters):
                value = float(lanes.values[row, i])
                self.scales[row, i] = scale = scale_of(item, value)
                if (id(case), i) not in known or item.column in scenes.columns:
                    known[id(case), i] = allowed_changes(case, item, value, scale)
            self._allowed.append([known[id(case), i] for i in range(n_parameters)])
        cells = n_rows if statistic is None else len(statistic.first(self.scales))
        size = (cells, n_parameters, lanes.n_quantities)
        self.value = np.full((cells, lanes.n_quantities), np.nan)
        self.derivative, self.error = np.full(size, np.nan), np.full(size, np.inf)
        self.is_kink: Truths = np.zeros(size, dtype=bool)
        self.valid_within = np.zeros(size)
        # last jump of the slopes, and smaller steps that confirm it
        self._jump, self._smaller = np.zeros(size), np.zeros(size, dtype=int)
        self._solve()

    def _solve(self) -> None:
        levels = _LEVELS if self._statistic is None else _OF_STATISTIC
        offsets: list[Array] = []
        changes: list[Array] = []
        pending = np.ones(self.scales.shape, dtype=bool)
        for level, (factor, rtol) in enumerate(levels):
            near = self._offsets(factor, level == 0, pending)
            centre, values, raw = self._compute(near, rtol)
            self.value = np.where(np.isnan(centre), self.value, centre)
            offsets.append(self.of_cells(near))
            with np.errstate(invalid="ignore"):
                changes.append(values - centre[:, None, None, :])
            is_open = self._estimate(offsets[-1][..., :LANES], values, centre, factor, rtol)
            if self._statistic is not None:
                self._resample(self._statistic, raw, near)
                break
            pending &= is_open.any(axis=2)
            if not pending.any():
                break
        largest = self._largest()[:, None, :]
        with np.errstate(invalid="ignore"):
            none = (self.error > _NO_DERIVATIVE * abs(self.derivative)) & (
                self.error > _NOTICED * largest
            )
        self.is_kink |= none | np.isnan(self.derivative)
        self.error[np.isnan(self.derivative)] = np.nan
        self._find_valid(np.concatenate(offsets, axis=2), np.concatenate(changes, axis=2))

    def _offsets(self, factor: float, is_first: bool, pending: Truths) -> Array:
        """Return relative changes, shape (rows, parameters, offsets), NaN for no run."""
        found = np.full((*pending.shape, LANES + 2 * len(FAR) * is_first), np.nan)
        for row, i in np.argwhere(pending):
            down, up = self._allowed[row][i][False], self._allowed[row][i][True]
            near = offsets_of((down > 0, up > 0), factor)
            found[row, i, : near.size] = near
            if is_first:
                far = [sign * step for step in FAR for sign, most in ((1, up), (-1, down))
                       if step <= most and step > abs(near).max()]  # fmt: skip
                found[row, i, LANES : LANES + len(far)] = far
        return found

    def _compute(self, offsets: Array, rtol: float) -> tuple[Array, Array, Array]:
        """Run the lanes: values without change, of all changes, and those before a statistic."""
        places = np.argwhere(np.isfinite(offsets))
        rows = np.unique(places[:, 0])
        requests = [Request(int(row), -1, 0.0, rtol) for row in rows]
        n_centres = len(requests)
        for row, i, k in places:
            value = self._lanes.values[row, i] + offsets[row, i, k] * self.scales[row, i]
            requests.append(Request(int(row), int(i), float(value), rtol))
        found, has_fallen = self._lanes.run(requests)
        if self._statistic is not None:
            found[has_fallen] = np.inf
        centre = np.full((len(offsets), found.shape[1]), np.nan)
        centre[rows] = found[:n_centres]
        values = np.full((*offsets.shape, found.shape[1]), np.nan)
        values[tuple(places.T)] = found[n_centres:]
        if self._statistic is None:
            return centre, values, values
        return self._statistic.of(centre), self._statistic.of(values), values

    def of_cells(self, values: Array) -> Array:
        """Reduce values of scenes to the common value of each cell."""
        return values if self._statistic is None else self._statistic.first(values)

    def _largest(self) -> Array:
        """Return the largest of value and p dq/dp over the parameters."""
        slopes = np.where(np.isfinite(self.derivative), abs(self.derivative), 0.0)
        value = np.where(np.isfinite(self.value), abs(self.value), 0.0)
        return np.asarray(np.maximum(value, slopes.max(axis=1)))

    def _estimate(
        self, offsets: Array, values: Array, centre: Array, factor: float, rtol: float
    ) -> Truths:
        """Differentiate, keep the better estimates, and return where steps disagree."""
        found: dict[tuple[int, int, int], Estimate] = {}
        for cell, i in np.argwhere(np.isfinite(offsets[..., 0])):
            good = np.isfinite(offsets[cell, i])
            for q in range(centre.shape[1]):
                at = (int(cell), int(i), q)
                near = values[cell, i, :LANES, q][good]
                found[at] = derivative_at(offsets[cell, i][good], near, centre[cell, q])
                if np.isnan(self.derivative[at]):
                    self.derivative[at] = found[at].derivative
        largest = self._largest()
        is_open = np.zeros(self.derivative.shape, dtype=bool)
        for at, item in found.items():
            most = largest[at[0], at[2]]
            if not math.isfinite(item.derivative):
                continue
            is_jump = item.is_kink and abs(item.jump) > _NOTICED * most
            cell, i, q = at
            around = np.append(values[cell, i, :LANES, q], centre[cell, q])
            round_off = max(_ROUND_OFF * most, resolution(around)) / (NEAR[1] * factor)
            of_tolerance = max(_OF_TOLERANCE * rtol / (NEAR[1] * factor), _LEAST)
            floor = of_tolerance * most + round_off
            error = _SAFETY * item.spread + floor
            if is_jump and abs(item.jump - self._jump[at]) < _SAME_JUMP * abs(item.jump):
                self._smaller[at] += factor < 1
                if self._smaller[at] >= _CONFIRMED:
                    self.is_kink[at] = True
                    self.derivative[at], self.error[at] = item.derivative, abs(item.jump) / 2
                    continue
            self._jump[at] = item.jump if is_jump else 0.0
            is_open[at] = item.spread > max(_SETTLED * most, 2 * round_off)
            if error < self.error[at]:
                self.derivative[at], self.error[at] = item.derivative, error
        return is_open

    def _resample(self, statistic: SuiteStatistic, raw: Array, offsets: Array) -> None:
        """Compute the scatter of a slope over resampled suites."""
        near = statistic.first(offsets)[:, :, :LANES, None]
        tried = np.isfinite(near)
        lever = np.where(tried, near - np.nanmean(near, axis=2, keepdims=True), 0.0)
        samples = []
        with np.errstate(invalid="ignore"):
            for values in statistic.of_resampled(raw[:, :, :LANES]):
                product = lever * np.where(tried, values, 0.0)
                samples.append(product.sum(axis=2) / (lever**2).sum(axis=2))
            low, high = np.quantile(np.array(samples), (0.16, 0.84), axis=0)
            self.bootstrap_error = (high - low) / 2

    def _find_valid(self, offsets: Array, changes: Array) -> None:
        largest = self._largest()
        for cell, i, q in np.ndindex(self.derivative.shape):
            tried = np.isfinite(offsets[cell, i])
            self.valid_within[cell, i, q] = valid_range(
                offsets[cell, i][tried],
                changes[cell, i, :, q][tried],
                float(self.derivative[cell, i, q]),
                _UNSEEN * float(largest[cell, q]),
            )
