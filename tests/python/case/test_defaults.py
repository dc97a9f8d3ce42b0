"""Defaults of a case, and the warning about violated conservation laws."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import Runner
from scenes import block, coupled

TRUE = {"model": {"formulation": "exact"}, "impact": {"rule": "coupled", "e": None}}
PAPER = {"model": {"formulation": "published"}, "impact": {"rule": None, "e": 0.9}}
SHORT = {"t_end": 3.0}
ENERGY = "not conserved: energy while theta < 0 (formulation 'published')"
EVEN_CABLE = {"eta_0": 1.0, "eta_alpha": 1.0}
STOREYS = {"m_over_m_w": [1.0, 1.0], "k_over_m_w": [200.0, 150.0], "height": [2.0, 2.0]}


def outside(e: float = 0.9, gamma: float = 5.0) -> str:
    """Warn of an impulse outside the base, from the balance of moments about the new corner."""
    h, b = 2.0, 0.5
    inertia = 4 / 3 * (h**2 + b**2) + 4 * gamma * h**2
    e_max = 1 - 2 * b**2 / inertia
    widths = (e_max - e) * inertia / (b * (1 + e)) / (2 * b)
    case = coupled(frame={"gamma": gamma}, impact={"e": 0.1}, solver={"t_end": 0.01})
    found = rwmf.simulate(case)["e_max"].item()
    assert found == pytest.approx(e_max, rel=1e-15)
    shown = [float(f"{x:.4g}") for x in (e, found, widths)]
    if shown[0] == shown[1]:
        shown[:2] = e, found
    most = repr(shown[1])
    if shown[1] == 1.0:
        most = f"1 - {1 - found:.4g}".replace("e-0", "e-")
    return (
        f"e = {shown[0]!r} is below e_max = {most}, that of &impact rule = 'coupled': the "
        f"impulse would act {shown[2]!r} base widths outside the base"
    )


def without_choices(**changes: dict[str, object] | None) -> rwmf.Case:
    """Scene with `&impact`, but neither rule nor formulation."""
    case = coupled(solver=SHORT, **changes)
    return case.replace(model=None, impact=None).replace(impact={})


def lines(case: rwmf.Case) -> list[str]:
    """Warnings of a run about energy and impacts, without their numbers."""
    found = rwmf.simulate(case).attrs["warnings"].splitlines()
    return [line for line in found if line.startswith("not conserved") or " e_max " in line]


def test_nothing_said_is_exact_with_the_momentum_balance() -> None:
    case = without_choices()
    assert (case.model.formulation, case.impact.rule) == ("exact", "coupled")
    silent, told = rwmf.simulate(case), rwmf.simulate(coupled(solver=SHORT, **TRUE))
    assert float(silent.u_s_max) == float(told.u_s_max)
    assert float(silent.e) == float(silent.e_max) > 0.99
    assert silent.attrs["warnings"] == ""


@pytest.mark.parametrize("formulation", ["published", "symmetric", "exact"])
@pytest.mark.parametrize("impact", [None, {}])
def test_a_rocking_wall_balances_its_momentum_by_default(
    formulation: str, impact: dict[str, object] | None
) -> None:
    alone = block(impact=None, initial={"theta_over_alpha": 0.5})
    alone = alone.replace(impact=impact, model={"formulation": formulation})
    assert alone.impact.rule == "coupled"
    assert alone.impact.given == frozenset()
    alpha = np.arctan2(alone.wall.b, alone.wall.h)
    run = rwmf.simulate(alone)
    assert float(run.e) == pytest.approx(1 - 1.5 * np.sin(alpha) ** 2, rel=1e-15)
    assert "impact" in run.attrs["effects"]
    assert lines(alone) == []
    # keys of the group are axes without it
    found = rwmf.sweep(alone, {"e": [0.9]}, quantities="impacts")
    assert found.impacts.item() == rwmf.simulate(alone.replace(impact={"e": 0.9})).impacts
    assert found.e.item() == 0.9
    with pytest.raises(rwmf.InputError, match="quantities: e: is an axis, which has its values"):
        rwmf.sweep(alone, {"e": [0.9]}, quantities="e")


def test_rule_none_loses_nothing_at_impacts() -> None:
    start = {"theta_over_alpha": 0.5}
    run = rwmf.simulate(block(impact={"rule": "none", "e": None}, initial=start))
    assert float(run.e) == 1.0
    assert "impact" not in run.attrs["effects"]
    assert float(run.theta_max_over_alpha) == pytest.approx(0.5, rel=1e-8)
    with pytest.raises(rwmf.InputError, match="must not be given with rule = 'none'"):
        block(impact={"rule": "none"})


def test_a_hinged_wall_has_no_rule_of_impacts() -> None:
    rocking = coupled(impact=None, cable=None)
    hinged = rocking.replace(wall={"base": "pinned"})
    assert (rocking.impact.rule, hinged.impact) == ("coupled", None)
    assert "impact" not in rwmf.simulate(hinged).attrs["effects"]
    assert hinged.replace(wall={"base": None}) == rocking


def test_a_table_needs_no_rule() -> None:
    table = {"table_theta_dot": [0.1, 1.0], "table_e": [0.95, 0.9]}
    assert without_choices().replace(impact=table).impact.rule == "table"
    with pytest.raises(rwmf.InputError, match="must not be given with rule = 'constant'"):
        without_choices().replace(impact={"e": 0.9, "table_e": [0.9]})


@pytest.mark.parametrize(
    ("changes", "expected", "impulse"),
    [
        (TRUE, [], None),
        (PAPER, [ENERGY], (0.9, 5.0)),
        (PAPER | {"frame": {"gamma": 1800.0}}, [ENERGY], (0.9, 1800.0)),
        (PAPER | {"cable": EVEN_CABLE}, [ENERGY], (0.9, 5.0)),
        (TRUE | {"model": {"formulation": "published"}}, [ENERGY], None),
        (PAPER | {"model": {"formulation": "exact"}}, [], (0.9, 5.0)),
        (TRUE | {"impact": {"rule": "housner", "e": None}}, [], (0.9117647058823529, 5.0)),
        # as near to the momentum balance as four digits can tell
        (PAPER | {"impact": {"rule": None, "e": 0.99416}}, [ENERGY], (0.99416, 5.0)),
        # an impulse inside the base
        (TRUE | {"impact": {"rule": None, "e": 1.0}}, [], None),
        # a frame without mass moves no wall: the formulations are one
        (PAPER | {"frame": {"gamma": 0.0}}, [], (0.9, 0.0)),
        (PAPER | {"frame": None}, [], (0.9, 0.0)),
        (PAPER | {"impact": None, "cable": None, "wall": {"base": "pinned"}}, [], None),
        (PAPER | {"frame": {"T_s": None, "gamma": None}, "storeys": STOREYS}, [ENERGY], ()),
    ],
)
def test_what_a_run_does_not_conserve(
    changes: dict[str, dict[str, object] | None],
    expected: list[str],
    impulse: tuple[float, ...] | None,
) -> None:
    told = lines(coupled(solver=SHORT, **changes))
    assert told[0 if impulse is None else 1 :] == expected
    if impulse:
        assert told[0] == outside(*impulse)


def test_the_line_is_true_for_energy() -> None:
    """Return the missing energy between impacts, without damping, from a start at the left."""
    changes = {
        "frame": {"xi_s": 0.0},
        "cable": EVEN_CABLE,
        "impact": {"e": 1.0},
        "motion": {"kind": "none", "a_max_g": None, "omega_p": None},
        "initial": {"theta_over_alpha": -0.3},
        "output": {"energy": True},
        "solver": {"t_end": 0.2, "method": "dop853"},
    }
    residual = {}
    for formulation in ("published", "exact"):
        run = rwmf.simulate(coupled(**changes, model={"formulation": formulation}))
        assert int(run.impacts) == 0
        residual[formulation] = abs(float(run.energy_balance_relative))
    assert residual["exact"] < 1e-8 < 1e-5 < residual["published"]


def test_warnings_come_back_from_a_file(tmp_path: Path) -> None:
    """None, one and several: the same text in memory and in NetCDF."""
    case = coupled(solver=SHORT, **PAPER)
    falling = {"cable": {"eta_0": 1.0, "eta_alpha": 5.0}}
    told = [
        rwmf.simulate(coupled(solver=SHORT, **TRUE)),
        rwmf.simulate(case.replace(**falling)),
        rwmf.spectrum(case, T_s=[0.5, 1.0]),
    ]
    for found in told:
        found.drop_vars("status", errors="ignore").to_netcdf(tmp_path / "w.nc", engine="h5netcdf")
        with xr.open_dataset(tmp_path / "w.nc", engine="h5netcdf") as kept:
            assert kept.attrs["warnings"] == found.attrs["warnings"]
    assert [len(found.attrs["warnings"].splitlines()) for found in told] == [0, 3, 3]


@pytest.mark.parametrize("method", ["auto", "dop853", "adams"])
def test_the_default_rule_follows_the_grid(method: str) -> None:
    """Every ordinate has the balance of its mass ratio and width, in lanes and in single runs."""
    case = without_choices().replace(solver={"method": method, "t_end": 3.0})
    grid = {"T_s": [0.6, 1.2], "gamma": [2.0, 50.0], "b": [0.5, 0.9]}
    found = rwmf.spectrum(case, **grid)
    for place in found.u_s_max.stack(point=found.u_s_max.dims).point.values:
        at = dict(zip(found.u_s_max.dims, place, strict=True))
        one = case.replace(
            frame={"T_s": at["T_s"], "gamma": at["gamma"]},
            wall={"b": at["b"]},
            solver={"method": "dop853"},
        )
        alone = float(rwmf.simulate(one).u_s_max)
        assert float(found.u_s_max.sel(at)) == pytest.approx(alone, rel=2e-7)


@pytest.mark.parametrize(
    "effect",
    [
        *(
            {"storeys": STOREYS | {"coupling": word}, "frame": {"T_s": None, "gamma": None}}
            for word in ("reduced", "every_floor", "full")
        ),
        {"vertical": {"ratio": 0.5}},
        {"inerter": {"inertance_over_m_w": 0.5}},
        {"link": {"L": 6.0}},
        {"yielding": {"u_y": 0.1}, "p_delta": {}},
    ],
    ids=lambda effect: "-".join(map(str, effect.values()))[-40:],
)
def test_the_default_rule_with_every_effect(effect: dict[str, dict[str, object]]) -> None:
    case = without_choices(**effect)
    run = rwmf.simulate(case)
    assert float(run.e) == float(run.e_max)
    assert lines(case) == []
    spectrum = rwmf.spectrum(case, T_s=[0.8, 1.6])
    assert (spectrum.status == "ok").all()
    # lift-off and impacts take part, of a yielding frame but one
    assert int(run.impacts) > 0


def test_friction_with_the_default_rule() -> None:
    grid = {"T_s": [0.6, 1.5], "gamma": [5.0, 100.0]}
    found = rwmf.sweep(without_choices(), grid, quantities="friction_demand_max")
    assert np.isfinite(found.friction_demand_max).all()
    assert found.attrs["warnings"] == ""


def test_check_notes_what_was_otherwise(command: Runner, tmp_path: Path) -> None:
    without_choices().to_namelist(tmp_path / "silent.nml")
    notes = [line for line in command("check", "silent.nml").stdout.splitlines() if "note" in line]
    assert len(notes) == 2
    assert "formulation = 'exact'" in notes[0]
    assert "before version 0.2 it was 'published'" in notes[0]
    assert "rule = 'coupled'" in notes[1]
    assert "before version 0.8 it was 'none' (e = 1)" in notes[1]
    block(impact=None).to_namelist(tmp_path / "absent.nml")
    notes = [line for line in command("check", "absent.nml").stdout.splitlines() if "note" in line]
    assert [note.split(", ")[0] for note in notes] == ["note: &impact rule = 'coupled'"]
    for changes in (TRUE, PAPER):
        coupled(solver=SHORT, **changes).to_namelist(tmp_path / "told.nml")
        assert "note:" not in command("check", "told.nml").stdout
    # of a wall that stands alone all formulations are one
    block(model=None).to_namelist(tmp_path / "block.nml")
    assert "note:" not in command("check", "block.nml").stdout
