"""Runs of exported scripts, and their demands beside those of rwmf."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from rwmf.case import Case
from rwmf.errors import InputError, NumericalError
from rwmf.run.simulation import simulate

_COMPARED_IMPACTS = 10


@dataclass(frozen=True)
class Demand:
    """A demand of both programs.

    Attributes
    ----------
    name : str
        Key of the demand; of an impact its number and unit.
    ours, theirs : float
        Values of rwmf and of OpenSees.
    """

    name: str
    ours: float
    theirs: float

    @property
    def difference(self) -> float:
        """Relative difference [-]; of an impact that of the times [s]."""
        if self.name.startswith("impact"):
            return self.theirs - self.ours
        return self.theirs / self.ours - 1 if self.ours else self.theirs


def run_opensees(script: str | os.PathLike[str]) -> dict[str, object]:
    """Run an exported script."""
    python = os.environ.get("RWMF_OPENSEES")
    if not python and importlib.util.find_spec("openseespy"):
        python = sys.executable
    if not python:
        raise InputError(
            "no openseespy: install it with `pip install openseespy`, or set the environment "
            "variable RWMF_OPENSEES to a Python that has it"
        )
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        done = subprocess.run(
            [python, os.fspath(script), str(answer)], capture_output=True, text=True, check=False
        )
        if not answer.is_file():
            last = done.stderr.strip().splitlines()
            raise NumericalError(f"{script}: {last[-1] if last else 'OpenSees gives no answer'}")
        found: dict[str, object] = json.loads(answer.read_text(encoding="utf-8"))
        return found


def compare_with_opensees(case: Case, answer: dict[str, object]) -> list[Demand]:
    """Simulate a case, and put its demands beside those of OpenSees."""
    is_bent = case.bending is not None
    response = simulate(case.replace(output={"reactions": True}), dt=1e-4 if is_bent else 1e-3)
    peaks = dict(answer["peaks"])  # type: ignore[call-overload]
    found = [
        Demand(name, float(response[name.removesuffix("_m")]), float(value))
        for name, value in peaks.items()
        if name.removesuffix("_m") in response
    ]
    if case.wall is None:
        return found
    times = _impacts(response["time"].to_numpy(), response["theta"].to_numpy(), is_bent)
    pairs = zip(times, list(answer["impacts"]), strict=False)  # type: ignore[call-overload]
    return found + [
        Demand(f"impact {i} [s]", ours, theirs)
        for i, (ours, theirs) in enumerate(pairs, start=1)
        if i <= _COMPARED_IMPACTS
    ]


def _impacts(t: np.ndarray, theta: np.ndarray, is_bent: bool) -> list[float]:
    """Return times of impacts between excursions above 2 % of the largest [s]."""
    known = np.isfinite(theta)
    t, theta = t[known], theta[known]
    # a wall that bends stays down for a while
    signs = np.sign(theta)
    is_change = signs[1:] != signs[:-1] if is_bent else signs[1:] * signs[:-1] < 0
    places = [0, *(np.flatnonzero(is_change) + 1), theta.size]
    peaks = [np.abs(theta[a:b]).max(initial=0.0) for a, b in pairwise(places)]
    limit, times, landed = 0.02 * max(peaks), [], None
    for i, place in enumerate(places[1:-1]):
        if peaks[i] > limit or (landed is not None and not is_bent):
            landed = _zero(t[: place + 1], theta[: place + 1])
        if landed is not None and peaks[i + 1] > limit:
            times.append(landed)
            landed = None
    return times


def _zero(t: np.ndarray, theta: np.ndarray) -> float:
    """Return the time between the last two samples at which a rotation is zero [s]."""
    # beyond the sample before a rest, its straight line; to the other side, that between
    first, last = (-3, -2) if theta[-1] == 0 else (-2, -1)
    slope = (theta[last] - theta[first]) / (t[last] - t[first])
    return float(t[last] - theta[last] / slope)
