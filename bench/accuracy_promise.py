"""Checks on random scenes that `&solver accuracy` holds, and measures its cost.

    .venv/bin/python bench/accuracy_promise.py [N] [SEED] [QUANTITY] [STOREYS]

QUANTITY is the peak with the requested accuracy (u_s_max_m); with STOREYS the frames have as many
storeys instead of one degree of freedom. The requested accuracies are 1e-3, 1e-5, 1e-7 and 1e-9.
The delivered error is measured against two independent methods at their tightest tolerances. The
time, estimate included, is compared with that of the cheapest setting of equal accuracy from a
search over methods and tolerances. Prints a table in Markdown.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
import rwmf
from common import table
from random_cases import random_cases, with_storeys
from rwmf import records
from rwmf.run.quantities import find_quantities

ASKED = (1e-3, 1e-5, 1e-7, 1e-9)
TRUSTED = 1e-11
SEARCH = {
    "adams": np.logspace(-2, -11, 10),
    "taylor": np.logspace(-2, -10, 9),
    "dop853": np.logspace(-2, -13, 9),
}


def _run(case: rwmf.Case, quantity: str, **solver: object) -> tuple[float, dict[str, object]]:
    if "accuracy" in solver:
        case = case.replace(output=None)
        solver = solver | {"accuracy_of": quantity}
    result = rwmf.simulate(case.replace(solver=solver))
    return float(result[next(iter(find_quantities((quantity,))))]), result.attrs


def _search(case: rwmf.Case, quantity: str, trusted: float) -> list[tuple[float, float]]:
    """Error and time of every setting."""
    found = []
    for method, tolerances in SEARCH.items():
        for rtol in tolerances:
            peak, attrs = _run(case, quantity, method=method, rtol=float(rtol))
            found.append((abs(peak - trusted) / trusted, float(attrs["seconds"])))
    return found


def _cells(accuracy: float, found: list[tuple[float, float, float]]) -> list[str]:
    error, estimate, cost = np.array(found).T
    # below this both numbers are round-off
    judged = (estimate > 1e-12) & (error > 1e-12)
    ratio = estimate[judged] / error[judged]
    return [
        f"{accuracy:g}",
        f"{np.mean(error <= accuracy):.1%}",
        f"{np.max(error) / accuracy:.2g}",
        f"{np.mean((ratio >= 0.1) & (ratio <= 10)):.1%} of {judged.sum()}",
        f"{np.nanmedian(cost):.2f}",
    ]


def main(n: int = 240, seed: int = 1, quantity: str = "u_s_max_m", storeys: int = 0) -> None:
    """Run and print."""
    rows: dict[float, list[tuple[float, float, float]]] = {accuracy: [] for accuracy in ASKED}
    skipped = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("elcentro", "pacoima"):
            records.export(name, Path(folder) / f"{name}.csv")
        for case in random_cases(n, seed=seed, records=Path(folder)):
            if storeys:
                case = with_storeys(case, storeys)
            if quantity != "u_s_max_m":
                case = case.replace(output={"reactions": True})
            trusted, _ = _run(case, quantity, method="dop853", rtol=3e-14)
            other, _ = _run(case, quantity, method="taylor", rtol=1e-13)
            # a wall that never lifts off has an exact answer
            if trusted <= 0.0 or abs(other - trusted) > TRUSTED * trusted:
                skipped += 1
                continue
            settings = _search(case, quantity, trusted)
            for accuracy in ASKED:
                peak, attrs = _run(case, quantity, accuracy=accuracy, rtol=None)
                error = abs(peak - trusted) / trusted
                cheapest = min((s for e, s in settings if e <= accuracy), default=np.nan)
                cost = float(attrs["seconds"]) + float(attrs["estimate_seconds"])
                rows[accuracy].append(
                    (error, float(attrs["estimated_relative_error"]), cost / cheapest)
                )
    frames = f"{storeys} storeys" if storeys else "one degree of freedom"
    print(f"rwmf {rwmf.__version__}, {quantity}, {n} scenes of {frames}, seed {seed}; {skipped}")
    print("left out, in which nothing happens or the trusted methods differ by more than", end=" ")
    print(f"{TRUSTED:g}.\n")
    heads = ("accuracy", "kept in", "largest error / accuracy",
             "estimate within a factor of 10", "cost")  # fmt: skip
    print(table(heads, [_cells(accuracy, found) for accuracy, found in rows.items()]))
    print("\nCost: median time, estimate included, over that of the cheapest setting (search).")


if __name__ == "__main__":
    words = sys.argv[1:]
    main(*map(int, words[:2]), *words[2:3], *map(int, words[3:4]))
