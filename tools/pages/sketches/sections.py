"""Sketches of a section of the wall and of its shear and moment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from rwmf.plotting.style import GREY, INK, tint

from pages.sketches.shapes import (
    BLUE,
    GREEN,
    HALF,
    RED,
    B,
    H,
    Sketch,
    arc,
    arrow,
    dimension,
    ground,
    label,
    wall,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CUT = 1.5
_LINKS = (2.0, 4.0)


def _draw_section(ax: Axes) -> None:
    ground(ax, -2.0, 2.0)
    wall(ax, (B, 0.0))
    ax.fill_between([-B, B], _CUT, 2 * H, color=tint(BLUE, 0.3), zorder=4.5, lw=0)
    ax.plot([-B - 0.25, B + 0.25], [_CUT, _CUT], color=RED, lw=1.4, ls=(0, (5, 1.5)), zorder=6)
    dimension(ax, (1.35, 0.0), (1.35, _CUT), "$z$", (0.2, 0.0))
    dimension(ax, (1.35, _CUT), (1.35, 2 * H), "$s$", (0.2, 0.0))
    for height in _LINKS:
        arrow(ax, (-B - 0.95, height), (-B, height), GREEN)
    label(ax, (-B - 0.6, _LINKS[0] + 0.22), "links", color=GREEN)
    label(ax, (-B - 0.6, _LINKS[1] + 0.22), "links", color=GREEN)
    arrow(ax, (0.0, 2 * H + 0.55), (0.0, 2 * H + 0.02), RED)
    label(ax, (0.2, 2 * H + 0.38), "$P$", color=RED)
    ax.plot(0.0, (_CUT + 2 * H) / 2, marker="o", color=INK, ms=4, zorder=7)
    arrow(ax, (0.0, 2.75), (0.0, 2.1))
    label(ax, (-0.43, 2.35), "weight")
    arrow(ax, (0.0, 2.75), (0.7, 2.75))
    label(ax, (0.35, 2.95), "inertia")
    arrow(ax, (0.7, _CUT - 0.22), (-0.05, _CUT - 0.22), RED)
    label(ax, (0.42, _CUT - 0.45), "$V$", color=RED)
    arc(ax, (-0.35, _CUT), 0.33, (2.0, 4.4), color=RED)
    label(ax, (-0.35, _CUT - 0.6), "$M$", color=RED)
    arrow(ax, (B, -0.75), (B, -0.05))
    label(ax, (B + 0.2, -0.5), "$N$")
    arrow(ax, (B + 0.85, -0.28), (B + 0.12, -0.28))
    label(ax, (B + 1.05, -0.28), "$H$")


def _draw_diagrams(ax: Axes) -> None:
    z = np.linspace(0.0, 2 * H, 401)
    s = 2 * H - z
    below = [z <= height for height in _LINKS]
    forces = (0.9, -1.4)
    shear = 1.5 * s / (2 * H) * (0.4 + 0.2 * z) + 0.1
    shear = shear + sum(f * b for f, b in zip(forces, below, strict=True))
    moment = np.concatenate([[0.0], np.cumsum((shear[::-1][1:] + shear[::-1][:-1]) / 2)])[::-1]
    moment = moment * (z[1] - z[0])
    for values, x, scale, colour, name in (
        (shear, 0.0, 0.75, RED, "$V$"),
        (moment, 3.6, 0.55, BLUE, "$M$"),
    ):
        line = x + scale * values
        ax.fill_betweenx(z, x, line, color=tint(colour, 0.2), lw=0)
        ax.plot(line, z, color=colour)
        ax.plot([x, x], [0, 2 * H], color=INK, lw=1.0)
        peak = np.argmax(np.abs(values))
        ax.plot(line[peak], z[peak], marker="o", color=colour, ms=5)
        label(ax, (x, 2 * H + 0.3), name, color=colour)
    ground(ax, -1.6, 5.6)
    for height in _LINKS:
        ax.plot([-1.6, 5.6], [height, height], color=GREY, lw=0.8, ls=":")
    label(ax, (1.75, _LINKS[0] + 0.18), "link", color=GREY)
    label(ax, (1.75, _LINKS[1] - 0.2), "link", color=GREY)
    label(ax, (2.0, -0.5), "dots: largest values, reported with their height")


SKETCHES = (
    Sketch("section-wall", _draw_section, HALF, (-3.2, 3.2), (-0.9, 4.7)),
    Sketch("section-diagrams", _draw_diagrams, HALF, (-1.8, 5.8), (-0.8, 4.7)),
)
