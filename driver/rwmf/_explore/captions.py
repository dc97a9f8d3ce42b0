"""Sentences that explain the response of a case with its own numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from rwmf.case import Case
from rwmf.quantities import Quantity

# with these, the acceleration at uplift is no constant of the case
_CHANGING_UPLIFT = ("storeys", "bending", "vertical", "initial")
# energies that are dissipated, and their names
_DISSIPATED = {
    "impact": "impacts",
    "viscous": "dampers",
    "hysteretic": "yielding",
    "bending_damping": "damping of the wall's modes",
}
# largest storey drift over that of the roof [-] for drifts that hardly differ
_EVEN = 1.05
# a part of the input below this is not mentioned
_LEAST_PART = 0.005


def captions_of(
    case: Case, summary: Mapping[str, Any], t_lift_off: float | None, yields: Sequence[bool]
) -> list[str]:
    """Explain the response of a case."""
    found = [
        _uplift(case, summary, t_lift_off),
        _rotation(case, summary),
        _tendon(summary),
        _concentration(summary),
        _yielding(summary, yields),
        _collapse(summary),
        _energy(summary),
    ]
    return [text for text in found if text]


def uplift_acceleration(case: Case) -> float | None:
    """Compute the ground acceleration at which the resting wall lifts off."""
    if case.wall is None or case.wall.base != "rocking":
        return None
    if any(name in case.groups for name in _CHANGING_UPLIFT):
        return None
    prestress = 0.0 if case.cable is None else float(case.cable.eta_0)
    gamma = 0.0 if case.frame is None else float(case.frame.gamma)
    return float(case.wall.b / case.wall.h) * (1.0 + prestress) / (1.0 + 2.0 * gamma)


def _uplift(case: Case, summary: Mapping[str, Any], t_lift_off: float | None) -> str:
    if case.wall is None or case.wall.base != "rocking":
        return ""
    needed = uplift_acceleration(case)
    if t_lift_off is not None:
        beyond = f", where the ground passes {needed:.2g} g" if needed is not None else ""
        return f"The wall lifts off at {t_lift_off:.2f} s{beyond}."
    if summary.get("theta_max_over_alpha", 0.0) > 0.0:
        return ""
    if needed is None:
        return "No uplift: the base stays closed."
    peak = case.kernel.peak_of_motion() / float(case.model.g)
    return f"No uplift: it needs {needed:.2g} g, and the ground reaches {peak:.2g} g."


def _rotation(case: Case, summary: Mapping[str, Any]) -> str:
    ratio = summary.get("theta_max_over_alpha", 0.0)
    if summary.get("overturned"):
        return "The wall overturns."
    if not ratio > 0.0 or case.wall is None:
        return ""
    alpha = math.atan2(float(case.wall.b), float(case.wall.h))
    size = f"its slenderness α = {alpha:.3g} rad"
    if ratio > 1.0:
        return f"It rotates to {ratio:.3g} times {size}: beyond α its weight overturns it."
    return f"It rotates to {_percent(ratio)} of {size}."


def _tendon(summary: Mapping[str, Any]) -> str:
    if summary.get("cable_ruptured"):
        return "The tendon ruptures."
    loss = summary.get("cable_prestress_loss_over_m_w_g", 0.0)
    if not loss > 0.0:
        return ""
    newtons = summary.get("cable_prestress_loss_N")
    size = f"{loss:.2g} m_w g" if newtons is None else f"{1e-3 * newtons:.3g} kN"
    return f"The tendon yields and loses {size} of its prestress."


def _concentration(summary: Mapping[str, Any]) -> str:
    """Compare the largest storey drift with the drift of the roof."""
    largest, roof = summary.get("storey_drift_max", 0.0), summary.get("roof_drift_max", 0.0)
    if not (largest > 0.0 and roof > 0.0):
        return ""
    storey = next(
        i for i in range(1, 1000) if summary.get(f"storey_{i}_drift_max", largest) == largest
    )
    ratio = f"{largest / roof:.2g} times" if largest > _EVEN * roof else "nearly"
    return f"Storey {storey} has the largest IDR, {100 * largest:.3g} %: {ratio} that of the roof."


def _yielding(summary: Mapping[str, Any], yields: Sequence[bool]) -> str:
    if not yields:
        return ""
    ductility = summary.get("ductility")
    if ductility is None:
        ductility = max(summary[f"storey_{i + 1}_ductility"] for i in range(len(yields)))
    size = f"ductility {ductility:.3g}"
    if not any(yields):
        return f"The frame stays elastic: {size}."
    if len(yields) == 1:
        return f"The frame yields: {size}."
    storeys = [str(i + 1) for i, has_yielded in enumerate(yields) if has_yielded]
    if len(storeys) == 1:
        return f"Storey {storeys[0]} yields: {size}."
    return f"Storeys {', '.join(storeys[:-1])} and {storeys[-1]} yield: largest {size}."


def _collapse(summary: Mapping[str, Any]) -> str:
    if not summary.get("collapsed"):
        return ""
    return f"It collapses at {summary['t_collapse_s']:.2f} s, at a limit of its drift."


def _energy(summary: Mapping[str, Any]) -> str:
    total = summary.get("energy_input_J_per_kg", 0.0)
    if not total > 0.0:
        return ""
    parts = {
        name: summary.get(f"energy_{key}_J_per_kg", 0.0) / total
        for key, name in _DISSIPATED.items()
    }
    if sum(parts.values()) > 1.0 + _LEAST_PART:
        # the weight of a leaning or falling structure adds energy
        return ""
    ordered = sorted(parts.items(), key=lambda part: -part[1])
    texts = [f"{name} {_percent(part)}" for name, part in ordered if part >= _LEAST_PART]
    return f"Of the energy put in by the ground, {', '.join(texts)} at the end." if texts else ""


def _percent(part: float) -> str:
    return f"{100 * part:.0f} %" if part >= 0.0995 else f"{100 * part:.2g} %"


def compare_with_frame(quantity: Quantity, value: float, alone: float | None) -> str:
    """Compare a peak with that of the frame without a wall."""
    if alone is None or not (math.isfinite(value) and math.isfinite(alone) and alone > 0.0):
        return ""
    change = 100.0 * (value / alone - 1.0)
    comparison = f"{_percent(abs(change) / 100)} {'less' if change < 0 else 'more'} than"
    if abs(change) < 0.05:
        comparison = "as much as"
    return f"At the period of the case, {quantity.meaning}: {comparison} the frame alone."
