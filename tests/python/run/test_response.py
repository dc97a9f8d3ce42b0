"""A response has storeys and floors as dimensions, a headline, and every flat name."""

import copy
import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT, run_python
from rwmf.cli import main
from rwmf.run import simulation
from rwmf.run.quantities import QUANTITIES, find, find_numbered
from scenes import bare_frame, block, coupled

HEIGHT = (4.0, 3.0, 3.5)
MOTION = rwmf.Motion(4.0 * np.sin(np.arange(80) * 0.15), dt=0.02, unit="m/s2", name="waves")


def _storeys(coupling: str, **changes: object) -> rwmf.Case:
    case = coupled(
        wall={"h": sum(HEIGHT) / 2, "b": 1.0, "m_w": 3.0e4},
        frame={"T_s": None, "gamma": None},
        storeys={"m_over_m_w": [2.0, 2.0, 1.5], "k_over_m_w": [2e3, 1.5e3, 1e3],
                 "height": HEIGHT, "coupling": coupling},
        yielding={"storey_u_y": 0.01} if coupling != "reduced" else None,
        motion=MOTION, solver={"t_end": 2.0}, output={"reactions": True, "dt": 0.02},
    )  # fmt: skip
    return case.replace(**changes)  # type: ignore[arg-type]


SCENES = {
    **{name: lambda name=name: _storeys(name) for name in ("full", "every_floor", "reduced")},
    "one storey": lambda: coupled(
        motion=MOTION, solver={"t_end": 2.0}, output={"reactions": True, "dt": 0.02}
    ),
    "no wall": lambda: bare_frame(output={"reactions": True, "dt": 0.02}),
    "no frame": lambda: block(output={"reactions": True, "dt": 0.02}),
}


@pytest.mark.parametrize("scene", SCENES)
def test_every_flat_name_is_a_variable(scene: str) -> None:
    """Each key and column of the kernel, of any number, by its name."""
    case = SCENES[scene]()
    run = rwmf.simulate(case)
    with simulation.start(case) as result:
        summary = result.summary()
        columns, values = result.history()
    for key, value in summary.items():
        for name in find(key).names("run"):
            assert name in run
            assert run[name].dims == ()
            assert run[name].item() == value, name
            assert getattr(run, name).identical(run[name])
            assert run[name].attrs == find(key).attributes
    for column, row in zip(columns, values, strict=True):
        for name in find(column).names("history"):
            assert run[name].dims == ("time",)
            assert run[name].values.tobytes() == row.tobytes()
            assert run[name].attrs == find(column).attributes
    changed = {"seconds"}
    assert {key: value for key, value in run.flat().items() if key not in changed} == {
        key: "\n".join(value) if key == "warnings" else value
        for key, value in summary.items()
        if key not in changed
    }


@pytest.mark.parametrize("scene", SCENES)
def test_no_variable_has_a_number(scene: str) -> None:
    """Quantities of the table with a number have a dimension, with number and height [m]."""
    case = SCENES[scene]()
    run = rwmf.simulate(case)
    n = 1 if case.storeys is None else len(HEIGHT)
    names = {item.over_levels.name: item for item in QUANTITIES.values() if item.level}
    assert not [name for name in run.variables if any(part.isdigit() for part in name.split("_"))]
    for name, values in run.data_vars.items():
        level = names[name].level if name in names else ""
        assert {*values.dims} & {"storey", "floor", "mode"} == {level} - {""}
        if level in ("storey", "floor"):
            assert list(run[level].values) == list(range(1, n + 1))
    if case.frame is not None:
        assert "floor" in run.dims
    heights = HEIGHT if case.storeys is not None else [2 * case.wall.h] if case.wall else []
    if "floor" in run.dims and heights:
        assert list(run["floor_height"].values) == pytest.approx(np.cumsum(heights))
        assert run["floor_height"].attrs["units"] == "m"
    if case.storeys is not None:
        assert list(run["storey_height"].values) == pytest.approx(heights)


