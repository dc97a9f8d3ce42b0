"""Measure whether spectra keep their tolerance, under motions that are much too strong as well.

    .venv/bin/python bench/spectrum_errors.py

El Centro times 1 to 8, the wall of the paper in two widths, three formulations, 76 periods, mass
ratios from 5 to 1800. An ordinate is too wrong when its error exceeds rtol times its sensitivity to
the motion, if that is more than 1. Errors are those against `dop853` at 1e-12; the run takes some
three minutes.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
from peers.problem import case, read_record

RECORD = Path(__file__).resolve().parent.parent / "inputs" / "records" / "elcentro.csv"
FORMULATIONS = ("symmetric", "exact", "published")
WIDTHS = (0.5, 1.0)
SCALES = (1.0, 2.0, 4.0, 8.0)
GAMMAS = (5.0, 6.0, 10.0, 25.0, 60.0, 150.0, 230.0, 500.0, 1800.0)
RTOLS = (1e-7, 1e-8)
PERIODS = np.concatenate([np.linspace(0.05, 0.5, 46), np.linspace(0.55, 3.0, 30)])
NUDGE = 1e-6

Array = npt.NDArray[np.float64]


def _scene(formulation: str, b: float, gamma: float) -> rwmf.Case:
    """State a scene, but for the scale of the motion."""
    return case(read_record(RECORD), "auto", RTOLS[0]).replace(
        wall={"b": b}, frame={"gamma": gamma}, model={"formulation": formulation}
    )


def _peaks(scene: rwmf.Case, scale: float, method: str, rtol: float) -> Array:
    """Peaks of all periods [m]."""
    requested = scene.replace(motion={"scale": scale}, solver={"method": method, "rtol": rtol})
    return rwmf.spectrum(requested, T_s=PERIODS, threads=1).u_s_max.values.ravel()


def _worst(scene: rwmf.Case, scale: float, truth: Array, rtol: float) -> list[tuple[float, float]]:
    """Return periods [s] with errors above the allowed one, and the ratios."""
    error = np.abs(_peaks(scene, scale, "auto", rtol) / truth - 1)
    if not np.any(error > rtol):
        return []
    nudged = _peaks(scene, scale * (1 + NUDGE), "dop853", 1e-12)
    allowed = rtol * np.maximum(1.0, np.abs(nudged / truth - 1) / NUDGE)
    return [
        (float(T_s), float(part))
        for T_s, part in zip(PERIODS, error / allowed, strict=True)
        if part > 1
    ]


def main() -> None:
    """Print the ordinates that are too wrong."""
    computed = found = 0
    for formulation, b, scale, gamma in itertools.product(FORMULATIONS, WIDTHS, SCALES, GAMMAS):
        scene = _scene(formulation, b, gamma)
        truth = _peaks(scene, scale, "dop853", 1e-12)
        for rtol in RTOLS:
            computed += truth.size
            for T_s, part in _worst(scene, scale, truth, rtol):
                found += 1
                print(
                    f"{formulation}, b = {b:g} m, motion times {scale:g}, gamma = {gamma:g}, "
                    f"rtol = {rtol:.0e}, T_s = {T_s:.3f} s: {part:.2f} times the allowed error"
                )
    print(f"{found} of {computed} ordinates exceed the allowed error.")


if __name__ == "__main__":
    main()
