"""Case objects: typed, immutable, edited by copies, back to namelists."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import rwmf
from hypothesis import given
from hypothesis import strategies as st
from rwmf.case.namelist import format_value
from scenes import coupled, record

TEXT = """! a comment
&WALL H = 2.0, b = 0.5 /
&frame t_s = 1 gamma = 5, xi_s = 5d-2 /
&motion kind = 'one_sine' v_p = 0.6 T_p = 1.0 /
&solver t_end = 2.0 /
"""


def test_values_are_typed() -> None:
    case = rwmf.Case.from_text(TEXT)
    assert (case.wall.h, case.frame.T_s, case.frame.xi_s) == (2.0, 1.0, 0.05)
    assert isinstance(case.frame.T_s, float)
    assert case.motion.kind == "one_sine"
    assert isinstance(case.solver.max_steps, int)
    assert case.frame["t_S"] == 1.0
    assert case.frame.units["T_s"] == "s"


def test_absent_groups_are_none() -> None:
    case = rwmf.Case.from_text(TEXT)
    assert case.cable is None
    assert case.spectrum is None
    assert "cable" not in case.groups
    with pytest.raises(AttributeError, match="there is no namelist group &cabel"):
        _ = case.cabel
    with pytest.raises(AttributeError, match="T_s, gamma, xi_s"):
        _ = case.frame.k_s


def test_defaults_come_from_the_kernel() -> None:
    case = rwmf.Case.from_text(TEXT)
    assert case.solver.method == "auto"
    assert case.solver.rtol == 1e-9
    assert "rtol" not in case.solver.given
    assert "t_end" in case.solver.given


def test_a_case_cannot_be_changed() -> None:
    case = coupled()
    with pytest.raises(AttributeError, match="replace"):
        case.frame.T_s = 2.0
    with pytest.raises(AttributeError, match="replace"):
        case.frame = None
    with pytest.raises(TypeError):
        case.frame["T_s"] = 2.0


def test_edits_return_new_cases() -> None:
    first = coupled()
    second = first.replace(frame={"t_s": 0.4}, output={"dt": 0.01})
    assert (first.frame.T_s, first.output) == (1.0, None)
    assert (second.frame.T_s, second.frame.gamma, second.output.dt) == (0.4, 5.0, 0.01)
    third = second.without("cable", "output")
    assert third.cable is None
    assert third == first.replace(frame={"T_s": 0.4}).replace(cable=None)
    assert first != second
    assert len({first, second, coupled()}) == 2


def test_bad_edits_are_refused() -> None:
    case = coupled()
    with pytest.raises(rwmf.InputError, match="T_s"):
        case.replace(frame={"T_s": -1.0})
    with pytest.raises(rwmf.InputError, match="no group &output"):
        case.without("output")
    with pytest.raises(rwmf.InputError):
        case.replace(fraem={"T_s": 1.0})
    with pytest.raises(rwmf.InputError, match=r"&frame: T_s = .* a namelist holds"):
        case.replace(frame={"T_s": object()})


def test_numpy_values() -> None:
    case = coupled(frame={"T_s": np.float64(0.7)}, solver={"max_steps": np.int64(1000)})
    assert (case.frame.T_s, case.solver.max_steps) == (0.7, 1000)
    many = coupled(spectrum={"T_s": np.linspace(0.1, 3, 300)})
    assert many.spectrum.T_s == tuple(np.linspace(0.1, 3, 300))
    assert max(map(len, many.to_namelist().splitlines())) <= 100


@given(st.floats(min_value=1e-300, max_value=1e300))
def test_numbers_round_trip(value: float) -> None:
    assert rwmf.Case.from_text(TEXT).replace(wall={"h": value}).wall.h == value


@pytest.mark.parametrize("value", [True, 3, 0.1, 1e-300, "it's", [1.0, 2.5], np.array([1, 2])])
def test_formats(value: object) -> None:
    assert format_value(value)


def test_namelist_text_is_stable() -> None:
    first = coupled(output={"dt": 0.01, "energy": True})
    assert rwmf.Case.from_text(first.to_namelist()).to_namelist() == first.to_namelist()
    assert rwmf.Case.from_text(TEXT).text == TEXT


def test_record_paths_stay_right(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A relative path is relative to the namelist, also for copies of the case."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    (tmp_path / "a" / "rec.txt").write_text("0 0\n0.5 1\n1 0\n", encoding="utf-8")
    motion = record(Path("rec.txt"), unit="m/s2")
    text = coupled().replace(motion={"kind": "none", "a_max_g": None, "omega_p": None})
    with monkeypatch.context() as patch:
        patch.chdir(tmp_path / "a")
        case = text.replace(motion=motion)
        expected = float(rwmf.simulate(case)["u_s_max"])
        case.to_namelist("case.nml")
    copies = [case, rwmf.Case.from_text(case.to_namelist())]
    monkeypatch.chdir(tmp_path)
    copies.append(rwmf.Case.from_namelist(Path("a", "case.nml")))
    copies[-1].to_namelist(tmp_path / "b" / "copy.nml")
    assert "../a/rec.txt" in (tmp_path / "b" / "copy.nml").read_text(encoding="utf-8")
    copies.append(rwmf.Case.from_namelist(tmp_path / "b" / "copy.nml"))
    copies.append(pickle.loads(pickle.dumps(copies[2])))
    copies.append(copies[2].replace(output={"dt": 0.1}))
    monkeypatch.chdir(tmp_path / "b")
    for copy in copies:
        assert float(rwmf.simulate(copy)["u_s_max"]) == expected


def test_repr() -> None:
    text = repr(coupled(spectrum={"T_s": list(np.linspace(0.1, 3, 30))}))
    assert "T_s = 1.0 s" in text
    assert "(30 values)" in text
    assert "rtol = 1e-09" in text


def test_unwritable_namelist(tmp_path: Path) -> None:
    with pytest.raises(rwmf.OutputError, match="cannot be written"):
        coupled().to_namelist(tmp_path / "missing" / "case.nml")
