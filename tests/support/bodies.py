"""Rocking walls and their frames as single bodies, and every demand on them.

Wall and floors have one momentum balance each. At every instant one linear system gives the angular
acceleration of the wall, both forces of the foundation and the force of every link; the same system
gives the impulses of an impact. Section forces of the wall are sums over the mass above, particle
by particle. Between two links shear and moment are polynomials of the height, whose largest values
are at their ends and roots. A piece of motion ends at the next impact, lift-off, change of a spring
or knot of the ground motion. SciPy integrates each piece, and its solution is searched for the
largest demands. The program is independent of the kernel.
"""

import copy
import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from bounded_springs import Spring
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import OptimizeResult, brentq, minimize_scalar

G = 9.81
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
SLOW = 1e-11  # a rate that a turn may leave [m/s]
Array = np.ndarray
Event = Callable[[float, Array], float]
Watched = tuple[str, int, Event, float]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_PLACES = np.array([0.1, 0.35, 0.65, 0.9])  # of a piece of the wall at which forces are summed
_CUBIC = np.linalg.inv(np.vander(_PLACES, 4))


@dataclass
class Ground:
    """Ground acceleration without jumps: straight lines, or half waves of a sine.

    Attributes
    ----------
    knots : list of float
        Times between which it is smooth [s].
    values : list of float
        Acceleration at them [m/s2].
    omega : float
        Angular frequency of a sine that begins at zero; 0: straight lines [rad/s].
    peak : float
        Its amplitude [m/s2].
    """

    knots: list[float]
    values: list[float]
    omega: float = 0.0
    peak: float = 0.0

    def __call__(self, t: float) -> float:
        """Return the acceleration [m/s2]."""
        if t >= self.knots[-1]:
            return 0.0
        if self.omega:
            return self.peak * math.sin(self.omega * t)
        i = max(0, bisect_right(self.knots, t) - 1)
        share = (t - self.knots[i]) / (self.knots[i + 1] - self.knots[i])
        return self.values[i] + share * (self.values[i + 1] - self.values[i])

    def velocity(self, t: float) -> float:
        """Return the velocity, from rest at the first knot [m/s]."""
        t = min(t, self.knots[-1])
        if self.omega:
            return self.peak / self.omega * (1.0 - math.cos(self.omega * t))
        ends = [*(x for x in self.knots if x < t), t]
        at = [self.values[i] for i in range(len(ends) - 1)]
        at.append(self(t) if t < self.knots[-1] else self.values[-1])
        return float(np.trapezoid(at, ends)) if len(ends) > 1 else 0.0


@dataclass
class Body:
    """The wall and its connections."""

    h: float
    b: float
    e: float | None = 0.9  # None: from the momentum balance
    formulation: str = "exact"
    eta: tuple[float, float] | None = None  # cable force at 0 and at alpha, over the weight
    cable: str = "truss"
    damper: float = 0.0  # under each corner, over m_w [1/s]
    fuse: dict[str, Any] | None = None  # `&fuse`


@dataclass
class Scene:
    """A frame, with or without a wall. Masses over one mass, that of the wall."""

    m: Sequence[float]
    k: Sequence[float]
    height: Sequence[float] | None  # None: a single degree of freedom of unknown height
    ground: Ground
    coupling: str = "full"
    is_single: bool = False
    xi: float = 0.05
    lean: float = 0.0
    limit: float = math.inf  # drift at which it has collapsed
    yielding: dict[str, Any] | None = None  # `&yielding`
    wall: Body | None = None
    vertical: float = 0.0  # acceleration upward over the horizontal one

    def __post_init__(self) -> None:
        """Make arrays."""
        self.n = len(self.m)


@dataclass
class Instant:
    """Everything at one instant, forces over the unit of mass."""

    ddot: float  # of the wall's rotation, or of the roof
    links: Array
    pivot: Array  # horizontal and vertical
    absolute: Array
    d: Array
    shear: Array


@dataclass
class Piece:
    """A piece of motion without an event, and the springs in it."""

    t: tuple[float, float]
    at: Callable[[float], Array]
    side: int
    rests: bool
    springs: list[Spring]


@dataclass
class Course:
    """Results of the program."""

    pieces: list[Piece] = field(default_factory=list)
    impacts: list[float] = field(default_factory=list)
    branches: int = 0
    collapse: float | None = None


