"""The one place that knows the compiled kernel: buffers, handles, status numbers, Ctrl-C.

Text enters the kernel as UTF-8 bytes and leaves it in byte buffers; results stay in the kernel
behind a handle until they are released.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._kernel import (
    rwmf_bindings_python_kernel as _kernel,
)
from rwmf._kernel import (
    rwmf_bindings_python_cost as cost_kernel,  # noqa: F401 (for _measure)
)
from rwmf._reference import (
    rwmf_bindings_python_reference as reference_kernel,  # noqa: F401 (for _measure)
)
from rwmf._wire import (
    FIRST_BUFFER,
    decode,
    encode,
    fetch_text,
    message_buffer,
    raise_for,
    split_table,
    summary_item,
)
from rwmf.errors import Interrupted

__all__ = [
    "Run",
    "Sweep",
    "describe",
    "instruction_set",
    "inventory",
    "quantities",
    "schema",
    "start_simulation",
    "start_spectrum",
    "version",
]

Progress = Callable[[int], None]
_T = TypeVar("_T")

# how often the waiting thread looks for Ctrl-C and reports progress: well below 0.2 s
_POLL_SECONDS = 0.05


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


def quantities() -> list[list[str]]:
    """Return the kernel's table of output quantities.

    Returns
    -------
    list of list of str
        One row a quantity, with the attributes of `rwmf.quantities.Quantity` in their order.
    """
    return split_table(fetch_text(_kernel.quantities))


def describe(text: str, source: str) -> list[list[str]]:
    """Read and validate a case.

    Parameters
    ----------
    text : str
        Namelist text.
    source : str
        Path of its file, against whose folder the path of a record is resolved; '' when it was
        made in memory.

    Returns
    -------
    list of list of str
        One row a value: ``group.key``, type, value, unit, ``given`` or ``default``.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    return split_table(_read_case(_kernel.describe, text, source))


def inventory(text: str, source: str) -> dict[str, list[str]]:
    """Read and validate a case, and list what it will simulate and report.

    Parameters
    ----------
    text : str
        Namelist text.
    source : str
        Path of its file, as for `describe`.

    Returns
    -------
    dict of str to list of str
        ``effects``, ``absent`` (effects that are not simulated), ``states``, ``events``,
        ``scalars``, and ``columns`` when there is a history.

    Raises
    ------
    InputError, NumericalError
        When the case is not acceptable.
    """
    rows = split_table(_read_case(_kernel.inventory, text, source))
    return {word: [name for name in names if name] for word, *names in rows}


def _read_case(procedure: Callable[..., tuple[int, int, int]], text: str, source: str) -> str:
    """Text that a procedure makes of a case, with a buffer as large as it asks for."""
    message = message_buffer()
    size = FIRST_BUFFER
    while True:
        buffer = np.zeros(size, dtype=np.int8)
        length, status, n = procedure(encode(text), encode(source), buffer, message)
        raise_for(status, message, n)
        if length <= size:
            return decode(buffer, length)
        size = int(length)


def end_of_motion(text: str, source: str) -> float:
    """Return when the ground of a case has come to rest [s].

    Parameters
    ----------
    text, source : str
        As for `describe`.

    Returns
    -------
    float
        End of the pulse or of the record, 0 without motion.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    message = message_buffer()
    t, status, n = _kernel.end_of_motion(encode(text), encode(source), message)
    raise_for(status, message, n)
    return float(t)


class _Handle:
    """A result in the kernel's memory; leave the ``with`` block and it is released."""

    _free: Callable[[int], None]

    def __init__(self, handle: int) -> None:
        self._handle: int | None = int(handle)

    @property
    def handle(self) -> int:
        """The handle; an address in the kernel must never be used after its release."""
        if self._handle is None:
            raise RuntimeError("this result of the kernel has been released")
        return self._handle

    def close(self) -> None:
        """Release the kernel's memory; calling it twice does no harm."""
        if self._handle is not None:
            type(self)._free(self._handle)
            self._handle = None

    def __enter__(self) -> Self:
        """Return the result itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the kernel's memory."""
        self.close()

    def __del__(self) -> None:
        """Release what nobody released."""
        self.close()


