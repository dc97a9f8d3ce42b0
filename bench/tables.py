"""Small tables of pages, each by its name.

    .venv/bin/python bench/tables.py NAME [...]

fragility     share of 1,000 trials whose 95 % band holds the true value (developer/bench.md)
pinned        share of periods at which a wall amplifies the frame's motion (reference/effects.md)
tendons       effect of a tendon on a yielding frame, by the wall's size (reference/effects.md)
verification  README.md
"""

import csv
import math
import sys
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import rwmf
from common import RECORD, ROOT, table
from rwmf.studies import wall_effect

Rows = Iterator[Sequence[object]]
WALL = {"h": 2.0, "b": 0.5}
CABLE = {"eta_0": 1.0, "eta_alpha": 5.0}
COUPLED = {"rule": "coupled"}


def fragility() -> Rows:
    """Draw capacities from a lognormal law (median 1, dispersion 0.4) and fit them."""
    trials, levels = 1000, (0.4, 0.6, 0.8, 1.0, 1.3, 1.7)
    chance = np.random.default_rng(1)
    yield "method", "records", "median", "dispersion"
    for method in ("counts", "capacities"):
        for n in (20, 44, 100):
            kept = np.zeros(2)
            for _ in range(trials):
                capacity = np.exp(0.4 * chance.standard_normal(n))
                # an incremental analysis brackets each capacity within 2 %
                steps = [levels if method == "counts" else (0.99 * c, 1.01 * c) for c in capacity]
                rows = [
                    (str(i), level, "collapsed" if level > c else "ok")
                    for i, c in enumerate(capacity)
                    for level in steps[i]
                ]
                names = ("record", "intensity", "status")
                stripes = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
                found = rwmf.fragility(stripes, method=method, resamples=400)
                for i, (name, truth) in enumerate((("median", 1.0), ("dispersion", 0.4))):
                    low, high = found[f"{name}_band"].values
                    kept[i] += low <= truth <= high
            yield method, n, *(f"{100 * share:.1f} %" for share in kept / trials)


def pinned() -> Rows:
    """Compare a rocking and a pinned wall with the frame alone."""
    pulse = {"a_max_g": 0.4, "T_p": 1.0}
    motions = {
        "El Centro": RECORD,
        "one sine, 0.4 g, 1 s": pulse | {"kind": "one_sine"},
        "one cosine, 0.4 g, 1 s": pulse | {"kind": "one_cosine"},
    }
    walls: dict[str, dict[str, Any]] = {
        "rocking": {"wall": WALL, "impact": COUPLED},
        "rocking, cable": {"wall": WALL, "impact": COUPLED, "cable": CABLE},
        "pinned": {"wall": WALL | {"base": "pinned"}},
    }
    yield "motion", "gamma", *walls
    for name, motion in motions.items():
        for gamma in (5.0, 50.0):
            shares = []
            for groups in walls.values():
                case = rwmf.Case(
                    **groups,
                    frame={"T_s": 1.0, "gamma": gamma, "xi_s": 0.05},
                    motion=motion,
                    model={"formulation": "exact"},
                    solver={"method": "dop853", "t_end": 40.0},
                )
                ratio = wall_effect(case, {"T_s": np.linspace(0.1, 3.0, 59)})["ratio"].values
                shares.append(f"{100 * np.mean(ratio > 1):.0f} %")
            yield name, f"{gamma:g}", *shares


def tendons() -> Rows:
    """Take medians over periods under El Centro; the strength is a tenth of the frame's weight."""
    yield "half height (m)", "change of u_s,max", "largest reaction without", "with the tendon"
    for h in (2.0, 6.0, 18.0):
        case = rwmf.Case(
            wall={"h": h, "b": h / 4},
            frame={"T_s": 1.0, "gamma": 10.0, "xi_s": 0.05},
            yielding={"f_y_over_m_s_g": 0.1, "hardening": 0.05},
            impact=COUPLED,
            motion=RECORD,
            model={"formulation": "exact"},
            solver={"method": "dop853"},
            output={"reactions": True, "dt": 0.005},
        )
        both = np.empty((30, 2, 2))
        for i, T_s in enumerate(np.linspace(0.5, 3.0, 30)):
            for j, cable in enumerate((None, CABLE)):
                run = rwmf.simulate(case.replace(frame={"T_s": float(T_s)}, cable=cable))
                both[i, j] = run["u_s_max"], run["pivot_normal_over_m_w_g"].max()
        change = np.median(np.abs(both[:, 1, 0] / both[:, 0, 0] - 1))
        yield f"{h:g}", f"{100 * change:.1f} %", *(f"{x:.2f}" for x in np.median(both[..., 1], 0))


def verification() -> Rows:
    """Compare with an independent program, literature and a closed form."""
    yield "case", "reference", "ours", "relative difference"
    with (ROOT / "tests" / "reference" / "peaks_taylor.csv").open(encoding="utf-8") as file:
        stored = list(csv.DictReader(line for line in file if not line.startswith("#")))
    pulse = {"a_max_g": 0.4, "omega_p": 6.283185307179586}
    for method in ("adams", "taylor", "dop853"):
        worst = 0.0
        for row in stored:
            is_record = row["motion"] == "elcentro"
            case = rwmf.Case(
                wall=WALL,
                frame={"T_s": float(row["T_s_s"]), "gamma": float(row["gamma"]), "xi_s": 0.05},
                cable=CABLE,
                impact={"e": 0.9},
                motion=RECORD if is_record else pulse | {"kind": row["motion"]},
                model={"formulation": row["formulation"]},
                solver={"method": method, "rtol": 1e-9, "t_end": None if is_record else 10.0},
            )
            peak = float(rwmf.simulate(case).u_s_max)
            worst = max(worst, abs(peak / float(row["u_s_max_m"]) - 1))
        words = f"{len(stored)} peaks, three formulations, `{method}`, rtol 1e-9"
        yield words, "independent Taylor-series program", "largest difference", f"{worst:.0e}"
    for T_s, xi_s, truth in ((0.5, 0.02, 0.068275), (1.0, 0.02, 0.151618), (2.0, 0.05, 0.136513)):
        frame = {"T_s": T_s, "xi_s": xi_s}
        found = float(
            rwmf.simulate(rwmf.Case(frame=frame, motion=RECORD, solver={"rtol": 1e-9})).u_s_max
        )
        words = f"bare frame, El Centro, T = {T_s} s, {100 * xi_s:.0f} %"
        shown = f"{truth} m (true peak between samples)"
        yield words, shown, f"{found:.6f} m", f"{abs(found / truth - 1):.0e}"
    alpha = math.atan(0.25)
    truth = 1 - 1.5 * math.sin(alpha) ** 2 / (1 + 15 * math.cos(alpha) ** 2)
    case = rwmf.Case(
        wall=WALL, frame={"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05}, impact=COUPLED,
        solver={"t_end": 0.0},
    )  # fmt: skip
    found = float(rwmf.simulate(case).e)
    words = "restitution by momentum balance, gamma = 5"
    yield words, f"{truth:.6f}", f"{found:.6f}", f"{abs(found / truth - 1):.0e}"


TABLES = (fragility, pinned, tendons, verification)

if __name__ == "__main__":
    for name in sys.argv[1:]:
        heads, *rows = {make.__name__: make for make in TABLES}[name]()
        print(table(heads, rows))
