"""Controls of the page for each key: slider range, initial value, exclusions.

Keys, units, types and bounds come from the kernel. This table adds practical ranges of walls and
frames, and the consequences of a choice. A key without an entry has a slider over its bounds.
"""

from __future__ import annotations

import math
from typing import Any

from rwmf.kernel import tables

# groups whose springs may also be linear
_SPRINGS = ("coupling", "restraint")
# usual range of values: low, high, and True for a logarithmic slider
_RANGES: dict[str, tuple[float, float, bool]] = {
    "wall.h": (0.5, 10.0, False),
    "wall.b": (0.1, 3.0, False),
    "wall.m_w": (1e3, 1e6, True),
    "frame.T_s": (0.05, 3.0, False),
    "frame.gamma": (0.1, 2000.0, True),
    "frame.xi_s": (0.0, 0.2, False),
    # of one storey; lists have a slider for each
    "storeys.m_over_m_w": (0.1, 10.0, True),
    "storeys.k_over_m_w": (10.0, 1e4, True),
    "storeys.m": (1e3, 1e6, True),
    "storeys.k": (1e6, 1e9, True),
    "storeys.height": (2.0, 8.0, False),
    "storeys.k_link_over_m_w": (1e2, 1e6, True),
    "storeys.k_link": (1e6, 1e10, True),
    "link.L": (1.0, 100.0, True),
    "bending.EI_over_m_w": (1e3, 1e7, True),
    "bending.EI": (1e7, 1e12, True),
    "bending.E": (1e9, 1e11, True),
    "bending.cracking": (0.1, 1.0, False),
    # each mode takes its own steps; the field accepts all that the kernel does
    "bending.modes": (1, 4, False),
    "bending.xi": (0.0, 0.1, False),
    "damper.c_over_m_w": (0.0, 20.0, False),
    "inerter.inertance_over_m_w": (0.0, 5.0, False),
    "fuse.eta_y": (0.05, 3.0, False),
    "fuse.stroke_y": (1e-3, 0.1, True),
    **{f"{name}.eta_y": (0.05, 3.0, False) for name in _SPRINGS},
    **{f"{name}.stroke_y": (1e-3, 0.1, True) for name in _SPRINGS},
    **{f"{name}.k_over_m_w": (0.1, 1e3, True) for name in _SPRINGS},
    "yielding.u_y": (5e-3, 0.5, True),
    "yielding.f_y_over_m_s_g": (0.02, 2.0, True),
    "yielding.storey_u_y": (1e-3, 0.1, True),
    "yielding.storey_F_y": (1e4, 1e7, True),
    "yielding.ultimate": (1.5, 30.0, False),
    "yielding.cap": (1.1, 10.0, False),
    "yielding.post_cap": (0.5, 20.0, False),
    "yielding.hardening": (-0.2, 0.5, False),
    "yielding.exponent": (1.0, 20.0, False),
    "p_delta.m_g_over_m_s": (0.0, 5.0, False),
    "p_delta.drift_limit": (0.01, 0.3, False),
    "cable.eta_0": (0.0, 5.0, False),
    "cable.eta_alpha": (0.0, 20.0, False),
    "cable.eta_y": (0.5, 10.0, False),
    "cable.rupture_strain": (1e-3, 0.1, True),
    "motion.a_max_g": (0.0, 2.0, False),
    "motion.v_p": (0.0, 3.0, False),
    "motion.omega_p": (1.0, 40.0, True),
    "motion.T_p": (0.1, 6.0, False),
    "motion.cycles": (0.5, 10.0, False),
    "motion.n_pulses": (1, 10, False),
    "motion.gamma_p": (1.05, 5.0, False),
    "motion.nu": (-math.pi, math.pi, False),
    "motion.t_0": (0.0, 5.0, False),
    "motion.scale": (0.0, 4.0, False),
    "vertical.ratio": (-1.0, 1.0, False),
    "vertical.scale": (0.0, 4.0, False),
    "initial.theta_over_alpha": (-1.5, 1.5, False),
    "initial.theta_dot": (-2.0, 2.0, False),
    "model.g": (1.0, 20.0, False),
    "model.overturning_angle": (0.2, math.pi / 2, False),
    "solver.t_end": (1.0, 60.0, False),
    "solver.rtol": (1e-13, 1e-2, True),
    "solver.accuracy": (1e-10, 1e-2, True),
    "solver.atol": (1e-16, 1e-4, True),
    "solver.max_steps": (1000, 50_000_000, True),
    "output.dt": (1e-3, 0.1, True),
    "output.friction_limit": (0.1, 1.5, False),
    "spectrum.T_s_min": (0.02, 1.0, False),
    "spectrum.T_s_max": (1.0, 10.0, False),
    "spectrum.n": (10, 1000, True),
}
# initial value of a key set on the page; other keys start in the middle of their range
_STARTS: dict[str, float | str | list[float] | list[str]] = {
    "wall.h": 2.0,
    "wall.b": 0.5,
    "wall.m_w": 20000.0,
    "wall.density": 2500.0,
    "wall.thickness": 0.3,
    "frame.T_s": 1.0,
    "frame.gamma": 5.0,
    "frame.xi_s": 0.05,
    "frame.m_s": 100000.0,
    "frame.k_s": 4e6,
    "storeys.m_over_m_w": [1.0, 1.0, 1.0],
    "storeys.k_over_m_w": [200.0, 200.0, 200.0],
    "storeys.height": [3.0, 3.0, 3.0],
    "storeys.m": [20000.0],
    "storeys.k": [4e6],
    "storeys.k_link_over_m_w": [1e4],
    "storeys.k_link": [2e8],
    "storeys.n": 3,
    "storeys.T_1": 1.0,
    "storeys.distribution": "linear",
    "bending.EI_over_m_w": 1e5,
    "bending.EI": 2e9,
    "bending.E": 3e10,
    "bending.cracking": 0.5,
    "bending.modes": 2,
    "bending.nu": 0.2,
    "link.L": 8.0,
    "damper.c_over_m_w": 2.0,
    "damper.c": 40000.0,
    "inerter.inertance_over_m_w": 0.5,
    "inerter.inertance": 10000.0,
    "fuse.eta_y": 0.3,
    "fuse.stroke_y": 0.005,
    "fuse.F_y": 60000.0,
    "fuse.k": 1.2e7,
    **{
        f"{name}.{key}": start
        for name in _SPRINGS
        for key, start in (
            ("eta_y", 0.2),
            ("stroke_y", 0.005),
            ("F_y", 1e4),
            ("k", 2e6),
            ("k_over_m_w", 10.0),
            ("c_over_m_w", 0.2),
            ("c", 4e3),
        )
    },
    "restraint.height": 0.0,
    "yielding.u_y": 0.05,
    "yielding.f_y_over_m_s_g": 0.2,
    "yielding.F_y": 100000.0,
    "yielding.storey_u_y": [0.01],
    "yielding.storey_F_y": [40000.0],
    "yielding.ultimate": 10.0,
    "yielding.cap": 4.0,
    "yielding.post_cap": 4.0,
    "yielding.lambda": [30.0],
    "p_delta.h_f": 4.0,
    "p_delta.m_g": 100000.0,
    "cable.eta_0": 1.0,
    "cable.offset": [0.0],
    "cable.eta_y": 3.0,
    "cable.rupture_strain": 0.03,
    "cable.length": 6.0,
    "cable.strands": 4,
    "cable.strand_area": 1.4e-4,
    "cable.modulus": 1.95e11,
    "cable.initial_stress": 5e8,
    "cable.yield_stress": 1.6e9,
    "impact.e": 0.9,
    "impact.r": 0.81,
    "impact.table_theta_dot": [0.0, 1.0],
    "impact.table_e": [0.95, 0.8],
    "motion.kind": "one_sine",
    "motion.a_max_g": 0.4,
    "motion.v_p": 0.6,
    "motion.T_p": 1.0,
    "motion.omega_p": 6.283,
    "motion.gamma_p": 2.0,
    "motion.unit": "g",
    "vertical.ratio": 0.5,
    "initial.theta_over_alpha": 0.5,
    "solver.t_end": 10.0,
    "output.dt": 0.01,
    "output.friction_limit": 0.5,
    "spectrum.T_s": [0.5, 1.0, 2.0],
    "spectrum.T_s_min": 0.05,
    "spectrum.T_s_max": 3.0,
    "spectrum.n": 200,
    "spectrum.gamma": [5.0],
    "spectrum.b": [0.5],
    "spectrum.quantities": ["u_s_max_m"],
}
_STRANDS = ("strands", "strand_area", "modulus", "initial_stress")
# alternative keys: setting one removes the others
_ALTERNATIVES = (
    ("motion.a_max_g", "motion.v_p"),
    ("motion.omega_p", "motion.T_p"),
    ("impact.e", "impact.r"),
    *(
        (f"impact.{factor}", f"impact.{column}")
        for factor in ("e", "r")
        for column in ("table_theta_dot", "table_e")
    ),
    *(
        (f"cable.{ratio}", f"cable.{key}")
        for ratio in ("eta_0", "eta_alpha", "eta_y")
        for key in (*_STRANDS, "yield_stress")
    ),
    ("wall.m_w", "wall.density"),
    ("wall.m_w", "wall.thickness"),
    ("frame.gamma", "frame.m_s"),
    ("frame.T_s", "frame.k_s"),
    ("frame.gamma", "frame.k_s"),
    ("storeys.m_over_m_w", "storeys.m"),
    ("storeys.k_over_m_w", "storeys.k"),
    ("storeys.k_over_m_w", "storeys.m"),
    ("storeys.k_link_over_m_w", "storeys.k_link"),
    ("bending.EI_over_m_w", "bending.EI", "bending.E"),
    ("damper.c_over_m_w", "damper.c"),
    ("inerter.inertance_over_m_w", "inerter.inertance"),
    ("fuse.eta_y", "fuse.F_y"),
    ("fuse.stroke_y", "fuse.k"),
    ("fuse.eta_y", "fuse.k"),
    *(
        (f"{name}.{one}", f"{name}.{other}")
        for name in _SPRINGS
        for one, other in (
            ("eta_y", "F_y"),
            ("stroke_y", "k"),
            ("eta_y", "k"),
            ("c_over_m_w", "c"),
            ("k_over_m_w", "eta_y"),
            ("k_over_m_w", "F_y"),
            ("k_over_m_w", "k"),
        )
    ),
    (
        "yielding.u_y",
        "yielding.f_y_over_m_s_g",
        "yielding.F_y",
        "yielding.storey_u_y",
        "yielding.storey_F_y",
    ),
    ("p_delta.m_g_over_m_s", "p_delta.m_g"),
    ("spectrum.T_s", "spectrum.n"),
    ("spectrum.T_s", "spectrum.T_s_min"),
    ("spectrum.T_s", "spectrum.T_s_max"),
    ("spectrum.T_s", "spectrum.spacing"),
    ("solver.accuracy", "solver.rtol"),
)
_MASS = "wall.m_w|density"
_AXIS = ("spectrum.T_s_min", "spectrum.T_s_max", "spectrum.n")
# keys required by a key when their group is present; 'a|b' means one of two
_BRINGS: dict[str, tuple[str, ...]] = {
    "wall.density": ("wall.thickness",),
    "wall.thickness": ("wall.density",),
    "frame.m_s": (_MASS,),
    "frame.k_s": ("frame.m_s", _MASS),
    "storeys.m": ("storeys.k|T_1", _MASS),
    "storeys.k": ("storeys.m", _MASS),
    "storeys.k_link": (_MASS,),
    "storeys.distribution": ("storeys.n",),
    "bending.EI": (_MASS,),
    "bending.E": ("wall.thickness", _MASS),
    "bending.cracking": ("bending.E",),
    "damper.c": (_MASS,),
    "inerter.inertance": (_MASS,),
    "fuse.F_y": (_MASS,),
    "fuse.k": ("fuse.F_y", _MASS),
    **{f"{name}.eta_y": (f"{name}.stroke_y",) for name in _SPRINGS},
    **{f"{name}.stroke_y": (f"{name}.eta_y|F_y",) for name in _SPRINGS},
    **{f"{name}.F_y": (f"{name}.stroke_y|k", _MASS) for name in _SPRINGS},
    **{f"{name}.{key}": (_MASS,) for name in _SPRINGS for key in ("k", "c")},
    "yielding.F_y": ("frame.gamma|m_s", _MASS),
    "yielding.storey_F_y": (_MASS,),
    "yielding.cap": ("yielding.post_cap",),
    "yielding.post_cap": ("yielding.cap",),
    "yielding.lambda_exponent": ("yielding.lambda",),
    "p_delta.m_g": ("frame.gamma|m_s", _MASS),
    "cable.eta_y": ("cable.eta_alpha",),
    "cable.rupture_strain": ("cable.eta_alpha|modulus",),
    **{f"cable.{key}": (*(f"cable.{other}" for other in _STRANDS if other != key), _MASS)
       for key in _STRANDS},
    "cable.yield_stress": ("cable.strands",),
    "impact.table_theta_dot": ("impact.table_e",),
    "impact.table_e": ("impact.table_theta_dot",),
    **{key: tuple(other for other in _AXIS if other != key) for key in _AXIS},
    "spectrum.spacing": _AXIS,
}  # fmt: skip
_EACH_STOREY = tuple(f"storeys.coupling={word}" for word in ("full", "springs", "every_floor"))
# keys that require one of these, or none of them (!), but not for completeness
_ONLY_BESIDE: dict[str, tuple[str, ...]] = {
    "cable.length": ("cable.strands", "cable.rupture_strain"),
    "cable.hardening": ("cable.eta_y", "cable.yield_stress"),
    **{
        f"{name}.{key}": (f"{name}.eta_y", f"{name}.F_y")
        for name in _SPRINGS
        for key in ("hardening", "law")
    },
    "output.friction_limit": ("output.reactions=true",),
    "solver.accuracy_of": ("solver.accuracy", "solver.verify=true"),
    "yielding.storey_u_y": _EACH_STOREY,
    "yielding.storey_F_y": _EACH_STOREY,
    **dict.fromkeys(
        ("yielding.u_y", "yielding.f_y_over_m_s_g", "yielding.F_y"),
        ("!storeys.coupling", "storeys.coupling=reduced", "storeys.coupling=every_floor"),
    ),
    "vertical.dt": ("!vertical.ratio",),
    "vertical.unit": ("!vertical.ratio",),
    "vertical.scale": ("!vertical.ratio",),
}
# effects absent from Eq. (15) as printed, which imply the exact formulation
_NOT_PUBLISHED = ("bending", "link", "cable.eta_y", "cable.yield_stress", "cable.rupture_strain",
                  "cable.law=truss", "cable.height", *_SPRINGS,
                  *(f"{name}.offset" for name in ("cable", "fuse", "damper", "nl_damper")),
                  )  # fmt: skip