class Run(_Handle):
    """Result of one simulation."""

    _free = staticmethod(_kernel.result_free)

    def summary(self) -> dict[str, Any]:
        """Named scalars and lists: the keys of ``rwmf run --json`` in their order."""
        lines = fetch_text(_kernel.result_summary, self.handle).splitlines()
        return dict(summary_item(line) for line in lines)

    def history(self) -> tuple[list[str], npt.NDArray[np.float64]]:
        """Column names and values (rows, columns); both empty without `&output dt`."""
        n_rows, n_columns, _ = _kernel.result_shape(self.handle)
        values = np.zeros((n_rows, n_columns), dtype=np.float64, order="F")
        if n_columns == 0:
            return [], values
        _kernel.result_history(self.handle, values)
        return fetch_text(_kernel.result_columns, self.handle).splitlines(), values

    def events(self) -> dict[str, npt.NDArray[Any]]:
        """Arrays over the events: kind (names), t [s], theta [rad] and theta_dot [rad/s].

        For the bare frame theta is the displacement [m] and theta_dot its rate [m/s].
        """
        n = _kernel.result_shape(self.handle)[2]
        kinds = np.zeros(n, dtype=np.intc)
        t, theta, theta_dot = (np.zeros(n) for _ in range(3))
        if n > 0:
            _kernel.result_events(self.handle, kinds, t, theta, theta_dot)
        names = np.array(fetch_text(_kernel.event_names).splitlines(), dtype=str)
        return {"kind": names[kinds - 1], "t": t, "theta": theta, "theta_dot": theta_dot}

    def write(self, source: str, folder: str) -> None:
        """Write the files of the batch program, named after `source`, into `folder`."""
        message = message_buffer()
        status, n = _kernel.result_write(self.handle, encode(source), encode(folder), message)
        raise_for(status, message, n, writing=True)


class Sweep(_Handle):
    """Result of a spectrum."""

    _free = staticmethod(_kernel.spectrum_free)

    def facts(self) -> dict[str, Any]:
        """Sizes and cost: n_T, n_gamma, n_b, bare, threads, rhs_evaluations, seconds."""
        names = ("n_T", "n_gamma", "n_b", "bare", "threads", "rhs_evaluations", "seconds")
        return dict(zip(names, _kernel.spectrum_shape(self.handle), strict=True))

    def values(self) -> dict[str, npt.NDArray[Any]]:
        """T_s [s], gamma [-], b [m], u_s_max [m] and status, the last two (b, gamma, T_s)."""
        facts = self.facts()
        shape = (facts["n_T"], facts["n_gamma"], facts["n_b"])
        axes = [np.zeros(n) for n in shape]
        u_s_max = np.zeros(shape, order="F")
        _kernel.spectrum_values(self.handle, *axes, u_s_max)
        status = np.array(fetch_text(_kernel.spectrum_status, self.handle).splitlines(), dtype=str)
        return {
            "T_s": axes[0],
            "gamma": axes[1],
            "b": axes[2],
            "u_s_max": np.ascontiguousarray(u_s_max.T),
            "status": status.reshape(shape[::-1]),
        }

    def write(self, path: str) -> None:
        """Write the CSV file of the batch program."""
        message = message_buffer()
        status, n = _kernel.spectrum_write(self.handle, encode(path), message)
        raise_for(status, message, n, writing=True)


def start_simulation(text: str, source: str) -> Run:
    """Run one simulation in a worker thread.

    Parameters
    ----------
    text : str
        Namelist text.
    source : str
        Path of its file, '' when it was made in memory.

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
        return _kernel.simulate(encode(text), encode(source), control, message)

    return _wait_for(call, message, source, Run, None)


def start_spectrum(
    text: str, source: str, threads: int = 0, progress: Progress | None = None
) -> Sweep:
    """Compute a spectrum in a worker thread.

    Parameters
    ----------
    text : str
        Namelist text with `&spectrum`.
    source : str
        Path of its file, '' when it was made in memory.
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

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        return _kernel.spectrum(encode(text), encode(source), threads, control, message)

    return _wait_for(call, message, source, Sweep, progress)


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
