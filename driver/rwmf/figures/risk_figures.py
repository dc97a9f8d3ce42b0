"""Figures of incremental dynamic analyses and fragility curves, of one or several designs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rwmf.assess.annual import hazard_of
from rwmf.assess.fragility_curves import exceedance
from rwmf.assess.table import demand_percentiles, quantities_of, read_table
from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.figures.styles import DOTS, legend_above, make_panels, plain, series, tint
from rwmf.kernel.numbers import show, to_array
from rwmf.run.arguments import dataset_of
from rwmf.run.quantities import fallen, is_least

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# strength of the curves of single records, and of bands
_FAINT, _BAND = 0.3, 0.25
_SYMBOLS = {"u_s_max": r"$u_{s,\max}$", "theta_max_over_alpha": r"$\theta_{\max}/\alpha$"}


@checked
def ida(dataset: xr.Dataset, ax: Axes | None = None, quantity: str | None = None) -> Axes:
    """Draw demands over intensity: every record, the median and 16 and 84 %.

    Parameters
    ----------
    dataset : xarray.Dataset
        Table of `rwmf.ida` or `rwmf.stripes`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; otherwise a new figure.
    quantity : str, optional
        The demand; otherwise the first of the table.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, with the demand across and the intensity upwards. Curves end at the last run
        without collapse. A percentile that reaches a collapse goes to the right edge.

    Raises
    ------
    InputError
        When the table lacks the demand.
    """
    ax = make_panels(ax, 1)[0]
    rows, name = _rows_of(dataset, quantity)
    found = demand_percentiles(rows, [name])
    x, y, down = rows[name].values, rows["intensity"].values, fallen(rows)
    stood = np.isfinite(x) & ~down
    edge = 1.1 * float(x[stood].max()) if stood.any() else 1.0
    designs = found["design"].values.tolist()
    for i, design in enumerate(designs):
        line = series(i, len(designs))
        colour = tint(line["color"], _FAINT)
        ends = []
        for record in dict.fromkeys(rows["record"].values.tolist()):
            own = (rows["design"].values == design) & (rows["record"].values == record)
            # after the first collapse a record may stand again: not drawn
            until = y < (y[own & down].min() if (own & down).any() else np.inf)
            chosen = own & stood & until
            curve = np.array([[0.0, *x[chosen]], [0.0, *y[chosen]]])
            ax.plot(*curve, color=colour, linewidth=0.6, zorder=1)
            if (own & down).any():
                ends.append(curve[:, -1])
        if ends:
            label = "last level before collapse" if len(designs) == 1 else None
            ax.plot(*np.transpose(ends), "x", color=line["color"], markersize=4, label=label)
        _draw_percentiles(ax, found.isel(design=i), name, edge, line, design * (len(designs) > 1))
    ax.set(xlim=(0, edge), ylim=(0, None))
    _label_demand(ax, rows, name)
    legend_above(ax, columns=len(designs) if len(designs) > 1 else 3)
    return ax


@checked
def cloud(dataset: xr.Dataset, ax: Axes | None = None, quantity: str | None = None) -> Axes:
    """Draw demands over intensity as dots in logarithmic axes; collapsed runs as crosses.

    Parameters
    ----------
    dataset : xarray.Dataset
        Table of `rwmf.cloud`, or another table of runs.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; otherwise a new figure.
    quantity : str, optional
        The demand; otherwise the first of the table.

    Returns
    -------
    matplotlib.axes.Axes
        The axes; crosses are at the largest demand before the collapse.

    Raises
    ------
    InputError
        When the table lacks the demand.
    """
    ax = make_panels(ax, 1)[0]
    rows, name = _rows_of(dataset, quantity)
    x, y, down = rows[name].values, rows["intensity"].values, fallen(rows)
    designs = list(dict.fromkeys(rows["design"].values.tolist()))
    for i, design in enumerate(designs):
        own = (rows["design"].values == design) & (x > 0) & np.isfinite(x)
        colour = series(i, len(designs))["color"]
        label = plain(design or "runs")
        ax.loglog(x[own & ~down], y[own & ~down], ".", color=colour, label=label)
        if (own & down).any():
            looks = {"color": colour, "markersize": 4, "label": f"{label}, collapsed"}
            ax.loglog(x[own & down], y[own & down], "x", **looks)
    _label_demand(ax, rows, name)
    legend_above(ax, columns=2)
    return ax


def _rows_of(dataset: xr.Dataset, quantity: str | None) -> tuple[xr.Dataset, str]:
    """Read the table of a figure, and choose its demand."""
    rows = read_table(dataset_of(dataset, "rwmf.ida", "intensity", "record", "status"))
    names = quantities_of(rows)
    if not names or (quantity is not None and quantity not in names):
        listed = ", ".join(names) or "none"
        raise InputError(f"quantity = {show(quantity)}: is not in the table, which has {listed}")
    # the first demand, a smallest value only where there is no other
    return rows, quantity or min(names, key=is_least)


def _label_demand(ax: Axes, rows: xr.Dataset, name: str) -> None:
    """Label the axes of a demand and its intensity."""
    attrs = rows[name].attrs
    unit = attrs.get("units", "1")
    label = plain(attrs.get("long_name", name)) + (f" ({plain(unit)})" if unit != "1" else "")
    ax.set(xlabel=label, ylabel=intensity_label(rows.attrs))


def _draw_percentiles(
    ax: Axes, found: xr.Dataset, name: str, edge: float, line: dict[str, Any], design: str
) -> None:
    """Draw the curves of one design; where a percentile collapses it runs level to the edge."""
    for j, share in enumerate(found["percentile"].values):
        values, levels = found[name].values[:, j], found["intensity"].values
        finite = np.isfinite(values)
        px, py = [0.0, *values[finite]], [0.0, *levels[finite]]
        if np.isposinf(values).any():
            px, py = [*px, edge], [*py, py[-1]]
        prefix = f"{plain(design)}: " if design else ""
        if share == 50:
            ax.plot(px, py, label=f"{prefix}median", **line)
        else:
            label = f"{prefix}16 and 84 %" if j == 0 else None
            ax.plot(px, py, label=label, **line | {"linestyle": ":", "linewidth": 1.2})


@checked
def fragility(dataset: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw fragility curves with their bands, and the counted fractions as dots.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.fragility`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; otherwise a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    ax = make_panels(ax, 1)[0]
    dataset_of(dataset, "rwmf.fragility", "median", "dispersion", "fitted", "limit")
    where = "intensity" if "intensity" in dataset.coords else "scale"
    found = dataset if "design" in dataset.dims else dataset.expand_dims("design")
    spread = found["dispersion_total" if "dispersion_total" in found else "dispersion"].values
    x = found[where].values
    n = found.sizes["design"]
    highest = max([x.max(), *(float(np.max(_points(found.isel(design=i))[0], initial=0.0))
                              for i in range(n))])  # fmt: skip
    fine = np.linspace(min(x.min(), 0.02 * highest), highest, 400)
    for i in range(n):
        own = found.isel(design=i)
        median = float(own["median"])
        line: dict[str, Any] = series(i, n)
        text = f"median {median:.3g}, dispersion {spread[i]:.2g}"
        name = f"{plain(found['design'].values[i])}: " if n > 1 else "lognormal, "
        ax.plot(fine, exceedance(fine, median, spread[i]), label=name + text, **line)
        if "median_resampled" in own:
            low, high = _band(own, fine, spread[i])
            ax.fill_between(fine, low, high, color=line["color"], alpha=_BAND, linewidth=0)
        at, share = _points(own)
        # complete dots where no record or all records exceed the limit
        dots = DOTS | ({"color": line["color"]} if n > 1 else {})
        ax.plot(at, share, clip_on=False, **dots)
    ax.set(xlabel=intensity_label(dataset.attrs), ylabel=_condition(dataset))
    ax.set(xlim=(0, fine[-1]), ylim=(0, 1.02))
    legend_above(ax, columns=1 if n > 1 else 2)
    return ax


def _points(found: xr.Dataset) -> tuple[Any, Any]:
    """Return the dots of a curve: capacities by rank, or counted fractions at the levels."""
    if "capacity" in found:
        capacity = found["capacity"].values
        capacity = np.sort(capacity[~np.isnan(capacity)])
        share = (np.arange(capacity.size) + 0.5) / capacity.size
        shown = np.isfinite(capacity) & (capacity > 0)
        return capacity[shown], share[shown]
    if "fraction" not in found:
        return np.empty(0), np.empty(0)
    where = "intensity" if "intensity" in found.coords else "scale"
    return found[where].values, found["fraction"].values


def _band(found: xr.Dataset, x: Any, total: float) -> Any:  # noqa: ANN401 (arrays)
    """Return the band of a fragility curve at intensities, by ranks of its resamples."""
    median = found["median_resampled"].values
    further = total**2 - float(found["dispersion"]) ** 2
    spread = np.sqrt(found["dispersion_resampled"].values ** 2 + further)
    used = ~np.isnan(median + spread)
    curves = exceedance(x[:, None], median[used], spread[used])
    return np.quantile(curves, found["quantile"].values, axis=1, method="inverted_cdf")


@checked
def hazard(curve: Any, ax: Axes | None = None, levels: Any = None) -> Axes:  # noqa: ANN401
    """Draw the annual frequency of exceedance over the intensity, both logarithmic.

    Parameters
    ----------
    curve : path, mapping or pair
        The hazard as for `rwmf.risk`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; otherwise a new figure.
    levels : array_like, optional
        Range of intensities; otherwise that of the curve, or 0.01 to 10 for a power law.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    ax = make_panels(ax, 1)[0]
    found = hazard_of(curve)
    low, high = found.limits
    if levels is not None:
        given = to_array("levels", levels, above=0.0, least=2)
        low, high = given.min(), given.max()
    if low == 0.0:
        low, high = 0.01, 10.0
    x = np.geomspace(low, high, 200)
    ax.loglog(x, found.frequency(x), **series(0, 1))
    ax.set(xlabel="intensity", ylabel="annual frequency of exceedance (1/year)", xlim=(low, high))
    return ax


