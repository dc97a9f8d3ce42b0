"""Axes of storeys and of blocks: an ordinate equals the run of its scene."""

import json
import math
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from checkout import Runner
from refused import refusals
from rwmf import cli
from rwmf.errors import InputError
from scenes import bare_frame, block, coupled

# the same equation with parameters that differ in their last digits
AGREEMENT = 1e-7
SOLVER = {"method": "dop853", "rtol": 1e-10, "t_end": 5.0}
PULSE = {"kind": "one_sine", "a_max_g": 0.35, "omega_p": 6.0}
STOREYS = {"m_over_m_w": [2.0, 1.5, 1.0], "k_over_m_w": [900.0, 700.0, 400.0]}
HEIGHTS = [1.5, 1.3, 1.2]
COUPLINGS = ("reduced", "every_floor", "full")
Changes = dict[str, dict[str, Any]]
EFFECTS: dict[str, Changes] = {
    "elastic": {},
    "fuse": {"fuse": {"eta_y": 0.3, "stroke_y": 0.01}},
    "p_delta": {"p_delta": {}},
    "tendon": {"cable": {"eta_y": 1.2}},
    "vertical": {"vertical": {"ratio": 0.5}},
    "initial": {"initial": {"theta_over_alpha": 0.2}},
    "damper": {"damper": {"c_over_m_w": 0.5}},
}
YIELDING: Changes = {"yielding": {"storey_u_y": [0.004], "law": "elastic_plastic"}}


def _storeys(coupling: str, changes: Changes | None = None) -> rwmf.Case:
    lists = STOREYS | {"height": HEIGHTS, "coupling": coupling}
    frame = {"T_s": None, "gamma": None}
    case = coupled(storeys=lists, frame=frame, motion=PULSE, solver=SOLVER)
    return case.replace(**(changes or {}))


def _scaled(case: rwmf.Case, T_s: float, gamma: float) -> rwmf.Case:
    """Scale the lists of a case by hand."""
    axes = case.kernel.axes()
    heavier = gamma / axes["gamma"].value
    stiffer = heavier * (axes["T_s"].value / T_s) ** 2
    lists = {
        "m_over_m_w": [heavier * m for m in STOREYS["m_over_m_w"]],
        "k_over_m_w": [stiffer * k for k in STOREYS["k_over_m_w"]],
    }
    return case.replace(storeys=lists)


@pytest.mark.parametrize(
    ("coupling", "effect"),
    # one mode yields as one spring
    [*product(COUPLINGS, EFFECTS), ("every_floor", "each yields"), ("full", "each yields")],
)
def test_storeys(coupling: str, effect: str) -> None:
    """Its own period and mass ratio give the run's bits, others those of scaled lists."""
    case = _storeys(coupling, EFFECTS.get(effect, YIELDING))
    axes = case.kernel.axes()
    T_s, gamma = axes["T_s"].value, axes["gamma"].value
    names = ["u_s_max", "theta_max_over_alpha", "storey_1_shear_max_over_m_w_g", "roof_drift_max",
             "storey_2_drift_max", "storey_drift_max", "floor_1_acceleration_max_g",
             "floor_acceleration_max_g", "overturning_moment_max_over_weight",
             "wall_moment_max_over_m_w_g", "wall_moment_max_height"]  # fmt: skip
    found = rwmf.spectrum(
        case, [T_s, 0.9], gamma=[gamma, 2.5 * gamma], b=[0.5, 0.6], quantities=names
    )
    assert (found["status"] == "ok").all()
    places = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 1)]
    for i, j, k in places:
        at = found.isel(T_s=i, gamma=j, b=k)
        one = case if i == j == 0 else _scaled(case, float(at["T_s"]), float(at["gamma"]))
        run = rwmf.simulate(one if k == 0 else one.replace(wall={"b": float(at["b"])}))
        for name in names:
            if i == j == 0:
                assert float(at[name]) == float(run[name])
            else:
                assert float(at[name]) == pytest.approx(float(run[name]), rel=AGREEMENT)


def test_storeys_without_wall() -> None:
    """Stiffnesses follow the period; there is no mass ratio."""
    lists = STOREYS | {"height": HEIGHTS, "coupling": "full"}
    case = bare_frame(storeys=lists, frame={"T_s": None}, motion=PULSE, solver=SOLVER)
    assert list(case.kernel.axes()) == ["T_s"]
    own = case.kernel.axes()["T_s"].value
    found = rwmf.spectrum(case, [own, 1.3])["u_s_max"]
    assert float(found[0]) == float(rwmf.simulate(case)["u_s_max"])
    softer = [k * (own / 1.3) ** 2 for k in STOREYS["k_over_m_w"]]
    run = rwmf.simulate(case.replace(storeys={"k_over_m_w": softer}))
    assert float(found[1]) == pytest.approx(float(run["u_s_max"]), rel=AGREEMENT)
    with pytest.raises(InputError, match="without &wall"):
        rwmf.spectrum(case, [own], gamma=[1.0])


