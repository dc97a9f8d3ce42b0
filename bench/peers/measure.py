"""Times and errors of a program, estimated from a sample of its periods.

All times are of one thread unless stated. They are the smaller of wall-clock time and CPU time.
Both are at least the cost of the work; on a shared machine the wall-clock time includes other work.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import rwmf
from rwmf._library import kernel_thread

from peers.problem import Array, Peer, Record, Solver, bands, case

# a peer is run again up to so many times, until so much time is spent [s]
MOST_REPEATS = 20
ENOUGH = 3.0


@dataclass(frozen=True)
class Row:
    """Results of a program at one gamma."""

    program: str
    rtol: float
    """[-]; nan where there is none."""
    gamma: float
    """[-]."""
    ordinates: int
    """Solved, of all periods."""
    seconds: float
    """An ordinate, mean over all periods [s]."""
    errors: Array
    """Relative errors of the solved ones, (ordinates,) [-]."""

    @property
    def error(self) -> float:
        """Largest error [-]; nan when one is not a number."""
        return float(np.max(self.errors))


class Clock:
    """Time spent in a `with` block."""

    def __enter__(self) -> Clock:
        """Start."""
        self.wall, self.cpu = time.perf_counter(), time.process_time()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop."""
        spent = time.perf_counter() - self.wall, time.process_time() - self.cpu
        self.seconds = min(spent)


@contextmanager
def _worker_cpu() -> Iterator[list[float]]:
    """Collect the CPU times of the kernel's calls inside [s].

    `rwmf` calls the kernel in a separate thread, which excludes the overhead of Python.
    """
    beside, spent = kernel_thread._call_beside, []

    def timed(call: Callable[..., object], *arguments: object) -> object:
        def measured(control: object) -> object:
            begin = time.thread_time()
            try:
                return call(control)
            finally:
                spent.append(time.thread_time() - begin)

        return beside(measured, *arguments)  # type: ignore[arg-type]

    kernel_thread._call_beside = timed  # type: ignore[assignment]
    try:
        yield spent
    finally:
        kernel_thread._call_beside = beside


def kernel(
    scene: rwmf.Case,
    T_s: Array | None,
    gamma: float | None = None,
    threads: int = 1,
    repeats: int = 1,
) -> tuple[Array, float]:
    """Let the kernel compute a spectrum."""
    best = math.inf
    for _ in range(repeats):
        with _worker_cpu() as spent:
            found = rwmf.spectrum(scene, T_s=T_s, gamma=gamma, threads=threads)
        best = min(best, float(found.attrs["seconds"]), sum(spent) if threads == 1 else math.inf)
    return found.u_s_max.values.reshape(-1), best


def kernel_row(
    record: Record, method: str, rtol: float, gamma: float, T_s: Array, truth: Array, repeats: int
) -> Row:
    """Measure a method of the kernel on all periods."""
    peaks, seconds = kernel(case(record, method, rtol), T_s, gamma, repeats=repeats)
    return Row(method, rtol, gamma, T_s.size, seconds / T_s.size, np.abs(peaks / truth - 1))


def peer_row(peer: Peer, record: Record, gamma: float, T_s: Array, truth: Array) -> Row:
    """Measure a peer, a slow one on a sample.

    A sample takes `per_band` periods at the middle of equal parts of each band. The mean cost of
    each band is weighted by the number of its periods.
    """
    solve = peer.make(record, gamma, peer.rtol)
    seconds, errors = 0.0, []
    parts = bands(T_s) if peer.per_band else [np.arange(T_s.size)]
    for part in parts:
        chosen = part[_middles(part.size, peer.per_band)] if peer.per_band else part
        peaks, spent = _timed(solve, T_s[chosen])
        seconds += spent * part.size / chosen.size
        errors.append(np.abs(peaks / truth[chosen] - 1))
    found = np.concatenate(errors)
    return Row(peer.name, peer.rtol, gamma, found.size, seconds / T_s.size, found)


def _timed(solve: Solver, T_s: Array) -> tuple[Array, float]:
    """Return peaks and least time [s]; fast runs are repeated."""
    begin, best = time.monotonic(), math.inf
    for _ in range(MOST_REPEATS):
        with Clock() as clock:
            peaks = solve(T_s)
        # an external program measures its own time
        best = min(best, getattr(solve, "seconds", clock.seconds))
        if time.monotonic() - begin > ENOUGH:
            break
    return peaks, best


def _middles(n: int, wanted: int) -> npt.NDArray[np.int64]:
    """Return the places in the middle of `wanted` equal parts of n."""
    parts = min(wanted, n)
    return ((np.arange(parts) + 0.5) * n / parts).astype(int)
