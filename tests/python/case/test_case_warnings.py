"""Warnings about a case: values outside the range of real buildings, and omitted effects.

Keys and their ranges come from the kernel's table, values from the shipped inputs.
"""

import json
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from checkout import ROOT, Runner
from rwmf.cli import main
from rwmf.kernel import tables
from scenes import bare_frame, block, coupled

INPUTS = sorted((ROOT / "inputs").glob("*.nml"))
RANGES = {
    (row[0], row[1]): tuple(float(end) for end in row[7].strip("[]").split(","))
    for row in tables.schema()
    if row[7]
}
STOREYS = {
    "n": 3, "m": 1.5e5, "k": 1.0e8, "height": 3.2, "coupling": "every_floor",
}  # fmt: skip
BUILDING: dict[str, dict[str, object]] = {
    "wall": {"h": 4.8, "b": 1.0, "density": 2500.0, "thickness": 0.3},
    "frame": {"xi_s": 0.03},
    "storeys": STOREYS,
    "cable": {"strands": 12, "strand_area": 150e-6, "modulus": 195e9, "initial_stress": 800e6},
    "fuse": {"F_y": 5e4, "k": 5e7},
    "impact": {"rule": "coupled"},
    "motion": {"kind": "one_sine", "a_max_g": 0.3, "T_p": 0.8},
    "solver": {"t_end": 1.0},
}
RIGID = "the wall is rigid"


def _given(case: rwmf.Case) -> Iterator[tuple[str, str, object]]:
    for group, values in case.groups.items():
        for key in values.given:
            if (group, key) in RANGES and key not in values.derived:
                yield group, key, values[key]


def _scaled(value: object, factor: float) -> object:
    return [x * factor for x in value] if isinstance(value, tuple) else float(str(value)) * factor


def _outside(case: rwmf.Case) -> list[str]:
    return [line for line in case.kernel.warnings() if "range of real buildings" in line]


def test_shipped_inputs_are_usual() -> None:
    for path in INPUTS:
        assert _outside(rwmf.Case.from_namelist(path)) == [], path


def test_every_key_with_a_range_warns() -> None:
    """Both ends, for each key that an input, or the building here, gives."""
    seen = set()
    for case in [*map(rwmf.Case.from_namelist, INPUTS), rwmf.Case(**BUILDING)]:
        for group, key, value in _given(case):
            low, high = RANGES[group, key]
            numbers = value if isinstance(value, tuple) else (value,)
            if (group, key) in seen or not all(numbers):
                continue
            for factor in (0.3 * low / max(map(abs, numbers)), 3 * high / min(map(abs, numbers))):
                try:
                    changed = case.replace(**{group: {key: _scaled(value, factor)}})
                except rwmf.InputError:
                    continue
                seen.add((group, key))
                assert any(line.startswith(f"&{group} {key} = ") for line in _outside(changed)), (
                    group, key, factor,
                )  # fmt: skip
    assert len(seen) >= 35


@pytest.mark.parametrize(
    ("group", "key", "value", "told"),
    [
        ("frame", "xi_s", 3.0, "3.0 % would be 0.03"),
        ("cable", "initial_stress", 800.0, "800.0 MPa would be 800000000.0 Pa"),
        ("cable", "strand_area", 150.0, "150.0 mm2 would be 0.00015 m2"),
        ("cable", "modulus", 195.0, "195.0 GPa would be 195000000000.0 Pa"),
        ("wall", "density", 2.5, "2.5 t/m3 would be 2500.0 kg/m3"),
        ("wall", "thickness", 300.0, "300.0 mm would be 0.3 m"),
        ("storeys", "m", 150.0, "150.0 t would be 150000.0 kg"),
        ("fuse", "F_y", 50.0, "50.0 kN would be 50000.0 N"),
    ],
)
def test_the_likely_slip(group: str, key: str, value: float, told: str) -> None:
    case = rwmf.Case(**BUILDING)
    assert _outside(case) == []
    lines = _outside(case.replace(**{group: {key: value}}))
    assert len(lines) == 1
    assert lines[0].startswith(f"&{group} {key} = {value}")
    assert lines[0].endswith(told)


