"""Coverage of the 95 % bands of fragility curves over synthetic trials.

    python bench/fragility_bands.py [--trials 1000]

A trial draws capacities of records from a lognormal law and counts those that fail at each level.
The coverage is the share of the trials whose band contains the true value. Percentile bootstraps
of small samples cover less than their name says; the numbers are reported, not tuned.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import rwmf
import xarray as xr

MEDIAN, DISPERSION = 1.0, 0.4
LEVELS = [0.4, 0.6, 0.8, 1.0, 1.3, 1.7]
SEED = 1


def stripes(capacity: np.ndarray) -> dict[str, list[object]]:
    """Make the table of stripes of records with given capacities."""
    rows = [
        (str(i), level, "collapsed" if level > own else "ok")
        for i, own in enumerate(capacity)
        for level in LEVELS
    ]
    return dict(
        zip(("record", "intensity", "status"), map(list, zip(*rows, strict=True)), strict=True)
    )


def bracketed(capacity: np.ndarray) -> dict[str, list[object]]:
    """Make the table of an incremental dynamic analysis, with capacities within 2 %."""
    rows = [
        (str(i), own * factor, status)
        for i, own in enumerate(capacity)
        for factor, status in ((0.99, "ok"), (1.01, "collapsed"))
    ]
    return dict(
        zip(("record", "intensity", "status"), map(list, zip(*rows, strict=True)), strict=True)
    )


def holds(found: xr.Dataset, name: str, truth: float) -> bool:
    """Check whether a band contains the true value."""
    low, high = found[f"{name}_band"].values
    return bool(low <= truth <= high)


def main() -> None:
    """Print the coverage of bands for both methods and three numbers of records."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=1000)
    trials = parser.parse_args().trials
    chance = np.random.default_rng(SEED)
    print("| method | records | trials | median [%] | dispersion [%] | seconds per fit |")
    print("|---|---|---|---|---|---|")
    for method, table in (("counts", stripes), ("capacities", bracketed)):
        for n in (20, 44, 100):
            kept, started, used = np.zeros(2), time.perf_counter(), 0
            for _ in range(trials):
                capacity = MEDIAN * np.exp(DISPERSION * chance.standard_normal(n))
                found = rwmf.fragility(table(capacity), method=method, resamples=400)
                kept += [holds(found, "median", MEDIAN), holds(found, "dispersion", DISPERSION)]
                used += 1
            seconds = (time.perf_counter() - started) / used
            shares = " | ".join(f"{100 * share:.1f}" for share in kept / used)
            print(f"| {method} | {n} | {used} | {shares} | {seconds:.3f} |", flush=True)


if __name__ == "__main__":
    main()
