"""Scenes of ratios expressed in kg, N and Pa."""

import math
from typing import Any

import rwmf

Groups = dict[str, dict[str, Any]]

DENSITY, THICKNESS, STRANDS, STRAND_AREA, LENGTH = 2400.0, 0.3, 7, 140e-6, 1.7
G = 9.81
MOTION: dict[str, Any] = {"kind": "one_sine", "a_max_g": 0.4, "T_p": 1.0}
_BASE: dict[str, Any] = {
    "wall": {"h": 9.0, "b": 2.0},
    "frame": {"xi_s": 0.05, "T_s": 0.8, "gamma": 4.0},
    "motion": MOTION,
    "solver": {"t_end": 5.0},
}
STOREYS: dict[str, Any] = {
    "m_over_m_w": [1.5, 1.5, 1.0],
    "k_over_m_w": [900.0, 700.0, 500.0],
    "height": [6.0, 6.0, 6.0],
}
CABLE = {"eta_0": 0.5, "eta_alpha": 3.0}
SCENES: dict[str, dict[str, Any]] = {
    "frame": {},
    "bare": {"wall": None, "frame": {"xi_s": 0.05, "T_s": 0.8}},
    "block": {"frame": None, "cable": CABLE | {"law": "truss"}},
    "pinned": {"wall": {"h": 9.0, "b": 2.0, "base": "pinned"}, "damper": {"c_over_m_w": 0.4}},
    "corners": {
        "damper": {"c_over_m_w": 0.4},
        "inerter": {"inertance_over_m_w": 0.7},
        "fuse": {"eta_y": 0.2, "stroke_y": 0.004},
        "cable": CABLE | {"eta_y": 0.9, "hardening": 0.02},
    },
    "rupture": {"cable": CABLE | {"rupture_strain": 0.005}},
    "yielding": {"yielding": {"u_y": 0.02, "hardening": 0.05}, "cable": CABLE},
    "bare yielding": {
        "wall": None,
        "frame": {"xi_s": 0.05, "T_s": 0.8},
        "yielding": {"u_y": 0.02},
    },
} | {
    f"storeys {coupling}": {
        "frame": {"xi_s": 0.05},
        "storeys": STOREYS | {"coupling": coupling} | links,
        "yielding": {"storey_u_y": [0.01, 0.02, 0.03]} if coupling != "reduced" else {"u_y": 0.02},
    }
    for coupling, links in (
        ("reduced", {}),
        ("every_floor", {}),
        ("full", {}),
        ("springs", {"k_link_over_m_w": [4e3, 5e3, 6e3]}),
    )
}
SCENES["p_delta"] = {"p_delta": {"m_g_over_m_s": 1.2}}
SCENES["storeys p_delta"] = SCENES["storeys full"] | SCENES["p_delta"]
SCENES["bare storeys"] = {"wall": None, "frame": {"xi_s": 0.05}, "storeys": STOREYS}


_UNITS = {"m_over_m_w": "m", "k_over_m_w": "k"}


def groups_of(scene: str) -> dict[str, Any]:
    """Return the groups of a scene in ratios.

    Parameters
    ----------
    scene : str
        One of `SCENES`.

    Returns
    -------
    dict
        Keys and values of each group.
    """
    return {key: value for key, value in (_BASE | SCENES[scene]).items() if value is not None}


def in_both(scene: str) -> tuple[rwmf.Case, rwmf.Case]:
    """Make a case in ratios, and the same in units.

    Parameters
    ----------
    scene : str
        One of `SCENES`.

    Returns
    -------
    tuple of Case
        Both with a mass, so that both have results in N.
    """
    groups = groups_of(scene)
    units = in_units(groups)
    if "wall" in groups:
        groups["wall"] = groups["wall"] | {"m_w": 4 * 9.0 * 2.0 * THICKNESS * DENSITY}
    elif "storeys" in groups:
        # any mass will do for ratios; those of storeys in kg are over 1 kg
        lists = {ratio: units["storeys"][key] for ratio, key in _UNITS.items()}
        groups["storeys"] = groups["storeys"] | lists
    return rwmf.Case(**groups), rwmf.Case(**units)


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
        ("storeys", "k_link_over_m_w", "k_link", m_w),
        ("damper", "c_over_m_w", "c", m_w),
        ("inerter", "inertance_over_m_w", "inertance", m_w),
        ("fuse", "eta_y", "F_y", m_w * G),
    ):
        if ratio in found.get(group, {}):
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
