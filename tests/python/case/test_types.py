"""Types of the public names in the eyes of a checker and of an editor."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Mapping
from keyword import iskeyword
from pathlib import Path

import pytest
import rwmf
from checkout import ROOT
from rwmf._library import schema
from scenes import coupled

SCRIPT = """\
import rwmf
from rwmf import loops, plot, studies

pulse = rwmf.Motion([0.0, 1.0, -1.0, 0.5] * 15, dt=0.02, unit="m/s2", name="pulse")
case = rwmf.Case(
    wall={"h": 2.0, "b": 0.5, "m_w": 9000.0},
    frame={"T_s": 0.8, "gamma": 5.0, "xi_s": 0.05},
    cable={"eta_0": 1.0, "eta_alpha": 5.0},
    motion=pulse,
    solver={"t_end": 2.0},
    output={"reactions": True},
)
height: float = 2 * case.wall.h
rule: str = case.model.formulation
heavier = case.replace(frame={"gamma": 2 * case.frame.gamma}).without("cable")
alone = case.without_wall()
history = rwmf.simulate(case, dt=0.01)
peak = float(history["u_s_max"]) / height
drift = float(history.roof_drift_max)
floors = history["floors_acceleration_max_g"].sel(floor=1)
spectra = rwmf.spectrum(case, T_s=[0.5, 1.0], quantities=("u_s_max", "friction_demand_max"))
found = rwmf.sweep(case, {"T_s": [0.5, 1.0], "eta": [(1.0, 5.0)]}, records=[pulse])
limit = float(rwmf.quantile(found, "u_s_max", 0.84).max())
ratio = float(studies.wall_effect(case, {"T_s": [0.5]})["ratio"].max())
panels = plot.history(history, case=case, color="k")
axes = plot.spectrum(spectra, bare=rwmf.spectrum(alone, T_s=[0.5, 1.0]))
springs = [loop.work for loop in loops.find_loops(history, case)]
curve = rwmf.pushover(case, 0.01, steps=2)
stripes = rwmf.stripes({"wall": case, "none": alone}, [pulse], [0.1, 0.4], "u_s_max")
met: bool = rwmf.checks(case.replace(limits={"u_s_max_m": 1.0}), history).is_met
slope = rwmf.gradient(case, ["frame.xi_s"], "u_s_max")
wall = rwmf.Wall(case)
wall.advance(0.1)
link: float = wall.forces.link
page = rwmf.explore(case) if link > 1e9 else None
keys: list[str] = [key for key in case.groups["wall"] if key in case.wall.given]
rwmf.plot.profile(rwmf.simulate("six.nml")) if peak > 1.0 else None
print(curve.sizes, stripes.sizes, met, slope, page.address if page else "")
print(history.headline(), rule, drift, limit, ratio, springs, keys, panels.size, float(floors))
"""
REVEALED = {
    "case.wall.h": "float",
    "case.storeys.m": "tuple[float, ...]",
    "case.solver.max_steps": "int",
    "case.output.energy": "bool",
    "case.motion.file": "str",
    "case.spectrum.quantities": "tuple[str, ...]",
    "case.wall.base": "Literal['rocking'] | Literal['pinned']",
    "case.without_wall()": "Case",
    "heavier": "Case",
    "history": "Response",
    'history["u_s_max"]': "DataArray",
    "history.storeys_drift_max": "DataArray",
    "history.isel(time=0)": "Response",
    "spectra": "Dataset",
    "rwmf.quantile(found)": "DataArray",
    "panels": "ndarray[tuple[int], dtype[object_]]",
    "axes": "Axes",
    "springs": "list[float]",
}


def _mypy(folder: Path, text: str) -> str:
    """Check a script with the packages of this interpreter, without a configuration."""
    pytest.importorskip("mypy")
    (folder / "script.py").write_text(text, encoding="utf-8")
    options = ["--strict", "--disallow-any-expr", "--config-file=", f"--cache-dir={folder}"]
    done = subprocess.run(
        [sys.executable, "-m", "mypy", *options, "script.py"],
        cwd=folder, env={"MYPYPATH": str(ROOT / "driver"), "PATH": ""},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    return done.stdout + done.stderr


@pytest.mark.slow
def test_a_users_script_passes_a_strict_checker(tmp_path: Path) -> None:
    """No expression has the type Any, a mistyped key is an error, and the script runs."""
    lines = [f"reveal_type({word})" for word in REVEALED]
    mistakes = ["case.wall.H0", "case.waal", "case.wall.h + case.motion.file"]
    printed = _mypy(tmp_path, SCRIPT + "\n".join([*lines, *mistakes]))
    first = SCRIPT.count("\n") + 1
    for place, (word, expected) in enumerate(REVEALED.items(), first):
        found = re.search(rf'^script.py:{place}: note: Revealed type is "(.*)"$', printed, re.M)
        assert found, printed
        assert re.sub(r"\b[a-z_]\w*\.(?=[\w.])", "", found[1]) == expected, word
    errors = re.findall(r"^script.py:(\d+): error", printed, re.M)
    assert {int(line) for line in errors} == {
        first + len(REVEALED) + i for i in range(len(mistakes))
    }, printed
    names = {"__name__": "script"}
    exec(compile(SCRIPT, "script.py", "exec"), names)


def test_declared_keys_are_those_of_the_kernel() -> None:
    """`tools/docs --made` makes the declarations; every value of a case has its declared type."""
    types = {"float": float, "int": int, "bool": bool, "str": str}
    declared = rwmf.case.groups.TYPES
    assert list(declared) == list(dict.fromkeys(row.group for row in schema()))
    for row in schema():
        annotations = declared[row.group].__annotations__
        assert (row.key in annotations) != iskeyword(row.key), row
    for name, group in coupled().groups.items():
        assert type(group) is declared[name]
        for key, value in group.items():
            kind = declared[name].__annotations__[key].split("[")[0]
            assert isinstance(value, types.get(kind, str if kind == "Literal" else tuple)), key


def test_names_for_completion() -> None:
    case = coupled()
    assert {*case.groups} <= {*dir(case)}
    assert "storeys" not in dir(case)
    assert {*case.wall} <= {*dir(case.wall)}
    assert "m_w" not in dir(case.wall)
    assert case.storeys is None
    assert isinstance(case.wall, Mapping)
    assert all(hasattr(case, name) for name in dir(case))
    assert all(hasattr(case.wall, name) for name in dir(case.wall))


def test_an_editor_completes_names() -> None:
    """Jedi, which completes in notebooks, knows groups and keys without running the script."""
    jedi = pytest.importorskip("jedi")
    begin = "import rwmf\ncase = rwmf.Case.from_text('')\n"

    def after(text: str) -> set[str]:
        return {found.name for found in jedi.Script(begin + text).complete()}

    assert set(rwmf.__all__) <= after("rwmf.")
    assert {*rwmf.case.groups.TYPES, "replace", "without_wall"} <= after("case.")
    assert {"h", "b", "m_w", "given"} <= after("case.replace(frame={}).wall.")
    assert {"advance", "state"} <= after("rwmf.Wall(case).")
    (kind,) = jedi.Script(begin + "case.wall.h").infer()
    assert kind.name == "float"


def test_a_table_in_a_notebook() -> None:
    """It shows every key with its value, unit and meaning; text of the user is escaped."""
    case = coupled(motion=rwmf.Motion([0.0, 1.0], dt=0.1, unit="g", name="<b>&"))
    page = case._repr_html_()
    for name, group in case.groups.items():
        assert f">&amp;{name}</td>" in page
        for key in group:
            assert f">{key}</td>" in page
        assert group._html_rows() in page
    assert "<b>" not in page
    assert "half height of the wall" in page
    assert page.count("<tr") == page.count("</tr>") == sum(map(len, case.groups.values()))
