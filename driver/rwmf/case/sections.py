"""Numbers of a case from dimensions and materials: steel plates, footings, concrete, the base."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.numbers import show, to_array, to_items, to_number

__all__ = ["Footing", "Plate", "Toe", "base_section", "fatigue_cycles", "footing", "toe", "ufp"]


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
    >>> from rwmf.sections import base_section
    >>> round(float(base_section(3.07e6, 0.005, width=4, thickness=0.35, k=1e10).moment))
    5533847
    """
    is_one = to_items(N) is None and to_items(theta) is None
    forces = to_array("N", N, least=1)
    angles = np.abs(to_array("theta", theta, least=1))
    if forces.size != angles.size and 1 not in (forces.size, angles.size):
        raise InputError(f"theta = {show(theta)}: must be one number, or as many as N")
    forces, angles = (np.ascontiguousarray(item) for item in np.broadcast_arrays(forces, angles))
    strip = [_size("width", width), _size("thickness", thickness), _size("k", k)]
    strength = np.finfo(float).max if f_c is None else _size("f_c", f_c)
    found = tables.strip_under(forces, angles, *strip, strength)
    values = {
        "contact_length": (found[:, 0], "m", "contact length of the base"),
        "toe_stress": (found[:, 1], "Pa", "compressive stress at the toe"),
        "moment": (found[:, 2], "N m", "moment of the stresses about the middle of the base"),
    }
    if E is not None:
        strain = found[:, 3] / _size("E", E)
        values["toe_strain"] = (strain, "1", "compressive strain at the toe")
    section = xr.Dataset(
        {
            name: ("state", array, {"units": unit, "long_name": meaning})
            for name, (array, unit, meaning) in values.items()
        }
    )
    return section.isel(state=0) if is_one else section


class Plate(NamedTuple):
    """Strength, stiffness and life of one U-shaped flexural plate (UFP).

    Attributes
    ----------
    F_y : float
        Force at the first yield of a fibre [N].
    F_p : float
        Plastic strength [N]: `F_y` of `&fuse`, `&coupling` and `&restraint`.
    k : float
        Elastic stiffness [N/m], `k` of the same groups.
    strain : float
        Strain amplitude of the outer fibre that the bend rolls over [-].
    cycles : float
        Cycles to fracture at this amplitude [-].
    stroke : float
        Largest stroke to each side [m]; infinite without `leg`.
    """

    F_y: float
    F_p: float
    k: float
    strain: float
    cycles: float
    stroke: float


class Footing(NamedTuple):
    """Stiffness and damping of a footing on the soil.

    Attributes
    ----------
    K_z : float
        Vertical stiffness [N/m].
    K_r : float
        Rotational stiffness in the plane of the motion [N m].
    C_z : float
        Vertical radiation damping [N s/m].
    k_z, k_r : float
        Subgrade moduli that give `K_z` and `K_r` [N/m3]. `&base_section k` takes one of them:
        `k_r` where the footing rocks in full contact.
    c_z : float
        `C_z` over the area [N s/m3].
    """

    K_z: float
    K_r: float
    C_z: float
    k_z: float
    k_r: float
    c_z: float


class Toe(NamedTuple):
    """Concrete at the toe of a wall, with the keys of `&base_section`.

    Attributes
    ----------
    f_c : float
        Compressive strength, with confinement [Pa].
    E : float
        Modulus of elasticity [Pa].
    length : float
        Length of the plastic hinge over which the concrete is strained [m].
    strain : float
        Strain at the strength [-].
    """

    f_c: float
    E: float
    length: float
    strain: float


