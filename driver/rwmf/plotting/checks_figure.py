"""Figure of checks: ratios of demands over limits, those of floors and storeys over the height."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from rwmf._arguments import checked
from rwmf._checks.checks import Checks, LimitCheck
from rwmf._numbers import show
from rwmf.errors import InputError
from rwmf.plotting import image_files as figures
from rwmf.plotting.style import COLOURS, INK, LIMIT, Panels, make_panels, new_figure, series
from rwmf.quantities import find_numbered

if TYPE_CHECKING:
    from matplotlib.axes import Axes


# longest drawn ratio; larger ones end at an arrow
_LONGEST = 3.0
_MET, _EXCEEDED = COLOURS[0], COLOURS[1]


@checked
def checks(found: Checks, axes: Axes | Sequence[Axes] | np.ndarray | None = None) -> Panels:
    """Draw ratios of demands over limits.

    Parameters
    ----------
    found : Checks
        From `rwmf.checks`, of a run or of one suite.
    axes : matplotlib axes or sequence of axes, optional
        One for the bars and, with limits of floors or storeys, one for the ratios over the height;
        otherwise a new figure.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes. A bar is the ratio of a run or the median of a suite. The line of a suite covers
        16 to 84 %, and its dot is the largest ratio.

    Raises
    ------
    InputError
        When `found` holds no checks, or those of a grid with several points.
    """
    if not isinstance(found, Checks) or not found.rows:
        raise InputError(f"found = {show(found)}: must be the result of rwmf.checks")
    if any(row.at != found.rows[0].at for row in found.rows):
        raise InputError("found: has several points of a grid: select one before rwmf.checks")
    groups = _over_height(found)
    panels = make_panels(axes, 1 + bool(groups), across=True)
    _draw_bars(panels[0], _bars(found, groups))
    if groups:
        _draw_heights(panels[1], groups)
    for ax in panels:
        ax.axvline(1.0, **LIMIT | {"linewidth": 1.4})
        ax.set_xlim(0, min(max(1.1, 1.05 * _reach(found)), _LONGEST))
        ax.set_xlabel("demand over limit")
    return panels


def save_checks(found: Checks, path: str | os.PathLike[str]) -> None:
    """Draw checks into a file."""
    groups = _over_height(found)
    n = len(_bars(found, groups))
    with new_figure(max(0.9 + 0.26 * n, 3.0 if groups else 0.0)) as figure:
        axes = figure.subplots(
            1, 1 + bool(groups), squeeze=False, width_ratios=[1.2, 1.0][: 1 + bool(groups)]
        )
        checks(found, axes[0])
        figures.save(figure, path)


def _over_height(found: Checks) -> dict[str, list[LimitCheck]]:
    """Return the checks of several floors or storeys by their key in `&limits`."""
    groups: dict[str, list[LimitCheck]] = {}
    for row in found.rows:
        if row.number:
            groups.setdefault(find_numbered(row.key)[0].limit_key, []).append(row)
    return {key: rows for key, rows in groups.items() if len(rows) > 1}


def _bars(found: Checks, groups: dict[str, list[LimitCheck]]) -> list[tuple[str, LimitCheck]]:
    """Return labels and checks of the bars: the largest of each group over the height."""
    bars: dict[str, LimitCheck] = {}
    for row in found.rows:
        key = find_numbered(row.key)[0].limit_key
        label = key if key in groups else row.key
        if label not in bars or _size(row) > _size(bars[label]):
            bars[label] = row
    return list(bars.items())


def _size(row: LimitCheck) -> float:
    """Return the ratio that is drawn: the median of a suite."""
    ratio = row.ratios[50.0] if row.ratios else row.ratio
    return 0.0 if math.isnan(ratio) else ratio


def _reach(found: Checks) -> float:
    return max((row.ratio for row in found.rows if not math.isnan(row.ratio)), default=1.0)


def _draw_bars(ax: Axes, bars: list[tuple[str, LimitCheck]]) -> None:
    for i, (_, row) in enumerate(bars):
        ratio = _size(row)
        ax.barh(i, min(ratio, _LONGEST), 0.62, color=_MET if ratio <= 1 else _EXCEEDED)
        if row.ratios:
            ends = [min(row.ratios[q], _LONGEST) for q in (16.0, 84.0)]
            ax.plot(ends, [i, i], color=INK, linewidth=1.2)
            largest = row.ratios[100.0]
            ax.plot(
                min(largest, _LONGEST), i, color=INK, clip_on=False, markersize=4,
                marker="o" if largest <= _LONGEST else ">",
            )  # fmt: skip
    ax.set_yticks(range(len(bars)), [label for label, _ in bars])
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")


def _draw_heights(ax: Axes, groups: dict[str, list[LimitCheck]]) -> None:
    for i, (key, rows) in enumerate(groups.items()):
        numbers = [row.number for row in rows]
        sizes = [min(_size(row), _LONGEST) for row in rows]
        if rows[0].key.startswith("storey"):
            # constant over the storey
            numbers = np.repeat([[n - 1, n] for n in numbers], 1, axis=0).ravel().tolist()
            sizes = np.repeat(sizes, 2).tolist()
            ax.plot(sizes, numbers, label=key, **series(i, len(groups)))
        else:
            ax.plot(sizes, numbers, label=key, marker="o", markersize=3, **series(i, len(groups)))
    top = max(row.number for rows in groups.values() for row in rows)
    ax.set_ylim(0, top + 0.1)
    ax.set_yticks(range(0, top + 1, 1 + top // 8))
    ax.set_ylabel("floor")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=1, borderpad=0.2)
