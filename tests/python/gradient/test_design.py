"""Designs: cheapest of all, whole numbers, missed targets, records left out, the page."""

import json
from pathlib import Path

import numpy as np
import pytest
import rwmf
from refused import refusals
from rwmf.assess.design import Target
from rwmf.cli import main
from scenes import bare_frame, coupled

_T = np.arange(0, 8, 0.02)
RECORDS = [
    rwmf.Motion(
        a * np.sin(_T * w + i) * np.exp(-(((_T - 3) / 2) ** 2)), dt=0.02, unit="m/s2", name=f"w{i}"
    )
    for i, (a, w) in enumerate([(3, 4), (4, 5), (3.5, 6), (5, 7), (3, 3), (4, 8), (2.5, 5.5)])
]
TARGET = {"quantity": "u_s_max", "limit": 0.2, "percentile": 84}
BOUNDS = {"eta_0": (0.0, 3.0), "xi_s": (0.02, 0.2)}


def test_frame_with_a_known_answer() -> None:
    """The peak of a linear frame is in proportion to the pulse: the bound is where it is met."""
    case = bare_frame(motion={"a_max_g": 0.1}, solver={"t_end": 4.0})
    peak = rwmf.sweep(case)["u_s_max"].item()
    target = {"quantity": "u_s_max", "limit": 2.5 * peak, "percentile": 100}
    found = rwmf.design(case, {"a_max_g": (0.05, 0.5)}, [target], {"a_max_g": -1.0}, designs=48)
    assert found.is_feasible
    assert found.values["a_max_g"] == pytest.approx(0.25, rel=1e-3)
    assert found.left_out == ()
    assert np.isnan([found.checks[0].value_left_out, found.checks[0].utilisation_left_out]).all()
    assert found.case.motion.a_max_g == found.values["a_max_g"]


def test_a_smallest_demand_without_runs_has_no_utilisation() -> None:
    target = Target("contact_length_min", 0.3, 0.84, 1.0, is_least=True)
    assert [target.utilisation(x) for x in (0.6, 0.0)] == [0.5, np.inf]
    assert np.isnan(target.utilisation(np.nan))


def test_cheaper_than_designs_at_random() -> None:
    cost = {"eta_0": 1.0, "xi_s": 20.0}
    found = rwmf.design(coupled(), BOUNDS, [TARGET], cost, RECORDS, left_out=(), designs=120)
    assert found.is_feasible
    random = np.random.default_rng(3)
    table = {name: random.uniform(*ends, 300) for name, ends in BOUNDS.items()}
    swept = rwmf.sweep(coupled(), points=table, records=RECORDS)
    meets = rwmf.quantile(swept, "u_s_max", 0.84).values <= 0.2
    assert 0 < meets.sum() < 300
    assert found.cost < (table["eta_0"] + 20 * table["xi_s"])[meets].min()
    again = rwmf.sweep(found.case, records=RECORDS)
    value = rwmf.quantile(again, "u_s_max", 0.84).item()
    assert value == pytest.approx(found.checks[0].value, rel=1e-9)
    assert value <= 0.2


def test_missed_targets_and_records_left_out() -> None:
    targets = [TARGET, {"quantity": "u_s_max", "limit": 0.01, "probability": 0.5}]
    targets.append({"quantity": "collapse", "probability": 0.2, "scale": 1.5})
    found = rwmf.design(coupled(), BOUNDS, targets, lambda x: x["eta_0"], RECORDS, designs=32)
    assert not found.is_feasible
    assert found.left_out == ("w3",)
    assert [line.partition(",")[0] for line in found.warnings] == [
        "e = 0.9 is below e_max = 0.9942"
    ]
    assert found.to_dict()["warnings"] == list(found.warnings)
    assert len(found.records) == len(RECORDS) - 1
    missed = [check for check in found.checks if not check.is_met]
    assert len(missed) == len(found.missed) > 0
    assert any("0.01 in 50 %" in text and "% of the limit" in text for text in found.missed)
    assert found.checks[1].utilisation == pytest.approx(found.checks[1].value / 0.01)
    assert found.checks[2].is_met


def test_nearest_design_to_a_target_far_away() -> None:
    """More damping is nearer, however far; an end by overturning is named."""
    target = TARGET | {"limit": 1e-4}
    damping = {"xi_s": (0.02, 0.2)}
    found = rwmf.design(coupled(), damping, [target], {"xi_s": 1.0}, RECORDS[:1], designs=16)
    assert found.values == {"xi_s": 0.2}
    assert found.checks[0].utilisation > 100
    fallen = coupled(model={"overturning_angle": 1e-6})
    found = rwmf.design(fallen, damping, [TARGET], {"xi_s": 1.0}, RECORDS[:1], designs=16)
    assert "too many motions end in collapse" in found.missed[0]
    none = {"quantity": "collapse", "probability": 0.1}
    found = rwmf.design(fallen, damping, [none], {"xi_s": 1.0}, RECORDS[:1], designs=16)
    assert "100.0 % collapse, more than 10 %" in found.missed[0]


