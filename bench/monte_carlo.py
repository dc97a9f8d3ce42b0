"""Cost of a row of a Monte Carlo sample relative to a run of a grid, and memory use.

    .venv/bin/python bench/monte_carlo.py [ROWS]

Eight parameters and a record differ from row to row; the records, 20 of them, are made here: white
noise of 20 s under an envelope. The grid is over period and mass ratio under the same records. With
1,000,000 rows, the default, it takes about two minutes on two cores.
"""

from __future__ import annotations

import os
import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf

ROWS = 1_000_000
RECORDS = 20
# runs of the grid at most
GRID_RUNS = 100_000
# parameter: least and greatest value
RANGES = {
    "T_s": (0.3, 3.0),
    "gamma": (2.0, 100.0),
    "b": (0.4, 0.6),
    "h": (1.8, 2.2),
    "xi_s": (0.02, 0.08),
    "eta_0": (0.5, 1.5),
    "e": (0.75, 0.95),
    "scale": (0.5, 1.5),
}
CASE: dict[str, dict[str, object]] = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05},
    "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
    "impact": {"e": 0.9},
    "motion": {"kind": "none"},
    "model": {"formulation": "symmetric"},
    "solver": {"rtol": 1e-6, "t_end": 20.0},
}


def main() -> None:
    """Run both sweeps and print their costs."""
    n = int(sys.argv[1]) if len(sys.argv) > 1 else ROWS
    case = rwmf.Case(**CASE)
    chance = np.random.default_rng(20)
    with tempfile.TemporaryDirectory() as folder:
        records = [_write_record(Path(folder) / f"noise_{i}.txt", chance) for i in range(RECORDS)]
        names = np.array([path.stem for path in records])
        points: dict[str, npt.NDArray[np.generic]] = {
            name: chance.uniform(*both, n) for name, both in RANGES.items()
        }
        points["record"] = names[chance.integers(RECORDS, size=n)]
        side = max(2, int((min(n, GRID_RUNS) / RECORDS) ** 0.5))
        grid = {"T_s": np.linspace(0.3, 3.0, side), "gamma": np.linspace(2.0, 100.0, side)}
        options = {"records": records, "unit": "g", "dt": 0.01}
        run = _cost(lambda: rwmf.sweep(case, grid, file=Path(folder) / "grid.nc", **options))
        before = _memory()
        row = _cost(lambda: rwmf.sweep(case, points=points, file=Path(folder) / "p.nc", **options))
        size = (Path(folder) / "p.nc").stat().st_size / n
    cores = len(os.sched_getaffinity(0))
    print(
        f"{n} rows over {len(RANGES)} parameters and {RECORDS} records: {1e6 * row:.1f} us of "
        f"{cores} cores each; a run of the grid ({side}^2 x {RECORDS}) {1e6 * run:.1f} us; "
        f"ratio {row / run:.2f}"
    )
    print(f"memory {_memory():.0f} MB, before {before:.0f} MB; {size:.0f} bytes of the file a row")


def _write_record(path: Path, chance: np.random.Generator) -> Path:
    """Write 20 s of noise, smoothed over 0.1 s, with a peak of 0.3 g."""
    noise = np.convolve(chance.normal(size=2000), np.hanning(11), "same")
    t = np.linspace(0.0, 20.0, 2000)
    values = noise * np.minimum(1.0, t / 2.0) * np.exp(-0.15 * t)
    np.savetxt(path, 0.3 * values / np.abs(values).max(), fmt="%.6f")
    return path


def _cost(sweep: object) -> float:
    """Seconds of a run."""
    started = time.perf_counter()
    found = sweep()  # type: ignore[operator]
    seconds = time.perf_counter() - started
    runs = found["u_s_max"].size
    fine = int((found["status"] == 0).sum())
    found.close()
    print(f"   {runs} runs, {fine} of them ok, in {seconds:.1f} s")
    return seconds / runs


def _memory() -> float:
    """Largest memory of the process so far [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


if __name__ == "__main__":
    main()
