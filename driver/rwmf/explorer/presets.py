"""Example cases of the page, each with one sentence."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import NamedTuple

from rwmf.case import Case

_FOLDER = Path(__file__).parent / "presets"


class Preset(NamedTuple):
    """An example case.

    Attributes
    ----------
    name : str
        File of the case without ``.nml``.
    title : str
        Title in the list.
    sentence : str
        Content of the case.
    """

    name: str
    title: str
    sentence: str


PRESETS = (
    Preset(
        "block",
        "Rocking block",
        "A free-standing block rocks under a pulse of 0.35 g; one of 0.40 g overturns it.",
    ),
    Preset(
        "wall_and_frame",
        "Wall and frame",
        "A tendon pulls a wall of 4 m back to its base, and the frame of one storey sways with it.",
    ),
    Preset(
        "six_storeys",
        "Six storeys",
        "Six storeys in kg and N yield beside a wall with twelve strands and two fuses.",
    ),
    Preset(
        "fig12_one_sine",
        "The paper's case",
        "Fig. 12 (a) of the paper: its equation as printed, and a forward pulse of 0.4 g.",
    ),
)
# case of `rwmf explore` without a file
FIRST = PRESETS[-1]


@cache
def case_of_preset(name: str) -> Case:
    """Read the case of a preset."""
    text = (_FOLDER / f"{name}.nml").read_text(encoding="utf-8")
    return Case.from_text(text, f"{name}.nml")
