"""A frame with a period in `&spectrum` only cannot be run singly, by any interface."""

from collections.abc import Callable
from pathlib import Path

import pytest
import rwmf
from checkout import Runner
from rwmf import cli
from rwmf.kernel import measure as _measure

SCENE = """&wall h = 2.0, b = 0.5 /
&frame gamma = 5.0, xi_s = 0.05 /
&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /
&model formulation = 'exact' /
&solver t_end = 1.0 /
&spectrum T_s = 1.0, 2.0 /
"""
NEEDED = "the key T_s is missing"

WAYS: dict[str, Callable[[rwmf.Case], object]] = {
    "simulate": rwmf.simulate,
    "history": lambda case: rwmf.simulate(case, dt=0.01),
    "accuracy": lambda case: rwmf.simulate(case.replace(solver={"accuracy": 1e-3})),
    "verify": lambda case: rwmf.simulate(case.replace(solver={"verify": True})),
    "cost": rwmf.cost,
    "a method": lambda case: _measure.measure_method(case, "dop853", 1e-6, 0.0),
    "a practice": lambda case: _measure.measure_fixed_steps(case, "rk4", 1.0, 0.0),
    "the reference": lambda case: _measure.solve_reference(case, 1e-18, 1e-20),
}


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("single") / "scene.nml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.mark.parametrize("way", WAYS)
def test_the_period_is_asked_for(way: str, file: Path) -> None:
    with pytest.raises(rwmf.InputError, match=NEEDED) as caught:
        WAYS[way](rwmf.Case.from_namelist(file))
    assert str(caught.value).startswith(str(file))
    assert "&frame (line" in str(caught.value)


@pytest.mark.parametrize("words", ["run", "cost", "animate --out a.gif", "study overturning"])
def test_the_commands_say_so(words: str, file: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main([*words.split(), str(file)]) == rwmf.InputError.exit_status
    assert NEEDED in capsys.readouterr().err


def test_a_spectrum_needs_none(file: Path, tmp_path: Path, batch: Runner) -> None:
    found = rwmf.spectrum(rwmf.Case.from_namelist(file))
    assert (found.status == "ok").all()
    assert batch(file, "--out", tmp_path).returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["scene.spectrum.csv"]


def test_history_larger_than_the_stack() -> None:
    """The history is shortened to the written rows; a thread has 8 MB."""
    case = rwmf.Case(
        frame={"T_s": 1.0, "xi_s": 0.05},
        motion={"kind": "one_sine", "a_max_g": 0.4, "T_p": 1.0},
        solver={"t_end": 3.0},
    )
    run = rwmf.simulate(case, dt=1e-5)
    assert run["time"].size == 300_001
    assert sum(run[name].nbytes for name in run if "time" in run[name].dims) > 6_000_000
