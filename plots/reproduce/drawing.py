"""What the reproduced figures share: colours, names, legends below the panels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from reproduce.formulations import EXACT, PUBLISHED, Formulation

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = [
    "ALONE",
    "ENGINE",
    "OVER_TIME",
    "column_title",
    "legend_below",
    "row_label",
    "shades",
    "style_of",
    "style_of_mass_ratio",
]

# blue and vermilion differ for every kind of colour vision; dashes tell them apart in print
_LINES = {
    EXACT.key: {"color": "#0072b2", "linestyle": "-", "linewidth": 1.3, "zorder": 3},
    PUBLISHED.key: {"color": "#d55e00", "linestyle": (0, (4, 1.5)), "linewidth": 1.2, "zorder": 4},
}
# above the lines: where the wall changes nothing, both must show
ALONE: dict[str, Any] = {"color": "black", "linestyle": (0, (1, 2)), "linewidth": 1.3, "zorder": 6}
# distinct in colour for every kind of vision; the light walls, whose lines coincide, one inside the
# other: colour and width
_MASS_RATIOS = {
    5.0: ("#440154", 1.2),
    10.0: ("#d55e00", 1.2),
    100.0: ("#0072b2", 1.2),
    1000.0: ("#009e73", 3.4),
    2000.0: ("#cc79a7", 2.2),
    20000.0: ("#e69f00", 1.2),
}
ENGINE: dict[str, Any] = {
    "color": "black",
    "linestyle": "none",
    "marker": "o",
    "markersize": 2.2,
    "zorder": 5,
}
OVER_TIME = r"$t$ (s)"


def style_of(form: Formulation) -> dict[str, Any]:
    """Return the arguments of ``Axes.plot`` for a form, with its label.

    Parameters
    ----------
    form : Formulation
        Formulation and restitution.

    Returns
    -------
    dict
        The arguments.
    """
    return {**_LINES[form.key], "label": form.label}


def shades(n: int) -> list[tuple[float, float, float, float]]:
    """Return n colours from dark to light, ordered in grey as well.

    Parameters
    ----------
    n : int
        How many.

    Returns
    -------
    list of tuple of float
        Red, green, blue and opacity [-].
    """
    import matplotlib

    viridis = matplotlib.colormaps["viridis"]
    return [viridis(float(x)) for x in np.linspace(0.0, 0.82, max(n, 2))][:n]


def style_of_mass_ratio(gamma: float) -> dict[str, Any]:
    """Return colour, width and label of a mass ratio: the same in every figure.

    Parameters
    ----------
    gamma : float
        Mass ratio [-].

    Returns
    -------
    dict
        Arguments of ``Axes.plot``.
    """
    colour, width = _MASS_RATIOS[gamma]
    label = rf"$\gamma$ = {gamma:g}"
    # wide lines below narrow ones
    return {"color": colour, "label": label, "linewidth": width, "zorder": 3 - width / 10}


def row_label(ax: Axes, text: str) -> None:
    """Write what a row of panels shows at the right of its last panel.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        The last panel.
    text : str
        What the row shows.
    """
    ax.text(1.03, 0.5, text, transform=ax.transAxes, rotation=270, va="center", ha="left")


def legend_below(figure: Figure, axes: Axes, columns: int = 4, title: str | None = None) -> None:
    """Put the legend of one of the axes below all of them, where it hides nothing.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The figure.
    axes : matplotlib.axes.Axes
        Whose lines are named.
    columns : int
        Columns of the legend.
    title : str, optional
        Its title.
    """
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(
        list(unique.values()), list(unique), loc="outside lower center", ncols=columns, title=title
    )


def column_title(ax: Axes, letter: str, text: str) -> None:
    """Write the paper's letter of a panel, where it has one, and what it shows.

    Parameters
    ----------
    ax : matplotlib.axes.Axes
        The panel.
    letter : str
        Its letter, or ''.
    text : str
        What it shows.
    """
    ax.set_title(f"({letter}) {text}" if letter else text)
