"""All effects at once, in combinations that hypothesis chooses."""

from __future__ import annotations

import math

import numpy as np
import pytest
import rwmf
from hypothesis import given, settings
from hypothesis import strategies as st

# the examples are the same in every run; the number keeps the suite short
_PROFILE = settings(max_examples=60, deadline=None, derandomize=True, database=None)
BALANCE = 1e-6
AGREEMENT = 1e-6  # of the peak among methods
# the resting wall's drive has another sign; what is left is the tolerance of the run
MIRROR = 1e-7
LIMIT = 1e-9  # what the steps of two runs at rtol 1e-13 leave


def _maybe(keys: dict[str, st.SearchStrategy[object]]) -> st.SearchStrategy[dict | None]:
    return st.none() | st.fixed_dictionaries(keys)


_CABLE = {
    "eta_0": st.just(1.0),
    "eta_alpha": st.floats(2.0, 12.0),
    "law": st.sampled_from(["linear", "truss"]),
}
_EFFECTS = st.fixed_dictionaries(
    {
        "cable": st.one_of(
            st.none(),
            st.fixed_dictionaries(_CABLE),
            st.fixed_dictionaries(
                _CABLE | {"eta_y": st.floats(1.1, 1.6), "hardening": st.sampled_from([0.0, 0.02])}
            ),
        ),
        "link": _maybe({"L": st.floats(8.0, 30.0)}),
        "damper": _maybe({"c_over_m_w": st.floats(0.05, 2.0)}),
        "fuse": _maybe(
            {
                # two fuses together bear less than the weight: else they hold the wall up
                "eta_y": st.floats(0.05, 0.4),
                "stroke_y": st.floats(1e-3, 1e-2),
                "hardening": st.sampled_from([0.0, 0.05]),
            }
        ),
        "yielding": _maybe({"u_y": st.floats(3e-3, 5e-2), "hardening": st.sampled_from([0.0, 0.1])})
        | _maybe({"u_y": st.floats(3e-3, 5e-2), "law": st.just("bouc_wen")}),
        "inerter": _maybe({"inertance_over_m_w": st.floats(0.1, 10.0)}),
        "vertical": _maybe({"ratio": st.floats(-0.7, 0.7)}),
        "impact": st.sampled_from(
            [
                {"e": 0.8},
                {"rule": "coupled"},
                {"rule": "table", "table_theta_dot": [0.05, 0.8], "table_e": [0.95, 0.7]},
            ]
        ),
        "frame": st.fixed_dictionaries(
            {
                "T_s": st.floats(0.2, 2.0),
                "gamma": st.floats(0.5, 100.0),
                "xi_s": st.sampled_from([0.0, 0.05]),
            }
        ),
        "model": st.fixed_dictionaries(
            {
                "formulation": st.sampled_from(["symmetric", "exact"]),
                "overturning_angle": st.just(0.9),
            }
        ),
        "motion": st.fixed_dictionaries(
            {
                "kind": st.sampled_from(["one_sine", "one_cosine", "ricker"]),
                "a_max_g": st.floats(0.1, 0.9),
                "T_p": st.floats(0.4, 1.5),
            }
        ),
    }
)


def _case(groups: dict[str, dict | None], method: str = "dop853", **more: object) -> rwmf.Case:
    given_groups = {name: keys for name, keys in groups.items() if keys is not None}
    return rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        solver={"t_end": 4.0, "method": method, "rtol": 1e-10},
        **given_groups,
        **more,
    )


@_PROFILE
@given(_EFFECTS)
def test_energy_closes(groups: dict[str, dict | None]) -> None:
    """Work of the ground is what is stored and what is dissipated, by name."""
    run = rwmf.simulate(_case(groups, output={"energy": True}))
    assert float(run["energy_balance_relative"]) < BALANCE
    for name in ("energy_viscous_J_per_kg", "energy_hysteretic_J_per_kg", "energy_impact_J_per_kg"):
        if name in run:
            assert float(run[name]) >= -1e-12, name