@checked
def ufp(
    width: float,
    thickness: float,
    diameter: float,
    *,
    stress: float,
    modulus: float = 200e9,
    leg: float | None = None,
) -> Plate:
    """Compute strength, stiffness and life of a U-shaped flexural plate from its dimensions.

    The plates stand between an edge of the wall and a column or a second wall. The plastic moments
    at both tangent points of the bend carry F_p = stress width thickness^2/(2 diameter). The first
    fibre yields at two thirds of it. Bending of the semicircle gives
    k = 4 modulus width (thickness/diameter)^3/(3 pi). The bend rolls over the legs: a fibre changes
    between straight and curved, and its strain by thickness/diameter.

    Parameters
    ----------
    width, thickness : float
        Dimensions of the plate's section [m].
    diameter : float
        Diameter of the bend to the middle of the plate [m].
    stress : float
        Yield stress of the steel [Pa].
    modulus : float, optional
        Modulus of elasticity of the steel [Pa].
    leg : float, optional
        Straight length between the bend and its fixing [m]. A stroke moves the bend by half.

    Returns
    -------
    Plate
        Forces, stiffness, strain amplitude, cycles and stroke.

    Raises
    ------
    InputError
        When an argument is not a number above zero.

    See Also
    --------
    fatigue_cycles : Cycles of the same steel at another amplitude.

    Notes
    -----
    Strength and rolling strain: Kelly, Skinner and Heine, Bulletin of the New Zealand Society for
    Earthquake Engineering 5 (1972). Stiffness: unit load on the semicircle with rigid ends.
    Flexible legs and fixings lower it: Baird et al. (2014) are quoted with 16/(27 pi) in place of
    4/(3 pi), which was not checked here.

    Examples
    --------
    >>> from rwmf.sections import ufp
    >>> plate = ufp(0.12, 0.01, 0.1, stress=350e6, leg=0.05)
    >>> round(plate.F_p), round(plate.k), round(plate.cycles, 1), plate.stroke
    (21000, 10185916, 18.7, 0.1)
    """
    b, t = _size("width", width), _size("thickness", thickness)
    d, s = _size("diameter", diameter), _size("stress", stress)
    force, strain = s * b * t**2 / (2 * d), t / (2 * d)
    return Plate(
        F_y=2 * force / 3,
        F_p=force,
        k=4 * _size("modulus", modulus) * b * (t / d) ** 3 / (3 * math.pi),
        strain=strain,
        cycles=fatigue_cycles(strain),
        stroke=math.inf if leg is None else 2 * _size("leg", leg),
    )


@checked
def fatigue_cycles(strain: float, *, strain_1: float = 0.191, slope: float = -0.458) -> float:
    """Compute the cycles to fracture of steel at a strain amplitude (Coffin and Manson).

    The number is (strain/strain_1)^(1/slope).

    Parameters
    ----------
    strain : float
        Strain amplitude, half of the range [-].
    strain_1 : float, optional
        Amplitude of which one cycle leads to fracture [-].
    slope : float, optional
        Slope of the logarithm of the amplitude over that of the cycles [-].

    Returns
    -------
    float
        The number of cycles [-].

    Raises
    ------
    InputError
        When an argument is not a number above zero, or `slope` not one below.

    Notes
    -----
    The defaults are those of `Fatigue` in OpenSees, from tests on European steel sections by Ballio
    and Castiglioni (1995); calibration: Uriz, dissertation, University of California, Berkeley
    (2005). Tests on the steel of a plate give better numbers.

    Examples
    --------
    >>> from rwmf.sections import fatigue_cycles
    >>> round(fatigue_cycles(0.02))
    138
    """
    ratio = _size("strain", strain) / _size("strain_1", strain_1)
    return float(ratio ** (1 / to_number("slope", slope, below=0.0)))