_PULSE = {"a_max_g|v_p": True, "T_p|omega_p": True, "t_0": False}
_LOSING = {"cap": True, "post_cap": True, "residual": False, "lambda": False,
           "lambda_exponent": False}  # fmt: skip
# keys for some values of a choice only, with True where the value requires them; other values
# remove them. 'a|b' means one of two.
_BELONGING: dict[str, dict[str, dict[str, bool]]] = {
    "motion.kind": {
        "none": {},
        "one_sine": _PULSE,
        "one_cosine": _PULSE,
        "sine": _PULSE | {"cycles": False},
        "type_c": _PULSE | {"n_pulses": False},
        "mavroeidis_papageorgiou": _PULSE | {"gamma_p": True, "nu": False},
        "ricker": {"a_max_g": True, "T_p|omega_p": True, "t_0": False},
        "ricker_antisymmetric": {"a_max_g": True, "T_p|omega_p": True, "t_0": False},
        "record": {"dt": False, "unit": False, "scale": False},
    },
    "storeys.coupling": {
        "reduced": {},
        "every_floor": {},
        "full": {},
        "springs": {"k_link_over_m_w|k_link": True},
    },
    "impact.rule": {
        "constant": {"e|r": True},
        "housner": {},
        "coupled": {},
        "none": {},
        "table": {"table_theta_dot": True, "table_e": True},
    },
    **{
        f"{name}.law": {
            "elastic_plastic": {},
            "friction": {"breakaway": False},
            "flag": {"flag_height": False},
        }
        for name in ("fuse", *_SPRINGS)
    },
    "yielding.law": {
        "elastic_plastic": {},
        "friction": {"breakaway": False},
        "flag": {"flag_height": False},
        "bouc_wen": {"exponent": False, "beta": False},
        "peak_oriented": _LOSING,
        "pinched": _LOSING | {"pinch_force": False, "pinch_displacement": False},
    },
}
# additional keys set when a group is added to a case
_NEEDED_TOO = {
    "frame": ("T_s",),
    "storeys": ("k_over_m_w",),
    "yielding": ("u_y", "storey_u_y"),
    "bending": ("modes",),
    "vertical": ("ratio",),
    "motion": ("a_max_g", "T_p"),
    "solver": ("t_end",),
    "spectrum": ("T_s_min", "T_s_max", "n"),
    "initial": ("theta_over_alpha",),
    "coupling": ("eta_y",),
    "restraint": ("k_over_m_w",),
}
# keys allowed only together with groups, with True where required
_ONLY_WITH = {
    "frame.gamma": (("wall",), True),
    "spectrum.gamma": (("wall", "frame"), False),
    "spectrum.b": (("wall",), False),
}
# keys and values required by a group; None removes the key
_IMPLIED: dict[str, dict[str, str | int | None]] = {
    "bending": {
        "impact.rule": "coupled",
        **dict.fromkeys(("wall.base", "wall.walls", "cable.offset", "cable.height")),
    },
    "coupling": {"wall.walls": 2, "wall.base": None},
    "restraint": {"wall.base": None},
}
# groups that exclude each other
_EITHER = (("bending", "link"), *(("bending", name) for name in _SPRINGS))
# keys removed by a group that describes the same property
_INSTEAD_OF = {
    "storeys": ("frame.T_s", "frame.gamma", "frame.m_s", "frame.k_s", "p_delta.h_f"),
}
_TITLES = {
    "wall": "Wall",
    "frame": "Frame",
    "storeys": "Storeys",
    "link": "Link",
    "damper": "Dampers at the base",
    "nl_damper": "Nonlinear dampers at the base",
    "bending": "Wall that bends",
    "inerter": "Inerters at the base",
    "fuse": "Fuses at the base",
    "coupling": "Couplings between walls",
    "restraint": "Restraints at columns",
    "yielding": "Yielding of the frame",
    "p_delta": "P-Delta",
    "cable": "Cable",
    "impact": "Impact",
    "motion": "Ground motion",
    "vertical": "Vertical ground motion",
    "initial": "Initial state",
    "model": "Model",
    "solver": "Solver",
    "output": "Output of runs",
    "spectrum": "Spectrum of runs",
}
# groups with numbers that only the user knows: shown where the case has them, never added
_OF_THE_USER = ("base", "base_section", "limits", "sensitivity", "design")
# the page must not set file names: an uploaded record has a number
_NOT_EDITABLE = {("motion", "file"), ("vertical", "file")}


