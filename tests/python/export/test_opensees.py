"""Cases as scripts for OpenSeesPy: the text by itself, errors by group, and runs of the scripts.

The runs need openseespy, or the environment variable RWMF_OPENSEES: a Python that has it.
"""

import csv
import importlib.util
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from exported_scenes import ALONE, CASES, FRAME, MOTION, WALL, case_of
from rwmf.cli import main
from rwmf.errors import InputError
from rwmf.hosts.opensees_script import compare_with_opensees, opensees_script, run_opensees

# walls that bend, and the number of floors that are linked to their axis
BENT_WALLS = {
    "a wall that bends": 0,
    "roof of a wall that bends": 0,
    "every floor of a wall that bends": 3,
    "springs of a wall that bends": 4,
}
# a landing shakes floors with rigid links to a wall that bends: largest difference of accelerations
SHAKEN = {
    "a wall that bends": 1e-2,
    "roof of a wall that bends": 2.5e-2,
    "every floor of a wall that bends": 1e-1,
}


def calls(script: str, name: str) -> list[list[str]]:
    """Return the arguments of all calls of a command."""
    return [x.split(", ") for x in re.findall(rf"^ops\.{name}\((.*)\)$", script, re.MULTILINE)]


@pytest.mark.parametrize("name", ALONE)
def test_script_has_the_masses_and_the_motion(name: str) -> None:
    case = case_of(CASES[name])
    script = opensees_script(case)
    compile(script, name, "exec")
    masses = sum(float(words[1]) for words in calls(script, "mass"))
    expected = 0.0 if case.wall is None else 40e3 * case.wall.walls
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
        ("bending", WALL + FRAME + "&bending EI = 4e9 /"),
        ("initial", WALL + FRAME + "&initial theta_over_alpha = 0.2 /"),
    ],
)
def test_error_names_the_group(group: str, text: str) -> None:
    with pytest.raises(InputError, match=rf"&{group}: OpenSees lacks "):
        opensees_script(case_of(text))


def test_walls_side_by_side() -> None:
    """Corners, tendons and beams of three walls; the arms of a coupling meet in the gap."""
    script = opensees_script(case_of(CASES["three walls and beams"]))
    nodes = {int(x[0]): (float(x[1]), float(x[2])) for x in calls(script, "node")}
    assert [nodes[1000 * i + 1][0] for i in range(3)] == pytest.approx([0.0, 3.9, 7.8])
    elements = calls(script, "element")
    tendons = [x for x in elements if x[0] == '"corotTruss"' and int(x[2]) % 1000 == 11]
    assert [int(x[3]) for x in tendons] == [5, 1005, 2005]
    arms = [x[2:4] for x in elements if x[0] == '"zeroLength"' and int(x[2]) % 1000 == 8]
    # a spring and a dashpot in each gap
    assert arms == [["8", "1009"]] * 2 + [["1008", "2009"]] * 2
    assert nodes[8] == pytest.approx(nodes[1009]) and nodes[8] == pytest.approx((1.95, 5.0))


def test_elements_off_the_axis() -> None:
    """Each element between a fixed node and a node of the wall at its place."""
    script = opensees_script(case_of(CASES["elements off the axis"]))
    nodes = {int(x[0]): (float(x[1]), float(x[2])) for x in calls(script, "node")}
    fixed = {int(x[0]) for x in calls(script, "fix") if x[1:] == ["1", "1", "1"]}
    elements = calls(script, "element")
    tendons = [x for x in elements if x[0] == '"corotTruss"' and int(x[2]) in fixed]
    ends = [(nodes[int(x[2])], nodes[int(x[3])]) for x in tendons]
    assert ends == [((-0.7, 0.0), (-0.7, 10.0)), ((0.4, 0.0), (0.4, 8.0))]
    springs = [x for x in elements if x[0] == '"zeroLength"' and x[-2:] == ['"-dir"', "2"]]
    places = [nodes[int(x[3])] for x in springs if int(x[2]) in fixed]
    # a spring, and a dashpot beside the last restraint
    expected = [(-1.6, 0.0), (0.5, 0.0), (0.3, 0.0), (-1.2, 5.0), (3.0, 10.0), (3.0, 10.0)]
    assert places == expected
    assert all(nodes[int(x[2])] == nodes[int(x[3])] for x in springs if int(x[2]) in fixed)