@checked
def footing(
    G: float, nu: float, width: float, thickness: float, density: float = 1800.0
) -> Footing:
    """Compute stiffness and damping of a rectangular footing on the surface of a halfspace.

    Parameters
    ----------
    G : float
        Shear modulus of the soil at the strain of the earthquake [Pa].
    nu : float
        Poisson's ratio of the soil [-], below 0.5.
    width, thickness : float
        Dimensions of the footing in and across the plane of the motion [m].
    density : float, optional
        Density of the soil [kg/m3], for the damping.

    Returns
    -------
    Footing
        Stiffnesses, radiation damping, and both over the area.

    Raises
    ------
    InputError
        When an argument is not acceptable.

    Notes
    -----
    Static stiffnesses of Pais and Kausel, NIST GCR 12-917-21, Table 2-2a, with the half sides
    B <= L. ASCE 41-17, Figure 8-2, has them with whole sides. Damping: Table 2-3a, with
    psi = sqrt(2 (1 - nu)/(1 - 2 nu)), at most 2.5, which is C_z = 4 psi B L sqrt(G density).

    Examples
    --------
    >>> from rwmf.sections import footing
    >>> base = footing(40e6, 0.3, width=6.0, thickness=2.0)
    >>> [f"{x:.4g}" for x in (base.K_z, base.K_r, base.k_z, base.k_r)]
    ['4.952e+08', '2.992e+09', '4.127e+07', '8.312e+07']
    """
    modulus, ratio = _size("G", G), to_number("nu", nu, above=-1.0, below=0.5)
    half, across = _size("width", width) / 2, _size("thickness", thickness) / 2
    b, l_b = min(half, across), max(half, across) / min(half, across)
    turn = 3.73 * l_b**2.4 + 0.27 if half > across else 3.2 * l_b + 0.8
    psi = min(2.5, math.sqrt(2 * (1 - ratio) / (1 - 2 * ratio)))
    area = 4 * half * across
    vertical = modulus * b * (3.1 * l_b**0.75 + 1.6) / (1 - ratio)
    rotation = modulus * b**3 * turn / (1 - ratio)
    damping = psi * area * math.sqrt(modulus * _size("density", density))
    return Footing(
        K_z=vertical,
        K_r=rotation,
        C_z=damping,
        k_z=vertical / area,
        k_r=3 * rotation / (area * half**2),
        c_z=damping / area,
    )


@checked
def toe(f_c: float, height: float, *, pressure: float = 0.0) -> Toe:
    """Compute the concrete numbers of the toe of a wall.

    Parameters
    ----------
    f_c : float
        Compressive strength of the concrete without confinement [Pa].
    height : float
        Height of the wall [m].
    pressure : float, optional
        Effective lateral pressure of hoops and ties at their yield stress [Pa].

    Returns
    -------
    Toe
        Strength, modulus, hinge length and strain; `_asdict()` without `strain` is `&base_section`.

    Raises
    ------
    InputError
        When an argument is not acceptable.

    Notes
    -----
    Modulus: ACI 318-19, 19.2.2.1(b), 4700 sqrt(f_c) in MPa. Hinge length: 0.06 of the height, ACI
    ITG-5.2. Confinement: Mander, Priestley and Park, Journal of Structural Engineering 114 (1988),
    f_cc = f_c (2.254 sqrt(1 + 7.94 r) - 2 r - 1.254) with r = pressure/f_c, and the strain
    0.002 (1 + 5 (f_cc/f_c - 1)).

    Examples
    --------
    >>> from rwmf.sections import toe
    >>> concrete = toe(40e6, 19.2, pressure=2e6)
    >>> [f"{x:.4g}" for x in concrete]
    ['5.24e+07', '2.973e+10', '1.152', '0.005101']
    """
    strength = _size("f_c", f_c)
    r = to_number("pressure", pressure, above=-math.ulp(0.0)) / strength
    ratio = 2.254 * math.sqrt(1 + 7.94 * r) - 2 * r - 1.254
    return Toe(
        f_c=ratio * strength,
        E=4700e6 * math.sqrt(strength / 1e6),
        length=0.06 * _size("height", height),
        strain=0.002 * (1 + 5 * (ratio - 1)),
    )


def _size(name: str, value: float) -> float:
    """Return a checked number above zero."""
    return to_number(name, value, above=0.0)
