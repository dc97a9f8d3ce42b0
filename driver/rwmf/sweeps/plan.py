"""Planning of a sweep: chunks from a case, a grid, points and records; their tasks."""

from __future__ import annotations

import math
import os
import re
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf.case import Case, CaseLike, Motion
from rwmf.case.arguments import case_of
from rwmf.case.namelist import compose
from rwmf.errors import InputError, NumericalError, without_lines
from rwmf.kernel import kernel_case, results, tables
from rwmf.kernel.numbers import Array, short_decimal
from rwmf.motion.intensity import Intensity, choose_intensity, scale_to_one
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.run.quantities import (
    AXES,
    ORDINATES,
    SENSITIVITY,
    Quantity,
    default_quantity,
    find_quantities,
    keys_of,
)
from rwmf.sweeps.axes import (
    SCALE,
    Axis,
    Coordinate,
    Entries,
    Key,
    Layout,
    grid_axis,
    keys_of_axis,
    name_axes,
    put_number,
    record_axis,
)
from rwmf.sweeps.points import Points, point_axis

Progress = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class Task:
    """One kernel call.

    Attributes
    ----------
    number : int
        Number of the chunk.
    entries : dict
        Groups of the case of the first row.
    source : str
        Path whose folder records are relative to.
    columns : tuple of str
        Kernel names of the quantities that differ between rows.
    rows : numpy.ndarray, shape (rows, columns)
        The numbers.
    quantities : tuple of str
        Quantities stored for each run.
    motions : dict of str to Motion
        Motions from arrays that replace the records of ``motion`` and ``vertical``.
    threads : int
        Threads of the kernel.
    """

    number: int
    entries: Entries
    source: str
    columns: tuple[str, ...]
    rows: Array
    quantities: tuple[str, ...]
    motions: dict[str, Motion]
    threads: int = 1


@dataclass(frozen=True, eq=False)
class Chunk:
    """Results of a task.

    Attributes
    ----------
    number : int
        Number of the chunk.
    names : tuple of str
        Statuses that occur: 'ok', 'overturned', 'collapsed' or the name of an error.
    status : numpy.ndarray of uint8, shape (rows,)
        Indices into `names`.
    values : dict of str to numpy.ndarray, each of that shape
        One array per quantity, NaN where a run failed.
    """

    number: int
    names: tuple[str, ...]
    status: npt.NDArray[np.uint8]
    values: dict[str, Array]


def run_task(task: Task, progress: Progress | None = None) -> Chunk:
    """Compute a chunk; refused rows get a status and do not stop the others."""
    missing = np.full(len(task.rows), np.nan)
    try:
        found = _compute(task, progress)
    except (InputError, NumericalError) as error:
        name = "refused" if isinstance(error, InputError) else "failed"
        status = np.zeros(len(task.rows), dtype=np.uint8)
        return Chunk(task.number, (name,), status, dict.fromkeys(task.quantities, missing))
    names, codes = np.unique(found["status"].ravel(), return_inverse=True)
    # quantities of absent effects have no value
    values = {
        name: np.array(found.get(ORDINATES[name].key, missing)).ravel() for name in task.quantities
    }
    return Chunk(task.number, tuple(names.tolist()), codes.astype(np.uint8), values)


def _compute(task: Task, progress: Progress | None) -> dict[str, npt.NDArray[Any]]:
    samples = {group: motion.samples for group, motion in task.motions.items()}
    case = kernel_case.read_case(compose(task.entries), task.source, None, samples)
    allowed = case.applicable()
    # both names of a quantity have the same key
    requested = dict.fromkeys(ORDINATES[name].key for name in task.quantities)
    keys = [key for key in requested if key.removeprefix(SENSITIVITY) in allowed]
    with results.start_rows(
        case, task.source, task.columns, task.rows, keys, task.threads, progress
    ) as sweep:
        return sweep.values()


# runs of a chunk: enough to fill lanes and threads, few enough to repeat after an interruption
_CHUNK_RUNS = (256, 4096)
# between these limits, at least this many chunks are made
_CHUNKS = 64


@dataclass(frozen=True)
class Request:
    """Requested runs of a sweep: the arguments of `rwmf.sweep`.

    Attributes
    ----------
    case, grid, records, points, quantities, chunk, unit, dt, intensity, period, damping, periods
        As in `rwmf.sweep`.
    """

    case: CaseLike
    grid: Mapping[str, object] | None = None
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion] = ()
    points: Points | None = None
    quantities: Sequence[str] | None = None
    chunk: int = 0
    unit: str | None = None
    dt: float | None = None
    intensity: str | None = None
    period: float | None = None
    damping: float | None = None
    periods: Sequence[float] | None = None


