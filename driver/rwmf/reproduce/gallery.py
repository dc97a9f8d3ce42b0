"""Every figure that the command can make, by the name that it is asked for."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from rwmf import figures
from rwmf.errors import InputError
from rwmf.reproduce import cable, histories, rotations, spectra
from rwmf.reproduce.workshop import Workshop

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["CAPTIONS", "FORMATS", "GALLERY", "find", "make"]

FORMATS = ("png", "svg")
Draw = Callable[[Workshop], "AbstractContextManager[Figure]"]

GALLERY: dict[str, Draw] = {
    "fig04": partial(histories.draw_validation, name="g1800"),
    "fig05": partial(histories.draw_pulses, stem="fig05_stiff_frame"),
    "fig06": partial(histories.draw_pulses, stem="fig06_mild_frame"),
    "fig07": partial(rotations.draw, comparison=rotations.FIG07),
    "fig08": partial(rotations.draw, comparison=rotations.FIG08),
    "fig09": partial(rotations.draw, comparison=rotations.FIG09),
    "fig10": partial(rotations.draw, comparison=rotations.FIG10),
    "fig11": cable.draw,
    "fig12": spectra.draw_fig12,
    "fig13": spectra.draw_fig13,
    "benefit": spectra.draw_benefit,
    "band": spectra.draw_band,
    "free": partial(histories.draw_validation, name="free"),
    "block": partial(histories.draw_validation, name="block"),
    "g5": partial(histories.draw_validation, name="g5"),
    "disc": partial(histories.draw_validation, name="disc"),
}
_PANELS = "uplift of the corners, angular velocity and displacement against contact engines"
CAPTIONS = {
    "fig04": f"Fig. 4: {_PANELS} (four-cycle sine, gamma = 1800, T_s = 0.4 s)",
    "fig05": "Fig. 5: stiff frame (T_s = 0.4 s, gamma = 1800) with and without wall",
    "fig06": "Fig. 6: mild frame (T_s = 1 s, gamma = 1800) with and without wall",
    "fig07": "Fig. 7: rotation with a stiff and a mild frame, one-cosine pulse",
    "fig08": "Fig. 8: rotation for three mass ratios, one-cosine pulse",
    "fig09": "Fig. 9: rotation of two walls, gamma = 5, one-cosine pulse",
    "fig10": "Fig. 10: rotation of two walls, gamma = 1800, one-cosine pulse",
    "fig11": "Fig. 11: increment of the cable force, one-cosine pulse",
    "fig12": "Fig. 12: displacement spectra, one-sine and one-cosine pulse",
    "fig13": "Fig. 13: displacement spectra, El Centro 1940 N-S",
    "benefit": "Does the wall help? Largest displacement over that of the frame alone",
    "band": "What the lost Table 1 may change: spectra over the properties of the cable",
    "free": "Validation: a wall let go at half of its slenderness angle",
    "block": "Validation: a free-standing wall under a one-sine pulse of 0.30 g",
    "g5": f"Validation: {_PANELS} (gamma = 5, T_s = 1 s, one-cosine); "
    "the deformable wall vibrates after an impact, the model's cannot",
    "disc": f"Validation: {_PANELS} (squat wall, stiff cable, gamma = 5, T_s = 2 s)",
}


def find(word: str) -> str:
    """Return the figure that a word of the command line names.

    Parameters
    ----------
    word : str
        Name in the gallery, or a number of the paper: ``4``, ``fig4`` or ``fig04``.

    Returns
    -------
    str
        Name in the gallery.

    Raises
    ------
    InputError
        When there is no such figure.
    """
    name = word.lower()
    if match := re.fullmatch(r"(?:fig\.?)?0*(\d+)", name):
        name = f"fig{int(match[1]):02d}"
    if name not in GALLERY:
        raise InputError(f"{word!r} is not a figure; these are {', '.join(GALLERY)}")
    return name


def make(work: Workshop, name: str, folder: Path) -> list[Path]:
    """Draw a figure into a folder, in every format of `FORMATS`.

    Parameters
    ----------
    work : Workshop
        Where responses come from.
    name : str
        Name in the gallery.
    folder : path
        Existing folder.

    Returns
    -------
    list of path
        The files.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As the simulations and the writer of figures.
    """
    paths = [folder / f"{name}.{kind}" for kind in FORMATS]
    with GALLERY[name](work) as figure:
        for path in paths:
            figures.save(figure, path)
    return paths
