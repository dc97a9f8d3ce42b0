"""The figure of the comparison: error against cost, and what the cost depends on."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rwmf._cost import METHODS

from peers.measure import Row
from peers.problem import GAMMAS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito's colours; the kernel's own methods are filled, peers open
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
# errors below are those of the truth
FLOOR = 1e-13


def spectra(rows: Sequence[Row], dependence: dict[str, Any], path: Path) -> None:
    """Draw everything into a file.

    Parameters
    ----------
    rows : sequence of Row
        All programs.
    dependence : dict
        'tolerances' (rows of `fast`), and lists of points of 'ordinates', 'seconds of motion' and
        'threads'.
    path : Path
        File to write.
    """
    from rwmf.plotting import files as figures

    with figures.new_figure(9.6, 8.0) as figure:
        grid = figure.add_gridspec(3, 3, height_ratios=(1.3, 1.3, 1.0))
        for i, gamma in enumerate(GAMMAS):
            axes = figure.add_subplot(grid[i, :])
            _work_precision(axes, rows, dependence["tolerances"], gamma)
        for i, what in enumerate(("ordinates", "seconds of motion", "threads")):
            axes = figure.add_subplot(grid[2, i])
            x, y = np.array(dependence[what]).T
            axes.loglog(x, 1e6 * y, "o-", color=COLOURS[0])
            axes.set_xlabel(what)
            axes.set_ylabel("fast: µs an ordinate")
            axes.set_ylim(bottom=0.5e6 * y.min(), top=2e6 * y.max())
            if what == "threads":
                axes.set_xticks(x, [f"{count:g}" for count in x])
                axes.minorticks_off()
        figures.save(figure, path)


def _work_precision(
    axes: Axes, rows: Sequence[Row], tolerances: Sequence[Row], gamma: float
) -> None:
    """Draw error against cost at one mass ratio."""
    ours = [row for row in tolerances if row.gamma == gamma]
    axes.loglog(
        [1e6 * row.seconds for row in ours], [max(row.error, FLOOR) for row in ours], "-",
        color=COLOURS[0], zorder=1,
    )  # fmt: skip
    names = list(dict.fromkeys(row.program for row in rows))
    for number, name in enumerate(names):
        found = [row for row in rows if row.program == name and row.gamma == gamma]
        axes.loglog(
            [1e6 * row.seconds for row in found], [max(row.error, FLOOR) for row in found],
            MARKERS[number % len(MARKERS)], color=COLOURS[number % len(COLOURS)], label=name,
            fillstyle="full" if name in ("fast", *METHODS) else "none",
        )  # fmt: skip
    axes.set_xlabel(f"µs an ordinate, γ = {gamma:g}")
    axes.set_ylabel("largest relative error")
    if gamma == GAMMAS[0]:
        axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small")
