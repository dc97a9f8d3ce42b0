"""Impacts of the wall's corners in OpenSees with settings other than the stored ones.

``python bench/opensees_contact.py`` computes ``free``, the released wall, with each of them and
writes ``validation/opensees/contact.csv``. The requirements are those of ``opensees_cases.py``.
"""

from __future__ import annotations

import csv
import time
from dataclasses import replace

import rwmf
from opensees_cases import ROOT, Engine, EngineStoppedError, compute_wall
from reproduce.engines import COLUMNS, EngineHistory, compare
from reproduce.validation import fitted_restitution

HHT = ("HHT", 0.7)
VARIANTS: dict[str, dict[str, object]] = {
    "as stored": {},
    "stiffness 1e11 N/m": {"stiffness": 1e11},
    "stiffness 1e10 N/m": {"stiffness": 1e10},
    "time steps of 40 us": {"dt": 4e-5},
    "groove ten times as stiff as its pad": {"groove_ratio": 10.0},
    "beams a hundred times softer": {"beam_ratio": 100.0},
    "damping ratio 0.3": {"damping_ratio": 0.3},
    "damping ratio 0.1": {"damping_ratio": 0.1},
    "no damping": {"damping_ratio": 0.0},
    "no damping, HHT 0.7": {"damping_ratio": 0.0, "integrator": HHT},
    "no damping, TRBDF2": {"damping_ratio": 0.0, "integrator": ("TRBDF2",)},
    "no damping, HHT 0.7, 1e9 N/m, steps of 1 ms": {
        "damping_ratio": 0.0,
        "integrator": HHT,
        "stiffness": 1e9,
        "dt": 1e-3,
    },
    "no pads, betaKcurrent": {"corners": "springs"},
    "no pads, betaKcurrent, 2e10 N/m, steps of 20 us": {
        "corners": "springs",
        "stiffness": 2e10,
        "dt": 2e-5,
    },
}


def main() -> None:
    """Compute all of them."""
    case = rwmf.Case.from_namelist(ROOT / "validation" / "free.nml")
    case = case.replace(solver={"t_end": 3.0})
    response = rwmf.simulate(case)
    heads = ("corners", "theta rms", "impact time", "impacts", "e that fits best")
    rows: list[tuple[str, ...]] = [heads]
    for name, changes in VARIANTS.items():
        started = time.perf_counter()
        try:
            facts, values = compute_wall(case, replace(Engine(), **changes))
        except EngineStoppedError as error:
            rows.append((name, str(error), "-", "-", "-"))
        else:
            columns = dict(zip(COLUMNS[:5], values.T[:5], strict=True))
            history = EngineHistory(facts, columns)
            found = compare(response, history)
            same = found.impacts == found.engine_impacts
            rows.append(
                (
                    name,
                    f"{found.theta_rms:.3%}",
                    f"{1e3 * found.impact_time:.2f} ms" if same else "-",
                    f"{found.engine_impacts}",
                    fitted(case, history, float(response["e_max"])),
                )
            )
        print(*rows[-1], f"{time.perf_counter() - started:.0f} s", sep=" | ", flush=True)
    path = ROOT / "validation" / "opensees" / "contact.csv"
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows(rows)


def fitted(case: rwmf.Case, history: EngineHistory, momentum: float) -> str:
    """Write the restitution that fits best; it is looked for near the momentum balance."""
    e = fitted_restitution(case, history)
    if abs(e - momentum) < 0.0099:
        return f"{e:.5f}"
    return f"{'above' if e > momentum else 'below'} {e:.2f}"


if __name__ == "__main__":
    main()