def test_a_value_that_follows_from_usual_ones() -> None:
    """A frame of kg/s2 where N/m is meant: its stiffness is usual, its period is not."""
    case = bare_frame(frame={"T_s": None, "m_s": 5.0e8, "k_s": 2.0e5})
    assert [line.split(" = ")[0] for line in _outside(case)] == ["&frame T_s"]


def test_every_way_in_warns_once(command: Runner, batch: Runner, tmp_path: Path) -> None:
    case = rwmf.Case(**BUILDING).replace(frame={"xi_s": 3.0}, spectrum={"T_s": [0.4, 0.8]})
    case.to_namelist(tmp_path / "slip.nml")
    begin = "&frame xi_s = 3.0 "
    assert json.loads(command("check", "slip.nml", "--json").stdout)["warnings"][0].startswith(
        begin
    )
    for words in (["check"], ["run"], ["spectrum"]):
        found = command(*words, "slip.nml")
        assert (found.stdout + found.stderr).count(f"warning: {begin}") == 1, words
        assert found.returncode == 0
    assert batch("slip.nml").stderr.count(begin) == 1
    grid = {"T_s": [0.4, 0.8], "xi_s": [2.0, 3.0]}
    assert rwmf.sweep(case, grid).attrs["warnings"].count("&frame xi_s = ") == 1
    assert rwmf.simulate(case).attrs["warnings"].count(begin) == 1


# each function whose result is that of a case with a warning
_DOORS: dict[str, Callable[[rwmf.Case], object]] = {
    "simulate": rwmf.simulate,
    "spectrum": lambda case: rwmf.spectrum(case, T_s=[0.5, 1.0]),
    "sweep": lambda case: rwmf.sweep(case, {"T_s": [0.5, 1.0]}),
    "pushover": lambda case: rwmf.pushover(case, 0.01, steps=2),
    "wall": rwmf.Wall,
    "walls": lambda case: rwmf.Walls([case, case]),
    "element": rwmf.Element,
    "couple": lambda case: rwmf.hosts.couple(
        case, rwmf.hosts.FunctionHost([5.0], [[0.1]], [[40.0]], float, [0]), float, 0.05, 0.1
    ),
    "wall effect": lambda case: rwmf.studies.wall_effect(case, {"T_s": [0.5]}),
}


