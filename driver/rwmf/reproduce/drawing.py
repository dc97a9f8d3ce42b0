"""What the reproduced figures share: colours, names, legends below the panels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rwmf.reproduce.forms import EXACT, PUBLISHED, Form

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
ALONE = {"color": "black", "linestyle": (0, (1, 2)), "linewidth": 1.3, "zorder": 6}
# distinct in colour for every kind of vision, and from dark to light in grey
_MASS_RATIOS = {
    5.0: "#440154",
    10.0: "#d55e00",
    100.0: "#0072b2",
    1000.0: "#009e73",
    2000.0: "#cc79a7",
    20000.0: "#e69f00",
}
ENGINE = {"color": "black", "linestyle": "none", "marker": "o", "markersize": 2.2, "zorder": 5}
OVER_TIME = r"$t$ (s)"


def style_of(form: Form) -> dict[str, object]:
    """Return the arguments of ``Axes.plot`` for a form, with its label."""
    return {**_LINES[form.key], "label": form.label}


def shades(n: int) -> list[tuple[float, float, float, float]]:
    """Return n colours from dark to light, ordered in grey as well."""
    import matplotlib

    viridis = matplotlib.colormaps["viridis"]
    return [viridis(float(x)) for x in np.linspace(0.0, 0.82, max(n, 2))][:n]


def style_of_mass_ratio(gamma: float) -> dict[str, object]:
    """Return colour and label of a mass ratio: the same one in every figure."""
    return {"color": _MASS_RATIOS[gamma], "label": rf"$\gamma$ = {gamma:g}", "linewidth": 1.2}


def row_label(ax: Axes, text: str) -> None:
    """Write what a row of panels shows at the right of its last panel."""
    ax.text(1.03, 0.5, text, transform=ax.transAxes, rotation=270, va="center", ha="left")


def legend_below(figure: Figure, axes: Axes, columns: int = 4, title: str | None = None) -> None:
    """Put the legend of one of the axes below all of them, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(
        list(unique.values()), list(unique), loc="outside lower center", ncols=columns, title=title
    )


def column_title(ax: Axes, letter: str, text: str) -> None:
    """Write the paper's letter of a panel and what it shows."""
    ax.set_title(f"({letter}) {text}")
