"""Formulas at the base of the wall: the section on a strip without tension, and steel fuses."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf import _library
from rwmf._arguments import checked
from rwmf._numbers import show, to_array, to_items, to_number
from rwmf.errors import InputError


def base_section(
    N: npt.ArrayLike,
    theta: npt.ArrayLike,
    *,
    width: float,
    thickness: float,
    k: float,
    E: float | None = None,
    f_c: float | None = None,
) -> xr.Dataset:
    """Compute contact, stress and moment of a base on a strip of springs without tension.

    The kernel uses the same formulas for ``&base_section``.

    Parameters
    ----------
    N : float or sequence of float
        Compressive normal force [N].
    theta : float or sequence of float
        Rotation of the base [rad]; one number, or as many as forces.
    width, thickness : float
        Dimensions of the base in and across the plane of the motion [m].
    k : float
        Subgrade modulus: stress per settlement of the strip [N/m3].
    E : float, optional
        Modulus of elasticity of the strip [Pa], for the strain.
    f_c : float, optional
        Compressive strength: the largest stress of the strip [Pa].

    Returns
    -------
    xarray.Dataset
        ``contact_length`` [m], ``toe_stress`` [Pa] and ``moment`` of the stresses about the middle
        of the base [N m]. With E also ``toe_strain`` [-], k times the settlement of the toe over
        E. Stress over E is the strain of concrete up to about 0.6 f_c. A list gives arrays over
        ``state``.

    Raises
    ------
    InputError
        When an argument is not acceptable.

    Examples
    --------
    >>> round(float(base_section(3.07e6, 0.005, width=4, thickness=0.35, k=1e10).moment))
    5533847
    """
    is_one = to_items(N) is None and to_items(theta) is None
    forces = to_array("N", [N] if to_items(N) is None else N, least=1)
    angles = np.abs(to_array("theta", [theta] if to_items(theta) is None else theta, least=1))
    if forces.size != angles.size and 1 not in (forces.size, angles.size):
        raise InputError(f"theta = {show(theta)}: must be one number, or as many as N")
    forces, angles = (np.ascontiguousarray(item) for item in np.broadcast_arrays(forces, angles))
    width = to_number("width", width, above=0.0)
    thickness = to_number("thickness", thickness, above=0.0)
    found = np.empty((forces.size, 4), order="F")
    strength = np.finfo(float).max if f_c is None else to_number("f_c", f_c, above=0.0)
    k = to_number("k", k, above=0.0)
    _library.strip_under(width, thickness, k, strength, forces, angles, found)
    values = {
        "contact_length": (found[:, 0], "m", "contact length of the base"),
        "toe_stress": (found[:, 1], "Pa", "compressive stress at the toe"),
        "moment": (found[:, 2], "N m", "moment of the stresses about the middle of the base"),
    }
    if E is not None:
        strain = found[:, 3] / to_number("E", E, above=0.0)
        values["toe_strain"] = (strain, "1", "compressive strain at the toe")
    section = xr.Dataset(
        {
            name: ("state", array, {"units": unit, "long_name": meaning})
            for name, (array, unit, meaning) in values.items()
        }
    )
    return section.isel(state=0) if is_one else section


@checked
def ufp_force(stress: float, width: float, thickness: float, diameter: float) -> float:
    """Compute the plastic strength of a U-shaped flexural plate.

    The plastic moments at both tangent points of the bend carry the force
    F = stress width thickness^2/(2 diameter). The first fibre yields at two thirds of it. The
    plates stand between an edge of the wall and a column or a second wall. It is ``&fuse F_y`` for
    one plate at each edge.

    Parameters
    ----------
    stress : float
        Yield stress of the steel [Pa].
    width, thickness : float
        Dimensions of the plate's section [m].
    diameter : float
        Diameter of the bend to the middle of the plate [m].

    Returns
    -------
    float
        The force [N].

    Raises
    ------
    InputError
        When an argument is not a number above zero.

    Examples
    --------
    >>> round(ufp_force(350e6, 0.12, 0.01, 0.1), 6)
    21000.0
    """
    s, b, t, d = _sizes(stress=stress, width=width, thickness=thickness, diameter=diameter)
    return s * b * t**2 / (2 * d)


@checked
def ufp_stiffness(modulus: float, width: float, thickness: float, diameter: float) -> float:
    """Compute the elastic stiffness of a U-shaped flexural plate, ``&fuse k`` of one plate.

    Bending of the semicircle gives 4 modulus width (thickness/diameter)^3/(3 pi).

    Parameters
    ----------
    modulus : float
        Modulus of elasticity of the steel [Pa].
    width, thickness : float
        Dimensions of the plate's section [m].
    diameter : float
        Diameter of the bend to the middle of the plate [m].

    Returns
    -------
    float
        Force per displacement along the legs [N/m].

    Raises
    ------
    InputError
        When an argument is not a number above zero.

    Examples
    --------
    >>> round(ufp_stiffness(200e9, 0.12, 0.01, 0.1))
    10185916
    """
    e, b, t, d = _sizes(modulus=modulus, width=width, thickness=thickness, diameter=diameter)
    return 4 * e * b * (t / d) ** 3 / (3 * np.pi)


def _sizes(**values: float) -> list[float]:
    """Return the checked values of a plate."""
    return [to_number(name, value, above=0.0) for name, value in values.items()]
