"""Grazing: touches of theta = 0, small arches beyond it, events that fall together."""

from hard_scenes import BLOCK, Groups, Hard, quiet

_START: Groups = {"initial": {"theta_over_alpha": 0.3}, "solver": {"t_end": 2.5}}
_BLOCK: Groups = {**BLOCK, **_START, "solver": {"t_end": 1.0}}
_COUPLED: Groups = {
    **_START,
    "frame": {"T_s": 1.5},
    "cable": {"eta_0": 0.2, "eta_alpha": 1.0},
}
# ground acceleration of the plateau at which the falling wall touches theta = 0 and turns back:
# bisected with dop853 at 1e-13 [m/s2]
_TOUCH = ((6.170097794388508, "block", _BLOCK), (27.6025104326282, "coupled", _COUPLED))
# the free block from 0.3 alpha returns at this time, also by bisection [s]
_RETURN = 0.4754151714415915


def _push(level: float) -> tuple[tuple[float, float], ...]:
    """Push the falling wall upwards, and release it [m/s2]."""
    return ((0.0, 0.0), (0.3, 0.0), (0.5, -level), (0.6, -level), (0.65, 0.0))


CASES = [
    *(
        Hard(f"{name}, arch below zero, push {-part:+g}", groups, _push(level * (1 - part)))
        for level, name, groups in _TOUCH
        for part in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10)
    ),
    *(
        Hard(f"{name}, turns above zero, push {part:+g}", groups, _push(level * (1 + part)))
        for level, name, groups in _TOUCH
        for part in (1e-3, 1e-6, 1e-9)
    ),
    Hard("impact at a knot", _BLOCK, ((0.0, 0.0), (_RETURN, 0.0), (0.7, 3.0), (1.0, 0.0))),
    Hard("jump at an impact", _BLOCK,
         ((0.0, 0.0), (_RETURN, 0.0), (_RETURN + 1e-9, 3.0), (0.7, 3.0))),
    Hard("jump that holds the wall at an impact", _BLOCK,
         ((0.0, 0.0), (_RETURN, 0.0), (_RETURN + 1e-9, -3.0), (0.7, -3.0))),
    Hard("knots within round-off of an impact", _BLOCK,
         ((0.0, 0.0), (_RETURN, 0.0), (_RETURN * (1 + 3e-16), 1e-3), (_RETURN + 1e-12, 0.0))),
    Hard("two impacts within a loose step", {**_COUPLED, "motion": quiet()}, rtol=1e-4),
    Hard("high frequency pulse, loose tolerance", {
        "motion": {"kind": "sine", "a_max_g": 2.0, "omega_p": 60.0, "cycles": 9},
        "solver": {"t_end": 3.0}}, rtol=1e-5),
]  # fmt: skip
