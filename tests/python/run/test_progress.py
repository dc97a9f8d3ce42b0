"""Bars of long computations, in a notebook and on a terminal."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf.cli import main
from rwmf.kernel import progress as _progress
from scenes import coupled

T_S = [0.4, 0.6, 0.8]


class _Shell:
    """Shell of IPython inside a Jupyter kernel."""

    kernel = object()


class _Cell:
    """Output of a notebook's cell: one text for each change that a reader has seen."""

    def __init__(self) -> None:
        self.seen: list[str] = []

    def display(self, shown: object, *, display_id: bool) -> _Cell:
        """Show an object and return its place."""
        assert display_id
        self.update(shown)
        return self

    def update(self, shown: object) -> None:
        """Show an object in place of the one before."""
        self.seen.append(shown._repr_html_())  # type: ignore[attr-defined]
        assert str(shown) in self.seen[-1]


@pytest.fixture
def cell(monkeypatch: pytest.MonkeyPatch) -> _Cell:
    """Let this process be a Jupyter kernel without a front end."""
    pytest.importorskip("IPython")
    import IPython.core.getipython
    import IPython.display

    found = _Cell()
    monkeypatch.setattr(IPython.core.getipython, "get_ipython", _Shell)
    monkeypatch.setattr(IPython.display, "display", found.display)
    return found


def _map(progress: bool) -> object:
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.4},
        motion={"kind": "one_sine", "a_max_g": 0.3, "T_p": 0.5},
        solver={"t_end": 4.0},
    )
    return rwmf.studies.overturning_map(
        case, [5.0, 6.0, 7.0], [1.0, 3.0], tolerance=1.0, progress=progress
    )


CALLS: dict[str, Callable[[bool], object]] = {
    "ordinate": lambda progress: rwmf.spectrum(coupled(), T_s=T_S, progress=progress),
    "run": lambda progress: rwmf.sweep(coupled(), {"T_s": T_S}, progress=progress),
    "period": lambda progress: rwmf.studies.equal_response(
        coupled(), T_S, 0.01, tolerance=0.5, progress=progress
    ),
    "scan": _map,
}


@pytest.mark.parametrize("unit", CALLS)
def test_a_notebook_shows_a_bar(unit: str, cell: _Cell) -> None:
    """It ends with the number of units and their time, in place of the bar."""
    CALLS[unit](True)
    assert cell.seen[0].startswith("<progress max=")
    assert cell.seen[-1].startswith(f"3 of 3 {unit}s after ")
    assert "<progress" not in cell.seen[-1]


@pytest.mark.parametrize("unit", CALLS)
def test_nothing_is_shown_without_a_wish(unit: str, cell: _Cell) -> None:
    CALLS[unit](False)
    assert not cell.seen


def test_an_interrupted_bar_says_how_far_it_came(cell: _Cell) -> None:
    with pytest.raises(ZeroDivisionError), _progress.reporting(True) as report:
        assert report is not None
        report(2, 5)
        raise ZeroDivisionError
    assert cell.seen[-1].startswith("2 of 5 runs after ")


def test_a_redirected_output_shows_none(capfd: pytest.CaptureFixture[str]) -> None:
    rwmf.spectrum(coupled(), T_s=T_S, progress=True)
    assert capfd.readouterr() == ("", "")


def test_a_bar_is_refused_by_name() -> None:
    with pytest.raises(rwmf.InputError, match=r"progress = 3: must be True, or a function"):
        rwmf.spectrum(coupled(), T_s=T_S, progress=3)  # type: ignore[arg-type]


_QUAKES = [
    rwmf.Motion(np.sin(np.arange(100) * w), dt=0.02, unit="m/s2", name=f"w{w:g}")
    for w in (0.1, 0.2, 0.3)
]
SEARCHES: dict[str, Callable[..., object]] = {
    "ordinate": lambda **further: rwmf.spectrum(coupled(), T_s=T_S, **further),
    "run": lambda **further: rwmf.gradient(coupled(), ["T_s"], ["u_s_max"], **further),
    "design": lambda **further: rwmf.design(
        coupled(),
        {"xi_s": (0.02, 0.2)},
        [{"quantity": "u_s_max", "limit": 0.2, "percentile": 100}],
        {"xi_s": 1.0},
        designs=16,
        **further,
    ),
    "record": lambda **further: rwmf.records.select(
        _QUAKES, ([0.1, 2.0], [1.0, 0.1]), (0.2, 1.0), limits=(1e-3, 1e3), **further
    ),
}


@pytest.mark.parametrize("unit", SEARCHES)
def test_searches_report_what_they_have_done(unit: str, cell: _Cell) -> None:
    """The total may grow on the way; at the end all are done."""
    reports: list[tuple[int, int]] = []
    SEARCHES[unit](progress=lambda done, total: reports.append((done, total)))
    assert reports == sorted(reports)
    # the kernel reports no ordinate of a call that is this short but the last
    assert unit == "ordinate" or len({done for done, _ in reports}) > 1
    assert reports[-1][0] == reports[-1][1]
    SEARCHES[unit](progress=True)
    assert cell.seen[-1].startswith(f"{reports[-1][0]} of {reports[-1][1]} {unit}s after ")


# words of each command that loops over runs, behind its case
_LOOPS = {
    "spectrum": "--threads 1 --json",
    "gradient": "--parameters T_s --quantities u_s_max",
    "design": "--vary xi_s=0.02:0.2 --target u_s_max=0.2@100 --cost xi_s=1 --designs 16",
    "stripes": "--records quake.csv --unit g,0.02 --levels 0.1,0.2 --quantities u_s_max",
    "ida": "--records quake.csv --unit g,0.02 --levels 0.1,0.2 --quantities u_s_max --highest 0.4",
    "cloud": "--records quake.csv --unit g,0.02 --quantities u_s_max",
    "study wall": "--T_s 0.5,1.0",
    "study equal-response": "--T_p 0.5,1.0 --target 0.01",
    "records select": "--target target.csv --band 0.2,1 --limits 0.001,1000 --unit g,0.02",
}


@pytest.mark.parametrize("command", _LOOPS)
def test_every_command_that_loops_has_a_bar(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """On a terminal; JSON on the standard output stays clean."""
    monkeypatch.chdir(tmp_path)
    case = coupled(solver={"t_end": 2.0}, spectrum={"T_s": T_S})
    case.to_namelist("case.nml")
    Path("quake.csv").write_text("\n".join(map(str, 0.1 * _QUAKES[0].values)), encoding="utf-8")
    Path("target.csv").write_text("0.1,1\n2,0.1\n", encoding="utf-8")
    subject = "quake.csv" if command == "records select" else "case.nml"
    reader, terminal = os.openpty()
    with os.fdopen(terminal, "w") as stream, monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", stream)
        status = main([*command.split(), subject, *_LOOPS[command].split()])
    shown = os.read(reader, 65536).decode()
    os.close(reader)
    assert status == 0
    assert "/s]" in shown or "it/s" in shown or "[00:00<" in shown
    if command == "spectrum":
        assert "/3 [" in shown
        assert len(json.loads(capfd.readouterr().out)["T_s_s"]) == 3
