"""Film of a response: wall, frame and ground, frame by frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from subprocess import PIPE, Popen
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Case
from rwmf.case.elements import height_of_frame
from rwmf.errors import InputError, OutputError
from rwmf.figures import levels
from rwmf.figures.histories import members
from rwmf.figures.styles import COLOURS, GREY, INK, PALE, new_figure
from rwmf.kernel import files
from rwmf.kernel.numbers import Array, Truths, grouped
from rwmf.run.quantities import ENDINGS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from PIL.Image import Image


# points along a column
_COLUMN = np.linspace(0.0, 1.0, 12)
# shape of a column, clamped at the foot and guided at the floor above
_BENT = 3 * _COLUMN**2 - 2 * _COLUMN**3
# separator between parts of a line
_GAP = np.array([[np.nan, np.nan]])
# height of a drawn frame when the case gives none [m]
_NOMINAL = 3.0


@dataclass(frozen=True)
class Building:
    """Floors of a frame over time.

    Attributes
    ----------
    levels : numpy.ndarray, shape (n,)
        Heights of the floors above the ground [m].
    sway : numpy.ndarray, shape (n, times)
        Displacements of the floors, relative to the ground [m].
    has_yielded : numpy.ndarray of bool, shape (n, times)
        True from the first yield of the storey below each floor.
    linked : numpy.ndarray of bool, shape (n,)
        True for a floor linked to the wall.
    """

    levels: Array
    sway: Array
    has_yielded: Truths
    linked: Truths

    @property
    def angles(self) -> Array:
        """Storey drifts over storey heights, shape (n, times) [rad]."""
        heights = np.diff(self.levels, prepend=0.0)
        return np.diff(self.sway, axis=0, prepend=0.0) / heights[:, np.newaxis]


def find_building(case: Case, dataset: xr.Dataset) -> Building | None:
    """Find the floors of a case."""
    if case.frame is None:
        return None
    if case.storeys is None:
        floors = np.array([(2 * case.wall.h if case.wall else height_of_frame(case)) or _NOMINAL])
        drifts = dataset["u_s"].values[np.newaxis]
        first, heights = levels.levels_of_frame(dataset, case).first_yield, np.ones(1)
    else:
        drifts = np.array([dataset[name].values for name in members(dataset, "storey_{i}_drift")])
        heights = np.array(case.storeys.height)
        floors = np.cumsum(heights)
        first = levels.levels_of_storeys(dataset, case, len(drifts)).first_yield
    sway = np.cumsum(drifts * heights[:, np.newaxis], axis=0)
    has_yielded = np.zeros(drifts.shape, dtype=bool)
    if first.size == len(drifts):
        beyond = np.abs(drifts) > first[:, np.newaxis]
        has_yielded = np.logical_or.accumulate(beyond, axis=1)
    linked = np.full(floors.size, case.wall is not None)
    if case.storeys is None or case.storeys.coupling not in ("every_floor", "springs"):
        linked[:-1] = False
    return Building(floors, sway, has_yielded, linked)


class BuildingLines:
    """Columns, floors, hinges and links of a frame with one bay."""

    def __init__(self, ax: Axes, building: Building, feet: Array, sway: Array) -> None:
        self._building, self._feet, self._sway = building, feet, sway
        (self._columns,) = ax.plot([], [], color=COLOURS[0], linewidth=2.0)
        (self._yielded,) = ax.plot([], [], color=COLOURS[1], linewidth=2.0)
        (self._floors,) = ax.plot([], [], color=COLOURS[0], linewidth=3.0, solid_capstyle="round")
        (self._hinges,) = ax.plot([], [], "o", color=COLOURS[1], markersize=4.5, zorder=4)
        (self._links,) = ax.plot([], [], "o-", color=INK, linewidth=0.9, markersize=2.5)

    def move(self, i: int, ground: float, face: Array | None) -> None:
        """Draw the frame at a sample."""
        building = self._building
        x = ground + np.concatenate(([0.0], self._sway[:, i]))
        z = np.concatenate(([0.0], building.levels))
        columns: tuple[list[Array], list[Array]] = ([], [])
        for k, yields in enumerate(building.has_yielded[:, i]):
            column_axis = np.stack(
                (x[k] + (x[k + 1] - x[k]) * _BENT, z[k] + (z[k + 1] - z[k]) * _COLUMN), axis=1
            )
            columns[int(yields)].extend(column_axis + np.array([foot, 0.0]) for foot in self._feet)
        for line, parts in ((self._columns, columns[0]), (self._yielded, columns[1])):
            line.set_data(*_joined(parts))
        hinges = [column[[1, -2]] for column in columns[1]]
        self._hinges.set_data(*np.reshape(hinges, (-1, 2)).T)
        ends = [
            np.column_stack((self._feet + u, [h, h])) for u, h in zip(x[1:], z[1:], strict=True)
        ]
        self._floors.set_data(*_joined(ends))
        if face is not None:
            along = np.linspace(0.0, z[-1], len(face))
            links = [
                np.concatenate((end[1:], _at_height(face, along, end[1, 1])))
                for end, is_linked in zip(ends, building.linked, strict=True)
                if is_linked
            ]
            self._links.set_data(*_joined(links))


def _at_height(face: Array, along: Array, height: float) -> Array:
    """Return the point of a face at a height along the wall [m], shape (1, 2)."""
    return np.array([[np.interp(height, along, values) for values in face.T]])


def _joined(parts: list[Array]) -> Array:
    """Join the points of several parts into one line with gaps; shape (2, points)."""
    found = [item for part in parts for item in (part, _GAP)]
    return np.concatenate([np.empty((0, 2)), *found]).T


FORMATS = ("gif", "webp", "mp4")
_DOTS_PER_INCH = 100
# mark of a text that never changes: text is the slowest thing to draw
_STILL = "still"
# colours of a palette: few, and those between them at the edges of lines
_COLOURS = 128
# arguments of the writers of Pillow: WebP by its fastest method
_OPTIONS: dict[str, dict[str, Any]] = {"gif": {}, "webp": {"quality": 80, "method": 0}}
# smallest visible rotation [rad], or deflection of a wall over its height [-]
_VISIBLE = 0.12
# points of a face of a wall that bends, at equal distances
_FACE = np.linspace(0.0, 1.0, 41)
# duration of the mark of an impact [s]
_FLASH = 0.12
# duration of the last picture of a motion that has ended early [s]
_LAST = 1.0


@dataclass(frozen=True)
class Scale:
    """Magnifications of a film.

    Attributes
    ----------
    rotation : float
        Of rotations and drifts [-].
    deflection : float
        Of the deflection of a wall that bends [-]; otherwise that of rotations.
    """

    rotation: float
    deflection: float


def animate(
    case: Case,
    dataset: xr.Dataset,
    path: Path,
    frames_per_second: int,
    progress: Callable[[int, int], None] | None = None,
) -> Scale:
    """Draw a film of a response."""
    import PIL.Image

    kind = _kind_of(path)
    building = find_building(case, dataset)
    scale = scale_of(case, dataset, building)
    last = round(_LAST * frames_per_second) if _end_of(dataset) else 1
    samples = dataset.sizes["time"]
    with files.replacing(path, path.suffix) as stream, new_figure(6.0) as figure:
        # a new layout for every picture would make the film tremble
        figure.set_layout_engine("none")
        figure.set_dpi(_DOTS_PER_INCH)
        take = _camera(figure, _stage(figure, case, dataset, building, scale))

        def pictures() -> Iterator[Image]:
            for i in range(samples):
                picture = take(i)
                for _ in range(last if i == samples - 1 else 1):
                    yield picture
                if progress is not None:
                    progress(i + 1, samples)

        if kind == "mp4":
            _encode_mp4(pictures(), path, stream.name, frames_per_second)
        else:
            # one palette for all pictures: moving objects have the colours of the first and last
            colours = _palette(take(i) for i in np.linspace(0, samples - 1, 4).astype(int))
            found = (
                item.quantize(palette=colours, dither=PIL.Image.Dither.NONE) for item in pictures()
            )
            next(found).save(
                stream.name, format=kind, save_all=True, append_images=found,
                duration=int(1000 / frames_per_second), loop=0, **_OPTIONS[kind],
            )  # fmt: skip
    return scale


def _camera(figure: Figure, draw: Callable[[int], None]) -> Callable[[int], Image]:
    """Return a function that takes the picture of a sample."""
    from PIL import Image

    scene, curve = figure.axes
    artists = [*scene.lines, *scene.patches, *scene.texts]
    moving = sorted(
        (item for item in artists if item.get_gid() != _STILL), key=lambda item: item.zorder
    )
    moving.append(curve.lines[-1])
    for item in moving:
        item.set_animated(True)
    canvas: Any = figure.canvas
    canvas.draw()
    size = canvas.get_width_height()
    still = canvas.copy_from_bbox(figure.bbox)

    def take(i: int) -> Image.Image:
        canvas.restore_region(still)
        draw(i)
        for item in moving:
            figure.draw_artist(item)
        return Image.frombuffer("RGBA", size, canvas.buffer_rgba()).convert("RGB")

    return take


def _palette(pictures: Iterable[Image]) -> Image:
    """Return a picture with the palette of several."""
    from PIL import Image

    points = np.concatenate([np.asarray(picture).reshape(-1, 3) for picture in pictures])
    codes, counts = np.unique(points @ np.array([65536, 256, 1]), return_counts=True)
    kept: dict[tuple[int, ...], list[int]] = {}
    for code in codes[np.argsort(-counts)].tolist():
        colour = [code >> 16, code >> 8 & 255, code & 255]
        # Pillow does not tell closer colours apart: the frequent one stays as it is
        kept.setdefault(tuple(part >> 3 for part in colour), colour)
    found = Image.new("P", (1, 1))
    found.putpalette([part for colour in list(kept.values())[:_COLOURS] for part in colour])
    return found


def _kind_of(path: Path) -> str:
    """Return the format of a film after checking that it can be written."""
    from matplotlib.animation import FFMpegWriter
    from PIL import features

    kind = path.suffix.lstrip(".").lower()
    if kind not in FORMATS:
        raise InputError(f"{path}: {kind!r} is not a format of films: {', '.join(FORMATS)}")
    if kind == "mp4" and not FFMpegWriter.isAvailable():
        raise InputError(f"{path}: mp4 needs the program ffmpeg; gif and webp need nothing")
    if kind == "webp" and not features.check("webp"):
        raise InputError(
            f"{path}: webp needs the library of that name in Pillow; gif needs nothing"
        )
    return kind


def _encode_mp4(pictures: Iterator[Image], path: Path, name: str, frames_per_second: int) -> None:
    """Send the pictures to ffmpeg."""
    from matplotlib.animation import FFMpegWriter

    first = next(pictures)
    size = f"{first.width}x{first.height}"
    words = [
        FFMpegWriter.bin_path(), "-loglevel", "error", "-y",
        "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", str(frames_per_second), "-i", "-",
        # a folder may be called like an option or a protocol
        "-pix_fmt", "yuv420p", "-f", "mp4", f"file:{name}",
    ]  # fmt: skip
    with Popen(words, stdin=PIPE, stderr=PIPE) as process:
        try:
            for picture in chain([first], pictures):
                process.stdin.write(picture.tobytes())  # type: ignore[union-attr]
            _, errors = process.communicate()
        except BrokenPipeError:
            # the program may find the disk full
            _, errors = process.communicate()
    if process.returncode:
        text = " ".join(errors.decode(errors="replace").split())
        raise OutputError(f"{path}: cannot be written: {text}")


def scale_of(case: Case, dataset: xr.Dataset, building: Building | None) -> Scale:
    """Choose the magnifications of a film."""
    angles = [] if building is None else [building.angles.ravel()]
    angles += [dataset["theta"].values] if "theta" in dataset else []
    rotation = magnification(np.concatenate(angles))
    if case.bending is None:
        return Scale(rotation, rotation)
    share = _deflections(case, dataset, np.ones(1)) / (2 * case.wall.h)
    return Scale(rotation, max(rotation, magnification(share.ravel())))


def _deflections(case: Case, dataset: xr.Dataset, share: Array) -> Array:
    """Return w at heights over that of the wall, shape (n, times) [m]; 0 without ``&bending``."""
    if case.bending is None:
        return np.zeros((share.size, dataset.sizes["time"]))
    numbers = range(1, case.bending.modes + 1)
    modes = np.array([dataset[f"q_{i}"].values for i in numbers])
    return np.asarray(levels.mode_shapes(case, share) @ modes)


def _drawn_sway(case: Case, dataset: xr.Dataset, building: Building, scale: Scale) -> Array:
    """Return the displacements of floors as drawn [m]: linked ones keep their distance to the wall.

    Floors between them follow a straight line.
    """
    sway = scale.rotation * building.sway
    if scale.deflection == scale.rotation:
        return sway
    heights = building.levels[building.linked]
    bent = _deflections(case, dataset, heights / (2 * case.wall.h))
    added = [np.interp(building.levels, [0.0, *heights], [0.0, *column]) for column in bent.T]
    return sway + (scale.deflection - scale.rotation) * np.array(added).T


def magnification(theta: Array) -> float:
    """Return the magnification that makes rotations visible, 1 for large ones."""
    largest = float(np.abs(theta).max(initial=0.0))
    if largest >= _VISIBLE or largest == 0.0:
        return 1.0
    wanted = _VISIBLE / largest
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step for step in (1.0, 2.0, 5.0, 10.0) if step * decade <= wanted) * decade)


def in_words(case: Case, scale: Scale) -> str:
    """Describe the magnifications."""
    drawn = "rotations" if case.frame is None else "rotations and drifts"
    if case.wall is None:
        drawn = "drifts"
    text = f"{drawn} drawn {_times(scale.rotation)}"
    if case.bending is not None:
        text += f", deflection of the wall {_times(scale.deflection)}"
    return text


def _times(factor: float) -> str:
    return f"{factor:g} times" if factor > 1 else "to scale"


def corners(h: float, b: float, theta: float, is_pinned: bool = False) -> Array:
    """Return the corners of the wall, rotated about its base corner or its hinge."""
    pivot = np.array([0.0 if is_pinned else b if theta > 0 else -b, 0.0])
    sine, cosine = np.sin(theta), np.cos(theta)
    turn = np.array([[cosine, sine], [-sine, cosine]])
    upright = np.array([[-b, 0.0], [b, 0.0], [b, 2 * h], [-b, 2 * h]])
    return np.asarray(pivot + (upright - pivot) @ turn.T)


def ground_displacement(t: Array, acceleration: Array) -> Array:
    """Integrate the ground motion twice and remove the line from first to last sample."""
    velocity = _integrate(t, acceleration)
    displacement = _integrate(t, velocity)
    duration = max(t[-1] - t[0], np.finfo(float).tiny)
    return np.asarray(displacement - displacement[-1] * (t - t[0]) / duration)


def _integrate(t: Array, rate: Array) -> Array:
    steps = 0.5 * (rate[1:] + rate[:-1]) * np.diff(t)
    return np.array([0.0, *np.cumsum(steps)])


def _end_of(dataset: xr.Dataset) -> str:
    """Return the ending within the film: 'overturned', 'collapsed', or '' for none."""
    t = dataset["time"].values
    next_sample = 2 * t[-1] - t[max(t.size - 2, 0)]
    ends = dataset["event"].values[dataset["event_time"].values <= next_sample]
    return str(ends[-1]) if ends.size and ends[-1] in ENDINGS else ""


def _stage(
    figure: Figure, case: Case, dataset: xr.Dataset, building: Building | None, scale: Scale
) -> Callable[[int], None]:
    """Draw the scene and return the function that moves it to a sample."""
    t = dataset["time"].values
    ground = np.zeros_like(t)
    if "u_g_ddot" in dataset:
        ground = ground_displacement(t, dataset["u_g_ddot"].values)
    upper = figure.add_axes((0.02, 0.33, 0.96, 0.65))
    lower = figure.add_axes((0.12, 0.1, 0.84, 0.2))
    lines = None
    moves = [ground]
    if building is not None:
        sway = _drawn_sway(case, dataset, building, scale)
        moves.append((ground + sway).ravel())
        lines = BuildingLines(upper, building, _feet(case, building), sway)
    if case.wall is not None:
        angle = np.clip(scale.rotation * dataset["theta"].values, -np.pi / 2, np.pi / 2)
        tip = scale.deflection * _deflections(case, dataset, np.ones(1))[0]
        moves.append(ground + 2 * case.wall.h * np.sin(angle) + tip)
    _frame_scene(upper, case, building, np.concatenate(moves))
    move_wall = _wall(upper, case, dataset, scale, ground)
    (soil,) = upper.plot([], [], color=GREY, linewidth=3, zorder=1)
    soil_ends = np.array(upper.get_xlim()) * 0.92
    label = upper.text(0.01, 1.0, "", transform=upper.transAxes, va="top")
    shown = dataset["u_s"] if "u_s" in dataset else dataset["theta"]
    lower.plot(t, shown.values, color=COLOURS[0], linewidth=1.0)
    (cursor,) = lower.plot([t[0]], [shown.values[0]], "o", color=COLOURS[1], markersize=5)
    roof = "roof " if case.storeys is not None else ""
    label_of_shown = f"{roof}$u_s$ (m)" if "u_s" in dataset else r"$\theta$ (rad)"
    lower.set(xlabel="time $t$ (s)", ylabel=label_of_shown)
    lower.margins(x=0)
    end = _end_of(dataset)
    drawn = in_words(case, scale).replace(", ", ",\n")
    if building is not None and building.has_yielded.any():
        drawn += "\norange: storeys that have yielded"
    upper.text(0.99, 1.0, drawn, transform=upper.transAxes, va="top", ha="right", gid=_STILL)

    def draw(i: int) -> None:
        state, face = move_wall(i)
        if lines is not None:
            lines.move(i, ground[i], face)
        soil.set_data(ground[i] + soil_ends, [0.0, 0.0])
        state = end if end and i == t.size - 1 else state
        label.set_text(f"t = {t[i]:.2f} s" + (f", {state}" if state else ""))
        cursor.set_data([t[i]], [shown.values[i]])

    return draw


def _feet(case: Case, building: Building) -> Array:
    """Return the positions of both columns [m]: left of the wall, or in the middle."""
    if case.wall is None:
        return float(building.levels[-1]) * np.array([-0.3, 0.3])
    return np.asarray(levels.outermost(case)[0] - case.wall.h * np.array([2.0, 1.0]))


def _frame_scene(ax: Axes, case: Case, building: Building | None, moves: Array) -> None:
    """Set the limits of the picture, filled by the building and its displacements."""
    height = max(
        2 * case.wall.h if case.wall is not None else 0.0,
        float(building.levels[-1]) if building is not None else 0.0,
    )
    sides = [] if case.wall is None else [*levels.outermost(case)]
    sides += [] if building is None else [*_feet(case, building)]
    left = min(sides) + float(moves.min()) - 0.08 * height
    right = max(sides) + float(moves.max()) + 0.08 * height
    box = ax.get_window_extent()
    # room for the texts above
    upward = max(1.33 * height, (right - left) * box.height / box.width)
    beside = 0.5 * (upward * box.width / box.height - (right - left))
    ax.set(xlim=(left - beside, right + beside), ylim=(-0.08 * height, upward - 0.08 * height))
    ax.set_aspect("equal")
    ax.set_axis_off()


def _wall(
    ax: Axes, case: Case, dataset: xr.Dataset, scale: Scale, ground: Array
) -> Callable[[int], tuple[str, Array | None]]:
    """Draw wall, cable and impacts; return the function that moves them."""
    if case.wall is None:
        return lambda _: ("", None)
    h, b, is_pinned = case.wall.h, case.wall.b, case.wall.base == "pinned"
    share = _FACE if case.bending is not None else _FACE[[0, -1]]
    bent = scale.deflection * _deflections(case, dataset, share)
    axes, rods = levels.axes_of(case), grouped(levels.lines_of(case), lambda line: line.kind)
    walls = [ax.fill([0], [0], facecolor=PALE, edgecolor=INK, zorder=3)[0] for _ in axes]
    drawn = {
        kind: ax.plot(
            [], [], color=COLOURS[levels.COLOURS_OF[kind]] if kind in levels.COLOURS_OF else GREY,
            linewidth=1.2 if kind == "cable" else 2.0, zorder=4,
        )[0]
        for kind in rods
    }  # fmt: skip
    (hinge,) = ax.plot([], [], "o", color=INK, markersize=6, zorder=5)
    (flash,) = ax.plot([], [], "*", color=COLOURS[1], markersize=16, zorder=5)
    press = _pressure(ax, case, dataset, scale)
    theta, t = dataset["theta"].values, dataset["time"].values
    slip = dataset["base_slip"].values if "base_slip" in dataset else np.zeros_like(t)
    impacts = dataset["event_time"].values[dataset["event"].values == "impact"]
    still = "at rest" if case.bending is None else "both corners down"

    def move(i: int) -> tuple[str, Array | None]:
        angle = scale.rotation * theta[i]
        box = corners(h, b, angle, is_pinned) + np.array([ground[i] + slip[i], 0.0])
        across = np.outer(bent[:, i], [np.cos(angle), -np.sin(angle)])

        def bend(foot: Array, top: Array) -> Array:
            return foot + np.outer(share, top - foot) + across

        left, right = bend(box[0], box[3]), bend(box[1], box[2])
        outline = np.concatenate((right, left[::-1]))
        for wall, axis in zip(walls, axes, strict=True):
            wall.set_xy(outline + np.array([axis, 0.0]))

        def place(end: tuple[int, float, float]) -> Array:
            number, x, z = end
            if number < 0:
                return np.array([ground[i] + x, z])
            across, along = (box[1] - box[0]) / (2 * b), (box[3] - box[0]) / (2 * h)
            return np.asarray(box[0] + np.array([axes[number], 0.0]) + (x + b) * across + z * along)

        for kind, line in drawn.items():
            # the tendon follows a wall that bends
            join = bend if kind == "cable" else (lambda *ends: np.stack(ends))
            line.set_data(*_joined([join(*map(place, item.ends)) for item in rods[kind]]))
        if press is not None:
            return press(i, ground[i] + slip[i]), left
        if is_pinned:
            hinge.set_data([ground[i]], [0.0])
            return "", left
        past = t[i] - impacts
        hit = np.any((past >= 0) & (past < _FLASH))
        # rotation about the corner that has come down
        down = box[1] if theta[i] > 0 else box[0]
        struck = down[0] + np.array(axes) if hit else np.empty(0)
        flash.set_data(struck, np.zeros(struck.size))
        state = still if theta[i] == 0.0 else ("impact" if hit else "rocking")
        return state, left

    return move


def _pressure(
    ax: Axes, case: Case, dataset: xr.Dataset, scale: Scale
) -> Callable[[int, float], str] | None:
    """Draw the settlement under a base that gives, as its pressure; return the function moving it.

    The largest settlement is drawn a tenth of the height deep.
    """
    if case.base is None or "base_height" not in dataset:
        return None
    place = np.linspace(-case.wall.b, case.wall.b, 81)
    sine, middle = np.sin(dataset["theta"].values), dataset["base_height"].values
    deepest = float(np.max(case.wall.b * np.abs(sine) - middle))
    (shape,) = ax.fill([0], [0], facecolor=COLOURS[1], edgecolor="none", alpha=0.6, zorder=2)
    depth = 0.2 * case.wall.h / max(deepest, np.finfo(float).tiny)

    def move(i: int, middle_at: float) -> str:
        settled = np.maximum(0.0, place * sine[i] - middle[i])
        below = np.column_stack([place, -depth * settled])
        above = np.column_stack([place[::-1], np.zeros_like(place)])
        shape.set_xy(np.concatenate([below, above]) + np.array([middle_at, 0.0]))
        share = np.mean(settled > 0)
        return "in the air" if share == 0.0 else f"{share:.0%} of the base in contact"

    return move
