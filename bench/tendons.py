"""Effect of a tendon on a yielding frame with a rocking wall, by the wall's size.

.venv/bin/python bench/tendons.py

Walls of one slenderness and increasing height under El Centro, with frames whose strength is a
tenth of their weight. The results are the ratio of the largest displacements with and without a
tendon, and the reaction of the pivot. Medians over 30 periods from 0.5 to 3 s.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rwmf

ROOT = Path(__file__).resolve().parent.parent
PERIODS = np.linspace(0.5, 3.0, 30)
HALF_HEIGHTS = (2.0, 6.0, 18.0)  # m
TENDON = {"eta_0": 1.0, "eta_alpha": 5.0}


def respond(h: float, period: float, tendon: dict[str, float] | None) -> tuple[float, float]:
    """Simulate one frame with its wall."""
    groups = {
        "wall": {"h": h, "b": h / 4},
        "frame": {"T_s": period, "gamma": 10.0, "xi_s": 0.05},
        "yielding": {"f_y_over_m_s_g": 0.1, "hardening": 0.05},
        "impact": {"rule": "coupled"},
        "motion": {
            "kind": "record",
            "file": str(ROOT / "inputs" / "records" / "elcentro.csv"),
            "unit": "g",
        },
        "model": {"formulation": "exact"},
        "solver": {"method": "dop853"},
        "output": {"reactions": True, "dt": 0.005},
    }
    run = rwmf.simulate(rwmf.Case(**groups, **({"cable": tendon} if tendon else {})))
    return float(run["u_s_max"]), float(run["pivot_normal_over_m_w_g"].max())


def main() -> None:
    """Compute and print."""
    print("| half height (m) | change of u_s,max | largest reaction without | with the tendon |")
    print("|---|---|---|---|")
    for h in HALF_HEIGHTS:
        found = np.array(
            [[respond(h, period, tendon) for tendon in (None, TENDON)] for period in PERIODS]
        )
        change = np.median(np.abs(found[:, 1, 0] / found[:, 0, 0] - 1))
        without, with_it = np.median(found[:, :, 1], axis=0)
        print(f"| {h:g} | {100 * change:.1f} % | {without:.2f} | {with_it:.2f} |")


if __name__ == "__main__":
    main()
