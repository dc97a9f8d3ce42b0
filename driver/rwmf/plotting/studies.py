"""Figures of the studies. Nothing here simulates.

``draw_X(dataset, ax)`` draws the ``xarray.Dataset`` of the study X into ``matplotlib`` axes and
returns these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rwmf.studies.fragility import exceedance
from rwmf.studies.friction import CABLE, DEMAND
from rwmf.studies.overturning import SURVIVES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "draw_bands",
    "draw_equal_response",
    "draw_fragility",
    "draw_friction",
    "draw_overturning",
    "draw_suite",
    "draw_wall_effect",
]

_SYMBOLS = {
    "gamma": r"$\gamma$",
    "b": "$b$",
    "e": "$e$",
    "scale": "scale",
    "u_s_max": r"$u_{s,\max}$",
}
# regions of an overturning map: stays, then by the number of impacts
_STAYS = "0.96"


def draw_overturning(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw an overturning map: regions by the number of impacts, boundaries as dots.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.overturning_map`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    import matplotlib
    from matplotlib.colors import BoundaryNorm, ListedColormap

    outcome = dataset["outcome"]
    highest = max(int(outcome.max()), 0)
    shades = matplotlib.colormaps["viridis"](np.linspace(0.15, 0.95, highest + 1))
    colours = ListedColormap([_STAYS, *shades])
    norm = BoundaryNorm(np.arange(SURVIVES - 0.5, highest + 1), colours.N)
    x, y = dataset["omega_over_p"], dataset["amplitude"]
    mesh = ax.pcolormesh(x, y, outcome.T, cmap=colours, norm=norm, alpha=0.75, linewidth=0)
    mesh.set_rasterized(True)
    ax.plot(dataset["boundary_omega_over_p"], dataset["boundary_amplitude"], ".k", markersize=2.5)
    ax.set_xlabel(r"$\omega_p/p$")
    ax.set_ylabel(r"$a_p/(\alpha g)$")
    bar = ax.figure.colorbar(mesh, ax=ax, ticks=range(SURVIVES, highest + 1))
    names = ["stays", "no impact", "1 impact", *(f"{i} impacts" for i in range(2, highest + 1))]
    bar.ax.set_yticklabels(names[: highest + 2])
    return ax


def draw_suite(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw percentiles of a suite: the median as a line, the outer ones as a band.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.suite_spectra`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    name = next(str(key) for key in dataset if str(key).endswith("_percentiles"))
    for i, (label, curve) in enumerate(_curves(dataset[name], ("percentile", "T_s"))):
        low, middle, high = (curve.isel(percentile=k) for k in (0, curve.percentile.size // 2, -1))
        _fill_between(ax, curve["T_s"], low, high, i)
        ax.plot(curve["T_s"], middle, color=f"C{i}", label=label)
    _finish(ax, dataset[name.removesuffix("_percentiles")])
    return ax


def draw_bands(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw sensitivity bands: the nominal spectrum inside its range.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.sensitivity_bands`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    pairs = [_curves(dataset[name], ("T_s",)) for name in ("lowest", "nominal", "highest")]
    for i, ((_, low), (label, nominal), (_, high)) in enumerate(zip(*pairs, strict=True)):
        _fill_between(ax, nominal["T_s"], low, high, i)
        ax.plot(nominal["T_s"], nominal, color=f"C{i}", label=label)
    _finish(ax, dataset["nominal"])
    return ax


def draw_wall_effect(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw the ratio with over without the wall; over a suite its median.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.wall_effect`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    ratio = dataset["ratio"]
    if "record" in ratio.dims:
        ratio = ratio.median("record", keep_attrs=True)
    for label, curve in _curves(ratio, ("T_s",)):
        ax.plot(curve["T_s"], curve, label=label)
    ax.axhline(1.0, color="0.45", linewidth=0.8, linestyle=(0, (4, 2)))
    _finish(ax, dataset["ratio"])
    ax.set_ylabel(r"$u_{s,\max}$ with / without wall")
    return ax


def draw_friction(dataset: xr.Dataset, axes: Sequence[Axes]) -> Sequence[Axes]:
    """Draw required friction, and cable force or without a cable base shear; medians of a suite.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `friction_spectra`.
    axes : sequence of matplotlib.axes.Axes
        Two places to draw.

    Returns
    -------
    sequence of matplotlib.axes.Axes
        The axes.
    """
    second = CABLE if CABLE in dataset else "base_shear_max_over_weight"
    for ax, name in zip(axes, (DEMAND, second), strict=True):
        values = dataset[name]
        if "record" in values.dims:
            values = values.median("record", keep_attrs=True)
        for label, curve in _curves(values, ("T_s",)):
            ax.plot(curve["T_s"], curve, label=label)
        _finish(ax, dataset[name])
    return axes


def draw_fragility(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw a fragility curve: counted fractions as dots, the lognormal fit as a line.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.fragility`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    median, dispersion = float(dataset["median"]), float(dataset["dispersion"])
    scale = dataset["scale"].values
    # whole dots where none or all of the records exceed the limit
    dots: dict[str, Any] = {"color": "C0", "markersize": 3.5, "label": "counted", "clip_on": False}
    ax.plot(scale, dataset["fraction"], "o", **dots)
    text = f"lognormal, median {median:.3g}, dispersion {dispersion:.2g}"
    fine = np.linspace(scale.min(), scale.max(), 400)
    ax.plot(fine, exceedance(fine, median, dispersion), color="C0", label=text)
    ax.set_xlabel(r"$S_a(T_s)/g$")
    quantity = dataset.attrs["quantity"]
    limit = f"{float(dataset['limit']):g}"
    ax.set_ylabel(f"P({_SYMBOLS.get(quantity, quantity)} > {limit})")
    ax.set_ylim(0, 1.02)
    # above the axes: the curve may begin or end in any corner
    ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    return ax


def draw_equal_response(dataset: xr.Dataset, ax: Axes) -> Axes:
    """Draw the amplitudes of pulses that give the same displacement.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.studies.equal_response`.
    ax : matplotlib.axes.Axes
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    ax.plot(dataset["T_p"], dataset["a_max_g"])
    ax.set_yscale("log")
    for axis_format in (ax.yaxis.set_major_formatter, ax.yaxis.set_minor_formatter):
        axis_format(lambda value, _: f"{value:g}")
    ax.set_xlabel("$T_p$ (s)")
    ax.set_ylabel(r"$a_{\max}/g$ for $u_{s,\max}$ = " + f"{float(dataset['target']):g} m")
    return ax


def _curves(values: xr.DataArray, kept: tuple[str, ...]) -> list[tuple[str, xr.DataArray]]:
    """Split an array into curves; a label names the dimensions that have several values."""
    return list(_split(values, kept))


def _split(values: xr.DataArray, kept: tuple[str, ...]) -> Iterator[tuple[str, xr.DataArray]]:
    others = [str(name) for name in values.dims if name not in kept]
    for place in product(*(range(values.sizes[name]) for name in others)):
        at = dict(zip(others, place, strict=True))
        parts = [
            f"{_SYMBOLS.get(name, name)} = {_text(values[name].values[i])}"
            for name, i in at.items()
            if values.sizes[name] > 1
        ]
        yield ", ".join(parts), values.isel(at)


def _text(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _fill_between(ax: Axes, x: xr.DataArray, low: xr.DataArray, high: xr.DataArray, i: int) -> None:
    # an overturned wall has no upper end: the band stops there
    ax.fill_between(x, low, high.where(np.isfinite(high)), color=f"C{i}", alpha=0.2, linewidth=0)


def _finish(ax: Axes, values: xr.DataArray) -> None:
    unit = values.attrs.get("units", "1")
    ax.set_xlabel("$T_s$ (s)")
    ax.set_ylabel(values.attrs.get("long_name", "") + ("" if unit == "1" else f" ({unit})"))
    ax.set_ylim(bottom=0)
    ax.margins(x=0)
    if any(str(line.get_label())[:1] != "_" for line in ax.lines):
        ax.legend()
