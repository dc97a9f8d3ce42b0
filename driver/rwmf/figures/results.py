"""Figures of checks, of pushover curves and of the cost of accuracy."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.figures import image_files as figures
from rwmf.figures import styles
from rwmf.kernel.numbers import Array, grouped, show
from rwmf.run.arguments import dataset_of
from rwmf.run.checks import Checks, LimitCheck
from rwmf.run.quantities import find_numbered
from rwmf.run.response import marks_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from rwmf.assess.cost import Cost, Row

# longest drawn ratio; larger ones end at an arrow
_LONGEST = 3.0
_MET, _EXCEEDED = styles.COLOURS[0], styles.COLOURS[1]


@checked
def checks(found: Checks, axes: Axes | Sequence[Axes] | np.ndarray | None = None) -> styles.Panels:
    """Draw ratios of demands over limits.

    Parameters
    ----------
    found : Checks
        From `rwmf.checks`, of a run or of one suite.
    axes : matplotlib axes or sequence of axes, optional
        One for the bars and, with limits of floors or storeys, one for the ratios over the height;
        otherwise a new figure.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes. A bar is the ratio of a run or the median of a suite. The line of a suite covers
        16 to 84 %, and its dot is the largest ratio.

    Raises
    ------
    InputError
        When `found` holds no checks, or those of a grid with several points.
    """
    if not isinstance(found, Checks) or not found.rows:
        raise InputError(f"found = {show(found)}: must be the result of rwmf.checks")
    if any(row.at != found.rows[0].at for row in found.rows):
        raise InputError("found: has several points of a grid: select one before rwmf.checks")
    groups = _over_height(found)
    panels = styles.make_panels(axes, 1 + bool(groups), across=True)
    _draw_bars(panels[0], _bars(found, groups))
    if groups:
        _draw_heights(panels[1], groups)
    reach = max((row.ratio for row in found.rows if not math.isnan(row.ratio)), default=1.0)
    for ax in panels:
        ax.axvline(1.0, **styles.LIMIT | {"linewidth": 1.4})
        ax.set(xlim=(0, min(max(1.1, 1.05 * reach), _LONGEST)), xlabel="demand over limit")
    return panels


def save_checks(found: Checks, path: str | os.PathLike[str]) -> None:
    """Draw checks into a file."""
    groups = _over_height(found)
    n = len(_bars(found, groups))
    with styles.new_figure(max(0.9 + 0.26 * n, 3.0 if groups else 0.0)) as figure:
        axes = figure.subplots(
            1, 1 + bool(groups), squeeze=False, width_ratios=[1.2, 1.0][: 1 + bool(groups)]
        )
        checks(found, axes[0])
        figures.save(figure, path)


def _over_height(found: Checks) -> dict[str, list[LimitCheck]]:
    """Return the checks of several floors or storeys by their key in `&limits`."""
    numbered = (row for row in found.rows if row.number)
    groups = grouped(numbered, lambda row: find_numbered(row.key)[0].limit_key)
    return {key: rows for key, rows in groups.items() if len(rows) > 1}


def _bars(found: Checks, groups: dict[str, list[LimitCheck]]) -> list[tuple[str, LimitCheck]]:
    """Return labels and checks of the bars: the largest of each group over the height."""
    bars: dict[str, LimitCheck] = {}
    for row in found.rows:
        key = find_numbered(row.key)[0].limit_key
        label = key if key in groups else row.key
        if label not in bars or _size(row) > _size(bars[label]):
            bars[label] = row
    return list(bars.items())


def _size(row: LimitCheck) -> float:
    """Return the ratio that is drawn: the median of a suite."""
    ratio = row.ratios[50.0] if row.ratios else row.ratio
    return 0.0 if math.isnan(ratio) else ratio


def _draw_bars(ax: Axes, bars: list[tuple[str, LimitCheck]]) -> None:
    for i, (_, row) in enumerate(bars):
        ratio = _size(row)
        ax.barh(i, min(ratio, _LONGEST), 0.62, color=_MET if ratio <= 1 else _EXCEEDED)
        if row.ratios:
            ends = [min(row.ratios[q], _LONGEST) for q in (16.0, 84.0)]
            ax.plot(ends, [i, i], color=styles.INK, linewidth=1.2)
            largest = row.ratios[100.0]
            ax.plot(
                min(largest, _LONGEST), i, color=styles.INK, clip_on=False, markersize=4,
                marker="o" if largest <= _LONGEST else ">",
            )  # fmt: skip
    ax.set_yticks(range(len(bars)), [label for label, _ in bars])
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")


def _draw_heights(ax: Axes, groups: dict[str, list[LimitCheck]]) -> None:
    for i, (key, rows) in enumerate(groups.items()):
        numbers = [row.number for row in rows]
        sizes = [min(_size(row), _LONGEST) for row in rows]
        look = styles.series(i, len(groups))
        if rows[0].key.startswith("storey"):
            # constant over the storey
            numbers = [end for n in numbers for end in (n - 1, n)]
            sizes = np.repeat(sizes, 2).tolist()
        else:
            look |= {"marker": "o", "markersize": 3}
        ax.plot(sizes, numbers, label=key, **look)
    top = max(row.number for rows in groups.values() for row in rows)
    ax.set(ylim=(0, top + 0.1), yticks=range(0, top + 1, 1 + top // 8), ylabel="floor")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=1, borderpad=0.2)


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
    axes: Axes = styles.make_panels(ax, 1)[0]
    for method, colour, marker in zip(_METHODS, styles.COLOURS, styles.MARKERS, strict=False):
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
        styles.legend_beside(axes)
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
        color=styles.GREY,
        markerfacecolor=styles.GREY if filled else styles.PAPER,
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
        markeredgecolor=styles.INK,
        linestyle="none",
        label=f"cheapest for {_power(target)}",
    )
    axes.axhline(target, **styles.LEVEL)


def _power(value: float) -> str:
    exponent = math.log10(value)
    if math.isclose(exponent, round(exponent), abs_tol=1e-9):
        return f"$10^{{{round(exponent)}}}$"
    return f"{value:g}"


def _finish(axes: Axes, cost: Cost, over: str) -> None:
    axes.set(xscale="log", yscale="log", ylim=(_FLOOR / 3, 10.0), xlabel=_WORK[over])
    axes.set_yticks(10.0 ** np.arange(-16, 1, 2))
    peak = cost.reference["peak"]
    axes.set_ylabel(f"relative error of {_SYMBOLS.get(peak, peak)}")


_PLACES = {"fuse_left": "left fuse", "fuse_right": "right fuse"}
_VERBS = {
    "yield": "yields",
    "slack": "goes slack",
    "rupture": "ruptures",
    "capping": "reaches its capping point",
    "residual": "is at its residual force",
    "failure": "has no strength left",
}
_WORDS = {
    "decompression": "edge of the base decompresses",
    "uplift": "wall lifts off",
    "contact": "wall is back on its base",
    "overturned": "wall overturns",
    "collapsed": "drift limit of the case",
    "no_equilibrium": "no static equilibrium beyond",
    "no_contact": "no contact at the base",
}
# beginning of the marks of limits
OF_LIMIT = "limit_"
_KILO = 1e-3


def words_of_mark(name: str) -> str:
    """Return a mark in plain words."""
    if name.startswith(OF_LIMIT):
        return f"limit of {name.removeprefix(OF_LIMIT)}"
    place, _, verb = name.rpartition("_")
    if name in _WORDS or verb not in _VERBS:
        return _WORDS.get(name, name.replace("_", " "))
    return f"{_PLACES.get(place, place.replace('_', ' '))} {_VERBS[verb]}"


@checked
def pushover(
    curve: xr.Dataset, ax: Axes | None = None, *, history: xr.Dataset | None = None
) -> Axes:
    """Draw base shear over the drift of the roof, with the first mark of each kind.

    Parameters
    ----------
    curve : xarray.Dataset
        From `rwmf.pushover`.
    ax : matplotlib axes, optional
        Axes to draw in; otherwise a new figure.
    history : xarray.Dataset, optional
        From `rwmf.simulate` of the same case, with a history and `&output reactions`; its base
        shear is drawn behind the curve.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. Forces are in kN where masses are known, otherwise over the weight.

    Raises
    ------
    InputError
        When the history has no base shear or no drift.
    """
    curve = dataset_of(curve, "rwmf.pushover", "roof_drift", "base_shear_over_weight", "mark_step")
    (ax,) = styles.make_panels(ax, 1)
    scale = _KILO * float(curve.attrs.get("weight_N", 0.0))
    unit = scale or 1.0
    drift = 100 * curve["roof_drift"].values
    shear = unit * curve["base_shear_over_weight"].values
    if history is not None:
        moved, force = _hysteresis(history, curve)
        ax.plot(
            100 * moved, unit * force, color=styles.FAINT, lw=0.7, label="dynamic run", zorder=2
        )
    ax.axhline(0.0, **styles.LEVEL)
    ax.plot(drift, shear, color=styles.INK, lw=1.6, label="static curve", zorder=3)
    for i, (words, step, at) in enumerate(_first_marks(curve)):
        ax.plot(
            100 * at,
            np.interp(at, *_segment(curve, step)) * unit,
            linestyle="none",
            marker=styles.MARKERS[i % len(styles.MARKERS)],
            color=styles.COLOURS[i % len(styles.COLOURS)],
            markeredgecolor=styles.PAPER,
            markeredgewidth=0.5,
            markersize=7,
            label=f"{styles.plain(words)}, {100 * at:.3g} %",
            zorder=5,
        )
    ax.set_xlabel("roof drift (%)")
    weight = styles.plain(curve.attrs["weight"])
    ax.set_ylabel("base shear (kN)" if scale else f"base shear over {weight}")
    styles.legend_beside(ax)
    return ax


def _segment(curve: xr.Dataset, step: int) -> tuple[Array, Array]:
    """Return drifts, ascending, and shears of the step and the one before it."""
    rows = [max(step - 1, 0), step]
    drift, shear = (curve[name].values[rows] for name in ("roof_drift", "base_shear_over_weight"))
    if drift[0] == drift[1]:
        return drift[1:], shear[1:]
    order = np.argsort(drift)
    return drift[order], shear[order]


def _first_marks(curve: xr.Dataset) -> list[tuple[str, int, float]]:
    """Return words, step and drift of the first mark of each kind; storeys and floors share it."""
    found: dict[str, tuple[str, int, float]] = {}
    for name, step, drift in marks_of(curve):
        storey = re.fullmatch(r"storey_(\d+)_(\w+)", name)
        kind = f"storey_{storey[2]}" if storey else name
        words = words_of_mark(name)
        if storey:
            words = f"{words} first"
        elif name.startswith(OF_LIMIT):
            kind = find_numbered(name.removeprefix(OF_LIMIT))[0].limit_key
        found.setdefault(kind, (words, step, drift))
    return list(found.values())


def _hysteresis(history: xr.Dataset, curve: xr.Dataset) -> tuple[Array, Array]:
    """Return drift of the roof and resisting base shear of a run."""
    history = dataset_of(history, "rwmf.simulate")
    if "time" not in history.dims or "base_shear_over_weight" not in history:
        raise InputError(
            "history: has no base shear: must be a run with a history and reactions: "
            "simulate(case, dt=0.01) with &output reactions = .true."
        )
    shear = -history["base_shear_over_weight"].values
    for name, length in (
        ("frame_drift", 1.0),
        ("u_s", float(curve.attrs["roof_height_m"])),
        ("wall_drift", 1.0),
    ):
        if name in history:
            return history[name].values / length, shear
    raise InputError("history: has no drift of the roof: frame_drift, u_s or wall_drift")
