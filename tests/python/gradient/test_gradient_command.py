"""The command `rwmf gradient`: table, JSON, errors."""

import json
from pathlib import Path

import pytest
import rwmf
from rwmf.cli import main
from scenes import coupled


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
