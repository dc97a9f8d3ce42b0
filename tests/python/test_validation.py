"""The model against stored histories of engines that know no kinematics and no restitution."""

from __future__ import annotations

import importlib
import sys
from types import ModuleType

import numpy as np
import pytest
import rwmf
from conftest import ROOT
from rwmf.reproduce.engines import EngineHistory, compare, crossings, read
from rwmf.reproduce.histories import VALIDATION
from rwmf.reproduce.validation import VARIANTS, agrees, fitted_restitution

EXACT, LINEAR, SYMMETRIC, PUBLISHED = VARIANTS
# the engine's restitution against the momentum balance: contact takes 0.5 ms, not no time
RESTITUTION = 2e-4
# the engine again, another build of the same version or a later one: far below the tolerance
AGAIN = 5e-4


def case(name: str) -> rwmf.Case:
    return rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")


def mujoco(name: str) -> EngineHistory:
    return read(ROOT / "validation" / "mujoco" / f"{name}.csv")


@pytest.mark.parametrize("name", VALIDATION)
def test_exact_form_follows_the_engine(name: str) -> None:
    found = compare(rwmf.simulate(case(name)), mujoco(name))
    assert agrees(found), found


@pytest.mark.parametrize("name", VALIDATION)
def test_published_form_fails(name: str) -> None:
    """The control: a comparison that the published form passes would show nothing."""
    changes = dict(VARIANTS[PUBLISHED])
    if case(name).cable is None:
        del changes["cable"]
    found = compare(rwmf.simulate(case(name).replace(**changes)), mujoco(name))
    assert not agrees(found), found
    if name in ("g5", "disc"):
        assert found.theta_rms > 0.1
        assert found.u_s_rms > 0.1


def test_exact_form_follows_a_deformable_wall() -> None:
    """Finite elements over 1.2 s: looser, because the wall bends; the control still fails."""
    history = read(ROOT / "validation" / "calculix" / "g5.csv")
    assert str(history.facts["engine"]).startswith("CalculiX ")
    found = compare(rwmf.simulate(case("g5")), history)
    assert agrees(found, "calculix"), found
    control = compare(rwmf.simulate(case("g5").replace(**VARIANTS[PUBLISHED])), history)
    assert not agrees(control, "calculix"), control


@pytest.mark.parametrize("variant", [LINEAR, SYMMETRIC])
def test_disc_tells_arm_and_cable_apart(variant: str) -> None:
    response = rwmf.simulate(case("disc").replace(**VARIANTS[variant]))
    found = compare(response, mujoco("disc"))
    assert not agrees(found), found
    assert found.theta_rms > 0.01


@pytest.mark.parametrize("name", ["free", "block", "g5", "disc"])
def test_engine_has_the_restitution_of_the_momentum_balance(name: str) -> None:
    allowed = float(rwmf.simulate(case(name))["e_max"])
    found = fitted_restitution(case(name), mujoco(name))
    assert found == pytest.approx(allowed, abs=RESTITUTION)


@pytest.mark.parametrize("name", VALIDATION)
def test_history_names_engine_and_parameters(name: str) -> None:
    facts = mujoco(name).facts
    assert str(facts["engine"]).startswith("MuJoCo ")
    assert {"dt", "friction", "contact_time", "link_length"} <= set(facts)
    # a wall that slides is not the scene of the model
    assert facts["slip_max_m"] < 1e-3


def test_crossings_are_between_excursions() -> None:
    t = np.linspace(0.0, 3.0, 3001)
    theta = np.sin(np.pi * t)
    assert crossings(t, theta) == pytest.approx([1.0, 2.0], abs=1e-9)
    # a flutter below 2 % of the peak is no impact
    assert crossings(t, np.where(t < 2.0, theta, -0.01 * theta)).size == 1


def test_damaged_history(tmp_path: pytest.TempPathFactory) -> None:
    path = tmp_path / "damaged.csv"
    path.write_text("# {}\nt_s,theta_rad\n0.0,zero\n", encoding="utf-8")
    with pytest.raises(rwmf.InputError, match="not a stored history"):
        read(path)


def _engine_module() -> ModuleType:
    pytest.importorskip("mujoco")
    sys.path.insert(0, str(ROOT / "bench"))
    try:
        return importlib.import_module("mujoco_cases")
    finally:
        sys.path.pop(0)


def test_engine_again() -> None:
    """Where the engine is installed, it computes its stored history again."""
    module = _engine_module()
    _, rows = module.simulate(case("g5"), module.Engine())
    stored = mujoco("g5")
    difference = rows[:, 1] - stored["theta_rad"]
    assert np.abs(difference).max() < AGAIN * np.abs(stored["theta_rad"]).max()
