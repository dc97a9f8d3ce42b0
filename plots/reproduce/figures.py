"""Figures of the command, by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from rwmf.errors import InputError
from rwmf.figures import image_files
from rwmf.figures.styles import (
    ALONE,
    COLOURS,
    DOTS,
    INK,
    LEVEL,
    NESTED,
    legend_below,
    new_figure,
    series,
)
from rwmf.kernel.names import shorten
from rwmf.run.spectrum import start

from reproduce.engines import ENGINES, stored
from reproduce.responses import (
    FORMULATIONS,
    PERIODS,
    PUBLISHED,
    SHIPPED_ETAS,
    Formulation,
    Responses,
    View,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FIGURES", "FORMATS", "SCENES", "Recipe", "find", "make", "write_spectra"]

FORMATS = ("png", "svg")
# spectra: name of the namelist, title
SCENES = {
    "fig12_one_sine": "one-sine pulse",
    "fig12_one_cosine": "one-cosine pulse",
    "fig13_elcentro_slender_wall": r"El Centro, $\tan\alpha$ = 0.5/2",
    "fig13_elcentro_squat_wall": r"El Centro, $\tan\alpha$ = 1/2",
}
_FINE = tuple(float(T_s) for T_s in np.round(np.linspace(0.05, 3.0, 119), 10))
# every mass ratio of the spectra, from the heaviest wall to the lightest
_MASS_RATIOS = (5.0, 10.0, 100.0, 1000.0, 2000.0, 20000.0)
_MARKERS: dict[str, dict[str, Any]] = {
    "mujoco": {"marker": "o"},
    "opensees": {"marker": "s", "color": COLOURS[4], "markersize": 3.2},
    "calculix": {"marker": "x", "color": COLOURS[2], "markersize": 4, "markeredgewidth": 1.0},
}
# interval of an engine's dots and when they begin [s]: sparse enough to leave the lines visible,
# and those of the engines beside each other
_DOTS = 0.12
_FIRST_DOT = {"mujoco": 0.0, "opensees": 0.04, "calculix": 0.08}
_T, _T_S, _U_S = r"$t$ (s)", r"$T_s$ (s)", r"$u_{s,\max}$ (m)"
_OVER_ALPHA = r"$\theta/\alpha$"
_STIFF, _MILD = r"$T_s$ = 0.4 s", r"$T_s$ = 1 s"


def _style_of(form: Formulation) -> dict[str, Any]:
    return {**series(FORMULATIONS.index(form), len(FORMULATIONS)), "label": form.label}


def _style_of_mass_ratio(gamma: float) -> dict[str, Any]:
    """Return style and label of a mass ratio: the same in every figure."""
    line_style = series(_MASS_RATIOS.index(gamma), len(_MASS_RATIOS))
    return {**line_style, "label": rf"$\gamma$ = {gamma:g}"}


def _label_rows(panels: np.ndarray, texts: Iterable[str]) -> None:
    """Write the label of a row of panels to the right of its last panel."""
    for ax, text in zip(panels[:, -1], texts, strict=True):
        ax.text(1.03, 0.5, text, transform=ax.transAxes, rotation=270, va="center", ha="left")


def _title(panels: Iterable[Axes], texts: Iterable[str]) -> None:
    """Write the titles of panels, with the letters of the paper."""
    for ax, letter, text in zip(panels, "abcd", texts, strict=False):
        ax.set_title(f"({letter}) {text}")


def _label(panels: Iterable[Axes], x: str | None = None, y: Sequence[str] | None = None) -> None:
    """Label the axes of panels: one x for all, one y for each."""
    for i, ax in enumerate(panels):
        if x is not None:
            ax.set_xlabel(x)
        if y is not None:
            ax.set_ylabel(y[i % len(y)])


def _draw_engines(figure: Figure, of: Responses) -> None:
    """Fig. 4: uplifts, angular velocity and u_s."""
    name = "g1800"
    b, histories = of.engine_case(name).wall.b, stored(of, name)
    panels = figure.subplots(4, 1, sharex=True)
    for form in FORMULATIONS:
        response = View(of, form).engine_case(name)
        theta = response["theta"].values
        uplift = 2e3 * b * np.sin(np.abs(theta))
        rows = [np.where(theta > 0, uplift, 0.0), np.where(theta < 0, uplift, 0.0)]
        rows += [response[key].values for key in ("theta_dot", "u_s")]
        for ax, values in zip(panels, rows, strict=True):
            ax.plot(response["time"], values, **_style_of(form))
    for engine, history in histories.items():
        t = np.arange(_FIRST_DOT[engine], history["t_s"][-1], _DOTS)
        style = {**DOTS, **_MARKERS[engine], "label": ENGINES[engine]}
        columns = ("left_uplift_m", "right_uplift_m", "theta_dot_rad_s", "u_s_m")
        for ax, key, scale in zip(panels, columns, (1e3, 1e3, 1, 1), strict=True):
            ax.plot(t, np.interp(t, history["t_s"], scale * history[key]), **style)
    _title(panels, ("uplift of the left corner", "uplift of the right corner", "angular velocity",
                    "displacement of the frame"))  # fmt: skip
    _label(panels, y=("$v_{wl}$ (mm)", "$v_{wr}$ (mm)", r"$\dot\theta$ (rad/s)", "$u_s$ (m)"))
    for ax in panels:
        ax.margins(x=0)
    panels[-1].set_xlabel(_T)
    legend_below(figure, panels[0], columns=2, title=NESTED)


def _draw_pulses(figure: Figure, of: Responses, stem: str) -> None:
    """Figs 5 and 6: both pulses side by side; stem is the beginning of the names of the cases."""
    panels = figure.subplots(4, 2, sharex=True, sharey="row")
    pulses = ("one_sine", "one_cosine")
    for column, pulse in zip(panels.T, pulses, strict=True):
        name = f"{stem}_{pulse}"
        case = of.shipped(name)
        alpha = float(np.arctan2(case.wall.b, case.wall.h))
        for form in FORMULATIONS:
            response, style = View(of, form).history(name), _style_of(form)
            column[1].plot(response["time"], response["theta"] / alpha, **style)
            column[2].plot(response["time"], response["theta_dot"], **style)
            column[3].plot(response["time"], response["u_s"], **style)
        ground = response["u_g_ddot"] / case.model.g
        column[0].plot(response["time"], ground, color=INK, linewidth=1.0)
        column[0].margins(x=0)
        alone = of.alone(f"{stem}_alone_{pulse}")
        column[3].plot(alone["time"], alone["u_s"], **ALONE, label="frame alone")
    _title(panels[0], (f"{pulse.replace('_', '-')} pulse" for pulse in pulses))
    _label(panels[3], _T)
    _label(panels[:, 0], y=(r"$\ddot u_g/g$", r"$\theta/\alpha$", r"$\dot\theta$ (rad/s)",
                            "$u_s$ (m)"))  # fmt: skip
    legend_below(figure, panels[3, 0], title=NESTED)


def _draw_rotations(
    figure: Figure, of: Responses, columns: dict[str, tuple[str, ...]], labels: tuple[str, ...],
    y: str = _OVER_ALPHA,
) -> None:  # fmt: skip
    """Figs 7 to 10: a column for each title with its cases, a row for each form."""
    panels = figure.subplots(2, len(columns), sharex=True, sharey="col", squeeze=False)
    for (i, j), ax in np.ndenumerate(panels):
        view, names = View(of, FORMULATIONS[i]), list(columns.values())[j]
        for k, (name, text) in enumerate(zip(names, labels, strict=True)):
            # later the rotations are too small to see
            response, wall = view.history(name).sel(time=slice(0.0, 8.0)), of.shipped(name).wall
            scale = float(np.arctan2(wall.b, wall.h)) if "alpha" in y else 1.0
            ax.plot(
                response["time"], response["theta"] / scale, **series(k, len(names)), label=text
            )
        ax.margins(x=0)
    _label_rows(panels, (form.label for form in FORMULATIONS))
    if len(columns) > 1:
        _title(panels[0], columns)
    else:
        panels[0, 0].set_title(*columns)
    _label(panels[1], _T)
    _label(panels[:, 0], y=(y,))
    legend_below(figure, panels[0, 0], title=NESTED)


def _draw_cable(figure: Figure, of: Responses) -> None:
    """Fig. 11: histories for three frames and two walls, and the maximum over all periods."""
    frames, walls = {"stiff": 0.4, "mild": 1.0, "flexible": 2.0}, {"heavy": 5, "light": 1800}
    styles = [
        (View(of, form), wall, gamma,
         {**series(i, 4), "label": rf"$\gamma$ = {gamma}, {form.label}"})
        for i, ((wall, gamma), form) in enumerate(product(walls.items(), FORMULATIONS))
    ]  # fmt: skip
    grid = figure.add_gridspec(2, 3, height_ratios=(1, 1.25))
    panels: list[Axes] = []
    for column, frame in enumerate(frames):
        first = panels[0] if panels else None
        ax = figure.add_subplot(grid[0, column], sharey=first, sharex=first)
        for view, wall, _, style in styles:
            response = view.history(f"fig11_cable_{frame}_frame_{wall}_wall")
            ax.plot(response["time"], response["cable_force_over_m_w_g"] - SHIPPED_ETAS[0], **style)
        ax.set_xlim(0.0, 6.0)
        ax.tick_params(labelleft=column == 0)
        panels.append(ax)
    panels[0].set_ylabel(r"$P/(m_w g) - \eta_0$")
    _label(panels, _T)
    ax = figure.add_subplot(grid[1, :])
    for view, _, gamma, style in styles:
        ax.plot(PERIODS, view.increments(float(gamma)), **style)
    case = of.shipped("fig11_cable_stiff_frame_heavy_wall")
    newton = case.wall.m_w * case.model.g
    scales = (lambda x: np.asarray(x) * newton / 1e3, lambda y: np.asarray(y) * 1e3 / newton)
    right = ax.secondary_yaxis("right", functions=scales)
    right.set_ylabel(rf"$P - P_0$ (kN), $m_w$ = {case.wall.m_w:g} kg")
    right.grid(False)
    _label([ax], _T_S, (r"max $P/(m_w g) - \eta_0$",))
    ax.margins(x=0)
    ax.set_ylim(bottom=0)
    titles = [rf"$T_s$ = {T_s:g} s" for T_s in frames.values()]
    _title([*panels, ax], [*titles, "largest increment over the period of the frame"])
    legend_below(figure, ax, columns=2, title=NESTED)


def _draw_curves(
    ax: Axes, of: Responses, name: str, form: Formulation, *, is_ratio: bool = False
) -> None:
    """Draw a spectrum, a line for each mass ratio, or its ratio to that of the frame alone."""
    # in the exact form the impacts of a light wall hardly end: every second period shows enough
    periods = None if form is PUBLISHED else _FINE
    found = View(of, form).spectrum(name, periods)
    alone = of.spectrum_alone(name, periods) if is_ratio else 1.0
    for j, gamma in enumerate(found["gamma"].values):
        values = found["u_s_max"].isel(b=0, gamma=j).values / alone
        ax.plot(found["T_s"], values, **_style_of_mass_ratio(float(gamma)))
    ax.margins(x=0)


def _draw_spectra(figure: Figure, of: Responses, names: tuple[str, ...], record: str = "") -> None:
    """Figs 12 and 13: two cases side by side, a row for each form, and the record."""
    grid = figure.add_gridspec(
        3 if record else 2, 2, height_ratios=(1, 1, 0.5)[: 3 if record else 2]
    )
    panels = np.empty((2, 2), dtype=object)
    for (i, form), (j, name) in product(enumerate(FORMULATIONS), enumerate(names)):
        ax = figure.add_subplot(grid[i, j], sharex=panels[0, 0], sharey=panels[0, 0])
        _draw_curves(ax, of, name, form)
        T_s = View(of, PUBLISHED).spectrum(name)["T_s"]
        ax.plot(T_s, of.spectrum_alone(name), **ALONE, label="frame alone")
        ax.tick_params(labelbottom=i == 1, labelleft=j == 0)
        panels[i, j] = ax
    titled = list(panels[0])
    if record:
        ax = figure.add_subplot(grid[2, :])
        case, response = of.shipped(names[0]), View(of, PUBLISHED).history(names[0])
        ax.plot(response["time"], response["u_g_ddot"] / case.model.g, color=INK, linewidth=0.6)
        ax.margins(x=0)
        _label([ax], _T, (r"$\ddot u_g/g$",))
        titled.append(ax)
    _title(titled, [*(SCENES[name] for name in names), record])
    _label_rows(panels, (form.label for form in FORMULATIONS))
    _label(panels[1], _T_S)
    _label(panels[:, 0], y=(_U_S,))
    panels[0, 0].set_ylim(bottom=0)
    legend_below(figure, panels[0, 0], columns=6, title=NESTED)


def _draw_benefit(figure: Figure, of: Responses) -> None:
    """Draw the largest displacement over that of the frame alone: below 1 the wall helps."""
    panels = figure.subplots(4, 2, sharex=True, sharey=True)
    for (i, name), (j, form) in product(enumerate(SCENES), enumerate(FORMULATIONS)):
        _draw_curves(panels[i, j], of, name, form, is_ratio=True)
        panels[i, j].axhline(1.0, **LEVEL)
    _label_rows(panels, SCENES.values())
    _title(panels[0], (form.label for form in FORMULATIONS))
    _label(panels[:, 0], y=("with / without wall",))
    _label(panels[-1], _T_S)
    panels[0, 0].set_ylim(0.2, 1.6)
    lines = {line.get_label(): line for ax in panels.flat for line in ax.lines}
    known = [lines[label] for gamma in _MASS_RATIOS
             if (label := _style_of_mass_ratio(gamma)["label"]) in lines]  # fmt: skip
    figure.legend(handles=known, loc="outside lower center", ncols=6, title=NESTED)


class Recipe(NamedTuple):
    """A figure: a function that draws into an empty one, its height [inch], a description."""

    draw: Callable[[Figure, Responses], None]
    height: float
    caption: str


_RATIOS = tuple(rf"$\gamma$ = {n}" for n in (5, 100, 1800))


def _rotations(
    caption: str, stem: str, ends: Sequence[str] = ("slender_wall", "squat_wall"),
    labels: tuple[str, ...] = ("$b$ = 0.5 m", "$b$ = 1 m"), y: str = r"$\theta$ (rad)",
) -> Recipe:  # fmt: skip
    """Return the recipe of a figure with columns for the stiff and the mild frame."""
    columns = {
        title: tuple(f"{stem}_{frame}_frame_{end}" for end in ends)
        for title, frame in ((_STIFF, "stiff"), (_MILD, "mild"))
    }
    return Recipe(partial(_draw_rotations, columns=columns, labels=labels, y=y), 4.6, caption)


FIGURES: dict[str, Recipe] = {
    "fig04": Recipe(
        _draw_engines, 7.4,
        "Fig. 4: uplift of the corners, angular velocity and displacement against contact engines "
        "(four-cycle sine, gamma = 1800, T_s = 0.4 s); "
        "the deformable wall vibrates after an impact, the model's cannot",
    ),
    "fig05": Recipe(
        partial(_draw_pulses, stem="fig05_stiff_frame"), 7.2,
        "Fig. 5: stiff frame (T_s = 0.4 s, gamma = 1800) with and without wall",
    ),
    "fig06": Recipe(
        partial(_draw_pulses, stem="fig06_mild_frame"), 7.2,
        "Fig. 6: mild frame (T_s = 1 s, gamma = 1800) with and without wall",
    ),
    "fig07": Recipe(
        partial(
            _draw_rotations, labels=(_STIFF, _MILD),
            columns={r"$\gamma$ = 1800": ("fig07_rocking_with_stiff_frame",
                                          "fig07_rocking_with_mild_frame")},
        ), 4.6, "Fig. 7: rotation with a stiff and a mild frame, one-cosine pulse",
    ),
    "fig08": _rotations(
        "Fig. 8: rotation for three mass ratios, one-cosine pulse", "fig08",
        [f"mass_ratio_{n}" for n in (5, 100, 1800)], _RATIOS, _OVER_ALPHA,
    ),
    "fig09": _rotations(
        "Fig. 9: rotation of two walls, gamma = 5, one-cosine pulse", "fig09"
    ),
    "fig10": _rotations(
        "Fig. 10: rotation of two walls, gamma = 1800, one-cosine pulse", "fig10"
    ),
    "fig11": Recipe(_draw_cable, 5.8, "Fig. 11: increment of the cable force, one-cosine pulse"),
    "fig12": Recipe(
        partial(_draw_spectra, names=tuple(SCENES)[:2]), 5.8,
        "Fig. 12: displacement spectra, one-sine and one-cosine pulse",
    ),
    "fig13": Recipe(
        partial(_draw_spectra, names=tuple(SCENES)[2:],
                record="El Centro 1940 N-S, textbook version"),
        7.2, "Fig. 13: displacement spectra, El Centro 1940 N-S",
    ),
    "benefit": Recipe(
        _draw_benefit, 7.8, "Does the wall help? Largest displacement over that of the frame alone"
    ),
}  # fmt: skip


def find(word: str) -> str:
    """Return the figure that a word of the command line names."""
    name = word.lower()
    if match := re.fullmatch(r"(?:fig\.?)?0*(\d{1,2})", name):
        name = f"fig{int(match[1]):02d}"
    if name not in FIGURES:
        raise InputError(f"{shorten(word)!r} is not a figure; these are {', '.join(FIGURES)}")
    return name


def make(of: Responses, name: str, folder: Path) -> list[Path]:
    """Draw a figure into a folder, in every format of `FORMATS`."""
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    recipe = FIGURES[name]
    with new_figure(recipe.height) as figure:
        recipe.draw(figure, of)
        figure.align_ylabels()
        for path in paths:
            image_files.save(figure, path)
    return paths


def write_spectra(of: Responses, folder: Path) -> None:
    """Write the shipped spectra as ``NAME.csv`` and, of the exact form, ``NAME_exact.csv``."""
    for name, (form, end) in product(SCENES, zip(FORMULATIONS, ("", "_exact"), strict=True)):
        case = of.shipped(name).replace(**form.changes)
        with start(case, 0, None) as sweep:
            sweep.write(case.text, str(folder / f"{name}{end}.csv"))
