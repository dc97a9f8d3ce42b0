"""Time loop that couples a wall with the frame of a host."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from rwmf._arguments import case_of
from rwmf._hosts.element import Element
from rwmf._hosts.states import WallEvent
from rwmf._numbers import show, to_array, to_number
from rwmf.case import Case, CaseLike
from rwmf.coupling.host import Host, Reals, end_rates
from rwmf.errors import InputError, NumericalError

__all__ = ["CoupledRun", "CouplingEnergy", "couple"]

_MOST_ITERATIONS = 30
# iterations after which the flexibility of the host is computed anew
_PATIENCE = 6
# flexibilities that are kept, and the digits by which their steps differ
_MOST_KEPT = 8
_DIGITS = 6
# part of the step that shows masses and accelerations of the host
_INSTANT = 1e-4
# relative difference of masses that two such parts show
_SAME_MASS = 1e-2
# part of the step below which the rest of a step is skipped
_NOTHING = 1e-9
# impacts, lift-offs and ends of branches in a step
_MOST_STOPS = 1000
# repetitions of a step that ends at an impact
_MOST_REPETITIONS = 8


class CouplingEnergy(NamedTuple):
    """Energies of a coupling.

    Attributes
    ----------
    work : float
        Work of the frame on the wall through the links [J].
    impacts : float
        Kinetic energy that wall and frame lose at impacts [J].
    error : float
        Work of the differences between the force of the wall and that on the frame [J].
    """

    work: float
    impacts: float
    error: float


@dataclass
class CoupledRun:
    """Results of a coupling at the ends of its steps.

    Attributes
    ----------
    host_mass : float
        Mass of the frame that moves with the wall, at the highest link [kg].
    t : list of float
        Times [s].
    u, theta, force : list of float
        Displacement of the highest link [m], rotation of the wall [rad], and force of the wall on
        the frame [N]. The force is summed over the links by their heights.
    events : list of WallEvent
        Lift-offs, impacts and rest.
    u_s_max : float
        Largest displacement of the highest link, also inside steps [m].
    impacts : int
        Number of impacts.
    velocity_factor : float
        Factor on the velocity of the link at the last impact [-]; NaN without one.
    energy : CouplingEnergy
        Energies of the coupling [J].
    iterations : int
        Trial steps of the host.
    """

    host_mass: float
    velocity_factor: float = math.nan
    t: list[float] = field(default_factory=list)
    u: list[float] = field(default_factory=list)
    theta: list[float] = field(default_factory=list)
    force: list[float] = field(default_factory=list)
    events: list[WallEvent] = field(default_factory=list)
    u_s_max: float = 0.0
    impacts: int = 0
    energy: CouplingEnergy = field(default_factory=lambda: CouplingEnergy(0.0, 0.0, 0.0))
    iterations: int = 0


class _Step(NamedTuple):
    """A trial step on which wall and frame agree."""

    forces: Reals
    u: float
    v: float
    a: float
    theta: float
    theta_dot: float
    residual: float


def couple(
    case: CaseLike,
    host: Host,
    ground: Callable[[float], float],
    dt: float,
    t_end: float,
    heights: object = None,
    tolerance: float = 1e-10,
) -> CoupledRun:
    """Step a wall and the frame of a host together.

    Impacts and lift-offs end a step at their instant. At an impact the balance of momentum over
    the masses of the host changes the velocities (rule ``coupled``), or the factor of the case.

    Parameters
    ----------
    case : Case or path
        Wall with `m_w`, tendon, fuses, impact rule and effects that an `Element` of one degree of
        freedom carries. Its frame and motion have no effect.
    host : Host
        The frame at rest, for example an `OpenSeesHost` or a `FunctionHost`.
    ground : callable
        Ground acceleration [m/s2] at a time [s], the one of the host; linear within a step.
    dt : float
        Step [s].
    t_end : float
        End [s].
    heights : array_like, shape (links,), optional
        Heights of the links above the base, from the ground up [m]. The wall keeps them on a
        straight line; the highest is the link of the case. Needed for several links.
    tolerance : float
        Difference between the forces of wall and frame, over the weight of the wall [-].

    Returns
    -------
    CoupledRun
        Histories, events, maxima and energies.

    Raises
    ------
    InputError
        When the case does not allow an element, or an argument is not acceptable.
    NumericalError
        When an iteration does not converge, or the wall overturns.
    """
    step = to_number("dt", dt, above=0.0)
    end = to_number("t_end", t_end, above=0.0)
    if not callable(ground):
        raise InputError(f"ground = {show(ground)}: must be callable")
    if not hasattr(host, "links") or not callable(getattr(host, "attempt", None)):
        raise InputError(f"host = {show(host)}: must be an OpenSeesHost, a FunctionHost or a Host")
    shape = _shape(heights, len(host.links))
    accuracy = to_number("tolerance", tolerance, above=0.0)
    pair = _Pair(case_of(case), host, ground, step, shape, accuracy)
    begin = host.time()
    for number in range(1, math.ceil((end - begin) / step * (1 - 1e-12)) + 1):
        pair.advance(min(begin + number * step, end))
    return pair.run


def _shape(heights: object, links: int) -> Reals:
    """Displacements of the links over that of the highest one."""
    if heights is None and links == 1:
        return np.ones(1)
    if heights is None:
        raise InputError(f"heights: must be given with {links} links")
    values = to_array("heights", heights, above=0.0)
    if len(values) != links or np.any(np.diff(values) <= 0):
        raise InputError(f"heights = {show(heights)}: must be {links} increasing heights")
    return np.asarray(values / values[-1])


class _Pair:
    """A wall and a frame that step together."""

    def __init__(
        self,
        case: Case,
        host: Host,
        ground: Callable[[float], float],
        dt: float,
        shape: Reals,
        tolerance: float,
    ) -> None:
        mass = None if case.wall is None else case.wall.get("m_w")
        if mass is None:
            raise InputError("case: a coupling needs &wall m_w, the mass of the wall")
        self._weight = to_number("m_w", mass) * case.model.g
        self._tolerance = tolerance * self._weight
        self._host, self._ground, self._dt, self._shape = host, ground, dt, shape
        self._instant = _INSTANT * dt
        self._flexibilities: dict[float, Reals] = {}
        # accelerations of the frame by unit forces at the links [1/kg]
        self._by_force = self._increments_by_force(self._instant) * 4 / self._instant**2
        at_links = self._by_force[host.links]
        # without a mass the acceleration would grow as the step shrinks
        longer = 10 * self._instant
        again = self._increments_by_force(longer)[host.links] * 4 / longer**2
        if not np.allclose(at_links, again, rtol=_SAME_MASS) or not np.all(np.diag(again) > 0):
            raise InputError("host: a link has no mass")
        self._element = Element(case)
        if self._element.dofs > 1:
            raise InputError(
                "case: a coupling needs a wall of one degree of freedom: without &bending "
                "and &storeys coupling = 'springs'"
            )
        side = None if self._element.side else 1
        self._wall_mass = self._element.respond(0.0, 0.0, 0.0, 0.0, side=side).mass
        self.run = CoupledRun(float(shape @ np.linalg.solve(at_links, shape)))
        self._force = self._theta = 0.0
        self._forces: Reals = np.zeros(len(host.links))
        self._rates: Reals = np.zeros(len(host.links))
        self._losses = [0.0, 0.0, 0.0]
        self._enter(self._element.side, host.motion()[1])
        self._note()

    def _increments_by_force(self, h: float) -> Reals:
        """Increments of the frame in a step by unit forces on the frame at the links [m/N]."""
        links = len(self._host.links)
        base = self._host.attempt(np.zeros(links), h)
        columns = [
            (self._host.attempt(self._weight * unit, h) - base) / self._weight
            for unit in np.eye(links)
        ]
        return np.array(columns).T

    def advance(self, t: float) -> None:
        """Step to a time, with stops at impacts and lift-offs."""
        least = _NOTHING * self._dt
        for _ in range(_MOST_STOPS):
            h = t - self._host.time()
            if h <= least:
                self._note()
                return
            try:
                if self._element.side:
                    self._rock(h)
                else:
                    self._hold(h)
            except InputError as error:
                raise NumericalError(f"t = {self._host.time():g} s: {error}") from None
        raise NumericalError(
            f"t = {self._host.time():g} s: more than {_MOST_STOPS} stops in a step: shorten dt"
        )

    def _note(self) -> None:
        """Add the present state to the histories."""
        run, link = self.run, self._host.links[-1]
        run.t.append(self._host.time())
        run.u.append(float(self._host.motion()[0][link]))
        run.theta.append(self._theta)
        run.force.append(-self._force)
        run.energy = CouplingEnergy(*self._losses)

    def _at_links(self) -> tuple[Reals, Reals, Reals]:
        u, v, a = (values[self._host.links] for values in self._host.motion())
        return u, v, a

    def _solve(self, h: float, is_held: bool) -> _Step:
        """Find the forces of the links: on a straight line with the wall, or without motion."""
        shape = self._shape
        u_0, v_0, a_0 = self._at_links()
        ground = self._ground(self._host.time() + h)
        forces = self._forces + h * self._rates
        last = math.inf
        for iteration in range(_MOST_ITERATIONS):
            self.run.iterations += 1
            increment = self._host.attempt(-forces, h)[self._host.links]
            v, a = end_rates(increment, h, v_0, a_0)
            by_force = self._flexibility(h, is_new=iteration > 0 and iteration % _PATIENCE == 0)
            turns = (0.0, 0.0)
            if is_held:
                residuals, matrix = increment, -by_force
                error = float(np.abs(np.linalg.solve(by_force, increment)).max())
            else:
                r = self._element.respond(float(u_0[-1] + increment[-1]), float(v[-1]),
                                          float(a[-1]), ground)  # fmt: skip
                turns = (r.theta, r.theta_dot)
                stiffness = r.stiffness + 2 / h * r.damping + 4 / h**2 * r.mass
                residuals = increment - shape * increment[-1]
                residuals[-1] = shape @ forces - r.force
                matrix = shape[:, None] * by_force[-1] - by_force
                matrix[-1] = shape + stiffness * by_force[-1]
                error = abs(float(residuals[-1]))
                if len(shape) > 1:
                    off = np.linalg.solve(by_force, np.append(residuals[:-1], 0.0))
                    error = max(error, float(np.abs(off).max()))
            # below the first bound the residual is round-off of the inertia forces of short steps
            if error <= self._tolerance or (error >= last / 2 and error <= 1e-6 * self._weight):
                end = (float(u_0[-1] + increment[-1]), float(v[-1]), float(a[-1]))
                return _Step(forces, *end, *turns, error)
            last = error
            forces = forces - np.linalg.solve(matrix, residuals)
        raise NumericalError(
            f"t = {self._host.time():g} s: wall and host disagree by {error:.3g} N after "
            f"{_MOST_ITERATIONS} iterations: shorten dt"
        )

    def _flexibility(self, h: float, is_new: bool) -> Reals:
        """Displacements of the links by unit forces at the end of a step [m/N]."""
        # whole steps differ by the rounding of the times
        part = round(h / self._dt, _DIGITS)
        if is_new or part not in self._flexibilities:
            if len(self._flexibilities) > _MOST_KEPT:
                self._flexibilities.clear()
            self._flexibilities[part] = self._increments_by_force(h)[self._host.links]
        return self._flexibilities[part]

    def _commit(self, step: _Step, h: float) -> None:
        """Make a step of the host, with its energies and maxima."""
        u_0, v_0, _ = self._at_links()
        self._host.commit(-step.forces, h)
        force = float(self._shape @ step.forces)
        way = step.u - float(u_0[-1])
        self._losses[0] += (self._force + force) / 2 * way
        self._losses[2] += abs(step.residual * way)
        self._rates = (step.forces - self._forces) / h
        self._force, self._forces = force, step.forces
        highest = max(abs(step.u), abs(float(u_0[-1])))
        if v_0[-1] * step.v < 0:
            turn = h * float(v_0[-1]) / (float(v_0[-1]) - step.v)
            highest = max(highest, abs(float(u_0[-1]) + float(v_0[-1]) * turn / 2))
        self.run.u_s_max = max(self.run.u_s_max, highest)
        self._theta = step.theta
        if self._element.side:
            self._element.commit()

    def _rock(self, h: float) -> None:
        """Step a rocking wall, at most to an impact or to the end of a branch."""
        host, element = self._host, self._element
        begin = tuple(float(values[-1]) for values in self._at_links())
        t = host.time()
        step = self._solve(h, is_held=False)
        event = element.next_event(
            h, begin, step[1:4], (self._ground(t), self._ground(t + h)), has_branches=True
        )
        if event is not None and event.tau <= _NOTHING * self._dt:
            if event.kind == "impact" and step.u * element.side <= 0:
                # a wall that has just lifted off does not move away
                element.revert()
                self._enter(0, self._with_link_velocity(host.motion()[1], 0.0))
                return
            event = None
        if event is None:
            self._commit(step, h)
            return
        tau = event.tau
        step = self._solve(tau, is_held=False)
        if event.kind == "impact":
            for _ in range(_MOST_REPETITIONS):
                change = -step.u / step.v if step.v else 0.0
                if abs(change) <= _NOTHING * self._dt or not 0 < tau + change <= h:
                    break
                tau += change
                step = self._solve(tau, is_held=False)
        self._commit(step, tau)
        if event.kind == "impact":
            self._land(step)

    def _land(self, step: _Step) -> None:
        """Change the velocities by the balance of momentum, and the side."""
        element, host, run = self._element, self._host, self.run
        t = host.time()
        run.impacts += 1
        run.events.append(WallEvent("impact", t, 0.0, step.theta_dot))
        v = float(element.land(step.u, step.v, run.host_mass)[0])
        run.velocity_factor = v / step.v
        mass = run.host_mass + self._wall_mass
        self._losses[1] += mass * (step.v**2 - v**2) / 2
        after = self._with_link_velocity(host.motion()[1], v)
        push = self._push(after)
        rests = v == 0 or element.settles(
            self._dt, (step.u, v, 0.0), self._ground(t), push, run.host_mass
        )
        if rests:
            self._losses[1] += mass * v**2 / 2
            run.events.append(WallEvent("rest", t, 0.0, 0.0))
        self._enter(
            *((0, self._with_link_velocity(after, 0.0)) if rests else (element.side, after))
        )

    def _with_link_velocity(self, velocities: Reals, v: float) -> Reals:
        """Return velocities after impulses at the links."""
        links = self._host.links
        change = self._shape * v - velocities[links]
        return np.asarray(
            velocities + self._by_force @ np.linalg.solve(self._by_force[links], change)
        )

    def _free_accelerations(self, velocities: Reals) -> Reals:
        """Accelerations of the frame without forces at the links."""
        host, h = self._host, self._instant
        _, _, accelerations = host.motion()
        host.set_rates(velocities, accelerations)
        increment = host.attempt(np.zeros(len(host.links)), h)
        return end_rates(increment, h, velocities, accelerations)[1]

    def _push(self, velocities: Reals) -> float:
        """Force of the frame on a wall at rest, at the highest link."""
        links = self._host.links
        free = self._free_accelerations(velocities)[links]
        return float(self._shape @ np.linalg.solve(self._by_force[links], free))

    def _enter(self, side: int, velocities: Reals) -> None:
        """Begin to rock on a side, or to rest, with accelerations in equilibrium."""
        host, shape = self._host, self._shape
        if side != self._element.side:
            self._element.place(side)
        free = self._free_accelerations(velocities)
        by_force = self._by_force[host.links]
        at_links = free[host.links]
        if side == 0:
            forces: Reals = np.asarray(np.linalg.solve(by_force, at_links))
        else:
            v = float(velocities[host.links[-1]])
            r = self._element.respond(0.0, v, 0.0, self._ground(host.time()))
            residuals = at_links - shape * at_links[-1]
            residuals[-1] = -r.force - r.mass * at_links[-1]
            matrix = shape[:, None] * by_force[-1] - by_force
            matrix[-1] = shape + r.mass * by_force[-1]
            forces = np.asarray(np.linalg.solve(matrix, -residuals))
        host.set_rates(velocities, free - self._by_force @ forces)
        self._forces, self._rates = forces, np.zeros(len(forces))
        self._force = float(shape @ forces)

    def _hold(self, h: float) -> None:
        """Step beside a wall at rest, at most to its lift-off."""
        host = self._host
        t = host.time()
        grounds = self._ground(t), self._ground(t + h)
        step = self._solve(h, is_held=True)
        ends = self._force, float(self._shape @ step.forces)
        still = np.zeros(3)
        event = self._element.next_event(h, still, still, grounds, push=ends)
        if event is None:
            self._commit(step, h)
            return
        side, tau = event.side, event.tau
        if tau > _NOTHING * self._dt:
            # the push need not be linear: the rest of the step shows the lift-off, or none
            self._commit(self._solve(tau, is_held=True), tau)
            return
        self.run.events.append(WallEvent("lift_off", host.time(), 0.0, 0.0))
        self._enter(side, host.motion()[1])
