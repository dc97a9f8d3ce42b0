"""A hinged wall with devices under both corners and a short link, against a separate program.

The program derives the equation of motion by Lagrange's equations from the energies of wall, frame
and devices. Derivatives by the rotation are complex steps.
"""

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
import rwmf
from scenes import coupled
from scipy.integrate import solve_ivp

G = 9.81
H, B = 2.0, 0.5
T_S, GAMMA, XI = 0.9, 3.0, 0.03
OMEGA, PEAK = 5.0, 0.5
PULSE_END = 2 * math.pi / OMEGA
T_END = 3.0
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
DAMPER = {"c_over_m_w": 1.5}
INERTER = {"inertance_over_m_w": 2.0}
FUSE = {"eta_y": 0.3, "stroke_y": 0.004, "hardening": 0.05}
LINK = {"L": 5.0}


def ground(t: float) -> float:
    """Return the ground acceleration of the pulse [m/s2]."""
    return PEAK * G * math.sin(OMEGA * t) if t < PULSE_END else 0.0


def _slope(function: Callable[[complex], complex], x: float) -> float:
    return function(complex(x, 1e-30)).imag / 1e-30


class Hinged:
    """Equation of motion and memory of the fuses.

    Parameters
    ----------
    c, beta : float
        Damping and inertance of one corner over m_w [1/s], [-].
    length : float, optional
        Of the link [m]; None: infinite.
    fuse : bool
        With fuses under both corners.
    """

    def __init__(self, c: float, beta: float, length: float | None, *, fuse: bool) -> None:
        self.c, self.beta, self.length, self.fuse = c, beta, length, fuse
        self.plastic, self.branch = 0.0, 0
        self.k = FUSE["eta_y"] * G / FUSE["stroke_y"]
        self.modulus = FUSE["hardening"] * self.k / (1 - FUSE["hardening"])

    def u(self, x: complex) -> complex:
        """Displacement of the frame [m]: the link follows the middle of the top, which sinks."""
        if self.length is None:
            return 2 * H * cmath.sin(x)
        sunk = 2 * H * (1 - cmath.cos(x))
        return 2 * H * cmath.sin(x) + self.length - cmath.sqrt(self.length**2 - sunk**2)

    def slope(self, x: complex) -> complex:
        """Its derivative, written down."""
        if self.length is None:
            return 2 * H * cmath.cos(x)
        sunk = 2 * H * (1 - cmath.cos(x))
        return 2 * H * cmath.cos(x) + sunk * 2 * H * cmath.sin(x) / cmath.sqrt(
            self.length**2 - sunk**2
        )

    @staticmethod
    def stroke(x: complex) -> complex:
        """Return the extension of the left corner, and the compression of the right [m]."""
        return 2 * B * cmath.sin(x / 2)

    def inertia(self, x: complex) -> complex:
        """Twice the kinetic energy over m_w and theta'^2 [m2]."""
        wall = 4 / 3 * H**2 + B**2 / 3
        return wall + GAMMA * self.slope(x) ** 2 + 2 * self.beta * (B * cmath.cos(x / 2)) ** 2

    def force(self, x: float) -> float:
        """Force of the left fuse [m/s2]."""
        s = self.stroke(x).real
        if self.branch:
            flow = (self.k * s - self.branch * FUSE["eta_y"] * G) / (self.k + self.modulus)
            return self.branch * FUSE["eta_y"] * G + self.modulus * flow
        return self.k * (s - self.plastic)

    def rates(self, t: float, y: np.ndarray) -> list[float]:
        """Return theta' and theta''."""
        x, rate = y
        arm = self.slope(x).real
        omega = 2 * math.pi / T_S
        moment = GAMMA * arm * (omega**2 * self.u(x).real + 2 * XI * omega * arm * rate)
        moment += (GAMMA * arm + H * math.cos(x)) * ground(t) - G * H * math.sin(x)
        stroke_slope = _slope(self.stroke, x)
        moment += 2 * self.c * stroke_slope**2 * rate
        if self.fuse:
            moment += 2 * self.force(x) * stroke_slope
        moment += _slope(self.inertia, x) / 2 * rate**2
        return [rate, -moment / self.inertia(x).real]

    def run(self) -> tuple[float, float, int]:
        """Return the largest |u_s| [m], theta at the end and the number of yieldings."""
        t, y, largest, yieldings = 0.0, np.zeros(2), 0.0, 0
        while t < T_END:
            stop = PULSE_END if t < PULSE_END else T_END

            def turn(_t: float, y: np.ndarray) -> float:
                return float(y[1])

            def limit(_t: float, y: np.ndarray) -> float:
                if not self.fuse or self.branch:
                    return 1.0
                excess = abs(self.force(y[0]) - self.modulus * self.plastic)
                return FUSE["eta_y"] * G - excess

            turn.terminal = True
            turn.direction = -np.sign(y[1]) if y[1] else 0
            limit.terminal, limit.direction = True, -1
            piece = solve_ivp(self.rates, (t, stop), y, events=[turn, limit], **TIGHT)
            t, y = float(piece.t[-1]), piece.y[:, -1]
            largest = max(largest, abs(self.u(y[0])))
            if piece.t_events[0].size:
                y[1] = 0.0
                if self.branch:
                    s = self.stroke(y[0]).real
                    self.plastic = (self.k * s - self.branch * FUSE["eta_y"] * G) / (
                        self.k + self.modulus
                    )
                    self.branch = 0
                # the next turn is the other way: leave this one behind
                step = solve_ivp(self.rates, (t, t + 1e-6), y, **TIGHT)
                t, y = float(step.t[-1]), step.y[:, -1]
            elif piece.t_events[1].size:
                self.branch = int(np.sign(y[1]))
                yieldings += 1
        return largest, float(y[0]), yieldings


