"""A wall and a frame that step together, and their time loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from rwmf._arguments import case_of, checked
from rwmf._hosts.states import WallEvent
from rwmf._numbers import show, to_number
from rwmf.case import CaseLike
from rwmf.coupling.coupled_wall import CoupledWall, Split, WallResponse
from rwmf.coupling.function_host import LinkedFrame
from rwmf.coupling.host import CoupledRun, CouplingEnergy, Host, Reals, end_rates
from rwmf.errors import InputError, NumericalError, warn

_MOST_ITERATIONS = 30
# iterations after which the flexibility of the host is computed anew
_PATIENCE = 6
# part of the step below which the rest of a step is skipped
_NOTHING = 1e-9
# residual over the weight that may be round-off of the host
_ROUNDING = 1e-6
# relative round-off of an increment, with a margin
_DIGITS = 1e-14
# impacts, lift-offs and ends of branches in a step
_MOST_STOPS = 1000
# repetitions of a step that ends at an impact
_MOST_REPETITIONS = 8


class _Step(NamedTuple):
    """A trial step on which wall and frame agree.

    Forces of the frame on the wall, displacements of the links, and the wall's coordinates with
    their rates.
    """

    forces: Reals
    u: Reals
    y: Reals
    theta: float
    theta_dot: float
    residual: float


class Pair:
    """A wall and a frame that step together.

    Attributes
    ----------
    run : CoupledRun
        Results up to the present time.
    """

    def __init__(
        self,
        wall: CoupledWall,
        host: Host,
        ground: Callable[[float], float],
        dt: float,
        weight: float,
        tolerance: float,
    ) -> None:
        self._wall, self._host, self._ground, self._dt = wall, host, ground, dt
        self._weight, self._tolerance = weight, tolerance * weight
        self._frame = LinkedFrame(host, dt, weight)
        mass = wall.links.T @ self._frame.mass @ wall.links
        self._mass: Reals = (mass + mass.T) / 2
        self.run = CoupledRun(float(self._mass[0, 0]))
        self._theta = 0.0
        # time of a lift-off after which the wall did not move away
        self._returned_at = -math.inf
        self._y: Reals = np.zeros((3, wall.n))
        self._forces: Reals = np.zeros(len(host.links))
        self._rates: Reals = np.zeros(len(host.links))
        self._losses = [0.0, 0.0, 0.0]
        self._enter(wall.element.side, np.zeros(wall.n))
        self._note()

    def advance(self, t: float) -> None:
        """Step to a time, with stops at impacts and lift-offs."""
        least = _NOTHING * self._dt
        for _ in range(_MOST_STOPS):
            h = t - self._host.time()
            if h <= least:
                self._note()
                return
            try:
                if self._wall.element.side:
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
        run, wall = self.run, self._wall
        run.t.append(self._host.time())
        run.u.append(float(self._host.motion()[0][self._host.links[-1]]))
        run.theta.append(self._theta)
        run.force.append(-float(wall.shares @ self._forces))
        run.link_forces.append(-self._forces)
        run.deflection.append(wall.deflection(self._y))
        run.energy = CouplingEnergy(*self._losses)

    def _split(self) -> Split:
        return self._wall.split(is_held=not self._wall.element.side)

    def _coordinates(self, split: Split) -> Reals:
        """Return the committed coordinates of the wall with their rates."""
        return np.asarray(
            self._y[:, split.integrated] @ split.own.T + self._frame.motion() @ split.follow.T
        )

    def _system(self, split: Split, flexibility: Reals, tangent: Reals) -> Reals:
        """Derive `_residuals` by the forces of the links and the wall's own coordinates."""
        links = self._wall.links
        by_forces = split.follow @ flexibility
        own_by_links = links[split.tied] @ split.own
        tied = [links[split.tied] @ by_forces - flexibility[split.tied], -own_by_links]
        rows = tangent[split.balanced]
        balanced = [links[:, split.balanced].T + rows @ by_forces, -rows @ split.own]
        return np.block([tied, balanced])

    def _residuals(
        self, split: Split, at_links: Reals, y: Reals, forces: Reals, resisting: Reals
    ) -> Reals:
        """Conditions that a step meets: tied links, then the balance of the wall's coordinates."""
        links = self._wall.links
        tied = at_links[split.tied] - links[split.tied] @ y
        return np.append(tied, (forces @ links - resisting)[split.balanced])

    def _respond(self, split: Split, y: Reals, ground: float) -> WallResponse:
        """Response of the wall; at rest without own coordinates it has none."""
        return self._wall.respond(y, ground) if split.balanced.size else self._wall.none

    def _solve(self, h: float) -> _Step:
        """Find the forces of the links with which wall and frame agree at the end of a step."""
        split = self._split()
        y_0 = self._coordinates(split)
        ground = self._ground(self._host.time() + h)
        forces = self._forces + h * self._rates
        own = (h * y_0[1] + h * h / 2 * y_0[2])[split.integrated]
        rounding = max(_ROUNDING * self._weight, self._inertia_rounding(y_0[1], h))
        last = error = math.inf
        for iteration in range(_MOST_ITERATIONS):
            self.run.iterations += 1
            increment = self._host.attempt(-forces, h)[self._host.links]
            change = split.own @ own + split.follow @ increment
            y = np.array([y_0[0] + change, *end_rates(change, h, y_0[1], y_0[2])])
            is_late = iteration > 0 and iteration % _PATIENCE == 0
            flexibility = self._frame.flexibility(h, is_new=is_late)
            r = self._respond(split, y, ground)
            residuals = self._residuals(split, increment, change, forces, r.force)
            error = self._error(split, flexibility, residuals)
            if error <= self._tolerance or (error >= last / 2 and error <= rounding):
                u = self._frame.motion()[0] + increment
                return _Step(forces, u, y, r.theta, r.theta_dot, error)
            last = error
            tangent = r.stiffness + 2 / h * r.damping + 4 / h**2 * r.mass
            correction = np.linalg.solve(self._system(split, flexibility, tangent), residuals)
            forces = forces - correction[: len(forces)]
            own = own - correction[len(forces) :]
        raise NumericalError(
            f"t = {self._host.time():g} s: wall and host disagree by {error:.3g} N after "
            f"{_MOST_ITERATIONS} iterations: shorten dt"
        )

    def _inertia_rounding(self, velocities: Reals, h: float) -> float:
        """Round-off of inertia forces [N]: accelerations are differences over the step."""
        speed = float(np.abs(velocities).max())
        return _DIGITS * float(np.abs(self._frame.mass).max()) * speed / h

    def _error(self, split: Split, flexibility: Reals, residuals: Reals) -> float:
        """Largest residual as a force [N]."""
        tied = split.tied.size
        error = float(np.abs(residuals[tied:]).max(initial=0.0))
        if tied:
            apart = np.zeros(len(flexibility))
            apart[split.tied] = residuals[:tied]
            error = max(error, float(np.abs(np.linalg.solve(flexibility, apart)).max()))
        return error

    def _commit(self, step: _Step, h: float) -> None:
        """Make a step of the host, with its energies and maxima."""
        u_0, v_0, _ = self._frame.motion()
        self._host.commit(-step.forces, h)
        u, v, _ = self._frame.motion()
        way = step.u - u_0
        self._losses[0] += float((self._forces + step.forces) / 2 @ way)
        self._losses[2] += step.residual * float(np.abs(way).sum())
        self._rates = (step.forces - self._forces) / h
        self._forces, self._y, self._theta = step.forces, step.y, step.theta
        highest = max(abs(u[-1]), abs(u_0[-1]))
        if v_0[-1] * v[-1] < 0:
            turn = h * v_0[-1] / (v_0[-1] - v[-1])
            highest = max(highest, abs(u_0[-1] + v_0[-1] * turn / 2))
        self.run.u_s_max = max(self.run.u_s_max, float(highest))
        if self._wall.element.side:
            self._wall.element.commit()

    def _rock(self, h: float) -> None:
        """Step a rocking wall, at most to an impact or to the end of a branch."""
        element = self._wall.element
        begin = self._coordinates(self._split())
        t = self._host.time()
        step = self._solve(h)
        grounds = self._ground(t), self._ground(t + h)
        event = self._wall.next_event(h, begin, step.y, grounds, (0.0, 0.0))
        if event is not None and event.tau <= _NOTHING * self._dt:
            if event.kind == "impact" and step.y[0, 0] * element.side <= 0:
                # a wall that has just lifted off does not move away
                element.revert()
                self._returned_at = t
                self._stop_on_base(begin[1])
                return
            event = None
        if event is None:
            self._commit(step, h)
            return
        tau = event.tau
        step = self._solve(tau)
        if event.kind == "impact":
            for _ in range(_MOST_REPETITIONS):
                u, v = step.y[:2, 0]
                change = -float(u / v) if v else 0.0
                if abs(change) <= _NOTHING * self._dt or not 0 < tau + change <= h:
                    break
                tau += change
                step = self._solve(tau)
        side = element.side
        self._commit(step, tau)
        # a short flight may turn while the step is shortened: it then goes on
        if event.kind == "impact" and step.y[1, 0] * side < 0:
            self._land(step)

    def _kinetic(self, velocities: Reals) -> float:
        """Kinetic energy of the wall on its base and of the frame at the links [J]."""
        y = np.array([self._y[0], velocities, np.zeros(self._wall.n)])
        y[0, 0] = 0.0
        mass = self._wall.respond(y, 0.0).mass + self._mass
        return float(velocities @ mass @ velocities) / 2

    def _land(self, step: _Step) -> None:
        """Change the velocities by the balance of momentum, and the side."""
        element, run = self._wall.element, self.run
        t = self._host.time()
        run.impacts += 1
        run.events.append(WallEvent("impact", t, 0.0, step.theta_dot))
        before = step.y[1]
        self._losses[1] += self._kinetic(before)
        # on the base the coordinates are those of the element
        after = element.land(step.y[0], before, self._mass)
        run.velocity_factor = float(after[0] / before[0])
        if after[0] == 0 or self._settles(step.y[0], after):
            run.events.append(WallEvent("rest", t, 0.0, 0.0))
            self._stop_on_base(after)
        else:
            self._enter(element.side, after)
        self._losses[1] -= self._kinetic(self._y[1])

    def _settles(self, displacements: Reals, velocities: Reals) -> bool:
        """Tell whether the flights after an impact are shorter than a step."""
        element, t = self._wall.element, self._host.time()
        landed = element.save()
        element.place(0)
        still = velocities.copy()
        still[0] = 0.0
        of_frame = self._frame.with_link_velocities(self._wall.links @ velocities)
        free = self._frame.free_accelerations(of_frame)[self._host.links]
        forces, accelerations = self._equilibrium(still, free)
        element.restore(landed)
        accelerations[0] = 0.0
        motion = np.array([displacements, velocities, accelerations])
        push = self._wall.push(forces)
        return element.settles(self._dt, motion, self._ground(t), push, self._mass)

    def _stop_on_base(self, velocities: Reals) -> None:
        """Begin to rest: the straight wall stops, its modes and floors on springs go on."""
        still = velocities.copy()
        still[0] = 0.0
        self._enter(0, still)

    def _equilibrium(self, velocities: Reals, free: Reals) -> tuple[Reals, Reals]:
        """Find forces of the links and accelerations of the wall, on its present side.

        `free` are the accelerations of the links without forces.
        """
        split = self._split()
        y = np.array([self._y[0], velocities, split.follow @ free])
        r = self._respond(split, y, self._ground(self._host.time()))
        residuals = self._residuals(split, free, y[2], np.zeros(len(free)), r.force)
        by_force = self._frame.by_force[self._host.links]
        solution = np.linalg.solve(self._system(split, by_force, r.mass), -residuals)
        forces, own = np.split(solution, [len(free)])
        return forces, split.own @ own + split.follow @ (free - by_force @ forces)

    def _enter(self, side: int, velocities: Reals) -> None:
        """Begin to rock on a side, or to rest, with accelerations in equilibrium."""
        if side != self._wall.element.side:
            self._wall.element.place(side)
        if side == 0:
            self._y[0, 0] = 0.0
        of_frame = self._frame.with_link_velocities(self._wall.links @ velocities)
        free = self._frame.free_accelerations(of_frame)
        self._forces, accelerations = self._equilibrium(velocities, free[self._host.links])
        self._rates = np.zeros(len(self._forces))
        self._y = np.array([self._y[0], velocities, accelerations])
        self._host.set_rates(of_frame, free - self._frame.by_force @ self._forces)

    def _hold(self, h: float) -> None:
        """Step beside a wall at rest, at most to its lift-off."""
        begin = self._coordinates(self._split())
        t = self._host.time()
        grounds = self._ground(t), self._ground(t + h)
        step = self._solve(h)
        ends = self._wall.push(self._forces), self._wall.push(step.forces)
        event = self._wall.next_event(h, begin, step.y, grounds, ends)
        is_now = event is not None and event.tau <= _NOTHING * self._dt
        if event is None or (is_now and t == self._returned_at):
            # a flight that ends in the step of its lift-off is left out
            self._commit(step, h)
            return
        if not is_now:
            # the push need not be linear: the rest of the step shows the lift-off, or none
            self._commit(self._solve(event.tau), event.tau)
            return
        self.run.events.append(WallEvent("lift_off", t, 0.0, 0.0))
        self._enter(event.side, begin[1])


