"""The effect of a wall in several responses, the one quantity of other studies, and prestress."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import rwmf
import xarray as xr
from rwmf import cli, studies
from rwmf.errors import InputError
from scenes import coupled

RESPONSES = ["u_s_max", "storey_drift_max", "floor_acceleration_max_g"]


def _storeys() -> rwmf.Case:
    """Three storeys beside a wall that the roof is linked to."""
    return rwmf.Case(
        wall={"h": 4.8, "b": 1.3},
        frame={"xi_s": 0.03},
        storeys={
            "m_over_m_w": [0.5, 0.5, 0.5],
            "k_over_m_w": [2700.0, 2200.0, 1500.0],
            "height": [3.2, 3.2, 3.2],
            "coupling": "full",
        },
        cable={"eta_0": 1.0, "eta_alpha": 2.0},
        motion={"kind": "sine", "a_max_g": 0.3, "T_p": 1.1},
        solver={"t_end": 4.0, "rtol": 1e-7},
    )


def test_storeys_are_compared_in_drift_and_acceleration() -> None:
    """Each ratio is that of two runs; here the roof moves less and the floors shake more."""
    case = _storeys()
    T_s = case.kernel.axes()["T_s"].value
    found = studies.wall_effect(case, {"T_s": [T_s]})
    assert found.attrs["quantities"].split() == RESPONSES
    wanted = {"reactions": True}
    both = rwmf.simulate(case.replace(output=wanted))
    alone = rwmf.simulate(case.without_wall().replace(output=wanted))
    ratios = [float(found[f"{name}_ratio"].squeeze()) for name in RESPONSES]
    for name, ratio in zip(RESPONSES, ratios, strict=True):
        assert ratio == pytest.approx(float(both[name] / alone[name]), rel=1e-4), name
    assert min(ratios) < 1 < max(ratios)
    assert found["ratio"].equals(found["u_s_max_ratio"])
    assert {"u_s_max", "u_s_max_alone"} <= {*found}


def test_other_responses() -> None:
    case = coupled(solver={"t_end": 2.0})
    assert studies.wall_effect(case, {"T_s": [0.8]}).attrs["quantities"] == "u_s_max"
    wanted = ["floor_acceleration_max_g", "base_shear_max_over_weight"]
    found = studies.wall_effect(case, {"T_s": [0.8]}, quantities=wanted)
    assert found["ratio"].equals(found["floor_acceleration_max_g_ratio"])
    assert all(np.isfinite(found[f"{name}_ratio"]).all() for name in wanted)
    with pytest.raises(InputError, match="theta_max_over_alpha: the frame alone has no such"):
        studies.wall_effect(case, {"T_s": [0.8]}, quantities="theta_max_over_alpha")
    with pytest.raises(InputError, match="IDR: is unknown, did you mean storey_drift_max"):
        studies.wall_effect(case, {"T_s": [0.8]}, quantities=["IDR"])


def test_collapse_of_the_frame_alone() -> None:
    """The last peak before a collapse is no response to compare with."""
    limit = {"m_g_over_m_s": 1.0, "h_f": 8.0, "drift_limit": 0.02}
    case = coupled(p_delta=limit, motion={"a_max_g": 0.3}, solver={"t_end": 4.0})
    found = studies.wall_effect(case, {"T_s": [0.6, 0.9, 1.2]})
    assert np.isinf(found["u_s_max_alone"]).values.ravel().tolist() == [False, True, True]
    assert np.isfinite(found["u_s_max"]).values.ravel().tolist() == [True, True, False]
    assert found["ratio"].values.ravel()[1] == 0
    assert np.isnan(found["ratio"].values.ravel()[2])


def test_the_command_gives_all_and_no_verdict(
    tmp_path: object, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(str(tmp_path))
    _storeys().to_namelist("case.nml")
    words = ["study", "wall", "case.nml", "--T_s", "0.3,0.5", "--out", "w.nc", "--out", "w.svg"]
    assert cli.main(words) == 0
    out = capsys.readouterr().out
    assert "written: w.nc\nwritten: w.svg\n" in out
    assert all(f"  {name}: " in out for name in RESPONSES)
    with xr.open_dataset("w.nc", engine="h5netcdf") as found:
        ax = rwmf.plot.wall_effect(found.load(), plt.figure().subplots())
        names = [f"{name}_ratio" for name in RESPONSES]
        long = [line for line in ax.lines if len(line.get_xdata()) == 2]
        curves = [line for line in long if not str(line.get_label()).startswith("_")]
        for line, name in zip(curves, names, strict=True):
            assert np.array_equal(line.get_ydata(), found[name].squeeze())
    words = ["study", "wall", "case.nml", "--T_s", "0.3", "--quantities", "roof_drift_max"]
    assert cli.main(words) == 0
    assert "  roof_drift_max: " in capsys.readouterr().out


@pytest.mark.parametrize(
    "call",
    [
        lambda case, how: studies.equal_response(case, [0.5], 0.1, tolerance=0.5, **how),
        lambda case, how: rwmf.stripes(case, [_quake()], [0.1], **how),
    ],
    ids=["equal", "stripes"],
)
def test_quantities_is_the_name_everywhere(call: object) -> None:
    """One text or a list; the singular is refused with the new name."""
    case = coupled(solver={"t_end": 0.5, "rtol": 1e-4})
    name = "theta_max_over_alpha"
    expected = call(case, {"quantities": name})  # type: ignore[operator]
    assert expected.identical(call(case, {"quantities": [name]}))  # type: ignore[operator]
    with pytest.raises(TypeError, match="quantity is now quantities"):
        call(case, {"quantity": name})  # type: ignore[operator]


def _quake() -> rwmf.Motion:
    return rwmf.Motion(np.sin(np.arange(60) * 0.3), dt=0.02, unit="m/s2", name="quake")