@pytest.mark.parametrize(("name", "floors"), BENT_WALLS.items())
def test_wall_that_bends_is_a_chain_of_beams(name: str, floors: int) -> None:
    """Flexibility of the chain, by the positions and sections in the text of the script."""
    case = case_of(CASES[name])
    script = opensees_script(case)
    nodes = {int(x[0]): float(x[2]) for x in calls(script, "node")}
    beams = [x for x in calls(script, "element") if '"-damp"' in x and "Beam" in x[0]]
    ends = [(int(x[2]), int(x[3])) for x in beams]
    assert [a for a, _ in ends[1:]] == [b for _, b in ends[:-1]], "a chain"
    assert (ends[0][0], ends[-1][1]) == (1, 5)
    assert nodes[1] == 0.0 and nodes[5] == 10.0
    masses = {int(x[0]): float(x[1]) for x in calls(script, "mass")}
    masses = {node: mass for node, mass in masses.items() if not 100 < node < 300}
    assert sum(masses.values()) == pytest.approx(40e3, rel=1e-8)
    moment = sum(m * nodes[node] for node, m in masses.items())
    assert moment == pytest.approx(40e3 * 5.0, rel=1e-8)
    if case.bending.get("nu") is None:
        assert {float(x[6]) for x in beams} == {4e9}
    else:
        (_, _, modulus, area, inertia, shear, share), *_ = calls(script, "section")
        assert float(modulus) * float(inertia) == 4e9
        # kappa = 5/6, and G A from E I of the full section of width 2 b
        gross = 4e9 * 12 / 2.4**2 / (2 * 1.2)
        assert float(shear) * float(share) * float(area) == pytest.approx(5 / 6 * gross, rel=1e-8)
    linked = [int(x[0]) for x in calls(script, "equalDOF")]
    springs = [x for x in calls(script, "element") if x[0] == '"zeroLength"']
    linked += [int(x[2]) for x in springs if int(x[3]) > 100]
    heights = [nodes[node] for node in linked]
    assert heights == pytest.approx([10.0 * (i + 1) / floors for i in range(floors)])


def test_damping_of_a_wall_that_bends_has_the_frequency_of_the_cantilever() -> None:
    """The first mode of a cantilever: 1.8751 squared, over the square of its height."""
    text = CASES["a wall that bends"]
    omega = 1.8751040687**2 * math.sqrt(4e9 / 40e3 / 10.0**3)
    ((_, _, beta),) = calls(opensees_script(case_of(text)), "damping")
    assert float(beta) == pytest.approx(2 * 0.02 / omega, rel=1e-4)


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
    assert main(["export", str(file), "--out", str(script)]) == 0
    assert str(script) in capsys.readouterr().out
    compile(script.read_text(encoding="utf-8"), "case.py", "exec")


def case_text(text: str) -> list[str]:
    """Return the groups of a case, one per line."""
    whole = text + MOTION + "&model formulation = 'exact' /"
    return ["&" + x.rstrip().removesuffix("/") for x in whole.split("&")[1:]]


@pytest.mark.slow
@pytest.mark.parametrize("name", ALONE)
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
        elif name in BENT_WALLS and "tip" in demand.name:
            bound = 6e-2
        elif name in SHAKEN and "acceleration" in demand.name:
            bound = SHAKEN[name]
        assert abs(demand.difference) < bound, demand


def test_no_openseespy_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RWMF_OPENSEES", raising=False)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match="pip install openseespy"):
        run_opensees("script.py")


def test_the_stored_comparison_with_opensees() -> None:
    """Rows of ``bench/opensees_export.py``, which the page repeats."""
    path = ROOT / "validation" / "opensees" / "export.csv"
    page = (ROOT / "docs" / "howto" / "opensees.md").read_text(encoding="utf-8")
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    names = [row["case"] for row in rows]
    assert names == list(CASES)
    for row in rows:
        assert (row["drift_percent"] == "nan") == (row["case"] == "a wall")
        assert not float(row["drift_percent"]) >= 0.5
        assert not float(row["acceleration_percent"]) >= 1e2 * SHAKEN.get(row["case"], 1e-2)
        assert float(row["impact_ms"]) < 0.5 or row["impacts"] == "0"
        # 2 ms after each contact, with a mast 6 ms
        assert float(row["left_out_ms"]) <= 6.0 * int(row["contacts"])
        assert f"| {row['case']} | " in page
        if row["impacts"] != "0":
            cell = f"{float(row['impact_ms']):.2g} ({row['impacts']}) |"
            assert cell in next(line for line in page.splitlines() if f"| {row['case']} |" in line)
