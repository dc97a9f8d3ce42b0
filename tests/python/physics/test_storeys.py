"""Frames of several storeys and smooth hysteresis against independent programs in SciPy.

They share nothing with the kernel. `scipy.linalg.eigh` gives the modes, and `solve_ivp` finds the
events. `test_demands_of_walls.py` has storeys beside rocking walls.
"""

import math

import numpy as np
import pytest
import rwmf
from scenes import bare_frame, coupled
from scipy.integrate import quad, solve_ivp
from scipy.linalg import eigh
from scipy.optimize import brentq
from yielding import slowly_unloaded

G = 9.81
H, B = 6.0, 1.5
PULSE = {"kind": "one_sine", "a_max_g": 0.35, "omega_p": 4.0}
PULSE_END = 2 * math.pi / 4.0
TIGHT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-13}


def ground(t: float) -> float:
    """Return the ground acceleration of the pulse [m/s2]."""
    return 0.35 * G * math.sin(4.0 * t) if t < PULSE_END else 0.0


class Storeys:
    """A shear frame.

    Parameters
    ----------
    m, k : list of float
        Masses and stiffnesses over one mass, from the ground up [-], [1/s2].
    xi : float
        Damping ratio of every mode [-].
    """

    def __init__(self, m: list[float], k: list[float], xi: float) -> None:
        self.m = np.array(m)
        self.k = np.diag(k) + np.diag([*k[1:], 0.0])
        self.k -= np.diag(k[1:], 1) + np.diag(k[1:], -1)
        squares, modes = eigh(self.k, np.diag(m))
        momentum = self.m[:, None] * modes
        self.c = momentum @ np.diag(2 * xi * np.sqrt(squares)) @ momentum.T


@pytest.mark.parametrize("exponent", [1.0, 2.0, 5.0])
def test_bouc_wen_against_scipy(exponent: float) -> None:
    """The bare frame with hysteresis, integrated from one turn of the velocity to the next."""
    T_s, xi, u_y, hardening, beta = 0.8, 0.03, 0.02, 0.1, 0.7
    omega = 2 * math.pi / T_s

    def rates(t: float, y: np.ndarray, course: int) -> list[float]:
        u, v, z = y
        force = omega**2 * (hardening * u + (1 - hardening) * u_y * z)
        lost = abs(z) ** exponent * (1 - beta + math.copysign(beta, course * z))
        return [v, -2 * xi * omega * v - force - ground(t), v / u_y * (1 - lost)]

    t, y, course, largest = 0.0, np.zeros(3), -1, 0.0
    while t < 4.0:
        stop = PULSE_END if t < PULSE_END else 4.0

        def turns(_t: float, y: np.ndarray) -> float:
            return float(y[1])

        turns.terminal, turns.direction = True, -course
        piece = solve_ivp(
            lambda t, y, c=course: rates(t, y, c), (t, stop), y, events=turns, **TIGHT
        )
        t, y = float(piece.t[-1]), piece.y[:, -1]
        if piece.status == 1:
            course, y[1] = -course, 0.0
            largest = max(largest, abs(y[0]))
    case = bare_frame(
        frame={"T_s": T_s, "xi_s": xi},
        motion=PULSE,
        solver={"t_end": 4.0, "rtol": 1e-11, "method": "dop853"},
        **{"yielding": {"u_y": u_y, "hardening": hardening, "law": "bouc_wen",
                        "exponent": exponent, "beta": beta}},
    )  # fmt: skip
    run = rwmf.simulate(case)
    assert float(run["u_s_max"]) == pytest.approx(largest, rel=1e-8)
    assert float(run["residual_displacement"]) == pytest.approx(
        slowly_unloaded(y[0], y[2], u_y, hardening, beta, exponent), rel=1e-7
    )


