"""Effect of the contact settings: the first seconds of g5 with several variants.

``python bench/calculix/variants.py`` computes them and writes ``validation/calculix/variants.csv``,
which ``rwmf reproduce --docs`` shows: how far the model is from each.
"""

from __future__ import annotations

import argparse
import csv
import time
from dataclasses import replace

import rwmf
from history import Array
from reproduce.engines import COLUMNS, EngineHistory, compare
from run import ROOT, UNTIL, SolverStoppedError, compute
from settings import Settings

CASE = "g5"
PATH = ROOT / "validation" / "calculix" / "variants.csv"
# name, and differences from the settings of the stored histories
VARIANTS: dict[str, dict[str, object]] = {
    "as stored": {},
    "contact damping 1e8 N s/m3": {"damping": 1e8},
    "contact damping 1e7 N s/m3": {"damping": 1e7},
    "no contact damping": {"damping": 0.0},
    "contact stiffness 1e12 N/m3": {"stiffness": 1e12},
    "base hollow by 1 mm": {"hollow": 1e-3},
    "coefficient of friction 0.7": {"friction": 0.7},
    "wall a hundred times stiffer": {"modulus": 3e12},
    "mesh twice as fine": {"nx": 8, "nz": 16},
    "time steps half as long": {"dt": 2.5e-4, "dt_min": 5e-5},
    "contact of faces": {"support": "faces", "dt_min": 2e-6},
    "contact of faces, finer over the width": {"support": "faces", "dt_min": 1e-6, "nx": 8},
    "struts": {"support": "struts"},
}
HEADS = ("variant", "u_s rms", "u_s peak", "theta rms", "theta peak", "impact time", "run")
# a run longer than this has stalled [s]
LIMIT = 600.0


def main() -> None:
    """Compute the variants that the command line names and write the table."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="example: python bench/calculix/variants.py 'no contact damping' struts",
    )
    names = ", ".join(VARIANTS)
    parser.add_argument("variants", nargs="*", metavar="VARIANT", help=f"all, or of: {names}")
    wanted = parser.parse_args().variants or list(VARIANTS)
    if unknown := set(wanted) - set(VARIANTS):
        parser.error(f"no variant {', '.join(sorted(unknown))}; these are {names}")
    rows = _stored()
    for name in wanted:
        rows[name] = _row(name, replace(Settings(), **VARIANTS[name]))
        print(", ".join(rows[name]), flush=True)
        _write([rows[known] for known in VARIANTS if known in rows])


def _stored() -> dict[str, list[str]]:
    if not PATH.is_file():
        return {}
    with PATH.open(encoding="utf-8", newline="") as stream:
        _, *rows = csv.reader(stream)
    return {row[0]: row for row in rows}


def _write(rows: list[list[str]]) -> None:
    with PATH.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerows([HEADS, *rows])


def _row(name: str, settings: Settings) -> list[str]:
    case = rwmf.Case.from_namelist(ROOT / "validation" / f"{CASE}.nml")
    started = time.perf_counter()
    try:
        _, history = compute(case, settings, UNTIL[CASE], LIMIT)
    except SolverStoppedError as error:
        return [name, *["-"] * 5, f"stops at {error.reached:.2f} s of motion"]
    seconds = time.perf_counter() - started
    return [name, *_differences(case, history), f"{seconds:.0f} s"]


def _differences(case: rwmf.Case, history: Array) -> list[str]:
    engine = EngineHistory({}, dict(zip(COLUMNS, history.T, strict=True)))
    found = compare(rwmf.simulate(case), engine)
    relative = (found.u_s_rms, found.u_s_peak, found.theta_rms, found.theta_peak)
    return [*(f"{x:.2%}" for x in relative), f"{1e3 * found.impact_time:.2f} ms"]


if __name__ == "__main__":
    main()
