"""Captions of the page against the kernel: thresholds, shares and storeys that they state."""

from __future__ import annotations

import re

import pytest
import rwmf
from checkout import ROOT
from rwmf import Case
from rwmf.explorer.controls import describe
from rwmf.explorer.model import captions_of, compare_with_frame, uplift_acceleration
from rwmf.explorer.questions import case_of_preset
from rwmf.kernel import tables
from rwmf.run.quantities import find

BLOCK = case_of_preset("block")
FRAME = case_of_preset("wall_and_frame")
FIG12 = case_of_preset("fig12_one_sine")


def _captions(case: Case, t_lift_off: float | None = None, yields: tuple[bool, ...] = ()) -> str:
    """Return the captions of a run; times and storeys as the page passes them."""
    shown = case.replace(output={"dt": 0.1, "energy": True, "reactions": True})
    with rwmf.run.simulation.start(shown) as run:
        return " ".join(captions_of(shown, run.summary(), t_lift_off, yields))


@pytest.mark.parametrize(
    "case",
    [
        BLOCK,
        FRAME,
        FIG12,
        FRAME.replace(frame={"gamma": 0.3}, cable={"eta_0": 2.5}, wall={"b": 0.9}),
        FRAME.replace(link={"L": 6.0}),
        FRAME.replace(fuse={"eta_y": 0.3, "stroke_y": 0.005}),
        FRAME.replace(damper={"c_over_m_w": 2.0}, inerter={"inertance_over_m_w": 0.5}),
        FRAME.replace(yielding={"u_y": 0.02}, p_delta={}),
        FRAME.replace(model={"g": 5.0}),
        FRAME.replace(cable=None),
    ],
)
def test_the_acceleration_at_uplift_is_that_of_the_kernel(case: Case) -> None:
    """Just below it a run has no lift-off, just above it one."""
    needed = uplift_acceleration(case)
    assert needed is not None
    for factor, lifts in ((0.999, False), (1.001, True)):
        moved = case.replace(motion={"a_max_g": factor * needed}, solver={"t_end": 1.0})
        # a pulse in g follows the gravity of the case
        assert bool(rwmf.simulate(moved).lift_offs) == lifts


@pytest.mark.parametrize(
    "change",
    [
        {"vertical": {"ratio": 0.5}},
        {"initial": {"theta_over_alpha": 0.2}},
        {"wall": {"base": "pinned"}, "impact": None, "cable": None},
    ],
)
def test_no_constant_acceleration_at_uplift(change: dict[str, object]) -> None:
    assert uplift_acceleration(FRAME.replace(**change)) is None


def test_a_wall_that_stays_down_says_what_it_needs() -> None:
    text = _captions(BLOCK.replace(motion={"a_max_g": 0.2}))
    assert text == "No uplift: it needs 0.26 g, and the ground reaches 0.2 g."
    assert "The wall lifts off at 0.13 s, where the ground passes 0.26 g." in _captions(BLOCK, 0.13)


def test_the_rotation_is_over_alpha() -> None:
    assert re.search(r"rotates to 48 % of its slenderness α = 0\.25 rad", _captions(BLOCK, 0.1))
    assert "The wall overturns." in _captions(BLOCK.replace(motion={"a_max_g": 0.4}), 0.1)


def test_shares_of_the_energy_are_those_of_the_ledger() -> None:
    text = _captions(FIG12, 0.02)
    shares = dict(re.findall(r"(dampers|impacts) ([\d.]+) %", text))
    run = rwmf.simulate(FIG12.replace(output={"energy": True}))
    for name, key in (("dampers", "viscous"), ("impacts", "impact")):
        exact = float(run[f"energy_{key}_end"] / run["energy_input_end"])
        assert float(shares[name]) == pytest.approx(100 * exact, abs=0.51)


def test_storeys_that_yield_are_named() -> None:
    case = case_of_preset("six_storeys")
    run = rwmf.simulate(case)
    yields = tuple(bool(x > 1) for x in run.storeys_ductility.values)
    text = _captions(case, 0.09, yields)
    assert "Storeys 1, 2, 3, 4 and 5 yield: largest ductility 1.46." in text
    assert yields == (True, True, True, True, True, False)
    assert "Storey 5 has the largest IDR" in text
    assert "stays elastic" in _captions(case, None, (False,) * 6)


def test_a_collapse_has_its_time_and_no_shares() -> None:
    """The weight adds energy, so that shares of the work of the ground would mislead."""
    case = Case.from_namelist(ROOT / "inputs" / "p_delta_collapse.nml")
    text = _captions(case, None, (True,))
    assert f"collapses at {float(rwmf.simulate(case).t_collapse):.2f} s" in text
    assert "Of the energy" not in text


def test_a_tendon_that_yields() -> None:
    path = ROOT / "inputs" / "what_is_lost_when_the_tendon_yields.nml"
    case = Case.from_namelist(path)
    loss = float(rwmf.simulate(case).cable_prestress_loss_over_m_w_g)
    assert f"The tendon yields and loses {loss:.2g} m_w g of its prestress." in _captions(case, 0.1)


@pytest.mark.parametrize(
    ("value", "alone", "words"),
    [(0.72, 1.0, "28 % less than"), (1.05, 1.0, "5 % more than"), (1.0, 1.0, "as much as"),
     (float("nan"), 1.0, ""), (1.0, None, ""), (1.0, 0.0, "")],
)  # fmt: skip
def test_the_comparison_with_the_frame_alone(value: float, alone: float | None, words: str) -> None:
    text = compare_with_frame(find("u_s_max_m"), value, alone)
    assert words in text
    assert bool(text) == bool(words)


@pytest.mark.parametrize("row", [row for row in tables.schema() if row.gives], ids=lambda x: x.key)
def test_a_key_and_the_one_that_it_gives_replace_each_other(row: tables.KeyRow) -> None:
    """The kernel refuses both."""
    pair = {f"{row.group}.{row.gives}", f"{row.group}.{row.key}"}
    assert any(pair <= set(same) for same in describe()["alternatives"])
