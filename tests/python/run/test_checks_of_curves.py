"""Limits along a static curve: table, drifts at limits, marks, every interface and error."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
import scenes
from refused import refusals
from rwmf import cli, plot
from rwmf.run.response import columns_by_key
from scenes import WEIGHT, bare_frame, coupled, retrofit

LIMITS: dict[str, Any] = scenes.LIMITS | {
    "u_s_max_m": 0.2,
    "theta_max_over_alpha": 0.05,
    "roof_drift_max": 0.02,
    "wall_drift_max": 0.01,
    "frame_drift_max": 0.01,
    "base_shear_max_N": 1e6,
    "overturning_moment_max_N_m": 2e7,
    "tendon_force_max_N": 2.5e6,
    "cable_force_increment_max_N": 1e6,
    "tendon_strain_max": 0.006,
    "wall_shear_mid_max_N": 1e6,
    "wall_moments_above_max_N_m": 5e6,
}


def _retrofit(coupling: str = "every_floor", **changes: dict[str, Any] | None) -> rwmf.Case:
    return retrofit(coupling, limits=LIMITS, solver={"t_end": 1.0}).replace(**changes)


@pytest.mark.parametrize("coupling", ["full", "every_floor", "springs"])
@pytest.mark.parametrize("bending", [None, {"E": 3e10, "modes": 2}])
def test_demands_by_statics(coupling: str, bending: dict[str, Any] | None) -> None:
    """Links, sections, base and tendon from equilibrium and geometry; absent without statics."""
    case = _retrofit(coupling, bending=bending)
    curve = rwmf.pushover(case, (0.01, -0.004), steps=20)
    found = rwmf.checks(case, curve)
    assert found.absent == ("floor_acceleration_max_g",)
    demand = {row.key: row.demand for row in found.rows}
    columns = columns_by_key(curve)
    theta = columns["theta_rad"]
    phi = np.abs(theta).max()
    assert demand["fuse_stroke_max_m"] == pytest.approx(8.0 * math.sin(phi / 2), rel=1e-13)
    length = math.sqrt(4 * 9.6**2 + 8 * (1 - math.cos(phi)) + 4 * 9.6 * 2 * math.sin(phi))
    strain = 6e8 / 1.95e11 + (length - 19.2) / 19.2
    assert demand["tendon_strain_max"] == pytest.approx(strain, rel=1e-12)
    assert demand["tendon_stress_max_Pa"] == pytest.approx(1.95e11 * strain, rel=1e-12)
    area = 20 * 1.4e-4
    assert demand["tendon_force_max_N"] == pytest.approx(area * 1.95e11 * strain, rel=1e-12)
    assert demand["cable_force_increment_max_N"] == pytest.approx(
        area * (1.95e11 * strain - 6e8), rel=1e-11
    )
    section = rwmf.sections.base_section(
        columns["pivot_normal_over_m_w_g"] * WEIGHT, theta, width=4.0, thickness=0.35, k=1e10
    )
    stress = section.toe_stress.values.max()
    assert demand["toe_stress_max_Pa"] == pytest.approx(stress, rel=1e-12)
    assert demand["toe_strain_max"] == demand["toe_stress_max_Pa"] / 3e10
    assert demand["contact_length_min_m"] == pytest.approx(section.contact_length.values.min())
    slip = np.abs(columns["pivot_horizontal_over_m_w_g"]) / columns["pivot_normal_over_m_w_g"]
    assert demand["friction_demand_max"] == pytest.approx(slip.max(), rel=1e-15)
    assert demand["roof_drift_max"] == pytest.approx(0.01, rel=1e-15)
    # with links that stretch, the displacement of a run is that of the wall
    moved = np.abs(columns["roof_displacement_m"])
    if coupling == "springs":
        moved -= np.abs(columns["link_6_force_N"]) / 1e8
    assert demand["u_s_max_m"] == pytest.approx(moved.max(), rel=1e-9)
    assert demand["frame_drift_max"] == pytest.approx(moved.max() / 19.2, rel=1e-9)
    links = [key for key in columns if key.startswith("link_") and key.endswith("_N")]
    assert len(links) == (1 if coupling == "full" else 6)
    assert demand["link_6_force_max_N"] == np.abs(columns["link_6_force_N"]).max()
    # the shear of the wall changes by the link of the floor; signs are lost
    for i in range(1, 6):
        below, above = (columns[f"wall_shear_{i}{side}_N"] for side in ("", "_above"))
        push = np.abs(columns.get(f"link_{i}_force_N", 0.0 * theta) * np.cos(theta))
        error = np.minimum(np.abs(np.abs(below - above) - push), np.abs(below + above - push))
        assert error.max() < 1e-9 * below.max(), i
    assert np.all(columns["wall_moment_6_above_N_m"] == 0.0)
    assert columns["wall_moment_6_N_m"].max() < 0.2 * columns["wall_moment_1_N_m"].max()


def test_rows_are_the_largest_values_and_their_drifts() -> None:
    """A straight line reaches its limits at known drifts, on both sides of the protocol."""
    frame = bare_frame(
        p_delta={"h_f": 3.0, "m_g_over_m_s": 0.0},
        limits={"roof_drift_max": 0.004, "u_s_max_m": 0.024, "base_shear_max_over_weight": 10.0},
    )
    curve = rwmf.pushover(frame, (0.005, -0.01))
    drift, u, shear = (row for row in rwmf.checks(frame, curve).rows)
    by_key = {row.key: row for row in (drift, u, shear)}
    assert by_key["roof_drift_max"].demand == 0.01
    assert by_key["roof_drift_max"].drift_at_limit == pytest.approx(0.004, rel=1e-12)
    assert by_key["u_s_max_m"].drift_at_limit == pytest.approx(-0.008, rel=1e-12)
    assert math.isnan(by_key["base_shear_max_over_weight"].drift_at_limit or 0.0)
    marks = dict(zip(curve["mark"].values, curve["mark_roof_drift"].values, strict=True))
    assert marks == {
        "limit_roof_drift_max": by_key["roof_drift_max"].drift_at_limit,
        "limit_u_s_max_m": by_key["u_s_max_m"].drift_at_limit,
    }
    text = str(rwmf.checks(frame, curve))
    assert "reached at" in text
    assert "-0.8 %" in text


def test_a_curve_to_its_limit_meets_it() -> None:
    """Round-off of the roof is no exceedance."""
    for drift in (0.01, -0.013, 0.0217, 0.0371):
        case = coupled(limits={"roof_drift_max": abs(drift)})
        found = rwmf.checks(case, rwmf.pushover(case, drift))
        assert found.is_met, str(found)
        assert found.rows[0].ratio == pytest.approx(1.0, abs=1e-12)


def test_a_curve_that_ends_early_meets_no_limit() -> None:
    case = coupled(limits={"roof_drift_max": 1.0}, model={"overturning_angle": 0.01})
    found = rwmf.checks(case, rwmf.pushover(case, 0.04))
    assert found.rows[0].is_met
    assert not found.is_met
    assert "THE CURVE ENDS EARLY" in str(found)


def test_ratios_and_newtons_agree() -> None:
    unit = WEIGHT + 6 * 1.5e5 * 9.81
    limits = dict.fromkeys(LIMITS) | {
        "wall_shears_max_N": 0.3 * WEIGHT, "wall_shears_max_over_m_w_g": 0.3,
        "links_force_max_N": 0.3 * WEIGHT, "links_force_max_over_m_w_g": 0.3,
        "base_shear_max_N": 0.3 * unit, "base_shear_max_over_weight": 0.3,
        "storeys_shear_max_N": 0.3 * WEIGHT, "storeys_shear_max_over_m_w_g": 0.3,
    }  # fmt: skip
    case = _retrofit(limits=limits)
    rows = rwmf.checks(case, rwmf.pushover(case, 0.01, steps=10)).rows
    pairs = sorted(rows, key=lambda row: (row.number, row.key))
    assert len(pairs) == 2 * (3 * 6 + 1)
    for a, b in zip(pairs[::2], pairs[1::2], strict=True):
        assert a.ratio == pytest.approx(b.ratio, rel=1e-13), (a.key, b.key)


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Table, CSV, JSON and figures hold the rows of Python."""
    path, table, figure, drawn = (
        tmp_path / name for name in ("case.nml", "checks.csv", "checks.png", "curve.svg")
    )
    case = _retrofit()
    case.to_namelist(path)
    words = ["pushover", str(path), "--drifts", "0.01", "--steps", "20"]
    files = ["--checks", str(table), str(figure), "--out", str(drawn)]
    assert cli.main([*words, *files]) == 0
    out = capsys.readouterr().out
    assert "reached at" in out
    assert "no demand of a static curve: floor_acceleration_max_g" in out
    assert f"written: {table}" in out
    assert cli.main([*words, "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)["checks"]
    own = rwmf.checks(case, rwmf.pushover(case, 0.01, steps=20))
    assert shown["absent"] == ["floor_acceleration_max_g"]
    with table.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    for row, item, expected in zip(rows, shown["rows"], own.rows, strict=True):
        assert row["key"] == item["key"] == expected.key
        assert float(row["demand"]) == item["demand"] == expected.demand
        reached = item["drift_at_limit"]
        assert (math.nan if reached is None else reached) == pytest.approx(
            expected.drift_at_limit, rel=0, abs=0, nan_ok=True
        )
    assert figure.read_bytes()[:4] == b"\x89PNG"
    assert "limit of" in drawn.read_text(encoding="utf-8")
    assert cli.main([*words, "--all"]) == 0
    assert "wall_shear_3_max_N" in capsys.readouterr().out


def test_figure_has_one_mark_for_each_limit() -> None:
    case = _retrofit()
    ax = plot.pushover(rwmf.pushover(case, 0.02, steps=20))
    labels = [text for text in ax.get_legend_handles_labels()[1] if "limit of" in text]
    assert len(labels) == len({label.split(",")[0] for label in labels})
    assert sum("wall_shear" in label for label in labels) <= 2


def test_errors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    plain = coupled()
    with pytest.raises(rwmf.InputError, match="&limits: is missing or empty"):
        rwmf.checks(plain, rwmf.pushover(plain, 0.01))
    case = coupled(limits={"floor_acceleration_max_g": 1.0})
    with pytest.raises(rwmf.InputError, match="a static curve has none of the demands: floor_acc"):
        rwmf.checks(case, rwmf.pushover(case, 0.01))
    path = tmp_path / "case.nml"
    plain.to_namelist(path)
    assert cli.main(["pushover", str(path), "--checks", str(tmp_path / "c.csv")]) == 2
    assert "--checks: the case has no &limits" in capsys.readouterr().err
    case.to_namelist(path)
    assert cli.main(["pushover", str(path)]) == 0, "a curve is no check of accelerations"
    assert "a static curve has none of the demands" in capsys.readouterr().err


test_a_demand_that_cannot_exist_is_refused = refusals(
    lambda limits, changes: coupled(limits=limits, **changes),
    ({"tendon_stress_max_Pa": 1e9}, {}, "needs strands of &cable"),
    ({"tendon_strain_max": 0.01}, {}, "needs strands or rupture_strain of &cable"),
    ({"shear_key_force_max_over_m_w_g": 1.0}, {}, "needs shear_key of &wall"),
    (
        {"friction_demand_max": 0.5},
        {"wall": {"shear_key": True}},
        "needs no shear_key of &wall",
    ),
    ({"storey_residual_drift_max": 0.01}, {"yielding": {"u_y": 0.02}}, "needs &storeys"),
    ({"cable_prestress_loss_over_m_w_g": 0.1}, {}, "needs eta_y or rupture_strain of &cable"),
)


def test_a_frame_without_height_has_no_drift() -> None:
    with pytest.raises(rwmf.InputError, match="needs a height: &wall, &storeys or h_f to have"):
        bare_frame(limits={"roof_drift_max": 0.01})
