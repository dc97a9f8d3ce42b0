"""Conversion of numbers and arrays given by a caller; all conversions are in this module.

Texts, truth values, complex numbers, times and masked values are refused: NumPy would convert them
without a warning.
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from typing import Any, TypeGuard, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf.errors import InputError
from rwmf.kernel.names import shorten

_T = TypeVar("_T")
_K = TypeVar("_K", bound=Hashable)
Array = npt.NDArray[np.float64]
Truths = npt.NDArray[np.bool_]
Wholes = npt.NDArray[np.int64]
_NUMBERS = int | float | np.integer | np.floating
# types of integers in Python and NumPy
_NO_NUMBERS = bool | np.timedelta64
# names in messages for the kinds of NumPy types that are refused
_KINDS = {"b": "true or false", "c": "complex", "U": "text", "S": "bytes", "M": "dates",
          "m": "time differences", "V": "records"}  # fmt: skip
_FINITE = "a finite number"
_NUMPY = re.compile(r"\bnp\.(?:[a-z]+\d*_?\(('[^']*'|[^()]*)\)|(True|False)_)")


def show(value: object) -> str:
    """Write a value for a message, in at most one line."""
    if isinstance(value, int) and value.bit_length() > 256:
        return f"an integer of {value.bit_length()} bits"
    try:
        # numbers of NumPy, alone and in lists, as those of Python: 0.5, not np.float64(0.5)
        text = repr(value)
        if not isinstance(value, str | bytes):
            text = _NUMPY.sub(lambda found: found[1] or found[2], text)
    except Exception:
        text = f"an object of type {type(value).__name__}"
    return shorten(" ".join(text.split()))


def short_decimal(x: float) -> float:
    """Return 0.3 for 0.30000000000000004, so that labels of results are found by their decimals.

    Numbers that differ from twelve digits by more than rounding stay.
    """
    decimal = float(f"{x:.12g}")
    return decimal if abs(decimal - x) <= 4 * math.ulp(x) else x


def to_number(
    name: str,
    value: object,
    *,
    above: float = -math.inf,
    below: float = math.inf,
    wanted: str = "",
) -> float:
    """Convert one number."""
    number = float_of(value)
    if number is not None and math.isfinite(number) and above < number < below:
        return number
    ends = [f"> {above:g}"] if above > -math.inf else []
    ends += [f"< {below:g}"] if below < math.inf else []
    wanted = wanted or " ".join([_FINITE, " and ".join(ends)]).strip()
    raise InputError(f"{name} = {show(value)}: must be {wanted}")


def is_whole(value: object) -> TypeGuard[int | np.integer[Any]]:
    """Check whether a value has an integer type; truth values and times do not count."""
    return isinstance(value, int | np.integer) and not isinstance(value, _NO_NUMBERS)


def to_whole(name: str, value: object, lowest: int, highest: int | None = None) -> int:
    """Convert one whole number."""
    number: int | None = None
    if is_whole(value):
        number = operator.index(value)
    if number is not None and lowest <= number and (highest is None or number <= highest):
        return number
    allowed = f">= {lowest}" if highest is None else f"in [{lowest}, {highest}]"
    raise InputError(f"{name} = {show(value)}: must be a whole number {allowed}")


def to_array(
    name: str,
    values: object,
    *,
    wanted: str = "an array of finite numbers with one dimension",
    above: float = -math.inf,
    least: int = 0,
    is_finite: bool = True,
) -> Array:
    """Convert a list or an array of numbers."""
    array = _floats(name, values, wanted)
    if array.ndim > 1:
        raise InputError(f"{name}: has the shape {array.shape}: must have one dimension")
    array = np.atleast_1d(array)
    if array.size < least:
        raise InputError(f"{name}: has {array.size} values: must be at least {least}")
    is_wrong = ~np.isfinite(array) if is_finite else np.zeros(array.shape, dtype=bool)
    is_wrong |= array <= above
    if is_wrong.any():
        i = int(np.argmax(is_wrong))
        more = f", > {above:g}" if above > -math.inf else ""
        place = f" at position {i}" if array.size > 1 else ""
        raise InputError(f"{name} = {array[i].item()!r}{place}: must be {wanted}{more}")
    return array


def to_shaped(name: str, values: object, *shapes: tuple[int, ...]) -> Array:
    """Convert finite numbers of any dimension."""
    wanted = "finite numbers"
    array = np.array(values) if type(values) is float else _floats(name, values, wanted)
    if not np.isfinite(array).all():
        wrong = array[~np.isfinite(array)].flat[0].item()
        raise InputError(f"{name} = {wrong!r}: must be {wanted}")
    if shapes and array.shape not in shapes:
        allowed = " or ".join(map(str, shapes))
        raise InputError(f"{name}: has the shape {array.shape}: must have {allowed}")
    return array


def to_items(value: object) -> list[Any] | None:
    """List the items of a list, an array or another ordered iterable."""
    if not isinstance(value, Iterable) or isinstance(
        value, str | bytes | bytearray | memoryview | Mapping | set | frozenset
    ):
        return None
    try:
        return list(value)
    except Exception:
        return None


def float_of(value: object) -> float | None:
    """Convert one number."""
    if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.is_masked(value):
        value = value.item()
    if not isinstance(value, _NUMBERS) or isinstance(value, _NO_NUMBERS):
        return None
    try:
        return float(value)
    except OverflowError:
        return None


def _floats(name: str, values: object, wanted: str) -> Array:
    """Return numbers of any shape as a new array."""
    if isinstance(values, str | bytes | bytearray | memoryview | Mapping | set | frozenset):
        raise InputError(f"{name} = {show(values)}: must be {wanted}")
    masked = first_masked(values)
    if masked is not None:
        raise InputError(f"{name}: the value at position {masked} is masked: must be {wanted}")
    try:
        if isinstance(values, Iterator):
            values = list(values)
        array: npt.NDArray[Any] = np.asarray(values)
    except Exception:
        raise InputError(f"{name} = {show(values)}: must be {wanted}") from None
    if array.dtype.kind == "O":
        return _floats_of_objects(name, array, wanted)
    if array.dtype.kind not in "iuf":
        kind = _KINDS.get(array.dtype.kind, str(array.dtype))
        raise InputError(f"{name} = {show(values)}: is {kind}: must be {wanted}")
    if isinstance(values, list | tuple) and any(isinstance(item, bool) for item in values):
        # beside numbers NumPy converts a truth value to 0 or 1
        raise InputError(f"{name} = {show(values)}: has true or false in it: must be {wanted}")
    with np.errstate(over="ignore"):
        return np.array(array, dtype=np.float64)


def _floats_of_objects(name: str, array: npt.NDArray[Any], wanted: str) -> Array:
    found = np.empty(array.shape)
    for place in np.ndindex(array.shape):
        number = float_of(array[place])
        if number is None:
            raise InputError(f"{name}: {show(array[place])}: must be {wanted}")
        found[place] = number
    return found


def first_masked(values: object) -> int | None:
    """Find the first masked value."""
    if isinstance(values, np.ma.MaskedArray):
        found = np.flatnonzero(np.ma.getmaskarray(values))
        return int(found[0]) if found.size else None
    if isinstance(values, list | tuple):
        for i, item in enumerate(values):
            if isinstance(item, np.ma.MaskedArray) and np.ma.is_masked(item):
                return i
    return None


def grouped(items: Iterable[_T], key: Callable[[_T], _K]) -> dict[_K, list[_T]]:
    """Collect items by a key, in the order of their first ones."""
    found: dict[_K, list[_T]] = {}
    for item in items:
        found.setdefault(key(item), []).append(item)
    return found


def to_json(value: object) -> Any:  # noqa: ANN401 (JSON has several types)
    """Convert to JSON types; values that are not finite become null."""
    if isinstance(value, dict):
        return {key: to_json(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, list):
        return [to_json(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
