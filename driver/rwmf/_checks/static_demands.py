"""Demands along a static curve, and the drifts at which they reach the limits of a case."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf._checks.checks import Limit, limits_of
from rwmf._pushover import columns_by_key
from rwmf.case import Case

__all__ = ["columns_by_key", "crossings_of", "demand_along", "drift_at_limit", "ratios_of"]

Array = npt.NDArray[np.float64]
# a protocol often ends at a limit: round-off does not exceed it
_ROUND_OFF = 1e-12


def crossings_of(case: Case, curve: xr.Dataset) -> list[tuple[str, int, float]]:
    """Find where a curve first exceeds the limits of a case."""
    columns = columns_by_key(curve)
    found = []
    for limit in limits_of(case):
        demand = demand_along(case, columns, limit.key)
        if demand is None:
            continue
        ratios = ratios_of(limit, demand)
        drift = drift_at_limit(ratios, columns["roof_drift"])
        if not math.isnan(drift):
            found.append((f"limit_{limit.key}", int(np.argmax(ratios > 1)), drift))
    return found


def drift_at_limit(ratios: Array, drift: Array) -> float:
    """Return the drift of the roof at which a ratio first exceeds 1."""
    above = np.flatnonzero(ratios > 1)
    if not above.size:
        return math.nan
    step = above[0]
    if step == 0:
        return float(drift[0])
    before, after = ratios[step - 1], ratios[step]
    share = (1 - before) / (after - before) if math.isfinite(after) else 0.0
    return float(drift[step - 1] + share * (drift[step] - drift[step - 1]))


def ratios_of(limit: Limit, demand: Array) -> Array:
    """Return the ratio of demand over limit at every step; round-off does not exceed a limit."""
    ratios = np.asarray(limit.ratio(demand), dtype=np.float64)
    return np.where(np.abs(ratios - 1) < _ROUND_OFF, 1.0, ratios)


def demand_along(case: Case, columns: Mapping[str, Array], key: str) -> Array | None:
    """Return a demand at every step."""
    name = key.replace("_max", "").replace("_min", "")
    if name in columns:
        return columns[name]
    if name == "storey_drift":
        storeys = [values for item, values in columns.items() if _is_drift_of_storey(item)]
        return np.asarray(np.max(np.abs(storeys), axis=0)) if storeys else None
    if name == "theta_over_alpha":
        return columns["theta_rad"] / math.atan2(case.wall.b, case.wall.h)
    for beginning in ("tendon_force", "cable_force_increment"):
        if name.startswith(beginning):
            force = columns.get(name.replace(beginning, "cable_force"))
            if force is None or beginning == "tendon_force":
                return force
            # without load the wall stands and the cable has its prestress
            return np.asarray(force - force[0])
    return None


def _is_drift_of_storey(key: str) -> bool:
    return key.startswith("storey_") and key.endswith("_drift")
