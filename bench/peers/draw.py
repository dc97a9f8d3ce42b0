"""Figure of the comparison: error against cost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rwmf._cost import METHODS
from rwmf.plotting import image_files as figures
from rwmf.plotting.style import COLOURS, MARKERS, legend_below, new_figure

from peers.measure import Row
from peers.problem import GAMMAS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# errors below are those of the truth
FLOOR = 1e-13


def spectra(rows: Sequence[Row], tolerances: Sequence[Row], path: Path) -> None:
    """Draw everything into a file."""
    with new_figure(6.4) as figure:
        panels = figure.subplots(len(GAMMAS), 1)
        for ax, gamma in zip(panels, GAMMAS, strict=True):
            _work_precision(ax, rows, tolerances, gamma)
        legend_below(figure, panels[0], columns=3)
        figures.save(figure, path)


def _work_precision(
    axes: Axes, rows: Sequence[Row], tolerances: Sequence[Row], gamma: float
) -> None:
    """Draw error against cost at one mass ratio."""
    ours = [row for row in tolerances if row.gamma == gamma]
    axes.loglog(
        [1e6 * row.seconds for row in ours], [max(row.error, FLOOR) for row in ours], "-",
        color=COLOURS[0], zorder=1, label=f"auto, rtol {ours[0].rtol:.0e} to {ours[-1].rtol:.0e}",
    )  # fmt: skip
    names = list(dict.fromkeys(row.program for row in rows))
    for number, name in enumerate(names):
        found = [row for row in rows if row.program == name and row.gamma == gamma]
        axes.loglog(
            [1e6 * row.seconds for row in found], [max(row.error, FLOOR) for row in found],
            MARKERS[number % len(MARKERS)], color=COLOURS[number % len(COLOURS)], label=name,
            fillstyle="full" if name in ("auto", *METHODS) else "none",
        )  # fmt: skip
    axes.set_title(f"γ = {gamma:g}; filled: methods of the kernel, open: other programs")
    axes.set_xlabel("µs an ordinate")
    axes.set_ylabel("largest relative error")
