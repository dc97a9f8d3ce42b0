"""Prints the verification table of README.md: case, reference, ours, difference.

.venv/bin/python bench/verification.py
"""

from __future__ import annotations

import csv
import math
from pathlib import Path

import rwmf

ROOT = Path(__file__).resolve().parent.parent
PEAKS = ROOT / "tests" / "reference" / "peaks_taylor.csv"

WALL = "&wall h = 2.0, b = 0.5 /\n"
FRAME = "&frame T_s = {T_s_s}, gamma = {gamma}, xi_s = 0.05 /\n"
CABLE = "&cable eta_0 = 1.0, eta_alpha = 5.0 /\n&impact e = 0.9 /\n"
PULSE = "&motion kind = '{motion}', a_max_g = 0.4, omega_p = 6.283185307179586 /\n"
RECORD = "&motion kind = 'record', file = 'inputs/records/elcentro.csv', unit = 'g' /\n"
MODEL = "&model formulation = '{formulation}' /\n"
SOLVER = "&solver method = '{method}', rtol = 1e-9{t_end} /\n"


def _peak(method: str, row: dict[str, str]) -> float:
    """Peak |u_s| of one row of the table of an independent program, in m."""
    is_record = row["motion"] == "elcentro"
    text = WALL + FRAME + CABLE + (RECORD if is_record else PULSE) + MODEL + SOLVER
    t_end = "" if is_record else ", t_end = 10.0"
    case = rwmf.Case.from_text(
        text.format(method=method, t_end=t_end, **row), source=ROOT / "verification.nml"
    )
    return float(rwmf.simulate(case).u_s_max)


def _bare_frame(T_s: float, xi_s: float) -> float:
    """Peak of the bare frame under El Centro, in m."""
    text = f"&frame T_s = {T_s}, xi_s = {xi_s} /\n" + RECORD + "&solver rtol = 1e-9 /\n"
    return float(rwmf.simulate(rwmf.Case.from_text(text, source=ROOT / "verification.nml")).u_s_max)


def _line(case: str, reference: str, ours: str, difference: float) -> None:
    print(f"| {case} | {reference} | {ours} | {difference:.0e} |")


def main() -> None:
    """Compute and print."""
    print("| case | reference | ours | relative difference |")
    print("|---|---|---|---|")
    with PEAKS.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for method in ("adams", "taylor", "dop853"):
        worst = max(abs(_peak(method, row) / float(row["u_s_max_m"]) - 1) for row in rows)
        _line(
            f"{len(rows)} peaks, three formulations, `{method}`, rtol 1e-9",
            "independent Taylor-series program",
            "largest difference",
            worst,
        )
    for T_s, xi_s, expected in (
        (0.5, 0.02, 0.068275),
        (1.0, 0.02, 0.151618),
        (2.0, 0.05, 0.136513),
    ):
        found = _bare_frame(T_s, xi_s)
        _line(
            f"bare frame, El Centro, T = {T_s} s, {100 * xi_s:.0f} %",
            f"{expected} m (true peak between samples)",
            f"{found:.6f} m",
            abs(found / expected - 1),
        )
    alpha = math.atan(0.25)
    expected = 1 - 1.5 * math.sin(alpha) ** 2 / (1 + 15 * math.cos(alpha) ** 2)
    text = (
        WALL
        + FRAME.format(T_s_s=1.0, gamma=5.0)
        + "&impact rule = 'coupled' /\n&solver t_end = 0.0 /\n"
    )
    found = float(rwmf.simulate(rwmf.Case.from_text(text)).e)
    _line(
        "restitution by momentum balance, gamma = 5",
        f"{expected:.6f}",
        f"{found:.6f}",
        abs(found / expected - 1),
    )


if __name__ == "__main__":
    main()
