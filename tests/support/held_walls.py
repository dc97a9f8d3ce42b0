"""Equal walls held by vertical elements, as a system with one degree of freedom in SciPy.

Each element has a stroke x(phi, side), its derivative, and a force; virtual work gives the moment.
Springs that yield are followed by return mapping in fixed steps, everything else by an adaptive
method with located impacts. The program is independent of the kernel.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81


@dataclass
class Element:
    """Vertical element.

    Attributes
    ----------
    kind : str
        'axis', 'line', 'chord', 'rise' or 'pair'.
    d, z : float
        Offset, height of an anchor or of a held point; of a pair, d is the distance 2b + span [m].
    force_0, k, c : float
        Force at zero stroke over the mass of a wall [m/s2], stiffness [1/s2], damper [1/s].
    force_1, exponent : float
        Force of a nonlinear damper at 1 m/s [m/s2], and its exponent [-].
    weight : float
        Number of such elements for each wall.
    is_tendon : bool
        It bears tension only.
    strength, hardening : float
        Force at yield [m/s2]; tangent after yield over k.
    """

    kind: str
    d: float
    z: float = 0.0
    force_0: float = 0.0
    k: float = 0.0
    c: float = 0.0
    force_1: float = 0.0
    exponent: float = 1.0
    weight: float = 1.0
    is_tendon: bool = False
    strength: float = math.inf
    hardening: float = 0.0
    plastic: float = field(default=0.0, init=False)

    def stroke(self, b: float, side: int, phi: float) -> tuple[float, float]:
        """Return the stroke [m] and its derivative [m/rad]."""
        a, z, s, c = b - side * self.d, self.z, math.sin(phi), math.cos(phi)
        if self.kind == "axis":
            return a * phi, a
        if self.kind == "line":
            length = math.sqrt(z * z + 2 * a * a * (1 - c) + 2 * z * a * s)
            return length - z, a * (a * s + z * c) / length
        if self.kind == "chord":
            return 2 * a * math.sin(phi / 2), a * math.cos(phi / 2)
        if self.kind == "pair":
            return side * self.d * s, side * self.d * c
        return a * s - z * (1 - c), a * c - z * s

    def spring(self, x: float) -> tuple[float, float]:
        """Return the force of the spring and its plastic stroke after a change to the stroke x."""
        trial = self.force_0 + self.k * (x - self.plastic)
        if self.is_tendon:
            return max(trial, 0.0), self.plastic
        modulus = self.hardening * self.k / (1 - self.hardening)
        beyond = abs(trial - modulus * self.plastic) - self.strength
        if not beyond > 0:
            return trial, self.plastic
        flow = math.copysign(beyond / (self.k + modulus), trial - modulus * self.plastic)
        return trial - self.k * flow, self.plastic + flow


@dataclass
class Walls:
    """n equal walls that turn together, linked to a frame, in the formulation `exact`."""

    h: float
    b: float
    gamma: float
    period: float
    xi: float
    elements: list[Element] = field(default_factory=list)
    n: int = 1

    def __post_init__(self) -> None:
        """Set angle, half diagonal, frequency and velocity factor."""
        self.alpha, self.radius = math.atan2(self.b, self.h), math.hypot(self.h, self.b)
        self.omega = 2 * math.pi / self.period
        square = math.sin(self.alpha) ** 2
        share = 3 * self.gamma / self.n * (1 - square)
        self.e = 1 - 1.5 * square / (1 + share)

    def frame(self, side: int, phi: float) -> tuple[float, float, float]:
        """Return |u_s| [m] and its two derivatives by phi."""
        if side > 0:
            x, twice = self.alpha - phi, 2 * self.radius
            return (
                twice * (math.sin(self.alpha) - math.sin(x)),
                twice * math.cos(x),
                twice * math.sin(x),
            )
        height = 2 * self.h
        return height * math.sin(phi), height * math.cos(phi), -height * math.sin(phi)

    def acceleration(self, side: int, phi: float, rate: float, ground: float) -> float:
        """Return phi'' [rad/s2]."""
        u, j, k = self.frame(side, phi)
        share, push, omega = self.gamma / self.n, side * ground, self.omega
        x = self.alpha - phi
        moment = -self.radius * (G * math.sin(x) + push * math.cos(x))
        moment -= share * j * (k * rate**2 + 2 * self.xi * omega * j * rate + omega**2 * u + push)
        for element in self.elements:
            stroke, arm = element.stroke(self.b, side, phi)
            speed = arm * rate
            force = element.spring(stroke)[0] + element.c * speed
            force += element.force_1 * math.copysign(abs(speed) ** element.exponent, speed)
            moment -= element.weight * force * arm
        return moment / (4 / 3 * self.radius**2 + share * j * j)

    def let_go(self, phi: float, t_end: float) -> tuple[float, int]:
        """Return theta at the end after a release at theta = phi, and the number of impacts.

        Nothing yields, and the ground rests.
        """
        t, side, state, impacts = 0.0, 1, [phi, 0.0], 0

        def base(_t: float, y: np.ndarray) -> float:
            return float(y[0])

        base.terminal, base.direction = True, -1  # type: ignore[attr-defined]
        while t < t_end:

            def rates(_t: float, y: np.ndarray, side: int = side) -> list[float]:
                return [y[1], self.acceleration(side, y[0], y[1], 0.0)]

            found = solve_ivp(
                rates, (t, t_end), state, "DOP853", rtol=1e-12, atol=1e-15, events=base
            )
            t, state = float(found.t[-1]), [float(x) for x in found.y[:, -1]]
            if found.status == 1:
                impacts += 1
                side, state = -side, [0.0, -self.e * state[1]]
        return side * state[0], impacts

    def push_and_let_go(self, phi: float, t_end: float, dt: float) -> tuple[float, int]:
        """Return the same for springs that yield, in steps of dt with an error of their order."""
        side, y, v, impacts = 1, phi, 0.0, 0
        self._flow(side, y)
        for _ in range(round(t_end / dt)):
            k_1 = self.acceleration(side, y, v, 0.0)
            k_2 = self.acceleration(side, y + dt / 2 * v, v + dt / 2 * k_1, 0.0)
            k_3 = self.acceleration(side, y + dt / 2 * (v + dt / 2 * k_1), v + dt / 2 * k_2, 0.0)
            k_4 = self.acceleration(side, y + dt * (v + dt / 2 * k_2), v + dt * k_3, 0.0)
            y_new = y + dt * (v + dt / 6 * (k_1 + k_2 + k_3))
            v_new = v + dt / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)
            if y_new < 0:
                part = y / (y - y_new)
                self._flow(side, 0.0)
                side, impacts = -side, impacts + 1
                v_new = -self.e * (v + part * (v_new - v))
                y_new = (1 - part) * dt * v_new
            y, v = y_new, v_new
            self._flow(side, y)
        return side * y, impacts

    def _flow(self, side: int, phi: float) -> None:
        for element in self.elements:
            element.plastic = element.spring(element.stroke(self.b, side, phi)[0])[1]
