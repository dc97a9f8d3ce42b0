"""Printed digits and the warning ``sensitive`` on random scenes.

Each scene runs again with a motion that is stronger by 1e-9 to 1e-7, and with tolerances 10 and 100
times tighter. The change of each peak must stay within one unit of the last digit that `rwmf run`
prints. A warning is due where a motion that is weaker or stronger by 1e-4 changes a peak by more
than 1 %.

One scene of three is shaken to within 1e-1 to 1e-5 of its overturning, one of three has a wall that
bends.

    python bench/conditioning.py --scenes 200
    python bench/conditioning.py --cost
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import rwmf
import xarray as xr
from rwmf import _library

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "support"))
from bending_scenes import bending_scene

CHANGES = (1e-9, 1e-8, 1e-7)
TIGHTER = (0.1, 0.01)
# rtol of a scene
TOLERANCES = (1e-9, 1e-8, 1e-6)
DT, SAMPLES = 0.01, 1500
# relative change of the motion for the warning, and sensitivity above which it is due
WIDE, LIMIT = 1e-4, 100.0
# bisections of the amplitude that overturns a wall, from this largest one
BISECTIONS, STRONGEST = 12, 30.0
COST_RUNS, COST_ROUNDS = 10, 7
# number of a scene with a pulse
BENT = 13
COST_CASES = (
    "accuracy_elcentro_2s", "accuracy_pacoima", "storeys_full", "effect_vertical",
    "fig05_stiff_frame_alone_one_sine", "accuracy_block_near_overturning",
)  # fmt: skip
# case with a factor on its motion
Maker = Callable[[float], rwmf.Case]
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
    checked = outside = warned = due = missed = needless = 0
    for number in range(options.scenes):
        made = _near_overturning(dice, _scene(dice)) if number % 3 == 0 else _scene(dice)
        if number % 3 == 1:
            made = _bending(dice, number)
        run = rwmf.simulate(made(1.0))
        rtol = run.attrs["rtol"]
        is_warned = any(x.startswith("sensitive") for x in run.attrs["warnings"].splitlines())
        is_due = any(
            change > LIMIT * WIDE
            for factor in (1 - WIDE, 1 + WIDE)
            for *_, change in _changes(run, _plain(made(factor)))
        )
        warned, due = warned + is_warned, due + is_due
        missed, needless = missed + (is_due > is_warned), needless + (is_warned > is_due)
        others = {f"motion {x:g}": made(1 + x) for x in CHANGES}
        for part in TIGHTER:
            others[f"rtol {part:g}"] = made(1.0).replace(solver={"rtol": part * rtol})
        for label, other in others.items():
            for name, value, sensitivity, change in _changes(run, _plain(other)):
                digits = _library.digits_of(rtol, sensitivity)
                checked += 1
                if not change <= 10.0 ** (1 - digits) / _mantissa(value):
                    outside += 1
                    print(f"scene {number} {label} {name}: changes by {change:.2g}, sensitivity "
                          f"{sensitivity:.3g}, {digits} digits")  # fmt: skip
    share = 100 * (1 - outside / checked)
    print(f"{options.scenes} scenes: {checked - outside} of {checked} peaks hold ({share:.3f} %)")
    print(f"warnings: {warned} scenes; due in {due}, {missed} missed; {needless} needless")


def _print_costs() -> None:
    """Print the processor time of runs without sensitivities, and the extra time over it."""
    cases = {name: rwmf.Case.from_namelist(f"inputs/{name}.nml") for name in COST_CASES}
    cases["bending, every_floor"] = rwmf.Case(**bending_scene(BENT)[0])
    for name, case in cases.items():
        for reactions in (False, True):
            plain, both = (
                case.replace(output={"reactions": reactions, "conditioning": conditioning})
                for conditioning in (False, True)
            )
            # in turn, so that other work on the machine meets both
            times = [(_time(plain), _time(both)) for _ in range(COST_ROUNDS)]
            alone, together = (min(pair[i] for pair in times) for i in range(2))
            print(f"{name:40s} reactions {reactions!s:5s} {1e3 * alone:7.3f} ms, "
                  f"extra {together / alone - 1:.2f}")  # fmt: skip


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


def _changes(run: xr.Dataset, near: xr.Dataset) -> list[tuple[str, float, float, float]]:
    """Return name, value, sensitivity and relative change of each peak, of floors one by one."""
    found = []
    for name in map(str, run.data_vars):
        if name.startswith("sensitivity_"):
            peak = name.removeprefix("sensitivity_")
            others = near[peak] if peak in near else np.nan * run[peak]
            for here, sensitivity, there in np.broadcast(run[peak], run[name], others):
                if abs(here) > ROUND_OFF and np.isfinite(here):
                    found.append((peak, here, sensitivity, abs(there / here - 1)))
    return found


def _plain(case: rwmf.Case) -> xr.Dataset:
    """Run without sensitivities."""
    return rwmf.simulate(case.replace(output={"conditioning": False}))


def _near_overturning(dice: np.random.Generator, made: Maker) -> Maker:
    """Return the scene with an amplitude slightly below one that overturns its wall."""
    low, high = 0.0, STRONGEST
    if not _plain(made(high)).get("overturned", False):
        return made
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        overturns = bool(_plain(made(middle))["overturned"])
        low, high = (low, middle) if overturns else (middle, high)
    level = low * (1 - 10 ** -dice.uniform(1, 5))
    return lambda factor: made(level * factor)


def _bending(dice: np.random.Generator, number: int) -> Maker:
    """Return a scene with a wall that bends, longer and stronger than in the tests."""
    groups, record = bending_scene(number)
    level = dice.uniform(0.5, 3)
    groups["solver"] |= {"t_end": 4.0, "rtol": float(dice.choice(TOLERANCES))}
    groups["output"] = {"reactions": True}
    if record is None:
        case, peak = rwmf.Case(**groups), level * groups["motion"]["a_max_g"]
        return lambda factor: case.replace(motion={"a_max_g": factor * peak})
    values, dt = level * np.array(record["values"]), record["times"][1]
    motion = {"values": values, "dt": dt, "unit": "m/s2"}
    case = rwmf.Case(**groups, motion=rwmf.Motion(**motion))
    return lambda factor: case.replace(motion=rwmf.Motion(**motion | {"values": factor * values}))


def _scene(dice: np.random.Generator) -> Maker:
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
    case, seed, level = rwmf.Case(**groups), int(dice.integers(1e9)), dice.uniform(0.2, 1.5)
    return lambda factor: _with_noise(case, seed, level * factor)


def _with_noise(case: rwmf.Case, seed: int, level: float) -> rwmf.Case:
    """Return the case under filtered noise with a peak in g."""
    dice = np.random.default_rng(seed)
    t = np.arange(SAMPLES) * DT
    a = np.convolve(dice.standard_normal(SAMPLES + 20), np.hanning(21), "valid")[:SAMPLES]
    a *= np.minimum(1, t / 2) * np.minimum(1, (15 - t) / 4).clip(0)
    values = level / np.abs(a).max() * a
    made = case.replace(motion=rwmf.Motion(values, dt=DT, unit="g", name="noise"))
    return made.replace(vertical={"ratio": 0.5}) if seed % 3 == 0 else made


if __name__ == "__main__":
    main()
