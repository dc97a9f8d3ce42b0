"""Parameters of a gradient: names, values, steps and bounds; differences of their runs."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.errors import InputError, without_lines
from rwmf.kernel import tables
from rwmf.kernel.numbers import show
from rwmf.sweeps.axes import SCALE, SETTINGS, column_in, key_of_column, kind_of

Array = npt.NDArray[np.float64]
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
        return _row(self).unit.replace("-", "1")


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
    if key not in group:
        others = ", ".join(_givers(case, name, key)) or ", ".join(sorted(group.given))
        raise InputError(
            f"parameters: {item.name}: has no value in this case, whose &{name} gives {others}"
        )
    if key in group.derived:
        givers = ", ".join(_givers(case, name, key)) or ", ".join(sorted(group.given))
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
    ends = re.findall(r"[-+.\deE]+", "" if item.column == SCALE else _row(item).usual)
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
        is_list = _row(item).kind.endswith("list")
        return {name: {key: [value] if is_list else value}}
    numbers = value_of(case, item)
    if item.element:
        numbers[item.element - 1] = value
    else:
        numbers *= value / numbers.mean()
    return {name: {key: numbers.tolist()}}


def _row(item: Parameter) -> tables.KeyRow:
    return next(row for row in tables.schema() if (row.group, row.key) == item.key)
