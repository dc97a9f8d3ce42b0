"""Wall on a strip of springs by Newton and Euler: a second program beside `&base`.

The balance of forces and of moments about the centroid gives three linear equations for the
accelerations. SciPy integrates them, and its events cut the motion where the base slips or sticks.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp

Motion = Callable[[float], float]


@dataclass
class CompliantWall:
    """Wall, strip, single mass at the roof and tendon; lengths in m, forces over the mass."""

    h: float
    b: float
    kappa: float
    delay: float = 0.0
    mu: float | None = None
    gamma: float = 0.0
    omega_s: float = 0.0
    xi_s: float = 0.0
    eta_0: float = 0.0
    eta_alpha: float | None = None
    g: float = 9.81
    ground: Motion = lambda t: 0.0
    upward: Motion = lambda t: 0.0
    slip: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Stress the tendon on the settled wall."""
        self.z_0 = -self.g * (1 + self.eta_0) / (2 * self.b * self.kappa)
        alpha = np.arctan2(self.b, self.h)
        top = np.array(
            [
                2 * self.h * np.sin(alpha) + self.b * (1 - np.cos(alpha)),
                2 * self.h * np.cos(alpha) + self.b * np.sin(alpha),
            ]
        )
        stretch = np.hypot(*top) - 2 * self.h
        last = self.eta_0 if self.eta_alpha is None else self.eta_alpha
        self.slope = (last - self.eta_0) / stretch
        self.rest = 2 * self.h + self.z_0

    def pressure(self, y: np.ndarray) -> tuple[float, float]:
        """Force and moment about the middle of the stresses on the base, by Gauss' rule."""
        _, _, z, z_dot, theta, theta_dot = y[:6]
        deep = np.array([np.sin(theta), -z])
        rate = np.array([np.cos(theta) * theta_dot, -z_dot])
        stress = deep + self.delay * rate
        ends = [-self.b, self.b]
        ends += [-line[1] / line[0] for line in (deep, stress) if line[0] != 0]
        ends = sorted(e for e in ends if -self.b <= e <= self.b)
        nodes, weights = np.polynomial.legendre.leggauss(3)
        force = moment = 0.0
        for a, e in pairwise(ends):
            at = (a + e) / 2 + (e - a) / 2 * nodes
            p = np.where(
                deep[0] * at + deep[1] > 0, np.maximum(0.0, stress[0] * at + stress[1]), 0.0
            )
            force += self.kappa * (e - a) / 2 * np.sum(weights * p)
            moment += self.kappa * (e - a) / 2 * np.sum(weights * p * at)
        return force, moment

    def accelerations(self, t: float, y: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Accelerations of x, z and theta, and the forces N and H of the base."""
        x, x_dot, z, _, theta, theta_dot = y[:6]
        s, c = np.sin(theta), np.cos(theta)
        h, b = self.h, self.b
        normal, about_middle = self.pressure(y)
        corner = np.array([-b * c + 2 * h * s, b * s + 2 * h * c])
        u = x + corner[0] + b
        u_dot = x_dot + (2 * h * c + b * s) * theta_dot
        axis = np.array([x + 2 * h * s, z + 2 * h * c])
        length = np.hypot(*axis)
        pull = self.g * max(0.0, self.eta_0 + self.slope * (length - self.rest))
        tendon = -pull * axis / length

        def balance(a: np.ndarray, shear: float) -> np.ndarray:
            x_2, z_2, turn = a
            centre = np.array(
                [x_2 + h * (c * turn - s * theta_dot**2), z_2 - h * (s * turn + c * theta_dot**2)]
            )
            u_2 = x_2 + (2 * h * c + b * s) * turn + (-2 * h * s + b * c) * theta_dot**2
            link = -self.gamma * (
                u_2 + self.ground(t) + 2 * self.xi_s * self.omega_s * u_dot + self.omega_s**2 * u
            )
            force = np.array(
                [
                    shear + link + tendon[0] - self.ground(t),
                    normal + tendon[1] - self.g - self.upward(t),
                ]
            )
            # moments about the centroid, clockwise
            arm = corner - h * np.array([s, c])
            moment = arm[1] * link + h * (c * tendon[0] - s * tendon[1]) - h * c * shear
            moment += h * s * normal - c * about_middle
            return np.array([*(centre - force), (h**2 + b**2) / 3 * turn - moment])

        zero = balance(np.zeros(3), 0.0)
        columns = [balance(unit, 0.0) - zero for unit in np.eye(3)]
        if self.mu is not None and self.slip != 0:
            shear = -self.slip * self.mu * normal
            return np.linalg.solve(np.array(columns).T, -balance(np.zeros(3), shear)), normal, shear
        columns[0] = balance(np.zeros(3), 1.0) - zero
        solution = np.linalg.solve(np.array(columns).T, -zero)
        return np.array([0.0, *solution[1:]]), normal, solution[0]

    def rates(self, t: float, y: np.ndarray) -> np.ndarray:
        """First-order form."""
        a, _, _ = self.accelerations(t, y)
        return np.array([y[1], a[0], y[3], a[1], y[5], a[2]])

    def run(
        self, times: np.ndarray, theta: float = 0.0, z: float | None = None, rtol: float = 1e-12
    ) -> tuple[np.ndarray, int]:
        """States at the given times (times, 6) and the number of slips; each interval is smooth."""
        y = np.array([0.0, 0.0, self.z_0 if z is None else z, 0.0, theta, 0.0])
        rows, slips, t = [y.copy()], 0, times[0]
        for end in times[1:]:
            while t < end:
                events = self._events()
                part = solve_ivp(
                    self.rates,
                    (t, end),
                    y,
                    method="DOP853",
                    rtol=rtol,
                    atol=1e-15,
                    events=events,
                    max_step=0.7 / np.sqrt(2 * self.b * self.kappa),
                )
                y, t = part.y[:, -1].copy(), part.t[-1]
                if part.status == 1:
                    slips += self._change(t, y)
            rows.append(y.copy())
        return np.array(rows), slips

    def _events(self) -> list[Callable[[float, np.ndarray], float]]:
        if self.mu is None:
            return []

        def limit(t: float, y: np.ndarray) -> float:
            _, normal, shear = self.accelerations(t, y)
            return self.mu * normal - abs(shear)

        def speed(t: float, y: np.ndarray) -> float:
            return self.slip * y[1]

        event = limit if self.slip == 0 else speed
        event.terminal, event.direction = True, -1
        return [event]

    def _change(self, t: float, y: np.ndarray) -> int:
        if self.slip != 0:
            y[1], self.slip = 0.0, 0
            _, normal, shear = self.accelerations(t, y)
            if abs(shear) <= self.mu * normal:
                return 0
        else:
            _, _, shear = self.accelerations(t, y)
        self.slip = -int(np.sign(shear))
        return 1
