"""Time of walls that step with a host in Python, beside the kernel's own loop.

``python bench/hosts.py [WALLS]`` prints a table of microseconds. All walls rock under samples of
10 ms, one call for each interval unless stated.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import rwmf

TEXT = (
    "&wall h = 2.0, b = 0.5, m_w = 2.0e4 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
    "&impact rule = 'coupled' / &solver t_end = 10.0 /"
)
STEPS = 200
DT = 0.01
ROUNDS = 5


def best(work: Callable[[], float]) -> float:
    """Least of several times [s]: other programs can only increase a time."""
    return min(work() for _ in range(ROUNDS))


def motion() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and accelerations [m/s2]."""
    t = np.arange(STEPS + 1) * DT
    return t, 4.0 * np.sin(6.0 * t)


def one_call(case: rwmf.Case) -> float:
    """Time the kernel's own loop: all samples in one call."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = time.perf_counter()
        wall.advance_samples(t, a)
        return time.perf_counter() - begun


def one_wall(case: rwmf.Case) -> float:
    """Time a wall with a call for each interval."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = time.perf_counter()
        for i in range(STEPS):
            wall.advance_samples(t[i : i + 2], a[i : i + 2])
        return time.perf_counter() - begun


def with_state(case: rwmf.Case) -> float:
    """Time a wall whose state, forces and snapshot are taken at each interval."""
    t, a = motion()
    with rwmf.Wall(case) as wall:
        begun = time.perf_counter()
        for i in range(STEPS):
            wall.save()
            wall.advance_samples(t[i : i + 2], a[i : i + 2])
            _ = wall.state, wall.forces
        return time.perf_counter() - begun


def many_walls(case: rwmf.Case, walls: int, threads: int) -> float:
    """Time many walls with a call for each interval."""
    t, a = motion()
    with rwmf.Walls(case, walls, threads=threads) as group:
        begun = time.perf_counter()
        for i in range(STEPS):
            group.advance_samples(t[i : i + 2], a[i : i + 2])
        return time.perf_counter() - begun


def main() -> None:
    """Print the table."""
    walls = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    case = rwmf.Case.from_text(TEXT)
    scale = 1e6 / STEPS
    print("| | per wall and step [us] |")
    print("|---|---|")
    print(f"| one wall, all steps in one call | {best(lambda: one_call(case)) * scale:.2f} |")
    print(f"| one wall, a call for each step | {best(lambda: one_wall(case)) * scale:.2f} |")
    words = "with `save`, `state` and `forces` in each step"
    print(f"| one wall, {words} | {best(lambda: with_state(case)) * scale:.2f} |")
    for threads in (1, 2):
        seconds = best(partial(many_walls, case, walls, threads))
        print(f"| {walls:,} walls, a call for each step, threads = {threads} | "
              f"{seconds * scale / walls:.2f} |")  # fmt: skip
    print(f"\none call for {walls:,} walls: {seconds / STEPS * 1e3:.1f} ms", file=sys.stderr)


if __name__ == "__main__":
    main()
