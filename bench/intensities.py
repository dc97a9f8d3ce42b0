"""Intensity measures of El Centro: this program, eqsig and pyrotd.

    .venv/bin/python -m pip install eqsig pyrotd    # in an environment that is thrown away
    .venv/bin/python bench/intensities.py [RECORD [UNIT]]

Missing packages are listed and left out. All programs take the same samples.
"""

from __future__ import annotations

import importlib
import sys
import time
from collections.abc import Callable
from types import ModuleType

import numpy as np
import numpy.typing as npt
import rwmf
from rwmf import records

Array = npt.NDArray[np.float64]
PERIODS = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
G = 9.81
Row = tuple[str, list[float], float]


def _imported(name: str) -> ModuleType | None:
    try:
        return importlib.import_module(name)
    except ImportError:
        print(f"{name} is not installed: left out")
        return None


def _timed(name: str, compute: Callable[[], list[float]]) -> Row:
    compute()
    begin = time.perf_counter()
    values = compute()
    return name, values, time.perf_counter() - begin


def _own(motion: rwmf.Motion) -> list[float]:
    simple = [rwmf.intensity(motion, kind) for kind in ("peak_velocity", "arias", "cav")]
    return simple + [rwmf.intensity(motion, "pseudo_acceleration", period=T) for T in PERIODS]


def _eqsig(module: ModuleType, a: Array, dt: float) -> list[float]:
    signal = module.AccSignal(a, dt)
    signal.generate_response_spectrum(response_times=np.array(PERIODS), xi=0.05)
    signal.generate_peak_values()
    measures = importlib.import_module("eqsig.im")
    arias = float(np.ravel(measures.calc_arias_intensity(signal))[-1])
    cav = float(np.ravel(measures.calc_cav(signal))[-1])
    return [float(signal.pgv), arias, cav, *map(float, signal.s_a)]


def _pyrotd(module: ModuleType, a: Array, dt: float) -> list[float]:
    # one process, as the others
    module.processes = 1
    found = module.calc_spec_accels(dt, a / G, 1 / np.array(PERIODS), 0.05)
    return [np.nan] * 3 + [float(x) * G for x in found.spec_accel]


def main(record: str, unit: str | None) -> None:
    """Print values and differences."""
    motion = records.read(record, unit=unit)
    times = motion.times
    dt = float(f"{(times[-1] - times[0]) / (times.size - 1):.9g}")
    a = motion.values * {"g": G, "m/s2": 1.0, "cm/s2": 0.01}[motion.unit]
    rows = [_timed("rwmf", lambda: _own(motion))]
    for name, compute in (("eqsig", _eqsig), ("pyrotd", _pyrotd)):
        module = _imported(name)
        if module is not None:
            rows.append(_timed(name, lambda m=module, f=compute: f(m, a, dt)))
    heads = ["PGV m/s", "Arias m/s", "CAV m/s", *(f"Sa({T:g} s) m/s2" for T in PERIODS)]
    print("\n| measure | " + " | ".join(name for name, *_ in rows) + " | relative differences |")
    print("|---" * (len(rows) + 2) + "|")
    for i, head in enumerate(heads):
        values = [found[i] for _, found, _ in rows]
        parts = ("-" if np.isnan(x) else f"{x / values[0] - 1:+.2%}" for x in values[1:])
        shown = ("-" if np.isnan(x) else f"{x:.8g}" for x in values)
        print(f"| {head} | {' | '.join(shown)} | {', '.join(parts)} |")
    print(f"| time ms | {' | '.join(f'{1e3 * seconds:.3g}' for *_, seconds in rows)} | |")


if __name__ == "__main__":
    words = sys.argv[1:]
    main(words[0] if words else "inputs/records/elcentro.csv", words[1] if len(words) > 1 else None)
