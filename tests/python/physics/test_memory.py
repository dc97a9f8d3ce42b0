"""Wall and frame with springs that yield or break: losses of strength, limits, rules.

`tests/robustness/test_hard_combinations.py` has ledger, methods and mirror image of random scenes.
"""

import math

import numpy as np
import pytest
import rwmf
from refused import refusals
from scenes import coupled
from scipy.optimize import brentq

METHODS = ("adams", "bdf", "taylor", "dop853")


def test_loss_of_prestress() -> None:
    """A tendon stretched over its yield in one swing has lost that stretch, at every later pass."""
    theta = 0.3 * math.atan(0.25)
    case = coupled(
        cable={"eta_y": 1.5},
        frame={"xi_s": 0.0},
        motion={"kind": "none", "a_max_g": None, "omega_p": None},
        initial={"theta_over_alpha": 0.3},
        solver={"t_end": 10.0},
    )
    run = rwmf.simulate(case, dt=0.01)
    # at 0.3 alpha the elastic force would be 1 + 4*0.3
    loss = 1 + 4 * 0.3 - 1.5
    assert float(run["cable_prestress_loss_over_m_w_g"]) == pytest.approx(loss, rel=1e-12)
    assert float(run["cable_force_increment_max_over_m_w_g"]) == pytest.approx(0.5, rel=1e-12)
    expected = np.maximum(0, 1.5 + 4 / math.atan(0.25) * (np.abs(run["theta"].values) - theta))
    assert np.allclose(run["cable_force_over_m_w_g"].values, expected, atol=1e-12)


def test_rupture_in_the_first_swing() -> None:
    """The tendon ruptures at its strain, with an event, and the wall continues without a cable."""
    strain = 0.012
    case = coupled(cable={"eta_y": None, "law": "truss", "rupture_strain": strain})
    run = rwmf.simulate(case, dt=0.01)
    kinds = list(run["event"].values)
    assert bool(run["cable_ruptured"])
    assert kinds.count("rupture") == 1
    at = float(run["event_theta"].values[kinds.index("rupture")])
    h, b, phi = 2.0, 0.5, abs(at)
    rise = math.sqrt(4 * h**2 + 2 * b**2 * (1 - math.cos(phi)) + 4 * h * b * math.sin(phi)) - 2 * h
    alpha = math.atan(0.25)
    at_alpha = (
        math.sqrt(4 * h**2 + 2 * b**2 * (1 - math.cos(alpha)) + 4 * h * b * math.sin(alpha)) - 2 * h
    )
    assert rise + at_alpha / 4 == pytest.approx(2 * h * strain, rel=1e-12)
    after = run["time"].values > float(run["event_time"].values[kinds.index("rupture")])
    assert np.all(run["cable_force_over_m_w_g"].values[after] == 0)
    assert float(run["cable_prestress_loss_over_m_w_g"]) == 1


def test_fuses_hold_the_wall_up_on_one_side() -> None:
    """A wall released at 0.5 alpha descends to the equilibrium of fuse, weight and cable.

    The damper lets it creep there. The fuse, drawn out to s_0 and perfectly plastic, gives
    F = eta_y - k (s_0 - s) and no less than -eta_y: 2 sin(alpha) cos(theta/2) F + sin(alpha -
    theta) + eta_0 sin(alpha) = 0.
    """
    eta_y, stroke_y, eta_0 = 1.1, 0.01, 1.0
    alpha, b = math.atan2(0.5, 2.0), 0.5

    def stroke(theta: float) -> float:
        return 4 * b * math.sin(theta / 2)

    def moment(theta: float) -> float:
        force = eta_y - eta_y / stroke_y * (stroke(alpha / 2) - stroke(theta))
        cable = eta_0 * math.sin(alpha)
        return 2 * math.sin(alpha) * math.cos(theta / 2) * force + cable + math.sin(alpha - theta)

    end = brentq(moment, 1e-6, alpha / 2)
    quiet = {"kind": "none", "a_max_g": None, "omega_p": None}
    case = coupled(
        motion=quiet,
        initial={"theta_over_alpha": 0.5},
        frame=None,
        cable={"eta_0": eta_0, "eta_alpha": eta_0},
        damper={"c_over_m_w": 300.0},
        fuse={"eta_y": eta_y, "stroke_y": stroke_y},
        solver={"t_end": 60.0, "rtol": 1e-11, "method": "dop853"},
        output={"energy": True, "reactions": True},
    )
    run = rwmf.simulate(case, dt=60.0)
    assert float(run["theta_end_over_alpha"]) == pytest.approx(end / alpha, rel=1e-8)
    assert int(run["impacts"]) == 0
    assert float(run["energy_balance_relative"]) < 1e-8
    assert "the wall need not come down again" in run.attrs["warnings"]
    # weight and cable at the end, less the force of the other corner's fuse along its chord
    force = float(run["fuse_left_force_over_m_w_g"][-1])
    bears = 1 + eta_0 * math.cos(end) + force * math.cos(end / 2)
    assert float(run["pivot_normal_over_m_w_g"][-1]) == pytest.approx(bears, rel=1e-6)
    # the moment of weight and cable there is three quarters of that on the base
    weak = rwmf.simulate(case.replace(fuse={"eta_y": 0.7}))
    assert float(weak["theta_end_over_alpha"]) == 0
    assert "fuse" not in weak.attrs["warnings"]


