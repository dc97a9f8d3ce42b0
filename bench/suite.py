"""Cost of a sweep over a suite: 200,000 runs under the 100 components of FEMA P-695.

    .venv/bin/python -m pip install '.[suites]'     # the records
    .venv/bin/python bench/suite.py

It takes some ten seconds.
"""

from __future__ import annotations

import os
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
import rwmf

CASE = Path(__file__).resolve().parent.parent / "inputs" / "fig13_elcentro_slender_wall.nml"
RTOL = 1e-6


def main() -> None:
    """Run the sweep and print its cost."""
    case = rwmf.Case.from_namelist(CASE).replace(
        model={"formulation": "symmetric"},
        solver={"rtol": RTOL, "t_end": None},
        spectrum=None,
        frame={"T_s": 1.0},
    )
    grid = {
        "T_s": np.linspace(0.05, 3.0, 200),
        "gamma": [5, 10, 100, 1000, 2000],
        "b": [0.5, 1.0],
    }
    with tempfile.TemporaryDirectory() as folder:
        started = time.perf_counter()
        found = rwmf.sweep(case, grid=grid, records=["fema:all"], file=Path(folder) / "suite.nc")
        seconds = time.perf_counter() - started
        runs, fine = found.u_s_max.size, int((found.status == 0).sum())
        found.close()
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"{runs} runs, {fine} of them ok, at rtol {RTOL:.0e}: {seconds:.1f} s on {os.cpu_count()} "
        f"cores, {1e3 * seconds * (os.cpu_count() or 1) / runs:.3f} ms of a core each, "
        f"{memory:.0f} MB"
    )


if __name__ == "__main__":
    main()
