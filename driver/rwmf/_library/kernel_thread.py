"""Waiting for the kernel in a way that Ctrl-C can end."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._library.marshalling import raise_for
from rwmf.errors import Interrupted

__all__ = ["Progress", "wait_for", "write"]

Progress = Callable[[int], None]
_T = TypeVar("_T")

# how often the waiting thread looks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05
# how long a thread of the kernel waits for the next call
_IDLE_SECONDS = 1.0


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
    if progress is None and threading.current_thread() is not threading.main_thread():
        # signals go to the main thread: nothing can interrupt this one
        handle, status, n = call(control)
    else:
        handle, status, n = _call_beside(call, control, wrap, progress)
    raise_for(status, message, n, source=source)
    result = wrap(handle)
    if progress is not None:
        progress(int(control[0]))
    return result


class _Written:
    """A result without memory."""

    def __init__(self, _: int) -> None:
        pass

    def close(self) -> None:
        """Nothing to release."""


def write(call: Callable[[npt.NDArray[np.int64]], tuple[int, int]]) -> tuple[int, int]:
    """Wait for the kernel to write files in a way that Ctrl-C can end.

    Parameters
    ----------
    call : callable
        Gets two whole numbers, as in `wait_for`; returns status and length of the message.

    Returns
    -------
    tuple of int
        What the call returns.

    Raises
    ------
    Interrupted
        After Ctrl-C, unless the files were complete by then.
    """
    control = np.zeros(2, dtype=np.int64)
    if threading.current_thread() is not threading.main_thread():
        return call(control)
    done: list[tuple[int, int]] = []

    def keep(flags: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        done.append(call(flags))
        return (0, *done[0])

    try:
        _call_beside(keep, control, _Written, None)
    except Interrupted:
        if done and done[0][0] == 0:
            return done[0]
        raise
    return done[0]


def _call_beside(
    call: Callable[[npt.NDArray[np.int64]], tuple[int, int, int]],
    control: npt.NDArray[np.int64],
    wrap: Callable[[int], Any],
    progress: Progress | None,
) -> tuple[int, int, int]:
    """Call the kernel in a thread of its own: a signal must find this one in Python code."""
    outcome: list[tuple[int, int, int] | BaseException] = []
    running = threading.Lock()

    def work() -> None:
        try:
            outcome.append(call(control))
        except BaseException as error:
            # handed over to the waiting thread
            outcome.append(error)
        finally:
            running.release()

    running.acquire()
    worker = _idle.pop() if _idle else _Worker()
    worker.tasks.put(work)
    try:
        while not running.acquire(timeout=_POLL_SECONDS):
            if progress is not None:
                progress(int(control[0]))
    except BaseException as error:
        control[1] = 1
        # the end may have come while the exception was on its way
        while not outcome:
            running.acquire(timeout=_POLL_SECONDS)
        _idle.append(worker)
        _discard(outcome[0], wrap)
        if isinstance(error, KeyboardInterrupt):
            raise Interrupted("interrupted") from error
        raise
    _idle.append(worker)
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    return outcome[0]


class _Worker:
    """A thread that runs calls of the kernel, and ends when it has had none for a while.

    A thread costs as much as a short run: it takes the memory of its first run from the system.
    """

    def __init__(self) -> None:
        self.tasks: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        threading.Thread(target=self._work, name="rwmf-kernel", daemon=True).start()

    def _work(self) -> None:
        while True:
            try:
                task = self.tasks.get(timeout=_IDLE_SECONDS)
            except queue.Empty:
                try:
                    _idle.remove(self)
                except ValueError:
                    # taken out in the meantime: a call is on its way
                    continue
                return
            task()
            del task


# workers that wait for a call; a forked child has none, because threads stay behind
_idle: list[_Worker] = []
os.register_at_fork(after_in_child=_idle.clear)


def _discard(outcome: tuple[int, int, int] | BaseException, wrap: Callable[[int], Any]) -> None:
    """Release a result that nobody wants any more."""
    if not isinstance(outcome, BaseException) and outcome[1] == 0:
        wrap(outcome[0]).close()
