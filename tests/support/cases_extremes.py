"""Parameters far from the usual ones."""

import math

import numpy as np
from hard_scenes import BLOCK, Hard, quiet, sine, wall

_LONG = {"T_s": 50.0, "gamma": 5.0, "xi_s": 0.05}


def _noise(n: int, dt: float, size: float, seed: int) -> tuple[tuple[float, float], ...]:
    """Return filtered noise that begins and ends at zero [m/s2]."""
    raw = np.random.default_rng(seed).standard_normal(n)
    smooth = np.convolve(raw, np.hanning(9), "same") * np.hanning(n) * size
    return tuple((round(i * dt, 6), float(f"{a:.6e}")) for i, a in enumerate(smooth))


def _spikes(
    record: tuple[tuple[float, float], ...], size: float
) -> tuple[tuple[float, float], ...]:
    """Put a spike on every 97th sample [m/s2]."""
    return tuple((t, size if i % 97 == 96 else a) for i, (t, a) in enumerate(record))


CASES = [
    *(
        Hard(f"slenderness {alpha} rad", {"wall": wall(alpha), "motion": {"a_max_g": a}})
        for alpha, a in ((0.01, 0.05), (0.05, 0.3), (0.8, 2.0), (1.2, 3.0))
    ),
    *(Hard(f"half height {h} m", {"wall": wall(0.25, h)}) for h in (0.05, 0.5, 20.0, 200.0)),
    Hard("T_s = 0.005 s", {"frame": {"T_s": 0.005}, "solver": {"t_end": 3.0}}),
    Hard("T_s = 50 s", {"frame": _LONG, "solver": {"t_end": 60.0}}),
    Hard("undamped", {"frame": {"xi_s": 0.0}}),
    Hard("damping ratio 2", {"frame": {"xi_s": 2.0}}),
    Hard("damping ratio 2, short period", {"frame": {"xi_s": 2.0, "T_s": 0.05}}),
    Hard("eta 100 to 500", {"cable": {"eta_0": 100.0, "eta_alpha": 500.0},
                            "motion": {"a_max_g": 30.0}}),
    Hard("softening cable", {"cable": {"eta_0": 5.0, "eta_alpha": 1.0}}),
    Hard("softening cable, truss", {"cable": {"eta_0": 5.0, "eta_alpha": 0.0, "law": "truss"}}),
    *(
        Hard(f"block, {a:g} g", {**BLOCK, "motion": sine(a, 3, 60.0), "solver": {"t_end": 4.0}})
        for a in (0.26, 2.0)
    ),
    *(
        Hard(f"amplitude {a:g} g, gamma = 1e6", {
            "frame": {"gamma": 1e6}, "cable": None, "motion": {"a_max_g": a},
            "wall": wall(1e-2, 2.0)})
        for a in (1e-8, 1e-6, 1e-4)
    ),
    *(
        Hard(f"amplitude {a:g} g, stiff", {
            "frame": {"T_s": 0.05, "gamma": 100.0}, "motion": {"a_max_g": a, "omega_p": 40.0}})
        for a in (5.0, 50.0)
    ),
    Hard("free vibration of 1e-8 alpha", {
        "motion": quiet(), "initial": {"theta_over_alpha": 1e-8}, "solver": {"t_end": 0.5}}),
    Hard("200 Hz record", {"frame": {"T_s": 0.5}, "solver": {"t_end": None}},
         _noise(2000, 0.005, 2.0, 1)),
    Hard("record with spikes", {"frame": {"T_s": 0.5}, "solver": {"t_end": None}},
         _spikes(_noise(1000, 0.005, 1.0, 2), 30.0)),
    Hard("record of 10 minutes, dt = 1 s",
         {"frame": {"T_s": 3.0, "gamma": 20.0}, "solver": {"t_end": None}},
         _noise(600, 1.0, 0.7, 3)),
    Hard("record of steps, dt = 1 s", {"frame": {"T_s": 1.5}, "solver": {"t_end": None}},
         tuple((float(i), 3.0 * math.copysign(1, math.sin(1.7 * i))) for i in range(20))),
]  # fmt: skip
