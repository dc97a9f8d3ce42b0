"""Slope of a suite's median, share of sensitive records, and ranges tried at random steps.

    .venv/bin/python bench/suite_gradients.py CASE.nml [--parameter initial_stress]
        [--quantity storey_drift_max] [--records fema:far_field] [--steps 100] [--median-steps 20]

A record is sensitive when the relative change of its result per relative change of the parameter
exceeds 10. The linear prediction must err by at most 10 % of the change at random steps within
`valid_within`: `--steps` of random records, and `--median-steps` of the median.
"""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt
import rwmf
import xarray as xr

Array = npt.NDArray[np.float64]
SENSITIVE, ALLOWED = 10.0, 0.1
# change of a result, relative, that belongs to the integration
UNSEEN = 1e-7
STEPS = (1e-5, 1e-3)


def _share(changes: Array, predicted: Array, value: Array) -> str:
    """Return how many predictions err by at most 10 % of the change."""
    wrong = abs(changes - predicted)
    good = wrong <= ALLOWED * np.minimum(abs(changes), abs(predicted)) + UNSEEN * abs(value)
    return f"{good.sum()} of {good.size}"


def _try_records(
    case: rwmf.Case, found: xr.Dataset, options: argparse.Namespace, dice: np.random.Generator
) -> str:
    """Try random steps of random records, each within its range."""
    ranges = found["valid_within"].values
    rows = dice.choice(np.flatnonzero(ranges > 0), options.steps)
    steps = ranges[rows] * dice.uniform(-1, 1, options.steps)
    centre = found["parameter_value"].values.max()
    # a point names its record, so that only the drawn pairs run
    names = found["record"].values[rows].tolist()
    table = {options.parameter: centre * (1 + steps), "record": names, "rtol": [1e-9] * len(rows)}
    runs = rwmf.sweep(case, None, options.records, points=table, quantities=(options.quantity,))
    values = found["value"].values[rows]
    predicted = found["derivative"].values[rows] * centre * steps
    return _share(runs[options.quantity].values.ravel() - values, predicted, values)


def _try_median(
    case: rwmf.Case, found: xr.Dataset, options: argparse.Namespace, dice: np.random.Generator
) -> str:
    """Try random steps of the suite within the range of the median."""
    steps = found["valid_within"].item() * dice.uniform(-1, 1, options.median_steps)
    centre = found["parameter_value"].item()
    table = {options.parameter: centre * (1 + steps), "rtol": np.full(steps.size, 1e-9)}
    runs = rwmf.sweep(case, None, options.records, points=table, quantities=(options.quantity,))
    medians = np.median(runs[options.quantity].values.reshape(-1, steps.size), axis=0)
    value = found["value"].item()
    return _share(medians - value, found["derivative"].item() * centre * steps, np.array(value))


def _print_records(case: rwmf.Case, options: argparse.Namespace, dice: np.random.Generator) -> None:
    """Print the slopes of the records and their ranges."""
    alone = rwmf.gradient(
        case, options.parameter, options.quantity, records=options.records
    ).squeeze()
    slopes = abs(alone["derivative"] * alone["parameter_value"] / alone["value"]).values
    ranges = 100 * alone["valid_within"].values
    print(f"records: {slopes.size}, relative slope above {SENSITIVE:g}: "
          f"{int((slopes > SENSITIVE).sum())}, largest {np.nanmax(slopes):.6g}, "
          f"kinks {int(alone['is_kink'].sum())}")  # fmt: skip
    print(f"valid within: median {np.median(ranges):.2g} %, smallest {ranges.min():.2g} %")
    print(f"predicted within 10 % at random steps of records: "
          f"{_try_records(case, alone, options, dice)}")  # fmt: skip


def main() -> None:
    """Print the numbers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("case", help="namelist")
    parser.add_argument("--parameter", default="initial_stress")
    parser.add_argument("--quantity", default="storey_drift_max")
    parser.add_argument("--records", nargs="+", default=["fema:far_field"])
    parser.add_argument("--steps", type=int, default=100, help="of single records; 0 for none")
    parser.add_argument("--median-steps", type=int, default=20)
    options = parser.parse_args()
    case = rwmf.Case.from_namelist(options.case)
    dice = np.random.default_rng(1940)
    request = (options.parameter, options.quantity)
    middle = rwmf.gradient(case, *request, records=options.records, statistic=0.5).squeeze()
    relative = middle["parameter_value"].item() / middle["value"].item()
    print(f"median of {options.quantity}: {middle['value'].item():.6g}")
    print(
        f"relative slope {middle['derivative'].item() * relative:.4f}, "
        f"bootstrap error {middle['bootstrap_error'].item() * relative:.2g}, "
        f"valid within {100 * middle['valid_within'].item():.2g} %"
    )
    for step in STEPS:
        print(f"   by relative steps of {step:g}: {_slope(case, middle, options, step):.4f}")
    if options.median_steps:
        good = _try_median(case, middle, options, dice)
        print(f"predicted within 10 % at random steps of the median: {good}")
    if options.steps:
        _print_records(case, options, dice)


def _slope(case: rwmf.Case, found: xr.Dataset, options: argparse.Namespace, step: float) -> float:
    """Return the relative slope of the median by one central difference."""
    centre = found["parameter_value"].item()
    table = {options.parameter: [centre * (1 - step), centre * (1 + step)], "rtol": [1e-9] * 2}
    runs = rwmf.sweep(case, None, options.records, points=table, quantities=(options.quantity,))
    low, high = np.median(runs[options.quantity].values.reshape(-1, 2), axis=0)
    return float((high - low) / (2 * step) / found["value"].item())


if __name__ == "__main__":
    main()