def test_key_of_several_groups_means_that_of_the_case() -> None:
    case = coupled(fuse={"eta_y": 0.2, "stroke_y": 0.004})
    bounds = {"eta_y": (0.1, 0.3)}
    found = rwmf.design(case, bounds, [TARGET], {"eta_y": 1.0}, RECORDS[:1], designs=16)
    assert found.case.fuse.eta_y == found.values["eta_y"]


def test_whole_numbers() -> None:
    path = Path(__file__).parents[3] / "inputs" / "six_storeys_by_dimensions.nml"
    case = rwmf.Case.from_namelist(path).replace(solver={"t_end": 2.0})
    table = {"strands": np.arange(4, 41)}
    peaks = rwmf.sweep(case, points=table, quantities=("u_s_max",))["u_s_max"].values
    limit = float(np.sort(peaks)[len(peaks) // 2])
    target = {"quantity": "u_s_max", "limit": limit, "percentile": 100}
    found = rwmf.design(case, {"strands": (4, 40)}, [target], {"strands": 1.0}, designs=64)
    assert found.values == {"strands": int(table["strands"][peaks <= limit].min())}
    assert found.case.cable.strands == found.values["strands"]


USUAL = {
    "bounds": {"eta_0": (0.0, 1.0)}, "targets": [TARGET], "cost": {"eta_0": 1.0},
    "records": RECORDS,
}  # fmt: skip
test_refused_arguments = refusals(
    lambda changes: rwmf.design(coupled(), **(USUAL | changes)),
    ({"bounds": {"rule": (0, 1)}}, "design chooses numbers"),
    ({"bounds": {"eta_0": (1.0, 0.0)}}, "increasing"),
    ({"bounds": {"eta_0": (1.0,)}}, "low, high"),
    ({"bounds": {}}, "keys with"),
    ({"bounds": {"rtol": (1e-9, 1e-6)}}, "setting of the solver"),
    ({"bounds": {"scale": (1.0, 2.0)}}, "which targets have"),
    ({"bounds": {"a_max_g": (0.1, 0.2)}}, "records replace"),
    ({"bounds": {"T_s": (0.5, 1.0), "frame.T_s": (0.5, 1.0)}}, "same number"),
    ({"bounds": {"eta": (0.0, 1.0)}}, "give cable.eta_0 and cable.eta_alpha"),
    ({"bounds": {"b": (0.0, 1.0)}}, "lower ends: &wall: b = 0"),
    ({"bounds": {"e": (0.5, 1.5)}}, "upper ends: &impact: e = 1.5"),
    ({"targets": [TARGET | {"quantity": "storey_drift_max"}]}, "no such result"),
    ({"targets": [{"quantity": "collapse", "percentile": 9}]}, "a probability only"),
    ({"cost": {}}, "no weights; known: eta_0"),
    ({"targets": [{"quantity": "u_s_max", "limit": 0.1}]}, "one of percentile and prob"),
    ({"targets": [TARGET | {"top": 1}]}, "top: unknown"),
    ({"targets": [TARGET | {"percentile": 101}]}, "percentile in"),
    ({"targets": []}, "none is given"),
    ({"targets": ["u_s_max"]}, "must be mappings"),
    ({"cost": {"T_s": 1.0}}, "T_s: has no bounds"),
    ({"cost": 3.0}, "weights by key"),
    ({"left_out": RECORDS[:1]}, "records of the suite"),
    ({"guess": {"T_s": 1.0}}, "keys of bounds"),
)


def test_command_and_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.nml"
    coupled(solver={"t_end": 4.0}).to_namelist(path)
    words = ["design", str(path), "--vary", "xi_s=0.02:0.2", "--target", "u_s_max=0.2@100"]
    words += ["--cost", "xi_s=1", "--designs", "16", "--out", str(tmp_path / "design.nml")]
    pages = [tmp_path / "design.html", tmp_path / "design.pdf"]
    found = {}
    for page in pages:
        assert main([*words, "--out", str(page), "--json"]) == 0
        found = json.loads(capsys.readouterr().out)
    assert found["is_feasible"]
    assert pages[1].read_bytes().startswith(b"%PDF")
    text = pages[0].read_text(encoding="utf-8")
    for part in ("<svg", "&amp;frame", "rwmf design", "u_s_max &lt;= 0.2", "No record was left"):
        assert part in text
    design = rwmf.Case.from_namelist(tmp_path / "design.nml")
    assert design.frame.xi_s == found["values"]["xi_s"]
    assert main([*words[:4], "--target", "u_s_max=0.2", "--cost", "xi_s=1"]) == 2
    assert "PERCENTILE" in capsys.readouterr().err
