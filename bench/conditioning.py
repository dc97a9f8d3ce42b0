"""Printed digits and the warning ``sensitive`` on random scenes.

Each scene runs again with a motion that is stronger by 1e-9 to 1e-7, and with tolerances 10 and 100
times tighter. The change of each peak must stay within one unit of the last digit that `rwmf run`
prints.

    python bench/conditioning.py --scenes 200
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import rwmf
import xarray as xr
from rwmf import _library

CHANGES = (1e-9, 1e-8, 1e-7)
TIGHTER = (0.1, 0.01)
# rtol of a scene
TOLERANCES = (1e-9, 1e-8, 1e-6)
DT, SAMPLES = 0.01, 1500
COST_RUNS = 40
COST_CASES = (
    "accuracy_elcentro_2s", "accuracy_pacoima", "storeys_full", "effect_vertical",
    "fig05_stiff_frame_alone_one_sine", "accuracy_block_near_overturning",
)  # fmt: skip
# peaks this small are the round-off of others of their kind
ROUND_OFF = 1e-9


def main() -> None:
    """Print the share of the peaks within their digits, and each one outside."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cost", action="store_true", help="extra time of the sensitivities")
    options = parser.parse_args()
    if options.cost:
        _print_costs()
        return
    dice = np.random.default_rng(options.seed)
    checked = outside = warned = 0
    for number in range(options.scenes):
        case, seed, level = _scene(dice)
        run = rwmf.simulate(_with_motion(case, seed, level, 1.0))
        warned += any(line.startswith("sensitive") for line in run.attrs["warnings"].splitlines())
        others = {f"motion {x:g}": _with_motion(case, seed, level, 1 + x) for x in CHANGES}
        for part in TIGHTER:
            same = _with_motion(case, seed, level, 1.0)
            others[f"rtol {part:g}"] = same.replace(solver={"rtol": part * case.solver.rtol})
        for label, other in others.items():
            near = rwmf.simulate(other.replace(output={"conditioning": False}))
            for name, sensitivity, change in _changes(run, near):
                digits = _library.digits_of(case.solver.rtol, sensitivity)
                checked += 1
                if not change <= 10.0 ** (1 - digits) / _mantissa(float(run[name])):
                    outside += 1
                    print(f"scene {number} {label} {name}: changes by {change:.2g}, sensitivity "
                          f"{sensitivity:.3g}, {digits} digits")  # fmt: skip
    print(f"{options.scenes} scenes, {warned} with a warning: {checked - outside} of {checked} "
          f"peaks within their digits ({100 * (1 - outside / checked):.3f} %)")  # fmt: skip


def _print_costs() -> None:
    """Print the processor time of runs without sensitivities, and the extra time over it."""
    for name in COST_CASES:
        case = rwmf.Case.from_namelist(f"inputs/{name}.nml")
        for reactions in (False, True):
            times = []
            for conditioning in (False, True):
                wanted = {"reactions": reactions, "conditioning": conditioning}
                times.append(min(_time(case.replace(output=wanted)) for _ in range(5)))
            print(f"{name:40s} reactions {reactions!s:5s} {1e3 * times[0]:7.3f} ms, "
                  f"extra {times[1] / times[0] - 1:.2f}")  # fmt: skip


def _time(case: rwmf.Case) -> float:
    """Measure the processor time of one run [s]."""
    begin = time.process_time()
    for _ in range(COST_RUNS):
        with _library.start_simulation(case.kernel, case.label):
            pass
    return (time.process_time() - begin) / COST_RUNS


def _mantissa(value: float) -> float:
    """Return the number between 1 and 10 that the digits of a value make."""
    return float(abs(value) / 10 ** np.floor(np.log10(abs(value))))


def _changes(run: xr.Dataset, near: xr.Dataset) -> list[tuple[str, float, float]]:
    """Return name, sensitivity and relative change of each peak."""
    found = []
    for name in map(str, run.data_vars):
        if name.startswith("sensitivity_"):
            peak = name.removeprefix("sensitivity_")
            here, there = float(run[peak]), float(near.get(peak, np.nan))
            if abs(here) > ROUND_OFF and np.isfinite(here):
                found.append((peak, float(run[name]), abs(there / here - 1)))
    return found


def _scene(dice: np.random.Generator) -> tuple[rwmf.Case, int, float]:
    """Draw a wall with a frame of one mass or storeys, with or without devices; or a block."""
    h = dice.uniform(2.0, 10.0)
    groups: dict[str, dict[str, object]] = {
        "wall": {"h": h, "b": h * dice.uniform(0.1, 0.4)},
        "impact": {"rule": "coupled"},
        "solver": {"t_end": 18.0, "rtol": float(dice.choice(TOLERANCES))},
        "output": {"reactions": True},
    }
    kind = dice.integers(4)
    if kind > 0:
        groups["frame"] = {"xi_s": dice.uniform(0.01, 0.08), "T_s": dice.uniform(0.3, 2.0)}
        groups["cable"] = {"eta_0": dice.uniform(0, 1.5), "eta_alpha": dice.uniform(1.5, 6)}
    if kind in (1, 3):
        groups["frame"]["gamma"] = 10 ** dice.uniform(0.5, 2)
    if kind == 2:
        n = int(dice.integers(2, 6))
        groups["storeys"] = {
            "n": n, "m_over_m_w": 2.0, "height": 2 * h / n, "k_over_m_w": 2000.0,
            "coupling": str(dice.choice(["reduced", "every_floor", "full"])),
        }  # fmt: skip
        del groups["frame"]["T_s"]
    if kind == 3:
        groups["yielding"] = {"u_y": dice.uniform(0.01, 0.05), "hardening": 0.05}
    return rwmf.Case(**groups), int(dice.integers(1e9)), dice.uniform(0.2, 1.5)


def _with_motion(case: rwmf.Case, seed: int, level: float, factor: float) -> rwmf.Case:
    """Return the case under filtered noise."""
    dice = np.random.default_rng(seed)
    t = np.arange(SAMPLES) * DT
    a = np.convolve(dice.standard_normal(SAMPLES + 20), np.hanning(21), "valid")[:SAMPLES]
    a *= np.minimum(1, t / 2) * np.minimum(1, (15 - t) / 4).clip(0)
    values = factor * level / np.abs(a).max() * a
    made = case.replace(motion=rwmf.Motion(values, dt=DT, unit="g", name="noise"))
    return made.replace(vertical={"ratio": 0.5}) if seed % 3 == 0 else made


if __name__ == "__main__":
    main()
