"""Parts of the energy ledger: energies of inelastic springs and of masses."""

import math

import numpy as np
import pytest
import rwmf
from scenes import bare_frame, coupled

G = 9.81
T_S = 0.8
U_Y = 0.02


@pytest.mark.parametrize("with_wall", [False, True])
def test_a_yielding_spring_holds_what_its_force_says(with_wall: bool) -> None:
    """Perfectly plastic: f**2/(2 k), and never more than at yield."""
    make = coupled if with_wall else bare_frame
    case = make(frame={"T_s": T_S, "xi_s": 0.02}, yielding={"u_y": U_Y}, output={"energy": True})
    run = rwmf.simulate(case, dt=0.01)
    mass = float(case.frame["gamma"]) if with_wall else 1.0
    stiffness = (2 * math.pi / T_S) ** 2
    force = G * run["frame_force_over_m_s_g"].values
    assert float(run["ductility"]) > 1.5
    assert run["energy_strain"].values == pytest.approx(
        mass * force**2 / (2 * stiffness), abs=1e-12
    )
    assert float(run["energy_strain"].max()) <= mass * stiffness * U_Y**2 / 2 * (1 + 1e-12)
    assert "energy_effects" not in run
    assert float(run["energy_balance_relative"]) < 1e-8


def test_smooth_hysteresis_holds_its_elastic_part() -> None:
    """Hardening spring and z: a k u**2/2 + (1 - a) k (u_y z)**2/2."""
    a = 0.1
    law = {"u_y": U_Y, "law": "bouc_wen", "hardening": a}
    case = bare_frame(frame={"T_s": T_S, "xi_s": 0.02}, yielding=law, output={"energy": True})
    run = rwmf.simulate(case, dt=0.01)
    k = (2 * math.pi / T_S) ** 2
    u = run["u_s"].values
    z = (G * run["frame_force_over_m_s_g"].values / k - a * u) / ((1 - a) * U_Y)
    assert run["energy_strain"].values == pytest.approx(
        a * k * u**2 / 2 + (1 - a) * k * (U_Y * z) ** 2 / 2, abs=1e-12
    )


@pytest.mark.parametrize("with_wall", [False, True])
def test_storeys_hold_the_strain_of_all_storeys(with_wall: bool) -> None:
    """`full`: the springs' energy from the drifts, that of the masses from the floors' speed."""
    m, k = np.array([1.5, 1.2, 0.8]), np.array([600.0, 500.0, 400.0])
    make = coupled if with_wall else bare_frame
    changes = {} if not with_wall else {"cable": None, "wall": {"h": 5.0, "b": 1.0}}
    case = make(
        frame={"T_s": None, "gamma": None, "xi_s": 0.03},
        storeys={
            "m_over_m_w": list(m),
            "k_over_m_w": list(k),
            "height": [10.0 / 3] * 3,
            "coupling": "full",
        },
        output={"energy": True},
        **changes,
    )
    run = rwmf.simulate(case, dt=1e-3)
    unit = 1.0 if with_wall else m[-1]
    drift = np.array([run[f"storey_{i}_drift"].values for i in (1, 2, 3)]) * 10.0 / 3
    assert run["energy_strain"].values == pytest.approx(
        (k[:, None] * drift**2).sum(axis=0) / 2 / unit, abs=1e-10
    )
    if not with_wall:
        speed = np.gradient(np.cumsum(drift, axis=0), 1e-3, axis=1, edge_order=2)
        kinetic = (m[:, None] * speed**2).sum(axis=0) / 2 / unit
        assert run["energy_kinetic"].values == pytest.approx(kinetic, abs=1e-3 * kinetic.max())


@pytest.mark.parametrize("hardening", [0.0, 0.02, 0.3])
def test_a_tendon_that_breaks_holds_nothing(hardening: float) -> None:
    """The remaining energy is less by the work of the prestress, whatever the stored hardening."""
    eta_0, eta_alpha, h, b = 1.0, 5.0, 2.0, 0.5
    case = coupled(
        wall={"h": h, "b": b},
        cable={"eta_0": eta_0, "eta_alpha": eta_alpha, "eta_y": 1.6, "law": "linear"}
        | {"hardening": hardening, "rupture_strain": 0.02},
        motion={"a_max_g": 0.8},
        model={"formulation": "exact"},
        output={"energy": True},
    )
    run = rwmf.simulate(case, dt=0.01)
    kinds = list(run["event"].values)
    after = run["time"].values > float(run["event_time"][kinds.index("rupture")])
    # Eq. (1): the force grows by eta_alpha - eta_0 while the tendon is drawn out by b alpha
    drawn = eta_0 / (eta_alpha - eta_0) * b * math.atan(b / h)
    assert run["energy_cable"].values[after] == pytest.approx(-eta_0 * G * drawn / 2, rel=1e-9)
    assert float(run["energy_balance_relative"]) < 1e-8
