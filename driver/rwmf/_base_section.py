"""Formulas at the base of the wall: the section on a strip without tension, and a steel fuse."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf import _library
from rwmf._arguments import checked
from rwmf._numbers import show, to_array, to_items, to_number
from rwmf.errors import InputError

__all__ = ["base_section", "ufp_force"]


def base_section(
    N: npt.ArrayLike,
    theta: npt.ArrayLike,
    *,
    width: float,
    thickness: float,
    k: float,
    E: float | None = None,
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

    Returns
    -------
    xarray.Dataset
        ``contact_length`` [m], ``toe_stress`` [Pa] and ``moment`` of the stresses about the middle
        of the base [N m]; with E also ``toe_strain`` [-]. A list gives arrays over ``state``.

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
    found = np.empty((forces.size, 3), order="F")
    _library.strip_under(width, thickness, to_number("k", k, above=0.0), forces, angles, found)
    values = {
        "contact_length": (found[:, 0], "m", "contact length of the base"),
        "toe_stress": (found[:, 1], "Pa", "compressive stress at the toe"),
        "moment": (found[:, 2], "N m", "moment of the stresses about the middle of the base"),
    }
    if E is not None:
        strain = found[:, 1] / to_number("E", E, above=0.0)
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
    """Compute the yield force of a U-shaped flexural plate.

    The fully plastic moments at both tangent points of the bend carry the force:
    F = stress width thickness^2/(2 diameter). It is ``&fuse F_y`` for one plate at each corner.

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
    values: dict[str, Any] = {
        "stress": stress, "width": width, "thickness": thickness, "diameter": diameter,
    }  # fmt: skip
    s, b, t, d = (to_number(name, value, above=0.0) for name, value in values.items())
    return s * b * t**2 / (2 * d)
