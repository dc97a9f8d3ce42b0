"""Stored histories of independent engines, and distances of a response from them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from rwmf._files import files
from rwmf.errors import InputError

__all__ = ["COLUMNS", "Difference", "EngineHistory", "compare", "crossings", "read", "write"]

Array = npt.NDArray[np.float64]
# of a stored history; without a frame the last one is missing
COLUMNS = ("t_s", "theta_rad", "theta_dot_rad_s", "left_uplift_m", "right_uplift_m", "u_s_m")


@dataclass(frozen=True)
class EngineHistory:
    """History of an engine.

    Attributes
    ----------
    facts : dict
        Engine, version and parameters.
    columns : dict of str to numpy.ndarray, each shape (n,)
        As far as the scene has them, those of `COLUMNS`.
    """

    facts: dict[str, Any]
    columns: dict[str, Array]

    def __getitem__(self, name: str) -> Array:
        """Return a column."""
        return self.columns[name]


@dataclass(frozen=True)
class Difference:
    """Distances of a response from that of an engine.

    Attributes
    ----------
    theta_rms, u_s_rms : float
        Root-mean-square difference over the engine's peak [-]; NaN without a frame.
    theta_peak, u_s_peak : float
        Largest relative difference of a peak (theta: the worse of the two signs) [-].
    impacts, engine_impacts : int
        Number of crossings between excursions above 2 % of the peak.
    impact_time : float
        Largest difference of an impact's instant [s]; NaN when the numbers differ.
    """

    theta_rms: float
    u_s_rms: float
    theta_peak: float
    u_s_peak: float
    impacts: int
    engine_impacts: int
    impact_time: float


def read(path: Path) -> EngineHistory:
    """Read a stored history."""
    try:
        with path.open(encoding="utf-8") as stream:
            facts = json.loads(stream.readline().removeprefix("#"))
            names = stream.readline().strip().split(",")
            values = np.loadtxt(stream, delimiter=",", ndmin=2)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a stored history: {error}") from error
    if values.shape[1] != len(names):
        raise InputError(f"{path}: {len(names)} names for {values.shape[1]} columns")
    return EngineHistory(facts, dict(zip(names, values.T, strict=True)))


def write(
    path: Path, facts: dict[str, Any], history: Array, names: Sequence[str] = COLUMNS
) -> None:
    """Store a history: facts as JSON in the first line, then columns to six digits."""
    used = np.flatnonzero(~np.isnan(history).all(axis=0)).tolist()
    lines = [f"# {json.dumps(facts)}", ",".join(names[i] for i in used)]
    lines += [
        ",".join([f"{row[0]:.4f}", *(f"{x:.6g}" for x in row[1:])]) for row in history[:, used]
    ]
    files.write_bytes(path, ("\n".join(lines) + "\n").encode())


def compare(response: xr.Dataset, engine: EngineHistory) -> Difference:
    """Measure how far a response is from an engine's history, over the engine's duration."""
    t = engine["t_s"]
    within = response.sel(time=slice(None, t[-1] + 1e-9))
    theirs, ours = engine["theta_rad"], within["theta"].values
    resampled = np.interp(t, within["time"].values, ours)
    u_s_rms = u_s_peak = float("nan")
    if "u_s_m" in engine.columns:
        u_s = np.interp(t, within["time"].values, within["u_s"].values)
        u_s_rms = _rms(u_s - engine["u_s_m"]) / _peak(engine["u_s_m"])
        u_s_peak = abs(_peak(within["u_s"].values) / _peak(engine["u_s_m"]) - 1)
    here = crossings(within["time"].values, ours)
    there = crossings(t, theirs)
    same = here.size == there.size
    return Difference(
        theta_rms=_rms(resampled - theirs) / _peak(theirs),
        u_s_rms=u_s_rms,
        theta_peak=max(abs(ours.max() / theirs.max() - 1), abs(ours.min() / theirs.min() - 1)),
        u_s_peak=u_s_peak,
        impacts=here.size,
        engine_impacts=there.size,
        impact_time=float(np.abs(here - there).max(initial=0)) if same else float("nan"),
    )


def crossings(t: Array, theta: Array, floor: float = 0.02) -> Array:
    """Instants at which the wall changes sides between two excursions."""
    away = np.flatnonzero(np.abs(theta) > floor * np.abs(theta).max())
    found = []
    for i, j in pairwise(away):
        if theta[i] * theta[j] < 0:
            part = theta[i : j + 1] * np.sign(theta[i])
            k = i + int(np.flatnonzero(part <= 0)[0]) - 1
            found.append(t[k] + (t[k + 1] - t[k]) * theta[k] / (theta[k] - theta[k + 1]))
    return np.array(found)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _peak(values: Array) -> float:
    return float(np.abs(values).max())
