"""Vertical ground motion: the weight of the wall follows g + v_g''."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf.kernel import measure as _measure
from scenes import bare_frame, block, coupled
from scipy.integrate import solve_ivp

G = 9.81
ALPHA = math.atan2(0.5, 2.0)
METHODS = ("adams", "bdf", "taylor", "dop853")
# the same physics integrated with other numbers
SAME_PHYSICS = 1e-7
TIGHT = {"rtol": 1e-10}
# the pulse of the common scene, for a record instead
NO_PULSE = dict.fromkeys(("a_max_g", "omega_p"))


def _write(path: Path, t: np.ndarray, a: np.ndarray) -> str:
    """Write a record with two columns [s], [m/s2]."""
    rows = "".join(f"{x:.17g} {y:.17g}\n" for x, y in zip(t, a, strict=True))
    path.write_text(rows, encoding="utf-8")
    return str(path)


def _horizontal(folder: Path, dt: float = 1 / 64, scale: float = 1.0) -> dict[str, object]:
    """Return `&motion` of a decaying sine of 4 m/s2, sampled in steps of 1/1024 m/s2."""
    t = np.arange(0, 6 + dt / 2, dt)
    a = np.round(1024 * 4 * np.exp(-t / 3) * np.sin(2 * math.pi * t)) / 1024
    file = _write(folder / f"h{dt:.6f}_{scale}.txt", t, scale * a)
    return {"kind": "record", "file": file, "unit": "m/s2"} | NO_PULSE


def _vertical(folder: Path, t: np.ndarray, a: np.ndarray, name: str = "v") -> dict[str, object]:
    return {"file": _write(folder / f"{name}.txt", t, a), "unit": "m/s2"}


@pytest.mark.parametrize("formulation", ["published", "symmetric", "exact"])
@pytest.mark.parametrize("a", [-4.0, 3.0])
def test_constant_acceleration_is_another_gravity(
    a: float, formulation: str, tmp_path: Path
) -> None:
    """Runs are equal with g' = g + a and the same cable force P = eta m_w g."""
    common = {
        "motion": _horizontal(tmp_path),
        "solver": TIGHT | {"t_end": 6.0},
        "model": {"formulation": formulation},
    }
    forever = np.array([-1.0, 100.0])
    moved = rwmf.simulate(
        coupled(vertical=_vertical(tmp_path, forever, np.array([a, a])), **common)
    )
    heavier = G + a
    cable = {"eta_0": 1.0 * G / heavier, "eta_alpha": 5.0 * G / heavier}
    model = {"formulation": formulation, "g": heavier}
    other = rwmf.simulate(coupled(cable=cable, **(common | {"model": model})))
    assert int(moved["impacts"]) > 10
    for key in ("u_s_max", "theta_max_over_alpha", "theta_dot_max"):
        assert float(moved[key]) == pytest.approx(float(other[key]), rel=SAME_PHYSICS), key
    assert int(moved["impacts"]) == int(other["impacts"])


def test_hinged_wall() -> None:
    """A hinged wall leans out: a small swing has the stiffness of the frame less that of weight."""
    scene = {"wall": {"base": "pinned"}, "cable": None, "impact": None}
    changes = {"motion": {"a_max_g": 0.01}, "solver": TIGHT}
    still = rwmf.simulate(coupled(**scene, **changes))
    moved = rwmf.simulate(coupled(**scene, **changes, vertical={"ratio": 0.0}))
    assert float(moved["u_s_max"]) == pytest.approx(float(still["u_s_max"]), rel=1e-9)


@pytest.mark.parametrize("formulation", ["published", "symmetric", "exact"])
def test_no_vertical_motion(formulation: str) -> None:
    model = {"formulation": formulation}
    still = rwmf.simulate(coupled(model=model))
    moved = rwmf.simulate(coupled(model=model, vertical={"ratio": 0.0}))
    assert float(moved["u_s_max"]) == pytest.approx(float(still["u_s_max"]), rel=1e-10)
    assert "vertical" in moved.attrs["effects"]
    assert "vertical" not in still.attrs["effects"]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("ratio", [-0.8, 0.65, 1.5])
@pytest.mark.parametrize("gamma", [None, 5.0])
def test_lift_off_threshold(gamma: float | None, ratio: float, sign: int) -> None:
    """At a (1 + 2 gamma) = tan(alpha) (g (1 + eta_0) + ratio a), a > 0, to the left."""
    eta_0 = 0.0 if gamma is None else 1.0
    arms = 1 if gamma is None else 1 + 2 * gamma
    threshold = 0.25 * (1 + eta_0) / (arms - sign * ratio * 0.25)
    lifts = {}
    for factor in (1 - 1e-9, 1 + 1e-6):
        motion = {"kind": "one_sine", "a_max_g": sign * threshold * factor, "omega_p": 6.0}
        # the half wave of the other sign lifts sooner or later than this one
        solver = {"t_end": math.pi / 6.0}
        make = block if gamma is None else coupled
        case = make(motion=motion, vertical={"ratio": ratio}, solver=solver)
        lifts[factor] = int(rwmf.simulate(case)["lift_offs"])
    assert list(lifts.values()) == [0, 1]