@_PROFILE
@given(_EFFECTS)
def test_hinged_wall(groups: dict[str, dict | None]) -> None:
    """The same, all but cable and impact: the ledger closes and two methods agree."""
    groups = groups | {"cable": None, "impact": None}
    runs = [
        rwmf.simulate(
            _case(groups, method, output={"energy": True}).replace(wall={"base": "pinned"})
        )
        for method in ("dop853", "bdf")
    ]
    assert abs(float(runs[0]["energy_balance_relative"])) < BALANCE
    peaks = [float(run["u_s_max"]) for run in runs]
    assert peaks == pytest.approx([peaks[0]] * 2, rel=AGREEMENT, abs=1e-12)


@_PROFILE
@given(_EFFECTS)
def test_methods_agree(groups: dict[str, dict | None]) -> None:
    peaks = [
        float(rwmf.simulate(_case(groups, method))["u_s_max"])
        for method in ("dop853", "erk54", "bdf")
    ]
    assert peaks == pytest.approx([peaks[0]] * 3, rel=AGREEMENT, abs=1e-12)


@_PROFILE
@given(_EFFECTS)
def test_mirror(groups: dict[str, dict | None]) -> None:
    """`symmetric`: the opposite motion, the vertical one as before, gives the opposite rotation."""
    groups = groups | {"model": {"formulation": "symmetric", "overturning_angle": 0.9}}
    opposite = groups | {"motion": groups["motion"] | {"a_max_g": -groups["motion"]["a_max_g"]}}
    if groups["vertical"] is not None:
        opposite["vertical"] = {"ratio": -groups["vertical"]["ratio"]}
    one, other = (rwmf.simulate(_case(x), dt=0.05)["theta"].values for x in (groups, opposite))
    assert np.array_equal(np.isnan(one), np.isnan(other))
    assert np.nanmax(np.abs(one + other)) <= MIRROR * max(np.nanmax(np.abs(one)), 1e-9)


# an effect, the value that makes it vanish, and what is left without it
_LIMITS = {
    "link": ({"link": {"L": 1e12}}, {}),
    "cable": ({"cable": {"eta_y": 1e9}}, {}),
    "cable, truss": (
        {"cable": {"law": "truss", "eta_y": 1e9}},
        {"cable": {"law": "truss"}},
    ),
    "cable, strain": ({"cable": {"rupture_strain": 1e9}}, {}),
    "yielding": ({"yielding": {"u_y": 1e9}}, {}),
    "fuse": ({"fuse": {"eta_y": 1e-15, "stroke_y": 0.01}}, {}),
    "damper": ({"damper": {"c_over_m_w": 0.0}}, {}),
    "inerter": ({"inerter": {"inertance_over_m_w": 0.0}}, {}),
    "vertical": ({"vertical": {"ratio": 0.0}}, {}),
    "table": (
        {
            "impact": {
                "rule": "table",
                "e": None,
                "table_theta_dot": [0.1, 2.0],
                "table_e": [0.9, 0.9],
            }
        },
        {},
    ),
}


@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
@pytest.mark.parametrize("limit", _LIMITS)
def test_limit(limit: str, formulation: str) -> None:
    """The scene without the effect, but for round-off: same events, same peaks."""
    with_it, without = _LIMITS[limit]
    scene = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        frame={"T_s": 0.8, "gamma": 5.0, "xi_s": 0.05},
        cable={"eta_0": 1.0, "eta_alpha": 5.0},
        impact={"rule": "constant", "e": 0.9},
        motion={"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * math.pi},
        model={"formulation": formulation},
        solver={"t_end": 3.0, "method": "dop853", "rtol": 1e-13},
    )
    run = rwmf.simulate(scene.replace(**with_it), dt=3.0)
    plain = rwmf.simulate(scene.replace(**without), dt=3.0)
    assert int(plain["impacts"]) > 3
    for name in ("u_s_max", "theta_dot_max"):
        assert float(run[name]) == pytest.approx(float(plain[name]), rel=LIMIT), name
    impacts = [x["event_time"].values[x["event"].values == "impact"][:4] for x in (run, plain)]
    assert impacts[0] == pytest.approx(impacts[1], rel=LIMIT)
