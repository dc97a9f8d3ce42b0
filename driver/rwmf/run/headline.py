"""Scalars of a run as text: a headline of six lines, and a table by groups."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any, NamedTuple

from rwmf.case import Case
from rwmf.case.elements import total
from rwmf.run.quantities import SENSITIVITY, Quantity, find_numbered

_ASK = "not in the result (&output reactions = .false.)"
_PARTS = {"frame": "u_s_max_m", "wall": "theta_max_over_alpha"}
_SCALAR_OF_EFFECT = {
    "wall": "theta_max_over_alpha",
    "frame": "u_s_max_m",
    "cable": "cable_force_increment_max_over_m_w_g",
    "impact": "impacts",
}
_WIDTH = 100


def headline(summary: Mapping[str, Any], tendon_yield: float | None) -> list[str]:
    """Summarize a run in six lines."""
    return [f"{name:26s}{text}" for name, text in headline_rows(summary, tendon_yield).items()]


def headline_rows(summary: Mapping[str, Any], tendon_yield: float | None) -> dict[str, str]:
    """Return the lines of `headline` as name and text."""
    return {
        "roof displacement": _displacement(summary),
        "interstorey drift (IDR)": _drift(summary),
        "floor acceleration (PFA)": _acceleration(summary),
        "tendon force": _tendon(summary, tendon_yield),
        "residual drift": _residual(summary),
        "impacts and events": _events(summary),
    }


def tendon_yield_of(case: Case) -> float | None:
    """Return the force at which all tendons of a case yield."""
    if case.cable is None or "eta_y" not in case.cable:
        return None
    return total(case.cable, case.cable.eta_y)


def is_complete(summary: Mapping[str, Any]) -> bool:
    """Check whether scalars are those of a whole run, not of a selection or a static curve."""
    effects = summary.get("effects") or ()
    scalars = [key for effect, key in _SCALAR_OF_EFFECT.items() if effect in effects]
    return bool(scalars) and all(key in summary for key in scalars)


def _displacement(summary: Mapping[str, Any]) -> str:
    if "u_s_max_m" not in summary:
        return f"no frame; the wall rotates to {summary['theta_max_over_alpha']:.3g} alpha"
    height = _percent(summary, "roof_drift_max", " ({} of the height)")
    return f"{1e3 * summary['u_s_max_m']:.4g} mm{height}{_at(summary, 't_u_s_max_s')}"


def _drift(summary: Mapping[str, Any]) -> str:
    if "u_s_max_m" not in summary:
        return "no frame"
    if "storey_drift_max" in summary:
        where = _where(summary, "storey_{i}_drift_max", "storey")
        time = _at(summary, "t_storey_drift_max_s")
        return _percent(summary, "storey_drift_max", f"{{}}{where}{time}")
    if "roof_drift_max" in summary and "modal_mass_over_m_w" not in summary:
        return _percent(summary, "roof_drift_max", "{} (one storey)")
    return "the case gives no height" if "floor_acceleration_max_g" in summary else _ASK


def _acceleration(summary: Mapping[str, Any]) -> str:
    if "floor_acceleration_max_g" not in summary:
        return _ASK if "u_s_max_m" in summary else "no frame"
    where = _where(summary, "floor_{i}_acceleration_max_g", "floor")
    time = _at(summary, "t_floor_acceleration_max_s")
    return f"{summary['floor_acceleration_max_g']:.3g} g{where}{time}"


def _tendon(summary: Mapping[str, Any], tendon_yield: float | None) -> str:
    if "cable_force_increment_max_over_m_w_g" not in summary:
        return "no tendon"
    names = ("tendon_force_max", "cable_force_increment_max")
    name = next(name for name in names if f"{name}_over_m_w_g" in summary)
    force = summary[f"{name}_over_m_w_g"]
    text = f"{force:.4g} m_w g"
    if f"{name}_N" in summary:
        text = f"{1e-3 * summary[f'{name}_N']:.4g} kN"
    if name != "tendon_force_max":
        text += " above the prestress"
    elif tendon_yield is None:
        text += ", the tendon is elastic"
    else:
        text += f", {force / tendon_yield:.3g} of yield"
    return text + (", ruptured" if summary.get("cable_ruptured") else "")


def _residual(summary: Mapping[str, Any]) -> str:
    at_rest, unloaded = "roof_residual_drift_at_rest", "roof_residual_drift"
    if "storey_residual_drift_max" in summary:
        where = _where(summary, "storey_{i}_residual_drift", "storey")
        roof = _percent(summary, unloaded, ", {} at the roof")
        return _percent(summary, "storey_residual_drift_max", f"{{}}{where}{roof}")
    for key, place in ((unloaded, "at the roof"), (at_rest, "at the roof, at rest")):
        if key in summary:
            return _percent(summary, key, f"{{}} {place}")
    if "residual_displacement_m" in summary:
        return f"{1e3 * abs(summary['residual_displacement_m']):.3g} mm"
    if "theta_end_over_alpha" in summary:
        return f"rotation {abs(summary['theta_end_over_alpha']):.3g} alpha at the end"
    if summary.get("overturned"):
        return "the wall lies"
    parts = [word for word, key in _PARTS.items() if key in summary]
    return f"none: the {' and the '.join(parts)} return" + ("s" if len(parts) == 1 else "")


def _events(summary: Mapping[str, Any]) -> str:
    parts = [
        f"{summary[key]} {word}" + ("s" if summary[key] != 1 else "")
        for key, word in (("impacts", "impact"), ("lift_offs", "lift-off"))
        if key in summary
    ]
    if summary.get("collapsed"):
        parts.append("collapsed" + _at(summary, "t_collapse_s"))
    for key, words in (("overturned", "overturned"), ("pivot_lifts", "the pivot lifts")):
        if summary.get(key):
            parts.append(words)
    endings = [word for word in ("overturned", "collapsed") if word in summary]
    if endings and not any(summary[word] for word in endings):
        parts.append(f"not {' or '.join(endings)}")
    return ", ".join(parts) or "none"


def _percent(summary: Mapping[str, Any], key: str, text: str) -> str:
    """Return a text with a drift in percent; '' when the run has none."""
    return text.format(f"{100 * abs(summary[key]):.3g} %") if key in summary else ""


def _at(summary: Mapping[str, Any], key: str) -> str:
    return f" at {summary[key]:.2f} s" if key in summary else ""


def _where(summary: Mapping[str, Any], pattern: str, level: str) -> str:
    """Return the storey or floor with the largest value."""
    values: dict[int, float] = {}
    while (key := pattern.format(i=len(values) + 1)) in summary:
        values[len(values) + 1] = abs(summary[key])
    return f" ({level} {max(values, key=values.__getitem__)})" if values else ""


def grouped(
    summary: Mapping[str, Any],
    *,
    has_names: bool = False,
    digits: Mapping[str, int] | None = None,
) -> list[str]:
    """List the scalars of a run by the group that they belong to."""
    rows: dict[str, dict[str, list[str]]] = {}
    held = digits or {}
    for title, found in rows_by_title(summary).items():
        for item, keys, times in found:
            is_numbered = "{i}" in item.key
            # the first and the last number, as 1..6
            numbers = sorted(number for key in keys if (number := find_numbered(key)[1]))
            ends = "..".join(map(str, dict.fromkeys([*numbers[:1], *numbers[-1:]])))
            label = item.key.replace("{i}", ends)
            if has_names and item.name:
                shown = item.over_levels if is_numbered else item
                label = f"{shown.names('run')[0]} [{item.unit}]"
            most = 4 if is_numbered else 6
            texts = [value_text(key, summary[key], min(most, held.get(key, 6))) for key in keys]
            texts += [f"at {summary[time]:.4g} s" for time in times]
            rows.setdefault(title, {}).setdefault(label, []).extend(texts)
    width = max(len(label) for labels in rows.values() for label in labels)
    lines = []
    for title, labels in rows.items():
        lines.append(title)
        for label, texts in labels.items():
            lines += textwrap.wrap(
                " ".join(texts), _WIDTH, initial_indent=f"  {label:{width}s}  ",
                subsequent_indent=" " * (width + 4),
            )  # fmt: skip
    return lines


class Row(NamedTuple):
    """A quantity in a table of a run's scalars.

    Attributes
    ----------
    item : Quantity
        The quantity.
    keys : list of str
        Its keys in the run: one, or that of each storey, floor or mode from the ground up.
    times : list of str
        Keys of the times of its peak.
    """

    item: Quantity
    keys: list[str]
    times: list[str]


def rows_by_title(summary: Mapping[str, Any]) -> dict[str, list[Row]]:
    """Sort the scalars of a run into the groups of `grouped`."""
    found = {key: find_numbered(key) for key in summary if not key.startswith(SENSITIVITY)}
    names = {item.name for item, _ in found.values()}
    times = {item.name[2:]: key for key, (item, _) in found.items() if item.found == "time"}
    rows: dict[str, dict[str, Row]] = {}
    for key, (item, number) in found.items():
        # a force in N replaces its ratio, and a time is beside its peak
        in_newtons = item.name.removesuffix("_over_m_w_g")
        if item.found == "time" or (in_newtons != item.name and in_newtons in names):
            continue
        row = rows.setdefault(_title(item), {}).setdefault(item.key, Row(item, [], []))
        row.keys.append(key)
        peaks = [name for name in times if not number and item.name.startswith(name)]
        row.times.extend(times.pop(peak) for peak in peaks)
    return {title: list(found.values()) for title, found in rows.items()}


def _title(item: Quantity) -> str:
    """Return the title above a quantity."""
    if not item.name:
        return "computation"
    if item.asked_by == "energy" or item.key.startswith("wall_"):
        return item.key.split("_")[0]
    return item.group or "building"


def value_text(key: str, value: object, digits: int = 10) -> str:
    """Return the text of a scalar."""
    if key == "warnings":
        return str(len(value if isinstance(value, list) else str(value).splitlines()))
    if isinstance(value, list):
        return ", ".join(map(str, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    # zero without a sign
    return f"{value + 0.0:.{digits}g}" if isinstance(value, float) else str(value)
