"""Style of all figures: colours, lines, sizes, legends, panels.

Lines differ in colour and in a second property (dashes, width, markers), for grey print and for
colour-blind readers. All figures have the same width and no text below 9 pt, so that text stays
readable at the width of a page.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.run.quantities import AXES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.typing import RcKeyType


# axes of the panels of a figure
Panels = np.ndarray[tuple[int], np.dtype[np.object_]]
# width of every figure [inch]
WIDTH = 7.4
# colours of Okabe and Ito, distinct for all types of colour vision; yellow is too light for a line
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7", "#56b4e9")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
INK, GREY, FAINT, PALE, PAPER = "black", "0.4", "0.65", "0.9", "white"
_STYLE = Path(__file__).with_name("rwmf.mplstyle")
# dashes: lines drawn later have wider gaps, which show the lines below
_DASHES = ("-", (0, (5, 1.5)), (0, (6, 3, 1.5, 3)), (0, (3, 2)), (0, (7, 6)), (0, (2, 3)))
_WIDEST, _NARROWEST, _STEP, _SINGLE = 3.0, 1.1, 0.6, 1.4
# spacing in a legend with many names, in letters
_TIGHT: dict[str, Any] = {
    "handlelength": 1.5,
    "handletextpad": 0.5,
    "columnspacing": 0.9,
    "labelspacing": 0.3,
}
# fraction of the ramp that is dark enough for a line
_LIGHTEST = 0.88
# note under a figure with coinciding lines
NESTED = "lines that coincide lie one inside the other, narrow in wide"
# reference response, drawn above the others so that it is visible where they coincide
ALONE: dict[str, Any] = {"color": INK, "linestyle": (0, (1, 2)), "linewidth": 1.3, "zorder": 6}
# level such as 0 or 1 behind the lines
LEVEL: dict[str, Any] = {"color": FAINT, "linestyle": "-", "linewidth": 0.8, "zorder": 1}
# levels of first yield and of collapse
YIELD: dict[str, Any] = {"color": FAINT, "linestyle": (0, (6, 2)), "linewidth": 0.9, "zorder": 1}
LIMIT: dict[str, Any] = YIELD | {"color": COLOURS[1], "linestyle": (0, (1, 1.5))}
# results of other programs, or observations
DOTS: dict[str, Any] = {
    "color": INK,
    "linestyle": "none",
    "marker": MARKERS[0],
    "markersize": 2.6,
    "zorder": 5,
}

# unit of data: the factor to the unit of a label, and that unit
_LARGE_UNITS = {"N": (1e3, "kN"), "N m": (1e3, "kN m"), "Pa": (1e6, "MPa")}


def style() -> dict[RcKeyType, Any]:
    """Return settings for figures of publication size, for ``matplotlib.rc_context``.

    Returns
    -------
    dict
        Names and values of matplotlib's settings.
    """
    import matplotlib
    from cycler import cycler

    own = matplotlib.rc_params_from_file(_STYLE, use_default_template=False)
    return {**own, "axes.prop_cycle": cycler(color=COLOURS)}


@contextmanager
def new_figure(height: float) -> Iterator[Figure]:
    """Make a figure in the package's style, without a screen."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(style()):
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure


def series(i: int, n: int) -> dict[str, Any]:
    """Return the style of one of several lines: colour, dashes and width."""
    step = min(_STEP, (_WIDEST - _NARROWEST) / max(n - 1, 1))
    width = _SINGLE if n < 2 else _NARROWEST + step * (n - 1 - i)
    return {
        "color": COLOURS[i] if n <= len(COLOURS) else _ramp(i / (n - 1)),
        "linestyle": _DASHES[i % len(_DASHES)],
        "linewidth": width,
        "zorder": 2 + i / max(n, 1),
    }


def storey(i: int, n: int) -> dict[str, Any]:
    """Return the style for a floor or storey: dark at the ground, light at the roof."""
    if n < 2:
        return series(i, n)
    return {"color": _ramp(i / (n - 1)), "linewidth": 1.1 if n <= len(COLOURS) else 0.8}


def _ramp(share: float) -> str:
    """Return the colour of one of many lines, from dark to light."""
    import matplotlib
    from matplotlib.colors import to_hex

    return to_hex(matplotlib.colormaps["viridis"](_LIGHTEST * share))


def tint(colour: str, strength: float) -> tuple[float, float, float]:
    """Mix a colour with white; unlike transparent areas, adjacent ones show no seam."""
    from matplotlib.colors import to_rgb

    red, green, blue = (1 - strength * (1 - part) for part in to_rgb(colour))
    return red, green, blue


@checked
def make_panels(
    axes: Axes | Sequence[Axes] | np.ndarray | None, n: int, across: bool = False
) -> Panels:
    """Return the given axes, or those of a new figure, as an array.

    Parameters
    ----------
    axes : matplotlib axes or sequence of axes, optional
        One per panel.
    n : int
        Number of panels.
    across : bool
        Side by side with separate axes; otherwise above each other with a shared axis.

    Returns
    -------
    numpy.ndarray, shape (n,)
        The axes.

    Raises
    ------
    InputError
        When the numbers of axes and panels differ.
    """
    if axes is None:
        import matplotlib.pyplot as plt

        height = 3.0 if across else 3.6 if n == 1 else 0.8 + 1.5 * n
        rows, columns = (1, n) if across else (n, 1)
        with plt.rc_context(style()):
            _, axes = plt.subplots(
                rows, columns, sharex=not across, figsize=(WIDTH, height), layout="constrained"
            )
    panels = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if panels.size != n:
        raise InputError(f"{panels.size} axes for {n} panels: there must be as many")
    return panels


def label_plainly(axis: Axis) -> None:
    """Label a logarithmic axis of one or two decades with plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis.set_major_locator(LogLocator(subs=(1, 2, 3, 5)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def label_in_large_units(axis: Axis, unit: str) -> str:
    """Label the axis of a force in kN and that of a stress in MPa; its data stay in N and Pa."""
    from matplotlib.ticker import FuncFormatter

    if unit not in _LARGE_UNITS:
        return unit
    factor, shown = _LARGE_UNITS[unit]
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value / factor:g}"))
    return shown


def plain(text: object) -> str:
    """Return a text without formulas: matplotlib reads text between dollar signs as formulas."""
    return str(text).replace("$", r"\$")


def period_label(period: xr.DataArray) -> str:
    """Return the label of a period axis, with its definition unless it is a single frame's."""
    meaning = plain(period.attrs.get("long_name", AXES["T_s"].meaning))
    if meaning == AXES["T_s"].meaning:
        return "period $T_s$ (s)"
    return meaning.replace("2 pi/p", r"$2\pi/p$") + " (s)"


def legend_beside(
    ax: Axes, title: str | None = None, columns: int = 1, *, is_tight: bool = False
) -> None:
    """Put the legend to the right of the axes, outside the data."""
    words = {"title": title, "ncols": columns} | (_TIGHT if is_tight else {})
    ax.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), **words)


def legend_above(ax: Axes, columns: int, *, is_tight: bool = False) -> None:
    """Put the legend above the axes, outside the data."""
    words = {"ncols": columns, "borderpad": 0.2} | (_TIGHT if is_tight else {})
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), **words)


def legend_below(figure: Figure, axes: Axes, columns: int = 4, title: str | None = None) -> None:
    """Put the legend of one of the axes below all of them, outside the data."""
    handles, labels = axes.get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    figure.legend(
        list(unique.values()), list(unique), loc="outside lower center", ncols=columns, title=title
    )
