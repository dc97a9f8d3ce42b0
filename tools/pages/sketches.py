"""Sketches of the theory pages, drawn in the style of the project's figures.

Elements come first: walls, frames, links, arrows, dimensions and labels; then functions that draw a
sketch on given axes. `SKETCHES` lists them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from rwmf.figures.styles import ALONE, COLOURS, GREY, INK, LEVEL, PAPER, style, tint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["SKETCHES", "write_all"]

Array = npt.NDArray[np.float64]
Point = Sequence[float] | Array

# two or three sketches side by side are as wide as the text of a page [inch]
HALF, THIRD = 3.7, 2.45
BLUE, RED, GREEN = COLOURS[0], COLOURS[1], COLOURS[2]
# half width and half height of the walls [units of a sketch]
B, H = 0.8, 2.0

_TEXT_HEIGHT = 0.16
_BEAM = 4.0
_COLUMN = np.linspace(0.0, 1.0, 15)


@dataclass(frozen=True)
class Sketch:
    """A sketch: a file name, a size and a function that draws it.

    Attributes
    ----------
    name : str
        Name of the file without its suffix.
    draw : callable
        Draws on the axes that it gets.
    width : float
        Width [inch].
    x : tuple of float
        Range of the horizontal coordinate.
    y : tuple of float or None
        Range of the vertical one, in the same scale. None: the axes have separate scales.
    height : float
        Height of a diagram [inch].
    """

    name: str
    draw: Callable[[Axes], None]
    width: float
    x: tuple[float, float]
    y: tuple[float, float] | None = None
    height: float = 2.6

    def write(self, folder: Path) -> None:
        """Draw the sketch and write its file."""
        import matplotlib
        from matplotlib.figure import Figure

        height = self.height
        if self.y is not None:
            height = self.width * (self.y[1] - self.y[0]) / (self.x[1] - self.x[0])
        with matplotlib.rc_context(style()):
            figure = Figure(figsize=(self.width, height))
            axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
            axes.set_xlim(*self.x)
            axes.grid(False)
            if self.y is not None:
                axes.set_ylim(*self.y)
                axes.set_aspect("equal")
                axes.axis("off")
            self.draw(axes)
            figure.savefig(folder / f"{self.name}.svg", facecolor=PAPER, metadata={"Date": None})


def label(ax: Axes, at: Point, text: str, color: str = INK, ha: str = "center") -> None:
    """Write a text at a point."""
    ax.text(at[0], at[1], text, color=color, ha=ha, va="center", zorder=9)


def arrow(
    ax: Axes, start: Point, end: Point, colour: str = INK, width: float = 1.3, head: str = "-|>"
) -> None:
    """Draw an arrow."""
    look: dict[str, Any] = {"arrowstyle": head, "color": colour, "shrinkA": 0, "shrinkB": 0}
    look |= {"lw": width, "mutation_scale": 5.0 + 3.0 * width}
    ax.annotate("", (end[0], end[1]), (start[0], start[1]), arrowprops=look, zorder=8)


def dimension(ax: Axes, start: Point, end: Point, text: str, shift: Point = (0.0, 0.0)) -> None:
    """Draw a dimension line with its symbol."""
    arrow(ax, start, end, GREY, 0.8, "<|-|>")
    middle = (np.asarray(start, dtype=float) + np.asarray(end, dtype=float)) / 2
    label(ax, middle + np.asarray(shift), text)


def arc(
    ax: Axes,
    centre: Point,
    radius: float,
    angles: tuple[float, float],
    color: str = INK,
) -> None:
    """Draw an angle between two directions, with an arrow at its end."""
    swept = np.linspace(*angles, 30)
    x, y = centre[0] + radius * np.sin(swept), centre[1] + radius * np.cos(swept)
    ax.plot(x[:-1], y[:-1], color=color, lw=1.0, zorder=7)
    arrow(ax, (x[-3], y[-3]), (x[-1], y[-1]), color, 1.0)


def ground(ax: Axes, left: float, right: float, y: float = 0.0) -> None:
    """Draw the ground as a line with hatching below it."""
    ax.plot([left, right], [y, y], color=INK, lw=1.2, zorder=3)
    marks = np.arange(left + 0.12, right + 1e-9, 0.16)
    for x in marks:
        ax.plot([x - 0.1, x], [y - 0.1, y], color=GREY, lw=0.6, zorder=2)


def turned(pivot: Point, turn: float, corner: float = B) -> Callable[..., Array]:
    """Give the places of points of a wall that is turned about a corner of its base."""

    def place(x: Array | float, z: Array | float) -> Array:
        out = np.asarray(x) - corner
        up = np.asarray(z)
        return np.array(
            [
                pivot[0] + out * np.cos(turn) + up * np.sin(turn),
                pivot[1] - out * np.sin(turn) + up * np.cos(turn),
            ]
        )

    return place


def wall(ax: Axes, pivot: Point, turn: float = 0.0, *, corner: float = B) -> Callable[..., Array]:
    """Draw a wall that is turned about a corner of its base."""
    place = turned(pivot, turn, corner)
    outline = place(np.array([-B, B, B, -B]), np.array([0, 0, 2 * H, 2 * H]))
    ax.fill(*outline, facecolor=tint(BLUE, 0.14), edgecolor=BLUE, lw=1.5, zorder=4)
    return place


def cable(ax: Axes, place: Callable[..., Array], anchor: Point, text: str = "") -> None:
    """Draw the cable along the axis of a wall."""
    top = place(0.0, 2 * H)
    ax.plot([anchor[0], top[0]], [anchor[1], top[1]], color=RED, lw=1.6, ls=(0, (5, 1.5)), zorder=5)
    ax.plot(*top, marker="s", color=RED, ms=5, zorder=6)
    ax.plot(*anchor, marker="s", color=RED, ms=5, zorder=6)
    if text:
        where = place(0.0, 1.35 * H)
        label(ax, where + np.array([0.2, 0.0]), text, color=RED)


def frame(
    ax: Axes,
    columns: tuple[float, float],
    levels: Sequence[float],
    sway: Sequence[float],
) -> None:
    """Draw a moment frame: stiff floors on columns that bend."""
    bent = 3 * _COLUMN**2 - 2 * _COLUMN**3
    lower, shift = 0.0, 0.0
    for level, moved in zip(levels, sway, strict=True):
        for x in columns:
            line = x + shift + (moved - shift) * bent
            ax.plot(line, lower + (level - lower) * _COLUMN, color=INK, lw=1.4, zorder=4)
        ends = [columns[0] + moved - 0.08, columns[1] + moved + 0.08]
        ax.plot(ends, [level, level], color=INK, lw=_BEAM, solid_capstyle="butt", zorder=5)
        lower, shift = level, moved


def link(ax: Axes, start: Point, end: Point, *, is_long: bool = False) -> None:
    """Draw a link with its hinges."""
    look: dict[str, Any] = {"marker": "o", "ms": 4.5, "mfc": PAPER, "mew": 1.2}
    ax.plot([start[0], end[0]], [start[1], end[1]], zorder=6, color=GREEN, lw=1.8, **look)
    if is_long:
        x, y = (start[0] + end[0]) / 2, (start[1] + end[1]) / 2
        ax.plot([x - 0.06, x + 0.06], [y, y], color=PAPER, lw=3.0, zorder=6.5)
        for side in (-0.06, 0.06):
            ends = [x + side - 0.06, x + side + 0.06]
            ax.plot(ends, [y - 0.13, y + 0.13], color=GREEN, lw=1.2, zorder=7)


def corners(ax: Axes, left: Point, right: Point) -> None:
    """Mark both corners of a base with their names."""
    for place, name, side in ((left, "$O'$", -1), (right, "$O$", 1)):
        ax.plot(*place, marker="o", color=INK, ms=4, zorder=7)
        label(ax, (place[0] + 0.24 * side, place[1] + _TEXT_HEIGHT), name)


def ground_motion(ax: Axes, x: float, y: float) -> None:
    """Draw the acceleration of the ground as an arrow to the right."""
    arrow(ax, (x, y), (x + 0.7, y))
    label(ax, (x + 0.9, y), r"$\ddot u_g$", ha="left")


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


_LEVELS = np.array([1.0, 2.0, 3.0, 4.0])
_BAYS = (-3.7, -2.2)


def _draw_coupling(ax: Axes, shape: np.ndarray, text: str, *, is_linked_everywhere: bool) -> None:
    ground(ax, -4.1, 2.0)
    place = wall(ax, (B, 0.0), _TURN)
    roof = place(-B, 2 * H)[0] + B
    sway = roof * np.asarray(shape)
    frame(ax, _BAYS, _LEVELS.tolist(), sway.tolist())
    for level, moved in list(zip(_LEVELS, sway, strict=True))[
        None if is_linked_everywhere else -1 :
    ]:
        edge = place(-B, level / np.cos(_TURN))[0]
        link(ax, (_BAYS[1] + moved + 0.08, level), (edge, level))
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


def _law(text: str, cycles: Array, skeleton: Array, marks: Callable[[Axes], None] | None = None
         ) -> Sketch:  # fmt: skip
    """Make a sketch of a spring law: cycles of growing amplitude over the skeleton."""

    def draw(ax: Axes) -> None:
        ax.axhline(0.0, **LEVEL)
        ax.axvline(0.0, **LEVEL)
        ax.set(xlabel="$x/x_y$", ylabel="$F/F_y$", ylim=(-1.7, 1.7), xticks=[-5, -1, 1, 5])
        ax.set_yticks([-1, 0, 1])
        label(ax, (-_LIMIT + 0.2, 1.5), text, ha="left")
        ax.set_position((0.13, 0.18, 0.84, 0.79))
        ax.plot(*cycles, color=BLUE)
        ax.plot(*skeleton, **ALONE)
        if marks:
            marks(ax)

    name = f"law-{_LAWS[text.partition(',')[0]]}"
    return Sketch(name, draw, HALF, (-_LIMIT, _LIMIT))


_LAWS = {"elastic_plastic": "bilinear", "flag": "flag", "bouc_wen": "bouc-wen",
         "peak_oriented": "degrading"}  # fmt: skip
_LIMIT = 6.0
_BILINEAR = np.array(
    [(0, 0), (1, 1), (2.5, 1.12), (0.5, -0.88), (-2.5, -1.12), (-0.5, 0.88), (4.5, 1.28),
     (2.5, -0.72), (-4.5, -1.28), (-2.5, 0.72), (0, 0.92)]
).T  # fmt: skip
_SKELETON = np.array([(0, 0), (1, 1), (_LIMIT, 1.4)]).T
_HALF_FLAG = [(0.2, 0.2), (1, 1), (2.5, 1.12), (1.7, 0.32), (0.2, 0.2)]
_FLAG = np.array(
    [*_HALF_FLAG, *((-x, -y) for x, y in _HALF_FLAG), (1, 1), (4.5, 1.28), (3.7, 0.48), (0.2, 0.2),
     (-1, -1), (-4.5, -1.28), (-3.7, -0.48), (-0.2, -0.2)]
).T  # fmt: skip
_DEGRADING = np.array(
    [(0, 0), (1, 1), (2.5, 1.12), (1.3, 0), (-1.03, -0.93), (-2.5, -1.04), (-1.3, 0),
     (2.58, 1.04), (3, 1.08), (4, 0.82), (2.98, 0), (-2.58, -0.97), (-3, -1), (-4, -0.76),
     (-2.98, 0), (4.12, 0.76), (5.5, 0.4), (4.93, 0), (-4.12, -0.71), (-5.5, -0.37), (-4.93, 0)]
).T  # fmt: skip
_ENVELOPE = np.array([(0, 0), (1, 1), (3, 1.16), (_LIMIT, 0.32)]).T


def _bouc_wen(hardening: float = 0.08) -> Array:
    """Give the cycles of a smooth spring with n = 2, beta = gamma = 1/2."""
    ends = (0.0, 2.5, -2.5, 4.5, -4.5, 0.0)
    x = np.concatenate([np.linspace(a, b, 400, endpoint=False) for a, b in pairwise(ends)])
    z, memory = 0.0, np.empty_like(x)
    for i, step in enumerate(np.diff(x, prepend=0.0)):
        z += step * (1 - z**2 * 0.5 * (np.sign(step * z) + 1))
        memory[i] = z
    return np.array([x, hardening * x + (1 - hardening) * memory])


def _mark_bilinear(ax: Axes) -> None:
    label(ax, (0.55, 0.28), "$k$", ha="left")
    label(ax, (3.6, 1.42), "$a\\,k$")
    dimension(ax, (4.9, -0.71), (4.9, 1.28), "$2F_y$", (0.55, 0.0))


def _mark_flag(ax: Axes) -> None:
    dimension(ax, (3.4, 0.46), (3.4, 1.19), r"$\eta F_y$", (-0.55, -0.05))


def _mark_degrading(ax: Axes) -> None:
    label(ax, (3.0, 1.35), "cap")
    label(ax, (4.95, 1.12), "envelope")


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
    place = turned((B, 0.0), _TURN)
    outline = np.hstack([place(bent - B, z), place(bent + B, z)[:, ::-1]])
    ax.fill(*outline, facecolor=tint(BLUE, 0.14), edgecolor=BLUE, lw=1.5, zorder=4)
    ax.plot(*place(0 * z, z), color=INK, lw=1.1, ls=(0, (5, 1.5)), zorder=6)
    ax.plot(*place(bent, z), color=RED, lw=1.6, zorder=6)
    at = 62
    start, end = place(0 * z, z)[:, at], place(bent, z)[:, at]
    arrow(ax, start, end, INK, 0.9, "<|-|>")
    label(ax, (end[0] + 0.42, end[1] - 0.02), "$w(z, t)$", color=RED)
    top = place(0.0, 2 * H)
    label(ax, (top[0] - 0.1, top[1] + 0.25), "straight axis")
    ax.plot([B, B], [0.0, 2.3], color=GREY, lw=0.8, ls=":", zorder=6)
    right = place(B, 2.3)
    ax.plot([B, right[0]], [0.0, right[1]], color=GREY, lw=0.8, ls=":", zorder=6)
    arc(ax, (B, 0.0), 2.0, (0.0, _TURN))
    label(ax, (1.0, 1.75), r"$\theta$")
    corners(ax, place(-B, 0.0), (B, 0.0))
    dimension(ax, place(-1.35, 0.0), place(-1.35, 2 * H), "$2h$", (-0.3, 0.0))


def _draw_modes(ax: Axes) -> None:
    share = np.linspace(0.0, 1.0, 120)
    for number, x in enumerate((0.0, 2.2, 4.4)):
        ax.plot([x, x], [0, 2 * H], color=GREY, lw=0.9, ls=(0, (5, 1.5)))
        ax.plot(x + 0.7 * cantilever(number, share), 2 * H * share, color=COLOURS[number], lw=1.8)
        label(ax, (x, -0.4), f"mode {number + 1}", color=COLOURS[number])
    ground(ax, -0.8, 5.4)


_X, _Y = (-4.2, 2.2), (-0.25, 5.05)
_FAR = np.linspace(0.0, _LIMIT, 200)
_SMOOTH = np.array([_FAR, 0.08 * _FAR + 0.92 * np.tanh(_FAR)])
SKETCHES = (
    Sketch("scene", _draw_scene, HALF, (-5.3, 1.9), (-0.9, 4.6)),
    Sketch("rocking", _draw_rocking, HALF, (-5.3, 2.3), (-0.9, 4.8)),
    Sketch("impact-before", _draw_before, HALF, (-3.3, 2.5), (-0.5, 4.6)),
    Sketch("impact-after", _draw_after, HALF, (-3.3, 2.5), (-0.5, 4.6)),
    Sketch("device-fuse", _draw_device(_fuse, "fuse"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
    Sketch("device-damper", _draw_device(_damper, "damper"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
    Sketch("device-inerter", _draw_device(_inerter, "inerter"), THIRD, (-1.8, 1.5), (-0.35, 1.85)),
    Sketch("coupling-reduced", _draw_reduced, THIRD, _X, _Y),
    Sketch("coupling-full", _draw_full, THIRD, _X, _Y),
    Sketch("coupling-every-floor", _draw_every_floor, THIRD, _X, _Y),
    Sketch("p-delta-column", _draw_column, HALF, (-2.9, 3.1), (-0.25, 4.15)),
    Sketch("p-delta-law", _draw_push, HALF, (0.0, 6.0)),
    _law("elastic_plastic", _BILINEAR, _SKELETON, _mark_bilinear),
    _law("flag", _FLAG, _SKELETON, _mark_flag),
    _law("bouc_wen, $n = 2$", _bouc_wen(), _SMOOTH),
    _law("peak_oriented", _DEGRADING, _ENVELOPE, _mark_degrading),
    Sketch("section-wall", _draw_section, HALF, (-3.2, 3.2), (-0.9, 4.7)),
    Sketch("section-diagrams", _draw_diagrams, HALF, (-1.8, 5.8), (-0.8, 4.7)),
    Sketch("bending-wall", _draw_wall, HALF, (-2.7, 3.3), (-0.4, 4.6)),
    Sketch("bending-modes", _draw_modes, HALF, (-1.0, 5.6), (-0.7, 4.3)),
)


def write_all(folder: Path) -> None:
    """Draw all sketches."""
    folder.mkdir(parents=True, exist_ok=True)
    for sketch in SKETCHES:
        sketch.write(folder)
