"""Work-precision plot of measured costs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rwmf._arguments import checked
from rwmf._numbers import show
from rwmf.errors import InputError
from rwmf.plotting.style import (
    COLOURS,
    GREY,
    INK,
    LEVEL,
    MARKERS,
    PAPER,
    legend_beside,
    make_panels,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rwmf._cost import Cost, Row


_METHODS = ("adams", "bdf", "taylor", "dop853", "paper")
# procedures of practice: marker, and True for filled (dt), False for open (dt/10)
_PRACTICES = {
    "RK4, dt": ("P", True),
    "RK4, dt/10": ("P", False),
    "Newmark, dt": ("X", True),
    "Newmark, dt/10": ("X", False),
}
# symbols of the peaks compared by default
_SYMBOLS = {"u_s_max_m": r"$u_{s,\max}$", "theta_max_rad": r"$|\theta|_{\max}$"}
_WORK = {"seconds": "processor time of one run (s)", "rhs_evaluations": "evaluations of one run"}
# errors below this are round-off and drawn at this level
_FLOOR = 1e-16


@checked
def work_precision(
    cost: Cost, ax: Axes | None = None, *, legend: bool = True, over: str = "seconds"
) -> Axes:
    """Draw error against work, one line per method; procedures of practice are grey points.

    Parameters
    ----------
    cost : Cost
        From `rwmf.cost`.
    ax : matplotlib axes, optional
        Axes to draw in; otherwise a new figure.
    legend : bool
        Add a legend beside the axes.
    over : {'seconds', 'rhs_evaluations'}
        Measure of work: processor time, which varies with the load of the machine, or the number
        of evaluations, which does not.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. A ring marks the recommended row.

    Raises
    ------
    InputError
        When an argument has the wrong type.
    """
    if not getattr(cost, "rows", None):
        raise InputError(f"cost = {show(cost)}: must be the result of rwmf.cost, with rows")
    if over not in _WORK:
        raise InputError(f"over = {show(over)}: must be one of {', '.join(_WORK)}")
    axes: Axes = make_panels(ax, 1)[0]
    for method, colour, marker in zip(_METHODS, COLOURS, MARKERS, strict=False):
        rows = [row for row in cost.rows if row.method == method and _is_drawn(row)]
        if not rows:
            continue
        axes.plot(
            [getattr(row, over) for row in rows],
            [_height(row) for row in rows],
            color=colour,
            marker=marker,
            markersize=3.5,
            label=method,
        )
    for row in cost.practices:
        if _is_drawn(row):
            _draw_practice(axes, row, over)
    if cost.recommended is not None:
        _mark_recommended(axes, cost.recommended, cost.target, over)
    _finish(axes, cost, over)
    if legend:
        legend_beside(axes)
    return axes


def _is_drawn(row: Row) -> bool:
    return math.isfinite(row.relative_error) and math.isfinite(row.seconds)


def _height(row: Row) -> float:
    return max(row.relative_error, _FLOOR)


def _draw_practice(axes: Axes, row: Row, over: str) -> None:
    marker, filled = _PRACTICES.get(row.method, ("x", True))
    axes.plot(
        [getattr(row, over)],
        [_height(row)],
        marker,
        color=GREY,
        markerfacecolor=GREY if filled else PAPER,
        markersize=6,
        label=row.method,
    )


def _mark_recommended(axes: Axes, row: Row, target: float, over: str) -> None:
    axes.plot(
        [getattr(row, over)],
        [_height(row)],
        "o",
        markersize=10,
        markerfacecolor="none",
        markeredgecolor=INK,
        linestyle="none",
        label=f"cheapest for {_power(target)}",
    )
    axes.axhline(target, **LEVEL)


def _power(value: float) -> str:
    exponent = math.log10(value)
    if math.isclose(exponent, round(exponent), abs_tol=1e-9):
        return f"$10^{{{round(exponent)}}}$"
    return f"{value:g}"


def _finish(axes: Axes, cost: Cost, over: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(_FLOOR / 3, 10.0)
    axes.set_yticks(10.0 ** np.arange(-16, 1, 2))
    axes.set_xlabel(_WORK[over])
    peak = cost.reference["peak"]
    axes.set_ylabel(f"relative error of {_SYMBOLS.get(peak, peak)}")
