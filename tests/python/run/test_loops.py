"""Force-displacement loops: their areas equal the spring energies of the ledger."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from dimensional import groups_of
from rwmf import plot
from rwmf.figures import image_files as figures
from scenes import bare_frame, block

CASE = rwmf.Case.from_namelist(ROOT / "inputs" / "which_spring_takes_the_energy.nml")
# trapezoids between rows of 0.2 ms: corners of the loops lie between two rows
AREA = 1e-6


@pytest.mark.parametrize("law", ["linear", "truss"])
@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
@pytest.mark.parametrize("kind", ["one_sine", "one_cosine"])
def test_areas_are_the_ledger(kind: str, formulation: str, law: str) -> None:
    """The work of all springs is their stored energy at the end plus the dissipated energy."""
    changes = {"model": {"formulation": formulation}, "cable": {"law": law}}
    case = CASE.replace(**changes, motion={"kind": kind}, solver={"rtol": 1e-10})
    run = rwmf.simulate(case, dt=2e-4)
    found = {loop.spring: loop for loop in plot.find_loops(run, case)}
    assert list(found) == ["frame", "cable", "left fuse", "right fuse"]
    weights = {"frame": case.frame.gamma * case.model.g}
    work = sum(weights.get(name, case.model.g) * loop.work for name, loop in found.items())
    parts = ("strain", "cable", "effects", "hysteretic")
    ledger = sum(float(run[f"energy_{part}_J_per_kg"]) for part in parts)
    assert float(run["energy_hysteretic_J_per_kg"]) > 0.5
    assert work == pytest.approx(ledger, rel=AREA)


def test_displacements() -> None:
    """Elongation and uplift follow from the geometry of a rotated wall."""
    run = rwmf.simulate(CASE, dt=0.01)
    theta = run["theta"].values
    h, b = CASE.wall.h, CASE.wall.b
    found = {loop.spring: loop.displacement for loop in plot.find_loops(run, CASE)}
    side = np.sign(theta)
    phi = np.abs(theta)
    # from the pivot, with the wall turned by phi: its other corner and the middle of its top
    corner = 2 * b * np.stack([np.cos(phi) - 1, np.sin(phi)])
    assert found["left fuse"] == pytest.approx(np.where(side > 0, np.hypot(*corner), 0), abs=1e-15)
    assert found["right fuse"] == pytest.approx(np.where(side < 0, np.hypot(*corner), 0), abs=1e-15)
    top = [-b * np.cos(phi) + 2 * h * np.sin(phi), b * np.sin(phi) + 2 * h * np.cos(phi)]
    length = np.hypot(top[0] + b, top[1])
    assert found["cable"] == pytest.approx(length - 2 * h, abs=1e-14)


def test_a_bare_frame_has_one_panel(tmp_path: Path) -> None:
    case = bare_frame(yielding={"u_y": 0.01, "law": "bouc_wen"})
    run = rwmf.simulate(case, dt=0.005)
    assert [loop.spring for loop in plot.find_loops(run, case)] == ["frame"]
    assert plot.loops(run, case).shape == (1,)
    figures.save_loops(run, case, tmp_path / "loops.svg")
    assert (tmp_path / "loops.svg").stat().st_size > 1000


def test_what_has_no_loops() -> None:
    with pytest.raises(rwmf.InputError, match="no history"):
        plot.find_loops(rwmf.simulate(CASE), CASE)
    with pytest.raises(rwmf.InputError, match="need a spring"):
        plot.find_loops(rwmf.simulate(block(), dt=0.1), block())
    run = rwmf.simulate(CASE, dt=0.1)
    forces = [name for name in run.data_vars if "force_over" in str(name)]
    with pytest.raises(rwmf.InputError, match="no force of a spring"):
        plot.find_loops(run.drop_vars(forces), CASE)


@pytest.mark.parametrize("has_masses", [True, False])
def test_storeys_have_loops(has_masses: bool) -> None:
    """Their areas are the work done on the storeys; forces are in kN where masses are known."""
    case = rwmf.Case(**groups_of("storeys full")).replace(output={"reactions": True})
    if has_masses:
        case = case.replace(wall={"m_w": 2.0e4})
    run = rwmf.simulate(case, dt=1e-3)
    found = {loop.spring: loop for loop in plot.find_loops(run, case)}
    n = run.sizes["storey"]
    assert [name for name in found if name.startswith("storey")] == [
        f"storey {i}" for i in range(1, n + 1)
    ]
    for i in range(1, n + 1):
        loop = found[f"storey {i}"]
        height = float(run["storey_height"].sel(storey=i))
        assert loop.displacement == pytest.approx(height * run[f"storey_{i}_drift"].values)
        assert loop.force == pytest.approx(run[f"storey_{i}_shear_over_m_w_g"].values)
        assert (loop.newtons is not None) == has_masses
        if loop.newtons is not None:
            assert loop.newtons == pytest.approx(run[f"storey_{i}_shear"].values)
    panels = plot.loops(run, case)
    assert panels[0].get_title() == "Storeys"
    assert len(panels[0].get_legend().get_texts()) == n
    for ax in panels:
        assert ax.get_xlabel().endswith("(mm)")
        assert (ax.get_ylabel() == "force (kN)") == has_masses
        assert ax.get_title() in ("Storeys", "Tendon", "Fuses")
    loop = found["storey 1"]
    force = loop.force if loop.newtons is None else 1e-3 * loop.newtons
    assert panels[0].lines[0].get_ydata() == pytest.approx(force)
    assert panels[0].lines[0].get_xdata() == pytest.approx(1e3 * loop.displacement)
