"""The model against engines that are given neither kinematics nor restitution: numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

from rwmf._simulation import simulate
from rwmf.case import Case

from reproduce.engines import Difference, EngineHistory, compare
from reproduce.formulations import Changes
from reproduce.histories import VALIDATION, stored
from reproduce.response_cache import ResponseCache

__all__ = [
    "VARIANTS",
    "Row",
    "Tolerance",
    "agrees",
    "fitted_restitution",
    "measure",
    "tolerance",
]


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
class Row:
    """One line of the validation table.

    Attributes
    ----------
    case, engine, variant : str
        Compared quantity.
    difference : Difference
        How far the variant is from the engine.
    """

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


def measure(cache: ResponseCache) -> list[Row]:
    """Compare every variant of the model with every stored history."""
    rows = []
    for name in VALIDATION:
        case = Case.from_namelist(cache.validation / f"{name}.nml")
        histories = stored(cache, name)
        for variant, changes in VARIANTS.items():
            # a scene without cable has no law to change
            wanted = {k: v for k, v in changes.items() if k != "cable" or case.cable is not None}
            if changes is _LINEAR and not wanted:
                continue
            response = simulate(case.replace(**wanted))
            for engine, history in histories.items():
                rows.append(Row(name, engine, variant, compare(response, history)))
    return rows


def fitted_restitution(case: Case, history: EngineHistory) -> float:
    """Find the constant restitution with which the model is closest to an engine's history."""
    allowed = float(simulate(case)["e_max"])
    fast = case.replace(solver={"method": "dop853"}, output={"dt": 2e-3})

    def distance(e: float) -> float:
        response = simulate(fast.replace(impact={"rule": "constant", "e": e}))
        return compare(response, history).theta_rms

    return _minimum(distance, allowed - 0.01, min(allowed + 0.01, 1.0))


def _minimum(function: Callable[[float], float], low: float, high: float) -> float:
    """Golden-section search for the minimum of a function with one."""
    golden = 0.6180339887498949
    inner = [high - golden * (high - low), low + golden * (high - low)]
    values = [function(x) for x in inner]
    while high - low > 2e-6:
        if values[0] < values[1]:
            high, inner[1], values[1] = inner[1], inner[0], values[0]
            inner[0] = high - golden * (high - low)
            values[0] = function(inner[0])
        else:
            low, inner[0], values[0] = inner[0], inner[1], values[1]
            inner[1] = low + golden * (high - low)
            values[1] = function(inner[1])
    return 0.5 * (low + high)