@checked
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
        Wall with `m_w`, tendon, fuses, `&bending`, impact rule and other effects of an `Element`.
        Its frame and motion have no effect, but for link springs of `&storeys`.
    host : Host
        The frame at rest, for example an `OpenSeesHost` or a `FunctionHost`.
    ground : callable
        Ground acceleration [m/s2] at a time [s], the one of the host; linear within a step.
    dt : float
        Step [s]. With `&bending`, at most a twentieth of the period of the highest mode.
    t_end : float
        End [s].
    heights : array_like, shape (links,), optional
        Heights of the links above the base, from the ground up [m], by default those of `&storeys`.
        Needed for several links. A rigid wall keeps them on a straight line; the highest is the
        link of the case. A wall that bends has its highest link at 2h.
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
    if not hasattr(host, "links") or not callable(getattr(host, "attempt", None)):
        raise InputError(f"host = {show(host)}: must be an OpenSeesHost, a FunctionHost or a Host")
    given = case_of(case)
    mass = None if given.wall is None else given.wall.get("m_w")
    if mass is None:
        raise InputError("case: a coupling needs &wall m_w, the mass of the wall")
    weight = to_number("m_w", mass) * given.model.g
    wall = CoupledWall(given, len(host.links), heights)
    warn(given.kernel.motion_warnings())
    pair = Pair(wall, host, ground, dt, weight, tolerance)
    begin = host.time()
    for number in range(1, math.ceil((t_end - begin) / dt * (1 - 1e-12)) + 1):
        pair.advance(min(begin + number * dt, t_end))
    return pair.run
