"""Computations of the kernel that give a result."""

from __future__ import annotations

import operator

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.case import KernelCase
from rwmf._library.marshalling import message_buffer
from rwmf._library.results import Run, Spectrum
from rwmf._library.worker import Progress, wait_for
from rwmf.errors import InputError

__all__ = ["check_threads", "start_simulation", "start_spectrum"]


def check_threads(threads: int, name: str = "threads") -> int:
    """Check a number of threads.

    Parameters
    ----------
    threads : int
        Threads of the kernel, 0 for all.
    name : str
        What says so, for the message.

    Returns
    -------
    int
        The same.

    Raises
    ------
    InputError
        When it is no number of threads, or more than a spectrum takes on this machine: 16 for
        each processor that the process may use, and 256 in any case.
    """
    most = int(_kernel.most_threads())
    try:
        number = operator.index(threads)
    except TypeError:
        number = -1
    if not 0 <= number <= most:
        raise InputError(f"{name} = {threads}: must be 0 (all) to {most} on this machine")
    return number


def start_simulation(case: KernelCase, source: str) -> Run:
    """Run one simulation in a worker thread.

    Parameters
    ----------
    case : KernelCase
        From `read_case`.
    source : str
        What a message begins with: the path of the case's file, or ''.

    Returns
    -------
    Run
        To be closed by the caller.

    Raises
    ------
    InputError, NumericalError
        As the kernel reports them.
    Interrupted
        After Ctrl-C.
    """
    message = message_buffer()

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.simulate(case.handle, control, message)
        return handle, status, n

    return wait_for(call, message, source, lambda handle: Run(case, handle), None)


def start_spectrum(
    case: KernelCase, source: str, threads: int = 0, progress: Progress | None = None
) -> Spectrum:
    """Compute a spectrum in a worker thread.

    Parameters
    ----------
    case : KernelCase
        From `read_case`, with `&spectrum`.
    source : str
        What a message begins with: the path of the case's file, or ''.
    threads : int
        Threads of the kernel, 0 for all.
    progress : callable, optional
        Called about 20 times a second with the number of finished ordinates.

    Returns
    -------
    Spectrum
        To be closed by the caller.

    Raises
    ------
    InputError, NumericalError
        As the kernel reports them.
    Interrupted
        After Ctrl-C.
    """
    message = message_buffer()
    threads = check_threads(threads)

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.spectrum(case.handle, threads, control, message)
        return handle, status, n

    return wait_for(call, message, source, lambda handle: Spectrum(case, handle), progress)
