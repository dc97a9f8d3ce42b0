"""Start of runs, spectra and static curves; results in the kernel's memory."""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._kernel import rwmf_bindings_python_static_curve as _curves
from rwmf.errors import InputError
from rwmf.kernel.kernel_case import KernelCase
from rwmf.kernel.marshalling import (
    Closing,
    Memory,
    MemoryView,
    Progress,
    encode,
    fetch_text,
    split_lines,
    summary_item,
    wait_for,
    write,
)
from rwmf.kernel.numbers import Array, show

# scalars of a run in one call
_FIRST_CAPACITY = 256


class Result(Closing):
    """A result in the kernel's memory, released at the end of the ``with`` block.

    Arrays that view the memory keep it alive.
    """

    def __init__(self, case: KernelCase, handle: int) -> None:
        self.case = case
        self._memory: Memory | None = Memory(handle)

    @property
    def memory(self) -> Memory:
        """The memory; its address must not be used after the release."""
        if self._memory is None:
            raise RuntimeError("this result of the kernel has been released")
        return self._memory

    @property
    def handle(self) -> int:
        """The handle of the memory."""
        return self.memory.handle

    def close(self) -> None:
        """Release the kernel's memory; further calls have no effect."""
        self._memory = None


class Run(Result):
    """Result of one simulation."""

    def summary(self) -> dict[str, Any]:
        """Return named scalars and lists: the keys of ``rwmf run --json`` in their order."""
        lines: list[str] = []
        capacity = _FIRST_CAPACITY
        while True:
            reals, counts = np.zeros(capacity), np.zeros(capacity, dtype=np.int64)
            numbers_of = (self.case.handle, self.handle, reals, counts)
            lines = split_lines(fetch_text(_kernel.result_summary, *numbers_of))
            if len(lines) <= capacity:
                break
            capacity = len(lines)
        numbers = zip(lines, reals.tolist(), counts.tolist(), strict=False)
        return dict(summary_item(*item) for item in numbers)

    def history(self) -> tuple[list[str], Array]:
        """Return column names and values (columns, rows); both empty without `&output dt`.

        The values are a view of the kernel's memory: all views of this history share changes.
        """
        address, n_rows, n_columns, _ = _kernel.result_history(self.handle)
        if n_columns == 0:
            return [], np.zeros((0, 0))
        values = np.asarray(MemoryView(self.memory, address, (n_columns, n_rows)))
        return fetch_text(_kernel.result_columns, self.handle).splitlines(), values

    def events(self) -> dict[str, npt.NDArray[Any]]:
        """Return arrays over the events: kind (names), t [s], theta [rad] and theta_dot [rad/s].

        For the bare frame theta is the displacement [m] and theta_dot its rate [m/s].
        """
        n = _kernel.result_history(self.handle)[3]
        kinds = np.zeros(n, dtype=np.intc)
        t, theta, theta_dot = (np.zeros(n) for _ in range(3))
        if n > 0:
            _kernel.result_events(self.handle, kinds, t, theta, theta_dot)
        names = np.array(fetch_text(_kernel.event_names).splitlines(), dtype=str)
        return {"kind": names[kinds - 1], "t": t, "theta": theta, "theta_dot": theta_dot}

    def write(self, text: str, source: str, folder: str) -> None:
        """Write the files of the batch program, named after `source`, into `folder`."""
        asked = (self.case.handle, self.handle, encode(text), encode(source), encode(folder))
        write(lambda *buffers: _kernel.result_write(*asked, *buffers))


class Spectrum(Result):
    """Result of a spectrum."""

    def warnings(self) -> list[str]:
        """Return the warnings for all ordinates."""
        return [
            line for line in fetch_text(_kernel.spectrum_warnings, self.handle).split("\t") if line
        ]

    def facts(self) -> dict[str, Any]:
        """Return sizes and cost: n_T, n_gamma, n_b, threads, rhs_evaluations, seconds."""
        names = ("n_T", "n_gamma", "n_b", "threads", "rhs_evaluations", "seconds")
        return dict(zip(names, _kernel.spectrum_shape(self.handle), strict=True))

    def values(self) -> dict[str, npt.NDArray[Any]]:
        """Return T_s [s], gamma [-], b [m], status (b, gamma, T_s) and quantities by their keys."""
        shape = tuple(_kernel.spectrum_shape(self.handle)[:3])
        keys = fetch_text(_kernel.spectrum_quantities, self.handle).split("\t")
        axes = [np.zeros(n) for n in shape]
        address = _kernel.spectrum_values(self.handle, *axes)
        found = np.asarray(MemoryView(self.memory, address, (len(keys), *shape[::-1])))
        places = np.zeros(found[0].size, dtype=np.int8)
        names = fetch_text(_kernel.spectrum_status, self.handle, places).split("\t")
        # only statuses that occur: the longest name sets the memory per ordinate
        counts = np.bincount(places, minlength=len(names) + 1)
        used = [name if n > 0 else "" for name, n in zip(["", *names], counts, strict=True)]
        status = np.array(used, dtype=str)[places]
        return dict(zip(keys, found, strict=True)) | {
            "T_s": axes[0],
            "gamma": axes[1],
            "b": axes[2],
            "status": status.reshape(shape[::-1]),
        }

    def write(self, text: str, path: str) -> None:
        """Write the CSV file of the batch program, with the namelist text of the case in it."""
        asked = (self.case.handle, self.handle, encode(text), encode(path))
        write(lambda *buffers: _kernel.spectrum_write(*asked, *buffers))


