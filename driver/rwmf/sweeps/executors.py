"""Execution of chunks: threads of the kernel, or any executor of ``concurrent.futures``."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import contextmanager

from rwmf.errors import InputError
from rwmf.kernel.names import needed
from rwmf.kernel.results import check_threads
from rwmf.sweeps.plan import Chunk, Task, run_task

EXECUTORS = ("threads", "processes", "mpi", "dask")
Report = Callable[[int], None]
# chunks queued in an executor: enough for a thousand workers with little memory
_WINDOW = 2048
# chunks queued for each thread of this process
_CHUNKS_AHEAD = 2
_WAIT_SECONDS = 0.1
# with fewer chunks per thread, threads of the kernel share each chunk more evenly
_CHUNKS_A_THREAD = 4


class _StoppedError(Exception):
    """Stops the kernels of the other threads."""


def count_threads(threads: int) -> int:
    """Return the number of threads to use."""
    if check_threads(threads) > 0:
        return threads
    requested = os.environ.get("OMP_NUM_THREADS", "")
    if requested.isdecimal() and int(requested) > 0:
        return check_threads(int(requested), "OMP_NUM_THREADS")
    return len(os.sched_getaffinity(0))


def run_in_threads(
    make: Callable[[int, int], Task],
    numbers: list[int],
    threads: int,
    report: Report,
) -> Iterator[Chunk]:
    """Compute chunks with threads of this process."""
    n = count_threads(threads)
    alone = len(numbers) < _CHUNKS_A_THREAD * n
    # finished runs in unfinished chunks
    done: dict[int, int] = {}
    stop = threading.Event()

    def work(task: Task) -> Chunk:
        def count(runs: int) -> None:
            if stop.is_set():
                raise _StoppedError
            done[task.number] = runs

        try:
            return run_task(task, count)
        finally:
            done.pop(task.number, None)

    def report_count() -> None:
        # a copy, because other threads modify the counts
        report(sum(list(done.values())))

    tasks = (make(number, n if alone else 1) for number in numbers)
    with ThreadPoolExecutor(1 if alone else n, thread_name_prefix="rwmf-sweep") as executor:
        try:
            yield from _stream(executor, work, tasks, report_count, _CHUNKS_AHEAD * n)
        except BaseException:
            stop.set()
            executor.shutdown(wait=True, cancel_futures=True)
            raise


def run_on(executor: Executor, tasks: Iterable[Task]) -> Iterator[Chunk]:
    """Compute chunks on an executor of the caller, without closing it."""
    yield from _stream(executor, run_task, tasks, lambda: None)


def _stream(
    executor: Executor,
    work: Callable[[Task], Chunk],
    tasks: Iterable[Task],
    idle: Callable[[], None],
    window: int = _WINDOW,
) -> Iterator[Chunk]:
    """Keep the queue of the executor filled, and yield results as they arrive."""
    waiting: set[Future[Chunk]] = set()
    supply = iter(tasks)
    try:
        while True:
            while len(waiting) < window and (task := next(supply, None)) is not None:
                waiting.add(_submit(executor, work, task))
            if not waiting:
                return
            done, waiting = wait(waiting, _WAIT_SECONDS, FIRST_COMPLETED)
            idle()
            for future in done:
                yield future.result()
    except BrokenExecutor as error:
        raise _refusal(error) from error
    finally:
        for future in waiting:
            future.cancel()


def _submit(executor: Executor, work: Callable[[Task], Chunk], task: Task) -> Future[Chunk]:
    try:
        return executor.submit(work, task)
    except (RuntimeError, OSError) as error:
        # OSError: the workers ended during the call, which then writes to a closed pipe
        raise _refusal(error) from error


def _refusal(error: Exception) -> InputError:
    """Return the error for an executor whose workers have ended or that is shut down."""
    cause = " ".join(str(error).split()).partition(". ")[0]
    return InputError(
        f"executor: has no workers ({cause.rstrip('.')}): a script must create it below "
        "`if __name__ == '__main__':`, before its end or shutdown"
    )


@contextmanager
def open_executor(name: str, workers: int = 0) -> Iterator[Executor | None]:
    """Start the executor named on the command line, and shut it down at the end."""
    kind, _, address = name.partition(":")
    kind = kind.lower()
    if workers < 0:
        raise InputError(f"workers = {workers}: must be >= 0 (0: one a core)")
    makers = {"processes": _processes, "mpi": _mpi, "dask": _dask}
    if kind == "threads" and not address:
        yield None
    elif kind in makers and (kind == "dask" or not address):
        with makers[kind](address, workers or count_threads(0)) as executor:
            yield executor
    else:
        raise InputError(f"engine {name}: allowed are {', '.join(EXECUTORS)}, dask:ADDRESS")


@contextmanager
def _processes(_: str, workers: int) -> Iterator[Executor]:
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    # a forked child would copy locks held by threads of its parent
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as executor:
        yield executor


@contextmanager
def _mpi(_: str, __: int) -> Iterator[Executor]:
    with needed("mpi", "engine mpi: needs the package mpi4py and an MPI"):
        from mpi4py.futures import MPIPoolExecutor
    with MPIPoolExecutor() as executor:
        yield executor


@contextmanager
def _dask(address: str, workers: int) -> Iterator[Executor]:
    with needed("dask", "engine dask: needs the package distributed"):
        from distributed import Client
    here = {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    try:
        # silence messages about workers that start and stop
        client = Client(address, timeout=30) if address else Client(**here, silence_logs=50)
    except (ValueError, OSError) as error:
        raise InputError(
            f"engine dask:{address}: no scheduler answers there: {error}; an address is "
            "tcp://HOST:PORT"
        ) from error
    with client, client.get_executor() as executor:
        yield executor
