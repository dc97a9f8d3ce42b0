"""Figs 7 to 10: rotations that differ in one parameter, in both forms of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from rwmf.plotting.style import NESTED, legend_below, series

from reproduce import drawing
from reproduce.formulations import FORMULATIONS, Formulation
from reproduce.response_cache import ResponseCache

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FIG07", "FIG08", "FIG09", "FIG10", "Comparison", "draw"]


@dataclass(frozen=True)
class Comparison:
    """One figure of rotations.

    Attributes
    ----------
    columns : dict of str to tuple of str
        Title of a column of panels and the cases in it.
    labels : tuple of str
        Differences between the cases.
    over_alpha : bool
        Whether the rotation is shown over alpha; not where the walls differ in alpha.
    """

    columns: dict[str, tuple[str, ...]]
    labels: tuple[str, ...]
    over_alpha: bool


_STIFF, _MILD = r"$T_s$ = 0.4 s", r"$T_s$ = 1 s"
_WIDTHS = ("$b$ = 0.5 m", "$b$ = 1 m")
FIG07 = Comparison(
    {r"$\gamma$ = 1800": ("fig07_rocking_with_stiff_frame", "fig07_rocking_with_mild_frame")},
    (_STIFF, _MILD),
    True,
)
FIG08 = Comparison(
    {
        _STIFF: tuple(f"fig08_stiff_frame_mass_ratio_{n}" for n in (5, 100, 1800)),
        _MILD: tuple(f"fig08_mild_frame_mass_ratio_{n}" for n in (5, 100, 1800)),
    },
    tuple(rf"$\gamma$ = {n}" for n in (5, 100, 1800)),
    True,
)
FIG09 = Comparison(
    {
        _STIFF: ("fig09_stiff_frame_slender_wall", "fig09_stiff_frame_squat_wall"),
        _MILD: ("fig09_mild_frame_slender_wall", "fig09_mild_frame_squat_wall"),
    },
    _WIDTHS,
    False,
)
FIG10 = Comparison(
    {
        _STIFF: ("fig10_stiff_frame_slender_wall", "fig10_stiff_frame_squat_wall"),
        _MILD: ("fig10_mild_frame_slender_wall", "fig10_mild_frame_squat_wall"),
    },
    _WIDTHS,
    False,
)
# of a figure's time axis [s]: later the rotations are too small to see
_SHOWN = 8.0


def draw(figure: Figure, cache: ResponseCache, comparison: Comparison) -> None:
    """One figure of rotations: a column for each frame, a row for each form."""
    n = len(comparison.columns)
    panels = figure.subplots(2, n, sharex=True, sharey="col", squeeze=False)
    for j, (title, cases) in enumerate(comparison.columns.items()):
        for i, form in enumerate(FORMULATIONS):
            _draw_panel(panels[i, j], cache, form, comparison, cases)
            if j == n - 1:
                drawing.row_label(panels[i, j], form.label)
        drawing.column_title(panels[0, j], "ab"[j] if n > 1 else "", title)
        panels[1, j].set_xlabel(drawing.OVER_TIME)
    for ax in panels[:, 0]:
        ax.set_ylabel(r"$\theta/\alpha$" if comparison.over_alpha else r"$\theta$ (rad)")
    legend_below(figure, panels[0, 0], title=NESTED)


def _draw_panel(
    ax: Axes,
    cache: ResponseCache,
    form: Formulation,
    comparison: Comparison,
    cases: Sequence[str],
) -> None:
    for k, name in enumerate(cases):
        response = cache.history(name, form).sel(time=slice(0.0, _SHOWN))
        wall = cache.case(name, form).wall
        scale = float(np.arctan2(wall.b, wall.h)) if comparison.over_alpha else 1.0
        ax.plot(
            response["time"],
            response["theta"] / scale,
            **series(k, len(cases)),
            label=comparison.labels[k],
        )
    ax.margins(x=0)
