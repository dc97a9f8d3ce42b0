"""Wall and frame moving with the ground, frame by frame: a film of rocking, impact, lift-off."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from subprocess import CalledProcessError
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rwmf._files import files
from rwmf.case import Case
from rwmf.errors import InputError, OutputError
from rwmf.plotting.style import COLOURS, GREY, INK, PALE, new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.animation import AbstractMovieWriter
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

__all__ = ["FORMATS", "animate", "corners", "ground_displacement", "magnification"]

Array = npt.NDArray[np.float64]

FORMATS = ("gif", "mp4")
# a rotation that a person sees [rad]
_VISIBLE = 0.12
# how long an impact stays marked [s]
_FLASH = 0.12


def animate(
    case: Case,
    dataset: xr.Dataset,
    path: Path,
    frames_per_second: int,
    progress: Callable[[int, int], None] | None = None,
) -> float:
    """Draw a film of a response.

    Parameters
    ----------
    case : Case
        A case with a wall.
    dataset : xarray.Dataset
        Its response, one sample for each frame of the film.
    path : path
        File to write; its suffix names the format.
    frames_per_second : int
        Frames a second of the film.
    progress : callable, optional
        Called with the number of finished frames and of all.

    Returns
    -------
    float
        Factor by which rotations are drawn larger than they are [-].

    Raises
    ------
    InputError
        When the format is unknown or its writer is missing.
    OutputError
        When the file cannot be written.
    """
    writer = _writer(path, frames_per_second)
    factor = magnification(dataset["theta"].values)
    with files.replacing(path, path.suffix) as stream, new_figure(6.0) as figure:
        # a layout that is found again for every frame would tremble
        figure.set_layout_engine("none")
        draw = _stage(figure, case, dataset, factor)
        try:
            with writer.saving(figure, stream.name, dpi=100):
                for i in range(dataset.sizes["time"]):
                    draw(i)
                    writer.grab_frame()
                    if progress is not None:
                        progress(i + 1, dataset.sizes["time"])
        except CalledProcessError as error:
            # the program that writes the film may find the disk full
            raise OutputError(f"{path}: cannot be written: {error}") from error
    return factor


def _writer(path: Path, frames_per_second: int) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise InputError(f"{path}: {kind!r} is not a format of films: {', '.join(FORMATS)}")
    if kind == "mp4" and not FFMpegWriter.isAvailable():
        raise InputError(f"{path}: mp4 needs the program ffmpeg; gif needs nothing")
    return (FFMpegWriter if kind == "mp4" else PillowWriter)(fps=frames_per_second)


def magnification(theta: Array) -> float:
    """Return the factor that makes rotations visible, 1 for large ones.

    Parameters
    ----------
    theta : numpy.ndarray, shape (n,)
        Rotations [rad].

    Returns
    -------
    float
        1, 2, 5 or 10 times a power of ten [-].
    """
    largest = float(np.abs(theta).max(initial=0.0))
    if largest >= _VISIBLE or largest == 0.0:
        return 1.0
    wanted = _VISIBLE / largest
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in (1.0, 2.0, 5.0, 10.0) if step * decade <= wanted) * decade)


def corners(h: float, b: float, theta: float) -> Array:
    """Return the corners of the wall, turned about the corner that is down.

    Parameters
    ----------
    h, b : float
        Half height and half width [m].
    theta : float
        Rotation, positive about the right corner [rad].

    Returns
    -------
    numpy.ndarray, shape (4, 2)
        Left bottom, right bottom, right top, left top [m].
    """
    pivot = np.array([b if theta > 0 else -b, 0.0])
    sine, cosine = np.sin(theta), np.cos(theta)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    upright = np.array([[-b, 0.0], [b, 0.0], [b, 2 * h], [-b, 2 * h]])
    turned: Array = pivot + (upright - pivot) @ turn.T
    return turned


def ground_displacement(t: Array, acceleration: Array) -> Array:
    """Integrate the ground motion twice and take out the line from first to last sample.

    Parameters
    ----------
    t : numpy.ndarray, shape (n,)
        Times [s].
    acceleration : numpy.ndarray, shape (n,)
        Ground acceleration [m/s2].

    Returns
    -------
    numpy.ndarray, shape (n,)
        Displacement [m]; a record drifts without the correction.
    """
    velocity = _integrate(t, acceleration)
    displacement = _integrate(t, velocity)
    duration = max(t[-1] - t[0], np.finfo(float).tiny)
    level: Array = displacement - displacement[-1] * (t - t[0]) / duration
    return level


def _integrate(t: Array, rate: Array) -> Array:
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(t)
    return np.array([0.0, *np.cumsum(steps)])


def _stage(figure: Figure, case: Case, dataset: xr.Dataset, factor: float) -> Callable[[int], None]:
    """Set the scene and return what moves it to a sample."""
    t = dataset["time"].values
    ground = np.zeros_like(t)
    if "u_g_ddot" in dataset:
        ground = ground_displacement(t, dataset["u_g_ddot"].values)
    upper = figure.add_axes((0.02, 0.34, 0.96, 0.6))
    lower = figure.add_axes((0.12, 0.1, 0.84, 0.2))
    move_scene = _scene(upper, case, dataset, factor, ground)
    shown = dataset["u_s"] if "u_s" in dataset else dataset["theta"]
    lower.plot(t, shown.values, color=COLOURS[0], linewidth=1.0)
    (cursor,) = lower.plot([t[0]], [shown.values[0]], "o", color=COLOURS[1], markersize=5)
    lower.set_xlabel("$t$ (s)")
    lower.set_ylabel("$u_s$ (m)" if "u_s" in dataset else r"$\theta$ (rad)")
    lower.margins(x=0)

    def draw(i: int) -> None:
        move_scene(i)
        cursor.set_data([t[i]], [shown.values[i]])

    return draw


def _scene(
    ax: Axes, case: Case, dataset: xr.Dataset, factor: float, ground: Array
) -> Callable[[int], None]:
    """Wall, frame, link and ground; return what moves them to a sample."""
    h, b = case.wall.h, case.wall.b
    reach = max(3.0 * h, float(np.abs(ground).max()) + 2.0 * h)
    ax.set_xlim(-reach - h, reach)
    ax.set_ylim(-0.25 * h, 2.7 * h)
    ax.set_aspect("equal")
    ax.set_axis_off()
    (wall,) = ax.fill([0], [0], facecolor=PALE, edgecolor=INK, zorder=3)
    (soil,) = ax.plot([], [], color=GREY, linewidth=3)
    (posts,) = ax.plot([], [], color=COLOURS[0], linewidth=2.5)
    (link,) = ax.plot([], [], color=INK, linewidth=1.0)
    (cable,) = ax.plot([], [], color=COLOURS[2], linewidth=1.2, zorder=4)
    (flash,) = ax.plot([], [], "*", color=COLOURS[1], markersize=16, zorder=5)
    label = ax.text(0.01, 0.98, "", transform=ax.transAxes, va="top")
    theta, t = dataset["theta"].values, dataset["time"].values
    impacts = dataset["event_time"].values[dataset["event"].values == "impact"]

    def move(i: int) -> None:
        box = corners(h, b, factor * theta[i]) + np.array([ground[i], 0.0])
        wall.set_xy(box)
        soil.set_data(ground[i] + np.array([-3.2 * h, 2.2 * b]), [-0.03 * h] * 2)
        if case.frame is not None:
            _move_frame(posts, link, box[3], ground[i], h, b)
        if case.cable is not None:
            top = 0.5 * (box[2] + box[3])
            cable.set_data([ground[i], top[0]], [0.0, top[1]])
        past = t[i] - impacts
        hit = np.any((past >= 0) & (past < _FLASH))
        # the corner that came down is the one that the wall now turns about
        down = box[1] if theta[i] > 0 else box[0]
        flash.set_data([down[0]], [0.0]) if hit else flash.set_data([], [])
        state = "at rest" if theta[i] == 0.0 else ("impact" if hit else "rocking")
        label.set_text(f"t = {t[i]:.2f} s, {state}; rotations drawn {factor:g} times")

    return move


def _move_frame(
    posts: Line2D, link: Line2D, corner: Array, ground: float, h: float, b: float
) -> None:
    """Portal at the left whose roof follows the corner of the wall."""
    sway = corner[0] - (ground - b)
    feet = ground - b - h * np.array([2.0, 1.0])
    height = np.linspace(0.0, 1.0, 12)
    # clamped at the foot, guided at the roof
    shape = sway * (3 * height**2 - 2 * height**3)
    left, right = feet[0] + shape, feet[1] + shape
    posts.set_data(np.concatenate((left, right[::-1])),
                   2 * h * np.concatenate((height, height[::-1])))  # fmt: skip
    link.set_data([right[-1], corner[0]], [2 * h, corner[1]])
