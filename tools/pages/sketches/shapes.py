"""Elements of the sketches: walls, frames, links, springs, arrows, dimensions and labels."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from rwmf.plotting.style import COLOURS, GREY, INK, PAPER, style, tint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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


def wall(ax: Axes, pivot: Point, turn: float = 0.0, *, corner: float = B) -> Callable[..., Array]:
    """Draw a wall that is turned about a corner of its base."""

    def place(x: Array | float, z: Array | float) -> Array:
        out = np.asarray(x) - corner
        up = np.asarray(z)
        return np.array(
            [
                pivot[0] + out * np.cos(turn) + up * np.sin(turn),
                pivot[1] - out * np.sin(turn) + up * np.cos(turn),
            ]
        )

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
