"""Waiting for the kernel in a way that Ctrl-C can end."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._library.marshalling import raise_for
from rwmf.errors import Interrupted

__all__ = ["Progress", "wait_for"]

Progress = Callable[[int], None]
_T = TypeVar("_T")

# how often the waiting thread looks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05


def wait_for(
    call: Callable[[npt.NDArray[np.int64]], tuple[int, int, int]],
    message: npt.NDArray[np.int8],
    source: str,
    wrap: Callable[[int], _T],
    progress: Progress | None,
) -> _T:
    """Wait for the kernel in a way that Ctrl-C can end, and wrap the handle that it returns.

    Parameters
    ----------
    call : callable
        Gets two whole numbers, in which it counts what is done and looks for the wish to stop;
        returns handle, status and length of the message.
    message : numpy.ndarray of bytes, shape (n,)
        Where the call leaves its message.
    source : str
        What a message begins with: the path of the case's file, or ''.
    wrap : callable
        Makes a result of the handle.
    progress : callable, optional
        Called about 20 times a second with the number of what is done.

    Returns
    -------
    object
        What `wrap` makes.

    Raises
    ------
    InputError, NumericalError
        As the kernel reports them.
    Interrupted
        After Ctrl-C.
    """
    control = np.zeros(2, dtype=np.int64)
    outcome: list[tuple[int, int, int] | BaseException] = []
    finished = threading.Event()

    def work() -> None:
        try:
            outcome.append(call(control))
        except BaseException as error:
            # handed over to the waiting thread
            outcome.append(error)
        finally:
            finished.set()

    # a signal must find the main thread in Python code, not inside the kernel
    worker = threading.Thread(target=work, name="rwmf-kernel", daemon=True)
    worker.start()
    try:
        while not finished.wait(_POLL_SECONDS):
            if progress is not None:
                progress(int(control[0]))
    except BaseException as error:
        control[1] = 1
        worker.join()
        _discard(outcome[0], wrap)
        if isinstance(error, KeyboardInterrupt):
            raise Interrupted("interrupted") from error
        raise
    worker.join()
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    handle, status, n = outcome[0]
    raise_for(status, message, n, source=source)
    result = wrap(handle)
    if progress is not None:
        progress(int(control[0]))
    return result


def _discard(outcome: tuple[int, int, int] | BaseException, wrap: Callable[[int], Any]) -> None:
    """Release a result that nobody wants any more."""
    if not isinstance(outcome, BaseException) and outcome[1] == 0:
        wrap(outcome[0]).close()
