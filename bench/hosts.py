"""Time of walls that step with a host in Python, beside the kernel's own loop.

``python bench/hosts.py [WALLS]`` prints microseconds for a wall and step. All walls rock under
samples of 10 ms, one call for each interval unless stated.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import rwmf

TEXT = (
    "&wall h = 2.0, b = 0.5, m_w = 2.0e4 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
    "&impact rule = 'coupled' / &solver t_end = 10.0 /"
)
STEPS = 100
DT = 0.01
ROUNDS = 3


class Times(NamedTuple):
    """Times of some work [s]."""

    elapsed: float
    processor: float


def best(work: Callable[[], Times]) -> Times:
    """Return the least of several times: other programs can only increase a time."""
    found = [work() for _ in range(ROUNDS)]
    return Times(*(min(times) for times in zip(*found, strict=True)))


def clock() -> Times:
    """Read the clocks."""
    return Times(time.perf_counter(), time.process_time())


def since(begin: Times) -> Times:
    """Return the times since a reading."""
    return Times(*(now - then for now, then in zip(clock(), begin, strict=True)))


def motion() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and accelerations [m/s2]."""
    t = np.arange(STEPS + 1) * DT
    return t, 4.0 * np.sin(6.0 * t)


def one_call(case: rwmf.Case) -> Times:
    """Time the kernel's own loop: all samples in one call."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = clock()
        wall.advance_samples(t, a)
        return since(begun)


def one_wall(case: rwmf.Case) -> Times:
    """Time a wall with a call for each interval."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = clock()
        for i in range(STEPS):
            wall.advance_samples(t[i : i + 2], a[i : i + 2])
        return since(begun)


def with_state(case: rwmf.Case) -> Times:
    """Time a wall whose state, forces and snapshot are taken at each interval."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = clock()
        for i in range(STEPS):
            wall.save()
            wall.advance_samples(t[i : i + 2], a[i : i + 2])
            _ = wall.state, wall.forces
        return since(begun)


def many_walls(case: rwmf.Case, walls: int, threads: int) -> Times:
    """Time many walls with a call for each interval."""
    t, a = motion()
    with rwmf.Walls(case, walls, threads=threads) as group:
        begun = clock()
        for i in range(STEPS):
            group.advance_samples(t[i : i + 2], a[i : i + 2])
        return since(begun)


def row(words: str, times: Times, steps: int, of_loop: float) -> None:
    """Print a row: microseconds for a wall and step, and the ratio to the kernel's loop."""
    processor, elapsed = (1e6 * seconds / steps for seconds in (times.processor, times.elapsed))
    print(f"| {words} | {processor:.2f} | {elapsed:.2f} | {processor / of_loop:.1f} |")


def main() -> None:
    """Print the table."""
    walls = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    case = rwmf.Case.from_text(TEXT)
    print("| | processor [us] | elapsed [us] | processor over that of one call |")
    print("|---|---|---|---|")
    whole = best(partial(one_call, case))
    of_loop = 1e6 * whole.processor / STEPS
    row("one wall, all steps in one call", whole, STEPS, of_loop)
    row("one wall, a call for each step", best(partial(one_wall, case)), STEPS, of_loop)
    words = "the same with `save`, `state` and `forces` in each step"
    row(words, best(partial(with_state, case)), STEPS, of_loop)
    for n, threads in ((100, 1), (walls, 1), (walls, 2)):
        words = f"{n:,} walls in {threads} {'thread' if threads == 1 else 'threads'}"
        row(words, best(partial(many_walls, case, n, threads)), STEPS * n, of_loop)


if __name__ == "__main__":
    main()
