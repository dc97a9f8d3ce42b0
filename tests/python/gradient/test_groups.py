"""The command `rwmf gradient`; the groups `&sensitivity` and `&design` by command and function."""

import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
from refused import refusals
from rwmf.cli import main
from scenes import coupled

_T = np.arange(0, 8, 0.02)
DESIGN = {"parameters": ["xi_s"], "low": [0.02], "high": [0.2], "cost": [20.0], "designs": 16}


def _write(path: Path, **changes: dict[str, object] | None) -> str:
    coupled(solver={"t_end": 4.0}).replace(**changes).to_namelist(path)
    return str(path)


def test_derivatives_of_a_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = _write(tmp_path / "case.nml", sensitivity={"parameters": ["T_s", "eta_0"]})
    assert main(["run", path, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    truth = rwmf.gradient(path, ("T_s", "eta_0"))
    for parameter in ("T_s", "eta_0"):
        cell = truth.sel(quantity="u_s_max", parameter=parameter)
        name = f"d_u_s_max_d_{parameter}"
        assert found[name] == cell["derivative"].item()
        assert found[f"{name}_error"] == cell["error"].item()
        assert found[f"{name}_valid_within"] == cell["valid_within"].item()
        assert found[f"{name}_is_kink"] is False
    assert rwmf.gradient(path).equals(truth)
    assert main(["run", path]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any(line.split()[:2] == ["parameter", "value"] for line in lines)


def test_the_groups_change_no_bit_of_a_run(tmp_path: Path) -> None:
    plain = rwmf.simulate(_write(tmp_path / "plain.nml"))
    limits = {"u_s_max_m": 0.2}
    path = _write(
        tmp_path / "case.nml", sensitivity={"parameters": ["T_s"]}, design=DESIGN, limits=limits
    )
    both = rwmf.simulate(path)
    assert both.u_s_max.item() == plain.u_s_max.item()
    assert int(both.attrs["steps"]) == int(plain.attrs["steps"])


def test_design_of_a_case(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The command without options computes the design of the function with arguments."""
    for i, (a, w) in enumerate([(3, 4), (4, 5), (3.5, 6), (5, 7)]):
        wave = a * np.sin(_T * w + i) * np.exp(-(((_T - 3) / 2) ** 2))
        np.savetxt(tmp_path / f"wave{i}.csv", np.column_stack((_T, wave)))
    suite = {"records": ["wave*.csv"], "unit": "m/s2", "collapse_probability": 0.5}
    limits = {"u_s_max_m": 0.2}
    path = _write(tmp_path / "case.nml", design=DESIGN | suite, limits=limits)
    assert main(["design", path, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    targets = [
        {"quantity": "u_s_max", "limit": 0.2, "percentile": 84},
        {"quantity": "collapse", "probability": 0.5},
    ]
    records = [str(tmp_path / f"wave{i}.csv") for i in range(4)]
    truth = rwmf.design(
        path, {"xi_s": (0.02, 0.2)}, targets, {"xi_s": 20.0}, records, unit="m/s2", designs=16
    )
    assert found["values"] == truth.values
    assert found["left_out"] == list(truth.left_out) == ["wave3"]
    assert [check["value"] for check in found["checks"]] == [x.value for x in truth.checks]
    assert main(["design", path, "--designs", "8", "--vary", "xi_s=0.05:0.1", "--json"]) == 0
    assert 0.05 <= json.loads(capsys.readouterr().out)["values"]["xi_s"] <= 0.1


test_refused_designs = refusals(
    lambda changes: coupled(limits={"u_s_max_m": 0.2}, design=DESIGN | changes),
    ({"low": [0.02, 0.1]}, "low = 0.02, 0.1: must have one number for each of the 1 param"),
    ({"high": [0.01]}, "must be below high: number 1 is not"),
    ({"percentile": 50.0, "probability": 0.5}, "must not be given beside percentile"),
    ({"percentile": 0.0}, "percentile = 0"),
    ({"left_out": ["a.csv"]}, "must not be given without records"),
    ({"cost": None}, "cost is missing"),
)


def test_refused_requests_name_their_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits = {"u_s_max_m": 0.2}
    twice = {"parameters": ["xi_s", "xi_s"], "low": [0.02] * 2, "high": [0.2] * 2, "cost": [1, 1]}
    for changes, reason in (
        (twice, "parameters: xi_s: is given twice"),
        ({"parameters": ["law"]}, "bounds: law: is a choice"),
        ({"parameters": ["rtol"]}, "bounds: rtol: is a setting of the solver"),
        ({"low": [-1.0]}, "bounds, lower ends:"),
        ({"records": ["none*.csv"], "unit": "g"}, "no record is there"),
    ):
        path = _write(tmp_path / "case.nml", design=DESIGN | changes, limits=limits)
        assert main(["design", path]) == 2
        message = capsys.readouterr().err
        assert "case.nml, &design: " in message
        assert reason in message
    words = ["design", path, "--target", "u_s_max=0.2@84", "--cost", "xi_s=1"]
    assert main([*words, "--vary", "xi_s=0.02:0.1", "xi_s=0.1:0.2"]) == 2
    assert "--vary: xi_s: is given twice" in capsys.readouterr().err


def test_refused_groups(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(rwmf.InputError, match=r"&design.*has no target.*&limits"):
        coupled(design=DESIGN)
    path = _write(tmp_path / "case.nml", sensitivity={"parameters": ["law"]})
    assert main(["run", path]) == 2
    message = capsys.readouterr().err
    assert "case.nml, &sensitivity" in message
    assert "choice" in message
    plain = _write(tmp_path / "plain.nml")
    assert main(["gradient", plain]) == 2
    assert "&sensitivity" in capsys.readouterr().err
    assert main(["design", plain]) == 2
    assert "&design" in capsys.readouterr().err


def test_table_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.nml"
    coupled(solver={"t_end": 4.0}).to_namelist(path)
    words = ["gradient", str(path), "--parameters", "T_s,eta_0", "xi_s"]
    assert main([*words, "--quantities", "u_s_max", "theta_max_over_alpha", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    truth = rwmf.gradient(path, ("T_s", "eta_0", "xi_s"), ("u_s_max", "theta_max_over_alpha"))
    assert found["parameter"] == ["T_s", "eta_0", "xi_s"]
    assert found["derivative"] == truth["derivative"].values.tolist()
    assert main(words) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("u_s_max = ")
    assert [line.split()[0] for line in lines[2:]] == ["T_s", "eta_0", "xi_s"]
    assert float(lines[2].split()[2]) == pytest.approx(found["derivative"][0][0], rel=1e-7)
    assert main([*words[:-1], "law"]) == 2
    assert "choice" in capsys.readouterr().err