@pytest.mark.parametrize("eta_y", [1.2, 4.0])
def test_a_wall_on_both_fuses_is_refused(eta_y: float) -> None:
    """Drawn out on both sides, fuses with 2 eta_y > 1 + eta_0 leave no corner on the ground."""
    case = coupled(
        fuse={"eta_y": eta_y, "stroke_y": 0.004},
        solver={"rtol": 1e-10},
        output={"reactions": True},
    )
    instants = []
    for method in METHODS:
        with pytest.raises(
            rwmf.RwmfError, match="stands on its fuses, couplings or restraints at t = "
        ) as failure:
            rwmf.simulate(case.replace(solver={"method": method}))
        instants.append(float(str(failure.value).split("t = ")[1].split(" s")[0]))
    assert instants == pytest.approx([instants[0]] * len(METHODS), rel=1e-7)
    # until then the ground bears the wall, and from then on it would have to pull
    before = rwmf.simulate(case.replace(solver={"t_end": 0.8 * instants[0]}))
    assert float(before["pivot_normal_min_over_m_w_g"]) > 0
    weak = rwmf.simulate(case.replace(fuse={"eta_y": 0.99}, solver={"t_end": 40.0}))
    assert float(weak["theta_end_over_alpha"]) == 0


def test_hinged_wall_with_a_yielding_frame() -> None:
    hinged = {"cable": None, "impact": None, "wall": {"base": "pinned"}}
    case = coupled(**hinged, yielding={"u_y": 0.02, "hardening": 0.02}, output={"energy": True})
    run = rwmf.simulate(case)
    assert float(run["ductility"]) > 2
    assert float(run["energy_balance_relative"]) < 1e-8
    strong = rwmf.simulate(case.replace(yielding={"u_y": 1e3}))
    plain = rwmf.simulate(case.replace(yielding=None))
    assert float(strong["u_s_max"]) == pytest.approx(float(plain["u_s_max"]), rel=1e-9)


def test_published_with_a_yielding_frame() -> None:
    """Up to the first impact to the right the published equation is that of `symmetric`."""
    changes = {
        "motion": {"kind": "none", "a_max_g": None, "omega_p": None},
        "initial": {"theta_over_alpha": 0.4},
        "yielding": {"u_y": 0.05, "hardening": 0.05},
        "solver": {"t_end": 0.25},
    }
    found = [
        rwmf.simulate(coupled(model={"formulation": name}, **changes), dt=0.25)
        for name in ("published", "symmetric")
    ]
    assert int(found[0]["impacts"]) == 0
    assert float(found[0]["ductility"]) > 1
    assert float(found[0]["theta"][-1]) == pytest.approx(float(found[1]["theta"][-1]), rel=1e-8)


def test_spectrum_of_equal_strength() -> None:
    """Each ordinate is a separate run: widths, fuses, tendon and strength included."""
    case = coupled(
        frame={"T_s": None},
        cable={"eta_y": 1.4},
        fuse={"eta_y": 0.2, "stroke_y": 0.005},
        yielding={"f_y_over_m_s_g": 0.1},
        solver={"method": "dop853"},
        spectrum={"T_s_min": 0.5, "T_s_max": 1.5, "n": 3, "b": [0.4, 0.6]},
    )
    spectrum = rwmf.spectrum(case)
    for T_s in spectrum["T_s"].values:
        for b in (0.4, 0.6):
            one = case.replace(
                frame={"T_s": float(T_s)},
                wall={"b": b},
                yielding={
                    "f_y_over_m_s_g": None,
                    "u_y": 0.1 * 9.81 * (float(T_s) / 2 / math.pi) ** 2,
                },
                spectrum=None,
            )
            ordinate = spectrum["u_s_max"].sel(T_s=T_s, b=b).values.item()
            assert ordinate == pytest.approx(float(rwmf.simulate(one)["u_s_max"]), rel=1e-9)


_EXACT = {"model": {"formulation": "exact"}}
_REFUSED = [
    ({"yielding": {"hardening": 0.1}}, "exactly one of the keys u_y and f_y_over_m_s_g"),
    ({"yielding": {"u_y": 0.1, "f_y_over_m_s_g": 0.1}}, "must not be given beside u_y"),
    ({"yielding": {"u_y": 0.1}, "link": {"L": 5.0}, **_EXACT}, "overturning_angle <= "),
    ({"cable": {"hardening": 0.1}}, "must not be given without eta_y"),
    ({"cable": {"eta_y": 0.9}}, "must be > eta_0 = 1"),
    ({"cable": {"eta_y": 2.0, "eta_alpha": 1.0}}, "needs eta_alpha > eta_0"),
    ({"cable": {"rupture_strain": 1e-3}}, "the strain of the prestress"),
    ({"cable": {"eta_y": 2.0}, "model": {"formulation": "published"}}, "falls with rocking"),
    ({"fuse": {"eta_y": 1.0}}, "stroke_y"),
]


test_refused = refusals(
    lambda changes: coupled(**changes),
    *_REFUSED,
)


def test_short_link_up_to_the_rotation_that_it_allows() -> None:
    changes = {"yielding": {"u_y": 0.02}, "link": {"L": 2.0}, **_EXACT}
    with pytest.raises(rwmf.InputError) as refused:
        coupled(**changes | {"model": {"formulation": "exact", "overturning_angle": 1.0}})
    limit = float(str(refused.value).split("overturning_angle <= ")[1].split(" ")[0])
    # there the far end of the link turns back
    u = [4 * math.sin(phi) - 2 + math.sqrt(4 - (4 * (1 - math.cos(phi))) ** 2)
         for phi in (limit - 1e-3, limit, limit + 1e-3)]  # fmt: skip
    assert max(u) == u[1]
    case = coupled(**changes | {"model": {"formulation": "exact", "overturning_angle": limit}},
                   output={"energy": True})  # fmt: skip
    assert float(rwmf.simulate(case)["energy_balance_relative"]) < 1e-8
