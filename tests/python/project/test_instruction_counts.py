"""No standard call takes more than 3 % above its recorded instructions (developer/bench.md)."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from instruction_counts.__main__ import REFERENCE
from instruction_counts.calls import NAMES
from instruction_counts.ledger import Ledger, OtherSettingError, ReasonMissingError
from instruction_counts.measure import Build, Measured, StaleBuildError, measure

CALL = "run_tendon"


@pytest.fixture(scope="module")
def recorded() -> Ledger:
    """Read the counts of the repository."""
    return Ledger.read(REFERENCE)


@pytest.fixture(scope="module")
def measured(recorded: Ledger) -> Measured:
    """Count all calls once, where the recorded counts can be met."""
    if not shutil.which("valgrind"):
        pytest.skip("no valgrind, which counts instructions (apt-get install valgrind)")
    build = Build(ROOT)
    # a host depends on less than Python does: where it cannot be compared, nothing can
    _skip_elsewhere(recorded, build.setting(), CALL)
    return measure(build, NAMES)


def _skip_elsewhere(recorded: Ledger, setting: dict[str, str], name: str) -> None:
    differences = recorded.differences(setting, name)
    if differences:
        pytest.skip("; ".join(differences))


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_call_has_not_grown(name: str, recorded: Ledger, measured: Measured) -> None:
    _skip_elsewhere(recorded, measured.setting, name)
    lines = recorded.grown({name: measured.counts[name]})
    assert not lines, lines[0]


def test_every_call_is_recorded_and_no_other(recorded: Ledger) -> None:
    assert list(recorded.counts) == list(NAMES)


def _copy(ledger: Ledger, folder: Path) -> tuple[Ledger, Path]:
    """Return a copy that went through a file."""
    path = folder / "counts.txt"
    ledger.write(path)
    return Ledger.read(path), path


def test_file_keeps_everything(recorded: Ledger, tmp_path: Path) -> None:
    copy, path = _copy(recorded, tmp_path)
    assert copy == recorded
    assert path.read_bytes() == REFERENCE.read_bytes()


def test_guard_sees_growth(recorded: Ledger, tmp_path: Path) -> None:
    """A recorded count 4 % below the measured one is reported."""
    doctored, _ = _copy(recorded, tmp_path)
    now = dict(recorded.counts)
    doctored.counts[CALL] = old = round(now[CALL] / 1.04)
    (line,) = doctored.grown(now)
    assert line.startswith(
        f"{CALL} has grown by 4.0 %: from {old} to {now[CALL]} instructions, ratio 1.040. "
    )
    assert f"tools/counts --accept {CALL}" in line
    doctored.counts[CALL] = round(now[CALL] / 1.02)
    assert not doctored.grown(now)
    del doctored.counts[CALL]
    assert doctored.grown(now) == [
        f"{CALL} has no recorded count: tools/counts --accept {CALL}",
    ]


def test_growth_needs_a_reason(recorded: Ledger, tmp_path: Path) -> None:
    ledger, path = _copy(recorded, tmp_path)
    old = ledger.counts[CALL]
    new = round(1.02 * old)
    with pytest.raises(ReasonMissingError, match=f"{CALL} has grown, {old} -> {new}: say why"):
        ledger.accept({CALL: new}, ledger.setting, " ")
    assert ledger == recorded
    ledger.accept({CALL: new}, ledger.setting, "a finer\nsearch for the slack")
    ledger.write(path)
    again = Ledger.read(path)
    assert again.counts[CALL] == new
    assert again.reasons[CALL][-1] == f"{old} -> {new}: a finer search for the slack"


def test_shrinking_needs_none(recorded: Ledger, tmp_path: Path) -> None:
    ledger, _ = _copy(recorded, tmp_path)
    less = round(0.5 * ledger.counts[CALL])
    ledger.accept({CALL: less}, ledger.setting, "")
    assert ledger.counts[CALL] == less
    assert ledger.reasons == recorded.reasons


def test_small_growth_does_not_add_up(recorded: Ledger, tmp_path: Path) -> None:
    ledger, _ = _copy(recorded, tmp_path)
    ledger.accept({CALL: round(1.004 * ledger.counts[CALL])}, ledger.setting, "")
    assert ledger == recorded


def test_counts_of_another_compiler_do_not_mix(recorded: Ledger, tmp_path: Path) -> None:
    ledger, _ = _copy(recorded, tmp_path)
    other = ledger.setting | {"compiler": "GNU Fortran 99.1"}
    assert "GNU Fortran 99.1" in ledger.differences(other, CALL)[0]
    with pytest.raises(OtherSettingError, match="--accept all"):
        ledger.accept({CALL: 1}, other, "")
    ledger.accept(dict.fromkeys(NAMES, 1), other, "")
    assert ledger.setting["compiler"] == "GNU Fortran 99.1"


def test_python_of_the_host_does_not_matter(recorded: Ledger) -> None:
    other = recorded.setting | {"python": "CPython 9.9"}
    assert not recorded.differences(other, CALL)
    assert recorded.differences(other, "python_simulate")


def test_missing_build_is_reported(tmp_path: Path) -> None:
    with pytest.raises(StaleBuildError, match="standard_calls is missing: build first"):
        Build(tmp_path).check()
    with pytest.raises(StaleBuildError, match="build first"):
        Build(tmp_path).setting()


def test_old_build_is_reported(tmp_path: Path) -> None:
    build = Build(tmp_path)
    for program in (build.host, build.marks, build.batch, build.extension):
        program.parent.mkdir(parents=True, exist_ok=True)
        program.touch()
    source = tmp_path / "src" / "rwmf" / "model" / "cable.f90"
    source.parent.mkdir(parents=True)
    source.touch()
    later = build.host.stat().st_mtime + 10
    os.utime(source, (later, later))
    with pytest.raises(StaleBuildError, match=r"standard_calls is older than src/rwmf/model/cable"):
        build.check()