@pytest.mark.parametrize("quiet", ["motion", "vertical"])
def test_merged_knots(quiet: str, tmp_path: Path) -> None:
    """Records of different dt give the bits of one common grid (numbers exact in binary)."""
    coarse, fine = np.arange(0, 7, 1 / 16), np.arange(0, 7 - 1 / 16 + 1e-9, 1 / 64)
    rough = np.round(512 * 3 * np.cos(5 * coarse)) / 512
    smooth = np.round(512 * 3 * np.sin(7 * fine)) / 512
    a = {"motion": smooth, "vertical": smooth}
    a[quiet] = rough
    runs = []
    for grid in (coarse, fine):
        t = {"motion": fine, "vertical": fine}
        t[quiet] = grid
        values = a | {quiet: np.interp(grid, coarse, rough)}
        files = {
            name: _write(tmp_path / f"{name}{grid.size}.txt", t[name], values[name]) for name in t
        }
        motion = {"kind": "record", "file": files["motion"], "unit": "m/s2"} | NO_PULSE
        vertical = {"file": files["vertical"], "unit": "m/s2"}
        case = coupled(motion=motion, vertical=vertical, solver={"t_end": 8.0})
        runs.append(rwmf.simulate(case, dt=0.01))
    assert int(runs[0]["impacts"]) > 10
    for name in ("theta", "theta_dot", "u_g_ddot", "v_g_ddot"):
        assert np.array_equal(runs[0][name].values, runs[1][name].values), name
    assert float(runs[0]["u_s_max"]) == float(runs[1]["u_s_max"])


def test_default_end_is_that_of_the_longer_record(tmp_path: Path) -> None:
    t = np.array([0.0, 9.5])
    ends = {
        "both": coupled(
            motion=_horizontal(tmp_path),
            vertical=_vertical(tmp_path, t, np.ones(2)),
            solver={"t_end": None},
        ),
        "vertical": block(
            motion=None, vertical=_vertical(tmp_path, t, np.ones(2)), solver={"t_end": None}
        ),
        "short": coupled(
            motion=_horizontal(tmp_path),
            vertical=_vertical(tmp_path, t / 10, np.ones(2), "short"),
            solver={"t_end": None},
        ),
    }
    assert {name: case.solver.t_end for name, case in ends.items()} == {
        "both": 9.5,
        "vertical": 9.5,
        "short": 6.0,
    }


def _block_by_scipy(ratio: float, t_end: float) -> float:
    """Rotation at t_end of a block released at 0.5 alpha, e = 0.9, by another program [rad]."""
    R = math.hypot(2.0, 0.5)
    omega = 2 * math.pi

    def ground(t: float) -> float:
        return 0.4 * G * math.cos(omega * t) if t < 1 else 0.0

    def rates(t: float, y: np.ndarray, side: int) -> list[float]:
        arm = ALPHA - side * y[0]
        weight = G + ratio * ground(t)
        return [
            y[1],
            -0.75 / R * (side * weight * math.sin(arm) + ground(t) * math.cos(arm)),
        ]

    def base(t: float, y: np.ndarray, side: int) -> float:
        return y[0] * side

    base.terminal, base.direction = True, -1  # type: ignore[attr-defined]
    t, y, side = 0.0, [0.5 * ALPHA, 0.0], 1
    while t < t_end:
        stop = 1.0 if t < 1 else t_end
        found = solve_ivp(
            rates, (t, stop), y, args=(side,), events=base, method="DOP853", rtol=1e-12,
            atol=1e-14,
        )  # fmt: skip
        t, y = float(found.t[-1]), list(found.y[:, -1])
        if found.status == 1:
            y, side = [0.0, 0.9 * y[1]], -side
    return y[0]


