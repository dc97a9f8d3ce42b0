"""Figures of the studies.

A function draws the ``xarray.Dataset`` of the study of the same name into ``matplotlib`` axes and
returns these.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import TYPE_CHECKING

from rwmf._arguments import checked, dataset_of
from rwmf.plotting.style import (
    LEVEL,
    label_in_large_units,
    label_plainly,
    legend_above,
    period_label,
    plain,
    series,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["equal_response", "wall_effect"]

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


def _finish(ax: Axes, values: xr.DataArray) -> None:
    ax.set_xlabel(period_label(values["T_s"]))
    unit = label_in_large_units(ax.yaxis, values.attrs.get("units", "1"))
    text = values.attrs.get("long_name", "") + ("" if unit == "1" else f" ({unit})")
    ax.set_ylabel(plain(text))
    ax.set_ylim(bottom=0)
    ax.margins(x=0)
    if ax.get_legend_handles_labels()[1]:
        legend_above(ax, columns=2)
