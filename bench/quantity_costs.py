"""Processor time of a spectrum by requested quantity, over that of u_s_max alone.

    .venv/bin/python bench/quantity_costs.py [--repeats 5] [--rtol 1e-9]

General lanes (`dop853`), one thread, El Centro. All groups of a scene are timed in turn, round by
round; a time is the smallest of all rounds. The last lines are the time of a single run over that
of an ordinate, for `RUN_GROUPS`.
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path

import numpy as np
import rwmf

RECORD = Path(__file__).resolve().parent.parent / "inputs" / "records" / "elcentro.csv"
WALL = "&wall h = 2.0, b = 0.5 /\n&impact e = 0.9 /\n&cable eta_0 = 1.0, eta_alpha = 5.0 /\n"
BUILDING = "&wall h = 9.0, b = 2.0 /\n&impact rule = 'coupled' /\n&frame xi_s = 0.05 /\n"
STOREYS = (
    "&storeys m_over_m_w = 6*1.0, k_over_m_w = 6*1000.0, height = 6*3.0, coupling = 'full' /\n"
)
SCENES = {
    "single mass, gamma = 5": WALL + "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n",
    "six storeys, full": BUILDING + STOREYS,
    "six storeys, full, no wall": "&frame xi_s = 0.05 /\n" + STOREYS,
    "six storeys that yield": BUILDING
    + STOREYS
    + "&yielding storey_u_y = 6*0.01, hardening = 0.05 /\n",
}
RUN_GROUPS = ("u_s", "drift, acceleration")
GROUPS = {
    "theta'": ("theta_dot_max",),
    "t of u_s": ("t_u_s_max",),
    "acceleration": ("floor_acceleration_max_g",),
    "drift": ("storey_drift_max",),
    "roof drift": ("roof_drift_max",),
    "drift, acceleration": ("storey_drift_max", "floor_acceleration_max_g"),
    "storey shear": ("storey_1_shear_max_over_m_w_g",),
    "overturning": ("overturning_moment_max_over_weight",),
    "wall shear, moment": ("wall_shear_max_over_m_w_g", "wall_moment_max_over_m_w_g"),
    "base shear": ("base_shear_max_over_weight",),
    "friction": ("friction_demand_max",),
    "energies": ("energy_input_J_per_kg",),
}


def _groups(case: rwmf.Case) -> dict[str, tuple[str, ...]]:
    """List the groups whose quantities apply to a scene, and all of these together."""
    found = {"u_s": ("u_s_max",)}
    for name, quantities in GROUPS.items():
        try:
            rwmf.spectrum(case, T_s=[1.0], quantities=quantities)
        except rwmf.InputError:
            continue
        found[name] = quantities
    found["all"] = tuple(dict.fromkeys(key for keys in found.values() for key in keys))
    return found


def main() -> None:
    """Print a table for each scene."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--rtol", type=float, default=1e-9)
    options = parser.parse_args()
    T_s = np.geomspace(0.1, 3.0, 96)
    for scene, text in SCENES.items():
        motion = f"&motion kind = 'record', file = '{RECORD}', unit = 'g' /\n"
        solver = f"&solver t_end = 20.0, rtol = {options.rtol}, method = 'dop853' /\n"
        case = rwmf.Case.from_text(text + motion + solver)
        groups = _groups(case)
        best = dict.fromkeys(groups, math.inf)
        for _ in range(options.repeats):
            for name, quantities in groups.items():
                begin = time.process_time()
                rwmf.spectrum(case, T_s=T_s, quantities=quantities, threads=1)
                best[name] = min(best[name], time.process_time() - begin)
        print(f"\n{scene}: u_s {best['u_s'] / T_s.size * 1e3:.3f} ms an ordinate")
        for name, seconds in best.items():
            print(f"   {name:20} {seconds / best['u_s']:6.2f}")
        for name in RUN_GROUPS:
            if name not in groups:
                continue
            begin = time.process_time()
            for period in T_s[::8]:
                rwmf.spectrum(case, T_s=[period], quantities=groups[name], threads=1)
            run = (time.process_time() - begin) / T_s[::8].size
            print(f"   run over ordinate, {name}: {run / best[name] * T_s.size:.1f}")


if __name__ == "__main__":
    main()
