"""Stored histories of independent engines, and distances of a response from them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from rwmf import Case, simulate
from rwmf.errors import InputError
from rwmf.kernel import files
from scipy.optimize import minimize_scalar

from reproduce.responses import Array, Changes, Responses

__all__ = ["COLUMNS", "ENGINES", "RIGID", "VALIDATION", "VARIANTS", "Difference", "EngineHistory",
           "Tolerance", "agrees", "compare", "crossings", "fitted_restitution", "measure", "read",
           "stored", "tolerance", "write"]  # fmt: skip

# of a stored history; without a frame the last one is missing
COLUMNS = ("t_s", "theta_rad", "theta_dot_rad_s", "left_uplift_m", "right_uplift_m", "u_s_m")
# folder of stored histories, name in a legend
ENGINES = {
    "mujoco": "MuJoCo, rigid contact",
    "opensees": "OpenSees, no-tension corners",
    "calculix": "CalculiX, deformable wall",
}
# those whose wall does not deform
RIGID = ("mujoco", "opensees")
VALIDATION = ("free", "block", "g5", "g1800", "disc")
_LINEAR: Changes = MappingProxyType({"cable": {"law": "linear"}})
VARIANTS: dict[str, Changes] = {
    "exact, straight cable, momentum balance": MappingProxyType({}),
    "exact, Eq. (1), momentum balance": _LINEAR,
    "symmetric, straight cable, momentum balance": MappingProxyType(
        {"model": {"formulation": "symmetric"}}
    ),
    "published, e = 0.9": MappingProxyType(
        {
            "model": {"formulation": "published"},
            "impact": {"rule": "constant", "e": 0.9},
            **_LINEAR,
        }
    ),
}


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


@dataclass(frozen=True)
class Tolerance:
    """Criteria of agreement with an engine.

    Attributes
    ----------
    relative : float
        Largest relative difference of a peak and root-mean-square difference over the peak [-].
    u_s_rms : float
        Root-mean-square difference of the displacement over its peak [-].
    impact_time : float
        Largest difference of an impact's instant [s].
    """

    relative: float
    u_s_rms: float
    impact_time: float


# a rigid wall whose contact takes about half a millisecond
_RIGID = Tolerance(3e-3, 3e-3, 1e-3)
# and one on springs of 1e12 N/m
_STIFF = Tolerance(1e-3, 1e-3, 5e-4)
# the wall of finite elements bends and vibrates, unlike the model's. Where it hardly rotates, at
# the end of g1800, this moves its impacts, while the frame is unaffected
_SOFT = {"g5": Tolerance(2e-2, 2e-2, 5e-4), "g1800": Tolerance(2e-2, 3e-3, 2e-3)}


def tolerance(engine: str, case: str) -> Tolerance:
    """Return the criteria of agreement with the history of an engine for a case."""
    return {"mujoco": _RIGID, "opensees": _STIFF}.get(engine) or _SOFT[case]


def read(path: Path) -> EngineHistory:
    """Read a stored history."""
    try:
        with path.open(encoding="utf-8") as stream:
            facts = json.loads(stream.readline().removeprefix("#"))
            names = stream.readline().strip().split(",")
            values = np.loadtxt(stream, delimiter=",", ndmin=2)
        return EngineHistory(facts, dict(zip(names, values.T, strict=True)))
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a stored history: {error}") from error


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


def stored(of: Responses, name: str) -> dict[str, EngineHistory]:
    """Read the histories that engines left for a validation case."""
    paths = {engine: of.validation / engine / f"{name}.csv" for engine in ENGINES}
    return {engine: read(path) for engine, path in paths.items() if path.is_file()}


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


class Row(NamedTuple):
    """A variant of the model beside the history of an engine."""

    case: str
    engine: str
    variant: str
    difference: Difference


def agrees(difference: Difference, allowed: Tolerance) -> bool:
    """Tell whether a response is within a tolerance."""
    relative = (difference.theta_rms, difference.theta_peak, difference.u_s_peak)
    # NaN where the scene lacks the quantity: without a frame, no displacement
    return (
        not any(value > allowed.relative for value in relative)
        and not difference.u_s_rms > allowed.u_s_rms
        and difference.impacts == difference.engine_impacts
        and difference.impact_time <= allowed.impact_time
    )


def measure(of: Responses) -> list[Row]:
    """Compare every variant of the model with every stored history."""
    rows = []
    for name in VALIDATION:
        case, histories = of.engine_case(name), stored(of, name)
        for variant, changes in VARIANTS.items():
            # a scene without cable has no law to change
            wanted = {k: v for k, v in changes.items() if k != "cable" or case.cable is not None}
            if changes is _LINEAR and not wanted:
                continue
            response = simulate(case.replace(**wanted))
            rows += [Row(name, engine, variant, compare(response, history))
                     for engine, history in histories.items()]  # fmt: skip
    return rows


def fitted_restitution(case: Case, history: EngineHistory) -> float:
    """Find the constant restitution with which the model is closest to an engine's history."""
    allowed = float(simulate(case)["e_max"])
    fast = case.replace(solver={"method": "dop853"}, output={"dt": 2e-3})

    def distance(e: float) -> float:
        response = simulate(fast.replace(impact={"rule": "constant", "e": e}))
        return compare(response, history).theta_rms

    bounds = (allowed - 0.01, min(allowed + 0.01, 1.0))
    return float(minimize_scalar(distance, bounds=bounds, options={"xatol": 1e-7}).x)
