"""Cases as scripts for OpenSeesPy: the text by itself, errors by group, and runs of the scripts.

The runs need openseespy, or the environment variable RWMF_OPENSEES: a Python that has it.
"""

from __future__ import annotations

import importlib.util
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf.cli import main
from rwmf.errors import InputError
from rwmf.export.opensees import opensees_script
from rwmf.export.opensees_run import compare_with_opensees, run_opensees

WALL = "&wall h = 5.0, b = 1.2, m_w = 40e3 / &impact rule = 'coupled' /"
FRAME = "&frame T_s = 0.8, gamma = 3.0, xi_s = 0.04 /"
CABLE = "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss' /"
TENDON = "&cable eta_0 = 0.8, eta_alpha = 5.0, {} /"
MOTION = "&motion kind = 'one_sine', a_max_g = 0.7, T_p = 0.8 / &solver t_end = 1.2 /"
PINCHED = (
    "&yielding storey_u_y = 0.012, law = 'pinched', hardening = 0.03, cap = 5.0, post_cap = 8.0, "
    "residual = 0.1, lambda = 60.0, pinch_force = 0.4, pinch_displacement = 0.5 /"
)


SPRINGS = (
    "&frame xi_s = 0.03 / &storeys n = 4, m = 25e3, k = 25e6, height = 2.5, coupling = 'springs', "
    "k_link = 3e7, 2e7, 2e7, 1e7 /"
)


def storeys(n: int, coupling: str) -> str:
    return (
        f"&frame xi_s = 0.03 / &storeys n = {n}, m = 25e3, k = 25e6, height = {10.0 / n}, "
        f"coupling = '{coupling}', distribution = 'linear' /"
    )


CASES = {
    "a frame": "&frame T_s = 0.8, xi_s = 0.04, m_s = 1e5 /",
    "storeys": storeys(3, "full"),
    "storeys that pinch": storeys(4, "full") + PINCHED + "&p_delta m_g = 150e3 /",
    "a wall": WALL,
    "tendon": WALL + FRAME + CABLE,
    "Eq. (1)": WALL + FRAME + TENDON.format("law = 'linear'"),
    "a tendon that yields": WALL + FRAME + TENDON.format("law = 'truss', eta_y = 1.1"),
    "a tendon that breaks": WALL + FRAME + TENDON.format("law = 'truss', rupture_strain = 0.006"),
    "link": WALL + FRAME + CABLE + "&link L = 12.0 /",
    "fuses": WALL + FRAME + CABLE + "&fuse F_y = 40e3, k = 2e7, hardening = 0.02 /",
    "damper": WALL + FRAME + CABLE + "&damper c = 4e4 /",
    "damper by a power": WALL + FRAME + CABLE + "&nl_damper F_1 = 3e4, exponent = 0.5 /",
    "vertical": WALL + FRAME + CABLE + "&vertical ratio = 0.5 /",
    "flag": WALL + FRAME + "&yielding u_y = 0.03, hardening = 0.05, law = 'flag' /",
    "first mode": WALL + storeys(3, "reduced") + CABLE + "&p_delta m_g = 90e3 /",
    "roof": WALL + storeys(4, "full") + CABLE + PINCHED,
    "every floor": WALL + storeys(9, "every_floor") + CABLE,
    "springs": WALL + SPRINGS + CABLE,
    "hinge": "&wall h = 5.0, b = 1.2, m_w = 40e3, base = 'pinned' /" + FRAME,
}


def case_of(text: str) -> rwmf.Case:
    more = "" if "&motion" in text else MOTION
    return rwmf.Case.from_text(text + more + "&model formulation = 'exact' /")


def calls(script: str, name: str) -> list[list[str]]:
    """Return the arguments of all calls of a command."""
    return [x.split(", ") for x in re.findall(rf"^ops\.{name}\((.*)\)$", script, re.MULTILINE)]


