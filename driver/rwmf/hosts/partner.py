"""Frame of a coupling: its interface and results; one of matrices or functions, one in OpenSeesPy.

OpenSees has no command that takes a step back. A step that does not converge is taken back,
however, and leaves its last increment in the equation solver. So `OpenSeesHost.attempt` lets the
analysis fail after 1, 2, ... iterations of Newton's method and adds their increments.
"""

from __future__ import annotations

import math
import os
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import ModuleType
from typing import NamedTuple, Protocol

import numpy as np

from rwmf.case.arguments import function_of
from rwmf.errors import InputError, NumericalError
from rwmf.hosts.wall import WallEvent
from rwmf.kernel.numbers import (
    Array,
    Wholes,
    show,
    to_array,
    to_items,
    to_number,
    to_shaped,
    to_whole,
)

# step whose square is far above the smallest number [s]
_SHORTEST = 1e-100


class Host(Protocol):
    """A frame that steps by Newmark's average acceleration and can try a step.

    Vectors over the degrees of freedom hold displacements relative to the ground.

    Attributes
    ----------
    links : numpy.ndarray of int, shape (links,)
        Degrees of freedom linked to the wall, from the ground up.
    """

    links: Wholes

    def motion(self) -> tuple[Array, Array, Array]:
        """Return the committed motion of all degrees of freedom.

        Returns
        -------
        tuple of numpy.ndarray, each of shape (dofs,)
            Displacements [m], velocities [m/s], accelerations [m/s2].
        """
        ...

    def time(self) -> float:
        """Return the time of the committed motion.

        Returns
        -------
        float
            The time [s].
        """
        ...

    def attempt(self, forces: Array, h: float) -> Array:
        """Compute a step without committing it.

        Parameters
        ----------
        forces : numpy.ndarray, shape (links,)
            Forces on the frame at the links at the end of the step [N].
        h : float
            Length of the step [s].

        Returns
        -------
        numpy.ndarray, shape (dofs,)
            Increments of displacement [m].

        Raises
        ------
        NumericalError
            When the frame finds no equilibrium.
        """
        ...

    def commit(self, forces: Array, h: float) -> None:
        """Make a step.

        Parameters
        ----------
        forces : numpy.ndarray, shape (links,)
            Forces on the frame at the links at the end of the step [N].
        h : float
            Length of the step [s].

        Raises
        ------
        NumericalError
            When the frame finds no equilibrium.
        """
        ...

    def set_rates(self, velocities: Array, accelerations: Array) -> None:
        """Replace the committed rates, after an impact, a lift-off or rest.

        Parameters
        ----------
        velocities : numpy.ndarray, shape (dofs,)
            Velocities [m/s].
        accelerations : numpy.ndarray, shape (dofs,)
            Accelerations [m/s2].
        """
        ...


class IteratedHost(Host):
    """A host that corrects the increments of a step until it is in equilibrium."""

    _most_iterations: int

    def attempt(self, forces: Array, h: float) -> Array:
        """Compute a step without committing it."""
        forces, h = self._checked(forces, h)
        increment = self._guess(h)
        for iteration in range(1, self._most_iterations + 1):
            correction, is_last = self._correct(increment, forces, h, iteration)
            increment = increment + correction
            if is_last:
                return increment
        raise NumericalError(f"t = {self.time():g} s: the host finds no equilibrium")

    def commit(self, forces: Array, h: float) -> None:
        """Make a step."""
        self._make_step(*self._checked(forces, h))

    def _checked(self, forces: Array, h: float) -> tuple[Array, float]:
        links = (len(self.links),)
        return to_shaped("forces", forces, links), to_number(
            "h", h, above=_SHORTEST, below=1 / _SHORTEST
        )

    @abstractmethod
    def _guess(self, h: float) -> Array:
        """Return the increments before the first correction."""

    @abstractmethod
    def _correct(
        self, increment: Array, forces: Array, h: float, iteration: int
    ) -> tuple[Array, bool]:
        """Return a correction of increments, and whether it is the last one."""

    @abstractmethod
    def _make_step(self, forces: Array, h: float) -> None:
        """Make a step, as `commit`."""


