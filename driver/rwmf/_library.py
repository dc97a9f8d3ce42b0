"""The one place that knows the compiled kernel: buffers, handles, status numbers, Ctrl-C.

Text enters the kernel as UTF-8 bytes and leaves it in byte buffers. Cases and results stay in the
kernel behind a handle as long as Python refers to them, be it through an array alone: the large
arrays are not copied.
"""

from __future__ import annotations

import operator
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._kernel import (
    rwmf_bindings_python_cost as cost_kernel,  # noqa: F401 (for _measure)
)
from rwmf._kernel import (
    rwmf_bindings_python_kernel as _kernel,
)
from rwmf._reference import (
    rwmf_bindings_python_reference as reference_kernel,  # noqa: F401 (for _measure)
)
from rwmf._wire import (
    encode,
    fetch_text,
    message_buffer,
    raise_for,
    split_table,
    summary_item,
)
from rwmf.errors import InputError, Interrupted

__all__ = [
    "KernelCase",
    "Run",
    "Sweep",
    "check_threads",
    "instruction_set",
    "law_warning",
    "quantities",
    "read_case",
    "result_names",
    "schema",
    "start_simulation",
    "start_spectrum",
    "version",
]

Progress = Callable[[int], None]
_T = TypeVar("_T")

# how often the waiting thread looks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05
# scalars of a run that are fetched at once
_FIRST_ROOM = 256


def version() -> str:
    """Version of the compiled kernel.

    Returns
    -------
    str
        For example ``'0.1.0'``.
    """
    return fetch_text(_kernel.version)


def instruction_set() -> str:
    """Instructions that method ``fast`` uses on this processor.

    Returns
    -------
    str
        For example ``'x86-64-v4'``.
    """
    return fetch_text(_kernel.instruction_set)


def schema() -> list[list[str]]:
    """Return the kernel's table of groups and keys.

    Returns
    -------
    list of list of str
        One row a key: group, key, type, unit, default, what is allowed, help.
    """
    return split_table(fetch_text(_kernel.schema))


def needs_of_groups() -> dict[str, list[str]]:
    """Return the groups of a case, each with those without which it must not be given.

    Returns
    -------
    dict of str to list of str
        In the order of the documentation.
    """
    rows = split_table(fetch_text(_kernel.groups))
    found: dict[str, list[str]] = {}
    for name, *needs in rows:
        found.setdefault(name, []).extend(needs)
    return found


def quantities() -> list[list[str]]:
    """Return the kernel's table of output quantities.

    Returns
    -------
    list of list of str
        One row a quantity, with the attributes of `rwmf.quantities.Quantity` in their order.
    """
    return split_table(fetch_text(_kernel.quantities))


def result_names(source: str) -> list[str]:
    """Return the files that the batch program may write for a case.

    Parameters
    ----------
    source : str
        Path of its namelist.

    Returns
    -------
    list of str
        Their names, without folder.
    """
    return fetch_text(_kernel.result_names, encode(source)).splitlines()


def law_warning(laws: int) -> str:
    """Say in one line which laws are broken.

    Parameters
    ----------
    laws : int
        The bits of `KernelCase.broken_laws`, of one case or of several.

    Returns
    -------
    str
        The line, '' for none.
    """
    return fetch_text(_kernel.law_warning, laws)


class _Memory:
    """Memory of the kernel behind a handle, given back when nothing refers to it any more."""

    __slots__ = ("handle",)

    def __init__(self, handle: int) -> None:
        self.handle = int(handle)

    def __del__(self, release: Callable[[int], None] = _kernel.release) -> None:
        release(self.handle)


class _Array:
    """What numpy needs to see an array of the kernel; the array keeps the memory alive."""

    def __init__(self, memory: _Memory, address: int, shape: tuple[int, ...]) -> None:
        self.memory = memory
        # in C's order: the first index of Fortran, which runs fastest, is the last one here
        self.__array_interface__ = {
            "version": 3,
            "typestr": np.dtype(np.float64).str,
            "shape": tuple(int(n) for n in shape),
            "data": (int(address), False),
        }


