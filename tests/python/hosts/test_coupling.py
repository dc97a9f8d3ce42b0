"""A wall coupled with frames of other programs, beside the kernel's own frame."""

import csv
import importlib
import importlib.util
import itertools
from collections.abc import Callable

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from rwmf.hosts import FunctionHost, OpenSeesHost, couple
from rwmf.hosts.partner import CoupledRun
from rwmf.hosts.si_building import Building

TEXT = (
    "&wall h = 2.0, b = 0.5, m_w = 2.0e4 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
    "&impact rule = 'coupled' / &motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"
    "&solver t_end = {}, rtol = 1e-10 / {}"
)
STOREYS = (
    "&wall h = 5.0, b = 1.2, m_w = 40e3 / &impact rule = 'coupled' / &frame xi_s = 0.03 /"
    "&storeys n = 3, m = 40e3, k = 40e6, height = 3.0, 3.5, 3.5, coupling = '{}' /"
    "&motion kind = 'one_sine', a_max_g = 0.6, T_p = 0.8 / &solver t_end = 1.5, rtol = 1e-10 /"
)
M, T_S, XI = 1e5, 1.0, 0.05
OMEGA = 2 * np.pi / T_S
G = 9.81


def ground(t: float) -> float:
    return float(0.4 * G * np.sin(2 * np.pi * t)) if t <= 1.0 else 0.0


def frame(**changes: object) -> FunctionHost:
    parts: dict[str, object] = {
        "mass": [M], "damping": [2 * XI * M * OMEGA], "restoring": [M * OMEGA**2],
        "ground": ground, "links": [0],
    }  # fmt: skip
    return FunctionHost(**(parts | changes))  # type: ignore[arg-type]


def error_of(run: CoupledRun, truth: rwmf.Response) -> float:
    difference = np.interp(truth.time.values, run.t, run.u) - truth.u_s.values
    return float(np.abs(difference).max() / truth.u_s_max)


@pytest.mark.parametrize(
    "effects",
    ["", "&cable eta_0 = 0.5, eta_alpha = 4.0, law = 'truss' /", "&fuse F_y = 2e4, k = 1e7 /"],
)
def test_the_frame_of_the_kernel_to_second_order(effects: str) -> None:
    case = rwmf.Case.from_text(TEXT.format(2.0, effects))
    truth = rwmf.simulate(case, 0.01)
    errors = []
    for dt in (0.01, 0.005):
        run = couple(case, frame(), ground, dt, 2.0)
        assert run.impacts == int(truth.impacts) >= 2
        assert run.host_mass == pytest.approx(M, rel=1e-6)
        assert run.energy.error < 1e-9 * abs(run.energy.work)
        assert run.t[-1] == pytest.approx(2.0)
        errors.append(error_of(run, truth))
    assert errors[-1] < 1e-3
    for coarse, fine in itertools.pairwise(errors):
        assert 1.8 < np.log2(coarse / fine) < 2.3
    assert run.u_s_max == pytest.approx(float(truth.u_s_max), rel=3e-4)


def pulse(t: float) -> float:
    return float(0.6 * G * np.sin(2 * np.pi * t / 0.8)) if t <= 0.8 else 0.0


def building(case: rwmf.Case) -> tuple[FunctionHost, np.ndarray]:
    """Make the frame of a case with storeys as a host, and return the heights of its floors."""
    coupling = case.storeys.coupling
    given = Building(case.without("bending") if case.bending else case).frame
    assert given is not None
    k = [law.k for law in given.laws]
    stiffness = np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    damping, z = given.c, np.cumsum(given.height)
    if case.bending and coupling == "every_floor":
        # the kernel damps these floors in proportion to their stiffness, by the straight line
        omega = np.sqrt(z @ stiffness @ z / (z @ np.diag(given.m) @ z))
        damping = 2 * case.frame.xi_s / omega * stiffness
    links = [2] if coupling == "full" else [0, 1, 2]
    return FunctionHost(given.m, damping, stiffness, pulse, links), z


@pytest.mark.parametrize("coupling", ["full", "every_floor"])
def test_storeys_at_the_roof_or_at_every_floor(coupling: str) -> None:
    case = rwmf.Case.from_text(STOREYS.format(coupling))
    host, heights = building(case)
    is_every = coupling == "every_floor"
    run = couple(case, host, pulse, 0.004, 1.5, heights=heights if is_every else None)
    truth = rwmf.simulate(case, 0.01)
    assert error_of(run, truth) < 4e-3
    u = host.motion()[0]
    if is_every:
        assert u == pytest.approx(np.array([0.3, 0.65, 1.0]) * u[-1], abs=1e-9)


def on_springs(case: rwmf.Case) -> rwmf.Case:
    """Link all floors by springs."""
    return case.replace(storeys={"coupling": "springs", "k_link": 3e7})


