"""Sketches of a wall that bends: its deflection from the turned straight axis, and its modes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rwmf.plotting.style import COLOURS, GREY, INK, tint

from pages.sketches.shapes import (
    BLUE,
    HALF,
    RED,
    Array,
    B,
    H,
    Sketch,
    arc,
    arrow,
    corners,
    dimension,
    ground,
    label,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TURN = 0.16
# beta L of a cantilever beam
_ROOTS = (1.8751040687, 4.6940911330, 7.8547574382)


def cantilever(number: int, share: Array) -> Array:
    """Give a mode of a clamped uniform beam, 1 at its tip."""
    root = _ROOTS[number]
    ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
    at = root * share
    tip = np.cosh(root) - np.cos(root) - ratio * (np.sinh(root) - np.sin(root))
    shape: Array = (np.cosh(at) - np.cos(at) - ratio * (np.sinh(at) - np.sin(at))) / tip
    return shape


def _draw_wall(ax: Axes) -> None:
    ground(ax, -2.2, 2.6)
    z = np.linspace(0.0, 2 * H, 80)
    bent = 0.75 * cantilever(0, z / (2 * H))

    def place(x: Array, up: Array) -> Array:
        out = x - B
        return np.array(
            [
                B + out * np.cos(_TURN) + up * np.sin(_TURN),
                -out * np.sin(_TURN) + up * np.cos(_TURN),
            ]
        )

    outline = np.hstack([place(bent - B, z), place(bent + B, z)[:, ::-1]])
    ax.fill(*outline, facecolor=tint(BLUE, 0.14), edgecolor=BLUE, lw=1.5, zorder=4)
    ax.plot(*place(0 * z, z), color=INK, lw=1.1, ls=(0, (5, 1.5)), zorder=6)
    ax.plot(*place(bent, z), color=RED, lw=1.6, zorder=6)
    at = 62
    start, end = place(0 * z, z)[:, at], place(bent, z)[:, at]
    arrow(ax, start, end, INK, 0.9, "<|-|>")
    label(ax, (end[0] + 0.42, end[1] - 0.02), "$w(z, t)$", color=RED)
    top = place(np.array(0.0), np.array(2 * H))
    label(ax, (top[0] - 0.1, top[1] + 0.25), "straight axis")
    ax.plot([B, B], [0.0, 2.3], color=GREY, lw=0.8, ls=":", zorder=6)
    right = place(np.array(B), np.array(2.3))
    ax.plot([B, right[0]], [0.0, right[1]], color=GREY, lw=0.8, ls=":", zorder=6)
    arc(ax, (B, 0.0), 2.0, (0.0, _TURN))
    label(ax, (1.0, 1.75), r"$\theta$")
    corners(ax, place(np.array(-B), np.array(0.0)), (B, 0.0))
    base, top = place(np.array(-1.35), np.array(0.0)), place(np.array(-1.35), np.array(2 * H))
    dimension(ax, base, top, "$2h$", (-0.3, 0.0))


def _draw_modes(ax: Axes) -> None:
    share = np.linspace(0.0, 1.0, 120)
    for number, x in enumerate((0.0, 2.2, 4.4)):
        ax.plot([x, x], [0, 2 * H], color=GREY, lw=0.9, ls=(0, (5, 1.5)))
        ax.plot(x + 0.7 * cantilever(number, share), 2 * H * share, color=COLOURS[number], lw=1.8)
        label(ax, (x, -0.4), f"mode {number + 1}", color=COLOURS[number])
    ground(ax, -0.8, 5.4)


SKETCHES = (
    Sketch("bending-wall", _draw_wall, HALF, (-2.7, 3.3), (-0.4, 4.6)),
    Sketch("bending-modes", _draw_modes, HALF, (-1.0, 5.6), (-0.7, 4.3)),
)
