"""Ordinates of spectra report the quantities of runs, in one pass of the lanes."""

import json
from pathlib import Path

import numpy as np
import pairs
import pytest
import rwmf
from rwmf.case.namelist import compose
from rwmf.cli.main import main
from rwmf.errors import InputError
from rwmf.run import simulation as _simulation
from rwmf.run.quantities import find

_RTOL = 1e-9
_PERIODS = (0.3, 0.9)
# of the first of these scenes; the counts of a chatter depend on the tolerance
_EFFECTS = ("`exact`", "cable breaks", "`&yielding`", "`&p_delta`", "vertical, record", "`&fuse`",
            "cable, truss", "`&initial`", "e = 0",
            "impact, table", "vertical, ratio", "`&nl_damper`")  # fmt: skip
_SCENES = pairs.EFFECTS | {"e = 0": {"impact": {"rule": "constant", "e": 0.0}}}
_LOOSE = {"energy_balance_relative": 1e-3, "t_friction_demand_max_s": 1e-4, "impacts": 1.0}
_TIGHT = {"u_s_max_m": 10 * _RTOL}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder with the record of the pairs of effects."""
    place = tmp_path_factory.mktemp("ordinates")
    pairs.prepare(place)
    return place


def _case(name: str, folder: Path) -> rwmf.Case:
    case = rwmf.Case.from_text(compose(pairs.joined(_SCENES[name])), folder / "pair.nml")
    return case.replace(solver={"rtol": _RTOL}, output=None, spectrum={"T_s": list(_PERIODS)})


@pytest.mark.parametrize("effect", _EFFECTS)
def test_ordinates_are_runs(effect: str, folder: Path) -> None:
    """All quantities at once, and those that follow events alone, against runs at a tight rtol."""
    case = _case(effect, folder)
    keys = case.kernel.applicable()
    smooth = [key for key in keys if not find(key).asked_by]
    everything = rwmf.spectrum(case, quantities=keys).squeeze(drop=True)
    events = rwmf.spectrum(case, quantities=smooth).squeeze(drop=True)
    tight = case.replace(solver={"method": "dop853", "rtol": 1e-12}, spectrum=None)
    for T_s in _PERIODS:
        output = {"energy": True, "reactions": True}
        with _simulation.start(tight.replace(frame={"T_s": T_s}, output=output)) as run:
            expected = run.summary()
        for found, names in ((everything, keys), (events, smooth)):
            for key in names:
                value = float(found[find(key).called(key)].sel(T_s=T_s))
                wanted = float(expected.get(key, np.nan))
                loose = (_LOOSE | _TIGHT).get(key, 1e-6)
                assert value == pytest.approx(wanted, rel=loose, abs=loose, nan_ok=True), key


def test_what_follows_from_the_displacement(folder: Path) -> None:
    """An ordinate of peaks alone may leave out chatter that ends by itself."""
    case = _case("cable, linear", folder).replace(solver={"method": "auto"})
    names = ["u_s_max", "theta_max_over_alpha", "cable_force_increment_max_over_m_w_g", "e_max"]
    found = rwmf.spectrum(case, quantities=names)
    assert list(found.data_vars) == [*names, "status"]
    more = rwmf.spectrum(case, quantities=[*names, "impacts"])
    for name in names:
        np.testing.assert_allclose(found[name], more[name], rtol=100 * _RTOL)


def test_labels_and_files(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = _case("`&yielding`", folder)
    found = rwmf.spectrum(case, quantities=["ductility", "theta_dot_max_rad_s"])
    assert list(found.data_vars) == ["ductility", "theta_dot_max", "status"]
    assert found.theta_dot_max.attrs["units"] == "rad/s"
    path = folder / "asked.nml"
    groups = pairs.joined(pairs.EFFECTS["`&yielding`"])
    groups |= {"output": None, "spectrum": {"T_s": list(_PERIODS), "quantities": ("ductility",)}}
    path.write_text(compose({name: keys for name, keys in groups.items() if keys is not None}))
    words = ["spectrum", str(path), "--quantities", "ductility", "impacts"]
    files = ["--out", str(tmp_path / "a.csv"), "--out", str(tmp_path / "a.svg")]
    assert main([*words, "--json", *files]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert {"ductility", "impacts", "status"} <= set(shown)
    lines = (tmp_path / "a.csv").read_text().splitlines()
    assert "b_m,gamma,T_s_s,ductility,impacts,status" in lines
    assert (tmp_path / "a.svg").stat().st_size > 0
    assert main(words) == 0
    assert "impacts:" in capsys.readouterr().out
    assert main(["check", str(path)]) == 0
    assert "quantities = 'ductility'" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("u_max", "unknown, did you mean u_s_max_m[?] The list: reference/outputs.md"),
        ("theta_rad", "unknown"),
        ("steps", "unknown"),
        (
            "storey_1_ductility",
            "does not apply to this scene; reference/outputs.md lists the requirements of each",
        ),
        ("ductility", "does not apply"),
        ("friction_exceeded", "does not apply"),
        ("collapsed", "does not apply"),
    ],
)
def test_refusals(key: str, words: str, folder: Path) -> None:
    case = _case("`exact`", folder)
    with pytest.raises(InputError, match=words) as caught:
        rwmf.spectrum(case, quantities=["u_s_max", key])
    # the text is not the user's: it has no lines
    assert f"&spectrum: quantities = 'u_s_max_m', '{key}': " in str(caught.value)
    with pytest.raises(InputError, match="given twice"):
        rwmf.spectrum(case, quantities=["u_s_max", "u_s_max_m"])


def test_other_methods(folder: Path) -> None:
    """Methods without lanes report the same quantities, run by run."""
    case = _case("`exact`", folder)
    names = ["theta_max_over_alpha", "theta_dot_max", "base_shear_max_over_weight"]
    lanes = rwmf.spectrum(case, quantities=names)
    runs = rwmf.spectrum(case.replace(solver={"method": "taylor"}), quantities=names)
    for name in names:
        np.testing.assert_allclose(lanes[name], runs[name], rtol=1e-5)


def test_sweeps_take_them_from_one_call(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of T_s, gamma and b need no separate run; inapplicable quantities have no value."""
    monkeypatch.delattr("rwmf.kernel.results.start_simulation")
    case = _case("`exact`", folder)
    grid = {"T_s": list(_PERIODS), "gamma": [5.0, 10.0], "e": [0.8, 0.9]}
    names = ("theta_max_over_alpha", "friction_demand_max", "ductility")
    found = rwmf.sweep(case.replace(spectrum=None), grid, quantities=names)
    assert found["ductility"].isnull().all()
    assert found["friction_demand_max"].notnull().all()