@dataclass(frozen=True)
class Plan:
    """A validated sweep.

    Attributes
    ----------
    layout : Layout
        Dimensions, labels, identity.
    base : dict
        Groups of the case without the keys that axes set.
    source : str
        Path whose folder the case's own record is relative to.
    axes : tuple of Axis
        The dimensions, slowest first.
    motions : dict of str to Motion
        Motions from arrays in the case, by group.
    inputs : tuple of str
        Paths of the files that it reads.
    """

    layout: Layout
    base: Entries
    source: str
    axes: tuple[Axis, ...]
    motions: dict[str, Motion]
    inputs: tuple[str | os.PathLike[str], ...] = ()

    def task(self, number: int, threads: int = 1) -> Task:
        """Make the task of a chunk."""
        rows = self.layout.rows(number)
        columns = {
            name: values[positions]
            for axis, positions in zip(self.axes, rows.positions, strict=True)
            for name, values in axis.columns.items()
        }
        first = tuple(int(positions[0]) for positions in rows.positions)
        values = (
            np.column_stack(list(columns.values())) if columns else np.zeros((rows.places.size, 0))
        )
        return Task(
            number,
            self._entries(first),
            self.source,
            tuple(columns),
            values,
            self.layout.quantities,
            self._motions(first),
            threads,
        )

    def _motions(self, at: tuple[int, ...]) -> dict[str, Motion]:
        """Return the motions from arrays for one run."""
        found = dict(self.motions)
        for axis, position in zip(self.axes, at, strict=True):
            record = axis.scene(position).record
            if record is not None:
                found.pop("motion", None)
                if record.array is not None:
                    found["motion"] = record.array
        return found

    def _entries(self, at: tuple[int, ...]) -> Entries:
        """Make the groups of one run; a number may belong to another axis's record or text."""
        entries = {group: dict(keys) for group, keys in self.base.items()}
        placed = list(zip(self.axes, at, strict=True))
        for axis, position in placed:
            axis.scene(position).apply(entries)
        numbers = {
            name: float(values[position])
            for axis, position in placed
            for name, values in axis.columns.items()
        }
        # the kernel interprets period and mass ratio in a scene, as in a grid
        if "T_s" in numbers or "storeys" in entries:
            entries["spectrum"] = {name: numbers.pop(name) for name in AXES if name in numbers}
            # any period lets the kernel check the other numbers of storeys
            entries["spectrum"].setdefault("T_s", 1.0)
        for name, number in numbers.items():
            put_number(entries, name, number)
        return entries

    def checked(self) -> Plan:
        """Let the kernel validate every scene and the extremes of every column."""
        # reuse the record of the previous case
        known = self._check_one(tuple(0 for _ in self.axes), "")
        keys = keys_of(self.layout.quantities)
        warnings = known.warnings(keys)
        applicable = {*known.applicable()}
        for i, axis in enumerate(self.axes):
            for position in _telling_positions(axis):
                at = tuple(position if i == j else 0 for j in range(len(self.axes)))
                known = self._check_one(at, axis.where(position), known)
                warnings += known.warnings(keys)
                applicable.update(known.applicable())
        warnings += [
            f"quantities: {name} applies to no scene of the sweep and is NaN; "
            "reference/outputs.md lists the requirements"
            for name, key in zip(self.layout.quantities, keys, strict=True)
            if key.removeprefix(SENSITIVITY) not in applicable
        ]
        return replace(self, layout=replace(self.layout, warnings="\n".join(united(warnings))))

    def _check_one(
        self, at: tuple[int, ...], label: str, known: kernel_case.KernelCase | None = None
    ) -> kernel_case.KernelCase:
        entries = self._entries(at)
        # the violated laws depend on mass ratio and width together
        ends = {
            axis.name: np.unique([axis.columns[axis.name].min(), axis.columns[axis.name].max()])
            for axis in self.axes
            if axis.name in AXES
        }
        if "spectrum" in entries:
            entries["spectrum"] |= {name: tuple(found.tolist()) for name, found in ends.items()}
        label = label or ", ".join(axis.where(0) for axis in self.axes) or "the case"
        samples = {group: motion.samples for group, motion in self._motions(at).items()}
        try:
            return kernel_case.read_case(compose(entries), self.source, known, samples)
        except InputError as error:
            raise InputError(f"sweep, {label}: {without_lines(str(error))}") from error


def _telling_positions(axis: Axis) -> list[int]:
    """Return the first position of every scene, and the extremes of every column."""
    found: list[int] = np.unique(axis.scene_of, return_index=True)[1].tolist()
    for values in axis.columns.values():
        found += [int(values.argmin()), int(values.argmax())]
    # the first positions of all axes have been checked together
    return sorted({*found} - {0})


