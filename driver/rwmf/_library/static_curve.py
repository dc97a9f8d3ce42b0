"""Static curves of the kernel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_static_curve as _kernel
from rwmf._library.kernel_case import KernelCase
from rwmf._library.kernel_thread import wait_for
from rwmf._library.marshalling import encode, fetch_text, message_buffer
from rwmf._library.results import Result

__all__ = ["StaticCurve", "compute_curve"]

Array = npt.NDArray[np.float64]


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
    message = message_buffer()

    def call(control: npt.NDArray[np.int64]) -> tuple[int, int, int]:
        handle, status, n = _kernel.pushover(
            case.handle, encode(pattern), forces, drifts, steps, control, message
        )
        return handle, status, n

    with case.own_lines():
        found = wait_for(call, message, source, lambda handle: Result(case, handle), None)
    with found:
        return _copy(case, found.handle)


def _copy(case: KernelCase, handle: int) -> StaticCurve:
    """Copy a curve from the kernel."""
    n_columns, n_rows, n_marks, n_loads, height, weights = _kernel.curve_shape(case.handle, handle)
    values = np.zeros((n_columns, n_rows), order="F")
    rows, pattern = np.zeros(n_marks, dtype=np.intc), np.zeros(n_loads)
    _kernel.curve_values(handle, values, rows, pattern)
    ending, *names = fetch_text(_kernel.curve_names, handle).split("\t")
    columns = {name: np.array(row) for name, row in zip(names[:n_columns], values, strict=True)}
    marks = [(name, int(row) - 1) for name, row in zip(names[n_columns:], rows, strict=True)]
    return StaticCurve(
        columns, marks, pattern, ending, float(height), (float(weights[0]), float(weights[1]))
    )
