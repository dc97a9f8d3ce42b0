"""Controls of the page for each key: slider range, initial value, exclusions.

Keys, units, types and bounds come from the kernel. This table adds practical ranges of walls and
frames, and the consequences of a choice. A key without an entry has a slider over its bounds.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from rwmf.kernel import tables

# groups whose springs may also be linear
_SPRINGS = ("coupling", "restraint")


class Slider(NamedTuple):
    """Usual range of a number.

    Attributes
    ----------
    low, high : float
        Ends.
    is_log : bool
        Whether equal distances on the slider are equal factors.
    start : float or list of float, optional
        Value of a key that is set on the page; otherwise its default, or the middle of the range.
    """

    low: float
    high: float
    is_log: bool = False
    start: float | list[float] | None = None


_SLIDERS: dict[str, Slider] = {
    "wall.h": Slider(0.5, 10.0, start=2.0),
    "wall.b": Slider(0.1, 3.0, start=0.5),
    "wall.m_w": Slider(1e3, 1e6, is_log=True, start=20000.0),
    "frame.T_s": Slider(0.05, 3.0, start=1.0),
    "frame.gamma": Slider(0.1, 2000.0, is_log=True, start=5.0),
    "frame.xi_s": Slider(0.0, 0.2, start=0.05),
    # of one storey; lists have a slider for each
    "storeys.m_over_m_w": Slider(0.1, 10.0, is_log=True, start=[1.0, 1.0, 1.0]),
    "storeys.k_over_m_w": Slider(10.0, 1e4, is_log=True, start=[200.0, 200.0, 200.0]),
    "storeys.m": Slider(1e3, 1e6, is_log=True, start=[20000.0]),
    "storeys.k": Slider(1e6, 1e9, is_log=True, start=[4e6]),
    "storeys.height": Slider(2.0, 8.0, start=[3.0, 3.0, 3.0]),
    "storeys.k_link_over_m_w": Slider(1e2, 1e6, is_log=True, start=[1e4]),
    "storeys.k_link": Slider(1e6, 1e10, is_log=True, start=[2e8]),
    "link.L": Slider(1.0, 100.0, is_log=True, start=8.0),
    "bending.EI_over_m_w": Slider(1e3, 1e7, is_log=True),
    "bending.EI": Slider(1e7, 1e12, is_log=True, start=2e9),
    "bending.E": Slider(1e9, 1e11, is_log=True, start=3e10),
    "bending.cracking": Slider(0.1, 1.0, start=0.5),
    # each mode takes its own steps; the field accepts all that the kernel does
    "bending.modes": Slider(1, 4, start=2),
    "bending.xi": Slider(0.0, 0.1),
    "damper.c_over_m_w": Slider(0.0, 20.0, start=2.0),
    "inerter.inertance_over_m_w": Slider(0.0, 5.0, start=0.5),
    "fuse.eta_y": Slider(0.05, 3.0, start=0.3),
    "fuse.stroke_y": Slider(1e-3, 0.1, is_log=True, start=0.005),
    **{f"{name}.eta_y": Slider(0.05, 3.0, start=0.2) for name in _SPRINGS},
    **{f"{name}.stroke_y": Slider(1e-3, 0.1, is_log=True, start=0.005) for name in _SPRINGS},
    **{f"{name}.k_over_m_w": Slider(0.1, 1e3, is_log=True) for name in _SPRINGS},
    "yielding.u_y": Slider(5e-3, 0.5, is_log=True),
    "yielding.f_y_over_m_s_g": Slider(0.02, 2.0, is_log=True),
    "yielding.storey_u_y": Slider(1e-3, 0.1, is_log=True, start=[0.01]),
    "yielding.storey_F_y": Slider(1e4, 1e7, is_log=True, start=[40000.0]),
    "yielding.ultimate": Slider(1.5, 30.0, start=10.0),
    "yielding.cap": Slider(1.1, 10.0, start=4.0),
    "yielding.post_cap": Slider(0.5, 20.0, start=4.0),
    "yielding.hardening": Slider(-0.2, 0.5),
    "yielding.exponent": Slider(1.0, 20.0),
    "p_delta.m_g_over_m_s": Slider(0.0, 5.0),
    "p_delta.drift_limit": Slider(0.01, 0.3),
    "cable.eta_0": Slider(0.0, 5.0, start=1.0),
    "cable.eta_alpha": Slider(0.0, 20.0),
    "cable.eta_y": Slider(0.5, 10.0, start=3.0),
    "cable.rupture_strain": Slider(1e-3, 0.1, is_log=True, start=0.03),
    "motion.a_max_g": Slider(0.0, 2.0, start=0.4),
    "motion.v_p": Slider(0.0, 3.0, start=0.6),
    "motion.omega_p": Slider(1.0, 40.0, is_log=True, start=6.283),
    "motion.T_p": Slider(0.1, 6.0, start=1.0),
    "motion.cycles": Slider(0.5, 10.0),
    "motion.n_pulses": Slider(1, 10),
    "motion.gamma_p": Slider(1.05, 5.0, start=2.0),
    "motion.nu": Slider(-math.pi, math.pi),
    "motion.t_0": Slider(0.0, 5.0),
    "motion.scale": Slider(0.0, 4.0),
    "vertical.ratio": Slider(-1.0, 1.0, start=0.5),
    "vertical.scale": Slider(0.0, 4.0),
    "initial.theta_over_alpha": Slider(-1.5, 1.5, start=0.5),
    "initial.theta_dot": Slider(-2.0, 2.0),
    "model.g": Slider(1.0, 20.0),
    "model.overturning_angle": Slider(0.2, math.pi / 2),
    "solver.t_end": Slider(1.0, 60.0, start=10.0),
    "solver.rtol": Slider(1e-13, 1e-2, is_log=True),
    "solver.accuracy": Slider(1e-10, 1e-2, is_log=True),
    "solver.atol": Slider(1e-16, 1e-4, is_log=True),
    "solver.max_steps": Slider(1000, 50_000_000, is_log=True),
    "output.dt": Slider(1e-3, 0.1, is_log=True, start=0.01),
    "output.friction_limit": Slider(0.1, 1.5, start=0.5),
    "spectrum.T_s_min": Slider(0.02, 1.0, start=0.05),
    "spectrum.T_s_max": Slider(1.0, 10.0, start=3.0),
    "spectrum.n": Slider(10, 1000, is_log=True, start=200),
}
# initial value of other keys
_STARTS: dict[str, float | str | list[float] | list[str]] = {
    "wall.density": 2500.0,
    "wall.thickness": 0.3,
    "frame.m_s": 100000.0,
    "frame.k_s": 4e6,
    "storeys.n": 3,
    "storeys.distribution": "linear",
    "bending.nu": 0.2,
    "damper.c": 40000.0,
    "inerter.inertance": 10000.0,
    "fuse.F_y": 60000.0,
    "fuse.k": 1.2e7,
    **{
        f"{name}.{key}": start
        for name in _SPRINGS
        for key, start in (
            ("F_y", 1e4),
            ("k", 2e6),
            ("c_over_m_w", 0.2),
            ("c", 4e3),
        )
    },
    "restraint.height": 0.0,
    "yielding.F_y": 100000.0,
    "yielding.lambda": [30.0],
    "p_delta.h_f": 4.0,
    "p_delta.m_g": 100000.0,
    "cable.offset": [0.0],
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
    "motion.unit": "g",
    "spectrum.T_s": [0.5, 1.0, 2.0],
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
        low, high, log, first = _SLIDERS.get(name) or _range(row)
        middle = math.sqrt(low * high) if log else 0.5 * (low + high)
        own = tables.number_of(default)
        start = _STARTS.get(name, middle if own is None else own) if first is None else first
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
        if name in _SLIDERS:
            low, high, log, first = _SLIDERS[name]
            found |= {"low": low, "high": high, "log": log, "start": first}
    return found


def _range(row: tables.KeyRow) -> Slider:
    """Return the range of a slider from the bounds of its key."""
    own, (low, high, is_above, is_below) = tables.number_of(row.default), row.bounds
    if low is not None and high is not None:
        # the end of an open interval would be refused
        inset = 1e-3 * (high - low)
        is_log = low > 0 and high > 100 * low
        return Slider(low + inset * is_above, high - inset * is_below, is_log)
    if low == 0.0 and is_above:
        middle = own or 1.0
        return Slider(0.01 * middle, 100.0 * middle, is_log=True)
    if low is not None:
        return Slider(low + 0.01 * is_above, max(10.0 * abs(low), 4.0 * (own or 0.0), low + 10.0))
    reach = max(4.0 * abs(own or 0.0), 2.0)
    return Slider(-reach, reach)