@pytest.mark.parametrize("name", CASES)
def test_script_has_the_masses_and_the_motion(name: str) -> None:
    case = case_of(CASES[name])
    script = opensees_script(case)
    compile(script, name, "exec")
    masses = sum(float(words[1]) for words in calls(script, "mass"))
    expected = 0.0 if case.wall is None else 40e3
    if case.storeys is not None:
        n = len(case.storeys.m_over_m_w)
        expected += n * 25e3 if case.storeys.coupling != "reduced" else 0.0
    elif case.frame is not None:
        expected += 3 * 40e3 if case.wall is not None else 1e5
    if name != "first mode":
        assert masses == pytest.approx(expected, rel=1e-8)
    names: dict[str, object] = {}
    exec(script[script.index("A = [") : script.index("# model")], {}, names)
    a = np.array(names["A"])
    assert np.abs(a).max() == pytest.approx(0.7 * 9.81, rel=1e-6)


@pytest.mark.parametrize(
    ("group", "text"),
    [
        ("inerter", WALL + FRAME + "&inerter inertance = 1e4 /"),
        ("yielding", WALL + FRAME + "&yielding u_y = 0.03, law = 'friction' /"),
        ("yielding", "&frame T_s = 1.0, xi_s = 0.05 / &yielding u_y = 0.03, law = 'bouc_wen' /"),
        ("fuse", WALL + FRAME + "&fuse F_y = 4e4, k = 2e7, law = 'friction' /"),
        ("impact", "&wall h = 5.0, b = 1.2 / &impact e = 0.9 /"),
        ("bending", WALL + FRAME + "&bending EI_over_m_w = 1e5 /"),
        ("initial", WALL + FRAME + "&initial theta_over_alpha = 0.2 /"),
    ],
)
def test_error_names_the_group(group: str, text: str) -> None:
    with pytest.raises(InputError, match=rf"&{group}: OpenSees lacks "):
        opensees_script(case_of(text))


def test_samples_of_a_record_are_those_of_the_file() -> None:
    rng = np.random.default_rng(4)
    values = rng.standard_normal(80)
    motion = rwmf.Motion(values, dt=0.02, unit="m/s2", name="random")
    case = case_of(CASES["a frame"]).replace(motion=motion, solver={"t_end": 1.58})
    names: dict[str, object] = {}
    script = opensees_script(case)
    exec(script[script.index("G = ") : script.index("# model")], {}, names)
    assert names["INTERVAL"] == pytest.approx(0.02)
    np.testing.assert_allclose(np.array(names["A"])[:79], values[:79], rtol=1e-8)


def test_command_writes_the_script(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, script = tmp_path / "case.nml", tmp_path / "case.py"
    file.write_text("\n".join(x + " /" for x in case_text(CASES["storeys"])), encoding="utf-8")
    assert main(["export", "opensees", str(file), str(script)]) == 0
    assert str(script) in capsys.readouterr().out
    compile(script.read_text(encoding="utf-8"), "case.py", "exec")


def case_text(text: str) -> list[str]:
    """Return the groups of a case, one per line."""
    whole = text + MOTION + "&model formulation = 'exact' /"
    return ["&" + x.rstrip().removesuffix("/") for x in whole.split("&")[1:]]


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_demands_of_opensees(name: str, tmp_path: Path) -> None:
    if not os.environ.get("RWMF_OPENSEES") and not importlib.util.find_spec("openseespy"):
        pytest.skip("no OpenSees: RWMF_OPENSEES names no Python that has openseespy")
    case = case_of(CASES[name])
    script = tmp_path / "script.py"
    script.write_text(opensees_script(case), encoding="utf-8")
    found = compare_with_opensees(case, run_opensees(script))
    assert found
    for demand in found:
        bound = 5e-3
        if demand.name.startswith("impact"):
            bound = 5e-4
        elif "acceleration" in demand.name:
            # the link rings when the tendon breaks
            bound = math.inf if name == "a tendon that breaks" else 2e-2
        assert abs(demand.difference) < bound, demand


def test_no_openseespy_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RWMF_OPENSEES", raising=False)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="pip install openseespy"):
        run_opensees("script.py")
