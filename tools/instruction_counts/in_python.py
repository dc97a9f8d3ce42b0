"""Make calls of the Python package, their instructions counted: run by callgrind only.

python -m instruction_counts.in_python LIBRARY KIND NAME FILE [KIND NAME FILE ...]

LIBRARY holds the marks of ``bench/callgrind_marks.c``. The first line of the output is the
instruction set of the kernel.
"""

from __future__ import annotations

import ctypes
import gc
import sys
from collections.abc import Callable
from pathlib import Path

import rwmf
from rwmf.kernel import marshalling, tables

# longer than any call: the thread that waits for the kernel wakes up once
_FOREVER = 1e6


def _call_of(kind: str, case: rwmf.Case) -> Callable[[], object]:
    if kind == "simulate":
        return lambda: rwmf.simulate(case)
    if kind == "sweep":
        row = {"T_s": [0.4, 0.8, 1.2, 1.6], "gamma": [5.0, 100.0]}
        return lambda: rwmf.sweep(case, row, threads=1)
    # more than displacements: each point needs a separate run
    points = {"T_s": [0.8, 1.6]}
    return lambda: rwmf.sweep(
        case, points, threads=1, quantities=("u_s_max", "theta_max_over_alpha")
    )


def main() -> None:
    """Make every call a few times, the last one counted."""
    library, *words = sys.argv[1:]
    marks = ctypes.CDLL(library)
    marshalling._POLL_SECONDS = _FOREVER
    sys.setswitchinterval(_FOREVER)
    print(tables.instruction_set())
    for kind, name, file in zip(words[::3], words[1::3], words[2::3], strict=True):
        call = _call_of(kind, rwmf.Case.from_namelist(Path(file)))
        # the interpreter specialises its code during the first calls
        for _ in range(10):
            call()
        gc.collect()
        gc.disable()
        marks.rwmf_begin_count()
        call()
        marks.rwmf_end_count(name.encode())
        gc.enable()


if __name__ == "__main__":
    main()