@pytest.mark.parametrize("ratio", [0.65, -0.65])
def test_another_program(ratio: float) -> None:
    motion = {"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * math.pi}
    case = block(
        motion=motion,
        vertical={"ratio": ratio},
        initial={"theta_over_alpha": 0.5},
        solver={"t_end": 2.0, "rtol": 1e-11},
    )
    run = rwmf.simulate(case, dt=2.0)
    assert int(run["impacts"]) > 1
    assert float(run["theta"][-1]) == pytest.approx(_block_by_scipy(ratio, 2.0), rel=1e-8)


@pytest.mark.parametrize("eta_0", [0.0, 1.0])
def test_a_wall_that_jumps_is_refused(eta_0: float, tmp_path: Path) -> None:
    """Without horizontal motion the wall stays until g (1 + eta_0) + v_g'' = 0, and then jumps."""
    t, a = np.array([0.0, 1.0, 2.0]), np.array([0.0, 0.0, -4 * G])
    case = coupled(
        frame=None,
        motion=None,
        cable={"eta_0": eta_0},
        vertical=_vertical(tmp_path, t, a),
        solver={"t_end": 3.0},
    )
    with pytest.raises(rwmf.RwmfError, match="the wall jumps at t = ") as failure:
        rwmf.simulate(case)
    instant = float(str(failure.value).split("t = ")[1].split(" s")[0])
    assert instant == pytest.approx(1 + (1 + eta_0) / 4, rel=1e-12)
    stays = rwmf.simulate(case.replace(vertical={"scale": 0.99 * (1 + eta_0) / 4}))
    assert int(stays["lift_offs"]) == 0
    assert "the wall jumps" not in stays.attrs["warnings"]


def test_a_wall_that_lands_without_weight_is_refused(tmp_path: Path) -> None:
    """The weight vanishes shortly before the wall is back on its base."""
    free = {"motion": None, "initial": {"theta_over_alpha": 0.5}, "output": {"dt": 5.0}}
    run = rwmf.simulate(block(**free, solver={"t_end": 5.0}))
    landing = float(run["event_time"].values[run["event"].values == "impact"][0])
    t = np.array([0.0, landing - 0.02, landing - 0.019, landing + 1])
    vertical = _vertical(tmp_path, t, np.array([0.0, 0.0, -2 * G, -2 * G]))
    with pytest.raises(rwmf.RwmfError, match="the wall jumps at t = ") as failure:
        rwmf.simulate(block(**free, vertical=vertical, solver={"t_end": 5.0}))
    instant = float(str(failure.value).split("t = ")[1].split(" s")[0])
    assert landing < instant < landing + 0.01


def test_times_that_differ_by_round_off_are_one_knot(tmp_path: Path) -> None:
    """3*0.1 is not 0.3 in binary."""
    t = np.arange(60) / 10
    a = 3 * np.sin(3 * t)
    (tmp_path / "column.txt").write_text("".join(f"{x:.17g}\n" for x in a), encoding="utf-8")
    (tmp_path / "times.txt").write_text(
        "".join(f"{x:.1f} {y:.17g}\n" for x, y in zip(t, a, strict=True)), encoding="utf-8"
    )
    motion = {"kind": "record", "file": str(tmp_path / "times.txt"), "unit": "m/s2"} | NO_PULSE
    column = {"file": str(tmp_path / "column.txt"), "unit": "m/s2", "dt": 0.1}
    times = {"file": str(tmp_path / "times.txt"), "unit": "m/s2"}
    runs = [rwmf.simulate(coupled(motion=motion, vertical=v)) for v in (column, times)]
    assert float(runs[0]["u_s_max"]) == pytest.approx(float(runs[1]["u_s_max"]), rel=1e-12)


def test_a_weight_that_vanishes_is_reported() -> None:
    run = rwmf.simulate(coupled(vertical={"ratio": 5.1}))
    assert "takes all of weight" in run.attrs["warnings"]


def test_the_record_travels_with_the_case(tmp_path: Path) -> None:
    (tmp_path / "records").mkdir()
    t = np.arange(0, 3, 0.01)
    _write(tmp_path / "records" / "v.txt", t, np.sin(t))
    text = coupled(motion=None, cable=None).text
    text += "&vertical file = 'records/v.txt', unit = 'm/s2' /\n"
    (tmp_path / "case.nml").write_text(text, encoding="utf-8")
    case = rwmf.Case.from_namelist(tmp_path / "case.nml")
    (tmp_path / "deep").mkdir()
    moved = tmp_path / "deep" / "moved.nml"
    case.to_namelist(moved)
    again = rwmf.Case.from_namelist(moved)
    assert Path(moved.parent, str(again.vertical.file)).resolve() == (
        tmp_path / "records" / "v.txt"
    )


PULSES: dict[str, dict[str, object]] = {
    "one_sine": {},
    "one_cosine": {},
    "sine": {"cycles": 2.5},
    "type_c": {"n_pulses": 2},
    "ricker": {},
    "ricker_antisymmetric": {},
    "mavroeidis_papageorgiou": {"gamma_p": 2.3, "nu": 0.7},
}


def _pulse(kind: str, a: float = 0.4) -> dict[str, object]:
    return {"kind": kind, "a_max_g": a, "omega_p": 5.0, "t_0": 0.3} | PULSES[kind]


def _shape(kind: str, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and acceleration [m/s2] of a pulse of 1 m/s2, as the kernel has it."""
    motion = _pulse(kind, 1 / G)
    case = bare_frame(motion=motion, solver={"t_end": 9.0, "method": "dop853"})
    run = rwmf.simulate(case, dt=0.0005)
    return run["time"].values, run["u_g_ddot"].values


@pytest.mark.parametrize("kind", PULSES)
@pytest.mark.parametrize("slope", [-6.0, 5.0])
def test_lift_off_beside_a_pulse(kind: str, slope: float, tmp_path: Path) -> None:
    """A vertical motion so steep that neither motion is extremal when the wall is pulled most.

    The amplitude at which the block just lifts off: the smallest of tan(alpha) (g + v)/|shape|.
    """
    t, shape = _shape(kind, tmp_path)
    knots = np.array([0.0, 0.9, 2.0, 3.1, 4.2, 5.3, 6.4, 12.0])
    v = np.array([0.0, 1.0, 1 - slope, 2.0, 2 + slope, -1.0, 1.0, 0.0])
    vertical = _vertical(tmp_path, knots, v)
    with np.errstate(divide="ignore"):
        needed = 0.25 * (G + np.interp(t, knots, v)) / np.abs(shape)
    at = int(np.argmin(needed))
    # the parabola through the samples around the least one, unless it is at a jump of the pulse
    a, lowest, c = needed[at - 1 : at + 2]
    margin = 2e-3
    if max(a, c) < 2 * lowest:
        margin = 1e-8
        lowest -= (c - a) ** 2 / (8 * (a - 2 * lowest + c))
    lifts = []
    for factor in (1 - margin, 1 + margin):
        case = block(
            motion=_pulse(kind, lowest * factor / G), vertical=vertical, solver={"t_end": 9.0}
        )
        lifts.append(int(rwmf.simulate(case)["lift_offs"]))
    assert lifts[0] == 0
    assert lifts[1] >= 1
    if margin < 1e-3:  # at an extremum of the pulse the wall would bear more than the margin
        assert 0.25 * (G + np.interp(t, knots, v)[at]) < lowest * np.abs(shape).max() * (1 - 1e-6)


@pytest.mark.parametrize("kind", PULSES)
def test_still_record_beside_a_pulse(kind: str, tmp_path: Path) -> None:
    """Knots alone change nothing; a constant record is another gravity."""
    common = {"motion": _pulse(kind), "solver": TIGHT}
    t = np.array([-1.0, 0.5, 0.77, 1.9, 100.0])
    still = _vertical(tmp_path, t, np.zeros(t.size), "still")
    constant = _vertical(tmp_path, t, np.full(t.size, 2.0), "constant")
    heavier = G + 2.0
    cable = {"eta_0": 1.0 * G / heavier, "eta_alpha": 5.0 * G / heavier}
    motion = _pulse(kind, 0.4 * G / heavier)
    for vertical, other in (
        (still, coupled(**common)),
        (
            constant,
            coupled(cable=cable, model={"g": heavier}, **(common | {"motion": motion})),
        ),
    ):
        run = rwmf.simulate(coupled(vertical=vertical, **common))
        expected = rwmf.simulate(other)
        assert int(run["impacts"]) > 3
        for key in ("u_s_max", "theta_max_over_alpha"):
            assert float(run[key]) == pytest.approx(float(expected[key]), rel=SAME_PHYSICS), key


@pytest.mark.parametrize("kind", ["one_sine", "type_c", "mavroeidis_papageorgiou"])
@pytest.mark.parametrize("method", METHODS)
def test_record_beside_a_pulse(kind: str, method: str, tmp_path: Path) -> None:
    """Quadruple precision, the energy ledger, and the mirrored pulse bit for bit."""
    t = np.arange(0.07, 4, 0.015)
    case = coupled(
        motion=_pulse(kind),
        vertical=_vertical(tmp_path, t, 5 * np.sin(9 * t)),
        model={"formulation": "symmetric"},
        solver={"t_end": 6.0, "rtol": 1e-10, "method": method},
        output={"energy": True},
    )
    run = rwmf.simulate(case)
    assert int(run["impacts"]) > 3
    assert abs(float(run["energy_balance_relative"])) < 1e-7
    reference = _measure.solve_reference(case, 1e-15, 1e-16)
    assert float(run["u_s_max"]) == pytest.approx(reference.values["u_s_max_m"], rel=1e-8)
    mirrored = rwmf.simulate(case.replace(motion={"a_max_g": -0.4}))
    assert float(mirrored["u_s_max"]) == float(run["u_s_max"])


def test_end_beside_a_pulse_must_be_given(tmp_path: Path) -> None:
    """The duration after a pulse does not apply to a record."""
    vertical = _vertical(tmp_path, np.array([0.0, 1.0]), np.zeros(2))
    with pytest.raises(rwmf.InputError, match="t_end is missing"):
        coupled(vertical=vertical, solver={"t_end": None})
