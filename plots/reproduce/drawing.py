"""Shared styles of the reproduced figures: forms, mass ratios, panel names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rwmf.plotting.style import series

from reproduce.formulations import FORMULATIONS, Formulation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = [
    "OVER_TIME",
    "column_title",
    "row_label",
    "style_of",
    "style_of_mass_ratio",
]

# every mass ratio of the figures, from the heaviest wall to the lightest
_MASS_RATIOS = (5.0, 10.0, 100.0, 1000.0, 2000.0, 20000.0)
OVER_TIME = r"$t$ (s)"


def style_of(form: Formulation) -> dict[str, Any]:
    """Return the arguments of ``Axes.plot`` for a form, with its label."""
    return {**series(FORMULATIONS.index(form), len(FORMULATIONS)), "label": form.label}


def style_of_mass_ratio(gamma: float) -> dict[str, Any]:
    """Return style and label of a mass ratio: the same in every figure."""
    line_style = series(_MASS_RATIOS.index(gamma), len(_MASS_RATIOS))
    return {**line_style, "label": rf"$\gamma$ = {gamma:g}"}


def row_label(ax: Axes, text: str) -> None:
    """Write the label of a row of panels to the right of its last panel."""
    ax.text(1.03, 0.5, text, transform=ax.transAxes, rotation=270, va="center", ha="left")


def column_title(ax: Axes, letter: str, text: str) -> None:
    """Write the title of a panel, with the letter of the paper if it has one."""
    ax.set_title(f"({letter}) {text}" if letter else text)
