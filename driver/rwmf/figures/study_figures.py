"""Figures of the studies.

A function draws the ``xarray.Dataset`` of the study of the same name into ``matplotlib`` axes and
returns these.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product, zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.assess.studies import SURVIVES
from rwmf.case.arguments import checked
from rwmf.figures import styles
from rwmf.run.arguments import dataset_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

# outcome, lower and upper amplitude
Region = tuple[int, float, float]
# opacity of a region's colour
_REGION = 0.5


@checked
def overturning_map(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw an overturning map: regions by the number of impacts, bisected boundaries as lines.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.overturning_map`.
    ax : matplotlib.axes.Axes
        Axes to draw in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.overturning_map", "omega_over_p", "outcome", "alpha")
    omegas = dataset["omega_over_p"].values
    columns = [_regions(dataset, i) for i in range(omegas.size)]
    for i in range(omegas.size - 1):
        _draw_between(ax, omegas[i : i + 2], columns[i], columns[i + 1])
    for outcome in sorted({region[0] for column in columns for region in column}):
        edge = {"edgecolor": styles.GREY, "linewidth": 0.6}
        ax.fill_between(
            [], [], [], label=_outcome_in_words(outcome), **(_region_style(outcome) | edge)
        )
    at = dataset["boundary_omega_over_p"], dataset["boundary_amplitude"]
    ax.plot(*at, **(styles.DOTS | {"markersize": 1.5}), label="bisected boundary")
    ax.set_xlim(omegas[0], omegas[-1])
    ax.set_ylim(columns[0][0][1], columns[0][-1][2])
    ax.set_xlabel(r"pulse frequency $\omega_p/p$")
    ax.set_ylabel(r"pulse amplitude $a_p/(\alpha g)$")
    ax.set_title(_scene_in_words(dataset))
    styles.legend_beside(ax)
    return ax


def _regions(dataset: xr.Dataset, i: int) -> list[Region]:
    """Return outcome, lower and upper amplitude of the regions at one frequency."""
    at = np.flatnonzero(
        dataset["boundary_omega_over_p"].values == dataset["omega_over_p"].values[i]
    )
    limits = dataset["boundary_amplitude"].values[at]
    outcomes = [int(dataset["outcome"].values[i, 0]), *map(int, dataset["above"].values[at])]
    edges = [*map(float, (dataset["amplitude"][0], *limits, dataset["amplitude"][-1]))]
    return list(zip(outcomes, edges, edges[1:], strict=False))


def _draw_between(
    ax: Axes,
    omegas: np.ndarray,
    left: list[Region],
    right: list[Region],
) -> None:
    """Fill the regions between two frequencies."""
    pairs = list(zip(left, right, strict=False))
    leaving = abs(len(left) - len(right))
    if leaving <= 1 and all(first[0] == second[0] for first, second in pairs):
        top = left[-1][2]
        for (_, y_left, _), (_, y_right, _) in pairs[1:]:
            ax.plot(omegas, [y_left, y_right], color=styles.INK, linewidth=0.9)
        for region, other in zip_longest(left, right):
            outcome = (region or other)[0]
            low, high = zip(*((x or (outcome, top, top))[1:] for x in (region, other)), strict=True)
            ax.fill_between(omegas, low, high, **_region_style(outcome))
        return
    middle = omegas.mean()
    for ends, column in (((omegas[0], middle), left), ((middle, omegas[1]), right)):
        for outcome, low_edge, high_edge in column:
            ax.fill_between(ends, low_edge, high_edge, **_region_style(outcome))


def _region_style(outcome: int) -> dict[str, Any]:
    if outcome == SURVIVES:
        return {"facecolor": styles.PAPER, "linewidth": 0}
    # anti-aliased edges would show between the columns of one region
    colour = styles.tint(styles.COLOURS[outcome % len(styles.COLOURS)], _REGION)
    return {"facecolor": colour, "linewidth": 0, "antialiased": False}


def _outcome_in_words(outcome: int) -> str:
    if outcome == SURVIVES:
        return "stays"
    impacts = {0: "without impact", 1: "after 1 impact"}.get(outcome, f"after {outcome} impacts")
    return f"overturns {impacts}"


def _scene_in_words(dataset: xr.Dataset) -> str:
    """Describe wall, velocity factor and pulse of a map."""
    units = {"alpha": r"$\alpha$ = {:.4g} rad", "p": "$p$ = {:.4g} rad/s", "e": "$e$ = {:.4g}"}
    parts = [form.format(float(dataset[name])) for name, form in units.items() if name in dataset]
    return ", ".join([*parts, styles.plain(dataset.attrs["pulse"]).replace("_", "-")])


_SYMBOLS = {
    "storey_drift_max": "storey drift",
    "floor_acceleration_max_g": "floor acceleration",
    "gamma": r"$\gamma$",
    "b": "$b$",
    "e": "$e$",
    "scale": "scale",
    "u_s_max": r"$u_{s,\max}$",
    "theta_max_over_alpha": r"$\theta_{\max}/\alpha$",
}
_LINES = ("-", "--", ":", "-.")


@checked
def wall_effect(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw the ratios of responses with and without the wall; medians over a suite.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.wall_effect`.
    ax : matplotlib.axes.Axes
        Axes to draw in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.wall_effect", "ratio")
    names = str(dataset.attrs["quantities"]).split()
    values = []
    for name in names:
        ratio = dataset[f"{name}_ratio"]
        over = [dim for dim in ("record",) if dim in ratio.dims]
        values.append(ratio.median(over, keep_attrs=True) if over else ratio)
    curves = [list(_curves(ratio)) for ratio in values]
    n = len(curves[0])
    for k, (name, found) in enumerate(zip(names, curves, strict=True)):
        symbol = _symbol(name) if len(names) > 1 else ""
        for i, (label, curve) in enumerate(found):
            # one colour per response, one line style per frame
            line_style = styles.series(k, len(names)) | {"linestyle": _LINES[i % len(_LINES)]}
            if len(names) == 1:
                line_style = styles.series(i, n)
            parts = [part for part in (symbol, label) if part]
            ax.plot(curve["T_s"], curve, label=", ".join(parts) or None, **line_style)
    ax.axhline(1.0, **styles.LEVEL)
    only = f"{_symbol(names[0])} " if len(names) == 1 else ""
    period = styles.period_label(dataset["T_s"])
    ax.set(xlabel=period, ylabel=f"{only}with / without wall", ylim=(0, None))
    ax.margins(x=0)
    if ax.get_legend_handles_labels()[1]:
        styles.legend_above(ax, columns=2)
    return ax


@checked
def equal_response(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw the amplitudes of pulses that give the same response.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.equal_response`.
    ax : matplotlib.axes.Axes
        Axes to draw in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.equal_response", "T_p", "a_max_g", "target")
    ax.plot(dataset["T_p"], dataset["a_max_g"], **styles.series(0, 1))
    ax.set_yscale("log")
    styles.label_plainly(ax.yaxis)
    ax.margins(x=0)
    ax.set_xlabel("pulse period $T_p$ (s)")
    quantity = str(dataset.attrs["quantity"])
    unit = styles.plain(dataset["target"].attrs.get("units", "1"))
    # the key of an acceleration over g ends with its unit
    if unit == "1":
        unit = "g" if quantity.endswith("acceleration_max_g") else ""
    reached = f"{_symbol(quantity)} = {float(dataset['target']):g} {unit}".rstrip()
    ax.set_ylabel(r"$a_{\max}/g$ for " + reached)
    return ax


def _curves(values: xr.DataArray) -> Iterator[tuple[str, xr.DataArray]]:
    """Split an array into curves over periods, labelled by the dimensions with several values."""
    others = [str(name) for name in values.dims if name != "T_s"]
    for place in product(*(range(values.sizes[name]) for name in others)):
        at = dict(zip(others, place, strict=True))
        parts = [
            f"{_SYMBOLS.get(name, styles.plain(name))} = {_text(values[name].values[i])}"
            for name, i in at.items()
            if values.sizes[name] > 1
        ]
        yield ", ".join(parts), values.isel(at)


def _text(value: object) -> str:
    return styles.plain(value) if isinstance(value, str) else f"{value:g}"


def _symbol(name: str) -> str:
    """Return the symbol of a quantity, or its name in words."""
    return _SYMBOLS.get(name) or styles.plain(name.replace("_", " "))
