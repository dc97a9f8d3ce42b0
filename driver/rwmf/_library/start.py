"""Computations of the kernel that return a result."""

from __future__ import annotations

import operator
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.kernel_case import KernelCase
from rwmf._library.kernel_thread import Progress, wait_for
from rwmf._library.marshalling import encode, message_buffer
from rwmf._library.results import Run, Spectrum
from rwmf._numbers import show
from rwmf.errors import InputError

__all__ = ["check_threads", "start_rows", "start_simulation", "start_spectrum"]


def check_threads(threads: int, name: str = "threads") -> int:
    """Check a number of threads."""
    most = int(_kernel.most_threads())
    try:
        number = -1 if isinstance(threads, bool) else operator.index(threads)
    except TypeError:
        number = -1
    if not 0 <= number <= most:
        raise InputError(f"{name} = {show(threads)}: must be 0 (all) to {most} on this machine")
    return number


def start_simulation(case: KernelCase, source: str, progress: Progress | None = None) -> Run:
    """Run one simulation in a worker thread."""
    message = message_buffer()

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.simulate(case.handle, control, message)
        return handle, status, n

    with case.own_lines():
        return wait_for(call, message, source, lambda handle: Run(case, handle), progress)


def start_spectrum(
    case: KernelCase,
    source: str,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: Sequence[str] = (),
) -> Spectrum:
    """Compute a spectrum in a worker thread."""
    message = message_buffer()
    threads = check_threads(threads)
    keys = encode("\t".join(quantities))

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.spectrum(case.handle, keys, threads, control, message)
        return handle, status, n

    with case.own_lines():
        return wait_for(call, message, source, lambda handle: Spectrum(case, handle), progress)


def start_rows(
    case: KernelCase,
    source: str,
    columns: Sequence[str],
    values: npt.NDArray[np.float64],
    quantities: Sequence[str] = (),
    threads: int = 0,
    progress: Progress | None = None,
) -> Spectrum:
    """Compute runs of one case with different numbers in a worker thread."""
    message = message_buffer()
    threads = check_threads(threads)
    # the kernel's order; row-wise data need no copy
    table = np.ascontiguousarray(values, dtype=np.float64).T
    names, keys = encode("\t".join(columns)), encode("\t".join(quantities))

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.rows(case.handle, names, table, keys, threads, control, message)
        return handle, status, n

    with case.own_lines():
        return wait_for(call, message, source, lambda handle: Spectrum(case, handle), progress)