def end_rates(increment: Array, h: float, v: Array, a: Array) -> tuple[Array, Array]:
    """Return the rates at the end of a step of average acceleration."""
    mean = increment / h
    return 2 * mean - v, 4 * (mean - v) / h - a


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
        Mass of the frame that moves with the wall, at the highest link [kg]; 0 on link springs.
    t : list of float
        Times [s].
    u, theta, force : list of float
        Displacement of the highest link [m], rotation of the wall [rad], and force of the wall on
        the frame [N]. The force is summed over the links by their heights.
    link_forces : list of numpy.ndarray, each of shape (links,)
        Force of the wall on the frame at each link [N].
    deflection : list of float
        Deflection of the top of a wall that bends [m]; 0 of a rigid wall.
    events : list of WallEvent
        Lift-offs, impacts and rest.
    u_s_max : float
        Largest displacement of the highest link, also inside steps [m].
    impacts : int
        Number of impacts.
    velocity_factor : float
        Factor on the velocity of the straight wall at the last impact [-]; NaN without one.
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
    link_forces: list[Array] = field(default_factory=list)
    deflection: list[float] = field(default_factory=list)
    events: list[WallEvent] = field(default_factory=list)
    u_s_max: float = 0.0
    impacts: int = 0
    energy: CouplingEnergy = field(default_factory=lambda: CouplingEnergy(0.0, 0.0, 0.0))
    iterations: int = 0


# flexibilities that are kept, and the digits by which their steps differ
_MOST_KEPT = 8
_DIGITS = 6
# part of the step that shows masses and accelerations of the host
_INSTANT = 1e-4
# relative difference of masses that two such parts show
_SAME_MASS = 1e-2


class LinkedFrame:
    """A host as its links show it.

    Attributes
    ----------
    by_force : numpy.ndarray, shape (dofs, links)
        Accelerations of the frame by unit forces at the links [1/kg].
    mass : numpy.ndarray, shape (links, links)
        Mass of the frame at the links [kg].
    """

    def __init__(self, host: Host, dt: float, force: float) -> None:
        self._host, self._dt, self._force = host, dt, force
        self._instant = _INSTANT * dt
        self._flexibilities: dict[float, Array] = {}
        self.by_force: Array = self._increments(self._instant) * 4 / self._instant**2
        at_links = self.by_force[host.links]
        # without a mass the acceleration would grow as the step shrinks
        longer = 10 * self._instant
        again = self._increments(longer)[host.links] * 4 / longer**2
        if not np.allclose(at_links, again, rtol=_SAME_MASS) or not np.all(np.diag(again) > 0):
            raise InputError("host: a link has no mass")
        self.mass: Array = np.asarray(np.linalg.inv(at_links), dtype=np.float64)

    def _increments(self, h: float) -> Array:
        """Increments of the frame in a step by unit forces on the frame at the links [m/N]."""
        links = len(self._host.links)
        base = self._host.attempt(np.zeros(links), h)
        columns = [
            (self._host.attempt(self._force * unit, h) - base) / self._force
            for unit in np.eye(links)
        ]
        return np.array(columns).T

    def motion(self) -> Array:
        """Return the committed motion of the links."""
        return np.array([values[self._host.links] for values in self._host.motion()])

    def flexibility(self, h: float, is_new: bool) -> Array:
        """Return the displacements of the links by unit forces at the end of a step."""
        # whole steps differ by the rounding of the times
        part = round(h / self._dt, _DIGITS)
        if is_new or part not in self._flexibilities:
            if len(self._flexibilities) > _MOST_KEPT:
                self._flexibilities.clear()
            self._flexibilities[part] = self._increments(h)[self._host.links]
        return self._flexibilities[part]

    def with_link_velocities(self, at_links: Array) -> Array:
        """Return the velocities of the frame after impulses at the links."""
        links = self._host.links
        _, velocities, _ = self._host.motion()
        change = at_links - velocities[links]
        return np.asarray(
            velocities + self.by_force @ np.linalg.solve(self.by_force[links], change)
        )

    def free_accelerations(self, velocities: Array) -> Array:
        """Return the accelerations without forces at the links, and set the velocities."""
        host, h = self._host, self._instant
        _, _, accelerations = host.motion()
        host.set_rates(velocities, accelerations)
        increment = host.attempt(np.zeros(len(host.links)), h)
        return end_rates(increment, h, velocities, accelerations)[1]


