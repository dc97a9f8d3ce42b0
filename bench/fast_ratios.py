"""Method `fast`: processor time, what falls back, a second thread, errors of the figures.

    .venv/bin/python bench/fast_ratios.py                all
    .venv/bin/python bench/fast_ratios.py fallbacks      one part: costs, fallbacks, quantities,
                                                         scaling, errors

The cost of an ordinate is the processor time of a spectrum less that of the same spectrum under a
motion too small to lift the wall (which leaves reading, fits and tables out), the smallest of five.
El Centro, the wall of the paper, e = 0.9, one thread. `adams` is given every tenth period. The
errors are those of all ordinates of the shipped Figs 12 and 13 against `dop853` at rtol 1e-13.
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
from peers.problem import case, read_record

INPUTS = Path(__file__).resolve().parent.parent / "inputs"
RECORD = INPUTS / "records" / "elcentro.csv"
GAMMAS = (5.0, 1800.0)
BANDS = ((0.05, 0.2), (0.2, 0.5), (0.3, 3.0), (0.05, 3.0))
FIGURES = (
    "fig12_one_sine",
    "fig12_one_cosine",
    "fig13_elcentro_slender_wall",
    "fig13_elcentro_squat_wall",
)
PUBLISHED, RTOLS = ("published", "exact"), (1e-7, 1e-8, 1e-9)
DEVICES: dict[str, dict[str, object]] = {
    "damper": {"c_over_m_w": 0.5},
    "inerter": {"inertance_over_m_w": 0.2},
    "vertical": {"ratio": 0.5},
}
YIELDING: dict[str, object] = {"u_y": 0.02, "hardening": 0.05}
# what the exponential lanes do not know, or leave to the general ones: mass ratio, groups
SCENES: tuple[tuple[str, float, dict[str, dict[str, object]]], ...] = (
    ("gamma = 5", 5.0, {}),
    ("gamma = 4.9", 4.9, {}),
    ("gamma = 2", 2.0, {}),
    ("gamma = 0.5", 0.5, {}),
    ("e = 0.98", 5.0, {"impact": {"e": 0.98}}),
    ("e = 0", 5.0, {"impact": {"e": 0.0}}),
    ("the motion times 2", 5.0, {"motion": {"scale": 2.0}}),
    ("the motion times 4", 5.0, {"motion": {"scale": 4.0}}),
    ("the motion times 12", 5.0, {"motion": {"scale": 12.0}}),
    ("corner dampers", 5.0, {"damper": {"c_over_m_w": 0.5}}),
    ("dampers, inerters, vertical motion", 5.0, DEVICES),
    ("the same, yielding frame", 5.0, DEVICES | {"yielding": YIELDING}),
    ("smooth hysteresis", 5.0, {"yielding": YIELDING | {"law": "bouc_wen"}}),
    ("fuses", 5.0, {"fuse": {"eta_y": 0.3, "stroke_y": 0.005, "hardening": 0.02}}),
    ("a tendon that yields", 5.0, {"cable": {"eta_y": 1.5, "hardening": 0.02}}),
    ("link of 5 m", 5.0, {"link": {"L": 5.0}}),
    ("initial rotation", 5.0, {"initial": {"theta_over_alpha": 0.2}}),
    ("b = 1.05 m", 5.0, {"wall": {"b": 1.05}}),
)
QUANTITIES = {
    "theta, theta', counts": ["u_s_max", "theta_max_over_alpha", "theta_dot_max", "impacts"],
    "reactions": ["u_s_max", "base_shear_max_over_weight", "friction_demand_max"],
    "energies": ["u_s_max", "energy_input_J_per_kg"],
}

Array = npt.NDArray[np.float64]


def _cpu(case: rwmf.Case, T_s: Array, gamma: float, repeats: int) -> float:
    """Smallest processor time of a spectrum [s]."""
    best = math.inf
    for _ in range(repeats):
        started = time.process_time()
        rwmf.spectrum(case, T_s=T_s, gamma=gamma, threads=1)
        best = min(best, time.process_time() - started)
    return best


def _cost(method: str, rtol: float, T_s: Array, gamma: float, repeats: int) -> float:
    """Processor time of an ordinate [us]."""
    shaken = case(read_record(RECORD), method, rtol)
    still = shaken.replace(motion={"scale": 1e-9})
    whole = _cpu(shaken, T_s, gamma, repeats)
    return 1e6 * (whole - _cpu(still, T_s, gamma, repeats)) / T_s.size


def _print_costs() -> None:
    """Print the cost by band, and the ratio to `adams`."""
    print("| T_s | gamma | fast 1e-7, us of processor time | adams 1e-8 | ratio |")
    print("|---|---|---|---|---|")
    for low, high in BANDS:
        T_s = np.linspace(low, high, 200)
        for gamma in GAMMAS:
            fast = _cost("fast", 1e-7, T_s, gamma, 5)
            adams = _cost("adams", 1e-8, T_s[5::10], gamma, 1)
            print(
                f"| {low:g}-{high:g} | {gamma:g} | {fast:.1f} | {adams:.0f} | {adams / fast:.0f} |"
            )


def _print_fallbacks() -> None:
    """Print what scenes with effects cost, beside single runs of every tenth period."""
    print("\n| 200 periods from 0.05 to 3 s | us | times the first | of a run | error | fell |")
    print("|---|---|---|---|---|---|")
    T_s = np.linspace(0.05, 3.0, 200)
    first = math.nan
    for name, gamma, groups in SCENES:
        scene = case(read_record(RECORD), "fast", 1e-7).replace(frame={"gamma": gamma}, **groups)
        general = scene.replace(solver={"method": "dop853"})
        us = 1e6 * _seconds(scene, T_s, 1) / T_s.size
        us_run = 1e6 * _seconds_of_runs(general, T_s[5::10]) / T_s[5::10].size
        truth = rwmf.spectrum(general.replace(solver={"rtol": 1e-13}), T_s=T_s)
        found = rwmf.spectrum(scene, T_s=T_s)
        error = np.abs(found.u_s_max.values / truth.u_s_max.values - 1)
        first = us if math.isnan(first) else first
        overturned = int((truth.status != "ok").sum())
        print(
            f"| {name} | {us:.0f} | {us / first:.1f} | {us / us_run:.3f} "
            f"| {np.nanmax(error):.1e} | {overturned} |"
        )


def _print_quantities() -> None:
    """Print what quantities cost beside u_s,max alone, in general lanes."""
    print("\n| scene, 100 periods from 0.1 to 3 s | " + " | ".join(QUANTITIES) + " |")
    print("|---|" + "---|" * len(QUANTITIES))
    T_s = np.linspace(0.1, 3.0, 100)
    for name, gamma, groups in SCENES:
        if name not in ("gamma = 5", "the same, yielding frame", "fuses"):
            continue
        scene = case(read_record(RECORD), "dop853", 1e-7).replace(frame={"gamma": gamma}, **groups)
        alone = _seconds(scene, T_s, 1)
        ratios = [_seconds(scene, T_s, 1, keys) / alone for keys in QUANTITIES.values()]
        print(f"| {name} | " + " | ".join(f"{ratio:.2f}" for ratio in ratios) + " |")


def _seconds(
    case: rwmf.Case, T_s: Array | None, threads: int, quantities: list[str] | None = None
) -> float:
    """Smallest wall-clock time of the kernel for a spectrum [s]."""
    asked = {} if quantities is None else {"quantities": quantities}
    found = [rwmf.spectrum(case, T_s=T_s, threads=threads, **asked) for _ in range(5)]
    return min(float(one.attrs["seconds"]) for one in found)


def _seconds_of_runs(case: rwmf.Case, T_s: Array) -> float:
    """Smallest wall-clock times of the kernel for single runs, together [s]."""
    runs = [case.replace(frame={"T_s": float(one)}) for one in T_s]
    return sum(min(float(rwmf.simulate(one).attrs["seconds"]) for _ in range(3)) for one in runs)


def _print_scaling() -> None:
    """Print what a second thread gains; the machine has to be idle."""
    print("\n| spectrum | 1 thread, s | 2 threads, s | ratio |")
    print("|---|---|---|---|")
    problem = case(read_record(RECORD), "fast", 1e-7)
    jobs: list[tuple[str, rwmf.Case, Array | None]] = [
        (f"gamma = 5, {n} periods", problem, np.linspace(0.05, 3.0, n)) for n in (200, 1000, 10000)
    ]
    for name in FIGURES[2:]:
        figure = rwmf.Case.from_namelist(INPUTS / f"{name}.nml")
        jobs.append((name, figure.replace(solver={"method": "fast", "rtol": 1e-7}), None))
    for name, job, T_s in jobs:
        one, two = _seconds(job, T_s, 1), _seconds(job, T_s, 2)
        print(f"| {name} | {one:.4f} | {two:.4f} | {one / two:.2f} |")


def _print_errors() -> None:
    """Print the largest errors of the shipped figures."""
    print("\n| figure | formulation | rtol | largest error | above rtol | general kernel |")
    print("|---|---|---|---|---|---|")
    for name in FIGURES:
        for formulation in PUBLISHED:
            case = rwmf.Case.from_namelist(INPUTS / f"{name}.nml")
            case = case.replace(model={"formulation": formulation})
            truth = rwmf.spectrum(case.replace(solver={"method": "dop853", "rtol": 1e-13}))
            for rtol in RTOLS:
                found = rwmf.spectrum(case.replace(solver={"method": "fast", "rtol": rtol}))
                error = np.abs(found.u_s_max.values / truth.u_s_max.values - 1)
                print(
                    f"| {name} | {formulation} | {rtol:.0e} | {error.max():.1e} "
                    f"| {(error > rtol).sum()} of {error.size} "
                    f"| {'some' if found.attrs['rhs_evaluations'] else 'none'} |"
                )


if __name__ == "__main__":
    parts = {
        "costs": _print_costs,
        "fallbacks": _print_fallbacks,
        "quantities": _print_quantities,
        "scaling": _print_scaling,
        "errors": _print_errors,
    }
    for part in sys.argv[1:] or parts:
        parts[part]()
