"""Results of a coupling."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from rwmf._hosts.states import WallEvent
from rwmf.coupling.host import Reals

__all__ = ["CoupledRun", "CouplingEnergy"]


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
