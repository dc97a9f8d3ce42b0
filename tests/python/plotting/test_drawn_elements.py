"""Films of walls side by side: drawn strokes against the strokes of the history."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rwmf

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from rwmf.explorer.model import Model
from rwmf.explorer.questions import given, read
from rwmf.figures.film import Scale, _stage, find_building
from rwmf.figures.levels import COLOURS_OF
from rwmf.figures.styles import COLOURS, GREY, PALE, new_figure

TEXT = """
&wall h = 4.0, b = 1.0, walls = 3 /
&cable offset = -0.5, 0.7, height = 8.0, 6.5, eta_0 = 0.4, eta_alpha = 5.0, law = 'truss' /
&coupling k_over_m_w = 10.0 /
&restraint offset = -1.0, 4.0, height = 4.0, 8.0, k_over_m_w = 8.0, 3.0 /
&motion kind = 'one_sine', a_max_g = 0.9, T_p = 0.8 /
&frame T_s = 0.6, gamma = 3.0, xi_s = 0.05 /
&model formulation = 'exact' /
&solver t_end = 1.2 /
"""


def _parts(ax: Axes, colour: str, width: float = 2.0) -> list[np.ndarray]:
    """Return the two ends of each line of a colour."""
    (line,) = (x for x in ax.lines if x.get_color() == colour and x.get_linewidth() == width)
    points = np.asarray(line.get_xydata()).reshape(-1, 3, 2)
    return list(points[:, :2])


@pytest.mark.parametrize("side", [1, -1])
def test_lines_of_a_film_have_the_strokes_of_the_history(side: int) -> None:
    case = rwmf.Case.from_text(TEXT)
    run = rwmf.simulate(case, dt=0.01)
    i = int((side * run["theta"]).values.argmax())
    theta = float(run["theta"][i])
    with new_figure(6.0) as figure:
        _stage(figure, case, run, find_building(case, run), Scale(1.0, 1.0))(i)
        ax = figure.axes[0]
        walls = [x for x in ax.patches if x.get_facecolor()[:3] == (float(PALE),) * 3]
        assert len(walls) == 3
        tendons = _parts(ax, COLOURS[COLOURS_OF["cable"]], 1.2)
        couplings = _parts(ax, COLOURS[COLOURS_OF["coupling"]])
        restraints = _parts(ax, COLOURS[COLOURS_OF["restraint"]])
        columns = [x for x in ax.lines if x.get_color() == GREY]
    lengths = [np.linalg.norm(top - foot) for foot, top in tendons]
    arms = np.tile([1.0 + side * 0.5, 1.0 - side * 0.7], 3)
    heights = np.tile([8.0, 6.5], 3)
    phi = abs(theta)
    expected = np.hypot(heights + arms * np.sin(phi), arms * (1 - np.cos(phi)))
    assert lengths == pytest.approx(expected, rel=1e-12)
    # between both gaps at several heights
    assert len(couplings) == 8
    for left, right in couplings:
        assert right[1] - left[1] == pytest.approx(2.0 * np.sin(theta), abs=1e-12)
    for (point, column), d, z in zip(restraints, (-1.0, 4.0), (4.0, 8.0), strict=True):
        rise = (1.0 - side * d) * np.sin(phi) - z * (1 - np.cos(phi))
        assert point[1] - column[1] == pytest.approx(rise, abs=1e-12)
    assert len(columns) == 3, "the ground, columns, and a rigid arm"


def test_explorer_draws_the_lines_of_the_film() -> None:
    case = rwmf.Case.from_text(TEXT)
    model = Model(case, Path("/proc/nowhere"))
    scene = model.history(read({"groups": given(case)}), lambda _: None)["scene"]
    kinds = [kind for kind, *_ in scene["lines"]]
    assert (kinds.count("cable"), kinds.count("coupling"), kinds.count("restraint")) == (6, 8, 2)
    first, _, last = scene["axes"]
    # beyond the outer walls: columns of the restraints
    assert scene["ends"][0] < first - 1.0 and scene["ends"][1] > last + 4.0
