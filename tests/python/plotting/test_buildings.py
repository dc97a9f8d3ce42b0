"""Figures and films of frames with storeys show the numbers of their datasets."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from PIL import Image, ImageSequence
from rwmf import cli
from rwmf.figures import image_files as figures
from rwmf.figures.film import BuildingLines, animate, corners, find_building
from rwmf.figures.histories import members
from rwmf.figures.image_files import save_history
from rwmf.figures.styles import COLOURS, new_figure

WALL_GROUPS = ("wall", "cable", "impact")
# without a wall no floor is linked to it
SCENES = (
    ("full", True),
    ("reduced", True),
    ("every_floor", True),
    ("full", False),
    ("reduced", False),
)


def _five_storeys(coupling: str = "full", **groups: object) -> rwmf.Case:
    """Give five storeys beside a wall, one second and a half of a pulse, with all demands."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / f"storeys_{coupling}.nml")
    wanted = {"output": {"dt": 0.01, "reactions": True}, "solver": {"t_end": 1.5}}
    return case.replace(**(wanted | groups))  # type: ignore[arg-type]


def _alone(case: rwmf.Case) -> rwmf.Case:
    return case.without(*(name for name in WALL_GROUPS if name in case.groups))


def _drawn(ax: Axes) -> list[np.ndarray]:
    """Values of the lines over time; marks and levels have few points."""
    return [np.asarray(line.get_ydata()) for line in ax.lines if len(line.get_ydata()) > 100]


def _levels(ax: Axes) -> list[float]:
    pairs = [line.get_ydata() for line in ax.lines if len(line.get_ydata()) == 2]
    return sorted({float(y[0]) for y in pairs if y[0] == y[1]})


def _same(found: list[np.ndarray], dataset: xr.Dataset, names: list[str], factor: float) -> None:
    assert len(found) == len(names)
    for values, name in zip(found, names, strict=True):
        assert np.array_equal(values, factor * dataset[name].values, equal_nan=True)


@pytest.mark.parametrize(("coupling", "has_wall"), SCENES)
def test_panels_of_storeys(coupling: str, has_wall: bool) -> None:
    case = _five_storeys(coupling)
    run = rwmf.simulate(case if has_wall else _alone(case))
    panels = rwmf.plot.history(run)
    shown = {ax.get_ylabel(): ax for ax in panels}
    numbers = range(1, 6)
    ground = "ground acceleration\n" r"$\ddot u_g$ (m/s²)"
    _same(_drawn(shown[ground]), run, ["u_g_ddot"], 1.0)
    drifts = [f"storey_{i}_drift" for i in numbers]
    _same(_drawn(shown["interstorey drift\n(%)"]), run, drifts, 100.0)
    accelerations = [f"floor_{i}_acceleration_g" for i in numbers]
    _same(_drawn(shown["floor acceleration\n(g)"]), run, accelerations, 1.0)
    if coupling == "full":
        floors = [*(f"floor_{i}" for i in range(1, 5)), "u_s"]
        _same(_drawn(shown["floor displacement\n$u_i$ (m)"]), run, floors, 1.0)
    assert ("frame displacement\n$u_s$ (m)" in shown) == (coupling != "full")
    assert (r"wall rotation $\theta$ (rad)" in shown) == has_wall


def test_levels_of_storeys_that_yield_one_by_one() -> None:
    u_y = (0.02, 0.02, 0.03, 0.03, 0.03)
    case = _five_storeys(
        yielding={"storey_u_y": u_y}, p_delta={"m_g_over_m_s": 0.5, "drift_limit": 0.04}
    )
    run = rwmf.simulate(case)
    ax = rwmf.plot.history(run, variables=["storey_{i}_drift"], case=case)[0]
    first = [100 * 0.02 / 3.2, 100 * 0.03 / 3.2]
    # the limit is in reach
    assert 100 * float(run["storey_drift_max"]) > 4.0 / 1.5
    assert _levels(ax) == pytest.approx([-4.0, -first[1], -first[0], *first, 4.0])
    names = [child.get_texts() for child in ax.get_children() if hasattr(child, "get_texts")]
    texts = [text.get_text() for legend in names for text in legend]
    assert {"yield 0.625 to 0.938 %", "limit 4 %"} <= {*texts}
    assert {"1", "2", "3", "4", "5"} <= {*texts}
    assert _levels(rwmf.plot.history(run, variables=["storey_{i}_drift"])[0]) == []


