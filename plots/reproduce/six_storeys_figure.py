"""Largest drifts and accelerations of a frame of six storeys over its height."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rwmf.case import Case
from rwmf.plotting.style import DOTS, legend_below, series

from reproduce import drawing
from reproduce.response_cache import ResponseCache
from reproduce.six_storeys import CASES, VARIANTS, peaks_of, read_peaks, variant

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw"]

_TITLES = ("El Centro, twice as strong", "one-sine pulse of 0.5 g")


def draw(figure: Figure, cache: ResponseCache) -> None:
    """Profiles of both cases with and without yielding and P-Delta, ours and OpenSees'."""
    panels = figure.subplots(2, 2, sharey=True, sharex="row")
    for column, name in enumerate(CASES):
        case = Case.from_namelist(cache.validation / f"{name}.nml")
        engine = read_peaks(cache.validation / "opensees" / f"{name}_peaks.csv")
        for i, words in enumerate(VARIANTS):
            ours = np.split(peaks_of(variant(case, words)), 2)
            theirs = np.split(engine[words], 2)
            storeys = np.arange(1, len(ours[0]) + 1)
            for row, factor in enumerate((100.0, 1.0)):
                ax, line_style = panels[row, column], series(i, len(VARIANTS))
                ax.plot(factor * ours[row], storeys, **line_style, label=words)
                label = "OpenSees" if i + 1 == len(VARIANTS) else None
                ax.plot(factor * theirs[row], storeys, **DOTS, label=label)
        drawing.column_title(panels[0, column], "ab"[column], _TITLES[column])
        panels[0, column].set_xlabel("largest drift of the storey (%)")
        panels[1, column].set_xlabel("largest acceleration of the floor (g)")
    for ax in panels[:, 0]:
        ax.set_ylabel("storey")
    for ax in panels.ravel():
        ax.set_xlim(left=0)
    legend_below(figure, panels[0, 0], columns=3)