def editable() -> dict[tuple[str, str], tuple[str, tuple[str, ...]]]:
    """Return the keys that the page may set."""
    return {
        row[:2]: (row.kind, tuple(row.allowed.split()) if row.kind == "choice" else ())
        for row in tables.schema()
        if row[:2] not in _NOT_EDITABLE
    }


def describe() -> dict[str, Any]:
    """Describe groups and keys for the page."""
    keys: dict[str, list[dict[str, Any]]] = {}
    for row in tables.schema():
        if row[:2] not in _NOT_EDITABLE:
            keys.setdefault(row.group, []).append(_describe_key(row))
    needs = tables.needs_of_groups()
    return {
        "groups": [
            {
                "name": name,
                "title": _TITLES.get(name, name.replace("_", " ").capitalize()),
                "needs": needs.get(name, []),
                "needed_too": _NEEDED_TOO.get(name, ()),
                "can_be_added": name not in _OF_THE_USER,
                "keys": found,
            }
            for name, found in keys.items()
        ],
        "alternatives": _ALTERNATIVES,
        "belonging": _BELONGING,
        "brings": _BRINGS,
        "only_beside": _ONLY_BESIDE,
        "not_published": _NOT_PUBLISHED,
        "only_with": _ONLY_WITH,
        "instead_of": _INSTEAD_OF,
        "implied": _IMPLIED,
        "either": _EITHER,
    }