@checked
def deaggregation(dataset: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of each range of intensities in the annual frequency.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.risk`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw in; otherwise a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    ax = make_panels(ax, 1)[0]
    dataset_of(dataset, "rwmf.risk", "annual_frequency", "contribution", "intensity_low")
    found = dataset if "design" in dataset.dims else dataset.expand_dims("design")
    n, bins = found.sizes["design"], found.sizes["bin"]
    for i in range(n):
        own = found.isel(design=i)
        name = f"{plain(own['design'].item())}: " if n > 1 else ""
        ax.bar(
            np.arange(bins) + (i + 0.5) * 0.8 / n - 0.4,
            100 * own["contribution"].values,
            0.8 / n,
            color=series(i, n)["color"],
            label=f"{name}{float(own['annual_frequency']):.3g} per year",
        )
    edges = found["intensity_low"].values[1:]
    ax.set_xticks(np.arange(bins - 1) + 0.5, [f"{edge:g}" for edge in edges], rotation=45)
    ax.set(xlabel=intensity_label(dataset.attrs), ylabel="share of the annual frequency (%)")
    legend_above(ax, columns=1 if n > 1 else 2)
    return ax


def _condition(dataset: xr.Dataset) -> str:
    """Return the label of the probability."""
    quantity = str(dataset.attrs.get("quantity", "collapse"))
    if quantity == "collapse":
        return "P(collapse)"
    limit = dataset["limit"]
    unit = plain(limit.attrs.get("units", "1"))
    value = f"{float(np.ravel(limit.values)[0]):g}" + ("" if unit == "1" else f" {unit}")
    return f"P({_SYMBOLS.get(quantity, plain(quantity))} > {value})"


def intensity_label(attributes: dict[Any, Any]) -> str:
    """Return the label of an intensity axis."""
    kind, period = (attributes.get(key) for key in ("intensity", "intensity_period_s"))
    if kind is None:
        return "intensity"
    if kind == "peak_acceleration":
        return "PGA/g"
    if period is None:
        unit = plain(attributes.get("intensity_unit", "g"))
        label = plain(attributes.get("intensity_label", kind)).replace("_", " ")
        return label if unit == "g" else f"{label} ({unit})"
    damping = 100 * float(attributes["intensity_damping"])
    return f"$S_a$({float(period):.3g} s, {damping:.3g} %)$/g$"