class KernelCase:
    """A case as the kernel has read it: any number of threads may compute from it at once."""

    def __init__(self, memory: _Memory) -> None:
        self._memory = memory

    @property
    def handle(self) -> int:
        """The handle, good as long as this object."""
        return self._memory.handle

    def describe(self) -> list[list[str]]:
        """One row a value: ``group.key``, type, value, unit, ``given`` or ``default``."""
        return split_table(fetch_text(_kernel.describe, self.handle))

    def inventory(self) -> dict[str, list[str]]:
        """List what the case will simulate and report.

        Returns
        -------
        dict of str to list of str
            ``effects``, ``absent`` (effects that are not simulated), ``states``, ``events``,
            ``scalars``, ``columns`` when there is a history, and ``notes`` (sentences).

        Raises
        ------
        InputError, NumericalError
            When the case cannot be simulated.
        """
        rows = split_table(self._ask(_kernel.inventory))
        return {word: [name for name in names if name] for word, *names in rows}

    def applicable(self) -> list[str]:
        """List the keys of the quantities that a spectrum of the scene may be asked for.

        Returns
        -------
        list of str
            In the order of the kernel's table.

        Raises
        ------
        InputError, NumericalError
            When the case cannot be simulated.
        """
        return self._ask(_kernel.applicable).split("\t")

    def broken_laws(self) -> int:
        """Laws of conservation that the case asks to break: bits 0 energy, 1 angular momentum."""
        return int(_kernel.broken_laws(self.handle))

    def _ask(self, procedure: Callable[..., tuple[int, int, int]]) -> str:
        """Fetch a text that the kernel may refuse."""

        def call(buffer: npt.NDArray[np.int8]) -> int:
            message = message_buffer()
            length, status, n = procedure(self.handle, buffer, message)
            raise_for(status, message, n)
            return length

        return fetch_text(call)

    def end_of_motion(self) -> float:
        """When the ground has come to rest, at the end of pulse or record; 0 without motion [s]."""
        return float(_kernel.end_of_motion(self.handle))


def read_case(text: str, source: str, known: KernelCase | None = None) -> KernelCase:
    """Read and validate a case.

    Parameters
    ----------
    text : str
        Namelist text.
    source : str
        Path of its file, against whose folder the path of a record is resolved; '' when it was
        made in memory.
    known : KernelCase, optional
        Where both name the same record, its samples are taken and the file is not read again.

    Returns
    -------
    KernelCase
        What all computations start from.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    message = message_buffer()
    handle, status, n = _kernel.case_read(
        encode(text), encode(source), 0 if known is None else known.handle, message
    )
    raise_for(status, message, n)
    return KernelCase(_Memory(handle))


class _Result:
    """A result in the kernel's memory; leave the ``with`` block and it is released.

    Arrays that show its memory keep it until they are gone as well.
    """

    def __init__(self, case: KernelCase, handle: int) -> None:
        self._case = case
        self._memory: _Memory | None = _Memory(handle)

    @property
    def memory(self) -> _Memory:
        """The memory; an address in the kernel must never be used after its release."""
        if self._memory is None:
            raise RuntimeError("this result of the kernel has been released")
        return self._memory

    @property
    def handle(self) -> int:
        """The handle of the memory."""
        return self.memory.handle

    def close(self) -> None:
        """Let go of the kernel's memory; calling it twice does no harm."""
        self._memory = None

    def __enter__(self) -> Self:
        """Return the result itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Let go of the kernel's memory."""
        self.close()


