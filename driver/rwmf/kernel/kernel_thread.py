"""Calls of the kernel that Ctrl-C can end."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf.errors import Interrupted
from rwmf.kernel.marshalling import raise_for

Progress = Callable[[int], None]
_T = TypeVar("_T")

# interval at which the waiting thread checks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05
# time after which an idle thread of the kernel ends
_IDLE_SECONDS = 1.0


def wait_for(
    call: Callable[[npt.NDArray[np.int64]], tuple[int, int, int]],
    message: npt.NDArray[np.int8],
    source: str,
    wrap: Callable[[int], _T],
    progress: Progress | None,
) -> _T:
    """Wait for a call of the kernel, interruptible by Ctrl-C, and wrap the returned handle."""
    control = np.zeros(2, dtype=np.int64)
    if progress is None and threading.current_thread() is not threading.main_thread():
        # only the main thread receives signals: this one cannot be interrupted
        handle, status, n = call(control)
    else:
        handle, status, n = _call_beside(call, control, wrap, progress)
    raise_for(status, message, n, source=source)
    result = wrap(handle)
    if progress is not None:
        progress(int(control[0]))
    return result


class NoResult:
    """Result of a call that returns none."""

    def __init__(self, _: int) -> None:
        pass

    def close(self) -> None:
        """Do nothing: there is no memory to release."""


def write(call: Callable[[npt.NDArray[np.int64]], tuple[int, int]]) -> tuple[int, int]:
    """Wait until the kernel has written files, interruptible by Ctrl-C."""
    control = np.zeros(2, dtype=np.int64)
    if threading.current_thread() is not threading.main_thread():
        return call(control)
    done: list[tuple[int, int]] = []

    def keep(flags: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        done.append(call(flags))
        return (0, *done[0])

    try:
        _call_beside(keep, control, NoResult, None)
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
    """Call the kernel in a worker thread, so that this one can handle signals in Python."""
    outcome: list[tuple[int, int, int] | BaseException] = []
    running = threading.Lock()

    def work() -> None:
        try:
            outcome.append(call(control))
        except BaseException as error:
            # passed to the waiting thread
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
        # the call may have ended while the exception was raised
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
    """A thread that runs calls of the kernel and ends after some idle time."""

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
                    # another thread has taken this worker, so a call follows
                    continue
                return
            task()
            del task


# idle workers; a forked child has none, because threads are not copied
_idle: list[_Worker] = []
os.register_at_fork(after_in_child=_idle.clear)


def _discard(outcome: tuple[int, int, int] | BaseException, wrap: Callable[[int], Any]) -> None:
    """Release a result that is no longer needed."""
    if not isinstance(outcome, BaseException) and outcome[1] == 0:
        wrap(outcome[0]).close()