# relative size of an increment at which Newton's method has converged
_CONVERGED = 1e-13
# difference for a tangent, relative to the increment of a step
_DIFFERENCE = 1e-6


class FunctionHost(IteratedHost):
    """A frame given by its masses and functions for damping and restoring forces.

    Its equation is M u'' + d(u') + r(u) + f = -M u_g'', with all displacements horizontal and
    relative to the ground.

    Parameters
    ----------
    mass : array_like, shape (dofs,) or (dofs, dofs)
        Masses, or mass matrix [kg].
    damping : array_like, shape (dofs, dofs), or callable
        Matrix [N s/m], or damping forces [N] at velocities [m/s].
    restoring : array_like, shape (dofs, dofs), or callable
        Matrix [N/m], or restoring forces [N] at displacements [m]. A function is called for trial
        displacements in any order; a law with memory keeps its state until `on_commit`.
    ground : callable
        Ground acceleration [m/s2] at a time [s].
    links : sequence of int
        Degrees of freedom linked to the wall, from the ground up, counted from 0.
    on_commit : callable, optional
        Called with the displacements [m] at the end of each step.

    Raises
    ------
    InputError
        When an argument is not acceptable.
    """

    _most_iterations = 50

    def __init__(
        self,
        mass: object,
        damping: object,
        restoring: object,
        ground: Callable[[float], float],
        links: object,
        on_commit: Callable[[Array], None] | None = None,
    ) -> None:
        self._mass = _matrix("mass", mass)
        n = len(self._mass)
        self._damping = _forces("damping", damping, n)
        self._restoring = _forces("restoring", restoring, n)
        self._ground = function_of("ground", ground)
        self._on_commit = None if on_commit is None else function_of("on_commit", on_commit)
        numbers = [to_whole("links", number, 0, n - 1) for number in to_items(links) or []]
        if not numbers:
            raise InputError(f"links = {show(links)}: must be numbers in [0, {n - 1}]")
        self.links: Wholes = np.array(numbers, dtype=np.int64)
        self._t = 0.0
        self._u, self._v, self._a = np.zeros((3, n))

    def motion(self) -> tuple[Array, Array, Array]:
        """Return the committed displacements, velocities and accelerations [m, s].

        Returns
        -------
        tuple of numpy.ndarray, each of shape (dofs,)
            The motion.
        """
        return self._u, self._v, self._a

    def time(self) -> float:
        """Return the time of the committed motion.

        Returns
        -------
        float
            The time [s].
        """
        return self._t

    def _guess(self, h: float) -> Array:
        return h * self._v

    def _correct(
        self, increment: Array, forces: Array, h: float, iteration: int
    ) -> tuple[Array, bool]:
        """Take a step of Newton's method."""
        load = -self._mass.sum(axis=1) * self._ground(self._t + h)
        np.add.at(load, self.links, forces)
        speed = np.abs(self._v).max()
        size = max(h * speed + h * h * np.abs(self._a).max(), np.abs(increment).max())
        v, a = end_rates(increment, h, self._v, self._a)
        u = self._u + increment
        residual = load - self._mass @ a - self._damping(v) - self._restoring(u)
        matrix = (
            4 / h**2 * self._mass
            + 2 / h * _tangent(self._damping, v, speed + h)
            + _tangent(self._restoring, u, size + h * h)
        )
        correction = np.linalg.solve(matrix, residual)
        return correction, bool(np.abs(correction).max() <= _CONVERGED * size)

    def _make_step(self, forces: Array, h: float) -> None:
        increment = self.attempt(forces, h)
        v, a = end_rates(increment, h, self._v, self._a)
        self._u, self._v, self._a = self._u + increment, v, a
        self._t += h
        if self._on_commit is not None:
            self._on_commit(self._u.copy())

    def set_rates(self, velocities: Array, accelerations: Array) -> None:
        """Replace the committed rates.

        Parameters
        ----------
        velocities : numpy.ndarray, shape (dofs,)
            Velocities [m/s].
        accelerations : numpy.ndarray, shape (dofs,)
            Accelerations [m/s2].
        """
        shape = self._u.shape
        self._v = to_shaped("velocities", velocities, shape)
        self._a = to_shaped("accelerations", accelerations, shape)


