"""Numbers of a computation with CalculiX: none of them belongs to the structure."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SUPPORTS", "THICKNESS", "Settings"]

THICKNESS = 0.2  # of the wall [m]
SUPPORTS = ("nodes", "faces", "struts")


@dataclass(frozen=True)
class Settings:
    """Settings of a computation.

    Attributes
    ----------
    support : str
        Support of the wall. ``nodes``: contact of the nodes of its base with the face of the
        foundation. ``faces``: contact of the faces of its base with that face. ``struts``: struts
        under the corners, which carry compression only.
    nx, nz : int
        Elements over the width and over the height of the wall.
    dt, dt_min : float
        Largest and smallest time step [s].
    stored_interval : float
        Interval of the stored history [s].
    modulus : float
        Young's modulus of the wall [N/m2].
    alpha : float
        Numerical damping of the integration by Hilber, Hughes and Taylor [-].
    friction : float
        Coefficient of friction of wall and foundation [-]; struts do not slide.
    stiffness : float
        Pressure of the contact over its overclosure [N/m3].
    damping : float
        Pressure of the contact over the velocity of closing, for ``nodes`` [N s/m3]. The impedance
        of the paper's foundation, the square root of 300 GPa times 2400 kg/m3, is 2.7e7: radiated
        energy of an impact does not return.
    stick : float
        Shear of the contact over the displacement before it slides [N/m3].
    tension : float
        Pull that the smoothed law of ``nodes`` may exert at most [N/m2].
    gap : float
        Largest clearance at which contact is checked [m].
    hollow : float
        Height of the base between the corners; 0 for a flat one [m].
    strut_stiffness : float
        Of each of the eight struts, in compression [N/m].
    """

    support: str = "nodes"
    nx: int = 4
    nz: int = 8
    dt: float = 5e-4
    dt_min: float = 1e-4
    stored_interval: float = 1e-3
    modulus: float = 30e9
    alpha: float = -0.05
    friction: float = 0.35
    stiffness: float = 1e11
    damping: float = 3e7
    stick: float = 1e11
    tension: float = 1e3
    gap: float = 1e-5
    hollow: float = 0.0
    strut_stiffness: float = 1e10
