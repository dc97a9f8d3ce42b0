"""Sketches of the rocking wall: scene, impact, and the devices under its corners."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from rwmf.plotting.style import GREY, INK, PAPER, tint

from pages.sketches.shapes import (
    BLUE,
    GREEN,
    HALF,
    RED,
    THIRD,
    Array,
    B,
    H,
    Sketch,
    arc,
    arrow,
    cable,
    corners,
    dimension,
    frame,
    ground,
    ground_motion,
    label,
    link,
    wall,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ALPHA = np.arctan2(B, H)
_TURN = 0.16
_COLUMNS = (-4.6, -2.6)
_SWAY = 2 * np.hypot(B, H) * (np.sin(_ALPHA) - np.sin(_ALPHA - _TURN))


def _draw_scene(ax: Axes) -> None:
    ground(ax, -5.2, 1.7)
    place = wall(ax, (B, 0.0))
    cable(ax, place, (0.0, 0.0))
    label(ax, (-0.22, 1.2), "$P$", color=RED)
    frame(ax, _COLUMNS, [2 * H], [0.0])
    link(ax, (_COLUMNS[1] + 0.08, 2 * H), (-B, 2 * H), is_long=True)
    label(ax, (-1.7, 2 * H + 0.3), "long link", color=GREEN)
    label(ax, (-3.6, 2 * H + 0.25), "$m_s$")
    label(ax, (-3.6, 1.9), "frame\n" + r"$\omega_s,\ \xi_s$")
    label(ax, (-0.38, 3.4), "$m_w$", color=BLUE)
    corners(ax, (-B, 0.0), (B, 0.0))
    ax.plot([B, 0.0], [0.0, H], color=INK, lw=1.1, zorder=6)
    ax.plot([B, B], [0.0, H + 0.3], color=GREY, lw=0.8, ls=":", zorder=6)
    ax.plot(0.0, H, marker="o", color=INK, ms=4, zorder=7)
    label(ax, (0.2, 0.95), "$R$")
    arc(ax, (B, 0.0), 1.35, (0.0, -_ALPHA))
    label(ax, (0.55, 1.6), r"$\alpha$")
    dimension(ax, (1.3, H), (1.3, 2 * H), "$h$", (0.2, 0.0))
    dimension(ax, (1.3, 0.0), (1.3, H), "$h$", (0.2, 0.0))
    dimension(ax, (-B, -0.45), (0.0, -0.45), "$b$", (0.0, -0.2))
    dimension(ax, (0.0, -0.45), (B, -0.45), "$b$", (0.0, -0.2))
    ground_motion(ax, -4.3, -0.5)


def _draw_rocking(ax: Axes) -> None:
    ground(ax, -5.2, 2.2)
    place = wall(ax, (B, 0.0), _TURN)
    cable(ax, place, (0.0, 0.0))
    frame(ax, _COLUMNS, [2 * H], [_SWAY])
    corner = place(-B, 2 * H)
    link(ax, (_COLUMNS[1] + _SWAY + 0.08, 2 * H), corner, is_long=True)
    corners(ax, place(-B, 0.0), (B, 0.0))
    for x in _COLUMNS:
        ax.plot([x, x], [0.0, 2 * H + 0.45], color=GREY, lw=0.8, ls=":", zorder=2)
    arrow(ax, (_COLUMNS[0], 2 * H + 0.35), (_COLUMNS[0] + _SWAY, 2 * H + 0.35))
    label(ax, (_COLUMNS[0] + 1.15 * _SWAY, 2 * H + 0.35), "$u_s$", ha="left")
    ax.plot([B, B], [0.0, 3.0], color=GREY, lw=0.8, ls=":", zorder=6)
    arc(ax, (B, 0.0), 2.6, (0.0, _TURN))
    label(ax, (1.08, 2.85), r"$\theta$")
    left = place(-B, 0.0)
    dimension(ax, (left[0] - 0.12, 0.0), (left[0] - 0.12, left[1]), "")
    label(ax, (left[0] - 0.55, 0.32), "uplift", ha="right")
    ground_motion(ax, -4.3, -0.5)


def _turning(ax: Axes, about: float, text: str) -> None:
    """Draw a wall in the instant of an impact, with velocities as those of a turn to the left."""
    ground(ax, -2.9, 2.2)
    wall(ax, (about, 0.0), corner=about)
    corners(ax, (-B, 0.0), (B, 0.0))
    ax.plot(about, 0.0, marker="o", ms=9, mfc="none", mec=INK, mew=1.6, zorder=8)
    label(ax, (about, -0.32), "pivot")
    ax.plot([-2.9, -2.1], [2 * H, 2 * H], color=INK, lw=9.0, solid_capstyle="butt", zorder=4)
    link(ax, (-2.1, 2 * H), (-B, 2 * H), is_long=True)
    label(ax, (-2.5, 2 * H + 0.28), "$m_s$")
    arc(ax, (0.0, H + 0.1), 0.42, (2.3, -2.3))
    label(ax, (0.0, H + 0.1), text)


def _velocity(ax: Axes, start: tuple[float, float], step: tuple[float, float]) -> None:
    arrow(ax, start, (start[0] + step[0], start[1] + step[1]), RED)


def _draw_before(ax: Axes) -> None:
    _turning(ax, B, "$w_1$")
    _velocity(ax, (-1.6, 2 * H - 0.3), (-1.1, 0.0))
    label(ax, (-2.1, 2 * H - 0.58), "$2h\\,w_1$", color=RED)
    _velocity(ax, (-B, 0.62), (0.0, -0.5))
    label(ax, (-B - 0.48, 0.55), "$2b\\,w_1$", color=RED)
    label(ax, (0.0, 2 * H + 0.3), "before: $O'$ lands")


def _draw_after(ax: Axes) -> None:
    _turning(ax, -B, "$w_2$")
    _velocity(ax, (-1.6, 2 * H - 0.3), (-0.9, 0.0))
    label(ax, (-2.1, 2 * H - 0.58), "$2h\\,w_2$", color=RED)
    _velocity(ax, (B, 0.05), (0.0, 0.45))
    label(ax, (B + 0.5, 0.62), "$2b\\,w_2$", color=RED)
    label(ax, (0.0, 2 * H + 0.3), "after: $w_2 = e\\,w_1$")


def _draw_device(body: Callable[[Axes, Array, Array], None], text: str) -> Callable[[Axes], None]:
    def draw(ax: Axes) -> None:
        """Draw the foot of a wall with a device under the corner that lifts."""
        turn = 0.34
        ground(ax, -1.7, 1.5)
        place = wall(ax, (B, 0.0), turn)
        foot, head, aside = np.array([-B, 0.0]), place(-B, 0.0), np.array([0.42, 0.0])
        body(ax, foot, head)
        ax.plot(*foot, marker="o", color=RED, ms=4, zorder=8)
        ax.plot(*head, marker="o", color=RED, ms=4, zorder=8)
        ax.plot(B, 0.0, marker="o", color=INK, ms=4, zorder=8)
        label(ax, (B + 0.22, 0.16), "$O$")
        dimension(ax, foot - aside, head - aside, "$s$", (-0.2, 0.0))
        label(ax, (0.35, 1.15), text, color=RED)
        ax.set_ylim(-0.35, 1.85)

    return draw


def _between(foot: Array, head: Array) -> Callable[[Array, Array], Array]:
    """Give points by their share of the way from foot to head and their distance from it."""
    along = head - foot
    across = np.array([along[1], -along[0]]) / np.hypot(*along)
    return lambda share, out: (
        foot[:, np.newaxis] + along[:, np.newaxis] * share + across[:, np.newaxis] * out
    )


def _fuse(ax: Axes, foot: Array, head: Array) -> None:
    point = _between(foot, head)
    share = np.array([0, 0.2, 0.3, 0.7, 0.8, 1.0])
    out = np.array([0.11, 0.11, 0.045, 0.045, 0.11, 0.11])
    sides = np.hstack([point(share, out), point(share[::-1], -out)])
    ax.fill(*sides, facecolor=tint(RED, 0.35), edgecolor=RED, lw=1.2, zorder=7)


def _damper(ax: Axes, foot: Array, head: Array) -> None:
    point = _between(foot, head)
    look: dict[str, Any] = {"color": RED, "lw": 1.4, "zorder": 7}
    ax.plot(*point(np.array([0, 0.35]), np.zeros(2)), **look)
    cup = point(np.array([0.72, 0.35, 0.35, 0.72]), np.array([-0.13, -0.13, 0.13, 0.13]))
    ax.plot(*cup, **look)
    ax.plot(*point(np.array([0.55, 0.55]), np.array([-0.1, 0.1])), **look | {"lw": 2.4})
    ax.plot(*point(np.array([0.55, 1.0]), np.zeros(2)), **look)


def _inerter(ax: Axes, foot: Array, head: Array) -> None:
    point = _between(foot, head)
    look: dict[str, Any] = {"color": RED, "lw": 1.4, "zorder": 7}
    ax.plot(*point(np.array([0, 1.0]), np.zeros(2)), **look)
    turns = np.linspace(0.0, 2 * np.pi, 40)
    middle = point(np.array([0.5]), np.array([0.0]))
    wheel = middle + 0.17 * np.array([np.cos(turns), np.sin(turns)])
    ax.fill(*wheel, facecolor=PAPER, edgecolor=RED, lw=1.4, zorder=8)
    label(ax, middle[:, 0], "$B$", color=RED)


SKETCHES = (
    Sketch("scene", _draw_scene, HALF, (-5.3, 1.9), (-0.9, 4.6)),
    Sketch("rocking", _draw_rocking, HALF, (-5.3, 2.3), (-0.9, 4.8)),
    Sketch("impact-before", _draw_before, HALF, (-3.3, 2.5), (-0.5, 4.6)),
    Sketch("impact-after", _draw_after, HALF, (-3.3, 2.5), (-0.5, 4.6)),
    Sketch("device-fuse", _draw_device(_fuse, "fuse"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
    Sketch("device-damper", _draw_device(_damper, "damper"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
    Sketch("device-inerter", _draw_device(_inerter, "inerter"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
)
