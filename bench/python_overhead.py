"""Overhead of a call from Python over the kernel's own time, measured in one run.

Run it as ``.venv/bin/python bench/python_overhead.py [ROUNDS [ORDINATES]]``, for a pulse and a
record; with ORDINATES it prints time and memory of a spectrum of this size. It prints the times of
calls, of the same work in the kernel alone, and their difference. For comparison it prints the time
of ``xarray.Dataset`` for labelling the same arrays. The measurements alternate, and the least time
of each counts: use more rounds on a shared machine.
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import rwmf
import xarray as xr
from rwmf._kernel import rwmf_bindings_python_kernel as kernel
from rwmf.case.grid import with_grid

ROOT = Path(__file__).resolve().parent.parent


def main(rounds: int = 200, ordinates: int = 0) -> None:
    """Measure and print."""
    if ordinates:
        _measure_many(ordinates)
    for name in ("fig12_one_cosine.nml", "fig13_elcentro_slender_wall.nml"):
        _measure(name, rounds)


def _measure_many(n: int) -> None:
    """Print time and memory of spectra of a bare frame, one call each; memory is the peak."""
    case = rwmf.Case(
        frame={"T_s": 1.0, "xi_s": 0.05},
        motion={"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * np.pi},
        solver={"t_end": 10.0},
    )
    quantities = ["u_s_max_m", "energy_input_J_per_kg", "energy_viscous_J_per_kg"]
    print("| ordinates | quantities | seconds | us each | bytes each | all [MB] |")
    print("|---|---|---|---|---|---|")
    rwmf.spectrum(case, T_s=np.linspace(0.1, 3.0, 1000), quantities=quantities)
    before = _peak_memory()
    for m in (n // 10, n):
        begin = time.perf_counter()
        made = rwmf.spectrum(case, T_s=np.linspace(0.1, 3.0, m), quantities=quantities)
        seconds = time.perf_counter() - begin
        grown = _peak_memory() - before
        print(
            f"| {made.status.size} | {len(quantities)} | {seconds:.1f} | {1e6 * seconds / m:.2f} "
            f"| {grown / m:.0f} | {grown / 1e6:.0f} |"
        )


def _peak_memory() -> int:
    """Largest memory of this process so far [bytes]."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _measure(name: str, rounds: int) -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / name)
    case = case.replace(spectrum=None, output=None)
    print(f"{name}: the least of {rounds} rounds")
    print("| call | rwmf [ms] | kernel [ms] | ratio | between [ms] | xarray.Dataset [ms] |")
    print("|---|---|---|---|---|---|")
    for label, call, bare in [
        ("simulate", lambda: rwmf.simulate(case), _bare(case)),
        (
            "simulate with history",
            lambda: rwmf.simulate(case, 0.01),
            _bare(case.replace(output={"dt": 0.01})),
        ),
        *(
            (
                f"spectrum of {n}",
                lambda T_s=T_s: rwmf.spectrum(case, T_s=T_s, threads=1),
                _bare_spectrum(with_grid(case, T_s)),
            )
            for n in (1, 200, 2000)
            for T_s in [np.linspace(0.1, 3.0, n)]
        ),
    ]:
        made = call()
        turns = max(rounds // 10, rounds // made.sizes.get("T_s", 1))
        mine, own, labels = _least((call, bare, _labelling(made)), turns)
        ratios = f"{mine / own:.2f} | {mine - own:.3f} | {labels:.3f}"
        print(f"| {label} | {mine:.3f} | {own:.3f} | {ratios} |")
    change = _least((lambda: case.replace(frame={"T_s": 0.7}),), rounds)[0]
    text = _least((lambda: case.replace(model={"formulation": "exact"}),), rounds)[0]
    print(f"a change of a number {change:.3f} ms, an edit of the text {text:.3f} ms")


def _bare(case: rwmf.Case) -> Callable[[], None]:
    """Return a run of the kernel without labelling its result."""
    message, control = np.zeros(8192, dtype=np.int8), np.zeros(2, dtype=np.int64)

    def call() -> None:
        kernel.release(kernel.simulate(case.kernel.handle, control, message)[0])

    return call


def _bare_spectrum(case: rwmf.Case) -> Callable[[], None]:
    message, control = np.zeros(8192, dtype=np.int8), np.zeros(2, dtype=np.int64)

    def call() -> None:
        kernel.release(kernel.spectrum(case.kernel.handle, b"", 1, control, message)[0])

    return call


def _labelling(made: xr.Dataset) -> Callable[[], None]:
    """Return the call of `xarray.Dataset` for the arrays of a dataset."""
    variables = {
        name: (data.dims, data.values, data.attrs) for name, data in made.data_vars.items()
    }
    coordinates = {name: (data.dims, data.values, data.attrs) for name, data in made.coords.items()}

    def call() -> None:
        xr.Dataset(variables, coordinates, made.attrs)

    return call


def _least(calls: tuple[Callable[[], object], ...], rounds: int) -> list[float]:
    """Least time of each call [ms]."""
    least = [np.inf] * len(calls)
    for _ in range(rounds):
        for i, call in enumerate(calls):
            begin = time.perf_counter()
            call()
            least[i] = min(least[i], 1e3 * (time.perf_counter() - begin))
    return least


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
