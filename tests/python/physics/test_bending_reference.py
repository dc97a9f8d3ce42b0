"""The reference program for walls that bend: its own anchors, balances and limits.

Closed forms, modal superposition, a Ritz solution of the shear-flexible cantilever and the rigid
wall of the kernel check `tests/support/bending.py`, the reference of the kernel. Nothing here needs
a kernel with `&bending`.
"""

from __future__ import annotations

import math

import bending
import numpy as np
import pytest
import rwmf
from bending import BentWall, Course
from bending_demands import Demands
from bending_parts import AT_LOBATTO, LOBATTO, Ground, Groups, Shapes, cantilever_roots
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

H, B = 6.0, 1.2
STOREYS = {
    "m_over_m_w": [1.5, 1.4, 1.0],
    "k_over_m_w": [900.0, 800.0, 500.0],
    "height": [4.2, 4.3, 3.5],
}


def _block(modes: int, **groups: dict) -> Groups:
    wall = {"wall": {"h": H, "b": B}, "solver": {"t_end": 2.0}}
    return wall | {"bending": {"EI_over_m_w": 1.5e5, "modes": modes}} | groups


def _building(coupling: str, **groups: dict) -> Groups:
    case = {
        "frame": {"xi_s": 0.05},
        "storeys": STOREYS | {"coupling": coupling, "k_link_over_m_w": 3e4},
        "cable": {"eta_0": 1.0, "eta_alpha": 4.0},
        "motion": {"kind": "one_sine", "a_max_g": 0.45, "T_p": 0.7},
    }
    return _block(2, **case) | groups


def test_cantilever_roots() -> None:
    roots = cantilever_roots(12)
    assert roots[:3] == pytest.approx([1.875104069, 4.694091133, 7.854757438], abs=1e-9)
    np.testing.assert_allclose(Shapes(12, 3.0).mass, 0.25, rtol=1e-13)


@pytest.mark.parametrize("shear", [0.0, 0.004, 0.05])
def test_shapes_are_orthogonal_and_one_at_the_tip(shear: float) -> None:
    shapes = Shapes(12, 7.0, shear)
    z, weight = shapes.rule()
    phi = shapes(z)
    products = (phi * weight[:, None]).T @ phi / 7.0
    np.testing.assert_allclose(products, np.diag(shapes.mass), atol=1e-13)
    np.testing.assert_allclose(shapes(np.array([0.0, 7.0])), [[0] * 12, [1] * 12], atol=1e-13)


def test_shear_flexible_cantilever_against_ritz() -> None:
    shear, n = 0.02, 22
    x, weight = np.polynomial.legendre.leggauss(40)
    z, weight = (x + 1) / 2, weight / 2
    # deflection and rotation: z times Legendre polynomials
    p = np.polynomial.legendre.legvander(x, n - 1)
    slopes = [np.polynomial.legendre.legder(row) for row in np.eye(n)]
    dp = 2 * np.array([np.polynomial.legendre.legval(x, s) for s in slopes]).T
    f, df = z[:, None] * p, p + z[:, None] * dp
    none = np.zeros_like(f)
    bends, shears = np.hstack([none, df]), np.hstack([df, -f])
    stiff = bends.T @ (weight[:, None] * bends) + shears.T @ (weight[:, None] * shears) / shear
    mass = np.hstack([f, none]).T @ (weight[:, None] * np.hstack([f, none]))
    squares = np.sort(1 / eigh(mass, stiff, eigvals_only=True)[-5:])
    np.testing.assert_allclose(Shapes(5, 1.0, shear).squares, squares, rtol=1e-9)


def test_frequencies_of_a_wall() -> None:
    # 19.2 m x 4 m x 0.35 m, 30 GPa, 2,500 kg/m3
    stiffness = 30e9 * 0.35 * 4.0**3 / 12 / (19.2 * 4.0 * 0.35 * 2500)
    groups = {"wall": {"h": 9.6, "b": 2.0}, "bending": {"EI_over_m_w": stiffness, "modes": 1}}
    fixed = BentWall(groups)
    assert fixed.omega[0] / (2 * math.pi) == pytest.approx(6.071953, abs=1e-6)
    for modes, error in ((6, 1e-6), (10, 1e-7)):
        groups["bending"]["modes"] = modes
        wall = BentWall(groups | {"wall": {"h": 9.6, "b": 1e-7}})
        mass = wall.inertia(np.zeros((1, wall.size)), 1)[0]
        squares = eigh(np.diag([0.0, *(wall.mass * wall.omega**2)]), mass, eigvals_only=True)
        beta = (np.sqrt(np.abs(squares[1:3])) / fixed.omega[0]) ** 0.5 * 1.875104068711961
        assert beta[0] == pytest.approx(3.926602312, rel=error)
        assert beta[1] == pytest.approx(7.068582746, rel=20 * error)