def test_the_roof_is_a_floor() -> None:
    run = rwmf.simulate(_storeys("full"))
    assert run["floors"].dims == ("time", "floor")
    assert (run["floors"].sel(floor=3) == run["u_s"]).all()
    drifts = run["floors"].diff("floor").values / np.array(HEIGHT[1:])
    assert drifts == pytest.approx(run["storeys_drift"].values[:, 1:], abs=1e-12)


def test_what_a_floor_lacks_is_absent() -> None:
    """The wall has a link at the roof alone."""
    run = rwmf.simulate(_storeys("full"))
    assert list(np.isnan(run["links_force_max"])) == [True, True, False]
    for name in ("link_1_force_max", "link_4_force_max", "link_0_force", "storey_9_drift"):
        assert name not in run
        with pytest.raises(KeyError):
            run[name]
        assert not hasattr(run, name)


def test_a_changed_response_stays_one() -> None:
    run = rwmf.simulate(_storeys("full"))
    drift = run["storey_3_drift"]
    for other in (run.copy(deep=True), copy.copy(run), pickle.loads(pickle.dumps(run)),
                  run.isel(time=slice(None)), run.assign(more=1.0)):  # fmt: skip
        assert isinstance(other, rwmf.Response)
        assert other["storey_3_drift"].identical(drift)
        assert other.headline() == run.headline()
    assert [*run[["u_s", "storey_2_drift"]].data_vars] == ["u_s", "storey_2_drift"]
    upper = run.sel(storey=[3])
    assert "storey_3_drift" in upper
    assert "storey_1_drift" not in upper
    assert run.assign(storey_2_drift=0.0)["storey_2_drift"].item() == 0.0


