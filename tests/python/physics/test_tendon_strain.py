"""Largest strain of the tendon: prestress and elongation over its length, in every law."""

import math
from typing import Any

import pytest
import rwmf

H, B, E = 4.0, 1.0, 195.0e9
ALPHA = math.atan2(B, H)


def _case(**cable: float | str | None) -> rwmf.Case:
    strands: dict[str, Any] = {
        "strands": 8,
        "strand_area": 150e-6,
        "modulus": E,
        "initial_stress": 600e6,
    }
    return rwmf.Case(
        wall={"h": H, "b": B, "m_w": 2.0e4},
        frame={"T_s": 0.8, "m_s": 1.0e5, "xi_s": 0.05},
        cable=strands | cable,
        impact={"rule": "coupled"},
        motion={"kind": "one_sine", "a_max_g": 0.6, "T_p": 0.9},
        model={"formulation": "exact"},
        solver={"t_end": 2.0},
        limits={"tendon_strain_max": 0.01},
    )


def _elongation(law: str, phi: float) -> float:
    if law == "linear":
        return B * phi
    return math.sqrt(4 * H**2 + 2 * B**2 * (1 - math.cos(phi)) + 4 * H * B * math.sin(phi)) - 2 * H


@pytest.mark.parametrize("law", ["linear", "truss"])
@pytest.mark.parametrize("length", [None, 12.0])
@pytest.mark.parametrize("yields", [False, True])
def test_prestress_and_elongation(law: str, length: float | None, *, yields: bool) -> None:
    """The strain follows the largest rotation; an elastic one is the stress over the modulus."""
    case = _case(law=law, length=length, yield_stress=900e6 if yields else None)
    run = rwmf.simulate(case)
    phi = float(run["theta_max_over_alpha"]) * ALPHA
    expected = 600e6 / E + _elongation(law, phi) / (length or 2 * H)
    found = float(run["tendon_strain_max"])
    assert found == pytest.approx(expected, rel=1e-13)
    stress = float(run["tendon_stress_max"])
    assert (found > 1.1 * stress / E) if yields else found == pytest.approx(stress / E, rel=1e-13)
    assert rwmf.checks(case, run).rows[0].demand == found


def test_it_breaks_at_its_rupture_strain() -> None:
    """With ratios as well: the prestrain follows from the stiffness."""
    ratios = {"eta_0": 1.0, "eta_alpha": 4.0, "rupture_strain": 0.05}
    gone = dict.fromkeys(("strands", "strand_area", "modulus", "initial_stress"))
    case = _case(**gone, **ratios)
    run = rwmf.simulate(case)
    phi = float(run["theta_max_over_alpha"]) * ALPHA
    strain = B * (ALPHA / 3 + phi) / (2 * H)
    assert float(run["tendon_strain_max"]) == pytest.approx(strain, rel=1e-13)
    broken = rwmf.simulate(case.replace(cable={"rupture_strain": 0.9 * strain}))
    assert bool(broken["cable_ruptured"])
    assert float(broken["tendon_strain_max"]) == 0.9 * strain


def test_published_falls_on_one_side() -> None:
    """Eq. (1) as printed: the strain is that of the largest force."""
    run = rwmf.simulate(_case(law="linear").replace(model={"formulation": "published"}))
    assert float(run["tendon_strain_max"]) == pytest.approx(
        float(run["tendon_stress_max"]) / E, rel=1e-13
    )


def test_unknown_without_a_length() -> None:
    gone = dict.fromkeys(("strands", "strand_area", "modulus", "initial_stress"))
    with pytest.raises(
        rwmf.InputError, match=r"tendon_strain_max.*needs strands or rupture_strain"
    ):
        _case(**gone, eta_0=1.0, eta_alpha=4.0)
