"""The model against stored histories of engines that know no kinematics and no restitution."""

import importlib
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from reproduce import six_storeys
from reproduce.engines import (
    COLUMNS,
    RIGID,
    VALIDATION,
    VARIANTS,
    EngineHistory,
    agrees,
    compare,
    crossings,
    fitted_restitution,
    read,
    tolerance,
    write,
)
from reproduce.six_storeys import CASES, FULL, compare_frame, peaks_of, read_peaks

EXACT, LINEAR, SYMMETRIC, PUBLISHED = VARIANTS
RIGID_STORED = [(engine, name) for engine in RIGID for name in VALIDATION]
STORED = [*RIGID_STORED, ("calculix", "g5"), ("calculix", "g1800")]
# the engine's restitution against the momentum balance: contact takes 0.5 ms, not no time
RESTITUTION = 2e-4
# drifts and accelerations of storeys, over their peaks
STOREYS = 1e-3
# the engine again, another build of the same version or a later one: far below the tolerance
AGAIN = 5e-4


def case(name: str) -> rwmf.Case:
    return rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")


def stored(engine: str, name: str) -> EngineHistory:
    return read(ROOT / "validation" / engine / f"{name}.csv")


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
    if engine in RIGID and name in ("g5", "disc"):
        assert found.theta_rms > 0.1
        assert found.u_s_rms > 0.1


def test_deformable_wall_in_the_cases_asked_for() -> None:
    """The first 1.2 s of g5 and all of the paper's own case, with contact."""
    for name, until in (("g5", 1.2), ("g1800", 6.0)):
        history = stored("calculix", name)
        assert history["t_s"][-1] == pytest.approx(until, abs=2e-3)
        assert history.facts["support"] == "nodes"


@pytest.mark.parametrize("engine", RIGID)
@pytest.mark.parametrize("variant", [LINEAR, SYMMETRIC])
def test_disc_tells_arm_and_cable_apart(variant: str, engine: str) -> None:
    response = rwmf.simulate(case("disc").replace(**VARIANTS[variant]))
    found = compare(response, stored(engine, "disc"))
    assert not agrees(found, tolerance(engine, "disc")), found
    assert found.theta_rms > 0.01


@pytest.mark.parametrize(("engine", "name"), [x for x in RIGID_STORED if x[1] != "g1800"])
def test_engine_has_the_restitution_of_the_momentum_balance(engine: str, name: str) -> None:
    allowed = float(rwmf.simulate(case(name))["e_max"])
    found = fitted_restitution(case(name), stored(engine, name))
    assert found == pytest.approx(allowed, abs=RESTITUTION)


@pytest.mark.parametrize(("engine", "name"), STORED)
def test_history_names_engine_and_parameters(engine: str, name: str) -> None:
    facts = stored(engine, name).facts
    names = {"mujoco": "MuJoCo ", "opensees": "OpenSees ", "calculix": "CalculiX "}
    assert str(facts["engine"]).startswith(names[engine])
    assert {"dt", "stiffness" if engine == "opensees" else "friction"} <= set(facts)
    # a wall that slides is not the scene of the model; the deformable one does a little at a blow
    assert facts["slip_max_m"] < (1e-3 if engine in RIGID else 2e-3)


def frame(name: str, elcentro: Path) -> rwmf.Case:
    found = case(name)
    if found.motion.kind == "record":
        found = found.replace(motion={"file": str(elcentro)})
    return found


def stored_peaks(name: str) -> dict[str, np.ndarray]:
    return read_peaks(ROOT / "validation" / "opensees" / f"{name}_peaks.csv")


@pytest.mark.parametrize("name", CASES)
def test_six_storeys_follow_opensees(name: str, elcentro: Path) -> None:
    """Drift of every storey and acceleration of every floor, at all times and at the peaks."""
    history = stored("opensees", name)
    found = compare_frame(frame(name, elcentro), history, stored_peaks(name)[FULL])
    assert len(found.peak) == 12
    assert found.peak.max() < STOREYS
    assert found.history.max() < STOREYS


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("less", six_storeys.VARIANTS)
def test_what_yielding_and_p_delta_are_worth(name: str, less: str, elcentro: Path) -> None:
    peaks = stored_peaks(name)
    ours = peaks_of(six_storeys.variant(frame(name, elcentro), less))
    assert ours == pytest.approx(peaks[less], rel=STOREYS)
    # the control: each of the others is another frame
    for other in set(six_storeys.VARIANTS) - {less}:
        assert np.abs(ours / peaks[other] - 1).max() > 10 * STOREYS, other


def test_damaged_peaks(tmp_path: Path) -> None:
    path = tmp_path / "peaks.csv"
    path.write_text("peak,neither\nstorey_1_drift,high\n", encoding="utf-8")
    with pytest.raises(rwmf.InputError, match="not a table of peaks"):
        read_peaks(path)


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


def test_rigid_engine_again() -> None:
    """An installed engine reproduces its stored history."""
    pytest.importorskip("mujoco")
    module = importlib.import_module("mujoco_cases")
    engine = module.Engine()
    rows, _ = module.simulate(case("g5"), engine)
    expected = stored("mujoco", "g5")
    difference = rows[:: round(engine.stored_interval / engine.dt), 1] - expected["theta_rad"]
    assert np.abs(difference).max() < AGAIN * np.abs(expected["theta_rad"]).max()
