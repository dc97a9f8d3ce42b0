"""History of a wall from the output of CalculiX."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import numpy.typing as npt
from deck import Deck

__all__ = ["Array", "read_history", "slip"]

Array = npt.NDArray[np.float64]
_HEAD = re.compile(r"\s*(displacements|velocities).*time\s+(\S+)")


def read_history(path: Path, deck: Deck) -> Array:
    """Read the rotation of the base, the uplifts of its corners and the displacements."""
    rows: dict[float, dict[tuple[str, int], list[float]]] = {}
    kind, t = "", 0.0
    for line in path.read_text(encoding="utf-8").splitlines():
        if match := _HEAD.match(line):
            # the static step before the motion took one second
            kind, t = match[1], float(match[2]) - 1.0
        elif kind and line.split() and line.split()[0].isdigit():
            number, *values = line.split()
            rows.setdefault(t, {})[kind, int(number)] = [float(x) for x in values]
    if not rows:
        return np.empty((0, 7))
    found = np.array([_row(t, row, deck) for t, row in sorted(rows.items())])
    interval = deck.settings.stored_interval
    times = interval * np.arange(1, int(found[-1, 0] / interval + 1e-6) + 1)
    columns = [np.interp(times, found[:, 0], column) for column in found.T[1:]]
    return np.column_stack([times, *columns])


def _row(t: float, row: dict[tuple[str, int], list[float]], deck: Deck) -> list[float]:
    left, right = int(deck.wall[0, 0, 0]), int(deck.wall[-1, 0, 0])
    u_l, u_r = row["displacements", left], row["displacements", right]
    v_l, v_r = row["velocities", left], row["velocities", right]
    across, up = 2 * deck.b + u_r[0] - u_l[0], u_l[2] - u_r[2]
    rate = (v_l[2] - v_r[2]) * across - up * (v_r[0] - v_l[0])
    theta = float(np.arctan2(up, across))
    u_s = row["displacements", deck.mass][0]
    down = u_r[0] if theta > 0 else u_l[0]
    return [t, theta, rate / (across**2 + up**2), u_l[2], u_r[2], u_s, down]


def slip(rows: Array) -> float:
    """Range of the place of the corner that is down, where the wall is clearly lifted [m]."""
    lifted = rows[np.abs(rows[:, 1]) > 1e-4, 6]
    return float(np.ptp(lifted)) if lifted.size else 0.0