def test_a_response_from_a_file_is_drawn(tmp_path: Path) -> None:
    """A plain dataset of xarray has no flat names; figures need none."""
    case = _storeys("full")
    run = rwmf.simulate(case)
    run.to_netcdf(tmp_path / "run.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as read:
        for draw, words in ((rwmf.plot.history, {}), (rwmf.plot.profile, {}),
                            (rwmf.plot.envelope, {"case": case})):  # fmt: skip
            panels, expected = draw(read, **words), draw(run, **words)
            for ax, other in zip(panels, expected, strict=True):
                for line, same in zip(ax.lines, other.lines, strict=True):
                    assert np.array_equal(line.get_xydata(), same.get_xydata(), equal_nan=True)


def test_headline_of_a_building() -> None:
    case = _storeys("full", cable={"eta_y": 3.0})
    run = rwmf.simulate(case)
    lines = run.headline().splitlines()
    warned = run.attrs["warnings"].splitlines()
    assert warned
    assert [line.removeprefix("warning").strip() for line in lines[6:]] == warned
    storey = int(run["storeys_drift_max"].values.argmax()) + 1
    floor = int(run["floors_acceleration_max_g"].values.argmax()) + 1
    assert f"{1e3 * float(run['u_s_max']):.4g} mm" in lines[0]
    assert f"{100 * float(run['storey_drift_max']):.3g} % (storey {storey})" in lines[1]
    assert f"{float(run['floor_acceleration_max_g']):.3g} g (floor {floor})" in lines[2]
    force = float(run["tendon_force_max"])
    assert f"{force / 1e3:.4g} kN" in lines[3]
    assert f"{force / (3.0 * 3.0e4 * case.model.g):.3g} of yield" in lines[3]
    assert f"{100 * float(run['storey_residual_drift_max']):.3g} %" in lines[4]
    assert f"{int(run['impacts'])} impacts" in lines[5]
    assert repr(run).splitlines()[1 : 1 + len(lines)] == lines
    assert lines[0] in run._repr_html_()


@pytest.mark.parametrize(
    ("name", "place", "text"),
    [
        ("study_block.nml", 5, "overturned"),
        ("p_delta_collapse.nml", 5, "collapsed at "),
        ("fig05_stiff_frame_alone_one_sine.nml", 3, "no tendon"),
        ("study_block.nml", 1, "no frame"),
        ("fig12_one_cosine.nml", 2, " g (floor 1) at "),
        ("fig05_stiff_frame_alone_one_sine.nml", 4, "none: the frame returns"),
    ],
)
def test_headline_of_a_file(
    name: str, place: int, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(ROOT / "inputs" / name)
    assert main(["run", path]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert text in lines[place]
    assert rwmf.simulate(path).headline().splitlines()[:6] == lines[:6]
    assert not [line for line in lines if len(line) > 120]


@pytest.mark.parametrize("is_asked", [None, True, False])
def test_a_headline_is_that_of_the_command(
    is_asked: bool | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Forces and drifts are in the result unless the case declines them."""
    case = SCENES["one storey"]().replace(wall={"m_w": 5.0e3}, output={"reactions": is_asked})
    case.to_namelist(tmp_path / "case.nml")
    assert main(["run", str(tmp_path / "case.nml")]) == 0
    lines = capsys.readouterr().out.splitlines()
    run = rwmf.simulate(case)
    assert run.headline().splitlines()[:6] == lines[:6]
    if is_asked is False:
        assert "reactions = .false." in lines[1]
    else:
        assert f" {float(run['tendon_force_max']) / 1e3:.4g} kN" in lines[3]
        assert f" {100 * float(run['roof_drift_max']):.3g} % (one storey)" in lines[1]


_SELECTED = {
    "variables": lambda run: run[["theta", "u_s"]],
    "concat": lambda run: xr.concat([run, run], "record"),
    "expand_dims": lambda run: run.expand_dims("record"),
    "dropped": lambda run: run.drop_vars("u_s_max"),
    "scalars": lambda run: run[["u_s_max", "storey_2_drift_max"]],
    "one storey": lambda run: run.isel(storey=0, floor=0),
    "empty": lambda run: run[[]],
    "other warnings": lambda run: run[["theta"]].assign_attrs(warnings=3),
    "curve": lambda run: rwmf.pushover(_storeys("full"), 0.01, steps=2),
    "none": lambda run: rwmf.Response(),
}


@pytest.mark.parametrize("name", _SELECTED)
def test_a_selection_shows_the_table_of_xarray(name: str) -> None:
    selected = _SELECTED[name](rwmf.simulate(_storeys("full")))
    text, page = repr(selected), selected._repr_html_()
    if name == "one storey":
        assert selected.headline() in text
        return
    assert "Dimensions" in text
    assert "xr-wrap" in page
    with pytest.raises(rwmf.InputError, match=r"scalars of rwmf\.simulate"):
        selected.headline()


def test_groups_and_all_keys(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`--all` prints the keys of `--json`; the table has them in groups, levels on one line."""
    _storeys("every_floor").to_namelist(tmp_path / "case.nml")
    words = ["run", str(tmp_path / "case.nml")]
    printed = []
    for option in ("--json", "--all", None):
        assert main([*words, *([option] if option else [])]) == 0
        printed.append(capsys.readouterr().out)
    summary = json.loads(printed[0])
    lines = printed[1].splitlines()
    keys = [key for key in summary if not key.startswith("sensitivity_")]
    assert [line.split()[0] for line in lines] == keys
    rows = {line.split()[0]: line.split()[1:] for line in printed[2].splitlines()[6:]}
    drifts = [float(word) for word in rows["storey_1..3_drift_max"]]
    assert drifts == pytest.approx([summary[f"storey_{i}_drift_max"] for i in (1, 2, 3)], rel=1e-3)
    assert float(rows["u_s_max_m"][0]) == pytest.approx(summary["u_s_max_m"], rel=1e-5)
    assert float(rows["u_s_max_m"][2]) == pytest.approx(summary["t_u_s_max_s"], rel=1e-3)
    # every quantity is there: ratios as forces, times beside their peaks
    shown = {QUANTITIES[key.replace("1..3", "{i}")].name for key, words in rows.items() if words}
    for item, _ in map(find_numbered, keys):
        assert item.found == "time" or {item.name, item.name.removesuffix("_over_m_w_g")} & shown


def test_results_load_neither_scipy_nor_matplotlib(tmp_path: Path) -> None:
    """`import rwmf` loads no xarray; a response and a spectrum load nothing further."""
    code = (
        "import sys, rwmf\n"
        "slow = {'scipy', 'matplotlib', 'dask', 'h5py'}\n"
        "assert not {*slow, 'xarray', 'pandas', 'numpy'} & {*sys.modules}\n"
        f"case = rwmf.Case.from_namelist({str(ROOT / 'inputs' / 'fig12_one_cosine.nml')!r})\n"
        "assert not {*slow, 'xarray', 'pandas'} & {*sys.modules}\n"
        "run = rwmf.simulate(case, 0.1)\n"
        "rwmf.spectrum(case, T_s=[1.0])\n"
        "assert float(run['u_s_max']) > 0 and run.headline()\n"
        "assert not slow & {*sys.modules}, slow & {*sys.modules}\n"
    )
    done = run_python(code, tmp_path)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    "name", ["storeys_springs", "storeys_bending", "which_spring_takes_the_energy", "study_block"]
)
def test_table_has_a_row_for_each_time(name: str) -> None:
    """Columns have the names and numbers of single storeys, and no product with the events."""
    run = rwmf.simulate(ROOT / "inputs" / f"{name}.nml", dt=0.05)
    table = run.table()
    assert table.index.tolist() == run["time"].values.tolist()
    over_time = [x for x in run.data_vars.values() if "time" in x.dims]
    assert sum(int(np.prod(x.shape[1:])) for x in over_time) >= table.shape[1] >= len(over_time)
    for column in table:
        assert np.array_equal(table[column], run[column].values, equal_nan=True), column
        assert table.attrs["units"][column] == run[column].attrs["units"]
    if "storey" in run.dims:
        assert "storey_2_drift" in table and "storeys_drift" not in table
    levels = [size for level, size in run.sizes.items() if level not in ("time", "event")]
    assert len(run.to_dataframe()) == run.sizes["time"] * int(np.prod(levels))
    with pytest.raises(rwmf.InputError, match="table: no history"):
        run.drop_dims("time").table()


def test_a_static_curve_is_a_table_and_draws_itself() -> None:
    curve = rwmf.pushover(_storeys("full"))
    table = curve.table()
    assert table.index.name == "step"
    assert np.array_equal(table["roof_drift"], curve["roof_drift"])
    assert np.array_equal(table["storey_2_drift"], curve["storeys_drift"].sel(storey=2))
    assert len(curve.to_dataframe()) == curve.sizes["step"] * curve.sizes["storey"] ** 2
    (ax,), other = curve.plot(), rwmf.plot.pushover(curve)
    assert np.array_equal(ax.lines[0].get_xydata(), other.lines[0].get_xydata())


def test_a_response_draws_itself() -> None:
    run = rwmf.simulate(_storeys("full"))
    ours, theirs = run.plot(variables=["u_s"]), rwmf.plot.history(run, variables=["u_s"])
    for ax, other in zip(ours, theirs, strict=True):
        assert np.array_equal(ax.lines[0].get_xydata(), other.lines[0].get_xydata())
    # the methods of xarray remain
    assert run.plot.scatter(x="u_s", y="theta") is not None
    page = run._repr_html_()
    head, _, folded = page.partition("<details>")
    assert run.headline().splitlines()[0] in head
    assert "xr-wrap" in folded and "xr-wrap" not in head
