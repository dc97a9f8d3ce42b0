"""The work-precision plot: axes in, axes out. Nothing here simulates."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rwmf.plotting.style import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rwmf._cost import Cost, Row

__all__ = ["work_precision"]

# Okabe and Ito's colours, told apart by colour-blind readers too, with markers for grey print
_LOOKS = {
    "adams": ("#0072B2", "o"),
    "bdf": ("#E69F00", "s"),
    "erk54": ("#009E73", "^"),
    "dop853": ("#D55E00", "D"),
    "extrapolation": ("#CC79A7", "v"),
}
# today's procedures: marker, and whether it is filled (dt) or open (dt/10)
_PRACTICES = {
    "ode45, default": ("*", True),
    "RK4, dt": ("P", True),
    "RK4, dt/10": ("P", False),
    "Newmark, dt": ("X", True),
    "Newmark, dt/10": ("X", False),
}
_PRACTICE_COLOUR = "0.25"
# errors below are round-off and drawn there
_FLOOR = 1e-16


def work_precision(cost: Cost, ax: Axes | None = None, *, legend: bool = True) -> Axes:
    """Draw error against time, one line a method; today's procedures are grey points.

    Parameters
    ----------
    cost : Cost
        From `rwmf.cost`.
    ax : matplotlib axes, optional
        Where to draw; otherwise a new figure.
    legend : bool
        With a legend beside the axes.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. A ring marks the recommended row.
    """
    axes = _new_axes() if ax is None else ax
    for method, (colour, marker) in _LOOKS.items():
        rows = [row for row in cost.rows if row.method == method and _is_drawn(row)]
        axes.plot(
            [row.seconds for row in rows],
            [_height(row) for row in rows],
            color=colour,
            marker=marker,
            markersize=3.5,
            label=method,
        )
    for row in cost.practices:
        if _is_drawn(row):
            _draw_practice(axes, row)
    if cost.recommended is not None:
        _mark_recommended(axes, cost.recommended, cost.target)
    _finish(axes, cost)
    if legend:
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return axes


def _new_axes() -> Axes:
    import matplotlib.pyplot as plt

    with plt.rc_context(style()):
        return plt.subplots(figsize=(6.4, 4.2), layout="constrained")[1]


def _is_drawn(row: Row) -> bool:
    return math.isfinite(row.relative_error) and math.isfinite(row.seconds)


def _height(row: Row) -> float:
    return max(row.relative_error, _FLOOR)


def _draw_practice(axes: Axes, row: Row) -> None:
    marker, filled = _PRACTICES.get(row.method, ("x", True))
    axes.plot(
        [row.seconds],
        [_height(row)],
        marker,
        color=_PRACTICE_COLOUR,
        markerfacecolor=_PRACTICE_COLOUR if filled else "white",
        markersize=6,
        label=row.method,
    )


def _mark_recommended(axes: Axes, row: Row, target: float) -> None:
    axes.plot(
        [row.seconds],
        [_height(row)],
        "o",
        markersize=10,
        markerfacecolor="none",
        markeredgecolor="0.1",
        linestyle="none",
        label=f"cheapest for {_power(target)}",
    )
    axes.axhline(target, color="0.6", linewidth=0.7, linestyle=":", zorder=1)


def _power(value: float) -> str:
    exponent = math.log10(value)
    if math.isclose(exponent, round(exponent), abs_tol=1e-9):
        return f"$10^{{{round(exponent)}}}$"
    return f"{value:g}"


def _finish(axes: Axes, cost: Cost) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(_FLOOR / 3, 10.0)
    axes.set_yticks(10.0 ** np.arange(-16, 1, 2))
    axes.set_xlabel("time of one run (s)")
    symbol = r"u_{s,\max}" if cost.reference["peak"] == "u_s_max_m" else r"|\theta|_{\max}"
    axes.set_ylabel(f"relative error of ${symbol}$")
