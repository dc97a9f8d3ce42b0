"""One style for every figure, and panels to draw in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import RcKeyType

__all__ = ["make_panels", "style"]


def style() -> dict[RcKeyType, Any]:
    """Return settings for figures of publication size, for ``matplotlib.rc_context``.

    Returns
    -------
    dict
        Names and values of matplotlib's settings.
    """
    return {
        "figure.dpi": 110,
        "savefig.dpi": 200,
        "font.size": 9,
        "axes.titlesize": 9,
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "grid.color": "0.9",
        "grid.linewidth": 0.6,
        "lines.linewidth": 1.3,
        "legend.frameon": False,
        "svg.hashsalt": "rwmf",
    }


def make_panels(
    axes: Axes | Sequence[Axes] | np.ndarray | None, n: int, across: bool = False
) -> np.ndarray:
    """Return the given axes, or those of a new figure, as an array.

    Parameters
    ----------
    axes : matplotlib axes or sequence of axes, optional
        As many as there are panels.
    n : int
        Number of panels.
    across : bool
        Side by side, each with an axis of its own; otherwise above each other over the same one.

    Returns
    -------
    numpy.ndarray, shape (n,)
        The axes.

    Raises
    ------
    ValueError
        When there are more or fewer axes.
    """
    if axes is None:
        import matplotlib.pyplot as plt

        size = (6.4, 3.4) if n == 1 else (6.4, 0.6 + 1.5 * n)
        rows, columns = (1, n) if across else (n, 1)
        if across:
            size = (3.2 * n, 3.0)
        with plt.rc_context(style()):
            _, axes = plt.subplots(
                rows, columns, sharex=not across, figsize=size, layout="constrained"
            )
    panels = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if panels.size != n:
        raise ValueError(f"{panels.size} axes for {n} panels: there must be as many")
    return panels
