"""Top level of the command: no option, file, stream or bug may show a traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from rwmf import cli
from rwmf.cli import case_files
from scenes import block, coupled

QUICK = {"method": "dop853", "rtol": 1e-6, "t_end": 1.0}
LONG = "x" * 3000


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder with a case, a block and a sweep, in which the command runs."""
    coupled(solver=QUICK).to_namelist(tmp_path / "case.nml")
    block(initial={"theta_over_alpha": 1.2}).to_namelist(tmp_path / "fallen.nml")
    storeys = {"m_over_m_w": [2.0, 1.5], "k_over_m_w": [900.0, 700.0], "height": [2.0, 2.0]}
    tall = coupled(frame={"T_s": None, "gamma": None}, storeys=storeys | {"coupling": "full"})
    tall.to_namelist(tmp_path / "tall.nml")
    (tmp_path / "s.nml").write_text("&sweep case='case.nml' /\n&grid T_s=1.0 /\n", "utf-8")
    (tmp_path / "only.csv").write_text("# part 1/2\n", "utf-8")
    (tmp_path / "many.csv").write_text(f"# part {'1' * 5000}/2\n", "utf-8")
    os.mkfifo(tmp_path / "pipe")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def _told(words: list[str], capfd: pytest.CaptureFixture[str]) -> tuple[int, str]:
    status = cli.main(words)
    return status, capfd.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["sweep", "s.nml", "--out", "."], r".: is a folder, not a file"),
        (["sweep", "s.nml", "--out", LONG], "x... (3000 letters): a name has at most 255 bytes"),
        (
            ["sweep", "s.nml", "--engine", "processes:5000"],
            "--engine: 5000: must be a whole number",
        ),
        (["sweep", "s.nml", "--threads", "99999999999"], "--threads: 99999999999: must be a whole"),
        (["sweep", "s.nml", "--threads", "-1"], "--threads: -1: must be a whole number"),
        (["sweep", "s.nml", "--engine", "dask:foo"], "engine dask:foo: no scheduler answers"),
        (["sweep", "s.nml", "--engine", "threads:2"], "engine threads:2: allowed are threads,"),
        (["sweep", LONG], "the file does not exist"),
        (["run", "case.nml", "--out", LONG], "x: File name too long"),
        (["run", "case.nml", "--out", LONG + ".png"], "a name has at most 255 bytes"),
        (["spectrum", "case.nml", "--threads", "100000"], "100000: must be"),
        (["spectrum", "case.nml", "--threads", "two"], "--threads: two: must be a whole number"),
        (["cost", "case.nml", "--out", "x.doc"], "is not a format of figures"),
        (["cost", "case.nml", "--target", "nan"], "--target: nan: must be in (0, 1)"),
        (["records", "export", "elcentro", "--out", "."], ".: is a folder, not a file"),
        (["study", "wall", "case.nml", "--out", ".."], "..: is a folder, not a file"),
        (["study", "wall", "case.nml", "--T_s", "1,nan"], "--T_s/--t_s: 1,nan: must be FIRST:LAST"),
        (["study", "overturning", "fallen.nml", "--tolerance", "-1"], "--tolerance: -1: must be"),
        (["study", "equal-response", "case.nml", "--target", "nan"], "--target: nan: must be"),
        (["reproduce"], "now: tools/run reproduce"),
        (["study", "bands"], "now: a recipe of the page Studies"),
        (["spectrum", "case.nml", "--csv", "x.csv"], "now: --out FILE.csv"),
        (["spectrum", "case.nml", "--thread", "1", "--ot", "x.png"], "did you mean --out?"),
        (["spectrm"], "did you mean spectrum?"),
        (
            ["sweep", "--out", "o.csv", "--merge", "case.nml"],
            "case.nml: is not written by rwmf-batch --part K/N",
        ),
        (
            ["sweep", "--out", "o.csv", "--merge", "only.csv"],
            "needs the parts 1 to 2 once each, has 1",
        ),
        (
            ["sweep", "--out", "o.csv", "--merge", "many.csv"],
            "many.csv: is not written by rwmf-batch --part K/N",
        ),
        (
            ["sweep", "--out", "o.csv", "--merge", "pipe"],
            "pipe: the file is empty or not a regular file",
        ),
        (["run", "case.nml", "fallen.nml"], "several cases need --out"),
        (["run", "case.nml", "fallen.nml", "--out", "x"], "must end with .csv, .nc, .jsonl"),
        (["run", "case.nml", "--out", "t.csv", "--out", "x.png"], "FILE.png: needs one case"),
        (["run", "case.nml", "case.nml", "--out", "case.nml"], "must end with"),
        (["pushover", "tall.nml", "--run"], "--run: needs a figure"),
        (["pushover", "tall.nml", "--drifts", "2"], "must be between -1 and 1"),
        (["pushover", "tall.nml", "--drifts", "x"], "finite numbers with commas"),
        (
            ["pushover", "tall.nml", "--pattern", "1,2,3"],
            "has 3 values, must have one for each floor that is loaded: 2",
        ),
        (["pushover", "tall.nml", "--pattern", "second"], "must be first_mode, roof, or forces"),
        (["pushover", "tall.nml", "--steps", "0"], "must be a whole number"),
        (["pushover", "tall.nml", "--forces", "1,2"], "now: --pattern F1,F2"),
        (
            ["pushover", "tall.nml", "--out", "x.svg", "--out", "y.png"],
            "allowed is one file and one figure",
        ),
        (["animate", "fallen.nml", "--fps", "0"], "--fps: 0: must be a whole number in [1, 100]"),
        (["animate", "fallen.nml", "--until", "-1"], "--until: -1: must be a finite number > 0"),
    ],
    ids=lambda value: " ".join(value)[:40] if isinstance(value, list) else "",
)
def test_words_that_are_refused(
    words: list[str], message: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    before = sorted(folder.iterdir())
    status, told = _told(words, capfd)
    assert status == 2
    assert message in " ".join(told.split())
    assert "Traceback" not in told
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    ("sweep", "grid", "message"),
    [
        ("chunk=1e999", "", "&sweep: chunk = inf: must be one whole number >= 0"),
        ("chunk=-1", "", "&sweep: chunk = -1.0: must be one whole number >= 0"),
        ("chunk=2.5", "", "&sweep: chunk = 2.5: must be one whole number >= 0"),
        ("dt=1e999", "", "&sweep: dt = inf: must be one finite number > 0"),
        ("unit=3", "", "&sweep: unit = 3.0: must be one text"),
        ("", "n_pulses='abc'", "grid: motion.n_pulses = 'abc': must be a whole number"),
        ("", "T_s='exact'", "grid: T_s = 'exact': must be a finite number"),
        ("", "e=1e999", "grid: impact.e = inf: must be a finite number"),
        ("records='**x.at2'", "", "records: **x.at2: "),
        ("records='a\0b'", "", "must not contain the character NUL"),
        ("file='a\0b'", "", "must not contain the character NUL"),
        (f"records='{LONG}'", "", "a name has at most 255 bytes"),
        (f"file='{LONG}'", "", "(3000 letters): a name has at most 255 bytes"),
        ("file=''", "", "&sweep: file = : must not be empty"),
        ("file='..'", "", "&sweep: file = ..: is a folder, not a file"),
        ("records='pipe'", "", "records: pipe: is not a regular file"),
    ],
    ids=lambda text: text[:20].replace("\0", "0"),
)
def test_sweep_files_that_are_refused(
    sweep: str, grid: str, message: str, folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    Path("s.nml").write_text(f"&sweep case='case.nml' {sweep} /\n&grid {grid} /\n", "utf-8")
    before = sorted(folder.iterdir())
    status, told = _told(["sweep", "s.nml"], capfd)
    assert status == 2
    assert told.startswith("rwmf: s.nml")
    assert message in told
    assert told.count("\n") == 1
    assert sorted(folder.iterdir()) == before


def test_what_nobody_has_foreseen(
    folder: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The message is one line with the kind of error, or the traceback on request."""

    def fail(_: object) -> int:
        raise ZeroDivisionError("by\nnothing")

    monkeypatch.setattr(case_files, "run_check", fail)
    monkeypatch.delenv("RWMF_TRACEBACK", raising=False)
    assert _told(["check", "case.nml"], capfd) == (
        3,
        "rwmf: unexpected ZeroDivisionError: by nothing (RWMF_TRACEBACK=1 in the environment shows "
        "where)\n",
    )
    monkeypatch.setenv("RWMF_TRACEBACK", "1")
    with pytest.raises(ZeroDivisionError):
        cli.main(["check", "case.nml"])


def _shell(line: str) -> subprocess.CompletedProcess[bytes]:
    text = line.replace("rwmf", f"{sys.executable} -m rwmf")
    return subprocess.run(text, shell=True, capture_output=True, check=False)


@pytest.mark.parametrize("words", ["check case.nml", "--help", "run case.nml --json --out ."])
@pytest.mark.parametrize("place", [">/dev/full", ">&-"])
def test_output_that_cannot_be_written(words: str, place: str, folder: Path) -> None:
    """The computation continues, files are written, and the command reports lost output."""
    done = _shell(f"rwmf {words} {place}")
    assert done.returncode == 2
    assert b"rwmf: the standard output cannot be written: " in done.stderr
    assert b"Traceback" not in done.stderr
    assert (folder / "case.summary.csv").exists() == ("--out" in words)


@pytest.mark.parametrize("place", ["2>/dev/full", "2>&-"])
def test_messages_that_cannot_be_written(place: str, folder: Path) -> None:
    del folder
    assert _shell(f"rwmf run missing.nml {place}").returncode == 2
    done = _shell(f"rwmf run case.nml --json {place}")
    assert (done.returncode, done.stdout[:1]) == (0, b"{")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_warnings_stand_before_the_results(unbuffered: str, folder: Path) -> None:
    """In a pipe for both streams as well, whatever Python buffers."""
    coupled(model={"formulation": "published"}, solver=QUICK).to_namelist(folder / "old.nml")
    done = _shell(f"PYTHONUNBUFFERED={unbuffered} rwmf run old.nml 2>&1")
    lines = done.stdout.decode().splitlines()
    warned = [line.startswith("rwmf: old.nml: warning: ") for line in lines]
    assert any(warned)
    assert warned == sorted(warned, reverse=True)
    assert lines[-1].split() == ["warnings", str(sum(warned))]


def test_names_that_are_no_utf8(folder: Path) -> None:
    """They are shown as they are; a terminal without the letters gets numbers."""
    name = os.fsdecode(b"caf\xe9.nml")
    (folder / "case.nml").rename(folder / name)
    here = os.fsencode(folder)
    command = [sys.executable, "-m", "rwmf", "check"]
    done = subprocess.run([*command, name], cwd=here, capture_output=True, check=True)
    assert done.stdout.startswith(b"caf\xe9.nml: valid\n")
    (folder / name).rename(folder / "caf\u00e9.nml")
    done = subprocess.run(
        [*command, "caf\u00e9.nml"],
        cwd=here,
        capture_output=True,
        check=True,
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
    )
    assert done.stdout.startswith(b"caf\\xe9.nml: valid\n")