@pytest.mark.parametrize(
    ("exponent", "start"), [(1.0, 0.3), (1.7, -0.4), (5.0, 0.12), (60.0, 0.08)]
)
def test_wall_let_go_with_a_smoothly_yielding_frame(exponent: float, start: float) -> None:
    """An initial rotation counts as reached from zero: z from the quadrature of 1/(1 - z^n)."""
    u_y, hardening, beta, gamma, xi, T_s = 0.08, 0.1, 0.6, 3.0, 0.05, 0.8
    h, b, t_end = 2.0, 0.5, 0.1
    radius, alpha, omega = math.hypot(h, b), math.atan2(b, h), 2 * math.pi / T_s
    side = 1 if start > 0 else -1

    def frame(theta: float) -> tuple[float, float, float]:
        angle = alpha - side * theta
        up = 2 * radius
        u = side * up * (math.sin(alpha) - math.sin(angle))
        return u, up * math.cos(angle), side * up * math.sin(angle)

    def rates(_t: float, y: np.ndarray) -> list[float]:
        theta, rate, z = y
        u, slope, bend = frame(theta)
        force = (
            omega**2 * (hardening * u + (1 - hardening) * u_y * z) + 2 * xi * omega * slope * rate
        )
        moment = -gamma * slope * (force + bend * rate**2)
        moment -= side * G * radius * math.sin(alpha - side * theta)
        course = math.copysign(1.0, -side * z)
        lost = abs(z) ** exponent * (1 - beta + beta * course)
        inertia = 4 / 3 * radius**2 + gamma * slope**2
        return [rate, moment / inertia, slope * rate / u_y * (1 - lost)]

    x = abs(frame(start * alpha)[0]) / u_y

    def excess(w: float) -> float:
        path = quad(lambda s: 1 / (1 - s**exponent), 0, -math.expm1(-w), epsabs=0, epsrel=1e-12)
        return path[0] - x

    z = -math.expm1(-brentq(excess, 1e-6, 10.0, xtol=1e-13))
    assert 0.5 < z < 1
    flow = solve_ivp(rates, (0, t_end), [start * alpha, 0.0, side * z], **TIGHT)
    case = coupled(
        wall={"h": h, "b": b},
        frame={"T_s": T_s, "gamma": gamma, "xi_s": xi},
        cable=None,
        motion={"kind": "none", "a_max_g": None, "omega_p": None},
        initial={"theta_over_alpha": start},
        solver={"t_end": t_end, "rtol": 1e-12, "method": "dop853"},
        output={"energy": True},
        **{"yielding": {"u_y": u_y, "hardening": hardening, "law": "bouc_wen",
                        "exponent": exponent, "beta": beta}},
    )  # fmt: skip
    run = rwmf.simulate(case, dt=t_end)
    assert int(run["impacts"]) == 0
    u = frame(start * alpha)[0]
    force = omega**2 * (hardening * u + (1 - hardening) * u_y * side * z) / G
    assert float(run["frame_force_over_m_s_g"][0]) == pytest.approx(force, rel=1e-9)
    assert float(run["theta"][-1]) == pytest.approx(flow.y[0, -1], rel=1e-8)
    assert abs(float(run["energy_balance_relative"])) < 1e-9


def test_keys_of_the_reduction() -> None:
    """Period, modal mass, participation and height of the first mode, by `scipy.linalg.eigh`."""
    m, k, height = [3.0, 2.0, 1.0], [900.0, 700.0, 400.0], [5.0, 4.0, 3.0]
    case = coupled(
        wall={"h": H, "b": B},
        frame={"T_s": None, "gamma": None},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height},
        solver={"t_end": 1.0},
    )
    found = rwmf.simulate(case)
    assert {name: found[name].attrs["units"] for name in ("T_s", "modal_height")} == {
        "T_s": "s",
        "modal_height": "m",
    }
    model = Storeys(m, k, 0.0)
    squares, modes = eigh(model.k, np.diag(m))
    share = model.m @ modes[:, 0]
    assert found["T_s"] == pytest.approx(2 * math.pi / math.sqrt(squares[0]), rel=1e-12)
    assert found["modal_mass_over_m_w"] == pytest.approx(share**2, rel=1e-12)
    assert found["mass_participation"] == pytest.approx(share**2 / 6.0, rel=1e-12)
    arms = np.cumsum(height) * model.m @ modes[:, 0]
    assert found["modal_height"] == pytest.approx(arms / share, rel=1e-12)
    assert found["roof_factor"] == pytest.approx(share * modes[-1, 0], rel=1e-12)