def _case(**changes: dict[str, object] | None) -> rwmf.Case:
    return coupled(
        wall={"h": H, "b": B, "base": "pinned"},
        frame={"T_s": T_S, "gamma": GAMMA, "xi_s": XI},
        cable=None,
        impact=None,
        motion={"kind": "one_sine", "a_max_g": PEAK, "omega_p": OMEGA},
        solver={"t_end": T_END, "rtol": 1e-12, "method": "dop853"},
        output={"energy": True, "reactions": True},
        **changes,
    )


@pytest.mark.parametrize(
    ("groups", "model"),
    [
        ({"damper": DAMPER}, Hinged(1.5, 0.0, None, fuse=False)),
        ({"inerter": INERTER}, Hinged(0.0, 2.0, None, fuse=False)),
        ({"link": LINK}, Hinged(0.0, 0.0, 5.0, fuse=False)),
        ({"fuse": FUSE}, Hinged(0.0, 0.0, None, fuse=True)),
        (
            {"damper": DAMPER, "inerter": INERTER, "link": LINK, "fuse": FUSE},
            Hinged(1.5, 2.0, 5.0, fuse=True),
        ),
    ],
)
def test_against_scipy(groups: dict[str, dict[str, object]], model: Hinged) -> None:
    run = rwmf.simulate(_case(**groups), dt=T_END)
    largest, last, yieldings = model.run()
    assert float(run["u_s_max"]) == pytest.approx(largest, rel=1e-7)
    assert float(run["theta"][-1]) == pytest.approx(last, rel=1e-7)
    assert abs(float(run["energy_balance_relative"])) < 1e-9
    if model.fuse:
        assert yieldings > 2
        forces = [float(run[f"fuse_{side}_force_over_m_w_g"][-1]) for side in ("left", "right")]
        assert forces == pytest.approx([model.force(last) / G, -model.force(last) / G], rel=1e-6)


def test_small_motion_has_the_damping_of_both_corners() -> None:
    """Two dampers at the arm b: c 2 b^2 theta' on the inertia of wall and frame."""
    stiffness = GAMMA * (2 * H * 2 * math.pi / T_S) ** 2 - G * H
    inertia = 4 / 3 * H**2 + B**2 / 3 + GAMMA * 4 * H**2
    c = 4.0
    run = rwmf.simulate(
        _case(damper={"c_over_m_w": c}).replace(
            frame={"xi_s": 0.0},
            motion={"kind": "none", "a_max_g": None, "omega_p": None},
            initial={"theta_over_alpha": 1e-4},
        ),
        dt=0.01,
    )
    decay = c * B**2 / inertia
    omega = math.sqrt(stiffness / inertia - decay**2)
    t = run["time"].values
    expected = np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    start = 1e-4 * math.atan2(B, H)
    assert run["theta"].values / start == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    "vanishing",
    [
        {"link": {"L": 1e12}},
        {"damper": {"c_over_m_w": 0.0}},
        {"inerter": {"inertance_over_m_w": 0.0}},
        {"fuse": {"eta_y": 1e-15, "stroke_y": 0.01}},
    ],
)
def test_limit(vanishing: dict[str, dict[str, object]]) -> None:
    plain = rwmf.simulate(_case())
    run = rwmf.simulate(_case(**vanishing))
    assert float(run["u_s_max"]) == pytest.approx(float(plain["u_s_max"]), rel=1e-10)


def test_short_link_with_a_yielding_frame_up_to_the_rotation_that_it_allows() -> None:
    """As for `exact`: beyond, the frame turns back while the wall goes on."""
    strong = {"yielding": {"u_y": 0.02}, "link": {"L": 4.1}}
    with pytest.raises(rwmf.InputError) as refused:
        _case(**strong)
    limit = float(str(refused.value).split("overturning_angle <= ")[1].split(" ")[0])
    run = rwmf.simulate(
        _case().replace(**strong, model={"formulation": "symmetric", "overturning_angle": limit})
    )
    assert abs(float(run["energy_balance_relative"])) < 1e-9


@pytest.mark.parametrize(("frame", "falls"), [(None, True), ({"T_s": T_S, "gamma": GAMMA}, False)])
def test_a_run_says_whether_it_lies_on_its_side(
    frame: dict[str, object] | None, falls: bool
) -> None:
    """Nothing but a frame holds a hinged wall up."""
    run = rwmf.simulate(_case().replace(frame=frame))
    assert bool(run["overturned"]) is falls
