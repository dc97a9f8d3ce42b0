"""Overturning: both sides of the boundary, and returns from beyond alpha."""

import math

from hard_scenes import BLOCK, Groups, Hard, quiet, wall

_ALPHA = 0.25
_P = math.sqrt(0.75 * 9.81 * math.cos(_ALPHA) / 2.0)
# pulse amplitudes over alpha g between which the block survives or overturns (one sine, omega_p =
# 5 p): bisected with dop853 at 1e-13; the six digits of other programs agree
_BOUNDARIES = (3.032339202552064, 6.743019149345504, 7.492999666842516)
_DISTANCES = ((1e-3, 1e-9), (1e-6, 1e-9), (1e-9, 1e-12))


def _pulse(a_p: float) -> Groups:
    """Block under a one-sine pulse of amplitude a_p alpha g, followed for 25/p after it."""
    return {
        **BLOCK,
        "wall": wall(_ALPHA),
        "motion": {"kind": "one_sine", "a_max_g": a_p * _ALPHA, "omega_p": 5 * _P},
        "solver": {"t_end": 2 * math.pi / (5 * _P) + 25 / _P},
    }


def _from(theta_over_alpha: float, **groups: object) -> Groups:
    """Free motion from a rotation."""
    return {"motion": quiet(), "initial": {"theta_over_alpha": theta_over_alpha}, **groups}


CASES = [
    *(
        Hard(f"boundary {a_p:.5f} {sign * part:+g}", _pulse(a_p * (1 + sign * part)), rtol=rtol)
        for a_p in _BOUNDARIES
        for part, rtol in _DISTANCES
        for sign in (-1, 1)
    ),
    Hard("exactly on the separatrix", {**BLOCK, **_from(1.0)}),
    *(Hard(f"{x:g} alpha beyond the separatrix", {**BLOCK, **_from(1 + x)})
      for x in (1e-2, 1e-6)),
    Hard("1e-6 alpha before the separatrix", {**BLOCK, **_from(1 - 1e-6),
                                              "solver": {"t_end": 15.0}}),
    Hard("back from 1.5 alpha with a frame", _from(1.5, cable=None)),
    Hard("back from 3 alpha with a cable",
         {**BLOCK, **_from(3.0), "cable": {"eta_0": 2.0, "eta_alpha": 20.0}}),
    Hard("back from 3 alpha, truss",
         {**BLOCK, **_from(3.0), "cable": {"eta_0": 2.0, "eta_alpha": 20.0, "law": "truss"}}),
    Hard("negative stiffness, survives", {
        "cable": None, "frame": {"T_s": 20.0}, "motion": {"a_max_g": 0.1},
        "solver": {"t_end": 12.0}}),
    Hard("negative stiffness, overturns", {
        "cable": None, "frame": {"T_s": 20.0, "gamma": 0.05}, "motion": {"a_max_g": 1.5}}),
    Hard("limit of 0.1 rad", {"model": {"overturning_angle": 0.1}, "motion": {"a_max_g": 1.5}}),
]  # fmt: skip