def test_profile_against_the_dataset(tmp_path: Path) -> None:
    case = _five_storeys(yielding={"storey_u_y": 0.02})
    run = rwmf.simulate(case)
    with new_figure(2.6) as figure:
        panels = rwmf.plot.profile(run, figure.subplots(1, 3), case=case)
        drifts, accelerations, shears = panels
        for ax, name, factor in (
            (drifts, "storey_{}_drift_max", 100.0),
            (shears, "storey_{}_shear_max_over_m_w_g", 1.0),
        ):
            x, y = ax.lines[0].get_data()
            for i in range(1, 6):
                value = factor * float(run[name.format(i)])
                assert list(zip(x, y, strict=True))[2 * i - 2 : 2 * i] == [
                    (value, i - 1),
                    (value, i),
                ]
        x, y = accelerations.lines[0].get_data()
        assert list(y) == [1, 2, 3, 4, 5]
        assert list(x) == [float(run[f"floor_{i}_acceleration_max_g"]) for i in y]
        named = {line.get_label(): line.get_xdata() for line in drifts.lines}
        assert named["yield"] == pytest.approx(100 * 0.02 / 3.2)
        assert named["residual"][0] == 100 * abs(float(run["storey_1_residual_drift"]))
        larger = run.assign(floor_5_acceleration_max_g=5.0)
        rwmf.plot.profile(larger, panels, label="larger")
        assert accelerations.get_xlim()[1] > 5.0
        labels = [text.get_text() for text in drifts.get_legend().get_texts()]
        assert labels == ["residual", "yield", "larger", "larger, residual"]
    with pytest.raises(
        ValueError, match=r"must be the dataset of rwmf.simulate .* &output reactions"
    ):
        rwmf.plot.profile(rwmf.simulate(case.replace(output={"reactions": False})))


