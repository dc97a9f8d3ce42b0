"""Scenes of ratios said once more in kg, N and Pa."""

from __future__ import annotations

import math
from typing import Any

Groups = dict[str, dict[str, Any]]

DENSITY, THICKNESS, STRANDS, STRAND_AREA, LENGTH = 2400.0, 0.3, 7, 140e-6, 1.7
G = 9.81


def in_units(groups: Groups) -> Groups:
    """Say the masses, stiffnesses and forces of a case by dimensional keys.

    Parameters
    ----------
    groups : dict
        Groups of a case in ratios. A frame without wall gets a mass of 3000 kg.

    Returns
    -------
    dict
        Groups of the same case.
    """
    found = {name: dict(keys) for name, keys in groups.items()}
    m_w = 3000.0
    if "wall" in found:
        m_w = 4 * found["wall"]["h"] * found["wall"]["b"] * THICKNESS * DENSITY
        found["wall"] |= {"density": DENSITY, "thickness": THICKNESS}
    for group, ratio, key, unit in (
        ("storeys", "m_over_m_w", "m", m_w),
        ("storeys", "k_over_m_w", "k", m_w),
        ("damper", "c_over_m_w", "c", m_w),
        ("inerter", "inertance_over_m_w", "inertance", m_w),
        ("fuse", "eta_y", "F_y", m_w * G),
    ):
        if group in found:
            value = found[group].pop(ratio)
            many = isinstance(value, list)
            found[group][key] = [unit * item for item in value] if many else unit * value
    if "fuse" in found:
        found["fuse"]["k"] = found["fuse"]["F_y"] / found["fuse"].pop("stroke_y")
    if "frame" in found and "storeys" not in found:
        frame = found["frame"]
        frame["m_s"] = frame.pop("gamma", 1.0) * m_w
        if "T_s" in frame:
            frame["k_s"] = frame["m_s"] * (2 * math.pi / frame.pop("T_s")) ** 2
    if "m_g_over_m_s" in found.get("p_delta", {}):
        mass = sum(found["storeys"]["m"]) if "storeys" in found else found["frame"]["m_s"]
        found["p_delta"]["m_g"] = mass * found["p_delta"].pop("m_g_over_m_s")
    if "yielding" in found:
        _yield(found)
    if "cable" in found:
        _stretch(found["cable"], found["wall"], m_w * G)
    return found


def _yield(found: Groups) -> None:
    """Turn displacements at first yield of a frame, or of its storeys, into forces."""
    keys = found["yielding"]
    if "storey_u_y" in keys:
        pairs = zip(keys.pop("storey_u_y"), found["storeys"]["k"], strict=True)
        keys["storey_F_y"] = [u_y * k for u_y, k in pairs]
    elif "storeys" not in found and "u_y" in keys:
        keys["F_y"] = found["frame"]["k_s"] * keys.pop("u_y")


def _stretch(cable: dict[str, Any], wall: dict[str, Any], weight: float) -> None:
    """Strands over a length that is not the height of the wall."""
    area = STRANDS * STRAND_AREA
    stress = weight * cable.pop("eta_0") / area
    eta_alpha = cable.pop("eta_alpha", None)
    last = stress if eta_alpha is None else weight * eta_alpha / area
    strain = elongation(wall["h"], wall["b"], cable.get("law", "linear")) / LENGTH
    cable |= {
        "strands": STRANDS,
        "strand_area": STRAND_AREA,
        "initial_stress": stress,
        "modulus": (last - stress) / strain,
        "length": LENGTH,
    }
    if "eta_y" in cable:
        cable["yield_stress"] = weight * cable.pop("eta_y") / area
    if "rupture_strain" in cable:
        cable["rupture_strain"] *= 2 * wall["h"] / LENGTH


def elongation(h: float, b: float, law: str) -> float:
    """Elongation of the cable at theta = alpha.

    Parameters
    ----------
    h, b : float
        Half height and half width of the wall [m].
    law : str
        'linear' for Eq. (1), 'truss' for the straight cable.

    Returns
    -------
    float
        The elongation [m].
    """
    alpha = math.atan2(b, h)
    if law == "linear":
        return b * alpha
    # from the middle of the base to that of the top, which turns about the corner that stays
    x = b * (1 - math.cos(alpha)) + 2 * h * math.sin(alpha)
    y = b * math.sin(alpha) + 2 * h * math.cos(alpha)
    return math.hypot(x, y) - 2 * h
