"""Figures of the command, by name."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rwmf._files.names import shorten
from rwmf.errors import InputError
from rwmf.plotting import image_files as figures
from rwmf.plotting.style import new_figure

from reproduce import cable, histories, rotations, six_storeys_figure, spectra
from reproduce.response_cache import ResponseCache

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FIGURES", "FORMATS", "FigureRecipe", "find", "make"]

FORMATS = ("png", "svg")


@dataclass(frozen=True)
class FigureRecipe:
    """One figure of the figures.

    Attributes
    ----------
    draw : callable
        Draws the responses into an empty figure.
    height : float
        Height [inch].
    caption : str
        Description of the figure.
    """

    draw: Callable[[Figure, ResponseCache], None]
    height: float
    caption: str


_PANELS = "uplift of the corners, angular velocity and displacement against contact engines"


def _validation(name: str, caption: str, height: float = 7.4) -> FigureRecipe:
    return FigureRecipe(partial(histories.draw_validation, name=name), height, caption)


def _pulses(stem: str, caption: str) -> FigureRecipe:
    return FigureRecipe(partial(histories.draw_pulses, stem=stem), 7.2, caption)


def _rotations(comparison: rotations.Comparison, caption: str) -> FigureRecipe:
    return FigureRecipe(partial(rotations.draw, comparison=comparison), 4.6, caption)


FIGURES: dict[str, FigureRecipe] = {
    "fig04": _validation(
        "g1800",
        f"Fig. 4: {_PANELS} (four-cycle sine, gamma = 1800, T_s = 0.4 s); "
        "the deformable wall vibrates after an impact, the model's cannot",
    ),
    "fig05": _pulses(
        "fig05_stiff_frame",
        "Fig. 5: stiff frame (T_s = 0.4 s, gamma = 1800) with and without wall",
    ),
    "fig06": _pulses(
        "fig06_mild_frame", "Fig. 6: mild frame (T_s = 1 s, gamma = 1800) with and without wall"
    ),
    "fig07": _rotations(
        rotations.FIG07, "Fig. 7: rotation with a stiff and a mild frame, one-cosine pulse"
    ),
    "fig08": _rotations(
        rotations.FIG08, "Fig. 8: rotation for three mass ratios, one-cosine pulse"
    ),
    "fig09": _rotations(
        rotations.FIG09, "Fig. 9: rotation of two walls, gamma = 5, one-cosine pulse"
    ),
    "fig10": _rotations(
        rotations.FIG10, "Fig. 10: rotation of two walls, gamma = 1800, one-cosine pulse"
    ),
    "fig11": FigureRecipe(
        cable.draw, 5.8, "Fig. 11: increment of the cable force, one-cosine pulse"
    ),
    "fig12": FigureRecipe(
        spectra.draw_fig12,
        5.8,
        "Fig. 12: displacement spectra, one-sine and one-cosine pulse",
    ),
    "fig13": FigureRecipe(
        spectra.draw_fig13, 7.2, "Fig. 13: displacement spectra, El Centro 1940 N-S"
    ),
    "benefit": FigureRecipe(
        spectra.draw_benefit,
        7.8,
        "Does the wall help? Largest displacement over that of the frame alone",
    ),
    "band": FigureRecipe(
        spectra.draw_band,
        5.8,
        "Possible influence of the lost Table 1: spectra over the properties of the cable",
    ),
    "free": _validation("free", "Validation: a wall let go at half of its slenderness angle", 5.8),
    "block": _validation(
        "block", "Validation: a free-standing wall under a one-sine pulse of 0.30 g", 5.8
    ),
    "g5": _validation("g5", f"Validation: {_PANELS} (gamma = 5, T_s = 1 s, one-cosine)"),
    "disc": _validation(
        "disc", f"Validation: {_PANELS} (squat wall, stiff cable, gamma = 5, T_s = 2 s)"
    ),
    "six_storeys": FigureRecipe(
        six_storeys_figure.draw,
        6.4,
        "Validation: six storeys with and without yielding and P-Delta against OpenSees",
    ),
}


def find(word: str) -> str:
    """Return the figure that a word of the command line names."""
    name = word.lower()
    if match := re.fullmatch(r"(?:fig\.?)?0*(\d{1,2})", name):
        name = f"fig{int(match[1]):02d}"
    if name not in FIGURES:
        raise InputError(f"{shorten(word)!r} is not a figure; these are {', '.join(FIGURES)}")
    return name


def make(cache: ResponseCache, name: str, folder: Path) -> list[Path]:
    """Draw a figure into a folder, in every format of `FORMATS`."""
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    recipe = FIGURES[name]
    with new_figure(recipe.height) as figure:
        recipe.draw(figure, cache)
        figure.align_ylabels()
        for path in paths:
            figures.save(figure, path)
    return paths