def test_run_draws_demands_that_the_case_does_not_ask_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The figure has them; the response is that of the case, bit by bit."""
    drawn: list[xr.Dataset] = []
    monkeypatch.setattr(
        figures, "save_history", lambda run, *rest: (drawn.append(run), save_history(run, *rest))
    )
    monkeypatch.chdir(tmp_path)
    bare = {"solver": {"t_end": 1.5}}
    for k, case in enumerate(
        (
            _five_storeys("full", output={"dt": 0.02, "reactions": False}),
            rwmf.Case.from_namelist(ROOT / "inputs" / "p_delta_collapse.nml").replace(**bare),
        )
    ):
        case.to_namelist("case.nml")
        assert cli.main(["run", "case.nml", "--out", f"{k}.png", "--json"]) == 0
        run, asked = drawn[k], rwmf.simulate(case)
        peak = "theta_max_over_alpha" if case.frame is None else "u_s_max"
        assert float(run[peak]) == float(asked[peak])
        assert ("floor_1_acceleration_g" in run) == (case.frame is not None)
        assert len(members(run, "storey_{i}_drift")) == (0 if case.storeys is None else 5)
        assert Path(f"{k}.png").stat().st_size > 1000


@pytest.mark.parametrize(("coupling", "has_wall"), SCENES)
def test_floors_of_a_film(coupling: str, has_wall: bool) -> None:
    """Floors are at the positions of the history; links keep their length at rest."""
    case = _five_storeys(coupling)
    case = case if has_wall else _alone(case)
    run = rwmf.simulate(case)
    building = find_building(case, run)
    assert building is not None
    assert building.levels == pytest.approx(3.2 * np.arange(1, 6))
    assert building.sway[-1] == pytest.approx(run["u_s"].values, abs=1e-14)
    if coupling == "full":
        assert building.sway[1] == pytest.approx(run["floor_2"].values, abs=1e-14)
    assert list(building.linked) == [has_wall and coupling == "every_floor"] * 4 + [has_wall]
    assert not building.has_yielded.any()
    i = int(np.argmax(np.abs(run["u_s"].values)))
    with new_figure(3.0) as figure:
        ax = figure.subplots()
        lines = BuildingLines(ax, building, np.array([-10.0, -6.0]), building.sway)
        face = corners(8.0, 2.0, float(run["theta"][i]))[[0, 3]] if has_wall else None
        lines.move(i, 0.3, face)
        columns, yielded, floors, hinges, links = (line.get_xydata() for line in ax.lines)
    assert not len(yielded)
    assert not len(hinges)
    ends = floors[np.isfinite(floors[:, 0])].reshape(5, 2, 2)
    assert ends[:, 0, 0] == pytest.approx(-10.0 + 0.3 + building.sway[:, i])
    assert ends[:, :, 1] == pytest.approx(np.repeat(building.levels[:, np.newaxis], 2, axis=1))
    assert len(columns) == 5 * 2 * 13
    drawn = links[np.isfinite(links[:, 0])].reshape(-1, 2, 2) if has_wall else np.empty((0, 2, 2))
    assert len(drawn) == building.linked.sum()
    # the ground is not moved here: the gap at rest is 4 m, of the roof exactly
    if has_wall:
        assert drawn[-1, 1, 0] - drawn[-1, 0, 0] + 0.3 == pytest.approx(4.0, abs=1e-9)


def test_storeys_that_have_yielded_are_marked() -> None:
    case = _five_storeys(yielding={"storey_u_y": (0.02, 9.0, 9.0, 9.0, 9.0)})
    run = rwmf.simulate(case)
    building = find_building(case, run)
    assert building is not None
    drift = np.abs(run["storey_1_drift"].values)
    first = int(np.argmax(drift > 0.02 / 3.2))
    assert list(np.flatnonzero(building.has_yielded[0])) == list(range(first, drift.size))
    assert not building.has_yielded[1:].any()
    with new_figure(3.0) as figure:
        ax = figure.subplots()
        lines = BuildingLines(ax, building, np.array([-10.0, -6.0]), building.sway)
        for i, is_marked in ((first - 1, False), (first, True), (drift.size - 1, True)):
            lines.move(i, 0.0, None)
            _, yielded, _, hinges, _ = ax.lines
            assert yielded.get_color() == hinges.get_color() == COLOURS[1]
            assert len(hinges.get_xydata()) == (4 if is_marked else 0)
            assert len(yielded.get_xydata()) == (2 * 13 if is_marked else 0)


@pytest.mark.parametrize(
    ("name", "groups"),
    [
        ("fig05_stiff_frame_alone_one_sine", {"solver": {"t_end": 1.0}}),
        ("storeys_reduced", {"solver": {"t_end": 1.0}}),
        ("study_block", {}),
        ("does_the_loss_of_strength_bring_it_down", {"motion": {"scale": 6.0}}),
    ],
)
def test_films(name: str, groups: dict[str, dict[str, float]], tmp_path: Path) -> None:
    """A frame alone, a mode, a wall that overturns, a frame that collapses: the end stays."""
    image = pytest.importorskip("PIL.Image")
    case = rwmf.Case.from_namelist(ROOT / "inputs" / f"{name}.nml").replace(**groups)
    case.to_namelist(tmp_path / "case.nml")
    film = tmp_path / "film.gif"
    words = ["animate", str(tmp_path / "case.nml"), "--fps", "4", "--out", str(film)]
    assert cli.main(words) == 0
    run = rwmf.simulate(case, dt=0.25)
    fall = [t for t, what in zip(run["event_time"].values, run["event"].values, strict=True)
            if what in ("overturned", "collapsed")]  # fmt: skip
    frames = int(4 * (fall[0] if fall else 1.0)) + 1 + (3 if fall else 0)
    durations = []
    with image.open(film) as found:
        for i in range(found.n_frames):
            found.seek(i)
            durations.append(found.info["duration"])
    # a picture that stays may be one of a longer duration
    assert sum(durations) == 250 * frames


def _film(tmp_path: Path, name: str) -> Path:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "storeys_full.nml")
    run = rwmf.simulate(case.replace(output={"dt": 0.5, "reactions": True}), dt=0.5)
    animate(case, run.isel(time=slice(0, 5)), tmp_path / name, 4)
    return tmp_path / name


def test_films_are_the_same_in_every_format(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """GIF and WebP by Pillow; raw pictures go to ffmpeg, here a program that keeps them."""
    pictures = []
    for name in ("film.gif", "film.webp"):
        with Image.open(_film(tmp_path, name)) as film:
            pictures.append([np.asarray(frame.convert("RGB"), dtype=float)
                             for frame in ImageSequence.Iterator(film)])  # fmt: skip
    assert len(pictures[0]) == len(pictures[1]) == 5
    program = tmp_path / "ffmpeg"
    # of no protocol and no option, whatever the folder is called
    program.write_text(
        '#!/bin/sh\nfor name; do :; done\ncase "$name" in file:*) cat >"${name#file:}";; esac\n',
        encoding="utf-8",
    )
    program.chmod(0o755)
    monkeypatch.setitem(matplotlib.rcParams, "animation.ffmpeg_path", str(program))
    raw = np.frombuffer(_film(tmp_path, "film.mp4").read_bytes(), dtype=np.uint8)
    raw = raw.reshape(5, *pictures[0][0].shape).astype(float)
    for i, picture in enumerate(raw):
        assert abs(picture - pictures[0][i]).mean() < 1.0
        assert abs(picture - pictures[1][i]).mean() < 3.0
        assert (picture != raw[i - 1]).any()
        # the paper is white, and everything that moves is there
        assert (pictures[0][i][0, 0] == 255).all()


def test_a_film_that_cannot_be_encoded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = tmp_path / "ffmpeg"
    program.write_text("#!/bin/sh\necho no space left >&2\nexit 1\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setitem(matplotlib.rcParams, "animation.ffmpeg_path", str(program))
    with pytest.raises(rwmf.OutputError, match=r"film.mp4: cannot be written: no space left"):
        _film(tmp_path, "film.mp4")
    assert not (tmp_path / "film.mp4").exists()
    with pytest.raises(rwmf.InputError, match="'avi' is not a format of films: gif, webp, mp4"):
        _film(tmp_path, "film.avi")
