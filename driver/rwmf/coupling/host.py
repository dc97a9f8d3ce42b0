"""Interface of a frame to the time loop of the coupling, and results of the loop."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from rwmf._hosts.states import WallEvent
from rwmf._numbers import to_number, to_shaped
from rwmf.errors import NumericalError

Reals = npt.NDArray[np.float64]
Wholes = npt.NDArray[np.int64]


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

    def motion(self) -> tuple[Reals, Reals, Reals]:
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

    def attempt(self, forces: Reals, h: float) -> Reals:
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

    def commit(self, forces: Reals, h: float) -> None:
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

    def set_rates(self, velocities: Reals, accelerations: Reals) -> None:
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

    def attempt(self, forces: Reals, h: float) -> Reals:
        """Compute a step without committing it."""
        forces, h = self._checked(forces, h)
        increment = self._guess(h)
        for iteration in range(1, self._most_iterations + 1):
            correction, is_last = self._correct(increment, forces, h, iteration)
            increment = increment + correction
            if is_last:
                return increment
        raise NumericalError(f"t = {self.time():g} s: the host finds no equilibrium")

    def commit(self, forces: Reals, h: float) -> None:
        """Make a step."""
        self._make_step(*self._checked(forces, h))

    def _checked(self, forces: Reals, h: float) -> tuple[Reals, float]:
        links = (len(self.links),)
        return to_shaped("forces", forces, links), to_number(
            "h", h, above=_SHORTEST, below=1 / _SHORTEST
        )

    @abstractmethod
    def _guess(self, h: float) -> Reals:
        """Return the increments before the first correction."""

    @abstractmethod
    def _correct(
        self, increment: Reals, forces: Reals, h: float, iteration: int
    ) -> tuple[Reals, bool]:
        """Return a correction of increments, and whether it is the last one."""

    @abstractmethod
    def _make_step(self, forces: Reals, h: float) -> None:
        """Make a step, as `commit`."""


def end_rates(increment: Reals, h: float, v: Reals, a: Reals) -> tuple[Reals, Reals]:
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
    link_forces: list[Reals] = field(default_factory=list)
    deflection: list[float] = field(default_factory=list)
    events: list[WallEvent] = field(default_factory=list)
    u_s_max: float = 0.0
    impacts: int = 0
    energy: CouplingEnergy = field(default_factory=lambda: CouplingEnergy(0.0, 0.0, 0.0))
    iterations: int = 0
