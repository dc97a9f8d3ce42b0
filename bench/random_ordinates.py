"""Spectra of random scenes with any effects: number of ordinates with errors above rtol.

    .venv/bin/python bench/random_ordinates.py [--count 5000] [--first 0] [--periods 10]
                                               [--rtol 1e-7] [--processes 2]

The scenes are the numbered ones of tests/support/combinations.py. They have wall, frame or storeys,
cable, link, dampers, fuses, inerters, vertical motion, tables of e, pulses and records. Each is a
spectrum by `method = 'auto'` over periods drawn from 0.1 to 3 s, in lanes. An ordinate is wrong
when its error exceeds rtol times the larger of 1 and its sensitivity to the motion. Errors are
relative to single runs by `taylor` at rtol 1e-13, which uses other steps and another event
search than the lanes. Every wrong ordinate is listed.
"""

from __future__ import annotations

import argparse
import math
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import rwmf

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from combinations import combination

TRUSTED = {"method": "taylor", "rtol": 1e-13}
SECOND = {"method": "dop853", "rtol": 1e-13}  # where chatter exhausts the first
SENSITIVITY = {"method": "dop853", "rtol": 1e-9, "verify": True}
NOTHING = 1e-12  # m
MOST_ABOVE = 1e-3  # share of ordinates
FARTHEST = 10.0


class Ordinate(NamedTuple):
    """One ordinate beside its truth.

    Attributes
    ----------
    number : int
        Of the scene.
    T_s : float
        Period [s].
    error : float
        Relative error of the peak over rtol and sensitivity, both of which are 1 at least.
    sensitivity : float
        Relative change of the peak per relative change of the motion; 1 where it is unknown.
    note : str
        Reason why the ordinate has no value: its ending, in the spectrum and in the reference.
    """

    number: int
    T_s: float
    error: float = 0.0
    sensitivity: float = 1.0
    note: str = ""


def check_scene(number: int, n_periods: int, rtol: float) -> list[Ordinate]:
    """Compare the spectrum of a scene with single runs.

    Parameters
    ----------
    number : int
        Of the scene.
    n_periods : int
        Number of ordinates.
    rtol : float
        Relative tolerance of the spectrum.

    Returns
    -------
    list of Ordinate
        Empty for a scene without frame, or one whose storeys give the period.
    """
    dice = random.Random(f"periods {number}")
    periods = sorted(0.1 * 30.0 ** dice.random() for _ in range(n_periods))
    made = combination(number)
    if "T_s" not in made.groups.get("frame", {}):
        return []
    with tempfile.TemporaryDirectory() as folder:
        case = made.build(Path(folder))
        spectrum = rwmf.spectrum(case.replace(solver={"rtol": rtol}), T_s=periods, threads=1)
        peaks = np.asarray(spectrum.u_s_max).ravel()
        states = np.asarray(spectrum.status).ravel()
        return [
            _compare(case, number, T_s, float(peak), str(state), rtol)
            for T_s, peak, state in zip(periods, peaks, states, strict=True)
        ]


def _scalars(case: rwmf.Case) -> dict[str, Any]:
    """Run a case and return its results without time axis, by name."""
    result = rwmf.simulate(case)
    return dict(result.attrs) | {
        str(name): value.item() for name, value in result.data_vars.items() if not value.dims
    }


def _compare(
    case: rwmf.Case, number: int, T_s: float, peak: float, state: str, rtol: float
) -> Ordinate:
    """Compare one ordinate with its truth."""
    here = case.replace(frame={"T_s": T_s})
    try:
        truth = _scalars(here.replace(solver=TRUSTED))
    except rwmf.NumericalError:
        try:
            truth = _scalars(here.replace(solver=SECOND))
        except rwmf.NumericalError as error:
            return Ordinate(number, T_s, note=f"{state}; truth: {str(error).split(' by t')[0]}")
    end = "overturned" if truth.get("overturned", False) else "ok"
    if state != end:
        return Ordinate(number, T_s, math.inf, note=f"{state}; truth: {end}")
    true_peak = float(truth["u_s_max"])
    error = abs(peak - true_peak) / max(true_peak, NOTHING) / rtol
    if not error > 1:
        return Ordinate(number, T_s, error)
    scalars = _scalars(here.replace(solver=SENSITIVITY))
    sensitivity = max(1.0, float(scalars.get("sensitivity", 1.0)))
    return Ordinate(number, T_s, error / sensitivity, sensitivity)


def _all_scenes(arguments: argparse.Namespace) -> Iterator[list[Ordinate]]:
    numbers = range(arguments.first, arguments.first + arguments.count)
    check = partial(check_scene, n_periods=arguments.periods, rtol=arguments.rtol)
    with ProcessPoolExecutor(arguments.processes) as pool:
        yield from pool.map(check, numbers, chunksize=8)


def main() -> int:
    """Print the shares; the exit status is 1 when more are too wrong than may be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=5000, help="number of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--periods", type=int, default=10, help="ordinates of each")
    parser.add_argument("--rtol", type=float, default=1e-7)
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    ordinates = [ordinate for scene in _all_scenes(arguments) for ordinate in scene]
    numbers = [ordinate for ordinate in ordinates if ordinate.note == ""]
    wrong = [ordinate for ordinate in ordinates if ordinate.error > 1]
    errors = np.array([ordinate.error for ordinate in numbers])
    print(f"{len(ordinates)} ordinates of {len({o.number for o in ordinates})} scenes")
    for share in (0.5, 0.9, 0.99, 0.999, 1.0):
        print(f"   {share:6.1%} have an error up to {np.quantile(errors, share):.2g} of the bound")
    for note, count in Counter(o.note for o in ordinates if o.note and o.error <= 1).items():
        print(f"   {count} not compared: {note}")
    print(f"{len(wrong)} above the bound:")
    for ordinate in sorted(wrong, key=lambda o: -o.error):
        print(
            f"   scene {ordinate.number}, T_s = {ordinate.T_s!r}: {ordinate.error:.3g} times,"
            f" sensitivity {ordinate.sensitivity:.3g} {ordinate.note}"
        )
    fails = len(wrong) > MOST_ABOVE * len(ordinates) or any(o.error > FARTHEST for o in wrong)
    return 1 if fails else 0


if __name__ == "__main__":
    sys.exit(main())
