"""Masses, springs and motions of a case in SI units, for programs with finite elements."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from rwmf.case import Case
from rwmf.case.elements import elements_of, height_of_frame
from rwmf.errors import InputError
from rwmf.kernel.numbers import Array
from rwmf.run.simulation import simulate

# interval at which a record is read, before samples on straight lines are left out [s]
_STEP = 1e-3
# masses of the cantilever whose first frequency the damping needs
_MASSES = 200


@dataclass(frozen=True)
class Law:
    """Force over the displacement of a spring.

    Attributes
    ----------
    k : float
        Elastic stiffness [N/m].
    force_y : float
        Force at first yield [N]; infinite for an elastic spring.
    values : dict
        Other keys of the group, ``law`` included; of an elastic spring none.
    """

    k: float
    force_y: float = math.inf
    values: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Frame:
    """A frame of one mass or of storeys, from the ground up.

    Attributes
    ----------
    coupling : str
        ``single``, or the coupling of `&storeys`.
    m, height, share : numpy.ndarray, shape (n,)
        Masses [kg], heights of the storeys [m], displacements of the floors over those of the
        masses [-].
    push : numpy.ndarray, shape (n,)
        Masses with which the ground pushes [kg]; they differ from `m` for a first mode alone.
    laws : list of Law
        Springs of the storeys.
    c : numpy.ndarray, shape (n, n)
        Damping between the masses and the ground [N s/m].
    lean : numpy.ndarray, shape (n,)
        Stiffness that gravity takes from each storey [N/m].
    k_link : numpy.ndarray, shape (n,) or (0,)
        Stiffness of the links to the wall [N/m]; empty for rigid links.
    floors : int
        Number of floors; of a first mode alone more than the number of masses.
    floor_heights : numpy.ndarray, shape (floors,)
        Heights of all storeys [m].
    """

    coupling: str
    m: Array
    height: Array
    share: Array
    push: Array
    laws: list[Law]
    c: Array
    lean: Array
    floor_heights: Array
    k_link: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def floors(self) -> int:
        """Number of floors."""
        return int(self.floor_heights.size)


@dataclass(frozen=True)
class Tendon:
    """A tendon.

    Attributes
    ----------
    offset, height : float
        Distance from the axis, and height of the upper anchor [m].
    is_straight : bool
        True for the length of a straight cable, False for Eq. (1).
    k : float
        Stiffness over its elongation [N/m].
    force, force_y : float
        Forces at rest and at first yield [N].
    hardening : float
        Stiffness after yielding over the elastic one [-].
    elongation_at_rupture : float
        Elongation beyond that at rest at which it breaks [m].
    """

    offset: float
    height: float
    is_straight: bool
    k: float
    force: float
    force_y: float
    hardening: float
    elongation_at_rupture: float


@dataclass(frozen=True)
class BentWall:
    """Stiffness and damping of a wall that bends.

    Attributes
    ----------
    stiffness : float
        Bending stiffness EI [N m2].
    shear_stiffness : float
        Shear stiffness kappa G A [N]; infinite without shear deformation.
    delay : float
        Damping over stiffness [s].
    """

    stiffness: float
    shear_stiffness: float
    delay: float


@dataclass(frozen=True)
class Device:
    """Spring and dashpot on the rise of a point of a wall, or between the edges of two walls.

    Attributes
    ----------
    law : Law or None
        The spring.
    c, exponent : float
        Constant [N s/m] or [N (s/m)^a], and the exponent a of the dashpot.
    offset, height : float
        Place of the point [m].
    is_restraint : bool
        Whether it stands beside one of the walls, not at each.
    """

    law: Law | None
    c: float = 0.0
    exponent: float = 1.0
    offset: float = 0.0
    height: float = 0.0
    is_restraint: bool = False


@dataclass(frozen=True)
class Base:
    """Strip of springs without tension under the wall.

    Attributes
    ----------
    k : float
        Stiffness over its length [N/m2].
    delay : float
        Damping over stiffness [s].
    """

    k: float
    delay: float


class Building:
    """A case in SI units.

    Attributes
    ----------
    h, b, m_w : float
        Half height [m], half width [m], mass of the wall [kg]; zero without wall.
    walls : int
        Number of equal walls side by side.
    coupling : Device or None
        Their couplings.
    spacing : float
        Distance of the axes of two walls [m].
    g : float
        Gravity [m/s2].
    is_pinned : bool
        Whether the wall is hinged.
    base : Base or None
        The strip under the wall; None for rigid corners.
    bent : BentWall or None
        Stiffness of a wall that bends; None for a rigid wall.
    link : float
        Length of the link [m]; infinite when absent.
    frame : Frame or None
        The frame.
    tendons : list of Tendon
        The tendons of each wall.
    devices : list of Device
        Fuses, dampers and restraints.
    theta, theta_dot : float
        Rotation [rad] and angular velocity [rad/s] at the start.
    dt : float
        Interval of the samples [s].
    a, a_v : numpy.ndarray, shape (n,)
        Horizontal and vertical ground acceleration [m/s2]; the latter may be empty.
    t_end : float
        End [s].
    """

    def __init__(self, case: Case) -> None:
        _refuse(case)
        wall, initial, coupling = case.wall, case.initial, case.coupling
        self.g = g = case.model.g
        self.m_w = m_w = 0.0 if wall is None else _number(wall.get("m_w")) or 1.0
        self.h, self.b = (0.0, 0.0) if wall is None else (wall.h, wall.b)
        self.walls = 1 if wall is None else wall.walls
        self.coupling: Device | None = None
        if coupling is not None:
            self.coupling = _device(elements_of(coupling, 0.0)[0], m_w, g)
        self.spacing = 2 * self.b + (0.0 if coupling is None else coupling.span)
        self.is_pinned = wall is not None and wall.base == "pinned"
        self.base = None if case.base is None else _base(case, m_w)
        self.bent = None if case.bending is None else _bent_wall(case, m_w)
        self.link = math.inf if case.link is None else case.link.L
        self.frame = None if case.frame is None else _frame(case, m_w)
        self.tendons = [] if case.cable is None else _tendons(case, m_w * g)
        self.devices = _devices(case, m_w)
        self.theta, self.theta_dot = 0.0, 0.0
        if initial is not None:
            self.theta = initial.theta_over_alpha * self.alpha
            self.theta_dot = initial.theta_dot
        self.dt, self.a, self.a_v, self.t_end = _motions(case)

    @property
    def alpha(self) -> float:
        """Slenderness of the wall [rad]."""
        return math.atan2(self.b, self.h)


_LAWS = ("elastic_plastic", "flag", "peak_oriented", "pinched")
_EXPORTED = {
    "wall", "frame", "storeys", "yielding", "fuse", "damper", "nl_damper", "cable", "p_delta",
    "link", "vertical", "initial", "impact", "motion", "model", "solver", "output", "bending",
    "coupling", "restraint", "base",
}  # fmt: skip


def _refuse(case: Case) -> None:
    """Stop at the first group that the finite elements lack."""

    def stop(group: str, why: str) -> None:
        raise InputError(f"{case.label}: &{group}: OpenSees lacks {why}")

    for key in ("mu", "d_y"):
        if case.base is not None and key in case.base:
            stop("base", f"{key} in this export: an elastic base that does not slide only")
    if case.inerter is not None:
        stop("inerter", "an inerter; leave the group out")
    for name in ("yielding", "fuse", "coupling", "restraint"):
        group = getattr(case, name)
        if group is not None and group.law not in _LAWS:
            stop(name, f"law = '{group.law}'; it has {', '.join(_LAWS)}")
    rocks = case.wall is not None and case.wall.base == "rocking" and case.base is None
    if rocks and case.impact.rule not in ("coupled", "housner"):
        stop("impact", f"rule = '{case.impact.rule}'; its impacts follow rule = 'coupled'")
    if rocks and case.impact.rule == "housner" and case.frame is not None:
        stop("impact", "rule = 'housner' beside a frame; its impacts follow rule = 'coupled'")
    if case.wall is not None and case.model.formulation != "exact":
        stop("model", f"formulation = '{case.model.formulation}'; use 'exact'")
    if case.initial is not None and case.frame is not None:
        stop("initial", "a rotated start of a wall with a frame in this export")
    if case.bending is not None and case.bending.damping == "modal":
        stop("bending", "damping = 'modal' of a wall by itself; use 'stiffness'")
    if case.bending is not None and case.bending.xi_of == "rocking":
        stop("bending", "xi_of = 'rocking'; use 'cantilever'")
    for name in sorted(set(case.groups) - _EXPORTED):
        stop(name, "a counterpart in this export; leave the group out")


def _devices(case: Case, m_w: float) -> list[Device]:
    """Return fuses, dampers and restraints; `m_w` scales the ratios."""
    b = 0.0 if case.wall is None else case.wall.b
    groups = (case.fuse, case.damper, case.nl_damper, case.restraint)
    return [
        _device(item, m_w, case.model.g, is_restraint=group is case.restraint)
        for group in groups
        if group is not None
        for item in elements_of(group, -b, b)
    ]


def _device(item: dict[str, Any], m_w: float, g: float, *, is_restraint: bool = False) -> Device:
    """Return a device from the values of an element."""
    law = None
    if "eta_y" in item:
        force = item["eta_y"] * m_w * g
        law = Law(force / item["stroke_y"], force, item)
    elif "k_over_m_w" in item:
        law = Law(item["k_over_m_w"] * m_w)
    return Device(
        law=law,
        c=item["eta_1"] * m_w * g if "eta_1" in item else item.get("c_over_m_w", 0.0) * m_w,
        exponent=item.get("exponent", 1.0),
        offset=item["offset"],
        height=item.get("height", 0.0),
        is_restraint=is_restraint,
    )


def _base(case: Case, m_w: float) -> Base:
    """Return the strip under the wall; `m_w` scales the ratios."""
    base = case.base
    stiffness = base.k_t_over_m_w
    delay = 2 * base.xi / math.sqrt(2 * case.wall.b * stiffness)
    if "delay" in base:
        delay = base.delay
    return Base(stiffness * m_w, delay)


def _bent_wall(case: Case, m_w: float) -> BentWall:
    """Return stiffness and damping of the wall; `m_w` scales the ratios."""
    bending, h, b = case.bending, case.wall.h, case.wall.b
    stiffness = bending.EI_over_m_w * m_w
    shear = math.inf
    if bending.get("nu") is not None:
        shear = 1.25 * stiffness / ((1 + bending.nu) * b**2 * bending.cracking)
    # lumped masses on the flexibility of the cantilever
    z = (np.arange(_MASSES) + 0.5) / _MASSES * 2 * h
    low, high = np.minimum(z, z[:, None]), np.maximum(z, z[:, None])
    flexibility = low**2 * (3 * high - low) / (6 * stiffness) + low / shear
    omega = math.sqrt(_MASSES / (m_w * float(np.linalg.eigvalsh(flexibility)[-1])))
    return BentWall(stiffness, shear, 2 * bending.xi / omega)


def _frame(case: Case, m_w: float) -> Frame:
    """Return the frame; `m_w` scales the ratios."""
    frame, storeys, p_delta = case.frame, case.storeys, case.p_delta
    weight = 0.0 if p_delta is None else p_delta.m_g_over_m_s * case.model.g
    if storeys is None:
        mass = frame.gamma * m_w if m_w else _number(frame.get("m_s")) or 1.0
        omega = 2 * math.pi / frame.T_s
        height = height_of_frame(case) or 1.0
        heights = np.array([height])
        lean = mass * weight / height
        return _of_one_mass(case, "single", mass, omega, np.ones(1), mass, lean, heights)
    unit = m_w or 1.0
    if not m_w and "m_over_m_w" in storeys.in_si:
        masses = cast("tuple[float, ...]", storeys.in_si["m_over_m_w"][0])
        unit = masses[0] / storeys.m_over_m_w[0]
    return _storeys(case, unit, weight)


def _storeys(case: Case, unit: float, weight: float) -> Frame:
    """Return the frame of storeys; `unit` is the mass of ratio 1."""
    storeys, xi = case.storeys, case.frame.xi_s
    m, k = (np.array(storeys[x]) * unit for x in ("m_over_m_w", "k_over_m_w"))
    heights = np.array(storeys.height)
    n = m.size
    drift = np.eye(n) - np.eye(n, k=-1)
    stiff = drift.T @ np.diag(k) @ drift
    lean = weight * np.cumsum(m[::-1])[::-1] / heights
    root = np.sqrt(m)
    squares, modes = np.linalg.eigh(stiff / np.outer(root, root))
    momentum = root[:, None] * modes
    c = momentum @ np.diag(2 * xi * np.sqrt(squares)) @ momentum.T
    if storeys.coupling == "reduced":
        share = modes[:, 0] / root
        share /= share[-1]
        mass = float(m @ share**2)
        leaning = float(share @ drift.T @ np.diag(lean) @ drift @ share)
        omega, push = math.sqrt(squares[0]), float(m @ share)
        return _of_one_mass(case, "reduced", mass, omega, share, push, leaning, heights)
    if storeys.coupling == "every_floor" and case.wall is not None:
        line = np.cumsum(heights) / heights.sum()
        c = 2 * xi / math.sqrt(line @ stiff @ line / (m @ line**2)) * stiff
    yields = None if case.yielding is None else np.broadcast_to(case.yielding.storey_u_y, n)
    k_link = np.zeros(0)
    if storeys.coupling == "springs" and case.wall is not None:
        k_link = np.broadcast_to(storeys.k_link_over_m_w, n) * unit
    return Frame(
        coupling=storeys.coupling,
        m=m,
        height=heights,
        share=np.ones(n),
        push=m,
        laws=[
            _law(case, float(k[i]), None if yields is None else float(yields[i])) for i in range(n)
        ],
        c=c,
        lean=lean,
        floor_heights=heights,
        k_link=k_link,
    )


def _of_one_mass(
    case: Case,
    coupling: str,
    mass: float,
    omega: float,
    share: Array,
    push: float,
    lean: float,
    heights: Array,
) -> Frame:
    """Describe a frame that one displacement moves."""
    u_y = None if case.yielding is None else _number(case.yielding.get("u_y")) or None
    return Frame(
        coupling=coupling,
        m=np.array([mass]),
        height=np.array([heights.sum()]),
        share=share,
        push=np.array([push]),
        laws=[_law(case, mass * omega**2, u_y)],
        c=np.array([[2 * case.frame.xi_s * omega * mass]]),
        lean=np.array([lean]),
        floor_heights=heights,
    )


def _number(value: object) -> float:
    """Return a number of the case; 0 for a key that it does not give."""
    return 0.0 if value is None else float(cast("float", value))


def _law(case: Case, k: float, u_y: float | None) -> Law:
    if case.yielding is None or u_y is None:
        return Law(k)
    return Law(k, k * u_y, dict(case.yielding))


def _tendons(case: Case, weight: float) -> list[Tendon]:
    """Return the tendons; `weight` is that of the wall."""
    h, b = case.wall.h, case.wall.b
    alpha, found = math.atan2(b, h), []
    for item in elements_of(case.cable, 0.0):
        height, first = item.get("height", 2 * h), item["eta_0"] * weight
        is_straight = item["law"] == "truss"
        end = b * alpha
        if is_straight:
            # on the axis, about a corner, the anchor rises and moves sideways
            rise = height * math.cos(alpha) + b * math.sin(alpha)
            aside = b * (1 - math.cos(alpha)) + height * math.sin(alpha)
            end = math.hypot(aside, rise) - height
        k = (item.get("eta_alpha", item["eta_0"]) - item["eta_0"]) * weight / end
        rupture = math.inf
        if "rupture_strain" in item:
            length = item.get("length") or height
            rupture = item["rupture_strain"] * length - (first / k if k > 0 else 0.0)
        found.append(
            Tendon(
                offset=item["offset"],
                height=height,
                is_straight=is_straight,
                k=k,
                force=first,
                force_y=item["eta_y"] * weight if "eta_y" in item else math.inf,
                hardening=item["hardening"],
                elongation_at_rupture=rupture,
            )
        )
    return found


def _motions(case: Case) -> tuple[float, Array, Array, float]:
    """Return interval [s], both ground accelerations [m/s2] and the end [s]."""
    motion, vertical = case.motion, case.vertical
    t_end = _number(case.solver.get("t_end")) or case.kernel.end_of_motion()
    if motion.kind == "none":
        return t_end, np.zeros(2), np.zeros(0), t_end
    step = _STEP if motion.kind == "record" else _STEP / 4
    a = _sampled(case, {}, step, t_end)
    a_v = np.zeros(0)
    if vertical is not None and vertical.get("ratio") is not None:
        a_v = vertical.ratio * a
    elif vertical is not None:
        given: dict[str, Any] = dict(vertical.as_given()) | {"kind": "record"}
        if "vertical" in case.motions:
            given["file"] = case.motions["vertical"]
        a_v = _sampled(case, given, step, t_end)
    stride = _widest_stride(a, a_v)
    a, a_v = _without_end(a[::stride]), _without_end(a_v[::stride])
    return stride * step, a, a_v, t_end


def _sampled(case: Case, motion: dict[str, Any], step: float, t_end: float) -> Array:
    """Return a ground acceleration at equal steps, by the history of an oscillator [m/s2]."""
    groups: dict[str, Any] = dict.fromkeys({*case.groups, "output"} - {"motion"})
    frame = dict.fromkeys(case.frame.as_given() if case.frame is not None else ())
    groups |= {"solver": {"t_end": t_end}, "model": {"g": case.model.g}}
    groups["frame"] = frame | {"T_s": 1.0, "xi_s": 0.05}
    if motion:
        groups["motion"] = dict.fromkeys(case.motion.as_given()) | motion
    history = simulate(case.replace(**groups), dt=step)
    return np.asarray(np.nan_to_num(history["u_g_ddot"].to_numpy()))


def _widest_stride(*motions: Array) -> int:
    """Return the largest stride of samples between which all motions are straight."""
    strides = (200, 100, 50, 40, 25, 20, 10, 8, 5, 4, 2, 1)
    return next(x for x in strides if all(_is_straight(a, x) for a in motions if a.size))


def _is_straight(a: Array, stride: int) -> bool:
    at = np.arange(a.size)
    last = (a.size - 1) // stride * stride
    between = np.interp(at[: last + 1], at[: last + 1 : stride], a[: last + 1 : stride])
    return bool(np.abs(between - a[: last + 1]).max() <= 1e-9 * np.abs(a).max())


def _without_end(a: Array) -> Array:
    """Return a motion up to its last value, and a zero."""
    if not a.any():
        return np.zeros(2) if a.size else a
    return np.append(a[: int(np.flatnonzero(a)[-1]) + 1], 0.0)
