"""Period and damping of an intensity: one factor for each record, whatever the design."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
import xarray as xr
from refused import refusals
from rwmf import cli
from rwmf.errors import InputError
from scenes import coupled

LEVELS = [0.2, 0.6]
_FAST = {"method": "dop853", "rtol": 1e-6}


def _records() -> list[rwmf.Motion]:
    chance = np.random.default_rng(5)
    noise = chance.standard_normal((2, 200)) * np.hanning(200)
    return [rwmf.Motion(a, dt=0.02, unit="m/s2", name=f"r{i}") for i, a in enumerate(noise)]


def _designs() -> dict[str, rwmf.Case]:
    """Two retrofits of a frame, its bare self, storeys, and a wall alone, each computed its way."""
    first = coupled(solver=_FAST | {"t_end": 4.0}, cable={"eta_alpha": 1.0})
    storeys = {"m_over_m_w": [2.0, 2.0], "k_over_m_w": [900.0, 600.0], "height": [2.0, 2.0]}
    return {
        "wall": first,
        "stiffer": first.replace(frame={"T_s": 0.7, "xi_s": 0.02}, solver={"rtol": 1e-8}),
        "published": first.replace(model={"formulation": "published"}, solver={"method": "adams"}),
        "bare": first.without_wall(),
        "storeys": first.replace(frame={"T_s": None, "gamma": None}, storeys=storeys),
        "block": first.without("frame"),
    }


def _analysis(case: rwmf.Case, **options: object) -> xr.Dataset:
    plain = "peak_acceleration" if case.frame is None else "pseudo_acceleration"
    return rwmf.sweep(case, {"scale": LEVELS}, _records(), **{"intensity": plain} | options)


def _factors(found: xr.Dataset) -> list[str]:
    return list(found["record_format"].values)


def test_designs_share_the_factor_of_each_record() -> None:
    """To the bit; without period and damping each takes its own."""
    wanted: dict[str, Any] = {"period": 1.1, "damping": 0.05, "intensity": "pseudo_acceleration"}
    found = {name: _analysis(case, **wanted) for name, case in _designs().items()}
    factors = [_factors(item) for item in found.values()]
    assert all(item == factors[0] for item in factors)
    assert factors[0][0] != factors[0][1]
    for item in found.values():
        assert item.attrs["intensity"] == "pseudo_acceleration"
        assert (item.attrs["intensity_period_s"], item.attrs["intensity_damping"]) == (1.1, 0.05)
        assert "period 1.1 s and damping 0.05" in item["scale"].attrs["long_name"]
    # the definition: omega^2 u_max of that oscillator is 1 g
    factor = float(factors[0][0].split("times ")[1])
    alone = rwmf.Case(frame={"T_s": 1.1, "xi_s": 0.05}, motion=_records()[0])
    peak = float(rwmf.simulate(alone.replace(motion={"scale": factor}))["u_s_max"])
    assert (2 * math.pi / 1.1) ** 2 * peak == pytest.approx(9.81, rel=1e-7)


def test_without_them_they_are_those_of_the_frame() -> None:
    designs = _designs()
    own = [_analysis(designs[name]) for name in ("wall", "stiffer", "storeys", "block")]
    periods = [item.attrs.get("intensity_period_s") for item in own]
    assert periods[:2] == [1.0, 0.7]
    assert periods[2] == designs["storeys"].kernel.axes()["T_s"].value
    assert periods[3] is None
    assert own[3].attrs["intensity"] == "peak_acceleration"
    assert _factors(own[0]) != _factors(own[1])


@pytest.mark.parametrize(
    "grid",
    [
        {"T_s": [0.5, 1.0]},
        {"T_s": [0.5]},
        {"gamma": [3.0, 5.0]},
        {"b": [0.4, 0.5]},
        {"frame.xi_s": [0.02, 0.05]},
    ],
)
def test_they_are_required_where_structures_vary(grid: dict[str, list[float]]) -> None:
    case = _designs()["wall"]
    options: dict[str, Any] = {"intensity": "pseudo_acceleration"}
    scaled = {"scale": [0.3]} | grid
    with pytest.raises(InputError, match="differs between the runs: give period and damping"):
        rwmf.sweep(case, scaled, _records(), **options)
    columns = {name: np.array(values) for name, values in grid.items()}
    with pytest.raises(InputError, match="differs between the runs"):
        rwmf.sweep(case, {"scale": [0.3]}, _records(), points=columns, **options)
    with pytest.raises(InputError, match="differs between the runs"):
        rwmf.sweep(case.replace(spectrum={"T_s": [0.5, 1.0]}), {}, _records(), **options)
    found = rwmf.sweep(case, scaled, _records(), **options, period=1.0, damping=0.05)
    assert found.attrs["intensity_period_s"] == 1.0
    # axes that leave the frame unchanged need none
    rwmf.sweep(case, {"scale": [0.3], "e": [0.8, 0.9], "T_s": [1.0]}, _records(), **options)


test_what_does_not_belong_together = refusals(
    lambda options: _analysis(_designs()["wall"], **options),
    ({"period": 1.0}, "has period only"),
    ({"damping": 0.05}, "has damping only"),
    ({"period": -1.0, "damping": 0.05}, "period = -1.0: must be"),
    ({"period": 1.0, "damping": -0.1}, "damping = -0.1: must be"),
    ({"intensity": "peak_acceleration", "period": 1.0}, "period: must not be given"),
    ({"intensity": "pseudo_aceleration"}, "did you mean pseudo_acceleration"),
)


def test_files_and_commands_take_and_state_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    _designs()["wall"].to_namelist("case.nml")
    for motion in _records():
        motion.write(f"{motion.name}.txt")
    (tmp_path / "s.nml").write_text(
        "&sweep case = 'case.nml', records = 'r*.txt', unit = 'm/s2', dt = 0.02,\n"
        "   intensity = 'pseudo_acceleration', period = 1.1, damping = 0.05 /\n"
        "&grid scale = 0.2, 0.6 T_s = 0.8, 1.0 /\n"
    )
    assert cli.main(["sweep", "s.nml"]) == 0
    with xr.open_dataset("s.nc", engine="h5netcdf") as found:
        assert (found.attrs["intensity_period_s"], found.attrs["intensity_damping"]) == (1.1, 0.05)
    words = "stripes case.nml --records r0.txt r1.txt --unit m/s2,0.02 --levels 0.1:3:4"
    options = "--intensity pseudo_acceleration:1.1@0.05 --out s.svg --out stripes.nc"
    assert cli.main([*words.split(), *options.split()]) == 0
    assert cli.main(["fragility", "stripes.nc", "--limit", "0.1", "--out", "f.nc"]) == 0
    with xr.open_dataset("f.nc", engine="h5netcdf") as found:
        assert found.attrs["intensity_period_s"] == 1.1
        ax = rwmf.plot.make_panels(None, 1)[0]
        rwmf.plot.fragility(found.load(), ax)
        assert ax.get_xlabel() == "$S_a$(1.1 s, 5 %)$/g$"