def _describe_key(row: tables.KeyRow) -> dict[str, Any]:
    """Describe a key from its row in the kernel's table, with the range of its slider."""
    name = f"{row.group}.{row.key}"
    kind, default, allowed = row.kind.removesuffix("s"), row.default, row.allowed
    found: dict[str, Any] = {
        "key": row.key,
        "kind": kind,
        "unit": row.unit.strip("-"),
        "default": default,
        "allowed": allowed,
        "help": row.meaning,
    }
    if kind == "choice":
        words = allowed.split()
        start: object = default if default in words else words[0]
        found |= {"words": words, "start": _STARTS.get(name, start)}
    elif kind in ("real", "integer"):
        low, high, log = _RANGES.get(name) or _range(row)
        middle = math.sqrt(low * high) if log else 0.5 * (low + high)
        own = tables.number_of(default)
        start = _STARTS.get(name, middle if own is None else own)
        found |= {"low": low, "high": high, "log": log, "start": start}
        if kind == "integer":
            found["start"] = round(float(str(start)))
    elif kind == "logical":
        # a key is set when its value differs from the default
        found["start"] = default != ".true."
    elif kind == "text":
        found["start"] = _STARTS.get(name, "u_s_max_m")
    else:
        # a list needs at least one number or word
        found["start"] = _STARTS.get(name, ["u_s_max_m"] if kind == "text list" else [1.0])
        if name in _RANGES:
            low, high, log = _RANGES[name]
            found |= {"low": low, "high": high, "log": log}
    return found


def _range(row: tables.KeyRow) -> tuple[float, float, bool]:
    """Return the range of a slider from the bounds of its key."""
    own, (low, high, is_above, is_below) = tables.number_of(row.default), row.bounds
    if low is not None and high is not None:
        # the end of an open interval would be refused
        inset = 1e-3 * (high - low)
        return low + inset * is_above, high - inset * is_below, low > 0 and high > 100 * low
    if low == 0.0 and is_above:
        middle = own or 1.0
        return 0.01 * middle, 100.0 * middle, True
    if low is not None:
        return low + 0.01 * is_above, max(10.0 * abs(low), 4.0 * (own or 0.0), low + 10.0), False
    reach = max(4.0 * abs(own or 0.0), 2.0)
    return -reach, reach, False
