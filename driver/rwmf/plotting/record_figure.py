"""Figures of ground motions: histories, spectra, spectra of a suite with its target."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rwmf.plotting.style import ALONE, COLOURS, GREY, label_plainly, legend_below, plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_records", "draw_selection"]

_THIN = 1.0
_Array = npt.NDArray[np.float64]
_HISTORIES = {
    "a": r"$\ddot u_g$ (g)",
    "v": r"$\dot u_g$ (m/s)",
    "u": r"$u_g$ (m)",
}


def draw_records(figure: Figure, records: Mapping[str, Mapping[str, _Array]]) -> None:
    """Draw acceleration, velocity, displacement, spectrum and build-up of energy."""
    parts: Any = figure.subfigures(1, 2, width_ratios=[1.5, 1.0])
    left, right = parts
    panels = dict(zip(_HISTORIES, left.subplots(3, 1, sharex=True), strict=True))
    spectrum, energy = right.subplots(2, 1, height_ratios=[1.8, 1.0])
    for i, (name, curves) in enumerate(records.items()):
        look = {"color": COLOURS[i % len(COLOURS)], "lw": _THIN}
        for key, ax in panels.items():
            ax.plot(curves["t"], curves[key], **look)
        energy.plot(curves["t"], curves["energy"], **look)
        spectrum.loglog(curves["periods"], curves["Sa"], label=plain(name), **look)
    for key, label in _HISTORIES.items():
        panels[key].set_ylabel(label)
    panels["u"].set_xlabel("time $t$ (s)")
    energy.set(xlabel="time $t$ (s)", ylabel="Arias share")
    spectrum.set(xlabel="period $T$ (s)", ylabel="$S_a$(5 %) (g)")
    for axis in (spectrum.xaxis, spectrum.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    legend_below(figure, spectrum)


def draw_selection(
    figure: Figure, periods: _Array, target: _Array, spectra: _Array, label: str
) -> None:
    """Draw the scaled spectra of a suite, their geometric mean and the target."""
    ax = figure.subplots()
    for i, spectrum in enumerate(spectra):
        ax.loglog(periods, spectrum, color=GREY, lw=0.8, label="components" if i == 0 else None)
    mean = np.exp(np.log(spectra).mean(axis=0))
    ax.loglog(periods, mean, color=COLOURS[0], lw=2.0, label="geometric mean")
    ax.loglog(periods, target, **ALONE, label="target")
    ax.set(xlabel="period $T$ (s)", ylabel=label)
    label_plainly(ax.xaxis)
    label_plainly(ax.yaxis)
    ax.legend()
