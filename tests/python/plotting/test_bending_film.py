"""Films of a wall that bends: shapes against the kernel, deflections as they are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT

pytest.importorskip("matplotlib")

from rwmf import cli
from rwmf.figures.film import _stage, find_building, in_words, scale_of
from rwmf.figures.levels import mode_shapes
from rwmf.figures.styles import new_figure

COUPLINGS = ("full", "reduced", "every_floor", "springs", "single", "none")


def _bent(coupling: str, t_end: float = 0.7, **bending: object) -> rwmf.Case:
    name = "every_floor" if coupling in ("single", "none") else coupling
    case = rwmf.Case.from_namelist(ROOT / "inputs" / f"storeys_{name}.nml").without("spectrum")
    if coupling in ("single", "none"):
        case = case.replace(storeys=None, frame={"T_s": 0.8, "gamma": 5.0})
    if coupling == "none":
        case = case.without("frame")
    return case.replace(
        wall={"density": 2500.0, "thickness": 0.3},
        impact={"rule": "coupled", "e": None},
        model={"formulation": "exact"},
        bending={"EI_over_m_w": 2e5, "modes": 2} | bending,
        solver={"t_end": t_end},
        output={"dt": 0.02, "reactions": True},
    )


@pytest.mark.parametrize(
    "bending",
    [
        {"modes": 1},
        {"modes": 3, "nu": 0.0},
        {"modes": 5, "nu": 0.35},
        {"modes": 12},
        {"EI_over_m_w": None, "E": 2e9, "cracking": 0.4, "modes": 4, "nu": 0.2},
    ],
    ids=str,
)
def test_shapes_are_those_of_the_kernel(bending: dict[str, object]) -> None:
    """Linked floors move with the wall: their displacements have the kernel's shapes."""
    case = _bent("every_floor", 0.1, **bending)
    run = rwmf.simulate(case.replace(output={"dt": 0.005}))
    heights = np.cumsum(case.storeys.height)
    floors = np.cumsum(run["storeys_drift"].values * np.array(case.storeys.height), axis=1)
    modes, turn = run["qs"].values[:, : case.bending.modes], np.cos(run["theta"].values)
    shapes = mode_shapes(case, heights / heights[-1])
    assert shapes.shape == (heights.size, case.bending.modes)
    assert shapes[-1] == pytest.approx(1.0)
    bent = modes @ shapes.T * turn[:, None]
    straight = (floors[:, -1] - bent[:, -1])[:, None] * heights / heights[-1]
    assert np.abs(bent[:, 1]).max() > 1e-6
    assert floors - straight == pytest.approx(bent, rel=1e-9, abs=1e-9 * np.abs(bent).max())


def test_pinned_numbers_of_the_modes() -> None:
    """Zeros of the second and third mode of a slender cantilever [textbooks]."""
    zeros = np.array([0.78344455, 0.50354787, 0.86767759])
    shapes = mode_shapes(_bent("none", modes=3), zeros)
    assert [shapes[0, 1], shapes[1, 2], shapes[2, 2]] == pytest.approx([0.0] * 3, abs=1e-7)
    assert mode_shapes(_bent("none").without("bending"), zeros).shape == (3, 0)


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_the_drawn_wall_bends(coupling: str) -> None:
    """The top is at its exaggerated place, links keep their length, the caption has the factors."""
    case = _bent(coupling)
    run = rwmf.simulate(case)
    building = find_building(case, run)
    scale = scale_of(case, run, building)
    tip = run["qs"].values[:, : case.bending.modes].sum(axis=1)
    height = 2 * case.wall.h
    assert scale.deflection >= scale.rotation
    assert scale.deflection * np.abs(tip).max() / height > 0.048
    i = int(np.argmax(np.abs(tip)))
    with new_figure(6.0) as figure:
        draw = _stage(figure, case, run, building, scale)
        draw(0)
        ax = figure.axes[0]
        left, links = [], []
        for sample in (0, i):
            draw(sample)
            outline = np.asarray(ax.patches[0].get_path().vertices)[:-1]
            n = len(outline) // 2
            left.append(outline[n:][::-1])
            assert len(outline) == 82
            links.append(np.asarray(ax.lines[4].get_xydata()) if building else np.empty((0, 2)))
        assert in_words(case, scale) in ax.texts[1].get_text().replace("\n", " ")
        # the building fills the picture, and nothing leaves it
        low, high = ax.get_ylim()
        assert (high - low) == pytest.approx(1.33 * height) or building is None
        seen = np.concatenate([line.get_xydata() for line in ax.lines if line.get_linewidth() < 3])
        (west, east), xs = ax.get_xlim(), seen[np.isfinite(seen[:, 0]), 0]
        assert west < xs.min() and xs.max() < east
    face, angle = left[1], scale.rotation * float(run["theta"][i])
    along = face - face[0]
    line = along @ [np.cos(angle), -np.sin(angle)]
    shape = mode_shapes(case, np.linspace(0, 1, 41)) @ run["qs"].values[i, : case.bending.modes]
    assert line == pytest.approx(scale.deflection * shape, abs=1e-12 * height)
    if building is None or coupling in ("full", "reduced", "springs"):
        return
    # no link opens: frame and wall are drawn with the same deflection
    ends = [np.diff(x[np.isfinite(x[:, 0])].reshape(-1, 2, 2), axis=1)[..., 0] for x in links]
    assert ends[1] == pytest.approx(ends[0], abs=0.02 * height)


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command says both factors."""
    path = tmp_path / "case.nml"
    _bent("springs", 0.5).to_namelist(path)
    words = ["animate", str(path), "--fps", "4", "--out", str(tmp_path / "film.gif")]
    assert cli.main(words) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert "rotations and drifts drawn" in last
    assert last.endswith("times")
    assert ", deflection of the wall " in last
