"""Sketches of storeys beside a wall: three couplings, and gravity on the displaced frame."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rwmf.plotting.style import ALONE, GREY, INK, LEVEL

from pages.sketches.shapes import (
    BLUE,
    HALF,
    RED,
    THIRD,
    B,
    H,
    Sketch,
    arrow,
    dimension,
    frame,
    ground,
    label,
    link,
    wall,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LEVELS = np.array([1.0, 2.0, 3.0, 4.0])
_COLUMNS = (-3.7, -2.2)
_TURN = 0.16


def _draw_coupling(ax: Axes, shape: np.ndarray, text: str, *, is_linked_everywhere: bool) -> None:
    ground(ax, -4.1, 2.0)
    place = wall(ax, (B, 0.0), _TURN)
    roof = place(-B, 2 * H)[0] + B
    sway = roof * np.asarray(shape)
    frame(ax, _COLUMNS, _LEVELS.tolist(), sway.tolist())
    for level, moved in list(zip(_LEVELS, sway, strict=True))[
        None if is_linked_everywhere else -1 :
    ]:
        edge = place(-B, level / np.cos(_TURN))[0]
        link(ax, (_COLUMNS[1] + moved + 0.08, level), (edge, level))
    label(ax, (-1.0, 4.75), text)
    ax.plot(B, 0.0, marker="o", color=INK, ms=4, zorder=7)


def _draw_reduced(ax: Axes) -> None:
    shape = np.sin(np.array([1, 2, 3, 4]) * np.pi / 9) / np.sin(4 * np.pi / 9)
    _draw_coupling(ax, shape, "reduced: first mode", is_linked_everywhere=False)


def _draw_full(ax: Axes) -> None:
    shape = np.array([0.62, 0.58, 1.05, 1.0])
    _draw_coupling(ax, shape, "full: all modes", is_linked_everywhere=False)


def _draw_every_floor(ax: Axes) -> None:
    _draw_coupling(ax, _LEVELS / 4, "every_floor: straight line", is_linked_everywhere=True)


def _draw_column(ax: Axes) -> None:
    levels, sway = [1.6, 3.2], [0.35, 0.75]
    columns = (-1.9, -0.3)
    ground(ax, -2.4, 2.6)
    frame(ax, columns, levels, sway)
    foot = 1.2
    lower, shift = 0.0, 0.0
    for level, moved in zip(levels, sway, strict=True):
        ax.plot([foot + shift, foot + moved], [lower, level], color=RED, lw=2.0, zorder=5)
        link(ax, (columns[1] + moved + 0.08, level), (foot + moved, level))
        lower, shift = level, moved
    ax.plot(foot, 0.0, marker="o", color=RED, ms=5, zorder=7)
    for level, moved, text in zip(levels, sway, ("$g\\,m_{g1}$", "$g\\,m_{g2}$"), strict=True):
        arrow(ax, (foot + moved, level + 0.75), (foot + moved, level + 0.08), RED)
        label(ax, (foot + moved - 0.12, level + 0.6), text, color=RED, ha="right")
    ax.plot([foot + sway[0]] * 2, [levels[0], levels[1] + 0.1], color=GREY, lw=0.8, ls=":")
    dimension(ax, (foot + sway[0], 2.9), (foot + sway[1], 2.9), "")
    label(ax, (foot + sway[0] - 0.22, 2.85), "$d_2$")
    dimension(ax, (-2.25, 1.6), (-2.25, 3.2), "$h_2$", (-0.22, 0.0))
    dimension(ax, (-2.25, 0.0), (-2.25, 1.6), "$h_1$", (-0.22, 0.0))
    arrow(ax, (columns[1] + sway[1] - 1.55, 3.45), (columns[1] + sway[1] - 0.65, 3.45), BLUE)
    label(ax, (columns[1] + sway[1] - 1.1, 3.7), "$W_2\\,d_2/h_2$", color=BLUE)


def _draw_push(ax: Axes) -> None:
    d = np.array([0.0, 1.0, 6.0])
    without = np.array([0.0, 1.0, 1.25])
    pushed = without - 0.16 * d
    ax.plot(d, without, **ALONE)
    ax.plot(d, pushed, color=BLUE)
    ax.plot(d, -0.16 * d, color=RED, ls=(0, (5, 1.5)))
    ax.axhline(0.0, **LEVEL)
    ax.set(xlabel="storey drift $d_i$", ylabel="storey shear", ylim=(-1.1, 1.6))
    ax.set_xticks([])
    ax.set_yticks([])
    label(ax, (3.6, 1.33), "columns alone", ha="center")
    label(ax, (4.6, 0.72), "with gravity", color=BLUE)
    label(ax, (2.2, -0.65), "$-W_i\\,d_i/h_i$", color=RED)
    ax.set_position((0.1, 0.14, 0.87, 0.82))


_X, _Y = (-4.2, 2.2), (-0.25, 5.05)
SKETCHES = (
    Sketch("coupling-reduced", _draw_reduced, THIRD, _X, _Y),
    Sketch("coupling-full", _draw_full, THIRD, _X, _Y),
    Sketch("coupling-every-floor", _draw_every_floor, THIRD, _X, _Y),
    Sketch("p-delta-column", _draw_column, HALF, (-2.9, 3.1), (-0.25, 4.15)),
    Sketch("p-delta-law", _draw_push, HALF, (0.0, 6.0)),
)