def test_accuracy_of_a_demand_in_ordinates_and_rows(folder: Path) -> None:
    """The error bound holds for the named quantity, requested or not."""
    name = "floor_acceleration_max_g"
    solver = {"rtol": None, "accuracy": 1e-8, "accuracy_of": name, "verify": True}
    case = _case("`exact`", folder)
    asked = case.replace(solver=solver)
    tight = case.replace(
        solver={"method": "dop853", "rtol": 1e-13}, spectrum=None, output={"reactions": True}
    )
    estimates = {}
    for names in (["u_s_max", name, "sensitivity"], ["u_s_max", "estimated_relative_error"]):
        found = rwmf.spectrum(asked, quantities=names).squeeze(drop=True)
        estimates |= {key: found[key] for key in names}
    grid = {"T_s": list(_PERIODS)}
    rows = rwmf.sweep(asked.replace(spectrum=None), grid, quantities=(name,)).squeeze(drop=True)
    for T_s in _PERIODS:
        expected = float(rwmf.simulate(tight.replace(frame={"T_s": T_s}))[name])
        one = float(estimates[name].sel(T_s=T_s))
        assert one == pytest.approx(expected, rel=1e-8)
        assert float(rows[name].sel(T_s=T_s)) == one
        assert float(estimates["estimated_relative_error"].sel(T_s=T_s)) <= 1e-8
        run = rwmf.simulate(asked.replace(frame={"T_s": T_s}, spectrum=None))
        assert float(run[name]) == pytest.approx(expected, rel=1e-8)
        sensitivity = float(estimates["sensitivity"].sel(T_s=T_s))
        assert sensitivity == pytest.approx(run.attrs["sensitivity"], rel=1e-4)


def test_estimates_of_ordinates_are_those_of_runs(folder: Path) -> None:
    """`accuracy` and `verify` in lanes: the bound is kept, the sensitivity is that of the run."""
    case = _case("`exact`", folder)
    names = ["u_s_max", "estimated_relative_error", "sensitivity"]
    asked = case.replace(solver={"rtol": None, "accuracy": 1e-6, "verify": True})
    found = rwmf.spectrum(asked, quantities=names).squeeze(drop=True)
    tight = case.replace(solver={"method": "dop853", "rtol": 1e-12}, spectrum=None)
    for T_s in _PERIODS:
        one = found.sel(T_s=T_s)
        assert str(one.status.values) == "ok"
        expected = float(rwmf.simulate(tight.replace(frame={"T_s": T_s})).u_s_max)
        assert float(one.u_s_max) == pytest.approx(expected, rel=1e-6)
        assert float(one.estimated_relative_error) <= 1e-6
        run = rwmf.simulate(asked.replace(frame={"T_s": T_s}, spectrum=None))
        assert float(one.sensitivity) == pytest.approx(run.attrs["sensitivity"], rel=1e-4)
    with pytest.raises(InputError, match="does not apply"):
        rwmf.spectrum(case, quantities=["sensitivity"])
