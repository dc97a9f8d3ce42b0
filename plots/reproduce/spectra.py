"""Figs 12 and 13: benefit and cost of the wall, and possible influence of the lost Table 1."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from rwmf.plotting.style import ALONE, INK, LEVEL, NESTED, legend_below

from reproduce import drawing
from reproduce.formulations import ETAS, FORMULATIONS, PUBLISHED, SHIPPED_ETAS, Formulation
from reproduce.response_cache import COARSE, ResponseCache

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["SCENES", "draw_band", "draw_benefit", "draw_fig12", "draw_fig13", "periods"]

# name of the namelist, title
SCENES = {
    "fig12_one_sine": "one-sine pulse",
    "fig12_one_cosine": "one-cosine pulse",
    "fig13_elcentro_slender_wall": r"El Centro, $\tan\alpha$ = 0.5/2",
    "fig13_elcentro_squat_wall": r"El Centro, $\tan\alpha$ = 1/2",
}
_PULSES, _RECORDS = tuple(SCENES)[:2], tuple(SCENES)[2:]
# in the exact form the impacts of a light wall hardly end: every second period is enough to see
_FINE = tuple(float(T_s) for T_s in np.round(np.linspace(0.05, 3.0, 119), 10))
_LABEL = r"$u_{s,\max}$ (m)"


def periods(form: Formulation) -> tuple[float, ...] | None:
    """Return the periods of a drawn spectrum [s]; None for those of the case."""
    return None if form is PUBLISHED else _FINE


def draw_fig12(figure: Figure, cache: ResponseCache) -> None:
    """Fig. 12: pulses side by side, a row for each form."""
    panels = figure.subplots(2, 2, sharex=True, sharey=True)
    _draw_spectra(panels, cache, _PULSES)
    legend_below(figure, panels[0, 0], columns=6, title=NESTED)


def draw_fig13(figure: Figure, cache: ResponseCache) -> None:
    """Fig. 13: both walls side by side, a row for each form, and the record."""
    grid = figure.add_gridspec(3, 2, height_ratios=(1, 1, 0.5))
    panels = np.empty((2, 2), dtype=object)
    for i, j in np.ndindex(2, 2):
        panels[i, j] = figure.add_subplot(grid[i, j], sharex=panels[0, 0], sharey=panels[0, 0])
    _draw_spectra(panels, cache, _RECORDS)
    for ax in panels[0]:
        ax.tick_params(labelbottom=False)
    for ax in panels[:, 1]:
        ax.tick_params(labelleft=False)
    _draw_record(figure.add_subplot(grid[2, :]), cache)
    legend_below(figure, panels[0, 0], columns=6, title=NESTED)


def _draw_spectra(panels: np.ndarray, cache: ResponseCache, names: tuple[str, ...]) -> None:
    for j, name in enumerate(names):
        alone = cache.spectrum_alone(name)
        for i, form in enumerate(FORMULATIONS):
            ax = panels[i, j]
            for style, curve in _curves(cache.spectrum(name, form, T_s=periods(form))):
                ax.plot(curve["T_s"], curve["u_s_max"], **style)
            ax.plot(alone["T_s"], alone["u_s_max"], **ALONE, label="frame alone")
            ax.margins(x=0)
            if j == 1:
                drawing.row_label(ax, form.label)
        drawing.column_title(panels[0, j], "ab"[j], SCENES[name])
        panels[1, j].set_xlabel(r"$T_s$ (s)")
    for ax in panels[:, 0]:
        ax.set_ylabel(_LABEL)
        ax.set_ylim(bottom=0)


def _curves(dataset: xr.Dataset) -> Iterator[tuple[dict[str, Any], xr.Dataset]]:
    """Give the style and the values for each mass ratio."""
    for j, gamma in enumerate(dataset["gamma"].values):
        yield drawing.style_of_mass_ratio(float(gamma)), dataset.isel(b=0, gamma=j)


def _draw_record(ax: Axes, cache: ResponseCache) -> None:
    case = cache.case(_RECORDS[0], PUBLISHED)
    response = cache.history(_RECORDS[0], PUBLISHED)
    ax.plot(response["time"], response["u_g_ddot"] / case.model.g, color=INK, linewidth=0.6)
    drawing.column_title(ax, "c", "El Centro 1940 N-S, textbook version")
    ax.set_xlabel(drawing.OVER_TIME)
    ax.set_ylabel(r"$\ddot u_g/g$")
    ax.margins(x=0)


def draw_benefit(figure: Figure, cache: ResponseCache) -> None:
    """Draw the largest displacement over that of the frame alone: below 1 the wall helps."""
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    lines: dict[float, object] = {}
    for i, name in enumerate(SCENES):
        for j, form in enumerate(FORMULATIONS):
            lines |= _draw_ratios(panels[i, j], cache, name, form)
        panels[i, 0].set_ylabel("with / without wall")
        drawing.row_label(panels[i, 1], SCENES[name])
    for ax, form, letter in zip(panels[0], FORMULATIONS, "ab", strict=True):
        drawing.column_title(ax, letter, form.label)
    panels[0, 0].set_ylim(0.2, 1.6)
    for ax in panels[-1]:
        ax.set_xlabel(r"$T_s$ (s)")
    known = [lines[gamma] for gamma in sorted(lines)]
    figure.legend(handles=known, loc="outside lower center", ncols=6, title=NESTED)


def _draw_ratios(
    ax: Axes, cache: ResponseCache, name: str, form: Formulation
) -> dict[float, object]:
    """Draw one panel and return its lines by mass ratio."""
    response = cache.spectrum(name, form, T_s=periods(form))
    alone = cache.spectrum_alone(name, periods(form))["u_s_max"].values
    lines: dict[float, object] = {}
    for style, curve in _curves(response):
        ratio = curve["u_s_max"].values / alone
        (lines[float(curve["gamma"])],) = ax.plot(curve["T_s"], ratio, **style)
    ax.axhline(1.0, **LEVEL)
    ax.margins(x=0)
    return lines


def draw_band(figure: Figure, cache: ResponseCache) -> None:
    """Draw the band of the published spectra over the cables that Table 1 may have held."""
    panels = figure.subplots(2, 2, sharex=True, sharey="row")
    for ax, letter, (name, title) in zip(panels.flat, "abcd", SCENES.items(), strict=True):
        _draw_bands(ax, cache, name)
        drawing.column_title(ax, letter, title)
        ax.margins(x=0)
    for row, top in zip(panels, (0.7, 0.4), strict=True):
        row[0].set_ylim(0.0, top)
        row[0].set_ylabel(_LABEL)
    for ax in panels[-1]:
        ax.set_xlabel(r"$T_s$ (s)")
    pairs = ", ".join(f"({first:g}, {last:g})" for first, last in ETAS)
    text = (
        f"{PUBLISHED.label}; lines: $(\\eta_0, \\eta_\\alpha)$ = (1, 5); bands: {pairs}\n"
        "crosses: the wall overturns with one of these cables, the band is that of the others"
    )
    legend_below(figure, panels[0, 0], title=text)


def _draw_bands(ax: Axes, cache: ResponseCache, name: str) -> None:
    spectra = [cache.spectrum(name, PUBLISHED, etas, COARSE).isel(b=0) for etas in ETAS]
    for gamma, height in ((5.0, 0.97), (100.0, 0.93), (2000.0, 0.89)):
        style = drawing.style_of_mass_ratio(gamma)
        curves = [spectrum.sel(gamma=gamma) for spectrum in spectra]
        fallen = np.array([curve["status"].values == "overturned" for curve in curves])
        values = np.array([curve["u_s_max"].values for curve in curves])
        # a wall on its side has no displacement to compare
        standing = np.ma.masked_where(fallen, values)
        ax.fill_between(
            COARSE,
            standing.min(axis=0),
            standing.max(axis=0),
            color=style["color"],
            alpha=0.25,
            lw=0,
        )
        ax.plot(COARSE, values[ETAS.index(SHIPPED_ETAS)], **style)
        times = np.array(COARSE)[fallen.any(axis=0)]
        place = np.full(times.size, height)
        transform = ax.get_xaxis_transform()
        ax.plot(times, place, "x", color=style["color"], markersize=3, transform=transform)
