"""Texts, errors and memory between Python and the kernel; calls that Ctrl-C can end."""

from __future__ import annotations

import os
import queue
import threading
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, Self, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf.errors import InputError, Interrupted, NumericalError, OutputError, RwmfError
from rwmf.kernel.numbers import Wholes


class Memory:
    """Memory of the kernel behind a handle, released with the last reference."""

    __slots__ = ("handle",)

    def __init__(self, handle: int) -> None:
        self.handle = int(handle)

    def __del__(self, release: Callable[[int], None] = _kernel.release) -> None:
        """Release the memory."""
        release(self.handle)


class Closing:
    """Base of objects that a ``with`` block closes at its end."""

    def __enter__(self) -> Self:
        """Return the object itself."""
        return self

    def __exit__(self, *unused: object) -> None:
        """Close the object."""
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Free what the object holds; further calls have no effect."""


class MemoryView:
    """Array interface for numpy to an array of the kernel; it keeps the memory alive."""

    def __init__(self, memory: Memory, address: int, shape: tuple[int, ...]) -> None:
        self.memory = memory
        # C order: the first index of Fortran, which varies fastest, is the last one here
        self.__array_interface__ = {
            "version": 3,
            "typestr": np.dtype(np.float64).str,
            "shape": tuple(int(n) for n in shape),
            "data": (int(address), False),
        }


FIRST_BUFFER = 65536
_MESSAGE_BYTES = 8192
_INTERRUPTED = 130
_ERRORS: dict[int, type[RwmfError]] = {1: NumericalError, 2: InputError}


def raise_for(
    status: int,
    message: npt.NDArray[np.int8],
    length: int,
    *,
    writing: bool = False,
    source: str = "",
) -> None:
    """Raise the exception for a status of the kernel; its message begins with the case's file."""
    if status == 0:
        return
    text = decode(message, min(length, message.size))
    if source and not text.startswith(source):
        text = f"{source}: {text}"
    if status == _INTERRUPTED:
        raise Interrupted(text)
    raise (OutputError if writing else _ERRORS.get(status, NumericalError))(text)


def call(procedure: Callable[..., Any], *arguments: object, source: str = "") -> list[Any]:
    """Call a procedure whose results end with status and length of a message; return the others."""
    message = message_buffer()
    found: list[Any]
    *found, status, length = procedure(*arguments, message)
    raise_for(status, message, length, source=source)
    return found


def fetch_text(procedure: Callable[..., int], *arguments: object) -> str:
    """Fetch a text, with a second call when the first buffer is too small."""
    size = FIRST_BUFFER
    while True:
        buffer = np.empty(size, dtype=np.int8)
        length = int(procedure(*arguments, buffer))
        if length <= size:
            return decode(buffer, length)
        size = length


def summary_item(line: str, real: float, count: int) -> tuple[str, Any]:
    """Return key and typed value of a line ``key<TAB>kind<TAB>text`` and its numbers."""
    key, kind, text = line.split("\t", 2)
    if kind == "list":
        return key, text.split("\t") if text else []
    return key, {"real": real, "int": count, "logical": bool(count), "text": text}[kind]


def split_table(text: str) -> list[list[str]]:
    """Split a text into rows and cells."""
    return [line.split("\t") for line in split_lines(text)]


def split_lines(text: str) -> list[str]:
    """Split a text at line feeds only: names of files may contain other separators, as U+2028."""
    lines = text.split("\n")
    return lines if lines[-1] else lines[:-1]


def message_buffer() -> npt.NDArray[np.int8]:
    """Allocate a buffer for a message of the kernel."""
    return np.empty(_MESSAGE_BYTES, dtype=np.int8)


def encode(text: str) -> bytes:
    """Encode a text for the kernel."""
    try:
        # surrogates in file names that are not UTF-8 become the original bytes
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        letter = f"U+{ord(text[error.start]):04X}"
        raise InputError(f"a text contains {letter}, which UTF-8 cannot encode") from None


def decode(buffer: npt.NDArray[np.int8], length: int) -> str:
    """Decode a text of the kernel."""
    return buffer[:length].tobytes().decode("utf-8", "surrogateescape")


Progress = Callable[[int], None]
Flags = Wholes
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
