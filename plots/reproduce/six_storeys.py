"""A frame of six storeys that yields and leans, against OpenSees."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import NamedTuple

import numpy as np
from rwmf import Case, simulate
from rwmf.errors import InputError
from rwmf.kernel import files

from reproduce.engines import EngineHistory
from reproduce.responses import Array

__all__ = ["CASES", "COLUMNS", "FULL", "VARIANTS", "FrameDifference", "compare_frame", "peaks_of",
           "read_peaks", "variant", "write_peaks"]  # fmt: skip

CASES = ("six_storeys", "six_storeys_pulse")
_FLOORS = range(1, 7)
# of a stored history
COLUMNS = (
    "t_s",
    *(f"storey_{i}_drift" for i in _FLOORS),
    *(f"floor_{i}_acceleration_g" for i in _FLOORS),
)
FULL = "yielding and P-Delta"
# groups removed from the case
VARIANTS: dict[str, tuple[str, ...]] = {
    FULL: (),
    "yielding": ("p_delta",),
    "P-Delta": ("yielding",),
    "neither": ("yielding", "p_delta"),
}


class FrameDifference(NamedTuple):
    """Distances of a frame from that of an engine, storey by storey.

    Attributes
    ----------
    ours : numpy.ndarray, shape (12,)
        Largest drifts [-] and accelerations [g], in the order of `COLUMNS`.
    peak : numpy.ndarray, shape (12,)
        Relative differences of the peaks [-].
    history : numpy.ndarray, shape (12,)
        Largest difference over time, over the engine's peak [-].
    """

    ours: Array
    peak: Array
    history: Array


def variant(case: Case, name: str) -> Case:
    """Remove the parts that a variant lacks."""
    for group in VARIANTS[name]:
        case = case.without(group)
    return case


def peaks_of(case: Case) -> Array:
    """Simulate a frame for its largest drifts [-] and accelerations [g]."""
    response = simulate(case)
    names = [*(f"storey_{i}_drift_max" for i in _FLOORS)]
    names += [f"floor_{i}_acceleration_max_g" for i in _FLOORS]
    return np.array([float(response[name]) for name in names])


def compare_frame(case: Case, engine: EngineHistory, peaks: Array) -> FrameDifference:
    """Measure how far a frame is from an engine's."""
    response, ours = simulate(case), peaks_of(case)
    t = response["time"].values
    history = [
        np.abs(np.interp(engine["t_s"], t, response[name].values) - engine[name]).max()
        for name in COLUMNS[1:]
    ]
    return FrameDifference(ours, np.abs(ours / peaks - 1), np.array(history) / peaks)


def write_peaks(path: Path, peaks: dict[str, Array]) -> None:
    """Store the peaks of all variants."""
    lines = [",".join(["peak", *peaks])]
    for i, name in enumerate(COLUMNS[1:]):
        lines.append(",".join([name, *(f"{values[i]:.7g}" for values in peaks.values())]))
    files.write_bytes(path, ("\n".join(lines) + "\n").encode())


def read_peaks(path: Path) -> dict[str, Array]:
    """Read the peaks of all variants."""
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            heads, *rows = csv.reader(stream)
        values = np.array([[float(cell) for cell in row[1:]] for row in rows]).T
        return dict(zip(heads[1:], values, strict=True))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a table of peaks: {error}") from error
