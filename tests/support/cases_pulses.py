"""Near-fault pulses: jumps at both ends, tails that fade, peaks that barely lift the wall."""

import math

from hard_scenes import BLOCK, Hard, threshold

_COUPLED = {"frame": {"T_s": 0.4}}
_BLOCK_LIMIT = threshold(BLOCK) / 9.81
_LIMIT = threshold(_COUPLED) / 9.81


def _pulse(kind: str, a_max_g: float, T_p: float = 0.8, **keys: object) -> dict[str, object]:
    """Return `&motion` of a pulse that begins at 0.3 s."""
    shape = {"kind": kind, "a_max_g": a_max_g, "omega_p": 2 * math.pi / T_p, "t_0": 0.3}
    return {"motion": shape | keys}


def _cycles(a_max_g: float, gamma_p: float, nu: float, T_p: float = 0.8) -> dict[str, object]:
    return _pulse("mavroeidis_papageorgiou", a_max_g, T_p, gamma_p=gamma_p, nu=nu)


# of C_1: the share of the largest acceleration that it begins with
_COS_PHI = math.cos(0.0697034 * math.pi)
_SWINGING = BLOCK | {"initial": {"theta_over_alpha": 0.5}}

CASES = [
    *(
        Hard(f"C_{n}, {name}", _COUPLED | _pulse("type_c", sign * 0.4, n_pulses=n))
        for n in (1, 2, 5)
        for name, sign in (("forward", 1), ("mirrored", -1))
    ),
    Hard("block, C_1 jumps beyond the threshold at once",
         BLOCK | _pulse("type_c", 1.001 * _BLOCK_LIMIT / _COS_PHI)),
    Hard("block, C_3, four times the threshold",
         BLOCK | _pulse("type_c", 4 * _BLOCK_LIMIT, n_pulses=3)),
    *(
        Hard(f"{kind}, {name}", _COUPLED | _pulse(kind, sign * 0.4))
        for kind in ("ricker", "ricker_antisymmetric")
        for name, sign in (("forward", 1), ("mirrored", -1))
    ),
    *(
        Hard(f"block, ricker, peak {excess:+g} of the threshold",
             BLOCK | _pulse("ricker", _BLOCK_LIMIT * (1 + excess)))
        for excess in (-1e-12, 1e-6, 1e-3)
    ),
    Hard("ricker_antisymmetric, peak +1e-06 of the threshold",
         _COUPLED | _pulse("ricker_antisymmetric", _LIMIT * (1 + 1e-6))),
    Hard("swinging block, narrow ricker", _SWINGING | _pulse("ricker", 5.0, 0.1)),
    Hard("swinging block, narrow ricker, loose tolerance",
         _SWINGING | _pulse("ricker_antisymmetric", 5.0, 0.1), rtol=1e-4),
    Hard("block under a narrow ricker, 20 g", BLOCK | _pulse("ricker", 20.0, 0.02)),
    *(
        Hard(f"cycles, gamma {gamma_p:g}, nu {nu:g}", _COUPLED | _cycles(0.4, gamma_p, nu))
        for gamma_p, nu in ((1.001, 0.0), (2.0, math.pi / 2), (3.3, 2.0))
    ),
    Hard("cycles that swell and fade, gamma 12", _COUPLED | _cycles(0.4, 12.0, 0.5, 0.2)),
    Hard("block, cycles, peak +1e-06 of the threshold",
         BLOCK | _cycles(_BLOCK_LIMIT * (1 + 1e-6), 2.5, 1.0)),
]  # fmt: skip
