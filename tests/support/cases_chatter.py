"""Chatter: impacts that accumulate, and rest that alternates with lift-off."""

from hard_scenes import BLOCK, Hard, quiet, sine

_FREE = {"motion": quiet(), "initial": {"theta_over_alpha": 0.5}}
_STIFF = {
    "frame": {"T_s": 0.05, "gamma": 0.5},
    "cable": {"eta_0": 5.0, "eta_alpha": 50.0},
    "solver": {"t_end": 5.0},
}

CASES = [
    *(
        Hard(f"free block, e = {e}", {**BLOCK, **_FREE, "impact": {"e": e}})
        for e in (0.0, 0.5, 0.9, 0.99)
    ),
    *(
        Hard(f"free wall and frame, e = {e}", {**_FREE, "impact": {"e": e}})
        for e in (0.0, 0.5, 0.9, 0.99)
    ),
    *(
        Hard(f"T_s = {T_s} s, gamma = {gamma:g}", {"frame": {"T_s": T_s, "gamma": gamma}})
        for T_s in (0.01, 0.03, 0.1)
        for gamma in (5.0, 1800.0)
    ),
    *(
        Hard(f"mass ratio {gamma:g}", {"frame": {"T_s": 0.4, "gamma": gamma}})
        for gamma in (1.0, 1e3, 1e6)
    ),
    Hard("mass ratio 0", {"frame": {"gamma": 0.0}, "motion": {"a_max_g": 0.8}}),
    *(
        Hard(f"pulse, e = {e}", {"impact": {"e": e}, "solver": {"t_end": 4.0}})
        for e in (0.0, 0.5, 0.99, 1 - 1e-6, 1.0)
    ),
    Hard("stiff frame, strong cable, 8 cycles", _STIFF | {"motion": sine(3.0, 8)}),
    Hard("stiff frame, strong cable, 30 cycles", _STIFF | {"motion": sine(2.0, 30, 40.0)}),
    Hard("long chatter under shaking", _STIFF | {"motion": sine(3.0, 8), "impact": {"e": 0.98}}),
    Hard(
        "rest and lift-off, 100 cycles",
        _STIFF | {"motion": sine(3.0, 100), "impact": {"e": 0.1}, "solver": {"t_end": 101.0}},
    ),
    Hard("no bounce under shaking", _STIFF | {"motion": sine(3.0, 8), "impact": {"e": 0.0}}),
]
