"""Studies: published boundaries, closed forms, counted statistics, the command line."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from rwmf import cli, studies
from rwmf.motion.record_sets import RecordFile, find_records
from scenes import bare_frame, block, coupled

QUICK = {"method": "dop853", "rtol": 1e-6}
PULSE = {"kind": "one_sine", "a_max_g": 0.35, "omega_p": 6.0}
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


def test_axes_of_studies_are_what_they_set() -> None:
    """Axes in any spelling; the frame alone gets the same ground motion as both."""
    case = coupled(solver=QUICK | {"t_end": 3.0})
    grid = {"frame.t_s": [0.5, 1.0], "A_max_g": [0.2, 0.4], "Wall.B": [0.5]}
    found = studies.wall_effect(case, grid)
    alone = found["u_s_max_alone"].squeeze()
    assert alone.sizes == {"a_max_g": 2, "T_s": 2}
    np.testing.assert_allclose(alone.sel(a_max_g=0.4) / alone.sel(a_max_g=0.2), 2.0, rtol=1e-5)


def test_equal_response_of_a_linear_frame() -> None:
    case = bare_frame(solver=QUICK)
    found = studies.equal_response(case, [0.5, 1.0], 0.1)
    for T_p, amplitude in zip(found["T_p"].values, found["a_max_g"].values, strict=True):
        pulse = {"a_max_g": float(amplitude), "omega_p": None, "T_p": float(T_p)}
        single = rwmf.simulate(case.replace(motion=pulse))
        assert float(single["u_s_max"]) == pytest.approx(0.1, rel=1e-5)


_HELD = block(motion=PULSE, solver=QUICK).replace(cable={"eta_0": 0.1, "eta_alpha": 0.5})
_STOREYS = coupled(
    frame={"T_s": None, "gamma": None},
    storeys={"m_over_m_w": [2.0, 1.5], "k_over_m_w": [900.0, 700.0], "height": [2.0, 2.0],
             "coupling": "full"},
    motion=PULSE, solver=QUICK | {"t_end": 4.0},
)  # fmt: skip


@pytest.mark.parametrize(
    ("words", "case"),
    [
        ("wall {} --T_s 0.5:1:3", coupled(solver=QUICK)),
        ("equal-response {} --T_p 0.5,1 --target 0.1", coupled(solver=QUICK)),
        *(("equal-response {} --T_p 0.8,1 --target 0.2", case) for case in (_HELD, _STOREYS)),
        *(
            ("overturning {} --omega 3,5 --amplitude 1:9:5", case)
            for case in (_overturning_block(), _HELD, _STOREYS)
        ),
    ],
)
def test_commands_draw_and_write(
    words: str, case: rwmf.Case, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    case.replace(impact={"rule": "coupled", "e": None}).to_namelist("case.nml")
    place = ["--out", "x.png", "--out", "x.nc"]
    assert cli.main(["study", *words.format("case.nml").split(), *place]) == 0
    assert Path("x.png").stat().st_size > 5000
    with xr.open_dataset("x.nc", engine="h5netcdf") as found:
        assert len(found.variables) > 1


def test_results_of_studies_say_where_they_come_from() -> None:
    found = [
        studies.overturning_map(_overturning_block(), [5.0], [1.0, 2.0]),
        studies.equal_response(bare_frame(solver=QUICK), [0.5], 0.1),
    ]
    for dataset in found:
        assert dataset.attrs["version"] == rwmf.__version__
        assert "&motion" in dataset.attrs["case"]