class Building:
    """A scene in motion.

    The state is the rotation of the wall and its rate, or displacement and velocity of the roof
    without a wall; with all modes displacements and velocities of the floors below the roof follow.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene, self.n, self.wall = scene, scene.n, scene.wall
        self.m, self.columns = np.array(scene.m, float), np.array(scene.k, float)
        self.free = self.n - 1 if scene.coupling == "full" else 0
        self.h, self.b = (scene.wall.h, scene.wall.b) if scene.wall else (0.0, 0.0)
        self.height = np.array(scene.height if scene.height else [np.nan], float)
        self.z = np.cumsum(self.height)
        matrix = _storeys(self.columns)
        squares, modes = eigh(matrix, np.diag(self.m))
        momentum = self.m[:, None] * modes
        self.c = momentum @ np.diag(2 * scene.xi * np.sqrt(squares)) @ momentum.T
        self.share = modes[:, 0] / modes[-1, 0]
        self.places = np.array([1.0])
        if scene.coupling == "every_floor":
            self.share = self.places = self.z / self.z[-1]
            omega = math.sqrt(self.share @ matrix @ self.share / (self.m @ self.share**2))
            self.c = 2 * scene.xi / omega * matrix
        weights = scene.lean * G * np.cumsum(self.m[::-1])[::-1]
        self.push = weights / self.height if scene.lean else np.zeros(self.n)
        self.fastest = math.sqrt(squares[-1])
        self.bend = np.diff(self.share, prepend=0.0)
        self.springs = self._springs(self.share @ matrix @ self.share)
        self._memo: tuple[Any, Any] = (None, None)

    def _springs(self, of_the_roof: float) -> list[Spring]:
        """Return the springs of the storeys, or one of the roof; then the left and right fuse."""
        given = dict(self.scene.yielding or {})
        given.pop("ultimate", None)
        self.is_one = "u_y" in given and self.scene.coupling != "full"
        u_y = given.pop("storey_u_y", None) or [given.pop("u_y", math.inf)] * self.n
        self.u_y = np.array(u_y, float)
        springs = [Spring(k, u, **given) for k, u in zip(self.columns, u_y, strict=True)]
        if self.is_one:
            springs = [Spring(of_the_roof, u_y[0], **given)]
        self.frame_springs = len(springs)
        if self.wall and self.wall.fuse:
            keys = dict(self.wall.fuse)
            force, stroke = keys.pop("eta_y") * G, keys.pop("stroke_y")
            springs += [Spring(force / stroke, stroke, **keys) for _ in range(2)]
        return springs

    # geometry

    def roof(self, y: Array, side: int) -> tuple[float, float, float]:
        """Return the displacement of the roof and its derivatives by the first state."""
        if not self.wall:
            return y[0], 1.0, 0.0
        start = self._corner(side) - side * self.b
        s, c = math.sin(y[0]), math.cos(y[0])
        x, up = c * start + 2 * self.h * s, 2 * self.h * c - s * start
        return x - start, up, -x

    def _corner(self, side: int) -> float:
        """Return the distance of the top corner with the roof's link from the axis."""
        is_left = side > 0 or self.wall.formulation == "exact"
        return -self.b if is_left else self.b

    def floors(self, y: Array, side: int) -> tuple[Array, Array]:
        """Return displacements and velocities of all floors."""
        u, slope, _ = self.roof(y, side)
        if not self.free:
            return self.share * u, self.share * (slope * y[1])
        below = y[2:].reshape(2, self.free)
        return np.append(below[0], u), np.append(below[1], slope * y[1])

    def drawn(self, y: Array, side: int) -> tuple[Array, Array]:
        """Return the elongations of all springs and their rates."""
        key = (y.tobytes(), side)
        if self._memo[0] == key:
            return self._memo[1]
        u, v = self.floors(y, side)
        if self.is_one:
            d, rate = u[-1:], v[-1:]
        else:
            d, rate = np.diff(u, prepend=0.0), np.diff(v, prepend=0.0)
        if len(self.springs) > self.frame_springs:
            chord = 4 * self.b * math.sin(side * y[0] / 2)
            opens = 2 * self.b * math.cos(y[0] / 2) * side * y[1]
            pair = np.array([[chord, opens], [0.0, 0.0]])[::side]
            d, rate = np.append(d, pair[:, 0]), np.append(rate, pair[:, 1])
        self._memo = (key, (d, rate))
        return d, rate

    # forces

    def shears(self, y: Array, side: int, springs: list[Spring]) -> Array:
        """Return the forces of the columns of the storeys."""
        d, _ = self.drawn(y, side)
        if self.is_one:
            return self.columns * self.bend * (springs[0].force(d[0]) / springs[0].k)
        return np.array([springs[i].force(d[i]) for i in range(self.n)])

    def pull(self, theta: float, side: int) -> Array:
        """Return the force of the cable on the wall."""
        if not self.wall.eta:
            return np.zeros(2)
        eta, (h, b) = self.wall.eta, (self.h, self.b)
        if self.wall.cable == "linear":
            share = abs(theta) / math.atan2(b, h)
            size = eta[0] + (eta[1] - eta[0]) * share
            return -G * size * np.array([math.sin(theta), math.cos(theta)])
        run, length = self._straight(theta, side)
        longest = self._straight(math.atan2(b, h), 1)[1]
        size = eta[0] + (eta[1] - eta[0]) * (length - 2 * h) / (longest - 2 * h)
        return -G * size * run

    def _straight(self, theta: float, side: int) -> tuple[Array, float]:
        """Return direction and length of a cable from the middle of the base to that of the top."""
        head = turned(theta) @ [-side * self.b, 2 * self.h] + [side * self.b, 0.0]
        length = math.hypot(*head)
        return head / length, length

    def lifted(self, y: Array, side: int, springs: list[Spring]) -> Array:
        """Return the force of fuse and damper on the corner that lifts; without it, zero."""
        # the chord of an arc has half its angle
        along = np.array([math.sin(y[0] / 2), math.cos(y[0] / 2)])
        size = self.wall.damper * 2 * self.b * math.cos(y[0] / 2) * side * y[1]
        if self.wall.fuse:
            i = self.frame_springs + (0 if side > 0 else 1)
            size += springs[i].force(self.drawn(y, side)[0][i])
        return -size * along

    def weight(self, t: float) -> float:
        """Return the weight per mass of the wall in the frame of the ground [m/s2]."""
        return G + self.scene.vertical * self.scene.ground(t)

    def instant(
        self, t: float, y: Array, side: int, springs: list[Spring], *, rests: bool
    ) -> Instant:
        """Solve for all accelerations and forces."""
        a_g = self.scene.ground(t)
        _, slope, bend = self.roof(y, side)
        u, v = self.floors(y, side)
        shear = self.shears(y, side, springs)
        d = np.diff(u, prepend=0.0)
        through = shear - self.push * d
        resisting = self.c @ v + through - np.append(through[1:], 0.0)
        inertia, known = self._linked(a_g, resisting)
        known = known + inertia * (bend * y[1] ** 2)
        ddot, links, pivot = 0.0, known, np.zeros(2)
        if not self.wall:
            ddot = -known.sum() / inertia.sum()
        else:
            matrix, right = self.balance(t, y, side, inertia.size, springs)
            matrix[3:, 0] = inertia * slope
            right[3:] = -known
            if rests:
                # the base is pressed on: no rotation, and no need of moments
                matrix[2], right[2] = 0.0, 0.0
                matrix[2, 0] = 1.0
            x = np.linalg.solve(matrix, right)
            ddot, pivot, links = x[0], x[1:3], x[3:]
            if self.wall.fuse:
                # the fuse under the pivot corner pulls it to the ground
                i = self.frame_springs + (1 if side > 0 else 0)
                pivot = pivot + np.array([0.0, springs[i].force(0.0)])
        absolute = self.share * (slope * ddot + bend * y[1] ** 2) + a_g
        if self.free:
            absolute[:-1] = -resisting[:-1] / self.m[:-1]
        return Instant(ddot, links, pivot, absolute, d, shear)

    def _linked(self, a_g: float, resisting: Array) -> tuple[Array, Array]:
        """Return the inertia that each link moves, and its other pull."""
        if self.scene.coupling == "every_floor":
            return self.m * self.share, self.m * a_g + resisting
        if self.scene.coupling == "reduced":
            mass = self.m * self.share
            return np.array([mass @ self.share]), np.array(
                [mass.sum() * a_g + self.share @ resisting]
            )
        return self.m[-1:], np.array([self.m[-1] * a_g + resisting[-1]])

    def balance(
        self, t: float, y: Array, side: int, links: int, springs: list[Spring]
    ) -> tuple[Array, Array]:
        """Momentum of the wall and moments about its centroid; unknown theta'', H, N, links."""
        turn = turned(y[0])
        centre = turn @ [-side * self.b, self.h]
        pull, top = self.pull(y[0], side), turn @ [0.0, self.h]
        corner, foot = self.lifted(y, side, springs), turn @ [-side * self.b, -self.h]
        matrix, right = self._arms(turn, centre, side, links), np.zeros(links + 3)
        right[:2] = centre * y[1] ** 2 - [self.scene.ground(t), self.weight(t)] + pull + corner
        right[2] = top[1] * pull[0] - top[0] * pull[1] + foot[1] * corner[0] - foot[0] * corner[1]
        return matrix, right

    def _arms(self, turn: Array, centre: Array, side: int, links: int) -> Array:
        """Return the inertia of the wall and the arms of pivot and links about its centroid."""
        matrix = np.zeros((links + 3, links + 3))
        high = turn @ (self.attached(side) - [side * self.b, 0.0]).T
        matrix[:2, 0] = centre[1], -centre[0]
        matrix[0, 1], matrix[1, 2], matrix[0, 3:] = -1, -1, 1
        matrix[2, 0] = (self.h**2 + self.b**2) / 3
        matrix[2, 1:3] = centre[1], -centre[0]
        matrix[2, 3:] = high[1] - centre[1]
        matrix[3:, 3:] = -np.eye(links)
        return matrix

    def attached(self, side: int) -> Array:
        """Return the places of the links, from the middle of the base."""
        pivot = np.array([side * self.b, 0.0])
        corner = np.array([self._corner(side), 2 * self.h])
        return pivot + self.places[:, None] * (corner - pivot)

    def after_impact(self, y: Array, side: int) -> float:
        """Return the factor of the angular velocity."""
        return self.impulses(y, side)[0] if self.wall.e is None else self.wall.e

    def impulses(self, y: Array, side: int) -> tuple[float, float, float]:
        """Return the factor of the angular velocity, and H and N for a unit velocity before.

        They follow from the impulses on all bodies. With a given factor the impulse acts anywhere
        along the base, and the moments about the corner do not matter.
        """
        inertia, _ = self._linked(0.0, np.zeros(self.n))
        turn = turned(0.0)
        matrix = self._arms(turn, np.array([side * self.b, self.h]), -side, inertia.size)
        slope = self.roof(np.zeros_like(y), -side)[1]
        matrix[3:, 0] = inertia * slope
        right = np.zeros(inertia.size + 3)
        # before: about the other corner, and the floors with the roof
        right[:2] = self.h, side * self.b
        right[2] = matrix[2, 0]
        right[3:] = inertia * slope
        if self.wall.e is not None:
            matrix[2], right[2] = 0.0, self.wall.e
            matrix[2, 0] = 1.0
        e, horizontal, normal = np.linalg.solve(matrix, right)[:3]
        return float(e), float(horizontal), float(normal)

    # demands

    def keys(self) -> list[str]:
        """Return the names of the results of `demands`."""
        numbers = range(1, self.n + 1)
        names = [f"floor_{i}_acceleration_max_g" for i in numbers]
        if not self.scene.is_single:
            names += [f"storey_{i}_drift_max" for i in numbers]
            names += [f"storey_{i}_shear_max_over_m_w_g" for i in numbers]
        names += ["u_s_max", "base_shear_max_over_weight"]
        if self.wall or self.scene.height:
            names += ["roof_drift_max", "overturning_moment_max_over_weight"]
        if self.wall:
            names += ["theta_max_over_alpha", "pivot_normal_min_over_m_w_g"]
            names += ["friction_demand_max", "wall_drift_max"]
            names += ["wall_shear_max_over_m_w_g", "wall_moment_max_over_m_w_g"]
        return names + self._force_keys()

    def _force_keys(self) -> list[str]:
        """Return the names of the values of `forces`."""
        numbers = range(1, self.n + 1)
        names = [f"floor_{i}_velocity_max" for i in numbers]
        if not self.wall:
            return names
        places = ["base", "mid"]
        for i in numbers:
            places += [f"{i}", f"{i}_above"]
        names += [
            f"wall_{what}_{place}_max_over_m_w_g"
            for place in places
            for what in ("shear", "moment")
        ]
        lowest = 1 if self.scene.coupling == "every_floor" else self.n
        names += [f"link_{i}_force_max_over_m_w_g" for i in range(lowest, self.n + 1)]
        return [*names, "pivot_normal_max_over_m_w_g", "tendon_force_max_over_m_w_g"]

    def forces(self, t: float, y: Array, side: int, now: Instant) -> list[float]:
        """Return velocities of the floors and forces of wall, links, pivot and cable."""
        found = [*np.abs(self.floors(y, side)[1] + self.scene.ground.velocity(t))]
        if not self.wall:
            return found
        z = np.array([0.0, self.h, *(2 * self.h * self.z / self.z[-1])])
        below, above = (
            np.abs(self.sections(z, t, y, side, now, beside)) / G
            for beside in (-1e-9 * self.h, 1e-9 * self.h)
        )
        above[:, -1] = 0.0  # there is no wall above the roof
        found += [*above[:, 0], *np.maximum(below[:, 1], above[:, 1])]
        for i in range(2, z.size):
            found += [*below[:, i], *above[:, i]]
        found += [*np.abs(now.links) / G, now.pivot[1] / G]
        return [*found, float(np.hypot(*self.pull(y[0], side))) / G]

    def travel(self, course: Course, t_end: float) -> tuple[float, float]:
        """Return the largest stroke of a fuse, and the way there and back of the busier one."""
        way, largest = np.zeros(2), 0.0
        for piece in course.pieces:
            begin, end = piece.t[0], min(piece.t[1], t_end)
            if end <= begin or piece.rests:
                continue
            times = np.linspace(begin, end, 200)
            rates = [piece.at(t)[1] for t in times]
            turns = [
                brentq(lambda t, p=piece: p.at(t)[1], a, b, xtol=1e-13)
                for (a, b), (x, y) in zip(pairwise(times), pairwise(rates), strict=True)
                if x * y < 0
            ]
            stroke = [4 * self.b * abs(math.sin(piece.at(t)[0] / 2)) for t in (begin, *turns, end)]
            way[0 if piece.side > 0 else 1] += np.abs(np.diff(stroke)).sum()
            largest = max(largest, *stroke)
        return largest, float(way.max())

    def demands(self, t: float, piece: Piece, only: int | None = None) -> Array:
        """Return all demands as magnitudes, the normal force of the pivot with its sign turned.

        With the number of one, those behind it may be missing and those before it zero.
        """
        y, side = piece.at(t), piece.side
        now = self.instant(t, y, side, piece.springs, rests=piece.rests)
        found = [*now.absolute / G]
        if not self.scene.is_single:
            found += [*now.d / self.height, *now.shear / G]
        u = self.roof(y, side)[0]
        total = self.m.sum() + (1.0 if self.wall else 0.0)
        shear = self.m @ now.absolute
        moment = (self.m * self.z) @ now.absolute
        roof = 2 * self.h if self.wall else self.z[-1]
        if self.wall:
            own = self._own_inertia(t, y, side, now.ddot)
            shear, moment = shear + own[0], moment + own[1]
        found += [u, shear / (G * total)]
        if self.wall or self.scene.height:
            found += [u / roof, moment / (G * total)]
        if not self.wall:
            return np.array([*np.abs(found), *self.forces(t, y, side, now)])
        found += [y[0] / math.atan2(self.b, self.h), 0.0]
        top = turned(y[0]) @ [-side * self.b, 2 * self.h] + [side * self.b, 0.0]
        found += [now.pivot[0] / now.pivot[1], top[0] / (2 * self.h)]
        found = [*np.abs(found)]
        found[-3] = -now.pivot[1] / G
        ends = len(found), len(found) + 2
        if only is not None and only < ends[0]:
            return np.array(found)
        is_inside = only is None or only < ends[1]
        found += [x / G for x in self.inside(t, y, side, now)] if is_inside else [0.0, 0.0]
        if only is not None and is_inside:
            return np.array(found)
        return np.array([*found, *self.forces(t, y, side, now)])

    def _own_inertia(self, t: float, y: Array, side: int, ddot: float) -> tuple[float, float]:
        """Return horizontal momentum of the wall per time, and its moment about the ground."""
        arm, force, part = self._particles(t, y, side, ddot, np.array([0.0]))
        push = part[0] * force[0][0]
        return push.sum(), (push * arm[1][0]).sum()

    def _particles(
        self, t: float, y: Array, side: int, ddot: float, z: Array
    ) -> tuple[Array, Array, Array]:
        """Return arms about the pivot, forces and masses of the particles above heights."""
        span = 2 * self.h - z
        up = z[:, None] + span[:, None] * (_NODES + 1) / 2
        part = span[:, None, None] / (2 * self.h) * np.outer(_WEIGHTS, _WEIGHTS) / 4
        high = np.broadcast_to(up[:, :, None], (*up.shape, _NODES.size))
        across = np.broadcast_to(self.b * _NODES - side * self.b, high.shape)
        s, c = math.sin(y[0]), math.cos(y[0])
        arm = np.array([c * across + s * high, c * high - s * across])
        rate = y[1] ** 2
        force = np.array(
            [arm[1] * ddot - arm[0] * rate + self.scene.ground(t), -arm[0] * ddot - arm[1] * rate]
        )
        return arm, force, part

    def sections(
        self, z: Array, t: float, y: Array, side: int, now: Instant, beside: float = 0.0
    ) -> Array:
        """Return the shears and the moments that the wall above heights needs from below.

        Links act from a distance `beside` above the heights on.
        """
        arm, force, part = self._particles(t, y, side, now.ddot, z)
        force = force + np.array([0.0, self.weight(t)])[:, None, None, None]
        turn = turned(y[0])
        own, place = np.tensordot(turn.T, force, 1) * part, np.tensordot(turn.T, arm, 1)
        axis = (1, 2)
        shear = own[0].sum(axis=axis)
        moment = ((place[1] - z[:, None, None]) * own[0]).sum(axis=axis)
        moment -= ((place[0] + side * self.b) * own[1]).sum(axis=axis)
        points = [*self.attached(side), np.array([0.0, 2 * self.h])]
        pulls = [*(np.array([-x, 0.0]) for x in now.links), self.pull(y[0], side)]
        for point, pull in zip(points, pulls, strict=True):
            fx, fz = turn.T @ pull
            acts = point[1] > z + beside
            shear -= acts * fx
            moment -= acts * ((point[1] - z) * fx - point[0] * fz)
        return np.array([shear, moment])

    def inside(self, t: float, y: Array, side: int, now: Instant) -> tuple[float, float]:
        """Return the largest shear and moment over the height of the wall."""
        ends = [0.0, *(2 * self.h * self.places)]
        z = np.concatenate([low + (high - low) * _PLACES for low, high in pairwise(ends)])
        values = self.sections(z, t, y, side, now)
        found = [0.0, 0.0]
        for i in range(len(ends) - 1):
            for q in range(2):
                line = _CUBIC @ values[q, 4 * i : 4 * i + 4]
                at = [0.0, 1.0, *(x for x in _turns(line) if 0 < x < 1)]
                found[q] = max(found[q], *np.abs(np.polyval(line, at)))
        return found[0], found[1]

    # motion

    def rates(self, t: float, y: Array, side: int, springs: list[Spring], *, rests: bool) -> Array:
        """Return the derivative of the state."""
        now = self.instant(t, y, side, springs, rests=rests)
        result = np.zeros_like(y)
        if not rests:
            result[:2] = y[1], now.ddot
        if self.free:
            result[2 : 2 + self.free] = y[2 + self.free :]
            result[2 + self.free :] = now.absolute[:-1] - self.scene.ground(t)
        return result

    def _moves(self, side: int, *, rests: bool) -> list[int]:
        """Return the springs that may change: a fuse moves under the corner that lifts."""
        frame = list(range(self.frame_springs if self.free or not rests else 0))
        if len(self.springs) > self.frame_springs and not rests:
            frame.append(self.frame_springs + (0 if side > 0 else 1))
        return [i for i in frame if self.springs[i].u_y < math.inf]

    def _spring_events(self, side: int, *, rests: bool) -> list[Watched]:
        """Return name, number, function and direction of the possible events of the springs."""
        events: list[Watched] = []
        for i in self._moves(side, rests=rests):
            spring = self.springs[i]
            if spring.on:
                sign = spring.on
                events.append(
                    ("turn", i, lambda _t, y, i=i, s=sign: s * self.drawn(y, side)[1][i], -1.0)
                )
                corner = spring.corner()
                if corner is not None:
                    events.append(
                        ("home", i, lambda _t, y, i=i, c=corner: abs(self.drawn(y, side)[0][i]) - c,
                         -1.0)
                    )  # fmt: skip
                continue
            low, high = spring.limits()
            events.append(("up", i, lambda _t, y, i=i, x=high: self.drawn(y, side)[0][i] - x, 1.0))
            events.append(
                ("down", i, lambda _t, y, i=i, x=low: self.drawn(y, side)[0][i] - x, -1.0)
            )
        return events

    def _events(self, side: int, *, rests: bool) -> list[Watched]:
        """Return all that may end a piece of motion."""
        events = self._spring_events(side, rests=rests)
        ultimate = (self.scene.yielding or {}).get("ultimate", math.inf)
        ends = self.scene.limit * self.height
        if ultimate < math.inf:
            ends = np.fmin(ends, ultimate * self.u_y) if not self.is_one else ends
        for i in range(self.n if np.isfinite(ends).any() else 0):
            events.append(
                ("collapse", i, lambda _t, y, i=i: abs(self._d(y, side)[i]) - ends[i], 1.0)
            )
        if self.is_one and ultimate < math.inf:
            most = ultimate * self.u_y[0]
            events.append(("collapse", 0, lambda _t, y: abs(self.roof(y, side)[0]) - most, 1.0))
        if self.wall and rests:
            events += [("lift", s, lambda t, y, s=s: self._drive(t, y, s), 1.0) for s in (1, -1)]
        elif self.wall:
            events.append(("impact", 0, lambda _t, y: side * y[0], -1.0))
        return events

    def _d(self, y: Array, side: int) -> Array:
        return np.diff(self.floors(y, side)[0], prepend=0.0)

    def _drive(self, t: float, y: Array, side: int) -> float:
        """Return the angular acceleration away from the base that a resting wall would have."""
        return side * self.instant(t, y, side, self.springs, rests=False).ddot

    def follow(self, t_end: float, shortest: float = 0.02) -> Course:
        """Follow the motion from rest up to a time, a collapse, or flights that get too short."""
        course = Course()
        t, side, rests = 0.0, 1, self.wall is not None
        y = np.zeros(2 + 2 * self.free)
        while t < t_end and course.collapse is None:
            later = [x for x in self.scene.ground.knots if x > t + 1e-12]
            stop = min([t_end, *later])
            watched = self._events(side, rests=rests)
            kept = copy.deepcopy(self.springs)
            flow = self._piece(y, (t, stop), side, watched, rests=rests)
            course.pieces.append(Piece((t, float(flow.t[-1])), flow.sol, side, rests, kept))
            t, y = float(flow.t[-1]), flow.y[:, -1].copy()
            for (name, i, _, _), times in zip(watched, flow.t_events, strict=False):
                if not times.size:
                    continue
                if name == "collapse":
                    course.collapse = t
                elif name == "lift":
                    side, rests = i, False
                elif name != "impact":
                    self._change(name, i, y, side)
                    course.branches += 1
            # a fuse may reach a bound as its corner lands
            if self.wall and not rests and side * y[0] < 1e-15 and side * y[1] < 0:
                course.impacts.append(t)
                y[:2], side = [0.0, self.after_impact(y, side) * y[1]], -side
                for spring in self.springs[self.frame_springs :]:
                    spring.turn(0.0)
            self._settle(y, side, rests=rests)
            ends = [*course.impacts[-2:], t]
            if len(course.impacts) > 1 and ends[1] - ends[0] < shortest:
                break
        return course

    def _piece(
        self, y: Array, span: tuple[float, float], side: int, watched: list[Watched], *, rests: bool
    ) -> OptimizeResult:
        """Integrate up to the first event; again up to a peak where a spring passes a limit."""
        for _, _, event, direction in watched:
            event.terminal, event.direction = True, direction  # type: ignore[attr-defined]
        between = [(i, event, d) for name, i, event, d in watched if name in ("up", "down")]
        turns: list[Event] = [
            lambda _t, y, i=i: self.drawn(y, side)[1][i] for i, _, d in between if d > 0
        ]
        while True:
            flow = solve_ivp(
                lambda t, y: self.rates(t, y, side, self.springs, rests=rests),
                span, y, events=[*(x[2] for x in watched), *turns], dense_output=True,
                max_step=1 / self.fastest, **TIGHT,
            )  # fmt: skip
            assert flow.status >= 0, flow.message
            peaks = zip(flow.t_events[len(watched) :], flow.y_events[len(watched) :], strict=True)
            passed = [
                t
                for times, states in peaks
                for t, state in zip(times, states, strict=True)
                if any(d * event(t, state) > 1e-15 for _, event, d in between)
            ]
            if not passed or min(passed) >= flow.t[-1] or min(passed) <= span[0]:
                return flow
            span = span[0], min(passed)

    def _change(self, name: str, i: int, y: Array, side: int) -> None:
        """Move a spring to its next branch."""
        spring, d = self.springs[i], self.drawn(y, side)[0][i]
        if name == "turn":
            spring.turn(d)
        elif name == "home":
            spring.come_home()
        else:
            spring.reach(1 if name == "up" else -1)

    def _settle(self, y: Array, side: int, *, rests: bool) -> None:
        """Apply simultaneous events: equal springs, and jumps of velocity."""
        d, rate = self.drawn(y, side)
        for i in self._moves(side, rests=rests):
            spring = self.springs[i]
            if spring.on and spring.on * rate[i] < SLOW:
                spring.turn(d[i])
            elif not spring.on and abs(rate[i]) > SLOW:
                low, high = spring.limits()
                near = 1e-13 * spring.u_y
                if d[i] > high - near and rate[i] > 0:
                    spring.reach(1)
                elif d[i] < low + near and rate[i] < 0:
                    spring.reach(-1)

    def largest(self, course: Course, t_end: float) -> dict[str, float]:
        """Return the largest demands up to a time, between samples as well."""
        step = min(0.004, 0.2 / self.fastest)
        sampled, rough = [], np.full(len(self.keys()), -np.inf)
        for piece in course.pieces:
            begin, end = piece.t[0], min(piece.t[1], t_end)
            if end <= begin:
                continue
            times = np.linspace(begin, end, 2 + math.ceil((end - begin) / step))
            values = np.array([self.demands(t, piece) for t in times])
            sampled.append((piece, times, values))
            rough = np.maximum(rough, values.max(axis=0))
        found = rough.copy()
        for piece, times, values in sampled:
            for q in range(rough.size):
                for i in _summits(values[:, q], rough[q] - 0.015 * abs(rough[q])):
                    bounds = times[max(i - 1, 0)], times[min(i + 1, times.size - 1)]
                    best = minimize_scalar(
                        lambda t, p=piece, q=q: -self.demands(t, p, q)[q],
                        bounds=bounds, method="bounded", options={"xatol": 1e-10},
                    )  # fmt: skip
                    found[q] = max(found[q], -best.fun)
        return dict(zip(self.keys(), map(float, found), strict=True))

    def left(self, course: Course, t_end: float) -> dict[str, float]:
        """Return the residuals after slow unloading at a time, by the names of the kernel."""
        piece = next(p for p in reversed(course.pieces) if p.t[0] <= t_end)
        d = self.drawn(piece.at(t_end), piece.side)[0]
        pairs = list(zip(piece.springs, d, strict=True))[: self.frame_springs]
        rest = np.array([spring.residual(x) for spring, x in pairs])
        found = {}
        if self.is_one or self.scene.is_single:
            found["residual_displacement"] = float(rest[0])
            if not self.scene.is_single:
                found["storey_residual_drift_max"] = float(
                    np.abs(rest[0] * self.bend / self.height).max()
                )
        else:
            drifts = rest / self.height
            found |= {f"storey_{i + 1}_residual_drift": float(x) for i, x in enumerate(drifts)}
            found["storey_residual_drift_max"] = float(np.abs(drifts).max())
        if self.scene.coupling == "full" and not self.scene.is_single:
            found["residual_displacement"] = float(rest.sum())
        if "residual_displacement" in found and (self.wall or self.scene.height):
            roof = 2 * self.h if self.wall else self.z[-1]
            found["roof_residual_drift"] = found["residual_displacement"] / roof
        return found


def _summits(values: Array, least: float) -> list[int]:
    """Return where samples are as high as both neighbours, the six highest above a level."""
    beside = np.concatenate([[-np.inf], values, [-np.inf]])
    # on a plateau, the first one
    high = (values > beside[:-2]) & (values >= beside[2:]) & (values > least)
    places = np.flatnonzero(high)
    return [int(i) for i in places[np.argsort(-values[places])][:6]]


def _turns(line: Array) -> list[float]:
    """Return where a cubic has its largest and its smallest value."""
    a, b, c = 3 * line[0], line[1], line[2]
    inner = b * b - a * c
    if inner < 0:
        return []
    # the larger root first: no difference of equal numbers
    larger = -b - math.copysign(math.sqrt(inner), b)
    return [x / y for x, y in ((larger, a), (c, larger)) if y]


def turned(theta: float) -> Array:
    """Return the matrix that turns clockwise."""
    s, c = math.sin(theta), math.cos(theta)
    return np.array([[c, s], [-s, c]])


def _storeys(k: Array) -> Array:
    """Return the matrix of storeys."""
    return np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