BENDING = "&bending EI = 3e9, xi = 0.02, modes = 2 /"


@pytest.mark.parametrize(
    ("coupling", "effects"),
    [
        ("full", BENDING + "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss', eta_y = 0.85 /"),
        ("every_floor", BENDING + "&fuse F_y = 2e4, k = 1e7 /"),
        ("springs", "&nl_damper F_1 = 1e4, exponent = 0.5 /"),
        ("springs", BENDING),
    ],
)
def test_walls_that_bend_and_link_springs(coupling: str, effects: str) -> None:
    """Every landing of these walls that bend ends in contact, and a lift-off follows."""
    is_on_springs = coupling == "springs"
    text = STOREYS.format("full" if is_on_springs else coupling) + effects
    case = rwmf.Case.from_text(text + "&output reactions = .true., energy = .true. /")
    case = case.replace(solver={"t_end": 0.8})
    if is_on_springs:
        case = on_springs(case)
    truth = rwmf.simulate(case, 0.01)
    u = truth.floors.values[:, -1] if is_on_springs else truth.u_s.values
    lost = 40e3 * float(truth.energy_impact.values[-1])
    errors = []
    for dt in (0.004, 0.002):
        host, _ = building(case)
        run = couple(case, host, pulse, dt, 0.8)
        assert run.impacts == int(truth.impacts) >= 1
        errors.append(np.abs(np.interp(truth.time.values, run.t, run.u) - u).max())
    assert errors[1] < 1e-3 * np.abs(u).max()
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.3
    # a landing takes the velocities of modes, which have 16 steps in a period
    assert run.energy.impacts == pytest.approx(lost, rel=0.03)
    assert run.energy.error < 1e-6 * abs(run.energy.work)
    assert len(run.link_forces[-1]) == len(host.links)
    assert (max(np.abs(run.deflection)) > 0) == bool(case.bending)


def test_heights_give_a_wall_that_bends_its_floors() -> None:
    """Heights beside a case without storeys: the same wall as one with storeys."""
    case = rwmf.Case.from_text(STOREYS.format("every_floor") + BENDING)
    alone = rwmf.Case.from_text(
        "&wall h = 5.0, b = 1.2, m_w = 40e3 / &frame T_s = 1.0, gamma = 2.0, xi_s = 0.05 /"
        "&impact rule = 'coupled' / &solver t_end = 1.0 /" + BENDING
    )
    runs = []
    for given, heights in ((case, None), (alone, [3.0, 6.5, 10.0])):
        host, _ = building(case)
        runs.append(couple(given, host, pulse, 0.005, 0.4, heights=heights))
    assert runs[0].u == runs[1].u
    assert runs[0].deflection == runs[1].deflection


def test_functions_are_as_good_as_matrices() -> None:
    case = rwmf.Case.from_text(TEXT.format(1.5, ""))
    kept: list[float] = []
    host = frame(
        damping=lambda v: 2 * XI * M * OMEGA * v,
        restoring=lambda u: M * OMEGA**2 * u,
        on_commit=lambda u: kept.append(float(u[0])),
    )
    by_function = couple(case, host, ground, 0.01, 1.5)
    by_matrix = couple(case, frame(), ground, 0.01, 1.5)
    assert by_function.u == pytest.approx(by_matrix.u, abs=1e-8)
    assert kept[-1] == by_function.u[-1]


def test_a_yielding_host_with_its_state_in_python() -> None:
    """An elastic-plastic frame with its state in Python, as a user writes it."""
    plastic = 0.0
    k, force_y = M * OMEGA**2, 2e5

    def restoring(u: np.ndarray) -> np.ndarray:
        return np.clip(k * (u - plastic), -force_y, force_y)

    def keep(u: np.ndarray) -> None:
        nonlocal plastic
        plastic = float(u[0] - restoring(u)[0] / k)

    text = TEXT.format(1.5, f"&yielding F_y = {force_y}, hardening = 0.0 /")
    case = rwmf.Case.from_text(text)
    truth = rwmf.simulate(case, 0.01)
    errors = []
    for dt in (0.004, 0.002):
        plastic = 0.0
        run = couple(case, frame(restoring=restoring, on_commit=keep), ground, dt, 1.5)
        errors.append(error_of(run, truth))
    assert errors[1] < 3e-4
    assert errors[0] / errors[1] > 2
    assert abs(plastic) > 1e-3


