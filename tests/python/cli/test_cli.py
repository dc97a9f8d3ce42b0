"""The command line: contracts of its output, its files and its exit statuses."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import Runner, run_python
from processes import compute, spent_by_children
from rwmf.kernel import tables
from scenes import bare_frame, block, coupled, read_table

RUN_KEYS = [
    "u_s_max_m",
    "t_u_s_max_s",
    "theta_max_over_alpha",
    "theta_dot_max_rad_s",
    "cable_force_increment_max_over_m_w_g",
    "impacts",
    "lift_offs",
    "overturned",
    "e",
    "e_max",
    "steps",
    "rhs_evaluations",
    "seconds",
    "method",
    "rtol",
    "effects",
    "warnings",
]
# 0.2 s from Ctrl-C to the end of the computation, as promised; then Python has to shut down,
# on a machine that runs other tests at the same time
INTERRUPT_SECONDS = 1.0


@pytest.fixture
def case_file(tmp_path: Path) -> Path:
    """Write a short case with a spectrum."""
    path = tmp_path / "case.nml"
    coupled(solver={"t_end": 4.0}, spectrum={"T_s_min": 0.5, "T_s_max": 1.5, "n": 3}).to_namelist(
        path
    )
    return path


@pytest.mark.parametrize(
    "words", [[], ["run"], ["spectrum"], ["check"], ["records"], ["records", "export"]]
)
def test_help_with_an_example(command: Runner, words: list[str]) -> None:
    found = command(*words, "--help")
    assert found.returncode == 0
    assert "example: rwmf" in " ".join(found.stdout.split())


def test_version(command: Runner, batch: Runner) -> None:
    found = command("--version")
    assert found.returncode == 0
    # the instructions that the vectorised loops use on this machine
    assert re.fullmatch(
        rf"rwmf {re.escape(rwmf.__version__)} \((x86-64(-v[34])?|generic)\)\n", found.stdout
    )
    assert batch("--version").stdout == found.stdout


@pytest.mark.parametrize("words", [[], ["dance"], ["run"], ["spectrum", "x", "--threads", "-1"]])
def test_usage_errors(command: Runner, words: list[str]) -> None:
    found = command(*words)
    assert found.returncode == 2
    assert "usage: rwmf" in found.stderr


@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        ([], 2, "no case is given"),
        (["--help"], 0, "usage: rwmf-batch"),
        (["--fast", "x.nml"], 2, "allowed: --out DIR, --part K/N"),
        (["--out"], 2, "--out"),
        (["--out", "nowhere", "x.nml"], 2, "nowhere"),
        (["--part", "3/2", "x.nml"], 2, "--part"),
        (["--part"], 2, "--part"),
        (["--out", ".", "a/x.nml", "b/x.nml"], 2, "b/x.nml: writes to the same names as a/x.nml"),
    ],
)
def test_words_of_the_batch_program(
    batch: Runner, words: list[str], status: int, said: str, case_file: Path, tmp_path: Path
) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "x.nml").write_bytes(case_file.read_bytes())
    found = batch(*words)
    assert found.returncode == status
    assert said in " ".join((found.stdout + found.stderr).split())
    assert not [*tmp_path.rglob("*.csv")]


def test_run_json(command: Runner, case_file: Path) -> None:
    found = command("run", case_file, "--json")
    assert found.returncode == 0
    shown = json.loads(found.stdout)
    assert [key for key in shown if key in RUN_KEYS] == RUN_KEYS
    assert {"floor_acceleration_max_g", "roof_drift_max", "tendon_force_max_over_m_w_g"} <= {*shown}
    assert [key for key in shown if key.startswith("sensitivity_")]
    assert shown["effects"][:4] == ["wall", "frame", "cable", "impact"]
    assert isinstance(shown["overturned"], bool)
    assert isinstance(shown["impacts"], int)


def test_keys_that_do_not_apply_are_absent(command: Runner, tmp_path: Path) -> None:
    path = tmp_path / "bare.nml"
    bare_frame(output={"energy": True, "reactions": False}).to_namelist(path)
    shown = json.loads(command("run", path, "--json").stdout)
    of_the_wall = [*RUN_KEYS[2:8], "e", "e_max"]
    expected = [key for key in RUN_KEYS if key not in of_the_wall]
    parts = [f"energy_{part}_J_per_kg" for part in ("input", "kinetic", "strain", "viscous")]
    keys = [key for key in shown if not key.startswith("sensitivity_")]
    assert keys == [*expected, *parts, "energy_balance_relative"]
    path = tmp_path / "block.nml"
    block(initial={"theta_over_alpha": 0.5}).to_namelist(path)
    shown = json.loads(command("run", path, "--json").stdout)
    assert "u_s_max_m" not in shown
    assert "cable_force_increment_max_over_m_w_g" not in shown
    assert shown["theta_max_over_alpha"] == 0.5


def test_failed_ordinates_are_null(command: Runner, tmp_path: Path) -> None:
    """An ordinate that fails gets a reason and does not stop the others."""
    path = tmp_path / "few.nml"
    coupled(solver={"t_end": 4.0, "max_steps": 20}, spectrum={"T_s": [0.5, 1.0]}).to_namelist(path)
    found = command("spectrum", path, "--json", "--out", "few.csv")
    assert found.returncode == 0
    shown = json.loads(found.stdout, parse_constant=pytest.fail)
    assert shown["u_s_max_m"] == [[[None, None]]]
    assert shown["status"] == [[["too_many_steps", "too_many_steps"]]]


def test_numerical_failure(command: Runner, batch: Runner, tmp_path: Path) -> None:
    path = tmp_path / "few.nml"
    coupled(solver={"max_steps": 20}).to_namelist(path)
    ours, theirs = command("run", path, "--out", "."), batch(path)
    assert (ours.returncode, theirs.returncode) == (1, 1)
    assert "max_steps" in ours.stderr
    assert ours.stderr.removeprefix("rwmf") == theirs.stderr.removeprefix("rwmf-batch")
    assert list(tmp_path.iterdir()) == [path]


def test_batch_notes_groups_of_the_command(batch: Runner, tmp_path: Path) -> None:
    """`rwmf-batch` has no checks, gradients and designs; a case without them has no note."""
    path, plain = tmp_path / "limited.nml", tmp_path / "plain.nml"
    case = coupled(solver={"t_end": 1.0})
    case.to_namelist(plain)
    case.replace(
        limits={"theta_max_over_alpha": 0.3}, sensitivity={"parameters": ["T_s"]}
    ).to_namelist(path)
    found = batch(plain, path)
    assert found.returncode == 0
    assert [line for line in found.stderr.splitlines() if " note: " in line] == [
        f"rwmf-batch: {path}: note: &limits, &sensitivity: evaluated by the command rwmf only"
    ]


def test_tables_of_the_batch_program(batch: Runner, tmp_path: Path) -> None:
    """Names of files, the text of the case, quotes in a list, bits of numbers."""
    motion = "&motion kind = 'record', file = 'say \"no\".txt', unit = 'g' / &output dt = 0.1 /"
    lines = ["&wall h = 2.0, b = 0.5 /", "! second line", motion]
    (tmp_path / 'say "no".txt').write_text("0 0\n1 900\n2 900\n", encoding="ascii")
    names = {"a.b.nml": "a.b", ".nml": ".nml", "plain": "plain"}
    for name in names:
        (tmp_path / name).write_bytes("\r\n".join(lines).encode())
    assert batch(*names).returncode == 0
    found = rwmf.simulate(tmp_path / "a.b.nml")
    for name in names.values():
        comments, (row,) = read_table(tmp_path / f"{name}.summary.csv")
        assert {f"# {line}" for line in lines} <= {*comments}
        assert row["warnings"] == found.attrs["warnings"].replace("\n", "; ")
        assert 'say "no"' in row["warnings"]
        _, history = read_table(tmp_path / f"{name}.history.csv")
        theta = [float(row["theta_rad"]) for row in history]
        np.testing.assert_array_equal(theta, found["theta"])


def test_check(command: Runner, case_file: Path) -> None:
    found = command("check", case_file)
    assert found.returncode == 0
    assert "effects: wall, frame, cable, impact, motion" in found.stdout
    assert "spectrum: 3 simulations" in found.stdout
    groups = dict.fromkeys(row[0] for row in tables.schema())
    given = ["wall", "frame", "cable", "impact", "motion", "model", "solver", "output", "spectrum"]
    given += ["base_section", "limits", "sensitivity", "design"]
    absent = ", ".join(group for group in groups if group not in given)
    assert absent.startswith("base, storeys, link, damper")
    assert f"not simulated: {absent}\n" in found.stdout
    assert "states: theta_rad, theta_dot_rad_s" in found.stdout
    assert "events: impact, peak, lift_off, rest, overturned" in found.stdout
    outputs = next(line for line in found.stdout.splitlines() if line.startswith("outputs: "))
    assert {*RUN_KEYS, "base_shear_max_over_weight"} <= {*outputs[9:].split(", ")}
    assert "history: none" in found.stdout
    assert "(law" not in found.stdout
    assert "rtol = 1e-09" in found.stdout


def test_check_lists_what_a_run_writes(command: Runner, tmp_path: Path) -> None:
    """The lists are not kept beside the outputs: they are those of the run itself."""
    path = tmp_path / "all.nml"
    output = {"dt": 0.01, "energy": True, "reactions": True, "friction_limit": 1e3}
    block(output=output, wall={"h": 2.0, "b": 0.5, "m_w": 1000.0}).to_namelist(path)
    lines = command("check", path).stdout.splitlines()
    shown = dict(line.split(": ", 1) for line in lines if ": " in line)
    assert shown["outputs"].split(", ") == list(json.loads(command("run", path, "--json").stdout))
    command("run", path, "--out", tmp_path)
    text = (tmp_path / "all.history.csv").read_text(encoding="utf-8")
    columns = next(line for line in text.splitlines() if line[0] != "#")
    assert shown["history"].split(", ") == columns.split(",")


def test_input_errors(command: Runner, case_file: Path) -> None:
    for words in (["run"], ["spectrum"], ["check"]):
        found = command(*words, "missing.nml")
        assert found.returncode == 2
        assert found.stderr == "rwmf: missing.nml: the file does not exist\n"
        assert found.stdout == ""
    no_grid = case_file.with_name("no_grid.nml")
    coupled().to_namelist(no_grid)
    found = command("spectrum", no_grid)
    assert found.returncode == 2
    assert "&spectrum" in found.stderr


def test_records(command: Runner, tmp_path: Path) -> None:
    assert "elcentro" in command("records", "export").stdout
    found = command("records", "export", "elcentro", "--out", "new/elcentro.csv")
    assert found.returncode == 0
    assert "1560 points" in found.stdout
    assert (tmp_path / "new" / "elcentro.csv").is_file()
    assert command("records", "export", "nothing", "--out", "x").returncode == 2


def test_closed_pipe(case_file: Path) -> None:
    found = subprocess.run(
        f"{sys.executable} -m rwmf check {case_file} | head -n 1",
        shell=True,
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.stderr == ""


@pytest.mark.slow
@pytest.mark.parametrize("words", [["run", "--out", "."], ["spectrum", "--out", "x.csv"]])
def test_interrupt(words: list[str], tmp_path: Path) -> None:
    """Ctrl-C ends a long computation at once, with status 130 and without files."""
    path = tmp_path / "long.nml"
    coupled(
        frame={"T_s": 0.05},
        motion={"kind": "sine", "cycles": 1e6},
        solver={"t_end": 1e6},
        spectrum={"T_s": [0.05, 0.06, 0.07]},
    ).to_namelist(path)
    process = subprocess.Popen(
        [sys.executable, "-m", "rwmf", words[0], str(path), *words[1:]],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )
    earlier = spent_by_children()
    sent = compute(process, 3.0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=30)
    assert spent_by_children() - earlier - sent < INTERRUPT_SECONDS
    assert (process.returncode, errors) == (130, "rwmf: interrupted\n")
    assert list(tmp_path.iterdir()) == [path]


def test_signals_end_commands_that_draw(tmp_path: Path) -> None:
    """SIGTERM and SIGHUP leave no unfinished film; an ignored SIGHUP, as by nohup, stays so."""
    coupled(solver={"t_end": 20.0}).to_namelist(tmp_path / "case.nml")
    words = [sys.executable, "-m", "rwmf", "animate", "case.nml"]
    for ends, ignored in (([signal.SIGTERM] * 2, False), ([signal.SIGHUP, signal.SIGTERM], True)):
        before = signal.signal(signal.SIGHUP, signal.SIG_IGN if ignored else signal.SIG_DFL)
        try:
            process = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)  # fmt: skip
        finally:
            signal.signal(signal.SIGHUP, before)
        with process:
            while not any(tmp_path.glob(".rwmf-*")):
                assert process.poll() is None
                time.sleep(0.02)
            process.send_signal(ends[0])
            if ignored:
                time.sleep(0.3)
                assert process.poll() is None
            process.send_signal(ends[1])
            _, errors = process.communicate(timeout=60)
        # `python -m` sends itself SIGINT at its end, which shells report as 130, where the signal
        # came while a library ran the text of a function, as `dataclasses` does
        assert process.returncode in (130, -signal.SIGINT)
        assert errors == "rwmf: interrupted\n"
        assert list(tmp_path.iterdir()) == [tmp_path / "case.nml"]


def test_interrupt_in_python(tmp_path: Path) -> None:
    """The exception is raised within 0.2 s of processor time after the signal."""
    code = """
import os, signal, threading, time
import rwmf
from scenes import coupled
case = coupled(frame={"T_s": 0.05}, motion={"kind": "sine", "cycles": 1e6}, solver={"t_end": 1e6})
# imported before the signal: it is meant for the kernel
simulate = rwmf.simulate
sent = []
def send():
    sent.append(time.process_time())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(0.5, send).start()
try:
    simulate(case)
except KeyboardInterrupt as error:
    assert isinstance(error, rwmf.Interrupted)
    print(time.process_time() - sent[0])
"""
    found = run_python(code, tmp_path)
    assert found.returncode == 0, found.stderr
    assert float(found.stdout) < 0.2


def test_an_error_in_the_progress_function_stops_the_kernel() -> None:
    case = coupled(motion={"kind": "sine", "cycles": 1e6}, solver={"t_end": 1e6})

    def fail(done: int, total: int) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        rwmf.spectrum(case, T_s=[0.05], progress=fail)