def test_history_of_the_floors() -> None:
    """Floors, roof and the drifts between them; states as the kernel has them."""
    m, k, height = [3.0, 2.0, 1.5], [600.0, 500.0, 300.0], [5.0, 4.0, 3.0]
    frame = Storeys(m, k, 0.05)
    case = bare_frame(
        frame={"T_s": None, "xi_s": 0.05},
        motion=PULSE,
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": "full"},
        solver={"t_end": 2.0, "rtol": 1e-11, "method": "dop853"},
    )
    run = rwmf.simulate(case, dt=0.1)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        u, v = y[:3], y[3:]
        return np.concatenate([v, -(frame.k @ u + frame.c @ v) / frame.m - ground(t)])

    pieces = [(0.0, PULSE_END), (PULSE_END, 2.0)]
    y, found = np.zeros(6), []
    t = run["time"].values
    for begin, end in pieces:
        part = t[(t >= begin) & (t <= end)]
        flow = solve_ivp(rates, (begin, end), y, dense_output=True, **TIGHT)
        found.append(flow.sol(part))
        y = flow.y[:, -1]
    u = np.hstack(found)[:3]
    for i, name in enumerate(("floor_1", "floor_2", "u_s")):
        assert run[name].values == pytest.approx(u[i], abs=1e-8)
        drift = np.diff(np.vstack([np.zeros(t.size), u]), axis=0)[i] / height[i]
        assert run[f"storey_{i + 1}_drift"].values == pytest.approx(drift, abs=1e-8)
    assert run["floor_1"].attrs["units"] == "m"
    assert case.kernel.inventory()["states"] == [
        "u_s_m",
        "u_s_dot_m_s",
        "floor_1_m",
        "floor_2_m",
        "floor_1_dot_m_s",
        "floor_2_dot_m_s",
    ]


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor", "dop853"])
def test_wall_that_never_lifts_off(method: str) -> None:
    """An implicit method must not give the resting wall a rotation out of round-off."""
    case = coupled(
        wall={"h": H, "b": B},
        frame={"T_s": None, "gamma": None, "xi_s": 0.02},
        storeys={
            "m_over_m_w": [1.0, 1.0],
            "k_over_m_w": [800.0, 800.0],
            "height": [H, H],
            "coupling": "full",
        },
        cable=None,
        impact={"e": 0.9},
        motion={"kind": "one_sine", "a_max_g": 0.02, "omega_p": 4.0},
        solver={"t_end": 2.0, "method": method},
    )
    run = rwmf.simulate(case, dt=0.1)
    assert int(run["lift_offs"]) == 0
    assert float(run["theta_dot_max"]) == 0
    assert abs(run["floor_1"]).max() > 1e-4


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor", "dop853"])
def test_a_wall_that_stays_at_rest_does_not_move(method: str) -> None:
    """Not by round-off either: a response of 1e-45 rad became the scale of the tolerances."""
    run = rwmf.simulate(
        rwmf.Case(
            wall={"h": 2.0, "b": 0.5},
            frame={"xi_s": 0.0},
            storeys={
                "m_over_m_w": [0.18, 0.11, 0.21],
                "k_over_m_w": [1450.0, 1020.0, 15000.0],
                "height": [1.3, 1.7, 1.0],
                "coupling": "full",
            },
            cable={"eta_0": 4.0, "eta_alpha": 7.0},
            impact={"e": 0.9},
            model={"formulation": "symmetric"},
            motion={"kind": "ricker", "a_max_g": 0.57, "T_p": 1.4},
            solver={"t_end": 4.0, "method": method, "rtol": 1e-10, "max_steps": 20_000},
        ),
        dt=0.01,
    )
    assert int(run["lift_offs"]) == 0
    assert np.all(run["theta"].values == 0)
    assert np.max(np.abs(run["floor_1"].values)) > 1e-4


def test_modes_that_cannot_be_found() -> None:
    stiff, soft = 1e9, 1e-9
    storeys = {
        "m_over_m_w": 5 * [1.0],
        "k_over_m_w": [stiff, soft, stiff, soft, soft],
        "height": 5 * [0.8],
        "coupling": "full",
    }
    with pytest.raises(rwmf.NumericalError, match="DSYGV"):
        _ = coupled(frame={"T_s": None, "gamma": None, "xi_s": 0.05}, storeys=storeys).kernel
