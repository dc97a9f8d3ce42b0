"""Dependence of an ordinate's cost on ordinates, length, tolerance, threads and formulation."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import numpy as np

from peers.measure import Row, kernel, kernel_row
from peers.problem import BANDS, GAMMAS, Array, G, Record, case, read_record

RTOL = 1e-7
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
LENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)
FORMULATIONS = (
    ("published", "linear"),
    ("symmetric", "linear"),
    ("exact", "linear"),
    ("exact", "truss"),
)
Points = list[tuple[float, float]]
"""Varied parameter, and the time of one ordinate [s]."""


def ordinates(record: Record, most: int, repeats: int) -> Points:
    """Time over the number of ordinates."""
    found, n = [], 1
    while n <= most:
        # a list of periods is limited, a grid is not
        grid = {"T_s_min": 0.3, "T_s_max": 3.0, "n": n, "spacing": "linear"}
        scene = case(record, "auto", RTOL, spectrum=grid if n > 1 else {"T_s": [1.0]})
        _, seconds = kernel(scene, None, GAMMAS[0], repeats=repeats if n <= 1000 else 1)
        found.append((float(n), seconds / n))
        n *= 10
    return found


def lengths(record: Record, T_s: Array, repeats: int) -> Points:
    """Time over the length of the record: the first part of it, or several times in a row."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for factor in LENGTHS:
            longer = _scaled(record, factor, Path(folder) / f"{factor}.csv")
            _, seconds = kernel(case(longer, "auto", RTOL), T_s, GAMMAS[0], repeats=repeats)
            found.append((float(longer.t[-1]), seconds / T_s.size))
    return found


def _scaled(record: Record, factor: float, path: Path) -> Record:
    a = np.tile(record.a, max(1, round(factor)))[: round(factor * record.a.size)]
    t = record.interval * np.arange(a.size)
    lines = [f"{t_k:.10g},{a_k / G:.17g}" for t_k, a_k in zip(t, a, strict=True)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_record(path)


def tolerances(record: Record, T_s: Array, truth: dict[float, Array], repeats: int) -> list[Row]:
    """Measure time and error over the requested tolerance."""
    return [
        kernel_row(record, "auto", rtol, gamma, T_s, truth[gamma], repeats)
        for gamma in GAMMAS
        for rtol in TOLERANCES
    ]


def threads(record: Record, n: int, repeats: int) -> Points:
    """Time over the number of threads, measured in turn."""
    counts = sorted({1, *(2**k for k in range(1, 10) if 2**k <= (os.cpu_count() or 1))})
    best = dict.fromkeys(counts, np.inf)
    T_s = np.linspace(0.3, 3.0, n)
    for _ in range(repeats):
        for count in counts:
            _, seconds = kernel(case(record, "auto", RTOL), T_s, GAMMAS[0], threads=count)
            best[count] = min(best[count], seconds)
    return [(float(count), seconds / n) for count, seconds in best.items()]


def formulations(record: Record, n: int, repeats: int) -> list[tuple[str, float, list[float]]]:
    """Time of formulations and cable laws in each band of periods."""
    found = []
    for formulation, law in FORMULATIONS:
        for gamma in GAMMAS:
            scene = case(record, "auto", RTOL).replace(
                model={"formulation": formulation}, cable={"law": law}
            )
            costs = [
                kernel(scene, np.linspace(*band, n), gamma, repeats=repeats)[1] / n
                for band in BANDS
            ]
            found.append((f"{formulation}, {law}", gamma, costs))
    return found
