"""Cost of a row of a Monte Carlo table relative to an ordinate of a grid, and memory use.

    .venv/bin/python bench/rows.py                  both parts
    .venv/bin/python bench/rows.py costs [N]        of N rows, 4000 when it is not given
    .venv/bin/python bench/rows.py memory [N]       of N rows of a bare frame, 10 million

Costs are the processor times of the kernel over that of a grid of as many periods under the same
record (El Centro). Grid and table run in turns on one thread, and the smallest of five counts.
Periods are from 0.2 to 3 s, all other numbers within 10 to 30 % of those of the case. Memory is the
increase of the peak
resident size in the call, and then after showing its results to numpy.
"""

from __future__ import annotations

import math
import resource
import sys
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
from peers.problem import case, read_record
from rwmf import _library
from rwmf._library import KernelCase

RECORD = Path(__file__).resolve().parent.parent / "inputs" / "records" / "elcentro.csv"
REPEATS = 5
YIELDING: dict[str, object] = {"u_y": 0.02, "hardening": 0.05}
# a scene, its columns beside the period with their ranges, and its quantities
WALL = {
    "gamma": 0.2,
    "b": 0.1,
    "wall.h": 0.1,
    "frame.xi_s": 0.3,
    "cable.eta_0": 0.2,
    "cable.eta_alpha": 0.2,
    "impact.e": 0.05,
    "scale": 0.3,
}
FIVE = (
    "u_s_max_m",
    "theta_max_over_alpha",
    "cable_force_increment_max_over_m_w_g",
    "e",
    "overturned",
)
SCENES: tuple[tuple[str, dict[str, object], Mapping[str, float], Sequence[str]], ...] = (
    ("scale", {}, {"scale": 0.3}, FIVE[:1]),
    ("gamma, b", {}, {"gamma": 0.2, "b": 0.1}, FIVE[:1]),
    ("gamma, b, h, xi_s, eta_0, eta_alpha, e, scale", {}, WALL, FIVE[:1]),
    ("the same, five quantities", {}, WALL, FIVE),
    ("the same, general lanes", {"solver": {"method": "dop853"}}, WALL, FIVE[:1]),
    ("the same, yielding frame", {"yielding": YIELDING}, WALL | {"yielding.u_y": 0.2}, FIVE[:1]),
)

Array = npt.NDArray[np.float64]


def _seconds(scene: KernelCase, columns: Sequence[str], table: Array, keys: Sequence[str]) -> float:
    """Processor time of one call [s]."""
    started = time.process_time()
    _library.start_rows(scene, "", columns, table, keys, threads=1).close()
    return time.process_time() - started


def _print_costs(n: int) -> None:
    """Print the costs of rows relative to ordinates of a grid."""
    generator = np.random.default_rng(1)
    T_s = np.sort(generator.uniform(0.2, 3.0, n))
    print(f"| {n} rows: columns beside T_s | row, us | ordinate of a grid, us | ratio |")
    print("|---|---|---|---|")
    for name, groups, spread, keys in SCENES:
        scene = case(read_record(RECORD), "auto", 1e-7).replace(
            model={"formulation": "symmetric"}, frame={"gamma": 5.0}, **groups
        )
        base = {"gamma": "frame.gamma", "b": "wall.b"}
        known = {row[0]: row[2] for row in scene.kernel.describe()}
        table = [T_s]
        for column, width in spread.items():
            middle = 1.0 if column == "scale" else float(known[base.get(column, column)])
            table.append(middle * generator.uniform(1 - width, 1 + width, n))
        rows = np.column_stack(table)
        row, ordinate = math.inf, math.inf
        for _ in range(REPEATS):
            ordinate = min(ordinate, _seconds(scene.kernel, ["T_s"], rows[:, :1], keys[:1]))
            row = min(row, _seconds(scene.kernel, ["T_s", *spread], rows, keys))
        print(f"| {name} | {1e6 * row / n:.1f} | {1e6 * ordinate / n:.1f} | {row / ordinate:.2f} |")


def _largest() -> int:
    """Largest resident size of the process so far [bytes]."""
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _print_memory(n: int) -> None:
    """Print the memory of rows during the computation, and of their results."""
    text = (
        "&frame T_s=1.0, xi_s=0.05 / &motion kind='one_sine', a_max_g=0.3, T_p=0.5 / "
        "&solver t_end=0.6, rtol=1e-5 /"
    )
    scene = _library.read_case(text, "")
    table = np.linspace(0.2, 3.0, n)[:, np.newaxis]
    before = _largest()
    started = time.perf_counter()
    with _library.start_rows(scene, "", ["T_s"], table) as found:
        seconds = time.perf_counter() - started
        computed = _largest()
        values = found.values()
        shown = _largest()
        assert np.isfinite(values["u_s_max_m"]).all()
    print(f"\n{n} rows in one call, {seconds:.1f} s: {(computed - before) / n:.1f} bytes a row,")
    print(f"with its results in numpy {(shown - before) / n:.1f} (the table itself has 8 a number)")


if __name__ == "__main__":
    parts = {"costs": (_print_costs, 4000), "memory": (_print_memory, 10_000_000)}
    if len(sys.argv) > 1:
        part, size = parts[sys.argv[1]]
        part(int(sys.argv[2]) if len(sys.argv) > 2 else size)
    else:
        for part, size in parts.values():
            part(size)
