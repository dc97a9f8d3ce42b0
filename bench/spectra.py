"""What a displacement spectrum costs: microseconds an ordinate and true error, method by method.

.venv/bin/python bench/spectra.py [--periods N] [--threads N]

El Centro (textbook version, 31.18 s), wall of the paper, gamma = 5 and 1800, e = 0.9. The error
is that of the peaks against `dop853` at rtol 1e-13, which agrees with the reference in quadruple
precision to better than 1e-11 (docs/accuracy.md). Slow methods are given every tenth period only,
SciPy three. Times are the smallest of three runs (slow methods: of one).
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
import scipy_peer

ROOT = Path(__file__).resolve().parent.parent
RECORD = ROOT / "inputs" / "records" / "elcentro.csv"
GAMMAS = (5.0, 1800.0)
REFERENCE = ("dop853", 1e-13)
FAST = (("fast", 1e-7), ("fast", 1e-8), ("fast", 1e-9))
SLOW = (("dop853", 1e-9), ("erk54", 1e-8), ("adams", 1e-8), ("bdf", 1e-8))
BANDS = ((0.05, 0.2), (0.2, 0.5), (0.5, 3.0))
H, B, XI, ETA_0, ETA_ALPHA, E = 2.0, 0.5, 0.05, 1.0, 5.0, 0.9

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    method: str
    rtol: float
    gamma: float
    ordinates: int
    microseconds: float
    """per ordinate"""
    error: float
    """largest relative error of the peaks"""


def _case(
    method: str, rtol: float, formulation: str = "symmetric", law: str = "linear"
) -> rwmf.Case:
    """Return the scene of the benchmark."""
    return rwmf.Case(
        wall={"h": H, "b": B},
        frame={"gamma": 5.0, "xi_s": XI},
        cable={"eta_0": ETA_0, "eta_alpha": ETA_ALPHA, "law": law},
        impact={"e": E},
        motion={"kind": "record", "file": str(RECORD), "unit": "g"},
        model={"formulation": formulation},
        solver={"method": method, "rtol": rtol},
        spectrum={"T_s": [1.0]},
    )


def _peaks(
    case: rwmf.Case, T_s: Array, gamma: float, threads: int, repeats: int = 1
) -> tuple[Array, float]:
    """Peaks [m] and the kernel's best wall-clock time [s]."""
    best = math.inf
    for _ in range(repeats):
        found = rwmf.spectrum(case, T_s=T_s, gamma=gamma, threads=threads)
        best = min(best, float(found.attrs["seconds"]))
    return found.u_s_max.values.reshape(-1), best


def _row(method: str, rtol: float, gamma: float, T_s: Array, truth: Array, threads: int) -> Row:
    """Measure one method of the kernel."""
    repeats = 3 if method == "fast" else 1
    peaks, seconds = _peaks(_case(method, rtol), T_s, gamma, threads, repeats)
    error = float(np.max(np.abs(peaks / truth - 1.0)))
    return Row(method, rtol, gamma, T_s.size, 1e6 * seconds / T_s.size, error)


def _scipy_rows(T_s: Array, truth: dict[float, Array]) -> list[Row]:
    """SciPy on three periods; nothing where it is not installed."""
    if importlib.util.find_spec("scipy") is None:
        return []
    t, a = scipy_peer.read_record(RECORD)
    chosen = np.linspace(T_s.size // 4, T_s.size - 1, 3).astype(int)
    rows = []
    for gamma in GAMMAS:
        started = time.perf_counter()
        walls = [scipy_peer.Wall(H, B, T_s[k], gamma, XI, ETA_0, ETA_ALPHA) for k in chosen]
        peaks = [scipy_peer.peak(wall, E, 1e-9, t, a) for wall in walls]
        cost = 1e6 * (time.perf_counter() - started) / chosen.size
        error = float(np.max(np.abs(np.array(peaks) / truth[gamma][chosen] - 1)))
        rows.append(Row("SciPy DOP853", 1e-9, gamma, chosen.size, cost, error))
    return rows


def _print_rows(rows: list[Row]) -> None:
    """Print the table of methods."""
    print("| method | rtol | gamma | ordinates | us an ordinate | largest error | over fast 1e-7 |")
    print("|---|---|---|---|---|---|---|")
    base = {row.gamma: row.microseconds for row in rows if (row.method, row.rtol) == FAST[0]}
    for row in rows:
        print(
            f"| {row.method} | {row.rtol:.0e} | {row.gamma:g} | {row.ordinates} "
            f"| {row.microseconds:.1f} | {row.error:.0e} "
            f"| {row.microseconds / base[row.gamma]:.1f} |"
        )


def _print_bands(threads: int) -> None:
    """Print what `fast` costs band by band, formulation by formulation."""
    bands = " | ".join(f"T_s {low:g}-{high:g}" for low, high in BANDS)
    print(f"\n| formulation, cable | gamma | {bands} |")
    print("|---|---|" + "---|" * len(BANDS))
    for formulation, law in (
        ("published", "linear"),
        ("symmetric", "linear"),
        ("exact", "linear"),
        ("exact", "truss"),
    ):
        for gamma in GAMMAS:
            case = _case("fast", 1e-7, formulation, law)
            costs = []
            for band in BANDS:
                T_s = np.linspace(*band, 192)
                _, seconds = _peaks(case, T_s, gamma, threads, 3)
                costs.append(f"{1e6 * seconds / T_s.size:.1f}")
            print(f"| {formulation}, {law} | {gamma:g} | " + " | ".join(costs) + " |")


def _print_scaling() -> None:
    """Print cost over threads and number of ordinates."""
    print("\n| ordinates | threads | us an ordinate |")
    print("|---|---|---|")
    for n in (1, 10, 100, 1000, 10000):
        for threads in (1, 2):
            _, seconds = _peaks(
                _case("fast", 1e-7), np.linspace(0.3, 3.0, n), 5.0, threads, 3 if n < 5000 else 1
            )
            print(f"| {n} | {threads} | {1e6 * seconds / n:.1f} |")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--periods", type=int, default=200, help="of the spectrum")
    parser.add_argument("--threads", type=int, default=1, help="threads of the kernel")
    options = parser.parse_args()
    T_s = np.linspace(0.05, 3.0, options.periods)
    truth = {gamma: _peaks(_case(*REFERENCE), T_s, gamma, 0)[0] for gamma in GAMMAS}
    rows = []
    for gamma in GAMMAS:
        for method, rtol in FAST:
            rows.append(_row(method, rtol, gamma, T_s, truth[gamma], options.threads))
        for method, rtol in SLOW:
            few, known = T_s[::10], truth[gamma][::10]
            rows.append(_row(method, rtol, gamma, few, known, options.threads))
    rows += _scipy_rows(T_s, truth)
    _print_rows(rows)
    _print_bands(options.threads)
    _print_scaling()


if __name__ == "__main__":
    main()
