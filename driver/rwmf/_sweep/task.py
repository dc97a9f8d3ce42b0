"""One chunk of a sweep: what a worker gets, what it gives back."""

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

__all__ = ["Chunk", "Task", "run_task"]

Progress = Callable[[int], None]


@dataclass(frozen=True, eq=False)
class Task:
    """One call of the kernel.

    Attributes
    ----------
    number : int
        Of the chunk.
    entries : dict
        Groups of the case of the first row.
    source : str
        Path against whose folder records are resolved.
    columns : tuple of str
        What differs from row to row, by the kernel's names.
    rows : numpy.ndarray, shape (rows, columns)
        The numbers.
    quantities : tuple of str
        What is kept of each run.
    motions : dict of str to Motion
        What stands for the records of ``motion`` and ``vertical`` in place of files.
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
        Of the chunk.
    names : tuple of str
        Statuses that occur: 'ok', 'overturned', 'collapsed' or the name of what went wrong.
    status : numpy.ndarray of uint8, shape (rows,)
        Places in `names`.
    values : dict of str to numpy.ndarray, each of that shape
        One array a quantity, NaN where a run failed.
    """

    number: int
    names: tuple[str, ...]
    status: npt.NDArray[np.uint8]
    values: dict[str, npt.NDArray[np.float64]]


def run_task(task: Task, progress: Progress | None = None) -> Chunk:
    """Compute a chunk. What the kernel refuses gets a status and does not stop the rest.

    Parameters
    ----------
    task : Task
        The chunk.
    progress : callable, optional
        Called with the number of finished runs; what it raises ends the computation.

    Returns
    -------
    Chunk
        The results.
    """
    missing = np.full(len(task.rows), np.nan)
    try:
        found = _compute(task, progress)
    except (InputError, NumericalError) as error:
        name = "refused" if isinstance(error, InputError) else "failed"
        status = np.zeros(len(task.rows), dtype=np.uint8)
        return Chunk(task.number, (name,), status, dict.fromkeys(task.quantities, missing))
    names, codes = np.unique(found["status"].ravel(), return_inverse=True)
    # a quantity whose effect is not in the scene has no value
    values = {
        name: np.array(found.get(QUANTITIES[name].key, missing)).ravel() for name in task.quantities
    }
    return Chunk(task.number, tuple(names.tolist()), codes.astype(np.uint8), values)


def _compute(task: Task, progress: Progress | None) -> dict[str, npt.NDArray[Any]]:
    samples = {group: motion.samples for group, motion in task.motions.items()}
    case = _library.read_case(compose(task.entries), task.source, None, **samples)
    allowed = case.applicable()
    # a quantity under both of its names is one key
    requested = dict.fromkeys(QUANTITIES[name].key for name in task.quantities)
    keys = [key for key in requested if key in allowed]
    with _library.start_rows(
        case, task.source, task.columns, task.rows, keys, task.threads, progress
    ) as sweep:
        return sweep.values()
