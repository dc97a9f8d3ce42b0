"""Envelopes of forces over the height show the numbers of their datasets."""

from __future__ import annotations

import numpy as np
import pytest
import rwmf
from checkout import ROOT

pytest.importorskip("matplotlib")

from scenes import block, coupled

REACTIONS = {"reactions": True, "dt": 0.02}


def _case(coupling: str, *, has_mass: bool, bends: bool = False) -> rwmf.Case:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / f"storeys_{coupling}.nml").without("spectrum")
    wall = {"m_w": 1e5} if has_mass else {}
    case = case.replace(wall=wall, solver={"t_end": 1.5}, output=REACTIONS)
    if not bends:
        return case
    exact = {"model": {"formulation": "exact"}, "impact": {"rule": "coupled", "e": None}}
    return case.replace(bending={"EI_over_m_w": 2e5, "modes": 1}, **exact)


@pytest.mark.parametrize("coupling", ["full", "reduced", "every_floor", "springs"])
@pytest.mark.parametrize(("has_mass", "bends"), [(True, False), (False, True)])
def test_one_run(coupling: str, has_mass: bool, bends: bool) -> None:
    """Points have the numbers of the run in the right place; labels have words and units."""
    case = _case(coupling, has_mass=has_mass, bends=bends)
    run = rwmf.simulate(case)
    panels = rwmf.plot.envelope(run, case)
    unit, factor = ("", 1e-3) if has_mass else ("_over_m_w_g", 1.0)
    heights = np.cumsum(case.storeys.height)
    places = {"base": 0.0, "mid": case.wall.h}
    for i, z in enumerate(heights):
        places |= {f"{i + 1}": z, f"{i + 1}_above": z}
    for ax, what in zip(panels, ("shear", "moment"), strict=False):
        x, z = ax.lines[0].get_data()
        drawn = {(float(value), float(at)) for value, at in zip(x, z, strict=True)}
        expected = {
            (factor * float(run[f"wall_{what}_{place}_max{unit}"]), float(at))
            for place, at in places.items()
            if place != "mid" or case.wall.h not in heights
        }
        assert drawn == expected
        assert list(z) == sorted(z)
        star = ax.lines[1].get_data()
        assert star[0][0] == factor * float(run[f"wall_{what}_max{unit}"])
        assert star[1][0] == float(run[f"wall_{what}_max_height"])
        assert ax.get_xlim()[1] >= max(x)
    links, z = panels[2].lines[0].get_data()
    first = 1 if coupling in ("every_floor", "springs") else len(heights)
    assert list(z) == pytest.approx(list(heights[first - 1 :]))
    numbers = range(first, len(heights) + 1)
    assert list(links) == [factor * float(run[f"link_{i}_force_max{unit}"]) for i in numbers]
    labels = [ax.get_xlabel() for ax in panels]
    assert labels == (
        ["largest shear (kN)", "largest moment (kN m)", "largest link force (kN)"]
        if has_mass
        else [
            "largest shear over $m_w g$",
            "largest moment over $m_w g$ (m)",
            "largest link force over $m_w g$",
        ]
    )
    assert panels[0].get_ylabel() == "height above the base (m)"


@pytest.mark.parametrize(("coupling", "bends"), [("every_floor", False), ("springs", True)])
def test_suite(coupling: str, bends: bool) -> None:
    """The line is the median, the band reaches from 16 to 84 %."""
    case = _case(coupling, has_mass=True, bends=bends)
    names = rwmf.plot.envelope_quantities(case)
    runs = rwmf.sweep(case, {"motion.a_max_g": [0.3, 0.4, 0.5, 0.6, 0.7]}, quantities=names)
    assert set(names) == set(runs.data_vars) - {"status"}
    panels = rwmf.plot.envelope(runs, case)
    base = runs["wall_moment_base_max"].values.ravel() / 1e3
    assert panels[1].lines[0].get_xdata()[0] == pytest.approx(np.median(base))
    (band,) = panels[1].collections
    ends = [x for x, z in band.get_paths()[0].vertices if z == 0]
    assert (min(ends), max(ends)) == pytest.approx(np.percentile(base, [16, 84]))
    assert len(panels[1].lines) == 1  # no star: the runs have their largest values at many places
    assert panels[0].get_legend_handles_labels()[1] == ["median", "16 to 84 %, 5 runs"]


def test_single_mass_and_block() -> None:
    """A single mass has one floor, at the top; a block has no links."""
    case = coupled(impact={"rule": "coupled", "e": None}, output={"reactions": True})
    panels = rwmf.plot.envelope(rwmf.simulate(case), case)
    assert list(panels[0].lines[0].get_ydata()) == [0.0, 2.0, 4.0, 4.0]
    assert list(panels[2].lines[0].get_ydata()) == [4.0]
    case = block(initial={"theta_over_alpha": 0.5}, output={"reactions": True})
    panels = rwmf.plot.envelope(rwmf.simulate(case), case)
    assert [list(ax.lines[0].get_ydata()) for ax in panels] == [[0.0, 2.0]] * 2


def test_complaints() -> None:
    """A dataset without envelopes, and a case without a wall."""
    case = _case("full", has_mass=False)
    with pytest.raises(rwmf.InputError, match="has no wall_shear_base_max: must be the dataset of"):
        rwmf.plot.envelope(rwmf.simulate(case.replace(output={"reactions": False})), case)
    with pytest.raises(rwmf.InputError, match="the case has no &wall"):
        rwmf.plot.envelope_quantities(case.without("wall", "cable", "impact"))
