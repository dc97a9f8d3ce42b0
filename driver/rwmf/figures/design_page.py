"""One page about a design: checks, figure, namelist and commands."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rwmf.case.namelist import compose
from rwmf.figures.image_files import drawn
from rwmf.figures.styles import INK, legend_above, new_figure, plain, series
from rwmf.kernel import files
from rwmf.kernel.names import readable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rwmf.assess.design import Design


_STYLE = (
    "body{font-family:sans-serif;max-width:60em;margin:2em auto}"
    "table{border-collapse:collapse}td,th{border:1px solid;padding:.3em .6em;text-align:left}"
    "pre{white-space:pre-wrap}"
)
# height of the figure of the checks, and of the printed page [inch]
_CHECKS, _PAGE = 1.2, 9.5
# margin and height of a line over the page
_MARGIN, _LINE = 0.05, 0.0165


def is_html(path: str | os.PathLike[str]) -> bool:
    """Tell a page in HTML from one that is drawn."""
    return Path(path).suffix.lower() == ".html"


def write(found: Design, path: str | os.PathLike[str], commands: Sequence[str] = ()) -> None:
    """Write the page of a design."""
    if is_html(path):
        files.write_bytes(path, readable(_html(found, commands)).encode())
        return
    with drawn(path, _PAGE) as figure:
        _draw_page(figure, found, commands)


def draw_checks(found: Design, ax: Axes) -> Axes:
    """Draw the utilisation of all targets: the suite of the design beside the records left out."""
    n = len(found.checks)
    # the first target on top
    places = np.arange(n, 0, -1)
    for i, (label, values) in enumerate(
        (
            ("suite of the design", [check.utilisation for check in found.checks]),
            ("records left out", [check.utilisation_left_out for check in found.checks]),
        )
    ):
        shown = [value if math.isfinite(value) else np.nan for value in values]
        if not np.isnan(shown).all():
            colour = series(i, 2)["color"]
            ax.barh(places - 0.16 - 0.24 * i, shown, 0.22, label=label, color=colour)
    for place, check in zip(places, found.checks, strict=True):
        ax.text(0, float(place), f" {plain(check.target)}", va="bottom")
    ax.axvline(1.0, linewidth=1.0, color=INK)
    ax.set(yticks=[], ylim=(0.4, n + 0.35), xlabel="value over limit")
    legend_above(ax, 2)
    return ax


def _sentences(found: Design) -> list[str]:
    state = "The design meets all targets." if found.is_feasible else (
        "No computed design meets all targets; this one is nearest."
    )  # fmt: skip
    judged = (
        f"It was chosen with {len(found.records)} motions and judged on {len(found.left_out)} "
        f"records that were left out: {', '.join(found.left_out)}."
        if found.left_out
        else "No record was left out: the design is judged on its own motions."
    )
    cost = f"Cost {found.cost:.8g}; {found.designs} designs computed."
    return [state, *found.missed, cost, judged]


def _rows(found: Design) -> list[list[str]]:
    return [
        [
            check.target,
            f"{check.value:.5g}",
            f"{check.limit:.5g}",
            "yes" if check.is_met else "NO",
            "-" if math.isnan(check.value_left_out) else f"{check.value_left_out:.5g}",
        ]
        for check in found.checks
    ]


_HEAD = ["target", "value", "limit", "met", "left out"]


def _namelist(found: Design) -> str:
    groups = found.case.groups
    return compose({name: group.as_given() for name, group in groups.items()})


def _html(found: Design, commands: Sequence[str]) -> str:
    with new_figure(_CHECKS + 0.4 * len(found.checks)) as figure:
        draw_checks(found, figure.subplots())
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata={"Date": None})
    picture = stream.getvalue()
    picture = picture[picture.index("<svg") :]
    table = "".join(
        "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in row) + "</tr>"
        for tag, row in [("th", _HEAD), *(("td", row) for row in _rows(found))]
    )
    values = ", ".join(f"{name} = {value:.8g}" for name, value in found.values.items())
    parts = [
        f"<!DOCTYPE html><html lang='en'><meta charset='utf-8'><title>Design</title>"
        f"<style>{_STYLE}</style><h1>Design</h1><p><b>{escape(values)}</b></p>",
        *(f"<p>{escape(text)}</p>" for text in _sentences(found)),
        f"<table>{table}</table>{picture}",
        f"<h2>Namelist</h2><pre>{escape(_namelist(found))}</pre>",
    ]
    if commands:
        parts.append(f"<h2>Commands</h2><pre>{escape(chr(10).join(commands))}</pre>")
    return "\n".join(parts) + "\n</html>\n"


def _draw_page(figure: Figure, found: Design, commands: Sequence[str]) -> None:
    """Draw the page: sentences, checks, then namelist and commands as text."""
    import textwrap

    figure.set_layout_engine("none")
    values = ", ".join(f"{name} = {value:.8g}" for name, value in found.values.items())
    lines = [line for text in _sentences(found) for line in textwrap.wrap(text, 88)]
    table = [f"{row[0]}: {row[1]} (limit {row[2]}), left out {row[4]}" for row in _rows(found)]
    head = [values, *lines, *table]
    figure.text(_MARGIN, 0.98, plain("\n".join(head)), va="top")
    height = (_CHECKS + 0.4 * len(found.checks)) / _PAGE
    below = 0.98 - _LINE * len(head) - height - 0.05
    draw_checks(found, figure.add_axes((_MARGIN, below + 0.05, 1 - 2 * _MARGIN, height - 0.05)))
    # groups in one line each, so that the page holds them
    groups = _namelist(found).split("\n\n")
    texts = [" ".join(group.split()) for group in groups] + list(commands)
    lines = [line for text in texts for line in textwrap.wrap(text, 100)]
    figure.text(_MARGIN, below, plain("\n".join(lines)), va="top", family="monospace", fontsize=6)
