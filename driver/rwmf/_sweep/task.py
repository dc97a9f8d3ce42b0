"""Chunk of a sweep: input and output of a worker."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._sweep.axes import Entries
from rwmf._sweep.kept_quantities import QUANTITIES
from rwmf.case import Motion
from rwmf.case.namelist import compose
from rwmf.errors import InputError, NumericalError
from rwmf.quantities import SENSITIVITY

__all__ = ["Chunk", "Task", "run_task"]

Progress = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class Task:
    """One kernel call.

    Attributes
    ----------
    number : int
        Number of the chunk.
    entries : dict
        Groups of the case of the first row.
    source : str
        Path whose folder records are relative to.
    columns : tuple of str
        Kernel names of the quantities that differ between rows.
    rows : numpy.ndarray, shape (rows, columns)
        The numbers.
    quantities : tuple of str
        Quantities stored for each run.
    motions : dict of str to Motion
        Motions from arrays that replace the records of ``motion`` and ``vertical``.
    threads : int
        Threads of the kernel.
    """

    number: int
    entries: Entries
    source: str
    columns: tuple[str, ...]
    rows: npt.NDArray[np.float64]
    quantities: tuple[str, ...]
    motions: dict[str, Motion]
    threads: int = 1


@dataclass(frozen=True, eq=False)
class Chunk:
    """Results of a task.

    Attributes
    ----------
    number : int
        Number of the chunk.
    names : tuple of str
        Statuses that occur: 'ok', 'overturned', 'collapsed' or the name of an error.
    status : numpy.ndarray of uint8, shape (rows,)
        Indices into `names`.
    values : dict of str to numpy.ndarray, each of that shape
        One array per quantity, NaN where a run failed.
    """

    number: int
    names: tuple[str, ...]
    status: npt.NDArray[np.uint8]
    values: dict[str, npt.NDArray[np.float64]]


def run_task(task: Task, progress: Progress | None = None) -> Chunk:
    """Compute a chunk; refused rows get a status and do not stop the others."""
    missing = np.full(len(task.rows), np.nan)
    try:
        found = _compute(task, progress)
    except (InputError, NumericalError) as error:
        name = "refused" if isinstance(error, InputError) else "failed"
        status = np.zeros(len(task.rows), dtype=np.uint8)
        return Chunk(task.number, (name,), status, dict.fromkeys(task.quantities, missing))
    names, codes = np.unique(found["status"].ravel(), return_inverse=True)
    # quantities of absent effects have no value
    values = {
        name: np.array(found.get(QUANTITIES[name].key, missing)).ravel() for name in task.quantities
    }
    return Chunk(task.number, tuple(names.tolist()), codes.astype(np.uint8), values)


def _compute(task: Task, progress: Progress | None) -> dict[str, npt.NDArray[Any]]:
    samples = {group: motion.samples for group, motion in task.motions.items()}
    case = _library.read_case(compose(task.entries), task.source, None, **samples)
    allowed = case.applicable()
    # both names of a quantity have the same key
    requested = dict.fromkeys(QUANTITIES[name].key for name in task.quantities)
    keys = [key for key in requested if key.removeprefix(SENSITIVITY) in allowed]
    with _library.start_rows(
        case, task.source, task.columns, task.rows, keys, task.threads, progress
    ) as sweep:
        return sweep.values()