_BLOCKS = {
    "elastic": {},
    "cable": {"cable": {"eta_0": 0.1, "eta_alpha": 0.5}},
    "fuse": EFFECTS["fuse"],
    "vertical": EFFECTS["vertical"],
    "initial": EFFECTS["initial"],
    "damper": EFFECTS["damper"],
    "inerter": {"inerter": {"inertance_over_m_w": 0.5}},
    "published": {"model": {"formulation": "published"}},
}


@pytest.mark.parametrize("effect", _BLOCKS)
def test_block(effect: str) -> None:
    """The width sets the slenderness at the height of the case, then the period the size."""
    case = block(motion=PULSE, solver=SOLVER).replace(**_BLOCKS[effect])
    own = case.kernel.axes()["T_s"].value
    assert own == pytest.approx(2 * math.pi / math.sqrt(0.75 * 9.81 / math.hypot(2.0, 0.5)))
    found = rwmf.spectrum(case, [own, 4.5], b=[0.5, 0.55])
    assert found["theta_max_over_alpha"].dims == ("b", "T_s")
    assert list(found.data_vars) == ["theta_max_over_alpha", "status"]
    for k, b in enumerate((0.5, 0.55)):
        slender = case.replace(wall={"b": b})
        factor = (4.5 / slender.kernel.axes()["T_s"].value) ** 2
        large = case.replace(wall={"h": factor * 2.0, "b": factor * b})
        run = rwmf.simulate(large)["theta_max_over_alpha"]
        at = found["theta_max_over_alpha"].isel(b=k)
        assert float(at[1]) == pytest.approx(float(run), rel=AGREEMENT)
    run = rwmf.simulate(case)["theta_max_over_alpha"]
    assert float(found["theta_max_over_alpha"][0, 0]) == float(run)


def test_similar_blocks() -> None:
    """Similar blocks under pulses that are as long for their size rotate by the same angles."""
    case = block(motion=PULSE, solver=SOLVER)
    own = case.kernel.axes()["T_s"].value
    for factor in (0.7, 2.0):
        slower = case.replace(
            motion={"omega_p": 6.0 / factor}, solver={"t_end": 5.0 * max(factor, 1.0)}
        )
        found = rwmf.spectrum(slower, [factor * own])["theta_max_over_alpha"]
        expected = rwmf.simulate(case)["theta_max_over_alpha"]
        assert float(found.squeeze()) == pytest.approx(float(expected), rel=AGREEMENT)


def test_errors_of_blocks_are_estimated() -> None:
    """Of the rotation: there is no displacement."""
    case = block(motion=PULSE, solver={"rtol": 1e-6, "t_end": 3.0, "verify": True})
    own = case.kernel.axes()["T_s"].value
    names = ["theta_max_over_alpha", "estimated_relative_error", "sensitivity"]
    found = rwmf.spectrum(case, [own], quantities=names).squeeze()
    run = rwmf.simulate(case)
    assert 0 < float(found["estimated_relative_error"]) < 1e-3
    assert float(found["sensitivity"]) == pytest.approx(run.attrs["sensitivity"], rel=1e-4)
    exact = case.replace(solver={"verify": None, "rtol": None, "accuracy": 1e-9})
    found = rwmf.spectrum(exact, [own]).squeeze()
    run = rwmf.simulate(case.replace(solver={"rtol": 1e-12, "verify": None}))
    peak = float(run["theta_max_over_alpha"])
    assert float(found["theta_max_over_alpha"]) == pytest.approx(peak, rel=1e-8)


