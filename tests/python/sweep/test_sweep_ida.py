"""Incremental dynamic analysis as one sweep file: six storeys, a wall, its cable, its fuses."""

import math
import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT
from rwmf import cli
from rwmf.errors import InputError

SHIPPED = ROOT / "inputs" / "sweeps"
NAMES = (
    "u_s_max",
    "theta_max_over_alpha",
    "cable_force_increment_max_over_m_w_g",
    "theta_end_over_alpha",
    "base_shear_max_over_weight",
)
LEVELS = (0.4, 1.6)


def write_records(folder: Path, count: int) -> None:
    """Write motions that grow and fade: filtered noise in AT2 files [g]."""
    folder.mkdir()
    chance = np.random.default_rng(3)
    dt = 0.02
    t = dt * np.arange(400)
    envelope = (t / 1.5) ** 2 * np.exp(2 * (1 - t / 1.5))
    for i in range(count):
        noise = np.convolve(chance.standard_normal(t.size), np.hanning(9), "same")
        samples = 0.05 * (1 + i / count) * envelope * noise
        head = f"A MOTION\nMADE\nACCELERATION IN UNITS OF G\nNPTS= {t.size}, DT= {dt} SEC\n"
        rows = samples.reshape(-1, 5).tolist()
        text = head + "".join(" ".join(f"{a:.7E}" for a in row) + "\n" for row in rows)
        (folder / f"motion{i:02d}.AT2").write_text(text, encoding="ascii")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Copy the shipped files to a folder with records; few levels."""
    monkeypatch.chdir(tmp_path)
    shutil.copy(SHIPPED / "six_storeys_with_fuses.nml", tmp_path)
    text = (SHIPPED / "six_storeys_ida.nml").read_text(encoding="utf-8")
    begin, end = text.index("scale = "), text.rindex("/")
    values = ", ".join(map(str, LEVELS))
    (tmp_path / "ida.nml").write_text(f"{text[:begin]}scale = {values}\n/\n{text[end + 2 :]}")
    write_records(tmp_path / "records", int(os.environ.get("RWMF_IDA_RECORDS", "3")))
    return tmp_path


def test_one_file_is_the_study_and_the_runs(place: Path) -> None:
    """The bits of the study, and to the tolerance those of a run whose record has the factor."""
    assert cli.main(["sweep", "ida.nml"]) == 0
    case = rwmf.Case.from_namelist("six_storeys_with_fuses.nml")
    records = sorted((place / "records").iterdir())
    study = rwmf.sweep(
        case,
        {"scale": LEVELS},
        records,
        quantities=NAMES,
        intensity="pseudo_acceleration",
    ).squeeze()
    with xr.open_dataset("ida.nc", engine="h5netcdf") as found:
        assert found["scale"].attrs["long_name"].startswith("pseudo-spectral acceleration")
        for name in NAMES:
            np.testing.assert_array_equal(found[name].squeeze(), study[name])
            assert found[name].dims == ("record", "scale", "b", "gamma", "T_s")
    T_s = case.kernel.axes()["T_s"].value
    alone = rwmf.Case(
        frame={"T_s": T_s, "xi_s": case.frame.xi_s},
        motion={"kind": "record", "file": str(records[1])},
        model={"g": case.model.g},
    )
    peak = float(rwmf.spectrum(alone, [T_s])["u_s_max"].squeeze())
    factor = LEVELS[1] * case.model.g / ((2 * math.pi / T_s) ** 2 * peak)
    gone = dict.fromkeys(case.motion)
    motion = gone | {"kind": "record", "file": str(records[1]), "scale": factor}
    run = rwmf.simulate(
        case.replace(motion=motion, solver={"t_end": None}, output={"reactions": True})
    )
    for name in NAMES:
        expected = float(run[name])
        assert float(study[name].isel(record=1, scale=1)) == pytest.approx(expected, rel=1e-4)
    assert float(run["theta_max_over_alpha"]) > 0.05


def test_what_cannot_be_scaled(place: Path) -> None:
    case = rwmf.Case.from_namelist("six_storeys_with_fuses.nml")
    records = ["records"]
    with pytest.raises(InputError, match="must be one of pseudo_acceleration, peak_acceleration"):
        rwmf.sweep(case, {"scale": [1.0]}, records, intensity="pga")
    with pytest.raises(InputError, match="needs records"):
        rwmf.sweep(case, {"scale": [1.0]}, intensity="peak_acceleration")
    (place / "quiet.csv").write_text("0 0\n1 0\n", encoding="ascii")
    with pytest.raises(InputError, match="has no intensity"):
        rwmf.sweep(case, {}, ["quiet.csv"], unit="g", intensity="pseudo_acceleration")


def test_peak_acceleration(place: Path) -> None:
    """A level is the peak of the ground."""
    case = rwmf.Case.from_namelist("six_storeys_with_fuses.nml")
    found = rwmf.sweep(case, {"scale": [0.3]}, ["records"], intensity="peak_acceleration")
    factor = float(found["record_format"].values[0].split("times ")[1])
    motion = dict.fromkeys(case.motion) | {
        "kind": "record",
        "file": str(sorted((place / "records").iterdir())[0]),
        "scale": 0.3 * factor,
    }
    scaled = case.replace(motion=motion, solver={"t_end": None})
    assert scaled.kernel.peak_of_motion() == pytest.approx(0.3 * case.model.g, rel=1e-12)