def make_plan(request: Request) -> Plan:
    """Plan a sweep."""
    case = case_of(request.case)
    records, points, intensity = _motions_of(request, case)
    named = [] if points is None else [scene.record for scene in points.scenes if scene.record]
    # records named by the points form no separate axis
    axes: list[Axis] = [record_axis(records)] if records and not named else []
    if points is not None:
        axes.append(points)
    grid = name_axes(request.grid or {})
    axes += [grid_axis(name, values) for name, values in grid.items() if name not in AXES]
    axes += _kernel_axes(case, grid, points)
    axes = [_labelled(axis, case, intensity) for axis in axes]
    _check_names(grid, axes, points)
    gone = {"spectrum"} | ({"motion"} if _has_records(axes) else set())
    base = {name: group.as_given() for name, group in case.groups.items() if name not in gone}
    quantities = (default_quantity(case),) if request.quantities is None else request.quantities
    # the demands of &limits come with every row
    wanted = find_quantities((*quantities, *case.kernel.limited_demands()))
    if getattr(case.output, "conditioning", False):
        wanted |= _sensitivities(wanted)
    for quantity in wanted.values():
        if quantity.asked_by:
            base.setdefault("output", {})[quantity.asked_by] = True
    for axis in axes:
        for label in axis.coordinates:
            if label.name in wanted:
                raise InputError(f"quantities: {label.name}: is an axis, which has its values")
    runs = math.prod(axis.size for axis in axes)
    block = request.chunk or min(max(_CHUNK_RUNS[0], -(-runs // _CHUNKS)), _CHUNK_RUNS[1])
    layout = _make_layout(case, compose(base), axes, tuple(wanted), block)
    if intensity is not None:
        layout = replace(layout, intensity=intensity.attributes)
    inputs: list[str | os.PathLike[str]] = [*case.inputs]
    inputs += [record.path for record in (*records, *named) if record.path]
    if isinstance(request.points, str | os.PathLike):
        inputs.append(request.points)
    plan = Plan(layout, base, case.kernel_source(), tuple(axes), case.motions, tuple(inputs))
    return plan.checked()


def _sensitivities(wanted: Mapping[str, Quantity]) -> dict[str, Quantity]:
    """Return the sensitivities of the peaks among the quantities."""
    keys = tuple(
        SENSITIVITY + item.key
        for item in wanted.values()
        # the height of a peak has none
        if item.found == "peak" and not item.key.endswith("_height_m")
    )
    return find_quantities(keys) if keys else {}


def _motions_of(
    request: Request, case: Case
) -> tuple[Sequence[RecordFile], Axis | None, Intensity | None]:
    """Find records and points of a request; scale the records if it sets an intensity."""
    unit, dt = request.unit, request.dt
    records: Sequence[RecordFile] = ()
    if len(request.records):
        records = find_records(request.records, unit=unit, dt=dt)
    if request.intensity is None:
        for name in ("period", "damping", "periods"):
            if getattr(request, name) is not None:
                raise InputError(f"{name}: belongs to intensity, which is not given")
        points = None if request.points is None else point_axis(request.points, records, unit, dt)
        return records, points, None
    if not records:
        raise InputError(f"intensity = {request.intensity!r}: needs records, which it scales")
    points = None if request.points is None else point_axis(request.points, records, unit, dt)
    varied = varied_keys(case, request.grid or {}, points)
    options = (request.period, request.damping, varied, request.periods)
    measure = choose_intensity(case, request.intensity, *options)
    records = scale_to_one(case, records, measure)
    if points is not None:
        # the table names the scaled records, so the second reading finds them
        points = point_axis(request.points, records, unit, dt)
        if any(scene.record and scene.record not in records for scene in points.scenes):
            text = f"intensity = {request.intensity!r}: the records of points must be in records"
            raise InputError(text)
    return records, points, measure


def united(warnings: Sequence[str]) -> list[str]:
    """Merge the warnings of several cases; lines that differ only in numbers become one."""
    found: dict[str, str] = {}
    for line in warnings:
        found.setdefault(re.sub(r"[-+\d.]+(e[-+]?\d+)?", "", line), line)
    return list(found.values())


def varied_keys(case: Case, grid: Mapping[str, object], points: Axis | None) -> list[Key]:
    """List the keys whose numbers differ between the runs of a sweep."""
    spectrum: Mapping[str, Any] = case.groups.get("spectrum", {})
    own: dict[str, object] = {name: spectrum[name] for name in AXES if name in spectrum}
    if "n" in spectrum:
        own["T_s"] = list(_periods(spectrum))
    found: list[Key] = []
    for name, values in (own | name_axes(grid)).items():
        axis = grid_axis(name, values)
        if axis.size == 1 and name in AXES:
            same = case.kernel.axes().get(name)
            if same is not None and same.value == axis.columns[name][0]:
                continue
        found += keys_of_axis(name)
    return found + sorted(points.keys if points is not None else ())


def _make_layout(
    case: Case, text: str, axes: Sequence[Axis], quantities: tuple[str, ...], block: int
) -> Layout:
    varies = any(("solver", "method") in axis.keys for axis in axes)
    return Layout(
        version=tables.version(),
        case=text,
        coordinates=tuple(label for axis in axes for label in axis.coordinates),
        scene_of={axis.name: axis.scene_of for axis in axes},
        block=block,
        quantities=quantities,
        motion_crc32=_own_record(case, ("vertical",) if _has_records(axes) else _OWN),
        method="" if varies else case.kernel.spectrum_method(),
    )


def _check_names(grid: Mapping[str, object], axes: Sequence[Axis], points: Axis | None) -> None:
    names = [
        name for axis in axes for name in {axis.name, *(item.name for item in axis.coordinates)}
    ]
    if len(set(names)) < len(names):
        raise InputError(f"grid: two axes have the same name: {', '.join(names)}")
    taken = set() if points is None else points.keys
    for name in grid:
        for key in keys_of_axis(name):
            if key in taken:
                raise InputError(f"grid and points: both set {name}")


def _has_records(axes: Sequence[Axis]) -> bool:
    return any(axis.scenes[0].record is not None for axis in axes)


# groups that may name a record
_OWN = ("motion", "vertical")


def _own_record(case: Case, groups: Sequence[str]) -> str:
    """Return the checksums of the records that groups of the case name."""
    found = []
    for name in groups:
        path = case.groups[name].get("file") if name in case.groups else None
        if name in case.motions:
            found.append(case.motions[name].checksum)
        elif path is not None:
            content = (Path(case.kernel_source()).parent / str(path)).read_bytes()
            found.append(f"{zlib.crc32(content):08x}")
    return "-".join(found)


def _kernel_axes(case: Case, grid: Mapping[str, object], points: Axis | None) -> Iterator[Axis]:
    """Make the axes of width, mass ratio and period that the scene has."""
    follows = {
        key for key in ("T_s", "gamma") if "frame" in case.groups and key in case.frame.derived
    }
    if "storeys" in case.groups and case.storeys.derived:
        follows = {"T_s", "gamma"}
    spectrum: Mapping[str, Any] = case.groups.get("spectrum", {})
    columns: Mapping[str, object] = {} if points is None else points.columns
    known = case.kernel.axes()
    for name in AXES:
        if name not in known and (name in grid or name in columns):
            label = "grid" if name in grid else "points"
            raise InputError(f"{label}: {name}: the case has no such effect to vary")
    for name, axis in known.items():
        if name in columns:
            continue
        if name in grid:
            yield grid_axis(name, grid[name])
        elif name in spectrum or (name == "T_s" and "n" in spectrum):
            values = spectrum[name] if name in spectrum else _periods(spectrum)
            yield grid_axis(name, list(values))
        # a block keeps its size unless the grid sets another
        elif points is None and name not in follows and (name != "T_s" or "frame" in case.groups):
            if axis.value is None:
                raise InputError(f"sweep: neither the grid nor the case gives {name}")
            yield grid_axis(name, [axis.value])


def _labelled(axis: Axis, case: Case, intensity: Intensity | None) -> Axis:
    """Label period, mass ratio, width and factor as the scene defines them."""
    known = case.kernel.axes()

    def label(item: Coordinate) -> Coordinate:
        if item.name in known:
            own = known[item.name]
            return replace(item, unit=own.unit, meaning=own.meaning)
        if item.name == SCALE and intensity is not None:
            if intensity.power > 1 and np.any(np.asarray(item.values) < 0):
                raise InputError(f"scale: levels of intensity = {intensity.kind!r} must be >= 0")
            unit, meaning, power = intensity.unit, intensity.label, intensity.power
            return replace(item, unit=unit, meaning=meaning, power=power)
        return item

    return replace(axis, coordinates=tuple(map(label, axis.coordinates)))


def _periods(spectrum: Mapping[str, Any]) -> Iterator[float]:
    """Repeat the kernel's operations in order, so that the periods have the same bits."""
    low, high = float(spectrum["T_s_min"]), float(spectrum["T_s_max"])
    n = int(spectrum["n"])
    for i in range(n):
        x = i / max(1, n - 1)
        if i == n - 1 and n > 1:
            yield high
        elif spectrum["spacing"] == "log":
            yield short_decimal(low * (high / low) ** x)
        else:
            yield short_decimal(low + x * (high - low))