def test_what_axes_are_called(
    batch: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Labels in the dataset, in the sweep and in the file of the batch program."""
    monkeypatch.chdir(tmp_path)
    meanings = {
        "reduced": "mass ratio of the first mode",
        "every_floor": "mass ratio of the frame on a straight line",
        "full": "mass of the roof over that of the wall",
    }
    for coupling, meaning in meanings.items():
        case = _storeys(coupling).replace(spectrum={"T_s": [0.5]})
        for found in (rwmf.spectrum(case), rwmf.sweep(case)):
            assert found["gamma"].attrs["long_name"].startswith(meaning)
            assert found["T_s"].attrs["long_name"].endswith("; all stiffnesses follow")
    case = block(motion=PULSE, solver=SOLVER, spectrum={"T_s": [2.0, 3.0, 4.0], "b": [0.5, 0.6]})
    case = case.replace(spectrum={"quantities": ["theta_max_over_alpha", "impacts"]})
    assert rwmf.spectrum(case)["T_s"].attrs["long_name"].startswith("2 pi/p of the block")
    plain = coupled().replace(spectrum={"T_s": [0.5]})
    assert rwmf.spectrum(plain)["T_s"].attrs["long_name"] == "period of the frame"
    case.to_namelist("case.nml")
    for words in (["--part", "1/2"], ["--part", "2/2"], []):
        assert batch(*words, "case.nml").returncode == 0
    text = Path("case.spectrum.csv").read_text(encoding="utf-8")
    assert "# axis T_s_s: 2 pi/p of the block" in text
    assert "\nb_m,T_s_s,theta_max_over_alpha,impacts,status\n" in text
    parts = [f"case.part-{k}-of-2.spectrum.csv" for k in (1, 2)]
    assert cli.main(["sweep", "--out", "joined.csv", "--merge", *parts]) == 0
    assert Path("joined.csv").read_bytes() == Path("case.spectrum.csv").read_bytes()


def test_command_spectrum_of_a_block(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    case = block(motion=PULSE, solver=SOLVER, spectrum={"T_s": [3.0, 4.0], "b": [0.5, 0.6]})
    path = tmp_path / "case.nml"
    case.to_namelist(path)
    assert cli.main(["spectrum", str(path), "--out", str(tmp_path / "s.png")]) == 0
    assert cli.main(["spectrum", str(path)]) == 0
    assert "b=0.5" in capsys.readouterr().out
    assert cli.main(["spectrum", str(path), "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert list(shown)[:3] == ["T_s_s", "b_m", "theta_max_over_alpha"]
    assert np.shape(shown["theta_max_over_alpha"]) == (2, 2)


def test_sweeps_of_blocks() -> None:
    """A width keeps the height; with a period it sets the slenderness."""
    case = block(motion=PULSE, solver=SOLVER)
    found = rwmf.sweep(case, {"b": [0.5, 0.55]})["theta_max_over_alpha"]
    for b, value in zip((0.5, 0.55), found.values, strict=True):
        assert value == float(rwmf.simulate(case.replace(wall={"b": b}))["theta_max_over_alpha"])
    grid = {"T_s": [3.0, 4.0], "b": [0.5, 0.55]}
    both = rwmf.sweep(case, grid)
    assert both["theta_max_over_alpha"].dims == ("b", "T_s")
    single = rwmf.spectrum(case, **grid)["theta_max_over_alpha"]
    np.testing.assert_array_equal(both["theta_max_over_alpha"], single)
    with pytest.raises(InputError, match="gamma: the case has no such effect"):
        rwmf.sweep(case, {"gamma": [1.0]})


def test_storeys_report_each_of_theirs() -> None:
    """Ductility and residual drift of each storey, in a sweep as in a run."""
    case = _storeys("full", YIELDING)
    names = ["storey_1_ductility", "Storey_3_Residual_Drift"]
    found = rwmf.sweep(case, quantities=names).squeeze()
    run = rwmf.simulate(case)
    assert float(found["storey_1_ductility"]) == float(run["storey_1_ductility"])
    assert float(found["storey_3_residual_drift"]) == float(run["storey_3_residual_drift"])
    with pytest.raises(
        InputError, match=r"storey_1_drift: is unknown, did you mean .* The list: r"
    ):
        rwmf.sweep(case, quantities=["storey_1_drift"])


test_unknown_axes = refusals(
    lambda name: rwmf.sweep(coupled(), {name: [1.0, 2.0]}),
    ("gama", "did you mean gamma? Allowed are scale, eta"),
    ("wal.b", "did you mean wall.b?"),
    ("frame.xi", "did you mean frame.xi_s?"),
    ("qqqqq", "qqqqq: no key of a case; allowed are scale, eta"),
)


test_unknown_groups = refusals(
    lambda changes: coupled().replace(**changes),
    ({"formulation": "exact"}, "did you mean model={'formulation': ...}? There are wall"),
    ({"fram": {"T_s": 1.0}}, "there is no group &fram, did you mean frame?"),
    ({"qqqqq": {"T_s": 1.0}}, "there is no group &qqqqq; there are wall"),
    ({"frame": 3.0}, "&frame = 3.0: must be keys with values, or None"),
)