def test_factors_at_impacts_of_a_straight_block() -> None:
    expected = [0.942, 0.134, -0.345, -0.448, -0.477, -0.488, -0.493]
    for modes, e in enumerate(expected):
        wall = BentWall(_block(modes))
        x, v = np.zeros(wall.size), np.zeros(wall.size)
        v[0] = -0.3
        after, _, _, goes = wall.landing(x, v, 1)
        if e > 0:
            assert goes
            assert after[0] / v[0] == pytest.approx(e, abs=5e-4)
        else:
            assert not goes
            assert after[0] == 0.0
        # the row of the rotation alone
        k = wall._energy_matrix(x[None], -1)
        factor = 1 - 2 * B**2 * np.linalg.inv(k)[0, 0]
        assert factor == pytest.approx(e, abs=6e-4)


def test_kinetic_energy_never_grows_at_impacts() -> None:
    rng = np.random.default_rng(5)
    for _ in range(400):
        coupling = str(rng.choice(["full", "every_floor", "reduced", "springs"]))
        groups = _building(coupling, inerter={"inertance_over_m_w": rng.uniform(0, 0.5)})
        groups["bending"] = {"EI_over_m_w": 1e4, "modes": int(rng.integers(1, 5))}
        groups["wall"] = {"h": H, "b": rng.uniform(0.3, 4.0)}
        wall = BentWall(groups)
        side = int(rng.choice([-1, 1]))
        x, v = 0.3 * rng.standard_normal((2, wall.size))
        v[0] = -side * abs(v[0])
        after, new_side, loss, goes = wall.landing(x, v, side)
        assert loss > -1e-14
        assert new_side == -side
        assert goes == (after[0] != 0.0)


