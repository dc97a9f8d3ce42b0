"""One chunk of a sweep: what a worker gets, what it gives back."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._sweep.axes import PLACES, Entries
from rwmf._sweep.quantities import QUANTITIES
from rwmf.case.namelist import compose
from rwmf.errors import InputError, NumericalError
from rwmf.quantities import ending_of

__all__ = ["Chunk", "Task", "run_task"]

Progress = Callable[[int], None]


@dataclass(frozen=True)
class Task:
    """One call of the kernel, or one a point where there is no frame.

    Attributes
    ----------
    number : int
        Of the chunk.
    entries : dict
        Groups of the case without its grid.
    source : str
        Path against whose folder records are resolved.
    grid : tuple of (name, values)
        Axes inside the chunk, slowest first: b [m], gamma [-], T_s [s] as far as there are.
    quantities : tuple of str
        What is kept of each run.
    threads : int
        Threads of the kernel.
    """

    number: int
    entries: Entries
    source: str
    grid: tuple[tuple[str, tuple[float, ...]], ...]
    quantities: tuple[str, ...]
    threads: int = 1

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the chunk."""
        return tuple(len(values) for _, values in self.grid)


@dataclass(frozen=True)
class Chunk:
    """Results of a task.

    Attributes
    ----------
    number : int
        Of the chunk.
    status : numpy.ndarray of str, shape `Layout.chunk_shape`
        'ok', 'overturned', 'collapsed' or the name of what went wrong.
    values : dict of str to numpy.ndarray, each of that shape
        One array a quantity, NaN where a run failed.
    """

    number: int
    status: npt.NDArray[np.str_]
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
    if any(name == "T_s" for name, _ in task.grid):
        return _run_grid(task, progress)
    return _run_points(task, progress)


def _run_grid(task: Task, progress: Progress | None) -> Chunk:
    """Leave the whole chunk to the kernel."""
    keys = {name: QUANTITIES[name].key for name in task.quantities}
    try:
        try:
            found = _compute_grid(task, tuple(keys.values()), progress)
        except InputError:
            # a quantity whose effect is not in the scene has no value
            allowed = _read_grid(task, ()).applicable()
            found = _compute_grid(
                task, tuple(key for key in keys.values() if key in allowed), progress
            )
    except (InputError, NumericalError) as error:
        return _failed(task, _status_of(error))
    missing = np.full(task.shape, np.nan)
    values = {name: found.get(key, missing).reshape(task.shape) for name, key in keys.items()}
    return Chunk(task.number, found["status"].reshape(task.shape), values)


def _read_grid(task: Task, keys: tuple[str, ...]) -> _library.KernelCase:
    grid: dict[str, object] = dict(task.grid)
    if keys:
        grid["quantities"] = keys
    return _library.read_case(compose(task.entries | {"spectrum": grid}), task.source)


def _compute_grid(
    task: Task, keys: tuple[str, ...], progress: Progress | None
) -> dict[str, npt.NDArray[Any]]:
    case = _read_grid(task, keys)
    with _library.start_spectrum(case, task.source, task.threads, progress) as sweep:
        return sweep.values()


def _run_points(task: Task, progress: Progress | None) -> Chunk:
    """Simulate the chunk's points one after the other for the scalars of their summaries."""
    status: list[str] = []
    rows: list[list[float]] = []
    # the record of the points is read once
    case = None
    for point in itertools.product(*(values for _, values in task.grid)):
        if progress is not None:
            progress(len(rows))
        text = compose(_with_point(task, point))
        try:
            case = _library.read_case(text, task.source, case)
            with _library.start_simulation(case, task.source) as run:
                summary = run.summary()
        except (InputError, NumericalError) as error:
            status.append(_status_of(error))
            rows.append([np.nan] * len(task.quantities))
            continue
        status.append(ending_of(summary))
        # a quantity whose effect is not in the scene has no value
        rows.append([summary.get(QUANTITIES[name].key, np.nan) for name in task.quantities])
    columns = np.array(rows, dtype=np.float64).T
    values = {
        name: np.ascontiguousarray(column).reshape(task.shape)
        for name, column in zip(task.quantities, columns, strict=True)
    }
    return Chunk(task.number, np.array(status, dtype=str).reshape(task.shape), values)


def _with_point(task: Task, point: tuple[float, ...]) -> Entries:
    entries = {group: dict(keys) for group, keys in task.entries.items()}
    for (name, _), value in zip(task.grid, point, strict=True):
        group, key = PLACES[name]
        entries.setdefault(group, {})[key] = value
    return entries


def _failed(task: Task, status: str) -> Chunk:
    values = {name: np.full(task.shape, np.nan) for name in task.quantities}
    return Chunk(task.number, np.full(task.shape, status), values)


def _status_of(error: Exception) -> str:
    return "refused" if isinstance(error, InputError) else "failed"
