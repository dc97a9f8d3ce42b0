"""Figures of the comparison: error against cost, and dependences of the cost."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import NullLocator
from rwmf._cost import METHODS
from rwmf.plotting import image_files as figures
from rwmf.plotting.style import COLOURS, MARKERS, label_plainly, legend_below, new_figure

from peers.measure import Row
from peers.problem import GAMMAS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# errors below are those of the truth
FLOOR = 1e-13


def spectra(rows: Sequence[Row], dependence: dict[str, Any], path: Path) -> None:
    """Draw everything into a file."""
    with new_figure(8.4) as figure:
        grid = figure.add_gridspec(3, 3, height_ratios=(1.3, 1.3, 1.0))
        precision = [figure.add_subplot(grid[i, :]) for i in range(len(GAMMAS))]
        for ax, gamma in zip(precision, GAMMAS, strict=True):
            _work_precision(ax, rows, dependence["tolerances"], gamma)
        for i, name in enumerate(("ordinates", "seconds of motion", "threads")):
            axes = figure.add_subplot(grid[2, i])
            x, y = np.array(dependence[name]).T
            axes.loglog(x, 1e6 * y, "o-", color=COLOURS[0])
            axes.set_xlabel("seconds of motion (s)" if "seconds" in name else name)
            axes.set_ylabel("" if i else "µs an ordinate")
            axes.set_ylim(bottom=0.5e6 * y.min(), top=2e6 * y.max())
            if name == "threads":
                axes.set_xticks(x, [f"{count:g}" for count in x])
                axes.xaxis.set_minor_locator(NullLocator())
            label_plainly(axes.yaxis)
        legend_below(figure, precision[0], columns=3)
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
