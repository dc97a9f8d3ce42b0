"""Thread scaling of a spectrum of 300 ordinates: ratio of times, measured alternately.

Run it as ``.venv/bin/python bench/threads.py [METHOD]`` on a machine with two free cores.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import rwmf

ROOT = Path(__file__).resolve().parent.parent


def main(method: str = "adams") -> None:
    """Measure and print."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig13_elcentro_slender_wall.nml")
    case = case.replace(solver={"method": method})
    seconds: dict[int, float] = {1: np.inf, 2: np.inf}
    for _ in range(3):
        for threads in seconds:
            found = rwmf.spectrum(
                case, T_s=np.linspace(0.05, 3.0, 300), gamma=[1800.0], threads=threads
            )
            seconds[threads] = min(seconds[threads], float(found.attrs["seconds"]))
    print(f"rwmf {rwmf.__version__}, {method}: 300 ordinates under El Centro, gamma = 1800")
    print(f"1 thread {seconds[1]:.3f} s, 2 threads {seconds[2]:.3f} s")
    print(f"ratio {seconds[1] / seconds[2]:.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
