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
from rwmf.kernel.marshalling import message_buffer, raise_for

Progress = Callable[[int], None]
Flags = npt.NDArray[np.int64]
Message = npt.NDArray[np.int8]
# results of a procedure, its status and the length of its message
Outcome = tuple[Any, ...]
_T = TypeVar("_T")

# interval at which the waiting thread checks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05
# time after which an idle thread of the kernel ends
_IDLE_SECONDS = 1.0


def wait_for(
    call: Callable[[Flags, Message], Outcome],
    source: str,
    wrap: Callable[..., _T],
    progress: Progress | None = None,
    *,
    writing: bool = False,
) -> _T:
    """Wait for a call of the kernel, interruptible by Ctrl-C, and wrap its results.

    The call gets the flags of progress and cancel and a buffer for a message. It returns results,
    status and length of the message.
    """
    flags, message = np.zeros(2, dtype=np.int64), message_buffer()

    def work() -> Outcome:
        return call(flags, message)

    if progress is None and threading.current_thread() is not threading.main_thread():
        # only the main thread receives signals: this one cannot be interrupted
        outcome = work()
    else:
        outcome = _call_beside(work, flags, wrap, progress)
    *found, status, n = outcome
    raise_for(status, message, n, source=source, writing=writing)
    result = wrap(*found)
    if progress is not None:
        progress(int(flags[0]))
    return result


def write(call: Callable[[Flags, Message], Outcome]) -> None:
    """Wait until the kernel has written files, interruptible by Ctrl-C."""
    done: list[Outcome] = []

    def keep(flags: Flags, message: Message) -> Outcome:
        done.append(call(flags, message))
        return done[0]

    try:
        wait_for(keep, "", lambda: None, writing=True)
    except Interrupted:
        if not done or done[0][0] != 0:
            raise


def _call_beside(
    call: Callable[[], Outcome],
    flags: Flags,
    wrap: Callable[..., object],
    progress: Progress | None,
) -> Outcome:
    """Call the kernel in a worker thread, so that this one can handle signals in Python."""
    outcome: list[Outcome | BaseException] = []
    running = threading.Lock()

    def work() -> None:
        try:
            outcome.append(call())
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
                progress(int(flags[0]))
    except BaseException as error:
        flags[1] = 1
        # the call may have ended while the exception was raised
        while not outcome:
            running.acquire(timeout=_POLL_SECONDS)
        _idle.append(worker)
        if not isinstance(outcome[0], BaseException) and outcome[0][-2] == 0:
            # the memory of a result is released with its last reference
            wrap(*outcome[0][:-2])
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