def test_energy_lost_at_impacts() -> None:
    case = rwmf.Case.from_text(TEXT.format(1.0, ""))
    run = couple(case, frame(), ground, 0.005, 1.0)
    assert [event.kind for event in run.events] == ["lift_off", "impact"]
    h, b, m = 2.0, 0.5, 2e4
    inertia = 4 / 3 * m * (h * h + b * b) + M * 4 * h * h
    assert run.velocity_factor == pytest.approx((inertia - 2 * m * b * b) / inertia, rel=1e-7)
    rate = run.events[1].theta_dot
    lost = inertia * rate**2 * (1 - run.velocity_factor**2) / 2
    assert run.energy.impacts == pytest.approx(lost, rel=1e-6)


def test_a_hinged_wall_has_no_impacts() -> None:
    text = TEXT.format(1.0, "").replace("b = 0.5,", "b = 0.5, base = 'pinned',")
    case = rwmf.Case.from_text(text.replace("&impact rule = 'coupled' /", ""))
    run = couple(case, frame(), ground, 0.005, 1.0)
    assert run.impacts == 0 and not run.events
    assert error_of(run, rwmf.simulate(case, 0.01)) < 1e-3


def test_bad_calls_are_named() -> None:
    case = rwmf.Case.from_text(TEXT.format(1.0, ""))
    light = case.replace(wall={"m_w": None})
    bent = case.replace(bending={"EI": 1e9, "xi": 0.02, "modes": 1})
    springs = on_springs(rwmf.Case.from_text(STOREYS.format("full")))
    two = {"mass": [M, M], "damping": np.eye(2), "restoring": np.eye(2), "links": [0, 1]}
    calls: list[tuple[str, Callable[[], object]]] = [
        ("&wall m_w", lambda: couple(light, frame(), ground, 0.01, 1.0)),
        ("heights = .* 2h = 4", lambda: couple(bent, frame(**two), ground, 0.01, 1.0, [1, 3])),
        ("has 2 links, &storeys", lambda: couple(springs, frame(**two), ground, 0.01, 1.0, [1, 3])),
        ("dt = 0", lambda: couple(case, frame(), ground, 0.0, 1.0)),
        ("ground = 3", lambda: couple(case, frame(), 3, 0.01, 1.0)),  # type: ignore[arg-type]
        ("heights", lambda: couple(case, frame(**two), ground, 0.01, 1.0)),
        ("links = ", lambda: frame(links=[3])),
        ("damping: has the shape", lambda: frame(damping=np.eye(2))),
        ("ground = 3", lambda: frame(ground=3)),
        ("link has no mass", lambda: couple(case, frame(mass=[0.0]), ground, 0.01, 1.0)),
    ]  # fmt: skip
    for match, call in calls:
        with pytest.raises(rwmf.InputError, match=match):
            call()
    with pytest.raises(rwmf.NumericalError, match="more than the wall can follow"):
        couple(case, frame(restoring=[0.0], ground=lambda t: 20.0), lambda t: 20.0, 0.01, 5.0)


def test_the_stored_comparison_with_opensees() -> None:
    path = ROOT / "validation" / "opensees" / "coupling.csv"
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    page = (ROOT / "docs" / "howto" / "stepping-python.md").read_text(encoding="utf-8")
    scenes = {row["scene"] for row in rows}
    assert len(scenes) == 8
    for scene in scenes:
        own = [row for row in rows if row["scene"] == scene]
        assert len(own) == 4
        assert float(own[0]["sensitivity"]) < 10
        assert abs(float(own[-1]["u_s_max_error"])) < 1e-4
        assert float(own[-1]["history_error"]) < 1e-4
        assert all(1.8 < float(row["order"]) < 2.6 for row in own[1:])
        for row in own:
            cells = f"| {float(row['dt_ms']):g} | {float(row['u_s_max_error']):.1e} |"
            assert f"| {scene} {cells}" in page


@pytest.mark.skipif(importlib.util.find_spec("openseespy") is None, reason="no OpenSees")
def test_opensees_is_the_frame_of_functions() -> None:
    ops = importlib.import_module("openseespy.opensees")
    case = rwmf.Case.from_text(TEXT.format(2.0, ""))
    dt = 0.01
    t = np.arange(0.0, 2.1, dt)
    a = np.array([ground(x) for x in t])
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, M)
    ops.uniaxialMaterial("Elastic", 1, M * OMEGA**2, 2 * XI * M * OMEGA)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 1)
    ops.timeSeries("Path", 1, "-dt", dt, "-values", *a.tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    lines = lambda x: float(np.interp(x, t, a))  # noqa: E731
    with pytest.raises(rwmf.InputError, match="nodes = 7"):
        OpenSeesHost(ops, [7])
    theirs = couple(case, OpenSeesHost(ops, [2]), lines, dt, 2.0)
    ours = couple(case, frame(ground=lines), lines, dt, 2.0)
    assert theirs.impacts == ours.impacts > 1
    assert theirs.u == pytest.approx(ours.u, abs=1e-9)
