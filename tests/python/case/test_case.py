"""Case objects: typed, immutable, edited by copies, back to namelists."""

import math
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


SCENE = (
    "&wall h = 2.0, b = 0.5 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 / &solver t_end = 10.0 / "
)
# groups besides those of the scene, values, and keys that do not apply
_TEXTS: tuple[tuple[str, dict[str, object], str], ...] = (
    ("&cable eta_0 = 2 / &motion kind = 'one_sine', a_max_g = 4d-1, T_p = 1 /",
     {"cable.eta_alpha": 2.0, "cable.law": "linear", "model.formulation": "exact",
      "model.g": 9.81, "model.overturning_angle": math.pi / 2, "motion.t_0": 0.0,
      "solver.max_steps": 50_000_000, "solver.verify": False, "impact.rule": "coupled"},
     "solver.atol solver.accuracy impact.e motion.cycles wall.m_w"),
    ("&Impact R = 0.81 / &MOTION Kind = \"Sine\", v_p = -1, t_p = 2, cycles = 4, t_0 = -1d0 / "
     "&cable eta_0 = 0, law = 'truss' / &output dt = 0.1, energy = T / &initial theta_dot = 1 /",
     {"impact.r": 0.81, "impact.rule": "constant", "motion.kind": "sine", "motion.v_p": -1.0,
      "motion.T_p": 2.0, "motion.cycles": 4.0, "motion.t_0": -1.0, "cable.law": "truss",
      "output.energy": True, "initial.theta_over_alpha": 0.0},
     "impact.e motion.a_max_g"),
    ("&impact e = 0.9 / &motion kind = 'type_c', v_p = 1, T_p = 1 / &output /",
     {"impact.rule": "constant", "motion.n_pulses": 1, "output.energy": False}, ""),
    ("&impact table_e = 1, 0.9, table_theta_dot = 1, 2 / &motion kind = 'mavroeidis_papageorgiou', "
     "v_p = 1, T_p = 1, gamma_p = 2.5 /",
     {"impact.rule": "table", "motion.gamma_p": 2.5, "motion.nu": 0.0}, "impact.e"),
    ("&spectrum T_s_min = 0.1, T_s_max = 3, n = 30, spacing = 'log', gamma = 5, 2*10 /",
     {"spectrum.n": 30, "spectrum.spacing": "log", "spectrum.gamma": (5.0, 10.0, 10.0)},
     "spectrum.b spectrum.T_s"),
    ("&spectrum T_s = 0.1, 0.5 /", {"spectrum.T_s": (0.1, 0.5)}, "spectrum.n"),
    ("&spectrum T_s_min = 1, T_s_max = 1, n = 1 /", {"spectrum.spacing": "linear"}, ""),
    # just below the limit: a period of 1e-5 s
    ("&fuse eta_y = 40, stroke_y = 1e-9 /", {"fuse.eta_y": 40.0}, ""),
)  # fmt: skip


@pytest.mark.parametrize(("text", "values", "absent"), _TEXTS)
def test_values_and_defaults(text: str, values: dict[str, object], absent: str) -> None:
    groups = rwmf.Case.from_text(SCENE + text).groups
    found = {
        f"{group}.{key}": value for group, keys in groups.items() for key, value in keys.items()
    }
    assert {key: found.get(key) for key in values} == values
    assert not set(absent.split()) & set(found)


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


def test_a_record_ends_the_simulation(tmp_path: Path) -> None:
    path = tmp_path / "rec.txt"
    path.write_text("0\n0.1\n0\n", encoding="utf-8")
    case = coupled(motion=record(path, unit="g", dt=0.5), solver={"t_end": None})
    assert case.solver.t_end == 1.0
    assert "t_end" not in case.solver.given
    with pytest.raises(rwmf.InputError, match="the record has one column: it needs the key dt"):
        case.replace(motion={"dt": None})


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
