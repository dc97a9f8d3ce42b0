"""Limits and checks: the run's own peaks, suites counted by hand, every interface and error."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
import scenes
import xarray as xr
from refused import refusals
from rwmf import cli, plot
from rwmf.run.quantities import QUANTITIES
from scenes import WEIGHT, bare_frame, block, coupled, retrofit

LIMITS: dict[str, Any] = scenes.LIMITS | {
    "roof_drift_max": 0.01,
    "storey_residual_drift_max": 0.002,
    "wall_moments_max_N_m": 5e6,
}


def _retrofit(coupling: str = "every_floor", **changes: dict[str, Any] | None) -> rwmf.Case:
    groups: dict[str, Any] = {"yielding": {"storey_u_y": 0.012, "hardening": 0.02}}
    limits = LIMITS
    if coupling == "reduced":
        # storeys do not yield one by one
        groups = {}
        limits = {k: v for k, v in LIMITS.items() if k != "storey_residual_drift_max"}
    pulse = {"kind": "ricker", "a_max_g": 0.5, "T_p": 1.1}
    case = retrofit(coupling, motion=pulse, limits=limits, solver={"t_end": 6.0}, **groups)
    return case.replace(**changes)


@pytest.mark.parametrize("coupling", ["reduced", "full", "every_floor", "springs"])
@pytest.mark.parametrize("bending", [None, {"E": 3e10, "modes": 2}])
def test_demands_are_the_peaks_of_the_run(coupling: str, bending: dict[str, Any] | None) -> None:
    """Bit for bit; a list gives a limit for each floor, one number the same for all."""
    case = _retrofit(coupling, bending=bending)
    run = rwmf.simulate(case)
    found = rwmf.checks(case, run)
    peaks = run.flat()
    links = 6 if coupling in ("every_floor", "springs") else 1
    assert len(found.rows) == len(case.limits.given) + 3 * 5 + links - 1
    for row in found.rows:
        assert row.demand == peaks[row.key]
        if row.key == "contact_length_min_m":
            assert row.ratio == row.limit / row.demand
        else:
            assert row.ratio == abs(row.demand) / row.limit
        assert row.is_met == (row.ratio <= 1)
    by_key = {row.key: row for row in found.rows}
    for i in range(6):
        assert by_key[f"wall_shear_{i + 1}_max_N"].limit == LIMITS["wall_shears_max_N"][i]
        assert by_key[f"wall_moment_{i + 1}_max_N_m"].limit == 5e6
        assert by_key[f"storey_{i + 1}_drift_max"].height == pytest.approx(3.2 * (i + 1))
    # the run of the same case without limits, and of one that asks by &output
    asked = rwmf.simulate(case.replace(limits=None, output={"reactions": True})).flat()
    assert all(asked[row.key] == row.demand for row in found.rows)
    assert rwmf.checks(case, asked).rows == found.rows


@pytest.mark.parametrize(
    ("ratio", "force", "unit"),
    [
        ("wall_shear_max_over_m_w_g", "wall_shear_max_N", WEIGHT),
        ("wall_shears_max_over_m_w_g", "wall_shears_max_N", WEIGHT),
        ("wall_moments_max_over_m_w_g_m", "wall_moments_max_N_m", WEIGHT),
        ("links_force_max_over_m_w_g", "links_force_max_N", WEIGHT),
        ("pivot_normal_max_over_m_w_g", "pivot_normal_max_N", WEIGHT),
        ("base_shear_max_over_weight", "base_shear_max_N", WEIGHT + 6 * 1.5e5 * 9.81),
        ("tendon_force_max_over_m_w_g", "tendon_force_max_N", WEIGHT),
    ],
)
def test_limits_over_the_weight_and_in_newtons_agree(ratio: str, force: str, unit: float) -> None:
    case = _retrofit(limits={**dict.fromkeys(LIMITS), ratio: 0.3, force: 0.3 * unit})
    rows = rwmf.checks(case, rwmf.simulate(case)).rows
    half = len(rows) // 2
    pairs = sorted(rows, key=lambda row: (row.number, row.key))
    assert half
    for a, b in zip(pairs[::2], pairs[1::2], strict=True):
        assert a.ratio == pytest.approx(b.ratio, rel=1e-14)


def test_a_limit_requests_its_demand_and_nothing_else() -> None:
    """By kind of observation; the motion and all other results keep their bits."""
    case = coupled(output={"reactions": False})
    plain = rwmf.simulate(case).flat()
    for limits, kind in (
        ({"u_s_max_m": 0.3}, ""),
        ({"friction_demand_max": 0.5}, "base_shear_max_over_weight"),
        ({"roof_drift_max": 0.02}, "floor_acceleration_max_g"),
        ({"wall_shear_base_max_over_m_w_g": 0.5}, "pivot_normal_max_over_m_w_g"),
    ):
        found = rwmf.simulate(case.replace(limits=limits)).flat()
        work = ("seconds", "rhs_evaluations")
        assert all(found[key] == value for key, value in plain.items() if key not in work)
        new = set(found) - set(plain)
        assert bool(new) == bool(kind)
        reactions = {key for key, item in QUANTITIES.items() if item.asked_by == "reactions"}
        assert not kind or kind in new & reactions
    assert coupled().limits is None
    assert coupled().kernel.limited_demands() == []


def test_scenes_without_storeys_frame_or_wall() -> None:
    single = coupled(limits={"roof_drift_max": 0.02, "floors_acceleration_max_g": 1.0,
                             "links_force_max_over_m_w_g": 3.0})  # fmt: skip
    assert [row.key for row in rwmf.checks(single, rwmf.simulate(single)).rows] == [
        "roof_drift_max", "floor_1_acceleration_max_g", "link_1_force_max_over_m_w_g",
    ]  # fmt: skip
    frame = bare_frame(limits={"u_s_max_m": 0.2, "floor_acceleration_max_g": 1.0})
    assert len(rwmf.checks(frame, rwmf.simulate(frame)).rows) == 2
    lone = block(initial={"theta_over_alpha": 0.5}, limits={"theta_max_over_alpha": 0.4})
    found = rwmf.checks(lone, rwmf.simulate(lone))
    assert found.rows[0].ratio == pytest.approx(1.25, rel=1e-12)
    assert not found.is_met


def test_an_overturned_run_meets_no_limit() -> None:
    case = block(initial={"theta_over_alpha": 1.2}, limits={"theta_dot_max_rad_s": 100.0})
    found = rwmf.checks(case, rwmf.simulate(case))
    assert found.rows[0].is_met
    assert not found.is_met
    assert found.ended == 1
    assert "OVERTURNED" in str(found)


def _suite(case: rwmf.Case) -> xr.Dataset:
    return rwmf.sweep(case, points={"motion.T_p": np.linspace(0.5, 2.0, 7), "scale": [1.0] * 7})


def test_suites_are_counted() -> None:
    """Ranks by hand; collapses are above every limit, and the worst for a smallest contact."""
    case = block(
        wall={"h": 2.0, "b": 0.5, "thickness": 0.2, "density": 2500.0}, base_section={"k": 1e9},
        motion={"kind": "one_sine", "a_max_g": 0.6, "T_p": 1.0}, model={"formulation": "exact"},
        limits={"theta_max_over_alpha": 0.3, "contact_length_min_m": 0.05},
    )  # fmt: skip
    runs = _suite(case)
    names = runs["status"].attrs["flag_meanings"].split()
    fallen = runs["status"].values == names.index("overturned")
    assert 0 < fallen.sum() < 7, "some must fall, some stand"
    found = rwmf.checks(case, runs)
    assert (found.runs, found.ended, found.failed) == (7, int(fallen.sum()), 0)
    peak, contact = found.rows
    ranked = np.sort(np.where(fallen, np.inf, runs["theta_max_over_alpha"].values))
    for q, rank in ((16.0, 2), (50.0, 4), (84.0, 6), (100.0, 7)):
        assert peak.demands[q] == ranked[rank - 1]
        assert peak.ratios[q] == ranked[rank - 1] / 0.3
    assert peak.share_above == np.mean(ranked > 0.3)
    smallest = np.sort(np.where(fallen, 0.0, runs["contact_length_min"].values))[::-1]
    assert [contact.demands[q] for q in (16.0, 50.0, 84.0, 100.0)] == [
        smallest[i] for i in (1, 3, 5, 6)
    ]
    assert contact.share_above == np.mean(smallest < 0.05)
    text = str(found)
    assert f"{int(fallen.sum())} runs overturned or collapsed" in text
    assert "16 %" in text


def test_each_point_of_a_grid_has_its_checks() -> None:
    case = coupled(limits={"u_s_max_m": 0.2, "theta_max_over_alpha": 0.3})
    grid = rwmf.spectrum(case, T_s=[0.5, 1.0], gamma=[2.0, 5.0])
    found = rwmf.checks(case, grid)
    assert len(found.rows) == 8
    for row in found.rows:
        name = {"u_s_max_m": "u_s_max", "theta_max_over_alpha": "theta_max_over_alpha"}[row.key]
        at = grid[name].sel(T_s=row.at["T_s"], gamma=row.at["gamma"]).squeeze()
        assert row.demand == float(at)
    assert "gamma = 2, T_s = 0.5" in str(found)


def test_analyses_keep_the_demands_of_limits() -> None:
    case = coupled(limits={"theta_max_over_alpha": 0.3})
    motion = rwmf.Motion(np.sin(np.linspace(0, 6.28, 200)) * 0.3, dt=0.01, unit="g", name="a")
    table = rwmf.cloud(case, [motion, rwmf.Motion(np.full(50, 0.1), dt=0.02, unit="g", name="b")])
    found = rwmf.checks(case, table)
    assert found.runs == 2
    values = table["theta_max_over_alpha"].values
    assert found.rows[0].demand == values.max()


def test_command_prints_writes_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, table, figure = (tmp_path / name for name in ("case.nml", "checks.csv", "checks.png"))
    case = _retrofit()
    case.to_namelist(path)
    assert cli.main(["run", str(path), "--checks", str(table), str(figure)]) == 0
    out = capsys.readouterr().out
    assert "EXCEEDED" in out
    assert "largest ratio" in out
    assert cli.main(["run", str(path), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    with table.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    python = rwmf.checks(case, rwmf.simulate(case))
    assert len(rows) == len(python.rows) == len(summary["checks"]["rows"])
    for row, item, own in zip(rows, summary["checks"]["rows"], python.rows, strict=True):
        assert row["key"] == item["key"] == own.key
        assert float(row["demand"]) == item["demand"] == own.demand == summary[own.key]
        assert float(row["ratio"]) == item["ratio"] == own.ratio
    assert figure.read_bytes()[:4] == b"\x89PNG"
    assert cli.main(["run", str(path), "--all"]) == 0
    assert "wall_shear_3_max_N" in capsys.readouterr().out.split("checks ", 1)[1]


def test_command_of_a_spectrum(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.nml"
    coupled(
        solver={"t_end": 3.0}, spectrum={"T_s": [0.5, 1.0]}, limits={"theta_max_over_alpha": 0.1}
    ).to_namelist(path)
    assert cli.main(["spectrum", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [row["T_s"] for row in found["checks"]["rows"]] == [0.5, 1.0]
    assert [row["demand"] for row in found["checks"]["rows"]] == np.ravel(
        found["theta_max_over_alpha"]
    ).tolist()


def test_figure_has_a_bar_for_each_demand() -> None:
    case = _retrofit()
    found = rwmf.checks(case, rwmf.simulate(case))
    panels = plot.checks(found)
    assert len(panels) == 2
    assert len(panels[0].patches) == len(LIMITS)
    widths = [bar.get_width() for bar in panels[0].patches]
    assert max(widths) == pytest.approx(min(found.worst.ratio, 3.0))
    labels = panels[1].get_legend_handles_labels()[1]
    assert labels == [
        "storeys_drift_max", "wall_shears_max_N", "wall_moments_max_N_m", "links_force_max_N",
    ]  # fmt: skip
    with pytest.raises(rwmf.InputError, match=r"must be the result of rwmf\.checks"):
        plot.checks(case)


def test_design_takes_its_targets_from_limits() -> None:
    case = coupled(limits={"u_s_max_m": 0.21, "theta_max_over_alpha": 0.5})
    how: dict[str, Any] = {"bounds": {"eta_0": (0.0, 3.0)}, "cost": {"eta_0": 1.0}, "designs": 20}
    named = [
        {"quantity": "u_s_max", "limit": 0.21, "percentile": 84},
        {"quantity": "theta_max_over_alpha", "limit": 0.5, "percentile": 84},
    ]
    both = [
        rwmf.design(case, targets=targets, **how)
        for targets in (named, [{"quantity": "limits", "percentile": 84}])
    ]
    assert both[0].values == both[1].values
    assert [check.target for check in both[0].checks] == [check.target for check in both[1].checks]
    found = rwmf.checks(both[1].case, rwmf.sweep(both[1].case))
    for check, row in zip(both[1].checks, found.rows, strict=True):
        assert check.utilisation == pytest.approx(row.ratio, rel=1e-12)


test_refused = refusals(
    lambda changes: coupled(**changes),
    ({"limits": {"drift": 0.01}}, "&limits.*drift"),
    ({"limits": {"roof_drift_max": -0.01}}, "roof_drift_max = -0.01: must be a number > 0"),
    ({"limits": {"roof_drift_max": 0.0}}, "roof_drift_max = 0.0: must be a number > 0"),
    ({"limits": {"pivot_normal_min_N": 1.0}}, "pivot_normal_min_N"),
    ({"limits": {"storey_drift_max": 0.01}}, "storey_drift_max.*needs &storeys"),
    ({"limits": {"fuse_stroke_max_m": 0.01}}, "fuse_stroke_max_m.*needs &fuse"),
    ({"limits": {"toe_strain_max": 0.01}}, "toe_strain_max.*needs &base_section"),
    ({"limits": {"wall_shear_max_N": 1e6}}, "wall_shear_max_N.*needs the mass of the wall"),
    ({"limits": {"floors_acceleration_max_g": [1.0, 1.0]}}, "one value, or one for each of 1"),
    ({"limits": {"roof_residual_drift": 0.01}}, "roof_residual_drift.*needs &yielding"),
)


def test_refused_beside_a_bare_frame_or_storeys() -> None:
    with pytest.raises(rwmf.InputError, match=r"links_force_max_over_m_w_g.*needs &wall"):
        bare_frame(limits={"links_force_max_over_m_w_g": 1.0})
    with pytest.raises(rwmf.InputError, match="one value, or one for each of 6"):
        _retrofit(limits={"wall_shears_max_N": [1e6, 1e6]})


def test_refused_arguments(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = coupled(limits={"theta_max_over_alpha": 0.3})
    plain = coupled()
    with pytest.raises(rwmf.InputError, match="&limits: is missing or empty"):
        rwmf.checks(plain, rwmf.simulate(plain))
    with pytest.raises(rwmf.InputError, match="result: has none of the demands"):
        rwmf.checks(case, {"u_s_max_m": 1.0})
    with pytest.raises(rwmf.InputError, match=r"result: has no theta_max_over_alpha"):
        rwmf.checks(case, rwmf.sweep(plain))
    with pytest.raises(rwmf.InputError, match="result = 3: must be"):
        rwmf.checks(case, 3)
    with pytest.raises(rwmf.InputError, match="targets: limits: has no limit"):
        rwmf.design(case, {"eta_0": (0, 1)}, [{"quantity": "limits", "limit": 1, "percentile": 84}],
                    {"eta_0": 1})  # fmt: skip
    with pytest.raises(rwmf.InputError, match="targets: limits: the case has no &limits"):
        rwmf.design(plain, {"eta_0": (0, 1)}, [{"quantity": "limits", "percentile": 84}],
                    {"eta_0": 1})  # fmt: skip
    path = tmp_path / "case.nml"
    plain.to_namelist(path)
    assert cli.main(["run", str(path), "--checks", str(tmp_path / "c.csv")]) == 2
    assert "--checks: the case has no &limits" in capsys.readouterr().err
    assert not (tmp_path / "c.csv").exists()


def test_a_demand_that_does_not_occur_is_named() -> None:
    """A frame that ends without an equilibrium has no drift at rest."""
    case = _retrofit(limits=dict.fromkeys(LIMITS) | {"roof_residual_drift_at_rest": 0.01,
                                                     "roof_drift_max": 1.0})  # fmt: skip
    found = rwmf.checks(case, {"roof_drift_max": 0.5})
    row = next(row for row in found.rows if row.key == "roof_residual_drift_at_rest")
    assert math.isnan(row.ratio)
    assert not row.is_met
    assert "no demand" in str(found)
