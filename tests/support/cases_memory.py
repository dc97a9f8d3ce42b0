"""Springs with memory: branches that end at a turn, at an impact, at rest, or all at once."""

import math

from hard_scenes import Hard, quiet, scene, sine

_ALPHA = math.atan(0.25)
_STEADY = {"frame": {"xi_s": 0.05}}
# force of the tendon at a rotation: eta_0 + (eta_alpha - eta_0) theta/alpha = 1 + 4 theta/alpha
_TENDON = {"cable": {"eta_y": 1.4, "hardening": 0.02}}
_FUSE = {"fuse": {"eta_y": 0.3, "stroke_y": 0.003}}
_FRAME = {"yielding": {"u_y": 0.03, "hardening": 0.05}}
_ALL = {**_TENDON, **_FUSE, **_FRAME}
# released at 0.3 alpha without motion: the first peak on the other side is known
_FREE = {"motion": quiet(), "initial": {"theta_over_alpha": 0.3}}


def _with(*groups: dict[str, dict[str, object]]) -> dict[str, dict[str, object]]:
    """Join groups key by key."""
    joined: dict[str, dict[str, object]] = {}
    for each in groups:
        for name, keys in each.items():
            joined[name] = joined.get(name, {}) | keys
    return joined


def _impacts(e: float) -> dict[str, dict[str, object]]:
    return {"impact": {"e": e}}


def _strain(over_prestress: float) -> float:
    """Strain of rupture at a rotation over alpha, that of the prestress included."""
    b = scene({})["wall"]["b"]
    return b * _ALPHA * (0.25 + over_prestress) / 4.0


CASES = [
    *(Hard(f"all springs yield, e = {e}", _with(_ALL, _impacts(e))) for e in (0.0, 0.5, 0.9, 1.0)),
    Hard("all springs yield, symmetric", _with(_ALL, {"model": {"formulation": "symmetric"}})),
    Hard("frame and fuses yield, published",
         _with(_FUSE, _FRAME, {"model": {"formulation": "published"}})),
    Hard("all springs yield, truss", _with(_ALL, {"cable": {"law": "truss"}})),
    *(
        Hard(f"yield {excess:+g} above an initial rotation",
             _with(_FREE, {"cable": {"eta_y": (1 + 4 * 0.3) * (1 + excess)}}))
        for excess in (-1e-9, 0.0, 1e-9)
    ),
    Hard("initial rotation far beyond yield of all", _with(_FREE, _ALL)),
    Hard("initial rotation beyond yield, outwards",
         _with(_FREE, _ALL, {"initial": {"theta_dot": 0.2}})),
    Hard("initial rotation beyond yield, inwards",
         _with(_FREE, _ALL, {"initial": {"theta_dot": -0.2}})),
    Hard("tendon slack before the impact", _with({"cable": {"eta_y": 1.05}}, _STEADY)),
    Hard("tendon without prestress", _with({"cable": {"eta_0": 0.0, "eta_y": 0.5}}, _STEADY)),
    Hard("tendon without prestress, never yields",
         {"cable": {"eta_0": 0.0, "eta_y": 100.0}, "impact": {"e": 0.5}}),
    Hard("tendon without strength", {"cable": {"eta_0": 0.0, "eta_y": 1e-300}}),
    Hard("tendon without strength, let go",
         _with(_FREE, {"cable": {"eta_0": 0.0, "eta_y": 1e-300}, "impact": {"e": 0.5}})),
    Hard("rupture in the first swing", {"cable": {"rupture_strain": _strain(0.1)}}),
    Hard("rupture of a yielding tendon",
         _with(_TENDON, {"cable": {"rupture_strain": _strain(0.15)}})),
    Hard("rupture, then fuses alone",
         _with(_FUSE, {"cable": {"rupture_strain": _strain(0.1)}, "motion": sine(0.4, 3)})),
    *(
        Hard(f"fuses in compression under the resting wall, eta_y = {eta}",
             {"fuse": {"eta_y": eta, "stroke_y": 0.002}, "motion": sine(0.5, 3),
              "impact": {"e": 0.5}})
        for eta in (0.5, 0.95, 1.0)
    ),
    Hard("fuses and chatter", _with(_FUSE, _impacts(0.5), {"frame": {"T_s": 0.1}})),
    Hard("stiff fuses, chatter", {"fuse": {"eta_y": 0.3, "stroke_y": 1e-5}, "frame": {"T_s": 0.2}}),
    Hard("weak fuses", {"fuse": {"eta_y": 1e-9, "stroke_y": 1e-9}}),
    *(
        Hard(f"residual force at rest, e = {e}",
             {"yielding": {"u_y": 0.01}, "cable": {"eta_0": 5.0, "eta_alpha": 10.0},
              "impact": {"e": e}, "motion": sine(0.8, 4)})
        for e in (0.0, 0.5)
    ),
    Hard("frame hardly stronger than nothing", {"yielding": {"u_y": 1e-6}}),
    Hard("yield of the frame at every turn", {"yielding": {"u_y": 1e-3}, "motion": sine(0.3, 6)}),
    Hard("kinks of a record and of springs", _ALL,
         tuple((0.1 * i, 4.0 * (0, 1, 0, -1)[i % 4]) for i in range(25))),
    Hard("jumps of a record and yield", _ALL,
         ((0.0, 0.0), (0.1, 4.0), (0.1000001, -4.0), (0.4, -4.0), (0.4000001, 4.0), (0.7, 4.0))),
]  # fmt: skip
