"""Wall on a strip of springs by Newton and Euler: a second program beside `&base`.

The balance of forces and of moments about the centroid gives three linear equations for the
accelerations. SciPy integrates them. Its events cut the motion at every kink of the forces: where
contact reaches an edge, the tendon slackens, the base slips or sticks, and strips or fuses yield.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Motion = Callable[[float], float]
State = Sequence[float]
_NODES = [(float(x), float(w)) for x, w in zip(*np.polynomial.legendre.leggauss(3), strict=True)]
OFF, PRESSED, CRUSHING, SETTLED = range(4)
_GRAZE = 1e-11  # s
_MOST_EVENTS = 20000


@dataclass
class Device:
    """Fuse or damper under the base, forces over the mass of the wall; or the frame's spring."""

    offset: float
    c: float = 0.0
    strength: float = 0.0
    stroke_y: float = 1.0
    hardening: float = 0.0
    flow: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Find the elastic stiffness and the modulus of the back stress."""
        self.k = self.strength / self.stroke_y
        self.modulus = self.hardening * self.k / (1 - self.hardening)

    def reserve(self, stroke: float, plastic: float, sign: int) -> float:
        """Force that is left until the fuse yields in a direction."""
        return self.strength - sign * (self.k * (stroke - plastic) - self.modulus * plastic)


@dataclass
class CompliantWall:
    """Wall, strip, single mass at the roof, tendon, devices; lengths in m, forces over the mass."""

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
    devices: Sequence[Device] = ()
    roof: Device | None = None
    strips: int = 0
    d_y: float = math.inf
    slip: int = field(default=0, init=False)
    peaks: dict[str, float] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        """Stress the tendon on the settled wall."""
        self.z_0 = -self.g * (1 + self.eta_0) / (2 * self.b * self.kappa)
        alpha = math.atan2(self.b, self.h)
        top = (
            2 * self.h * math.sin(alpha) + self.b * (1 - math.cos(alpha)),
            2 * self.h * math.cos(alpha) + self.b * math.sin(alpha),
        )
        last = self.eta_0 if self.eta_alpha is None else self.eta_alpha
        self.slope = (last - self.eta_0) / (math.hypot(*top) - 2 * self.h)
        self.rest = 2 * self.h + self.z_0
        self.places = [self.b * ((2 * i + 1) / self.strips - 1) for i in range(self.strips)]
        self.kinds = [PRESSED] * self.strips
        self.depths = [0.0] * self.strips
        self.fuses = [d for d in self.devices if d.strength > 0]
        self.springs = self.fuses if self.roof is None else [*self.fuses, self.roof]

    def settlement(self, place: float, y: State) -> tuple[float, float]:
        """Settlement of a point of the base and its rate."""
        return (
            place * math.sin(y[4]) - y[2],
            place * math.cos(y[4]) * y[5] - y[3],
        )

    def pressure(self, y: State) -> tuple[float, float]:
        """Force and moment about the middle of the stresses on the base."""
        force = moment = 0.0
        if self.strips:
            for place, kind, depth in zip(self.places, self.kinds, self.depths, strict=True):
                d, rate = self.settlement(place, y)
                stress = self.delay * rate + (self.d_y if kind == CRUSHING else d - depth)
                if kind in (PRESSED, CRUSHING):
                    force += stress
                    moment += stress * place
            width = 2 * self.b * self.kappa / self.strips
            return width * force, width * moment
        deep = (math.sin(y[4]), -y[2])
        rate = (math.cos(y[4]) * y[5], -y[3])
        stress = (deep[0] + self.delay * rate[0], deep[1] + self.delay * rate[1])
        ends = [-self.b, self.b]
        ends += [-line[1] / line[0] for line in (deep, stress) if line[0] != 0]
        for a, e in pairwise(sorted(e for e in ends if -self.b <= e <= self.b)):
            half = (e - a) / 2
            if deep[0] * (a + half) + deep[1] <= 0 or stress[0] * (a + half) + stress[1] <= 0:
                continue
            for node, weight in _NODES:
                at = a + half + half * node
                part = half * weight * (stress[0] * at + stress[1])
                force += part
                moment += part * at
        return self.kappa * force, self.kappa * moment

    def stroke(self, device: Device, y: State) -> tuple[float, float]:
        """Displacement of a point of the base along the line that halves the rotation, its rate.

        That of the frame is the displacement of the roof.
        """
        s, c = math.sin(y[4]), math.cos(y[4])
        if device is self.roof:
            u = y[0] + 2 * self.h * s + self.b * (1 - c)
            return u, y[1] + (2 * self.h * c + self.b * s) * y[5]
        gone = (y[0] + device.offset * (c - 1), y[2] - self.z_0 - device.offset * s)
        speed = (y[1] - device.offset * s * y[5], y[3] - device.offset * c * y[5])
        line = (math.sin(y[4] / 2), math.cos(y[4] / 2))
        across = gone[0] * line[1] - gone[1] * line[0]
        return (
            gone[0] * line[0] + gone[1] * line[1],
            speed[0] * line[0] + speed[1] * line[1] + across * y[5] / 2,
        )

    def pulls(self, y: State) -> tuple[float, float, float]:
        """Force of the devices on the wall and its clockwise moment about the centroid.

        Each force acts through the middle between the point and its place at rest.
        """
        force = [0.0, 0.0, 0.0]
        plastic = dict(zip(map(id, self.fuses), y[6:], strict=False))
        s, c = math.sin(y[4]), math.cos(y[4])
        centroid = (y[0] + self.h * s, y[2] + self.h * c)
        for device in self.devices:
            stroke, rate = self.stroke(device, y)
            pull = device.c * rate + device.k * (stroke - plastic.get(id(device), 0.0))
            x, z = -pull * math.sin(y[4] / 2), -pull * math.cos(y[4] / 2)
            at = (
                (y[0] + device.offset * (c + 1)) / 2 - centroid[0],
                (y[2] - device.offset * s + self.z_0) / 2 - centroid[1],
            )
            force[0] += x
            force[1] += z
            force[2] += at[1] * x - at[0] * z
        return force[0], force[1], force[2]

    def accelerations(self, t: float, y: State) -> tuple[list[float], float, float]:
        """Accelerations of x, z and theta, and the forces N and H of the base."""
        x, x_dot, z, _, theta, theta_dot = y[:6]
        s, c = math.sin(theta), math.cos(theta)
        h, b = self.h, self.b
        normal, about_middle = self.pressure(y)
        devices = self.pulls(y)
        gain, bend = 2 * h * c + b * s, (b * c - 2 * h * s) * theta_dot**2
        u = x + 2 * h * s + b * (1 - c)
        u_dot = x_dot + gain * theta_dot
        axis = (x + 2 * h * s, z + 2 * h * c)
        length = math.hypot(*axis)
        pull = self.g * max(0.0, self.eta_0 + self.slope * (length - self.rest))
        tendon = (-pull * axis[0] / length, -pull * axis[1] / length)
        ground = self.ground(t)
        plastic = 0.0 if self.roof is None else y[-1]
        spring = self.gamma * (
            bend + ground + 2 * self.xi_s * self.omega_s * u_dot + self.omega_s**2 * (u - plastic)
        )
        # the link acts at the left top corner: arm from the centroid (-b c + h s, b s + h c)
        arm = b * s + h * c
        # rows: balance along x, along z, about the centroid; columns: x'', z'', theta'', H
        rows = [
            [
                1 + self.gamma,
                0.0,
                h * c + self.gamma * gain,
                -1.0,
                h * s * theta_dot**2 - spring + tendon[0] - ground + devices[0],
            ],
            [
                0.0,
                1.0,
                -h * s,
                0.0,
                h * c * theta_dot**2 + normal + tendon[1] + devices[1] - self.g - self.upward(t),
            ],
            [
                arm * self.gamma,
                0.0,
                (h**2 + b**2) / 3 + arm * self.gamma * gain,
                h * c,
                h * (c * tendon[0] - s * tendon[1])
                - arm * spring
                + h * s * normal
                - c * about_middle
                + devices[2],
            ],
        ]
        if self.mu is not None and self.slip != 0:
            shear = -self.slip * self.mu * normal
            known, unknown = (3, shear), 0
        else:
            known, unknown = (0, 0.0), 3
        rhs = [row[4] - row[known[0]] * known[1] for row in rows]
        # z'' follows from the second row
        a, e = rows[0][unknown], rows[0][2]
        k, m = rows[2][unknown], rows[2][2]
        turn = (a * rhs[2] - k * rhs[0]) / (a * m - k * e)
        first = (rhs[0] - e * turn) / a
        rise = rhs[1] + h * s * turn
        if unknown == 0:
            return [first, rise, turn], normal, known[1]
        return [0.0, rise, turn], normal, first

    def rates(self, t: float, y: np.ndarray) -> list[float]:
        """First-order form; plastic strokes follow the states of the wall."""
        y = y.tolist()
        a, _, _ = self.accelerations(t, y)
        flows = [
            f.k / (f.k + f.modulus) * self.stroke(f, y)[1] if f.flow else 0.0 for f in self.springs
        ]
        return [y[1], a[0], y[3], a[1], y[5], a[2], *flows]

    def rest_at(self, theta: float) -> float:
        """Height of the middle of the base under a wall held at a rotation, without devices."""

        def excess(z: float) -> float:
            y = [0.0, 0.0, z, 0.0, theta, 0.0]
            deep = [self.settlement(place, y)[0] for place in self.places]
            self.kinds = [CRUSHING if d > self.d_y else PRESSED if d > 0 else OFF for d in deep]
            self.depths = [max(0.0, d - self.d_y) for d in deep]
            span = (2 * self.h * math.sin(theta), z + 2 * self.h * math.cos(theta))
            length = math.hypot(*span)
            pull = max(0.0, self.eta_0 + self.slope * (length - self.rest))
            return self.pressure(y)[0] - self.g * (1 + pull * span[1] / length)

        deep = self.b * abs(math.sin(theta))
        low = self.z_0 - deep
        while excess(low) < 0:
            low *= 2
        z = brentq(excess, low, deep, xtol=1e-18, rtol=1e-15)
        excess(z)
        return z

    def run(
        self, times: np.ndarray, theta: float = 0.0, rtol: float = 1e-12
    ) -> tuple[np.ndarray, int]:
        """States at the given times (times, 6) and the number of slips; each interval is smooth.

        `peaks` has the largest magnitudes over the motion.
        """
        y = np.zeros(6 + len(self.springs))
        y[2], y[4] = self.rest_at(theta) if theta else self.z_0, theta
        self.peaks = dict.fromkeys(("theta", "u", "x", "settlement", "stroke"), 0.0)
        self.sides: dict[str, bool] = {}
        rows, slips, t, pieces = [y.copy()], 0, times[0], 0
        for end in times[1:]:
            # the ground motion may jump
            if self.mu is not None and self.slip == 0:
                _, normal, shear = self.accelerations(t, y.tolist())
                slips += self._begin_slip(t, y) if abs(shear) > self.mu * normal else 0
            while t < end:
                pieces += 1
                if pieces > _MOST_EVENTS:
                    raise RuntimeError(f"no way on at t = {t} s")
                events = self._events(t, y.tolist())
                part = solve_ivp(
                    self.rates,
                    (t, end),
                    y,
                    method="DOP853",
                    rtol=rtol,
                    atol=1e-15,
                    events=[call for call, _ in events] + self._turns(),
                    max_step=0.7 / math.sqrt(2 * self.b * self.kappa),
                )
                y, t = part.y[:, -1].copy(), part.t[-1]
                for seen in (part.y.T, *part.y_events[len(events) :]):
                    for row in seen:
                        self._note(row.tolist())
                if part.status == 1:
                    for (_, change), found in zip(events, part.t_events, strict=False):
                        if found.size and found[-1] == t:
                            slips += change(t, y) or 0
            rows.append(y.copy())
        self.last = y.tolist()
        return np.array(rows)[:, :6], slips

    def crushed(self) -> float:
        """Largest crushed depth at the end; one that still grows ends at the last settlement."""
        return max(
            (
                self.settlement(place, self.last)[0] - self.d_y if kind == CRUSHING else depth
                for place, kind, depth in zip(self.places, self.kinds, self.depths, strict=True)
            ),
            default=0.0,
        )

    def _note(self, y: State) -> None:
        """Update the peaks."""
        s, c = math.sin(y[4]), math.cos(y[4])
        found = {
            "theta": abs(y[4]),
            "u": abs(y[0] + 2 * self.h * s + self.b * (1 - c)),
            "x": abs(y[0]),
            "settlement": self.b * abs(s) - y[2],
            "stroke": max((abs(self.stroke(f, y)[0]) for f in self.fuses), default=0.0),
        }
        for name, value in found.items():
            self.peaks[name] = max(self.peaks[name], value)

    def _turns(self) -> list[Callable[[float, np.ndarray], float]]:
        """Rates of the quantities with peaks."""
        return [
            lambda t, y: y[5],
            lambda t, y: y[1] + (2 * self.h * math.cos(y[4]) + self.b * math.sin(y[4])) * y[5],
            lambda t, y: y[1],
            lambda t, y: self.settlement(self.b, y)[1],
            lambda t, y: self.settlement(-self.b, y)[1],
            *[lambda t, y, f=f: self.stroke(f, y)[1] for f in self.fuses],
        ]

    def _events(self, t: float, y: State) -> list[tuple[Callable, Callable]]:
        """Functions that fall through zero where the motion changes, and the changes."""
        events: list[tuple[Callable, Callable]] = []

        def add(value: Callable, change: Callable) -> None:
            value.terminal, value.direction = True, -1
            events.append((value, change))

        if self.mu is not None:
            if self.slip == 0:
                for sign in (1, -1):
                    add(lambda t, y, s=sign: self._grip(t, y, s), self._begin_slip)
            else:
                add(lambda t, y: self.slip * y[1], self._end_slip)
        for i, fuse in enumerate(self.springs):
            if fuse.flow:
                add(lambda t, y, f=fuse: f.flow * self.stroke(f, y)[1], _flow(fuse, 0))
                continue
            for sign in (1, -1):
                add(
                    lambda t, y, f=fuse, i=i, s=sign: f.reserve(self.stroke(f, y)[0], y[6 + i], s),
                    _flow(fuse, sign),
                )
        for i in range(self.strips):
            self._add_strip(i, add)
        for name, kink in self._kinks().items():
            side = self.sides.setdefault(name, kink(t, y) >= 0)
            add(
                lambda t, y, k=kink, s=1 if side else -1: s * k(t, y),
                lambda t, y, n=name: self.sides.update({n: not self.sides[n]}),
            )
        return events

    def _kinks(self) -> dict[str, Callable[[float, State], float]]:
        """Functions that change sign where a force has a kink."""
        kinks: dict[str, Callable[[float, State], float]] = {}
        if self.slope > 0:
            kinks["tendon"] = lambda t, y: (
                self.eta_0
                + self.slope
                * (
                    math.hypot(
                        y[0] + 2 * self.h * math.sin(y[4]), y[2] + 2 * self.h * math.cos(y[4])
                    )
                    - self.rest
                )
            )
        if self.strips:
            return kinks
        for side in (-1, 1):
            kinks[f"edge {side}"] = lambda t, y, s=side: self.settlement(s * self.b, y)[0]
            if self.delay > 0:
                kinks[f"stress {side}"] = lambda t, y, s=side: (
                    (found := self.settlement(s * self.b, y))[0] + self.delay * found[1]
                )
        if self.delay > 0:
            # both conditions hold at one place
            kinks["cross"] = lambda t, y: y[2] * math.cos(y[4]) * y[5] - y[3] * math.sin(y[4])
        return kinks

    def _add_strip(self, i: int, add: Callable[[Callable, Callable], None]) -> None:
        """Add the functions that end the branch of a strip."""

        def excess(y: State, share: float = 0.0) -> float:
            d, rate = self.settlement(self.places[i], y)
            return d - self.depths[i] + share * self.delay * rate

        def become(kind: int) -> Callable:
            def change(t: float, y: State) -> None:
                d, rate = self.settlement(self.places[i], y)
                if self.kinds[i] == CRUSHING:
                    self.depths[i] = d - self.d_y
                rises = self.kinds[i] == OFF and d - self.depths[i] + self.delay * rate < 0
                self.kinds[i] = SETTLED if rises and self.delay > 0 else kind

            return change

        kind = self.kinds[i]
        if kind == OFF:
            add(lambda t, y: -excess(y), become(PRESSED))
        elif kind == CRUSHING:
            add(lambda t, y: self.settlement(self.places[i], y)[1], become(PRESSED))
        else:
            add(lambda t, y: excess(y), become(OFF))
            if kind == PRESSED:
                add(lambda t, y: self.d_y - excess(y), become(CRUSHING))
            if self.delay > 0:
                sign = 1 if kind == PRESSED else -1
                other = SETTLED if kind == PRESSED else PRESSED
                add(lambda t, y: sign * excess(y, 1.0), become(other))

    def _grip(self, t: float, y: State, sign: int) -> float:
        """Friction that is left, against a force to one side."""
        _, normal, shear = self.accelerations(t, list(y))
        return self.mu * normal - sign * shear

    def _begin_slip(self, t: float, y: State) -> int:
        self.slip = -int(math.copysign(1, self.accelerations(t, list(y))[2]))
        self.begun = t
        return 1

    def _end_slip(self, t: float, y: np.ndarray) -> int:
        y[1], self.slip = 0.0, 0
        _, normal, shear = self.accelerations(t, y.tolist())
        # a slip of no length grazes the limit
        held = abs(shear) <= self.mu * normal or t - self.begun < _GRAZE
        return 0 if held else self._begin_slip(t, y)


def _flow(fuse: Device, direction: int) -> Callable[[float, State], None]:
    """Change of a fuse that begins or ends to yield."""

    def change(t: float, y: State) -> None:
        fuse.flow = direction

    return change
