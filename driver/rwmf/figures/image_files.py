"""Writing of figures to files."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.figures import histories as plot
from rwmf.figures import loops
from rwmf.figures.profiles import demands_of, envelope, has_envelopes, profile
from rwmf.figures.styles import make_panels, new_figure
from rwmf.kernel import files
from rwmf.kernel.names import how_to_install
from rwmf.run.quantities import names_by_key

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure, FigureBase
    from matplotlib.transforms import BboxBase


# height of the panel of demands over the height of a building [inch]
_PROFILE = 2.6


def check_format(path: str | os.PathLike[str]) -> str:
    """Determine the format of a figure from its file's name."""
    try:
        from matplotlib.backend_bases import FigureCanvasBase
    except ModuleNotFoundError:
        raise InputError(f"figures need the package matplotlib: {how_to_install('plot')}") from None
    kind = Path(path).suffix.lstrip(".").lower()
    known = FigureCanvasBase.get_supported_filetypes()
    if kind not in known:
        raise InputError(f"{path}: {kind!r} is not a format of figures: {', '.join(known)}")
    return kind


def check_formats(*paths: str | None) -> None:
    """Check the file names of figures before a computation."""
    for path in filter(None, paths):
        check_format(path)


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure; after a failure an earlier file is unchanged."""
    kind = check_format(path)
    _fix_layout(figure)
    # without a date equal figures give equal files
    dated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with files.replacing(path) as stream:
        figure.savefig(stream, format=kind, metadata=dated.get(kind))


@contextmanager
def drawn(path: str | os.PathLike[str], height: float) -> Iterator[Figure]:
    """Make a figure, and write it at the end of the block."""
    with new_figure(height) as figure:
        yield figure
        save(figure, path)


def draw_into(path: str | None, height: float, draw: Callable[[Figure], object]) -> None:
    """Draw a figure of a given height [inch] into a file, unless there is none."""
    if path is not None:
        with drawn(path, height) as figure:
            draw(figure)


def _fix_layout(figure: Figure) -> None:
    """Lay the figure out, without the round-off of the layout, which differs between calls."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for part in figure.subfigs:
        part.bbox_relative.bounds = _rounded(part.bbox_relative)
    for axes in figure.axes:
        axes.set_position(_rounded(axes.get_position(original=True)))


def _rounded(box: BboxBase) -> tuple[float, float, float, float]:
    # the sum has no negative zero
    x, y, width, height = (round(value, 9) + 0.0 for value in box.bounds)
    return x, y, width, height


def save_history(
    dataset: xr.Dataset, path: str | os.PathLike[str], case: Case | None = None
) -> None:
    """Draw a history into a file, and for storeys also demands and forces over the height."""
    names, demands = plot.panels_of(dataset), demands_of(dataset)
    heights = [0.8 + 1.4 * len(names)]
    heights += [_PROFILE] * bool(demands)
    forces = case if demands and has_envelopes(dataset) else None
    heights += [_PROFILE] * (forces is not None)
    with drawn(path, sum(heights)) as figure:
        upper: FigureBase = figure
        if demands:
            parts = figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
            upper = parts[0]
            profile(dataset, parts[1].subplots(1, len(demands), sharey=True), case=case)
            if forces is not None:
                envelope(dataset, forces, parts[2].subplots(1, 3, sharey=True))
        axes = upper.subplots(len(names), 1, sharex=True, squeeze=False)
        plot.history(dataset, axes[:, 0], names, case=case)
        upper.align_ylabels()


def save_loops(dataset: xr.Dataset, case: Case, path: str | os.PathLike[str]) -> None:
    """Draw the force-displacement loops of the springs into a file."""
    n = len(loops.group_by_kind(loops.find_loops(dataset, case)))
    with drawn(path, 3.0) as figure:
        loops.draw(dataset, case, figure.subplots(1, n, squeeze=False)[0])


def save_spectrum(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Draw a spectrum into a file, one panel per quantity."""
    names = list(names_by_key(name for name in dataset.data_vars if name != "status").values())
    with drawn(path, 3.6 if len(names) == 1 else 2.8 * len(names)) as figure:
        panels = make_panels(figure.subplots(len(names)), len(names))
        for ax, name in zip(panels, names, strict=True):
            plot.spectrum(dataset, ax, quantities=name)
