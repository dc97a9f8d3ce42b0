"""The model against stored histories of engines that know no kinematics and no restitution."""

from __future__ import annotations

import importlib
import shutil
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from reproduce.engines import COLUMNS, EngineHistory, compare, crossings, read, write
from reproduce.histories import VALIDATION
from reproduce.validation import VARIANTS, agrees, fitted_restitution, tolerance

EXACT, LINEAR, SYMMETRIC, PUBLISHED = VARIANTS
STORED = [("mujoco", name) for name in VALIDATION] + [("calculix", n) for n in ("g5", "g1800")]
# the engine's restitution against the momentum balance: contact takes 0.5 ms, not no time
RESTITUTION = 2e-4
# the engine again, another build of the same version or a later one: far below the tolerance
AGAIN = 5e-4


def case(name: str) -> rwmf.Case:
    return rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")


def stored(engine: str, name: str) -> EngineHistory:
    return read(ROOT / "validation" / engine / f"{name}.csv")


def mujoco(name: str) -> EngineHistory:
    return stored("mujoco", name)


@pytest.mark.parametrize(("engine", "name"), STORED)
def test_exact_form_follows_the_engine(engine: str, name: str) -> None:
    found = compare(rwmf.simulate(case(name)), stored(engine, name))
    assert agrees(found, tolerance(engine, name)), found


@pytest.mark.parametrize(("engine", "name"), STORED)
def test_published_form_fails(engine: str, name: str) -> None:
    """The control: a comparison that the published form passes would show nothing."""
    changes = dict(VARIANTS[PUBLISHED])
    if case(name).cable is None:
        del changes["cable"]
    found = compare(rwmf.simulate(case(name).replace(**changes)), stored(engine, name))
    assert not agrees(found, tolerance(engine, name)), found
    if engine == "mujoco" and name in ("g5", "disc"):
        assert found.theta_rms > 0.1
        assert found.u_s_rms > 0.1


def test_deformable_wall_in_the_cases_asked_for() -> None:
    """The first 1.2 s of g5 and all of the paper's own case, with contact."""
    for name, until in (("g5", 1.2), ("g1800", 6.0)):
        history = stored("calculix", name)
        assert history["t_s"][-1] == pytest.approx(until, abs=2e-3)
        assert history.facts["support"] == "nodes"


@pytest.mark.parametrize("variant", [LINEAR, SYMMETRIC])
def test_disc_tells_arm_and_cable_apart(variant: str) -> None:
    response = rwmf.simulate(case("disc").replace(**VARIANTS[variant]))
    found = compare(response, mujoco("disc"))
    assert not agrees(found, tolerance("mujoco", "disc")), found
    assert found.theta_rms > 0.01


@pytest.mark.parametrize("name", ["free", "block", "g5", "disc"])
def test_engine_has_the_restitution_of_the_momentum_balance(name: str) -> None:
    allowed = float(rwmf.simulate(case(name))["e_max"])
    found = fitted_restitution(case(name), mujoco(name))
    assert found == pytest.approx(allowed, abs=RESTITUTION)


@pytest.mark.parametrize(("engine", "name"), STORED)
def test_history_names_engine_and_parameters(engine: str, name: str) -> None:
    facts = stored(engine, name).facts
    assert str(facts["engine"]).startswith({"mujoco": "MuJoCo ", "calculix": "CalculiX "}[engine])
    assert {"dt", "friction"} <= set(facts)
    # a wall that slides is not the scene of the model; the deformable one does a little at a blow
    assert facts["slip_max_m"] < {"mujoco": 1e-3, "calculix": 2e-3}[engine]


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


def test_written_history_is_read_again(tmp_path: Path) -> None:
    rows = np.array([[0.0, 1e-7, -2.0, 3.0, 0.0, np.nan], [0.5, 1 / 3, 0.25, 0.0, 1e-3, np.nan]])
    write(tmp_path / "history.csv", {"engine": "none"}, rows)
    found = read(tmp_path / "history.csv")
    assert found.facts == {"engine": "none"}
    assert list(found.columns) == list(COLUMNS[:5])
    assert np.column_stack(list(found.columns.values())) == pytest.approx(rows[:, :5], rel=1e-5)


def _bench_module(folder: str, name: str) -> ModuleType:
    sys.path.insert(0, str(ROOT / folder))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.pop(0)


def test_rigid_engine_again() -> None:
    """Where the engine is installed, it computes its stored history again."""
    pytest.importorskip("mujoco")
    module = _bench_module("bench", "mujoco_cases")
    _, rows = module.simulate(case("g5"), module.Engine())
    expected = mujoco("g5")
    difference = rows[:, 1] - expected["theta_rad"]
    assert np.abs(difference).max() < AGAIN * np.abs(expected["theta_rad"]).max()


def test_finite_elements_again() -> None:
    """Where the solver is installed, it computes the beginning of its stored history again."""
    if shutil.which("ccx") is None:
        pytest.skip("the program ccx is not installed")
    module = _bench_module("bench/calculix", "run")
    _, rows = module.compute(case("g5"), module.Settings(), 0.05)
    expected = stored("calculix", "g5")["u_s_m"][: len(rows)]
    assert len(rows) >= 49
    assert np.abs(rows[:, 5] - expected).max() < AGAIN * np.abs(expected).max()


@pytest.mark.parametrize("support", ["nodes", "faces", "struts"])
def test_numbers_of_a_deck(support: str) -> None:
    """The solver takes a number without a decimal point for a degree of freedom."""
    run = _bench_module("bench/calculix", "run")
    deck = run.Deck(case("g1800"), run.Settings(support=support), 1.0)
    run.add_support(deck)
    lines = deck.text().splitlines()
    springs = [i for i, line in enumerate(lines) if line.startswith("*SPRING")]
    assert len(springs) >= 3
    for i in springs:
        first = i + 2 if lines[i + 1] == "1" else i + 1
        assert all("." in word for word in lines[first].split(","))
    numbers = [
        int(lines[i + 1].split(",")[0])
        for i, line in enumerate(lines)
        if line.startswith("*ELEMENT")
    ]
    assert numbers == list(range(1, len(numbers) + 1))
