"""A wall and a frame that step together: coordinates with linear links, and the time loop."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError, NumericalError, placed, warn
from rwmf.hosts.element import Element, ElementEvent, ElementResponse
from rwmf.hosts.partner import (
    CoupledRun,
    CouplingEnergy,
    Host,
    LinkedFrame,
    end_rates,
)
from rwmf.hosts.wall import WallEvent
from rwmf.kernel.numbers import Array, Wholes, show, to_array, to_items, to_number

# groups of the frame, which the host owns
_FRAME = ("frame", "storeys", "yielding", "p_delta")
_TANGENTS = ("stiffness", "damping", "mass")


class Split(NamedTuple):
    """Coordinates of the wall by their owner: y = own z + follow u_links.

    Attributes
    ----------
    integrated : numpy.ndarray of int, shape (own,)
        Coordinates that the wall integrates.
    own : numpy.ndarray, shape (n, own)
        Derivatives of the coordinates by those that the wall integrates.
    follow : numpy.ndarray, shape (n, links)
        Derivatives by the displacements of the links of the host.
    tied : numpy.ndarray of int, shape (tied,)
        Links whose displacement is a condition.
    balanced : numpy.ndarray of int, shape (balanced,)
        Coordinates whose balance is a condition.
    """

    integrated: Wholes
    own: Array
    follow: Array
    tied: Wholes
    balanced: Wholes


class CoupledWall:
    """An element whose links move by ``links @ y``.

    The coordinates y are u of the straight wall, p = q cos(theta) for each mode q of `&bending`,
    and the floors on link springs. Rigid links of a wall that bends move by a linear combination of
    u and p. So displacements, velocities and accelerations of wall and frame agree in each step.

    Attributes
    ----------
    element : Element
        The element.
    n : int
        Number of coordinates.
    modes : int
        Number of modes.
    links : numpy.ndarray, shape (links, n)
        Displacements of the links of the host by unit coordinates.
    shares : numpy.ndarray, shape (links,)
        Heights of the links over that of the highest one.
    none : WallResponse
        Response of zeros.
    """

    def __init__(self, case: Case, links: int, heights: object) -> None:
        given = _heights(case, heights, links)
        is_on_springs = case.storeys is not None and case.storeys.coupling == "springs"
        if case.bending is not None and links > 1 and not is_on_springs:
            case = _at_heights(case, given)
        self.element = Element(case)
        self.n, self.modes = self.element.dofs, self.element.modes
        self._is_on_springs = is_on_springs
        still = np.zeros(self.n)
        # derivatives of the displacements of the wall at the links
        by_u = self.element.motion_of_links(still, still, still)[3:].T
        if is_on_springs:
            _compare(case, given, links, by_u[:, 0])
            self.shares: Array = by_u[:, 0]
            self.links: Array = np.eye(self.n)[1 + self.modes :]
        elif self.n == 1:
            self.shares = given / given[-1]
            self.links = self.shares[:, np.newaxis]
        else:
            self.shares, self.links = by_u[:, 0], by_u
        no = np.zeros((self.n, self.n))
        self.none = ElementResponse(*[no[0], no, no, no, *[no[0, 0]] * 6])
        self._splits = [self._split(is_held) for is_held in (False, True)]

    def split(self, is_held: bool) -> Split:
        """Return the coordinates by their owner."""
        return self._splits[is_held]

    def _split(self, is_held: bool) -> Split:
        n, links = self.n, len(self.links)
        first = 1 if is_held else 0
        follow = np.zeros((n, links))
        index, tied = np.arange(1, 1 + self.modes), np.arange(0)
        if self._is_on_springs:
            index = np.arange(first, 1 + self.modes)
            follow[1 + self.modes :] = np.eye(links)
        own = np.eye(n)[:, index]
        if not self._is_on_springs:
            tied = np.arange(links if is_held else links - 1)
            if not is_held:
                # u follows the highest link
                own[0] = -self.links[-1, 1:]
                follow[0, -1] = 1.0
        return Split(index, own, follow, tied, np.arange(first, n))

    def element_motion(self, y: Array) -> tuple[Array, Array]:
        """Return the motion in the coordinates of the element."""
        by_y = np.eye(self.n)
        if not self.modes or self._is_on_springs or not self.element.side:
            return y, by_y
        # the highest link of a wall that is bent by q = 1 m moves by u + cos(theta)
        bent = np.zeros_like(y)
        bent[:, 0], bent[0, 1] = y[:, 0], 1.0
        at_links = self.element.motion_of_links(*bent)[:, -1]
        c, c_dot, c_ddot = at_links[:3] - y[:, 0]
        by_u = at_links[3] - 1.0
        p, p_dot, p_ddot = y[:, 1:]
        x = y.copy()
        x[0, 1:] = q = p / c
        x[1, 1:] = q_dot = (p_dot - q * c_dot) / c
        x[2, 1:] = (p_ddot - 2 * q_dot * c_dot - q * c_ddot) / c
        by_y[1:, 1:] /= c
        by_y[1:, 0] = -q * by_u / c
        return x, by_y

    def respond(self, y: Array, ground: float) -> ElementResponse[Array]:
        """Compute a trial response.

        The derivatives leave out the change of the coordinates' own derivatives, which vanishes
        with the square of a step.
        """
        respond: Any = self.element.respond
        if self.n == 1:
            found = respond(*y[:, 0].tolist(), ground)
            force = np.array([found.force])
            turned = {name: np.array([[getattr(found, name)]]) for name in _TANGENTS}
        else:
            x, by_y = self.element_motion(y)
            found = respond(*x, ground)
            force = by_y.T @ found.force
            turned = {name: by_y.T @ getattr(found, name) @ by_y for name in _TANGENTS}
        response: ElementResponse[Array] = found._replace(force=force, **turned)
        return response

    def next_event(
        self,
        h: float,
        begin: Array,
        end: Array,
        grounds: tuple[float, float],
        push: tuple[float, float],
    ) -> ElementEvent | None:
        """Find the first event of a step, as `Element.next_event`."""
        x_0, x = self.element_motion(begin)[0], self.element_motion(end)[0]
        return self.element.next_event(h, x_0, x, grounds, push=push, has_branches=True)

    def deflection(self, y: Array) -> float:
        """Return the deflection of the top."""
        # the deflections of the modes are 1 at the top
        return float(self.element_motion(y)[0][0, 1 : 1 + self.modes].sum())

    def push(self, forces: Array) -> float:
        """Return the force on u of forces at the links."""
        return float(self.links[:, 0] @ forces)


def _heights(case: Case, heights: object, links: int) -> Array:
    """Return the heights of the links, by default those of the case; 1 for a single link."""
    if heights is None and links == 1:
        return np.ones(1)
    if heights is None:
        storeys = [] if case.storeys is None else to_items(case.storeys["height"]) or []
        if len(storeys) != links:
            raise InputError(f"heights: must be given with {links} links")
        heights = np.cumsum(storeys)
    values = to_array("heights", heights, above=0.0)
    if len(values) != links or np.any(np.diff(values) <= 0):
        raise InputError(f"heights = {show(heights)}: must be {links} increasing heights")
    return values


def _at_heights(case: Case, heights: Array) -> Case:
    """Return a case whose element has its links at heights [m]."""
    storeys = {"n": len(heights), "m": 1.0, "k": 1.0, "coupling": "every_floor"}
    alone = case.without(*(name for name in _FRAME if getattr(case, name) is not None))
    with placed(f"heights = {show(heights.tolist())}: "):
        return alone.replace(
            frame={"xi_s": 0.0}, storeys=storeys | {"height": np.diff(heights, prepend=0).tolist()}
        )


def _compare(case: Case, heights: Array, links: int, shares: Array) -> None:
    """Check the heights of link springs against those of the case."""
    if len(shares) != links:
        raise InputError(
            f"host: has {links} links, &storeys coupling = 'springs' of the case {len(shares)}"
        )
    if links > 1 and not np.allclose(heights, shares * heights[-1], rtol=1e-6):
        raise InputError(f"heights = {show(heights.tolist())}: differ from those of &storeys")


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

    forces: Array
    u: Array
    y: Array
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
        self._mass: Array = (mass + mass.T) / 2
        self.run = CoupledRun(float(self._mass[0, 0]))
        self._theta = 0.0
        # time of a lift-off after which the wall did not move away
        self._returned_at = -math.inf
        self._y: Array = np.zeros((3, wall.n))
        self._forces: Array = np.zeros(len(host.links))
        self._rates: Array = np.zeros(len(host.links))
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

    def _coordinates(self, split: Split) -> Array:
        """Return the committed coordinates of the wall with their rates."""
        return np.asarray(
            self._y[:, split.integrated] @ split.own.T + self._frame.motion() @ split.follow.T
        )

    def _system(self, split: Split, flexibility: Array, tangent: Array) -> Array:
        """Derive `_residuals` by the forces of the links and the wall's own coordinates."""
        links = self._wall.links
        by_forces = split.follow @ flexibility
        own_by_links = links[split.tied] @ split.own
        tied = [links[split.tied] @ by_forces - flexibility[split.tied], -own_by_links]
        rows = tangent[split.balanced]
        balanced = [links[:, split.balanced].T + rows @ by_forces, -rows @ split.own]
        return np.block([tied, balanced])

    def _residuals(
        self, split: Split, at_links: Array, y: Array, forces: Array, resisting: Array
    ) -> Array:
        """Conditions that a step meets: tied links, then the balance of the wall's coordinates."""
        links = self._wall.links
        tied = at_links[split.tied] - links[split.tied] @ y
        return np.append(tied, (forces @ links - resisting)[split.balanced])

    def _respond(self, split: Split, y: Array, ground: float) -> ElementResponse[Array]:
        """Response of the wall; at rest without own coordinates it has none."""
        return self._wall.respond(y, ground) if split.balanced.size else self._wall.none

    def _solve(self, h: float) -> _Step:
        """Find the forces of the links with which wall and frame agree at the end of a step."""
        split = self._split()
        y_0 = self._coordinates(split)
        ground = self._ground(self._host.time() + h)
        forces = self._forces + h * self._rates
        own = (h * y_0[1] + h * h / 2 * y_0[2])[split.integrated]
        # round-off of inertia forces [N]: accelerations are differences over the step
        largest = [float(np.abs(values).max()) for values in (self._frame.mass, y_0[1])]
        rounding = max(_ROUNDING * self._weight, _DIGITS * math.prod(largest) / h)
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
                return _Step(forces, u, y, float(r.theta), float(r.theta_dot), error)
            last = error
            tangent = r.stiffness + 2 / h * r.damping + 4 / h**2 * r.mass
            correction = np.linalg.solve(self._system(split, flexibility, tangent), residuals)
            forces = forces - correction[: len(forces)]
            own = own - correction[len(forces) :]
        raise NumericalError(
            f"t = {self._host.time():g} s: wall and host disagree by {error:.3g} N after "
            f"{_MOST_ITERATIONS} iterations: shorten dt"
        )

    def _error(self, split: Split, flexibility: Array, residuals: Array) -> float:
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

    def _kinetic(self, velocities: Array) -> float:
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

    def _settles(self, displacements: Array, velocities: Array) -> bool:
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

    def _stop_on_base(self, velocities: Array) -> None:
        """Begin to rest: the straight wall stops, its modes and floors on springs go on."""
        still = velocities.copy()
        still[0] = 0.0
        self._enter(0, still)

    def _equilibrium(self, velocities: Array, free: Array) -> tuple[Array, Array]:
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

    def _enter(self, side: int, velocities: Array) -> None:
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
