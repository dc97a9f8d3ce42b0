"""Ground motions from arrays, used in a case instead of a record's file."""

from __future__ import annotations

import functools
import os
import re
import zlib
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from rwmf.errors import InputError, placed
from rwmf.kernel import files
from rwmf.kernel.kernel_case import keep_samples
from rwmf.kernel.marshalling import Memory
from rwmf.kernel.numbers import Array, show, to_array, to_number

UNITS = ("g", "m/s2", "cm/s2")
# order of the derivative that the last steps of ObsPy leave: 2 for accelerations
_ORDERS = {"DISP": 0, "VEL": 1, "ACC": 2}
_QUANTITIES = {0: "displacements", 1: "velocities"}
_ARRAY = "an array of numbers with one dimension"


class Motion:
    """Samples of a ground acceleration in memory: a record without a file.

    A motion never changes: it keeps copies of the arrays. The samples follow the rules for files:
    at least two, finite, at strictly increasing times, with linear interpolation. It replaces the
    file wherever a case or a sweep names one::

        quake = rwmf.Motion(a, dt=0.01, unit="m/s2", name="synthetic 7")
        case = case.replace(motion=quake)
        case = case.replace(motion={"file": quake, "scale": 1.5}, vertical=rwmf.Motion(...))

    Parameters
    ----------
    values : array, shape (n,)
        Accelerations of the ground.
    dt : float, optional
        Interval of the samples, the first at t = 0 [s]; exactly one of `dt` and `times`.
    times : array, shape (n,), optional
        Times of the samples [s].
    unit : {'g', 'm/s2', 'cm/s2'}
        Unit of the values; 'g' means `&model g` of the case.
    name : str
        Name in outputs and messages.

    Attributes
    ----------
    values : numpy.ndarray, shape (n,)
        The accelerations, read-only.
    dt : float or None
        Interval of the samples [s]; None for a motion given with times.
    unit : str
        Unit of the accelerations.
    name : str
        Name in outputs and messages.
    samples : Memory
        The samples in the kernel.

    Raises
    ------
    InputError
        When the samples are not acceptable.
    """

    __slots__ = ("_times", "dt", "name", "samples", "unit", "values")

    dt: float | None
    name: str
    samples: Memory
    unit: str
    values: Array
    _times: Array | None

    def __init__(
        self,
        values: npt.ArrayLike,
        *,
        dt: float | None = None,
        times: npt.ArrayLike | None = None,
        unit: str,
        name: str = "array",
    ) -> None:
        put = super().__setattr__
        if not isinstance(name, str) or not name.strip() or not name.isprintable():
            raise InputError(f"name = {show(name)} of a motion: must be printable text on one line")
        put("name", name)
        with placed(f"motion {name!r}: "):
            if not isinstance(unit, str) or unit not in UNITS:
                raise InputError(f"unit = {show(unit)}: must be 'g', 'm/s2' or 'cm/s2'")
            if (dt is None) == (times is None):
                raise InputError("exactly one of dt and times must be given")
            put("unit", unit)
            if dt is not None:
                dt = to_number("dt", dt, above=0.0, wanted="a number > 0 [s]")
            put("dt", dt)
            put("values", _kept("values", values))
            put("_times", None if times is None else _kept("times", times))
            if self.values.size < 2:
                raise InputError(f"{self.values.size} samples: must be at least 2")
            put("samples", keep_samples(self.values, self._times))

    @classmethod
    def from_obspy(
        cls,
        source: Any,  # noqa: ANN401 (a type of ObsPy)
        unit: str | None = None,
        name: str | None = None,
    ) -> Motion:
        """Take the samples of a trace of ObsPy; the package itself is not needed.

        Parameters
        ----------
        source : obspy.Trace or obspy.Stream
            A trace of accelerations, or a stream with one. The first sample is at t = 0.
        unit : {'g', 'm/s2', 'cm/s2'}, optional
            Unit of the samples. It may be left out after ``remove_response(output="ACC")``, which
            gives m/s2.
        name : str, optional
            Name of the motion; otherwise the identifier of the trace.

        Returns
        -------
        Motion
            The samples of the trace.

        Raises
        ------
        InputError
            When the stream has several traces, the samples have gaps or are counts, velocities or
            displacements, or the unit is missing.
        """
        trace = _only_trace(source)
        title = str(getattr(trace, "id", "trace"))
        where = f"trace {title!r}"
        stats, data = trace.stats, trace.data
        if np.ma.is_masked(data):
            raise InputError(f"{where}: has gaps (masked samples): take one part of split()")
        samples = np.ma.getdata(data)
        if samples.dtype.kind in "iu":
            raise InputError(
                f"{where}: holds whole numbers, counts of a digitiser: call "
                'remove_response(output="ACC"), or read it with apply_calib=True'
            )
        if samples.shape != (int(stats.npts),):
            raise InputError(f"{where}: has {samples.size} samples, its header says {stats.npts}")
        order = _order_of(getattr(stats, "processing", None) or ())
        if order not in (None, 2):
            held = _QUANTITIES.get(order, "no accelerations")
            raise InputError(f"{where}: holds {held} after its processing: must be accelerations")
        if unit is None and order is None:
            raise InputError(f"{where}: states no unit: give unit = 'g', 'm/s2' or 'cm/s2'")
        return cls(samples, dt=stats.delta, unit=unit or "m/s2", name=name or title)

    @property
    def times(self) -> Array:
        """Times of the samples [s], read-only."""
        times: Array
        if self._times is not None:
            return self._times
        times = np.arange(self.values.size) * np.float64(self.dt or 0.0)
        times.flags.writeable = False
        return times

    @property
    def checksum(self) -> str:
        """CRC-32 of the numbers (times, if given, then values), as in outputs."""
        times = b"" if self._times is None else self._times.tobytes()
        return f"{zlib.crc32(self.values.tobytes(), zlib.crc32(times)):08x}"

    def keys(self) -> dict[str, Any]:
        """Return the keys that describe the motion in a case.

        Returns
        -------
        dict
            ``file`` (the name), ``unit`` and, for a motion with an interval, ``dt``.
        """
        found: dict[str, Any] = {"file": self.name, "unit": self.unit}
        return found if self.dt is None else found | {"dt": self.dt}

    def write(self, path: str | os.PathLike[str], header: str | Sequence[str] = ()) -> None:
        """Write the samples as a record file: one column, or times and values.

        Parameters
        ----------
        path : str or path
            The file; the numbers round-trip to the same bits.
        header : str or sequence of str, optional
            Lines of comment above the numbers.

        Raises
        ------
        OutputError
            When the file cannot be written.
        """
        if not isinstance(path, str | os.PathLike):
            raise InputError(f"path = {show(path)}: must be the path of a file")
        columns = [self.values] if self._times is None else [self._times, self.values]
        texts = [header] if isinstance(header, str) else header
        lines = [f"# {line}" for text in texts for line in text.splitlines()]
        lines += [" ".join(map(repr, row)) for row in np.column_stack(columns).tolist()]
        files.write_bytes(Path(path), ("\n".join(lines) + "\n").encode())

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse: a motion never changes."""
        raise AttributeError("a motion cannot be changed; make another one")

    def __eq__(self, other: object) -> bool:
        """Compare name, unit and samples."""
        if not isinstance(other, Motion):
            return NotImplemented
        return (
            self.keys() == other.keys()
            and np.array_equal(self.values, other.values)
            and np.array_equal(self.times, other.times)
        )

    def __hash__(self) -> int:
        """Hash name, unit and samples."""
        return hash((*self.keys().values(), self.checksum))

    def __reduce__(self) -> tuple[Callable[..., Motion], tuple[object, ...]]:
        """Pickle the samples."""
        make = functools.partial(
            Motion, dt=self.dt, times=self._times, unit=self.unit, name=self.name
        )
        return (make, (self.values,))

    def __copy__(self) -> Motion:
        """Return the motion itself: it never changes."""
        return self

    def __deepcopy__(self, _: object) -> Motion:
        """Return the motion itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show name, size, interval and unit."""
        sampling = "with times" if self.dt is None else f"dt = {self.dt!r} s"
        return f"Motion({self.name!r}: {self.values.size} samples, {sampling}, unit {self.unit!r})"


def _kept(name: str, values: npt.ArrayLike) -> Array:
    """Copy an array into a read-only one; the kernel reports a sample that is not finite."""
    array = to_array(name, values, wanted=_ARRAY, is_finite=False)
    array.flags.writeable = False
    return array


def _only_trace(source: Any) -> Any:  # noqa: ANN401 (a type of ObsPy)
    """Return a trace, or the only one of a stream."""
    if hasattr(source, "data") and hasattr(source, "stats"):
        return source
    traces = list(source) if isinstance(source, Iterable) else []
    if not traces or not all(hasattr(item, "data") and hasattr(item, "stats") for item in traces):
        raise InputError(f"source = {show(source)}: must be a trace of ObsPy, or a stream with one")
    if len(traces) > 1:
        names = ", ".join(str(getattr(item, "id", "trace")) for item in traces)
        raise InputError(
            f"the stream has {len(traces)} traces ({names}): give one, stream[0]; "
            "merge() joins parts of a channel"
        )
    return traces[0]


def _order_of(steps: Iterable[str]) -> int | None:
    """Return the order of the derivative after the recorded steps; None where none states it."""
    order = None
    for step in map(str, steps):
        removed = re.search(r"remove_response\(.*\boutput='(\w+)'", step, re.DOTALL)
        if removed is not None:
            order = _ORDERS.get(removed[1])
        elif order is not None:
            order += ("differentiate(" in step) - ("integrate(" in step)
    return order