def _matrix(name: str, value: object, n: int | None = None) -> Array:
    """Return a square matrix; a vector is its diagonal."""
    array = to_shaped(name, value)
    square = np.diag(array) if array.ndim == 1 else array
    if square.ndim != 2 or not square.size or len({*square.shape, n or len(square)}) > 1:
        size = "(dofs, dofs)" if n is None else f"({n}, {n})"
        raise InputError(f"{name}: has the shape {array.shape}: must have {size}")
    return square


def _forces(name: str, value: object, n: int) -> Callable[[Array], Array]:
    """Return a function for forces."""
    if not callable(value):
        return partial(np.matmul, _matrix(name, value, n))

    def compute(at: Array) -> Array:
        return to_array(name, value(at.copy()), least=n)

    return compute


def _tangent(forces: Callable[[Array], Array], at: Array, size: float) -> Array:
    """Return the derivative of forces: a matrix, or that of a function by differences."""
    if isinstance(forces, partial):
        return np.asarray(forces.args[0])
    step = _DIFFERENCE * size
    here = forces(at)
    columns = [(forces(at + step * unit) - here) / step for unit in np.eye(len(at))]
    return np.array(columns).T


# a residual below this part of the largest force in the first iteration counts as round-off
_ROUNDING = 1e-6
_NEVER = -1.0