@pytest.mark.parametrize("door", _DOORS)
def test_every_function_emits_warnings_at_the_line_of_the_user(door: str) -> None:
    case = coupled(
        frame={"xi_s": 3.0}, wall={"m_w": 1000.0, "thickness": None}, solver={"t_end": 0.1}
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        _DOORS[door](case)
    texts = [str(one.message) for one in caught]
    assert sum("&frame xi_s = 3.0 " in text for text in texts) == 1, texts
    assert len(texts) == len(set(texts))
    assert {(one.category, one.filename) for one in caught} == {(rwmf.RwmfWarning, __file__)}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", rwmf.RwmfWarning)
        _DOORS[door](case)
    assert not caught


def test_commands_emit_no_warnings_of_python(tmp_path: Path) -> None:
    """They print them, once; see `test_every_way_in_warns_once`."""
    path = tmp_path / "slip.nml"
    coupled(frame={"xi_s": 3.0}, spectrum={"T_s": [0.5]}).to_namelist(path)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for words in (["run"], ["spectrum"], ["pushover"]):
            assert main([*words, str(path)]) == 0
    assert not caught


def test_the_rigid_wall_is_told_where_it_matters() -> None:
    case = rwmf.Case(**BUILDING, output={"reactions": False})
    assert not any(RIGID in line for line in case.kernel.warnings())
    assert RIGID not in rwmf.simulate(case).attrs["warnings"]
    asking = case.replace(output=None)
    assert sum(RIGID in line for line in asking.kernel.warnings()) == 1
    assert rwmf.simulate(asking).attrs["warnings"].count(RIGID) == 1
    for quantity, n in (
        ("u_s_max_m", 0),
        ("storey_drift_max", 0),
        ("base_shear_max_over_weight", 0),
        ("floor_acceleration_max_g", 1),
        ("floor_2_acceleration_max_g", 1),
        ("wall_shear_max_over_m_w_g", 1),
        ("wall_moment_max_N_m", 1),
    ):
        found = rwmf.spectrum(case, T_s=[0.5], quantities=[quantity])
        assert found.attrs["warnings"].count(RIGID) == n, quantity
    free = {"coupling": "reduced"}
    alone = case.replace(
        wall=None, cable=None, fuse=None, impact=None, storeys=free, output={"reactions": True}
    )
    assert not any(RIGID in line for line in alone.kernel.warnings())


def test_landings_are_told_until_springs_and_shear_limit_them() -> None:
    case = rwmf.Case(**BUILDING).replace(fuse=None, bending={"E": 3e10})
    for coupling, bending, texts in (
        ("every_floor", {"nu": 0.2}, ("base shear, lowest links", "; coupling = 'springs'")),
        ("springs", {}, ("the base shear comes", "&bending nu")),
        ("springs", {"nu": 0.2}, ()),
    ):
        link = {"k_link": 3e8} if coupling == "springs" else {}
        told = case.replace(storeys={"coupling": coupling} | link, bending=bending)
        lines = told.kernel.warnings()
        assert len(lines) == bool(texts), lines
        assert all(text in lines[0] for text in texts)


def test_a_sweep_tells_of_the_rigid_wall() -> None:
    case = rwmf.Case(**BUILDING)
    for quantity, n in (("storey_drift_max", 0), ("wall_moment_max", 1)):
        found = rwmf.sweep(case, {"T_s": [0.4, 0.8]}, quantities=(quantity,))
        assert found.attrs["warnings"].count(RIGID) == n, quantity


def test_what_holds_is_shown(command: Runner, tmp_path: Path) -> None:
    """The height of the frame is 2h, and does not apply to storeys."""
    case = coupled(p_delta={"m_g_over_m_s": 1.0})
    case.to_namelist(tmp_path / "leans.nml")
    assert case.p_delta.h_f == 2 * case.wall.h
    shown = json.loads(command("check", "leans.nml", "--json").stdout)["values"]["p_delta"]["h_f"]
    assert shown["value"] == 2 * case.wall.h
    assert shown["origin"] == "default"
    same = case.replace(p_delta={"h_f": 2 * case.wall.h})
    assert float(rwmf.simulate(same).u_s_max) == float(rwmf.simulate(case).u_s_max)
    assert "h_f" not in rwmf.Case(**BUILDING).replace(p_delta={"m_g": 9e5}).p_delta


def test_shown_defaults_hold() -> None:
    """A case that gives every number that is shown is the same case."""
    for path in INPUTS:
        case = rwmf.Case.from_namelist(path)
        changes: dict[str, dict[str, object]] = {}
        for group, values in case.groups.items():
            for key in values:
                if key not in values.given and isinstance(values[key], (float, bool)):
                    changes.setdefault(group, {})[key] = values[key]
        for group, keys in changes.items():
            for key, value in keys.items():
                try:
                    told = case.replace(**{group: {key: value}})
                except rwmf.InputError:
                    continue  # a default that other keys exclude
                assert told.groups[group][key] == value, (path.name, group, key)


_RECORDS = {
    "peak of 5.1 g is outside the range of records, 1.0e-5 to 5.0 g: check the unit": (
        5.1,
        0.01,
        120,
    ),
    "peak of 9.0e-6 g is outside the range": (9e-6, 0.01, 120),
    "interval of 0.11 s exceeds 0.1 s: check dt": (0.3, 0.11, 120),
    "duration of 3610.0 s exceeds 3600.0 s: check dt": (0.3, 0.1, 36101),
    "": (4.9, 0.1, 36001),
}


@pytest.mark.parametrize("text", _RECORDS)
def test_a_record_that_is_no_earthquake(text: str, batch: Runner, tmp_path: Path) -> None:
    """By all ways that read it, horizontal and vertical."""
    peak, dt, n = _RECORDS[text]
    a = peak * np.sin(0.3 * np.arange(n)) ** 2
    a *= peak / abs(a).max()
    a[0] = a[-1] = 0
    (tmp_path / "a.txt").write_text("\n".join(map(repr, a.tolist())), encoding="utf-8")
    written = "unit = 'g', dt = " + repr(dt)
    case = coupled(motion=None).replace(solver={"t_end": 0.05})
    path = tmp_path / "case.nml"
    body = case.text + f"\n&motion kind = 'record', file = 'a.txt', {written} /\n"
    path.write_text(body, encoding="utf-8")
    from_file = rwmf.Case.from_namelist(path)
    from_array = case.replace(motion=rwmf.Motion(a, dt=dt, unit="g"))
    swept = rwmf.sweep(case, {"xi_s": [0.02]}, records=[tmp_path / "a.txt"], unit="g", dt=dt)
    found = [
        from_file.kernel.warnings(),
        from_array.kernel.warnings(),
        rwmf.simulate(from_file).attrs["warnings"].splitlines(),
        rwmf.spectrum(from_file, T_s=[0.5]).attrs["warnings"].splitlines(),
        swept.attrs["warnings"].splitlines(),
        batch("case.nml").stderr.splitlines(),
        rwmf.records.info(tmp_path / "a.txt", unit="g", dt=dt)[0]["warnings"],
    ]
    for lines in found:
        assert any(text and text in line for line in lines) == bool(text), lines
        unusual = [line for line in lines if "range of records" in line or "check dt" in line]
        assert bool(unusual) == bool(text)
    upward = tmp_path / "upward.nml"
    upward.write_text(
        coupled().replace(solver={"t_end": 0.05}).text
        + f"\n&vertical file = 'a.txt', {written} /\n", encoding="utf-8"
    )  # fmt: skip
    lines = rwmf.Case.from_namelist(upward).kernel.warnings()
    assert any(text and text in line for line in lines) == bool(text), lines


def test_no_warning_without_a_motion() -> None:
    """A scale of zero disables a record."""
    case = coupled(motion=None).replace(motion=rwmf.Motion([0.0, 9.0, 0.0], dt=0.01, unit="g"))
    assert any("range of records" in line for line in case.kernel.warnings())
    none = case.replace(motion={"scale": 0.0})
    assert not any("range of records" in line for line in none.kernel.warnings())


SLIDES = "slides at such impacts, which the model does not follow"


@pytest.mark.parametrize(
    ("changes", "slides"),
    [
        ({"wall": {"b": 1.0}}, True),
        ({"wall": {"b": 0.99}}, False),
        ({"wall": {"b": 1.4}}, True),
        # the mass of a frame keeps the loss small
        ({"wall": {"b": 1.0}, "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05}}, False),
        ({"wall": {"b": 1.0}, "impact": {"rule": None, "e": 0.79}}, True),
        ({"wall": {"b": 1.0}, "impact": {"rule": None, "e": 0.8}}, False),
        ({"wall": {"b": 1.0, "shear_key": True}}, False),
        ({"wall": {"b": 1.0, "base": "pinned"}, "impact": None}, False),
    ],
)
def test_squat_walls_slide_at_impacts(changes: dict[str, Any], slides: bool) -> None:
    case = block(impact={"rule": "coupled", "e": None}, solver={"t_end": 1.0}).replace(**changes)
    assert (SLIDES in rwmf.simulate(case).attrs["warnings"]) == slides


@pytest.mark.parametrize(
    ("k", "section", "is_soft"),
    [(9e8, {}, True), (1.1e9, {}, False), (None, {"length": 1e2}, False)],
)
def test_soft_soil_is_outside_the_model(
    k: float | None, section: dict[str, object], is_soft: bool
) -> None:
    given = section | ({"E": 3e10} if k is None else {"k": k})
    case = block(
        # m_w = 4 h b thickness density = 2e4 kg
        wall={"density": 2.5e4, "thickness": 0.2},
        impact={"rule": "coupled", "e": None},
        solver={"t_end": 1.0},
        base_section=given,
    )
    found = "below 1e4: the wall sinks into such soil" in rwmf.simulate(case).attrs["warnings"]
    assert found == is_soft
