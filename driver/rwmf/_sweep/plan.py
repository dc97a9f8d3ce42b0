"""From a case, a grid and records to the chunks of a sweep."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rwmf import _library
from rwmf._sweep.axes import (
    Axis,
    Coordinate,
    Entries,
    RecordAxis,
    ScaleAxis,
    key_axis,
    name_axes,
    numbers_of_axis,
)
from rwmf._sweep.layout import Layout
from rwmf._sweep.quantities import default_quantity, find_quantities
from rwmf._sweep.record_sets import RecordFile
from rwmf._sweep.task import Task
from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError
from rwmf.quantities import AXES

__all__ = ["Plan", "make_plan"]

# runs of a chunk: enough to keep lanes and threads full, few enough to lose without regret
_CHUNK_RUNS = 4096
# the same where each run is a call of the kernel
_CHUNK_POINTS = 128


@dataclass(frozen=True)
class Plan:
    """A sweep that is ready to run.

    Attributes
    ----------
    layout : Layout
        Dimensions, labels, identity.
    base : dict
        Groups of the case without what the axes set.
    source : str
        Path against whose folder the case's own record is resolved.
    axes : tuple of Axis
        Loops outside the chunks, slowest first.
    inner : tuple of (name, values)
        Axes inside the chunks.
    """

    layout: Layout
    base: Entries
    source: str
    axes: tuple[Axis, ...]
    inner: tuple[tuple[str, tuple[float, ...]], ...]

    def task(self, number: int, threads: int = 1) -> Task:
        """Make the task of a chunk.

        Parameters
        ----------
        number : int
            Of the chunk.
        threads : int
            Threads of the kernel.

        Returns
        -------
        Task
            What a worker needs.
        """
        positions, block = self.layout.place(number)
        grid = list(self.inner)
        if grid:
            grid[-1] = (grid[-1][0], grid[-1][1][block])
        return Task(
            number,
            self._entries(positions),
            self.source,
            tuple(grid),
            self.layout.quantities,
            threads,
        )

    def _entries(self, positions: tuple[int, ...]) -> Entries:
        entries = {group: dict(keys) for group, keys in self.base.items()}
        placed = zip(self.axes, positions, strict=True)
        # a factor acts on the amplitude that another axis may set
        for axis, position in sorted(placed, key=lambda pair: isinstance(pair[0], ScaleAxis)):
            axis.apply(entries, position)
        return entries

    def checked(self) -> Plan:
        """Let the kernel validate every position of every axis once, the others at their first.

        Returns
        -------
        Plan
            The same with what the kernel says that its runs do not conserve.

        Raises
        ------
        InputError
            When it refuses one.
        """
        first = [0] * len(self.axes)
        # a record that the case before has is not read again
        known: _library.KernelCase | None = None
        laws = 0
        for i, axis in enumerate(self.axes):
            for position in range(len(axis)):
                # the first position of all axes is checked once
                if position == 0 and i > 0:
                    continue
                label = axis.coordinates()[0].values[position]
                at = (*first[:i], position, *first[i + 1 :])
                known = self._check_one(at, f"{axis.name} = {label}", known)
                laws |= known.broken_laws()
        if not self.axes:
            laws = self._check_one((), "the case", None).broken_laws()
        return replace(self, layout=replace(self.layout, warnings=_library.law_warning(laws)))

    def _check_one(
        self, positions: tuple[int, ...], label: str, known: _library.KernelCase | None
    ) -> _library.KernelCase:
        entries = self._entries(positions)
        grid = dict(self.inner)
        if "T_s" in grid:
            entries["spectrum"] = dict(grid)
        try:
            return _library.read_case(compose(entries), self.source, known)
        except InputError as error:
            raise InputError(f"sweep, {label}: {error}") from error


def make_plan(
    case: Case,
    grid: Mapping[str, object],
    records: Sequence[RecordFile] = (),
    quantities: tuple[str, ...] | None = None,
    chunk: int = 0,
    level: str | None = None,
) -> Plan:
    """Lay out a sweep.

    Parameters
    ----------
    case : Case
        What all runs have in common; its `&spectrum` is part of the grid.
    grid : mapping
        Values of the axes by name.
    records : sequence of RecordFile
        Ground motions in the place of the case's own.
    quantities : tuple of str
        What is kept of each run; None for what the scene reports by itself.
    chunk : int
        Largest number of runs of a chunk, 0 for the usual one.
    level : str, optional
        What a factor on the ground motion is, where it is more than that.

    Returns
    -------
    Plan
        Validated by the kernel.

    Raises
    ------
    InputError
        When an axis, a value, a record or a quantity is not acceptable.
    """
    wanted = find_quantities((default_quantity(case),) if quantities is None else quantities)
    grid = name_axes(grid)
    axes: list[Axis] = [RecordAxis(tuple(records))] if records else []
    axes += [key_axis(name, values) for name, values in grid.items() if name not in AXES]
    if level is not None:
        axes = [
            replace(axis, meaning=level) if isinstance(axis, ScaleAxis) else axis for axis in axes
        ]
    names = [axis.name for axis in axes]
    if len(set(names)) < len(names):
        raise InputError(f"grid: two axes have the same name: {', '.join(names)}")
    inner = _inner_axes(case, grid)
    base = _base_entries(case, axes)
    for quantity in wanted.values():
        if quantity.asked_by:
            base.setdefault("output", {})[quantity.asked_by] = True
    size = chunk or (_CHUNK_RUNS if any(name == "T_s" for name, _ in inner) else _CHUNK_POINTS)
    layout = _make_layout(case, compose(base), axes, inner, tuple(wanted), size)
    return Plan(layout, base, case.kernel_source(), tuple(axes), inner).checked()


def _make_layout(
    case: Case,
    text: str,
    axes: list[Axis],
    inner: tuple[tuple[str, tuple[float, ...]], ...],
    quantities: tuple[str, ...],
    size: int,
) -> Layout:
    coordinates = [coordinate for axis in axes for coordinate in axis.coordinates()]
    known = case.kernel.axes()
    for name, values in inner:
        coordinates.append(Coordinate(name, name, values, known[name].unit, known[name].meaning))
    sizes = [len(values) for _, values in inner]
    block = max(1, size // max(1, int(np.prod(sizes[:-1], dtype=int)))) if sizes else 1
    return Layout(
        version=_library.version(),
        case=text,
        coordinates=tuple(coordinates),
        outer=tuple((axis.name, len(axis)) for axis in axes),
        inner=tuple((name, len(values)) for name, values in inner),
        block=min(block, sizes[-1]) if sizes else 1,
        quantities=quantities,
        motion_crc32="" if any(axis.name == "record" for axis in axes) else _own_record(case),
    )


def _own_record(case: Case) -> str:
    """Checksums of the records that the case names itself."""
    names = [
        case.groups[name].get("file") for name in ("motion", "vertical") if name in case.groups
    ]
    paths = [Path(case.kernel_source()).parent / str(name) for name in names if name is not None]
    return "-".join(f"{zlib.crc32(path.read_bytes()):08x}" for path in paths)


def _base_entries(case: Case, axes: list[Axis]) -> Entries:
    """Take the groups that no axis replaces; the grid comes back chunk by chunk."""
    gone = {"spectrum"}
    if any(axis.name == "record" for axis in axes):
        gone.add("motion")
    return {
        name: {key: group[key] for key in group if key in group.given}
        for name, group in case.groups.items()
        if name not in gone
    }


def _inner_axes(
    case: Case, grid: Mapping[str, object]
) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Axes that the kernel loops over, as far as the scene has them."""
    axes = case.kernel.axes()
    for name in AXES:
        if name in grid and name not in axes:
            raise InputError(f"grid: {name}: the case has no such effect to vary")
    found = []
    for name, axis in axes.items():
        # a block keeps its size unless it is asked for another one
        if name == "T_s" and not {"frame", "spectrum"} & set(case.groups) and name not in grid:
            continue
        values = grid[name] if name in grid else _values_of_case(case, name, axis)
        found.append((name, numbers_of_axis(name, values)))
    return tuple(found)


def _values_of_case(case: Case, name: str, axis: _library.SceneAxis) -> list[float]:
    spectrum: Mapping[str, Any] = case.groups.get("spectrum", {})
    if name in spectrum:
        return list(spectrum[name])
    if name == "T_s" and "n" in spectrum:
        return list(_periods(spectrum))
    if axis.value is None:
        raise InputError(f"sweep: neither the grid nor the case gives {name}")
    return [axis.value]


def _periods(spectrum: Mapping[str, Any]) -> Iterator[float]:
    """Follow the kernel operation by operation, so that the periods have the same bits."""
    low, high = float(spectrum["T_s_min"]), float(spectrum["T_s_max"])
    n = int(spectrum["n"])
    for i in range(n):
        x = i / max(1, n - 1)
        if i == n - 1 and n > 1:
            yield high
        elif spectrum["spacing"] == "log":
            yield low * (high / low) ** x
        else:
            yield low + x * (high - low)
