"""Figures of the studies.

``draw_X(dataset, ax)`` draws the ``xarray.Dataset`` of the study X into ``matplotlib`` axes and
returns these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from rwmf._arguments import checked, dataset_of
from rwmf.plotting.style import (
    LEVEL,
    label_in_large_units,
    label_plainly,
    legend_above,
    make_panels,
    period_label,
    plain,
    series,
)
from rwmf.studies.friction import CABLE, DEMAND

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = [
    "draw_bands",
    "draw_equal_response",
    "draw_friction",
    "draw_suite",
    "draw_wall_effect",
]

_LINES = ("-", "--", ":", "-.")
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
# opacity of a band, and of the hatching of a band without upper end
_BAND, _OPEN = 0.25, 0.5


@checked
def draw_suite(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw percentiles of a suite: the median as a line, the outer ones as a band.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.suite_spectra`.
    ax : matplotlib.axes.Axes
        Axes to draw in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.suite_spectra", "percentile")
    name = next(str(key) for key in dataset if str(key).endswith("_percentiles"))
    values = dataset[name.removesuffix("_percentiles")]
    bands = []
    for label, curve in _curves(dataset[name], ("percentile", "T_s")):
        low, middle, high = (curve.isel(percentile=k) for k in (0, curve.percentile.size // 2, -1))
        bands.append((label or "median", low, middle, high))
    first, last = (float(dataset["percentile"][k]) for k in (0, -1))
    _draw_bands(ax, bands, f"{first:g} to {last:g} % of {values.sizes['record']} records")
    _finish(ax, values)
    return ax


@checked
def draw_bands(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw sensitivity bands: the nominal spectrum within its range.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.sensitivity_bands`.
    ax : matplotlib.axes.Axes
        Axes to draw in.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.sensitivity_bands", "lowest", "nominal", "highest")
    pairs = [_curves(dataset[name], ("T_s",)) for name in ("lowest", "nominal", "highest")]
    bands = [
        (label or "nominal", low, nominal, high)
        for (_, low), (label, nominal), (_, high) in zip(*pairs, strict=True)
    ]
    _draw_bands(ax, bands, "range over the uncertain values")
    _finish(ax, dataset["nominal"])
    return ax


@checked
def draw_wall_effect(dataset: xr.Dataset, ax: Axes) -> Axes:
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
    curves = [_curves(ratio, ("T_s",)) for ratio in values]
    n = len(curves[0])
    for k, (name, found) in enumerate(zip(names, curves, strict=True)):
        symbol = _SYMBOLS.get(name, plain(name.replace("_", " "))) if len(names) > 1 else ""
        for i, (label, curve) in enumerate(found):
            # one colour per response, one line style per frame
            line_style = series(k, len(names)) | {"linestyle": _LINES[i % len(_LINES)]}
            if len(names) == 1:
                line_style = series(i, n)
            parts = [part for part in (symbol, label) if part]
            ax.plot(curve["T_s"], curve, label=", ".join(parts) or None, **line_style)
    ax.axhline(1.0, **LEVEL)
    _finish(ax, dataset["ratio"])
    only = (
        _SYMBOLS.get(names[0], plain(names[0].replace("_", " "))) + " " if len(names) == 1 else ""
    )
    ax.set_ylabel(f"{only}with / without wall")
    return ax


@checked
def draw_friction(dataset: xr.Dataset, axes: Sequence[Axes]) -> Sequence[Axes]:
    """Draw required friction, and cable force or base shear without a cable; suite medians.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `friction_spectra`.
    axes : sequence of matplotlib.axes.Axes
        Two axes to draw in.

    Returns
    -------
    sequence of matplotlib.axes.Axes
        The axes.
    """
    dataset_of(dataset, "rwmf.studies.friction_spectra", "T_s", DEMAND)
    panels = make_panels(axes, 2)
    second = CABLE if CABLE in dataset else "base_shear_max_over_weight"
    for ax, name in zip(panels, (DEMAND, second), strict=True):
        values = dataset[name]
        if "record" in values.dims:
            values = values.median("record", keep_attrs=True)
        _draw_lines(ax, values)
        _finish(ax, dataset[name], from_zero=False)
    return axes


@checked
def draw_equal_response(dataset: xr.Dataset, ax: Axes) -> Axes:
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
    ax.plot(dataset["T_p"], dataset["a_max_g"], **series(0, 1))
    ax.set_yscale("log")
    label_plainly(ax.yaxis)
    ax.margins(x=0)
    ax.set_xlabel("pulse period $T_p$ (s)")
    quantity = str(dataset.attrs["quantity"])
    unit = plain(dataset["target"].attrs.get("units", "1"))
    # the key of an acceleration over g ends with its unit
    if unit == "1":
        unit = "g" if quantity.endswith("acceleration_max_g") else ""
    symbol = _SYMBOLS.get(quantity, plain(quantity.replace("_", " ")))
    ax.set_ylabel(r"$a_{\max}/g$ for " + f"{symbol} = {float(dataset['target']):g} {unit}".rstrip())
    return ax


def _curves(values: xr.DataArray, kept: tuple[str, ...]) -> list[tuple[str, xr.DataArray]]:
    """Split an array into curves, labelled by the dimensions with several values."""
    return list(_split(values, kept))


def _split(values: xr.DataArray, kept: tuple[str, ...]) -> Iterator[tuple[str, xr.DataArray]]:
    others = [str(name) for name in values.dims if name not in kept]
    for place in product(*(range(values.sizes[name]) for name in others)):
        at = dict(zip(others, place, strict=True))
        parts = [
            f"{_SYMBOLS.get(name, plain(name))} = {_text(values[name].values[i])}"
            for name, i in at.items()
            if values.sizes[name] > 1
        ]
        yield ", ".join(parts), values.isel(at)


def _text(value: object) -> str:
    return plain(value) if isinstance(value, str) else f"{value:g}"


def _draw_lines(ax: Axes, values: xr.DataArray) -> None:
    curves = _curves(values, ("T_s",))
    for i, (label, curve) in enumerate(curves):
        ax.plot(curve["T_s"], curve, label=label or None, **series(i, len(curves)))


def _draw_bands(
    ax: Axes, bands: Sequence[tuple[str, xr.DataArray, xr.DataArray, xr.DataArray]], interval: str
) -> None:
    """Draw lines with their bands: label, lower end, line, upper end."""
    ends = [values.values[np.isfinite(values.values)] for band in bands for values in band[1:]]
    top = 1.05 * max((float(values.max()) for values in ends if values.size), default=1.0)
    is_told = False
    for i, (label, low, middle, high) in enumerate(bands):
        line_style = series(i, len(bands))
        x, colour = middle["T_s"], line_style["color"]
        ax.plot(x, middle, label=label, **line_style)
        closed = np.isfinite(high.values)
        ax.fill_between(x, low, high.where(closed), color=colour, alpha=_BAND, linewidth=0,
                        label=f"{label}: {interval}" if len(bands) > 1 else interval)  # fmt: skip
        # from the last period with an upper end: the hatched region extends beyond the figure
        rest = ~closed & np.isfinite(low.values)
        rest[:-1] |= rest[1:] & closed[:-1]
        if rest.any():
            ax.fill_between(x, low, top, where=rest, facecolor="none", edgecolor=colour,
                            alpha=_OPEN, hatch="///", linewidth=0,
                            label=None if is_told else "no upper end: overturns")  # fmt: skip
            is_told = True
    ax.set_ylim(0, top)


def _finish(ax: Axes, values: xr.DataArray, from_zero: bool = True) -> None:
    ax.set_xlabel(period_label(values["T_s"]))
    unit = label_in_large_units(ax.yaxis, values.attrs.get("units", "1"))
    text = values.attrs.get("long_name", "") + ("" if unit == "1" else f" ({unit})")
    ax.set_ylabel(plain(text))
    if from_zero:
        ax.set_ylim(bottom=0)
    ax.margins(x=0)
    if ax.get_legend_handles_labels()[1]:
        legend_above(ax, columns=2)