@dataclass(frozen=True)
class StaticCurve:
    """Curve of a case under static lateral loads.

    Attributes
    ----------
    columns : dict of str to numpy.ndarray, each shape (steps,)
        Values by the kernel's names, units included.
    marks : list of tuple
        Names of the events and their steps, from 0.
    pattern : numpy.ndarray, shape (loads,)
        Share of each floor in the load.
    ending : str
        'complete', 'overturned', 'collapsed', 'no_equilibrium' or 'no_contact'.
    height : float
        Height of the roof [m].
    weights : tuple of float
        Weight of the reference mass of ratios, and of wall and frame [N]; 0 without masses.
    """

    columns: dict[str, Array]
    marks: list[tuple[str, int]]
    pattern: Array
    ending: str
    height: float
    weights: tuple[float, float]


def compute_curve(
    case: KernelCase, source: str, pattern: str, forces: Array, drifts: Array, steps: int
) -> StaticCurve:
    """Move the roof of a case slowly through a protocol of drifts."""
    asked = (encode(pattern), forces, drifts, steps)
    with _started(Result, case, source, None, _curves.pushover, *asked) as found:
        return _copy(case, found.handle)


def _copy(case: KernelCase, handle: int) -> StaticCurve:
    """Copy a curve from the kernel."""
    n_columns, n_rows, n_marks, n_loads, height, weights = _curves.curve_shape(case.handle, handle)
    values = np.zeros((n_columns, n_rows), order="F")
    rows, pattern = np.zeros(n_marks, dtype=np.intc), np.zeros(n_loads)
    _curves.curve_values(handle, values, rows, pattern)
    ending, *names = fetch_text(_curves.curve_names, handle).split("\t")
    columns = {name: np.array(row) for name, row in zip(names[:n_columns], values, strict=True)}
    marks = [(name, int(row) - 1) for name, row in zip(names[n_columns:], rows, strict=True)]
    return StaticCurve(
        columns, marks, pattern, ending, float(height), (float(weights[0]), float(weights[1]))
    )


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


_Kept = TypeVar("_Kept", bound=Result)


def _started(
    kind: type[_Kept],
    case: KernelCase,
    source: str,
    progress: Progress | None,
    procedure: Callable[..., Any],
    *asked: object,
) -> _Kept:
    """Compute in a worker thread; the procedure returns the handle of its result."""
    with case.own_lines():
        return wait_for(
            lambda *buffers: procedure(case.handle, *asked, *buffers),
            source,
            lambda handle: kind(case, handle),
            progress,
        )


def start_simulation(case: KernelCase, source: str, progress: Progress | None = None) -> Run:
    """Run one simulation in a worker thread."""
    return _started(Run, case, source, progress, _kernel.simulate)


def start_spectrum(
    case: KernelCase,
    source: str,
    threads: int = 0,
    progress: Progress | None = None,
    quantities: Sequence[str] = (),
) -> Spectrum:
    """Compute a spectrum in a worker thread."""
    asked = (encode("\t".join(quantities)), check_threads(threads))
    return _started(Spectrum, case, source, progress, _kernel.spectrum, *asked)


def start_rows(
    case: KernelCase,
    source: str,
    columns: Sequence[str],
    values: Array,
    quantities: Sequence[str] = (),
    threads: int = 0,
    progress: Progress | None = None,
) -> Spectrum:
    """Compute runs of one case with different numbers in a worker thread."""
    # the kernel's order; row-wise data need no copy
    table = np.ascontiguousarray(values, dtype=np.float64).T
    names, keys = encode("\t".join(columns)), encode("\t".join(quantities))
    asked = (names, table, keys, check_threads(threads))
    return _started(Spectrum, case, source, progress, _kernel.rows, *asked)


def result_names(source: str) -> list[str]:
    """Return the names of the files that the batch program may write for a case."""
    return split_lines(fetch_text(_kernel.result_names, encode(source)))
