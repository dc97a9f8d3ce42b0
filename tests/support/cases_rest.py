"""Rest and lift-off: at the threshold, around it, and where the motion has knots and jumps."""

from hard_scenes import BLOCK, Hard, threshold

_COUPLED = {"frame": {"T_s": 0.4}}
_LIMIT = threshold(_COUPLED)
_BLOCK_LIMIT = threshold(BLOCK)


def _plateau(level: float) -> tuple[tuple[float, float], ...]:
    """Rise to a level, stay and return [m/s2]."""
    return ((0.0, 0.0), (1.0, level), (3.0, level), (4.0, 0.0))


def _wave(level: float, n: int) -> tuple[tuple[float, float], ...]:
    """Saw tooth that touches a level in every tooth [m/s2]."""
    return tuple((0.25 * i, level * (0, 1, 0, -1)[i % 4]) for i in range(n))


CASES = [
    *(
        Hard(f"plateau {excess:+g} of the threshold", _COUPLED, _plateau(_LIMIT * (1 + excess)))
        for excess in (-1e-12, 1e-9, 1e-6, 1e-3)
    ),
    *(
        Hard(f"block, plateau {excess:+g} of the threshold", BLOCK,
             _plateau(_BLOCK_LIMIT * (1 + excess)))
        for excess in (-1e-12, 1e-6)
    ),
    Hard("saw tooth 1e-6 above the threshold", _COUPLED, _wave(_LIMIT * (1 + 1e-6), 17)),
    Hard("saw tooth 10 % above, lift-off in every tooth", _COUPLED, _wave(_LIMIT * 1.1, 17)),
    Hard("lift-off at a knot", _COUPLED,
         ((0.0, 0.0), (0.5, _LIMIT), (0.75, 2 * _LIMIT), (1.5, -2 * _LIMIT), (2.0, 0.0))),
    Hard("first sample is not zero", _COUPLED, ((0.0, 3.0), (0.3, 3.0), (0.6, -3.0), (0.9, -3.0))),
    Hard("steps", _COUPLED,
         ((0.0, 0.0), (0.1, 3.0), (0.1000001, -3.0), (0.4, -3.0), (0.4000001, 3.0), (0.7, 3.0))),
    Hard("still ground", _COUPLED, ((0.0, 0.0), (3.0, 0.0))),
    Hard("still ground, wall without weight on it", {"motion": {"a_max_g": 0.0}}),
]  # fmt: skip