def _states(wall: BentWall, course: Course) -> None:
    """Hold rotation and modes against the forces on sections and pivot, at every piece."""
    at, demands = AT_LOBATTO, Demands(wall)
    for piece in course.pieces[:: max(1, len(course.pieces) // 60)]:
        t = LOBATTO
        x, v = piece.at(at, t)
        flow = wall.flow(piece, t, x, v)
        shear, moment, axial = demands.forces(piece, t, x, v, flow)
        scale = 1 + np.abs(moment).max()
        # nothing acts above the top
        assert np.abs(moment[:, -1, -1]).max() < 2 * wall.g * scale
        if piece.held:
            assert np.abs(x[:, 0]).max() == 0.0
            continue
        size = demands.corner(piece, x, v, flow)
        s, c = np.sin(x[:, 0]), np.cos(x[:, 0])
        if piece.fuses:
            size[1] -= wall.lifting(piece.fuses, -piece.side).force(np.zeros(1))
        devices = -(s * size[0] + c * size[1])
        pivot = axial - devices
        moments = -piece.side * wall.b * (pivot - devices)
        np.testing.assert_allclose(moment[:, 0, 0], moments, atol=1e-10 * scale)
        assert np.abs(shear).max() < 1e6


@pytest.mark.parametrize("coupling", ["reduced", "full", "every_floor", "springs"])
def test_ledger_and_base(coupling: str) -> None:
    groups = _building(
        coupling,
        damper={"c_over_m_w": 0.4},
        inerter={"inertance_over_m_w": 0.1},
        p_delta={"m_g_over_m_s": 1.2},
        vertical={"ratio": 0.4},
        solver={"t_end": 1.2},
    )
    groups["cable"]["law"] = "truss"
    wall = BentWall(groups)
    course = wall.follow()
    assert course.impacts
    assert course.contacts
    energy = max(wall.energies(course, p)["input"] for p in course.pieces)
    for piece in course.pieces[:: max(1, len(course.pieces) // 20)]:
        assert abs(wall.balance(course, piece)) < 1e-11 * energy
    assert min(course.losses) > 0
    _states(wall, course)


def test_fuses_with_modes() -> None:
    fuse = {"eta_y": 0.2, "stroke_y": 0.004, "hardening": 0.03}
    wall = BentWall(_building("reduced", fuse=fuse, solver={"t_end": 1.5}))
    course = wall.follow()
    last = course.pieces[-1]
    energy = wall.energies(course, last)
    assert energy["hysteretic"] > 0.01 * energy["input"]
    assert abs(wall.balance(course, last)) < 1e-11 * energy["input"]
    _states(wall, course)


def test_wall_held_down_by_modal_superposition() -> None:
    rng = np.random.default_rng(3)
    times = np.linspace(0, 1, 26)
    a_g = rng.standard_normal(26)
    groups = _block(3, cable={"eta_0": 50.0}, solver={"t_end": 1.4})
    wall = BentWall(groups, Ground.lines(times, a_g))
    course = wall.follow()
    assert not course.lift_offs
    q = np.zeros((3, 2))
    for i in range(25):
        q = np.array(
            [
                _oscillator(w, 0.02, a / m, a_g[i], a_g[i + 1], times[1], y)
                for w, a, m, y in zip(wall.omega, wall.area, wall.mass, q, strict=True)
            ]
        )
    piece = next(p for p in course.pieces if abs(p.t - 1.0) < 1e-9)
    np.testing.assert_allclose(piece.x[1:], q[:, 0], rtol=1e-10, atol=1e-13)
    np.testing.assert_allclose(piece.v[1:], q[:, 1], rtol=1e-10, atol=1e-12)


def _oscillator(
    w: float, xi: float, share: float, a: float, b: float, dt: float, y: np.ndarray
) -> np.ndarray:
    """Return displacement and velocity after straight ground acceleration, in closed form."""
    slope = -share * (b - a) / dt
    first = -share * a / w**2 - 2 * xi * slope / w**3
    rate, damped = slope / w**2, w * math.sqrt(1 - xi**2)
    d, v = y[0] - first, y[1] - rate
    decay, c, s = math.exp(-xi * w * dt), math.cos(damped * dt), math.sin(damped * dt)
    sine = (v + xi * w * d) / damped
    now = decay * (d * c + sine * s)
    speed = decay * damped * (sine * c - d * s) - xi * w * now
    return np.array([now + first + rate * dt, speed + rate])


@pytest.mark.parametrize("coupling", ["reduced", "every_floor", "full"])
def test_rigid_wall_is_that_of_the_kernel(coupling: str) -> None:
    groups = _building(coupling, p_delta={"m_g_over_m_s": 1.2}, damper={"c_over_m_w": 0.3})
    del groups["bending"], groups["storeys"]["k_link_over_m_w"]
    wall = BentWall(groups)
    found = wall.largest(wall.follow())
    solver = {"solver": {"t_end": 2.0, "rtol": 1e-12}, "impact": {"rule": "coupled"}}
    case = rwmf.Case(**(groups | solver | {"output": {"reactions": True, "energy": True}}))
    run = rwmf.simulate(case)
    names = [name for name in found if name in run]
    assert len(names) > 12
    for name in names:
        assert found[name] == pytest.approx(float(run[name]), rel=1e-10), name


def test_stiff_wall_is_rigid_up_to_the_first_impact() -> None:
    groups = _building("every_floor")
    rigid = BentWall({key: value for key, value in groups.items() if key != "bending"})
    course = rigid.follow()
    t = course.impacts[0] - 0.02
    expected = Demands(rigid).history(course, np.array([t]))["u_s_max_m"][0]
    errors = []
    for factor in (1e3, 1e4):
        groups["bending"] = {"EI_over_m_w": 1e5 * factor, "modes": 1}
        wall = BentWall(groups)
        found = Demands(wall).history(wall.follow(t + 0.01), np.array([t]))["u_s_max_m"][0]
        errors.append(abs(found - expected))
    assert errors[1] < 0.2 * errors[0] < 0.002 * abs(expected)


def test_peaks_are_not_below_a_fine_history() -> None:
    wall = BentWall(_building("every_floor", solver={"t_end": 0.9}))
    course = wall.follow()
    found = wall.largest(course)
    rows = Demands(wall).history(course, np.linspace(0, 0.9, 1500))
    for name in ("tip_deflection_max_m", "u_s_max_m", "floor_2_acceleration_max_g"):
        most = float(np.abs(rows[name]).max())
        assert most <= found[name] * (1 + 1e-12)
        assert most > 0.9 * found[name]


@pytest.mark.parametrize("number", [1, 2, 3, 5, 6, 7, 8, 11])
def test_scenes_do_not_depend_on_the_step(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    one = bending.solved(number)
    monkeypatch.setattr(bending, "ANGLE", 3.1)
    other = bending.solved(number)
    assert abs(one["missing"]) < 1e-11 * one["energy"]["input"]
    for name, value in one["peaks"].items():
        assert other["peaks"][name] == pytest.approx(value, rel=1e-10, abs=1e-13), name
    for name, times in one["events"].items():
        np.testing.assert_allclose(other["events"][name], times, rtol=1e-11)


def test_flight_by_another_integrator() -> None:
    wall = BentWall(_building("every_floor"))
    course = wall.follow(0.6)
    first = next(i for i, p in enumerate(course.pieces) if not p.held)
    flight = course.pieces[first : first + 12]
    one, t = flight[0], np.zeros(1)

    def rate(time: float, y: np.ndarray) -> np.ndarray:
        x, v = y.reshape(2, 1, -1)
        t[0] = time
        a = wall.accelerate(x, v, one.a_g(t), one.a_v(t), one.side, [], [], held=False).a
        return np.concatenate([v[0], a[0]])

    start = np.concatenate([one.x, one.v])
    found = solve_ivp(rate, (one.t, flight[-1].t), start, method="DOP853", rtol=1e-12, atol=1e-14)
    assert len(flight) == 12
    np.testing.assert_allclose(
        found.y[:, -1], [*flight[-1].x, *flight[-1].v], rtol=1e-8, atol=1e-11
    )


def test_block_swings_back_less_with_a_rigid_wall() -> None:
    heights = []
    for modes in (0, 3):
        groups = {"wall": {"h": H, "b": 1.5}, "initial": {"theta_over_alpha": 0.4}}
        groups["bending"] = {"EI_over_m_w": 1e6, "modes": modes}
        wall = BentWall(groups)
        course = wall.follow(2.25)
        later = [p for p in course.pieces if p.t >= course.impacts[0]]
        heights.append(max(abs(p.at(AT_LOBATTO, LOBATTO)[0][:, 0]).max() for p in later))
    np.testing.assert_allclose(np.array(heights) / (0.4 * wall.alpha), [0.790, 0.852], atol=6e-3)
