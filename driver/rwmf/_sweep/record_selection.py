"""Scaling of records to a target spectrum, and a greedy choice among them."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from rwmf._arguments import checked, path_of
from rwmf._files import files
from rwmf._intensity import DAMPING, pseudo_accelerations
from rwmf._numbers import show, to_array, to_items, to_number
from rwmf._records.lists import SUITE_HEADER
from rwmf._sweep.intensity import G, waveform_of_record
from rwmf._sweep.record_pairs import pairs
from rwmf._sweep.record_sets import RecordFile, find_records
from rwmf._sweep.record_targets import read_target
from rwmf.case import Motion
from rwmf.errors import InputError, warn

__all__ = ["Selection", "select", "write_suite"]

_Array = npt.NDArray[np.float64]
# periods of a band, evenly spaced in their logarithm
_PERIODS = 50
_NOT_ZERO = 1e-300
# largest pseudo-accelerations outside these limits point to a wrong unit [g]
_SMALLEST, _LARGEST = 1e-3, 5.0


@dataclass(frozen=True, eq=False)
class Selection:
    """Records scaled to a target spectrum.

    Attributes
    ----------
    records : tuple of RecordFile
        Components with their factors, in the order of the choice.
    names : tuple of str
        Name of the record of each component; both components of a pair have one name and factor.
    misfit : float
        Root of the mean square of ln(mean / target) over the band; the mean is geometric [-].
    periods : array, shape (n,)
        Periods of the band [s].
    target : array, shape (n,)
        Target spectrum [g].
    spectra : array, shape (components, n)
        Scaled spectra of the components [g].
    """

    records: tuple[RecordFile, ...]
    names: tuple[str, ...]
    misfit: float
    periods: _Array
    target: _Array
    spectra: _Array


@checked
def select(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    target_spectrum: str | os.PathLike[str] | Sequence[Sequence[float]],
    band: tuple[float, float],
    n: int | None = None,
    *,
    limits: tuple[float, float] = (0.25, 4.0),
    damping: float = DAMPING,
    is_paired: bool = False,
    unit: str | None = None,
    dt: float | None = None,
) -> Selection:
    """Scale records to a target spectrum, and choose those whose mean fits it best.

    The factor of a record makes the mean of ln(Sa) over the band that of the target. The choice is
    greedy: each step adds the record that makes the misfit of the geometric mean smallest.

    Parameters
    ----------
    words : iterable of str, path, RecordFile or Motion
        Candidates, as for `rwmf.find_records`.
    target_spectrum : str, path or (periods, pseudo-accelerations)
        Target spectrum, or its file with two columns: periods [s] or frequencies [Hz], and
        pseudo-accelerations [g] or in the unit of the column's name. It is interpolated in
        logarithms.
    band : (float, float)
        First and last period [s]; 50 periods between them, evenly spaced in their logarithm.
    n : int, optional
        Number of records; all candidates without it.
    limits : (float, float)
        Smallest and largest factor; records that need another one are left out.
    damping : float
        Damping ratio of the spectra [-].
    is_paired : bool
        True to take pairs of components with one factor for the geometric mean of their spectra.
    unit : str, optional
        Unit of the samples of files that do not give it.
    dt : float, optional
        Sampling interval [s] of files of one column.

    Returns
    -------
    Selection
        The records with factors, and spectra for a figure.

    Raises
    ------
    InputError
        When the band is not within the target, or too few records need factors within the limits.
    """
    low, high = _two("band", band)
    least, most = _two("limits", limits)
    to_number("damping", damping, below=1.0)
    periods = np.geomspace(low, high, _PERIODS)
    wanted = _target_at(target_spectrum, periods, damping)
    names, members = _candidates(words, is_paired, unit, dt)
    spectra = [
        np.array(
            [pseudo_accelerations(waveform_of_record(item, G), periods, damping) for item in group]
        )
        / G
        for group in members
    ]
    # logarithms of the candidates over the target, before scaling
    logs = np.array([np.log(np.maximum(each, _NOT_ZERO)).mean(axis=0) for each in spectra])
    logs -= np.log(wanted)
    factors = np.exp(-logs.mean(axis=1))
    usable = [i for i, factor in enumerate(factors) if least <= factor <= most]
    count = len(usable) if n is None else n
    if not 0 < count <= len(usable):
        raise InputError(
            f"select: {len(usable)} of {len(names)} records need factors within limits = "
            f"({least:g}, {most:g}), n = {n}: widen the limits or give more records"
        )
    scaled = logs + np.log(factors)[:, None]
    chosen = _choose(scaled, usable, count)
    found = [(names[i], item, factors[i]) for i in chosen for item in members[i]]
    return Selection(
        tuple(replace(item, scale=item.scale * float(factor)) for _, item, factor in found),
        tuple(name for name, _, _ in found),
        _misfit(scaled[chosen].mean(axis=0)),
        periods,
        wanted,
        np.concatenate([spectra[i] * factors[i] for i in chosen]),
    )


def _choose(scaled: _Array, usable: list[int], count: int) -> list[int]:
    """Add one record after the other; the first of equals."""
    chosen: list[int] = []
    total = np.zeros(scaled.shape[1])
    for size in range(1, count + 1):
        left = [i for i in usable if i not in chosen]
        best = min(left, key=lambda i: _misfit((total + scaled[i]) / size))
        chosen.append(best)
        total = total + scaled[best]
    return chosen


def _misfit(logs: _Array) -> float:
    return math.sqrt(float((logs**2).mean()))


def _candidates(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    is_paired: bool,
    unit: str | None,
    dt: float | None,
) -> tuple[list[str], list[tuple[RecordFile, ...]]]:
    if is_paired:
        sets = pairs(words, unit=unit, dt=dt)
        return [item.name for item in sets], [(item.first, item.second) for item in sets]
    records = find_records(words, unit=unit, dt=dt)
    return [record.name for record in records], [(record,) for record in records]


def _two(name: str, value: object) -> tuple[float, float]:
    ends = to_array(name, value, above=0.0, least=2)
    if ends.size != 2 or ends[0] >= ends[1]:
        raise InputError(f"{name} = {show(value)}: must be two numbers > 0, the smaller first")
    return float(ends[0]), float(ends[1])


def _target_at(
    target: str | os.PathLike[str] | Sequence[Sequence[float]], periods: _Array, damping: float
) -> _Array:
    """Interpolate the target spectrum [g]."""
    if isinstance(target, str | os.PathLike):
        table = read_target(Path(path_of("target_spectrum", target)), damping)
    else:
        rows = to_items(target) or []
        if len(rows) != 2:
            raise InputError(f"target_spectrum = {show(target)}: must be periods and accelerations")
        first, second = (to_array("target", row, above=0.0, least=2) for row in rows)
        if first.size != second.size:
            raise InputError(f"target: has {first.size} periods and {second.size} accelerations")
        table = np.stack([first, second])
        if np.any(np.diff(table[0]) <= 0):
            raise InputError("target: must be increasing periods > 0 and pseudo-accelerations > 0")
    if periods[0] < table[0, 0] * (1 - 1e-9) or periods[-1] > table[0, -1] * (1 + 1e-9):
        raise InputError(
            f"band = ({periods[0]:g}, {periods[-1]:g}): must be within the periods of the target, "
            f"{table[0, 0]:g} to {table[0, -1]:g} s"
        )
    peak = float(table[1].max())
    if not _SMALLEST < peak < _LARGEST:
        warn([f"target: the largest pseudo-acceleration is {peak:.4g} g: is it in g?"])
    values: _Array = np.exp(np.interp(np.log(periods), np.log(table[0]), np.log(table[1])))
    return values


@checked
def write_suite(selection: Selection, path: str | os.PathLike[str]) -> None:
    """Write a list of records with factors, which `rwmf.find_records` reads.

    Parameters
    ----------
    selection : Selection
        The records; each needs a separate file, or both horizontal channels of one file.
    path : str or path
        File to write.

    Raises
    ------
    InputError
        When a record is in memory.
    OutputError
        When the file cannot be written.
    """
    if not isinstance(selection, Selection):
        raise InputError(f"selection = {show(selection)}: must be the result of select")
    target = Path(path)
    lines = [SUITE_HEADER]
    for name, record in zip(selection.names, selection.records, strict=True):
        if not record.path:
            raise InputError(f"{record.name}: is in memory: a list of records names files")
        same = [item for item in selection.records if item.path == record.path]
        if record.array is not None and record.name != Path(record.path).stem and len(same) < 2:
            raise InputError(f"{record.name}: is one channel of {record.path}: export it first")
        file = os.path.relpath(record.path, target.absolute().parent)
        line = f"{file},{record.scale!r},{name}"
        if any(mark in file + name for mark in ',\n"'):
            raise InputError(f"{record.path}: a list cannot hold this name")
        if line not in lines:
            lines.append(line)
    files.write_bytes(target, ("\n".join(lines) + "\n").encode())