class OpenSeesHost(IteratedHost):
    """A frame that is the present model of OpenSeesPy.

    The model is complete before: masses at the linked nodes, and the ground acceleration as a
    `UniformExcitation`. This class makes the analysis (Newmark's average acceleration) and one load
    pattern. Constraints are handled by ``Plain``, so `equalDOF` is allowed. OpenSees then writes
    its messages to `log`, since every trial step ends with one.

    Parameters
    ----------
    ops : module
        ``openseespy.opensees``.
    nodes : sequence of int
        Tags of the nodes linked to the wall, from the ground up.
    dof : int
        Their horizontal degree of freedom, from 1.
    tolerance : float
        Residual force of an equilibrium of the frame [N].
    system : sequence
        Arguments of this command.
    tag : int
        Unused tag of a time series and a load pattern.
    log : path
        File for the messages of OpenSees.

    Raises
    ------
    InputError
        When a node does not exist, or its degree of freedom is fixed.
    """

    _most_iterations = 20

    def __init__(
        self,
        ops: ModuleType,
        nodes: Sequence[int],
        dof: int = 1,
        tolerance: float = 1e-6,
        system: Sequence[object] = ("BandGeneral",),
        tag: int = 987654,
        log: str = os.devnull,
    ) -> None:
        self._ops = ops
        self._tolerance = tolerance
        self._tag = tag
        self._dof = to_whole("dof", dof, 1)
        self._nodes = _existing(ops, nodes)
        ops.logFile(log, "-noEcho")
        ops.timeSeries("Constant", tag)
        ops.wipeAnalysis()
        ops.constraints("Plain")
        ops.numberer("RCM")
        ops.system(*system)
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
        self._ends_always(1)
        ops.analysis("Transient")
        self._load(np.zeros(len(self._nodes)))
        # numbers the equations; the step is taken back
        ops.analyze(1, 1e-9)
        self._places = [
            (equation, node, place)
            for node in ops.getNodeTags()
            for place, equation in enumerate(ops.nodeDOFs(node), start=1)
            if equation >= 0
        ]
        self._n = 1 + max(equation for equation, _, _ in self._places)
        found = {(node, place): equation for equation, node, place in self._places}
        for node in self._nodes:
            if (node, self._dof) not in found:
                raise InputError(f"nodes = {node}: degree of freedom {self._dof} is not free")
        self.links: Wholes = np.array([found[node, self._dof] for node in self._nodes])

    def _load(self, forces: Array) -> None:
        """Put forces on the linked nodes."""
        ops, tag = self._ops, self._tag
        if tag in ops.getPatterns():
            ops.remove("loadPattern", tag)
        ops.pattern("Plain", tag, tag)
        for node, force in zip(self._nodes, forces.tolist(), strict=True):
            values = [0.0] * len(ops.nodeDisp(node))
            values[self._dof - 1] = force
            ops.load(node, *values)

    def _ends_always(self, iterations: int) -> None:
        """Let every step fail after a number of iterations."""
        self._ops.test("NormUnbalance", _NEVER, iterations)

    def motion(self) -> tuple[Array, Array, Array]:
        """Return the committed displacements, velocities and accelerations.

        Returns
        -------
        tuple of numpy.ndarray, each of shape (equations,)
            Of translations in m and s, of rotations in rad and s.
        """
        ops = self._ops
        motion = np.zeros((3, self._n))
        for equation, node, place in self._places:
            motion[:, equation] = (
                ops.nodeDisp(node, place), ops.nodeVel(node, place), ops.nodeAccel(node, place),
            )  # fmt: skip
        u, v, a = motion
        return u, v, a

    def time(self) -> float:
        """Return the time of the domain.

        Returns
        -------
        float
            The time [s].
        """
        return float(self._ops.getTime())

    def _guess(self, h: float) -> Array:
        return np.zeros(self._n)

    def _correct(
        self, increment: Array, forces: Array, h: float, iteration: int
    ) -> tuple[Array, bool]:
        """Repeat the step with one iteration more, and take the last increment from the solver."""
        ops = self._ops
        if iteration == 1:
            self._load(forces)
        self._ends_always(iteration)
        if ops.analyze(1, h) == 0:
            raise NumericalError(f"t = {self.time():g} s: OpenSees kept a trial step")
        correction = np.array(ops.printX("-ret"))
        norms = ops.testNorms()[:iteration]
        residual = norms[-1]
        is_close = residual <= self._tolerance
        is_stuck = iteration > 1 and residual > norms[-2] / 2
        rounding = _ROUNDING * self._size(increment + correction, h)
        return correction, is_close or (is_stuck and residual <= rounding)

    def _size(self, increment: Array, h: float) -> float:
        """Force that rounding is relative to [N]: 4 m u / h2 with a mass of 1 t at least."""
        return 1e3 + 4e3 * float(np.abs(increment).max()) / h**2

    def _make_step(self, forces: Array, h: float) -> None:
        self._load(forces)
        # short steps end at the rounding of their inertia forces
        for tolerance in (self._tolerance, 1e3 * self._tolerance, 1e6 * self._tolerance):
            self._ops.test("NormUnbalance", tolerance, self._most_iterations)
            if self._ops.analyze(1, h) == 0:
                return
        raise NumericalError(f"t = {self.time():g} s: OpenSees does not converge")

    def set_rates(self, velocities: Array, accelerations: Array) -> None:
        """Replace the committed rates of all nodes.

        Parameters
        ----------
        velocities : numpy.ndarray, shape (equations,)
            Velocities [m/s, rad/s].
        accelerations : numpy.ndarray, shape (equations,)
            Accelerations [m/s2, rad/s2].
        """
        for equation, node, place in self._places:
            self._ops.setNodeVel(node, place, float(velocities[equation]), "-commit")
            self._ops.setNodeAccel(node, place, float(accelerations[equation]), "-commit")
        # the integrator keeps a copy of the motion; it reads the nodes again after a change
        self._ops.domainChange()


def _existing(ops: ModuleType, nodes: object) -> list[int]:
    """Return tags of nodes after checking that they exist."""
    tags = to_items(nodes)
    known = set(ops.getNodeTags())
    if not tags:
        raise InputError(f"nodes = {show(nodes)}: must be a list of tags")
    for tag in tags:
        if tag not in known:
            raise InputError(f"nodes = {show(tag)}: is no node of the model")
    return [int(tag) for tag in tags]
