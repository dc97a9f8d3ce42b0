"""Figs 4 to 6: histories of one wall, with engines or with the frame alone beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from rwmf._simulation import simulate
from rwmf.case import Case
from rwmf.plotting.style import ALONE, COLOURS, DOTS, INK, NESTED, legend_below

from reproduce import drawing
from reproduce.engines import EngineHistory, read
from reproduce.formulations import EXACT, FORMULATIONS, PUBLISHED, Formulation
from reproduce.response_cache import ResponseCache

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["ENGINES", "RIGID", "VALIDATION", "draw_pulses", "draw_validation", "respond", "stored"]

# folder of stored histories, name in a legend
ENGINES = {
    "mujoco": "MuJoCo, rigid contact",
    "opensees": "OpenSees, no-tension corners",
    "calculix": "CalculiX, deformable wall",
}
# those whose wall does not deform
RIGID = ("mujoco", "opensees")
VALIDATION = ("free", "block", "g5", "g1800", "disc")
_MARKERS: dict[str, dict[str, Any]] = {
    "mujoco": {"marker": "o"},
    "opensees": {"marker": "s", "color": COLOURS[4], "markersize": 3.2},
    "calculix": {"marker": "x", "color": COLOURS[2], "markersize": 4, "markeredgewidth": 1.0},
}
# interval of an engine's dots and when they begin [s]: sparse enough to leave the lines visible,
# and those of the engines beside each other
_DOTS = 0.12
_FIRST_DOT = {"mujoco": 0.0, "opensees": 0.04, "calculix": 0.08}


def respond(cache: ResponseCache, name: str, form: Formulation) -> xr.Dataset:
    """Simulate a validation case in one of the forms."""
    case = Case.from_namelist(cache.validation / f"{name}.nml")
    if form is PUBLISHED:
        linear = {"cable": {"law": "linear"}} if case.cable is not None else {}
        impact = {"rule": "constant", "e": 0.9}
        case = case.replace(model={"formulation": "published"}, impact=impact, **linear)
    return simulate(case)


def stored(cache: ResponseCache, name: str) -> dict[str, EngineHistory]:
    """Read the histories that engines left for a validation case."""
    paths = {engine: cache.validation / engine / f"{name}.csv" for engine in ENGINES}
    return {engine: read(path) for engine, path in paths.items() if path.is_file()}


def draw_validation(figure: Figure, cache: ResponseCache, name: str) -> None:
    """Panels of Fig. 4 for a validation case (name): uplifts, angular velocity and u_s."""
    responses = {form: respond(cache, name, form) for form in FORMULATIONS}
    engines = stored(cache, name)
    has_frame = "u_s" in responses[EXACT]
    panels = figure.subplots(4 if has_frame else 3, 1, sharex=True)
    _draw_panels(panels, cache, name, responses, engines)
    legend_below(figure, panels[0], columns=2, title=NESTED)


def _draw_panels(
    panels: np.ndarray,
    cache: ResponseCache,
    name: str,
    responses: dict[Formulation, xr.Dataset],
    engines: dict[str, EngineHistory],
) -> None:
    b = Case.from_namelist(cache.validation / f"{name}.nml").wall.b
    labels = ("$v_{wl}$ (mm)", "$v_{wr}$ (mm)", r"$\dot\theta$ (rad/s)", "$u_s$ (m)")
    titles = ("uplift of the left corner", "uplift of the right corner", "angular velocity",
              "displacement of the frame")  # fmt: skip
    for form, response in responses.items():
        for ax, values in zip(panels, _rows(response, b), strict=False):
            ax.plot(response["time"], values, **drawing.style_of(form))
    for engine, history in engines.items():
        for ax, values in zip(panels, _engine_rows(history), strict=False):
            t = np.arange(_FIRST_DOT[engine], history["t_s"][-1], _DOTS)
            style = {**DOTS, **_MARKERS[engine], "label": ENGINES[engine]}
            ax.plot(t, np.interp(t, history["t_s"], values), **style)
    for ax, letter, title, label in zip(panels, "abcd", titles, labels, strict=False):
        drawing.column_title(ax, letter, title)
        ax.set_ylabel(label)
        ax.margins(x=0)
    panels[-1].set_xlabel(drawing.OVER_TIME)


def _rows(response: xr.Dataset, b: float) -> list[np.ndarray]:
    """Return the uplifts of the corners [mm], the angular velocity and the displacement."""
    theta = response["theta"].values
    uplift = 2e3 * b * np.sin(np.abs(theta))
    rows = [np.where(theta > 0, uplift, 0.0), np.where(theta < 0, uplift, 0.0)]
    rows.append(response["theta_dot"].values)
    return [*rows, response["u_s"].values] if "u_s" in response else rows


def _engine_rows(history: EngineHistory) -> list[np.ndarray]:
    rows = [1e3 * history["left_uplift_m"], 1e3 * history["right_uplift_m"]]
    rows.append(history["theta_dot_rad_s"])
    return [*rows, history["u_s_m"]] if "u_s_m" in history.columns else rows


def draw_pulses(figure: Figure, cache: ResponseCache, stem: str) -> None:
    """Figs 5 and 6: both pulses side by side; stem is the beginning of the names of the cases."""
    panels = figure.subplots(4, 2, sharex=True, sharey="row")
    for column, pulse in enumerate(("one_sine", "one_cosine")):
        _draw_pulse(panels[:, column], cache, stem, pulse)
        title = pulse.replace("_", "-") + " pulse"
        drawing.column_title(panels[0, column], "ab"[column], title)
    texts = (r"$\ddot u_g/g$", r"$\theta/\alpha$", r"$\dot\theta$ (rad/s)", "$u_s$ (m)")
    for ax, text in zip(panels[:, 0], texts, strict=True):
        ax.set_ylabel(text)
    legend_below(figure, panels[3, 0], title=NESTED)


def _draw_pulse(panels: np.ndarray, cache: ResponseCache, stem: str, pulse: str) -> None:
    name = f"{stem}_{pulse}"
    case = cache.case(name, EXACT)
    alpha = float(np.arctan2(case.wall.b, case.wall.h))
    for form in FORMULATIONS:
        response = cache.history(name, form)
        t, style = response["time"], drawing.style_of(form)
        panels[1].plot(t, response["theta"] / alpha, **style)
        panels[2].plot(t, response["theta_dot"], **style)
        panels[3].plot(t, response["u_s"], **style)
    _draw_ground(panels[0], response, case.model.g)
    alone = cache.frame_alone(f"{stem}_alone_{pulse}")
    panels[3].plot(alone["time"], alone["u_s"], **ALONE, label="frame alone")
    panels[3].set_xlabel(drawing.OVER_TIME)


def _draw_ground(ax: Axes, response: xr.Dataset, g: float) -> None:
    ax.plot(response["time"], response["u_g_ddot"] / g, color=INK, linewidth=1.0)
    ax.margins(x=0)