class Run(_Result):
    """Result of one simulation."""

    def summary(self) -> dict[str, Any]:
        """Named scalars and lists: the keys of ``rwmf run --json`` in their order."""
        lines: list[str] = []
        room = _FIRST_ROOM
        while True:
            reals, counts = np.zeros(room), np.zeros(room, dtype=np.int64)
            lines = fetch_text(
                _kernel.result_summary, self._case.handle, self.handle, reals, counts
            ).splitlines()
            if len(lines) <= room:
                break
            room = len(lines)
        numbers = zip(lines, reals.tolist(), counts.tolist(), strict=False)
        return dict(summary_item(*item) for item in numbers)

    def history(self) -> tuple[list[str], npt.NDArray[np.float64]]:
        """Column names and values (columns, rows); both empty without `&output dt`.

        The values are the kernel's memory, which the array keeps: changes of it show in whatever
        else looks at the history of this run.
        """
        address, n_rows, n_columns, _ = _kernel.result_history(self.handle)
        if n_columns == 0:
            return [], np.zeros((0, 0))
        values = np.asarray(_Array(self.memory, address, (n_columns, n_rows)))
        return fetch_text(_kernel.result_columns, self.handle).splitlines(), values

    def events(self) -> dict[str, npt.NDArray[Any]]:
        """Arrays over the events: kind (names), t [s], theta [rad] and theta_dot [rad/s].

        For the bare frame theta is the displacement [m] and theta_dot its rate [m/s].
        """
        n = _kernel.result_history(self.handle)[3]
        kinds = np.zeros(n, dtype=np.intc)
        t, theta, theta_dot = (np.zeros(n) for _ in range(3))
        if n > 0:
            _kernel.result_events(self.handle, kinds, t, theta, theta_dot)
        names = np.array(fetch_text(_kernel.event_names).splitlines(), dtype=str)
        return {"kind": names[kinds - 1], "t": t, "theta": theta, "theta_dot": theta_dot}

    def write(self, source: str, folder: str) -> None:
        """Write the files of the batch program, named after `source`, into `folder`."""
        message = message_buffer()
        status, n = _kernel.result_write(
            self._case.handle, self.handle, encode(source), encode(folder), message
        )
        raise_for(status, message, n, writing=True)


class Sweep(_Result):
    """Result of a spectrum."""

    def warnings(self) -> list[str]:
        """Say what to keep in mind about all ordinates."""
        return law_warning(self._case.broken_laws()).splitlines()

    def facts(self) -> dict[str, Any]:
        """Sizes and cost: n_T, n_gamma, n_b, bare, threads, rhs_evaluations, seconds."""
        names = ("n_T", "n_gamma", "n_b", "bare", "threads", "rhs_evaluations", "seconds")
        return dict(zip(names, _kernel.spectrum_shape(self.handle), strict=True))

    def values(self) -> dict[str, npt.NDArray[Any]]:
        """T_s [s], gamma [-], b [m], status (b, gamma, T_s), each quantity likewise by its key."""
        shape = tuple(_kernel.spectrum_shape(self.handle)[:3])
        keys = fetch_text(_kernel.spectrum_quantities, self.handle).split("\t")
        axes = [np.zeros(n) for n in shape]
        address = _kernel.spectrum_values(self.handle, *axes)
        found = np.asarray(_Array(self.memory, address, (len(keys), *shape[::-1])))
        status = np.array(fetch_text(_kernel.spectrum_status, self.handle).splitlines(), dtype=str)
        return dict(zip(keys, found, strict=True)) | {
            "T_s": axes[0],
            "gamma": axes[1],
            "b": axes[2],
            "status": status.reshape(shape[::-1]),
        }

    def write(self, path: str) -> None:
        """Write the CSV file of the batch program."""
        message = message_buffer()
        status, n = _kernel.spectrum_write(self._case.handle, self.handle, encode(path), message)
        raise_for(status, message, n, writing=True)


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
        return _kernel.simulate(case.handle, control, message)

    return _wait_for(call, message, source, lambda handle: Run(case, handle), None)


def start_spectrum(
    case: KernelCase, source: str, threads: int = 0, progress: Progress | None = None
) -> Sweep:
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
    Sweep
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
        return _kernel.spectrum(case.handle, threads, control, message)

    return _wait_for(call, message, source, lambda handle: Sweep(case, handle), progress)


def _wait_for(
    call: Callable[[npt.NDArray[np.int64]], tuple[int, int, int]],
    message: npt.NDArray[np.int8],
    source: str,
    wrap: Callable[[int], _T],
    progress: Progress | None,
) -> _T:
    """Wait for the kernel in a way that Ctrl-C can end, and wrap the handle that it returns."""
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
