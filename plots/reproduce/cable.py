"""Fig. 11: force increment of the cable while the wall rocks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from rwmf.plotting.style import NESTED, legend_below, series

from reproduce import drawing
from reproduce.formulations import FORMULATIONS, SHIPPED_ETAS, Formulation
from reproduce.response_cache import ResponseCache

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["PERIODS", "draw", "increments"]

# frames of the histories: name in the inputs, period [s]
_FRAMES = {"stiff": 0.4, "mild": 1.0, "flexible": 2.0}
_WALLS = {"heavy": 5, "light": 1800}
PERIODS = tuple(float(T_s) for T_s in np.round(np.linspace(0.2, 3.0, 57), 10))


def increments(
    cache: ResponseCache,
    form: Formulation,
    gamma: float,
    etas: tuple[float, float] = SHIPPED_ETAS,
) -> np.ndarray:
    """Compute the largest increment of the cable force over the periods of the frame."""
    name = "fig11_cable_stiff_frame_heavy_wall"
    found = []
    for T_s in PERIODS:
        changes = {"frame": {"T_s": T_s, "gamma": float(gamma)}, "output": None}
        response = cache.history(name, form, etas, changes)
        found.append(float(response["cable_force_increment_max_over_m_w_g"]))
    return np.array(found)


def draw(figure: Figure, cache: ResponseCache) -> None:
    """Fig. 11: histories for three frames and two walls, and the maximum over all periods."""
    grid = figure.add_gridspec(2, 3, height_ratios=(1, 1.25))
    panels: list[Axes] = []
    for column, frame in enumerate(_FRAMES):
        first = panels[0] if panels else None
        ax = figure.add_subplot(grid[0, column], sharey=first, sharex=first)
        panels.append(ax)
        _draw_histories(ax, cache, frame, "abc"[column])
        ax.tick_params(labelleft=column == 0)
    panels[0].set_ylabel(r"$P/(m_w g) - \eta_0$")
    ax = figure.add_subplot(grid[1, :])
    _draw_maxima(ax, cache)
    legend_below(figure, ax, columns=2, title=NESTED)


def _style(form: Formulation, gamma: float) -> dict[str, Any]:
    walls = list(_WALLS.values())
    i = len(FORMULATIONS) * walls.index(int(gamma)) + FORMULATIONS.index(form)
    line_style = series(i, len(FORMULATIONS) * len(walls))
    return {**line_style, "label": rf"$\gamma$ = {gamma}, {form.label}"}


def _draw_histories(ax: Axes, cache: ResponseCache, frame: str, letter: str) -> None:
    for wall, gamma in _WALLS.items():
        for form in FORMULATIONS:
            response = cache.history(f"fig11_cable_{frame}_frame_{wall}_wall", form)
            increment = response["cable_force_over_m_w_g"] - SHIPPED_ETAS[0]
            ax.plot(response["time"], increment, **_style(form, gamma))
    drawing.column_title(ax, letter, rf"$T_s$ = {_FRAMES[frame]:g} s")
    ax.set_xlabel(drawing.OVER_TIME)
    ax.set_xlim(0.0, 6.0)


def _draw_maxima(ax: Axes, cache: ResponseCache) -> None:
    for gamma in _WALLS.values():
        for form in FORMULATIONS:
            ax.plot(PERIODS, increments(cache, form, gamma), **_style(form, gamma))
    case = cache.case("fig11_cable_stiff_frame_heavy_wall", FORMULATIONS[0])
    newton = case.wall.m_w * case.model.g
    right = ax.secondary_yaxis(
        "right",
        functions=(
            lambda x: np.asarray(x) * newton / 1e3,
            lambda y: np.asarray(y) * 1e3 / newton,
        ),
    )
    right.set_ylabel(rf"$P - P_0$ (kN), $m_w$ = {case.wall.m_w:g} kg")
    right.grid(False)
    drawing.column_title(ax, "d", "largest increment over the period of the frame")
    ax.set_xlabel(r"$T_s$ (s)")
    ax.set_ylabel(r"max $P/(m_w g) - \eta_0$")
    ax.margins(x=0)
    ax.set_ylim(bottom=0)
