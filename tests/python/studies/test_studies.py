"""Studies: published boundaries, closed forms, counted statistics, the command line."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from rwmf import cli, studies
from rwmf._sweep import RecordFile, find_records
from rwmf.errors import InputError
from scenes import bare_frame, block, coupled

QUICK = {"method": "dop853", "rtol": 1e-6}
# nonlinear block, alpha = 0.25 rad, w = 5, e = 0.9: amplitudes over alpha g by an independent
# program, printed to 1e-5
BOUNDARIES = [(3.03234, -1, 1), (6.74302, 1, -1), (7.49300, -1, 0)]
BOUNDARY_TOLERANCE = 1e-4


def _overturning_block() -> rwmf.Case:
    pulse = {"kind": "one_sine", "a_max_g": 1.0, "omega_p": 8.0}
    return block(wall={"b": 2 * math.tan(0.25)}, motion=pulse, solver={"method": "dop853"})


def test_published_overturning_boundaries() -> None:
    found = studies.overturning_map(_overturning_block(), [5.0], np.linspace(1, 9, 17))
    assert found.sizes["boundary"] == len(BOUNDARIES)
    for i, (amplitude, below, above) in enumerate(BOUNDARIES):
        at = found.isel(boundary=i)
        assert float(at["boundary_amplitude"]) == pytest.approx(amplitude, abs=BOUNDARY_TOLERANCE)
        assert (int(at["below"]), int(at["above"])) == (below, above)
        ratio = float(at["boundary_amplitude_over_g_tan_alpha"] / at["boundary_amplitude"])
        assert ratio == pytest.approx(0.25 / math.tan(0.25))
    assert found["outcome"].sel(amplitude=[1.0, 5.0, 7.0, 8.0]).values.tolist() == [[-1, 1, -1, 0]]


@pytest.fixture
def suite(tmp_path: Path) -> tuple[RecordFile, ...]:
    """Write three records of one column: noise that differs in strength."""
    chance = np.random.default_rng(7)
    for i in range(3):
        samples = (i + 1) * 0.1 * chance.standard_normal(150)
        text = "".join(f"{value!r}\n" for value in samples.tolist())
        (tmp_path / f"noise{i}.txt").write_text(text, encoding="ascii")
    return find_records([tmp_path / "noise*.txt"], unit="g", dt=0.04)


def test_ratio_without_a_wall_is_one(suite: tuple[RecordFile, ...]) -> None:
    """A wall that is too heavily held to lift off keeps the frame at rest; a free one does not."""
    held = coupled(cable={"eta_0": 1e6, "eta_alpha": 1e6}, solver=QUICK)
    grid = {"T_s": [0.5, 1.0], "gamma": [1.0, 2000.0]}
    assert not studies.wall_effect(held, grid, suite)["ratio"].values.any()
    free = studies.wall_effect(coupled(impact={"e": 0.99}, solver=QUICK), grid, suite)
    light = free["ratio"].sel(gamma=2000.0)
    assert free["ratio"].dims == ("record", "b", "gamma", "T_s")
    assert ((light > 0.7) & (light < 1.1)).all()


def test_percentiles_count_overturned_walls() -> None:
    values = xr.DataArray(
        [[1.0, np.inf], [2.0, np.inf], [3.0, 1.0], [np.nan, np.nan]], dims=("record", "T_s")
    )
    found = studies.percentiles(values, (50.0, 100.0))
    np.testing.assert_array_equal(found, [[2.0, np.inf], [3.0, np.inf]])
    fraction = studies.cumulative_distribution(values.rename("u"), [1.0, 2.5])
    np.testing.assert_allclose(fraction.transpose("level", "T_s"), [[1 / 3, 1 / 3], [2 / 3, 1 / 3]])


def test_suite_spectra(suite: tuple[RecordFile, ...]) -> None:
    found = studies.suite_spectra(coupled(solver=QUICK), {"T_s": [0.5, 1.0]}, suite)
    median = found["u_s_max_percentiles"].sel(percentile=50.0)
    np.testing.assert_array_equal(median, np.median(found["u_s_max"], axis=0))


def test_friction_of_a_resting_wall() -> None:
    """A wall that is held down moves with frame and ground: (1 + gamma) a/(g (1 + eta_0))."""
    held = coupled(cable={"eta_0": 20.0, "eta_alpha": 20.0}, solver=QUICK)
    found = studies.friction_spectra(held, {"T_s": [0.5, 1.0], "gamma": [1.0, 3.0]}).squeeze("b")
    a = held.motion.a_max_g
    expected = np.array([[2.0], [4.0]]) * a / 21.0 * np.ones(2)
    np.testing.assert_allclose(found["friction_demand_max"], expected, rtol=1e-12)
    np.testing.assert_allclose(found["base_shear_max_over_weight"], a, rtol=1e-12)
    np.testing.assert_allclose(found["cable_force_max_over_m_w_g"], 20.0, rtol=1e-12)
    np.testing.assert_allclose(found["pivot_normal_min_over_m_w_g"], 21.0, rtol=1e-12)
    with pytest.raises(InputError, match="no &wall"):
        studies.friction_spectra(bare_frame(), {"T_s": [1.0]})


def test_fragility_of_a_linear_frame_is_a_step(suite: tuple[RecordFile, ...]) -> None:
    """The frame alone is linear: all records reach a limit at the same intensity."""
    case = bare_frame(solver=QUICK)
    analysis = studies.incremental_dynamic_analysis(case, [0.1, 0.2, 0.3, 0.4], suite)
    # u = S_a/omega^2 with T_s = 1 s
    expected = 9.81 * analysis["scale"] / (2 * math.pi) ** 2
    np.testing.assert_allclose(analysis["u_s_max"].isel(record=1), expected, rtol=1e-4)
    curve = studies.fragility(analysis, 0.25 * 9.81 / (2 * math.pi) ** 2)
    assert curve["fraction"].values.tolist() == [0.0, 0.0, 1.0, 1.0]
    assert 0.2 < float(curve["median"]) < 0.3
    with pytest.raises(InputError, match=r"no run exceeds the limit: the largest u_s_max is 0.099"):
        studies.fragility(analysis, 100.0)
    with pytest.raises(InputError, match="every run exceeds the limit: the smallest u_s_max is"):
        studies.fragility(analysis, 1e-6)


def test_fragility_recovers_a_lognormal() -> None:
    """Demands that exceed the limit by a known law give its parameters back."""
    median, dispersion, n = 0.8, 0.4, 4000
    levels = np.linspace(0.2, 2.5, 24)
    chance = np.random.default_rng(1)
    capacity = median * np.exp(dispersion * chance.standard_normal(n))
    demand = (levels[None, :] > capacity[:, None]).astype(float)
    dataset = xr.Dataset(
        {
            "u_s_max": (("record", "scale"), demand),
            "status": (("record", "scale"), np.zeros((n, levels.size), "u1")),
        },
        {"scale": levels},
    )
    dataset["status"].attrs["flag_meanings"] = "ok overturned"
    found = studies.fragility(dataset, 0.5)
    # a sample of 4000
    assert float(found["median"]) == pytest.approx(median, rel=0.03)
    assert float(found["dispersion"]) == pytest.approx(dispersion, rel=0.05)


def test_bands_enclose_the_nominal_spectrum() -> None:
    uncertain = {"e": [0.8, 0.9, 0.95], "eta": [(1, 5), (0, 0)]}
    case = coupled(solver=QUICK | {"t_end": 4.0})
    found = studies.sensitivity_bands(case, {"T_s": [0.5, 1.0]}, uncertain)
    assert (found["lowest"] <= found["nominal"]).all()
    assert (found["nominal"] <= found["highest"]).all()
    assert (found["lowest"] < found["highest"]).all()


def test_bands_reach_perfect_restitution() -> None:
    """The default range of e ends at 1, where a stiff frame keeps the wall chattering."""
    case = coupled(solver=QUICK | {"t_end": 2.0})
    uncertain = {"e": [0.9, 1.0], "eta": [(0, 0), (5, 50)]}
    found = studies.sensitivity_bands(case, {"T_s": [0.01, 0.1, 1.0]}, uncertain)
    assert np.isfinite(found["highest"]).all()
    lossless = case.replace(impact={"e": 1.0}, cable={"eta_0": 0, "eta_alpha": 0})
    single = rwmf.spectrum(lossless, T_s=[0.01, 0.1, 1.0])["u_s_max"]
    assert (found["highest"].squeeze() >= single.squeeze()).all()


def test_axes_of_studies_are_what_they_set() -> None:
    """Axes in any spelling; the frame alone gets the same ground motion as both."""
    case = coupled(solver=QUICK | {"t_end": 3.0})
    grid = {"frame.t_s": [0.5, 1.0], "A_max_g": [0.2, 0.4], "Wall.B": [0.5]}
    found = studies.wall_effect(case, grid)
    alone = found["u_s_max_alone"].squeeze()
    assert alone.sizes == {"a_max_g": 2, "T_s": 2}
    np.testing.assert_allclose(alone.sel(a_max_g=0.4) / alone.sel(a_max_g=0.2), 2.0, rtol=1e-5)
    bands = [
        studies.sensitivity_bands(case, {T_s: [0.5, 1.0]}, {e: [0.8, 0.9]})
        for T_s, e in (("T_s", "e"), ("t_s", "impact.E"))
    ]
    xr.testing.assert_identical(*bands)
    with pytest.raises(InputError, match=r"impact\.e.*uncertain"):
        studies.sensitivity_bands(case, {"T_s": [0.5], "E": [0.9]}, {"e": [0.8, 0.9]})


def test_quantities_of_studies_in_any_letters(suite: tuple[RecordFile, ...]) -> None:
    case = coupled(solver=QUICK)
    found = studies.suite_spectra(case, {"t_s": [0.5]}, suite, "Theta_Max_Over_Alpha")
    assert "theta_max_over_alpha_percentiles" in found
    with pytest.raises(InputError, match="T_s cannot be a further axis"):
        studies.incremental_dynamic_analysis(case, [1.0], suite, grid={"t_s": [0.5]})


def test_equal_response_of_a_linear_frame() -> None:
    case = bare_frame(solver=QUICK)
    found = studies.equal_response(case, [0.5, 1.0], 0.1)
    for T_p, amplitude in zip(found["T_p"].values, found["a_max_g"].values, strict=True):
        pulse = {"a_max_g": float(amplitude), "omega_p": None, "T_p": float(T_p)}
        single = rwmf.simulate(case.replace(motion=pulse))
        assert float(single["u_s_max"]) == pytest.approx(0.1, rel=1e-5)


@pytest.mark.parametrize(
    "words",
    [
        ["overturning", "--omega", "3,5", "--amplitude", "1:9:5"],
        ["wall", "--T_s", "0.5:1:3"],
        ["bands", "--T_s", "0.5:1:3", "--e", "0.8,0.9"],
        ["spectra", "--T_s", "0.5:1:3", "--records", "r.txt"],
        ["friction", "--T_s", "0.5,1"],
        ["fragility", "--levels", "0.2:3:8", "--limit", "0.1", "--records", "r.txt"],
        ["equal-response", "--T_p", "0.5,1", "--target", "0.1"],
    ],
    ids=lambda words: words[0],
)
def test_commands_draw_and_write(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("h5py")
    monkeypatch.chdir(tmp_path)
    case = _overturning_block() if words[0] == "overturning" else coupled(solver=QUICK)
    case.to_namelist("case.nml")
    t = np.arange(200) * 0.02
    Path("r.txt").write_text(
        "".join(f"{x!r} {y!r}\n" for x, y in zip(t.tolist(), np.sin(6 * t).tolist(), strict=True)),
        encoding="ascii",
    )
    if "--records" in words:
        words = [*words, "--unit", "m/s2"]
    status = cli.main(
        ["study", words[0], "case.nml", *words[1:], "--plot", "x.png", "--file", "x.nc"]
    )
    assert status == 0
    assert Path("x.png").stat().st_size > 5000
    with xr.open_dataset("x.nc", engine="h5netcdf") as found:
        assert len(found.variables) > 1


def test_studies_come_with_the_package() -> None:
    code = "import rwmf; assert callable(rwmf.studies.overturning_map)"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize(
    ("impact", "cable", "axes"),
    [
        ({"e": None, "rule": "coupled"}, {}, ["eta"]),
        ({"e": None, "r": 0.81}, None, ["r"]),
        ({}, None, ["e"]),
        ({}, {}, ["e", "eta"]),
    ],
    ids=["rule", "r", "no cable", "both"],
)
def test_bands_vary_what_the_case_leaves_open(
    impact: dict[str, object],
    cable: dict[str, object] | None,
    axes: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    case = coupled(solver=QUICK | {"t_end": 2.0}, impact=impact)
    (case if cable is not None else case.without("cable")).to_namelist("case.nml")
    assert cli.main(["study", "bands", "case.nml", "--t_s", "1.0", "--file", "b.nc"]) == 0
    with xr.open_dataset("b.nc", engine="h5netcdf") as found:
        dimensions = json.loads(found.attrs["sweep"])["dimensions"]
    assert [item["name"] for item in dimensions] == [*axes, "b", "gamma", "T_s"]


def test_bands_without_anything_uncertain(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    case = coupled(solver=QUICK, impact={"e": None, "rule": "coupled"}).without("cable")
    case.to_namelist(tmp_path / "case.nml")
    assert cli.main(["study", "bands", str(tmp_path / "case.nml")]) == 2
    assert "nothing is uncertain: give --e or --eta" in capsys.readouterr().err


def test_fragility_says_what_it_found(
    suite: tuple[RecordFile, ...],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    """Median and dispersion on the screen; case, version and records in the file."""
    monkeypatch.chdir(tmp_path)
    bare_frame(solver=QUICK).to_namelist("case.nml")
    for i, record in enumerate(suite):
        samples = Path(record.path).read_text("ascii").split()
        text = "".join(f"{0.04 * k!r} {a}\n" for k, a in enumerate(samples))
        Path(f"r{i}.txt").write_text(text, "ascii")
    words = ["--records", "r0.txt", "r1.txt", "--unit", "g", "--levels", "0.1:1:4"]
    words += ["--limit", "0.1", "--file", "f.nc"]
    assert cli.main(["study", "fragility", "case.nml", *words]) == 0
    shown = capsys.readouterr().out
    with xr.open_dataset("f.nc", engine="h5netcdf") as found:
        fit = f"median {float(found['median']):.6g} g, dispersion {float(found['dispersion']):.6g}"
        assert f"u_s_max > 0.1 m: {fit}\n" in shown
        assert "&frame" in found.attrs["case"]
        assert found.attrs["version"] == rwmf.__version__
        assert found["record"].values.tolist() == ["r0", "r1"]
        assert found["record_crc32"].size == 2
        assert found["limit"].attrs["units"] == "m"


def test_results_of_studies_say_where_they_come_from() -> None:
    found = [
        studies.overturning_map(_overturning_block(), [5.0], [1.0, 2.0]),
        studies.equal_response(bare_frame(solver=QUICK), [0.5], 0.1),
        studies.sensitivity_bands(coupled(solver=QUICK), {"T_s": [0.5]}, {"e": [0.8, 0.9]}),
    ]
    for dataset in found:
        assert dataset.attrs["version"] == rwmf.__version__
        assert "&motion" in dataset.attrs["case"]
