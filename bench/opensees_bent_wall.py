"""The building with a wall that bends: OpenSees beside rwmf, and the page of it.

``python bench/opensees_bent_wall.py [NAME ...]`` computes variants of
``validation/six_storeys_wall.nml`` in OpenSees, and stores them in ``validation/opensees``:
``bent_wall_peaks.csv`` and ``bent_wall_NAME.csv``. It needs ``pip install '.[opensees]'``.
``bench/bent_wall_page.py`` writes the page from the stored peaks.

The wall is a chain of corotational beams with lumped masses on a rigid base. Each end of the base
is on a spring without tension (ENT), on a pad of spring and dashpot. A key holds the middle of the
base sideways. The tendon is a truss to the top of a stiff mast that turns with the base. Like that
of a tendon in a duct, its force does not bend the wall. Floors are masses with springs and dashpots
between them; links are springs, or rigid.
"""

import csv
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import openseespy.opensees as ops
from bent_wall_page import LINK, MODULUS, MOTIONS, NU, OWN, PEAKS, XI, read_peaks
from common import ROOT
from engines import Array, case_of, store_cases
from opensees_cases import (
    AVERAGE_ACCELERATION,
    advance,
    begin,
    constant_load,
    shake,
    solver,
    version,
)
from reproduce.engines import write

from bending_parts import Frame, Shapes  # isort: skip

G = 9.81
VARIANTS: dict[str, dict[str, Any]] = {
    "rigid": {"is_rigid": True},
    "bent": {},
    "springs": {"link": LINK},
    "shear": {"nu": NU},
    "shear_springs": {"nu": NU, "link": LINK},
}
STORED = (
    "theta_rad",
    "tip_deflection_m",
    "storey_1_drift",
    "storey_6_drift",
    "floor_2_acceleration_g",
    "floor_6_acceleration_g",
    "link_6_force_N",
    "wall_moment_base_N_m",
    "wall_moment_2_N_m",
)
# nodes: ground, its corners, corners of the base, pads, top of the mast; axis of the wall from
# AXIS up, floors from FLOOR + 1 up
GROUND, GROUND_LEFT, GROUND_RIGHT = 1, 2, 3
LEFT, RIGHT, PAD_LEFT, PAD_RIGHT, MAST = 4, 5, 6, 7, 8
FLOOR, AXIS = 20, 100
# materials
NO_TENSION, PAD, TENDON, STRESSED = 1, 2, 3, 4
STOREY, DASHPOT, SPRING = 20, 100, 60
SIDES = ((LEFT, PAD_LEFT, GROUND_LEFT, -1.0), (RIGHT, PAD_RIGHT, GROUND_RIGHT, 1.0))


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation: none of them belongs to the structure.

    Attributes
    ----------
    elements : int
        Number of beams over the height of the wall.
    stiffness : float
        Stiffness of the pad under each corner [N/m].
    contact_ratio : float
        Stiffness of the spring without tension over that of its pad [-].
    damping_ratio : float
        Of the rigid wall that moves vertically on both its pads [-].
    axial_ratio : float
        Axial stiffness of the wall over that of its section [-].
    rigid_beta : float
        Damping of the beams of a rigid wall over their stiffness [s].
    blow, rigid_blow : float
        Time after a landing in which the forces of the wall, or all demands of a rigid one, do not
        count [s].
    landed : float
        Rotation below which both corners are down [rad].
    turn_interval : float
        Interval of the mean angular acceleration [s].
    dt : float
        Time step [s].
    integrator : tuple
        Integrator of OpenSees and its parameters.
    stored_interval : float
        Interval of the stored history [s].
    stored : tuple of str
        Columns of the stored history.
    """

    elements: int = 24
    stiffness: float = 1e12
    contact_ratio: float = 10.0
    damping_ratio: float = 1.0
    axial_ratio: float = 1e3
    rigid_beta: float = 1e-4
    blow: float = 1e-3
    rigid_blow: float = 25e-3
    landed: float = 4e-6
    turn_interval: float = 1e-3
    dt: float = 5e-5
    integrator: tuple[str | float, ...] = AVERAGE_ACCELERATION
    stored_interval: float = 0.02
    stored: tuple[str, ...] = STORED


class Motion(NamedTuple):
    """Ground motion: interval [s] and accelerations [m/s2], and the end of the computation [s]."""

    dt: float
    a: Array
    t_end: float


def ground(name: str) -> Motion:
    """Return El Centro times two, or a sine of 0.6 g, 1 s."""
    if name == "elcentro":
        file = ROOT / "inputs" / "records" / "elcentro.csv"
        a = 2 * G * np.loadtxt(file, delimiter=",", skiprows=5, usecols=1)
        return Motion(0.02, a, MOTIONS[name])
    t = np.arange(1001) * 1e-3
    return Motion(1e-3, np.append(0.6 * G * np.sin(2 * math.pi * t), [0.0, 0.0]), MOTIONS[name])


class Building:
    """A building in OpenSees; forces on sections and demands of each step.

    Forces on sections are those of the beams, with the inertia of half a beam up to its end. The
    rigid wall has all its mass in the middle; its forces follow from the motion and the links.
    """

    def __init__(
        self, engine: Engine, *, is_rigid: bool = False, link: float | None = None,
        nu: float | None = None,
    ) -> None:  # fmt: skip
        case = case_of("six_storeys_wall")
        self.engine, self.case, self.is_rigid, self.link, self.nu = engine, case, is_rigid, link, nu
        self.n, self.m_w, self.b = engine.elements, case.wall.m_w, case.wall.b
        self.height = 2 * case.wall.h
        self.width = self.m_w * self.b**2 / 3  # moment of inertia of the width
        storeys = case.storeys
        self.heights = np.array(storeys.height)
        self.floors = range(1, self.heights.size + 1)
        self.m, self.k = (np.array(storeys[key]) * self.m_w for key in ("m_over_m_w", "k_over_m_w"))
        self.c = Frame(self._groups(), self.height, G).damping * self.m_w
        # numbers of the nodes of the wall at the floors
        self.at = np.rint(np.cumsum(self.heights) / self.height * self.n).astype(int)
        self.motion: Motion
        self._build_wall()
        self._build_corners()
        self._build_tendon()
        self._build_frame()
        self._load()

    def _groups(self) -> dict[str, dict[str, Any]]:
        """Return the groups of the building without bending, for its matrix of damping."""
        case = self.case
        storeys = {x: list(case.storeys[x]) for x in ("m_over_m_w", "k_over_m_w", "height")}
        storeys |= {"coupling": "every_floor"}
        if self.link is not None:
            storeys |= {"coupling": "springs", "k_link_over_m_w": self.link / self.m_w}
        return {
            "wall": {"h": case.wall.h, "b": self.b, "m_w": self.m_w},
            "frame": {"xi_s": case.frame.xi_s},
            "storeys": storeys,
            "cable": {x: case.cable[x] for x in ("eta_0", "eta_alpha", "law")},
            "impact": {"rule": "coupled"},
        }

    def _lumps(self) -> Array:
        """Return the masses of the nodes: of a rigid wall the one in the middle."""
        if self.is_rigid:
            return self.m_w * (np.arange(self.n + 1) == self.n // 2)
        return self.m_w / self.n * np.array([0.5, *[1.0] * (self.n - 1), 0.5])

    def _build_wall(self) -> None:
        """Chain of beams on a stiff base."""
        engine, wall, n = self.engine, self.case.wall, self.n
        begin(3)
        ops.geomTransf("Corotational", 1)
        ops.node(GROUND, 0.0, 0.0)
        ops.fix(GROUND, 1, 1, 1)
        for i, lump in enumerate(self._lumps()):
            ops.node(AXIS + i, 0.0, i * self.height / n)
            if lump:
                turning = lump * wall.h**2 / 3 + self.width if self.is_rigid else 0.0
                ops.mass(AXIS + i, lump, lump, turning if i else self.width)
        ops.fix(AXIS, 1, 0, 0)
        area, inertia = 2 * wall.b * wall.thickness, wall.thickness * (2 * wall.b) ** 3 / 12
        shear = 0.0 if self.nu is None else (1 + self.nu) * wall.b**2 / (5 * wall.h**2)
        square = Shapes(1, self.height, shear).squares[0]
        omega = math.sqrt(square * MODULUS * inertia / self.m_w / self.height**3)
        ops.damping("SecStif", 1, engine.rigid_beta if self.is_rigid else 2 * XI / omega)
        stiff = engine.axial_ratio * area
        kind, shape = "elasticBeamColumn", (stiff, MODULUS, inertia)
        if self.is_rigid:
            # as stiff as the base
            shape = (100.0, engine.stiffness * self.height, 1e4)
        elif self.nu is not None:
            sheared = (MODULUS / 2 / (1 + self.nu), 5 / 6 * area / stiff)
            ops.section("Elastic", 1, MODULUS, stiff, inertia, *sheared)
            ops.beamIntegration("Lobatto", 1, 1, 3)
            kind, shape = "forceBeamColumn", ()
        for i in range(AXIS, AXIS + n):
            last = (1, 1) if kind == "forceBeamColumn" else (1,)
            ops.element(kind, i, i, i + 1, *shape, *last, "-damp", 1)

    def _build_corners(self) -> None:
        """No-tension springs on pads with the dashpot of a plastic impact."""
        k, b = self.engine.stiffness, self.b
        tight = k * self.engine.contact_ratio
        delay = 2 * self.engine.damping_ratio / math.sqrt(2 * k / self.m_w)
        ops.uniaxialMaterial("ENT", NO_TENSION, tight)
        ops.uniaxialMaterial("Elastic", PAD, k, k * delay)
        for corner, pad, below, side in SIDES:
            for node, fixed in ((corner, (0, 0, 0)), (below, (1, 1, 1)), (pad, (1, 0, 1))):
                ops.node(node, side * b, 0.0)
                ops.fix(node, *fixed)
            ops.element("elasticBeamColumn", 10 + corner, AXIS, corner, b, tight * b, b, 1)
            ops.element("zeroLength", 20 + corner, below, pad, "-mat", PAD, "-dir", 2)
            ops.element("zeroLength", 30 + corner, pad, corner, "-mat", NO_TENSION, "-dir", 2)

    def _build_tendon(self) -> None:
        """Tendon from the ground to the top of a mast that turns with the base."""
        cable, height = self.case.cable, self.height
        k = cable.strands * cable.strand_area * cable.modulus / cable.length
        force = cable.strands * cable.strand_area * cable.initial_stress
        stiff = (100.0, self.engine.stiffness * height, 1e4)
        ops.node(MAST, 0.0, height)
        ops.element("elasticBeamColumn", 41, AXIS, MAST, *stiff, 1)
        ops.uniaxialMaterial("Elastic", TENDON, k * height)
        ops.uniaxialMaterial("InitStressMaterial", STRESSED, TENDON, force)
        ops.element("corotTruss", 42, GROUND, MAST, 1.0, STRESSED)

    def _build_frame(self) -> None:
        """Floors beside the nodes of the wall at their heights."""
        for i, z, m, k, at in zip(self.floors, np.cumsum(self.heights), self.m, self.k, self.at,
                                  strict=True):  # fmt: skip
            ops.node(FLOOR + i, 0.0, float(z))
            ops.fix(FLOOR + i, 0, 1, 1)
            ops.mass(FLOOR + i, m, 0.0, 0.0)
            ops.uniaxialMaterial("Elastic", STOREY + i, k)
            below = FLOOR + i - 1 if i > 1 else GROUND
            ops.element("twoNodeLink", 50 + i, below, FLOOR + i, "-mat", STOREY + i, "-dir", 2)
            node = int(AXIS + at)
            if self.link is None:
                ops.equalDOF(node, FLOOR + i, 1)
            else:
                ops.uniaxialMaterial("Elastic", SPRING + i, self.link)
                ops.element("zeroLength", 60 + i, node, FLOOR + i, "-mat", SPRING + i, "-dir", 1)
        # dashpots between all pairs of floors and to the ground, for the matrix of damping
        values = [(i, i, sum(row)) for i, row in enumerate(self.c)]
        values += [(i, j, -self.c[i, j]) for i, j in np.transpose(np.triu_indices_from(self.c, 1))]
        for tag, (i, j, value) in enumerate(values, start=1):
            if abs(value) >= 1e-9 * self.c[i, i]:
                ops.uniaxialMaterial("Elastic", DASHPOT + tag, 0.0, float(value))
                ends = (int(FLOOR + 1 + i), GROUND if i == j else int(FLOOR + 1 + j))
                ops.element("twoNodeLink", 200 + tag, *ends, "-mat", DASHPOT + tag, "-dir", 2)

    def _load(self) -> None:
        """Load the wall with its weight."""
        constant_load()
        for i, lump in enumerate(self._lumps()):
            ops.load(AXIS + i, 0.0, -lump * G, 0.0)
        solver(("LoadControl", 1.0), "Static")
        advance(1)
        ops.wipeAnalysis()

    def go(self, motion: Motion) -> tuple[Array, dict[str, float]]:
        """Return rows at the stored interval, and the largest magnitudes of all steps."""
        engine = self.engine
        self.motion = motion
        shake(motion.dt, motion.a)
        solver(engine.integrator, "Transient")
        self.rates: list[float] = []
        self.turn, is_up, blow_until = 0.0, False, 0.0
        rows, peaks = [], {}
        for step in range(1, round(motion.t_end / engine.dt) + 1):
            t = step * engine.dt
            advance(1, engine.dt)
            self._follow_turn(is_up)
            found = self._observe(t)
            # forces of the blow of a corner that lands are impulses, not demands
            was_up, is_up = is_up, abs(found["theta_rad"]) > engine.landed
            if was_up and not is_up:
                blow_until = t + (engine.rigid_blow if self.is_rigid else engine.blow)
            for name, value in found.items():
                if t >= blow_until or not (self.is_rigid or name.startswith("wall")):
                    peaks[name] = max(peaks.get(name, 0.0), abs(value))
            if step % round(engine.stored_interval / engine.dt) == 0:
                rows.append([t, *(found[name] for name in engine.stored)])
        return np.array(rows), peaks

    def _follow_turn(self, is_up: bool) -> None:
        """Take the mean angular acceleration: that of a step rings on the pads after a blow."""
        dt = self.engine.dt
        self.rates.append(-ops.nodeVel(AXIS, 3))
        steps = len(self.rates) - 1
        if steps == round(self.engine.turn_interval / dt):
            first = self.rates.pop(0)
            self.turn = (self.rates[-1] - first) / (steps * dt)
        if not is_up and not self.is_rigid:
            self.rates, self.turn = [], 0.0

    def _observe(self, t: float) -> dict[str, float]:
        """Return demands by the names of rwmf."""
        a_g = float(np.interp(t / self.motion.dt, np.arange(self.motion.a.size), self.motion.a))
        u, u_t, a = (np.array([read(FLOOR + i, 1) for i in self.floors])
                     for read in (ops.nodeDisp, ops.nodeVel, ops.nodeAccel))  # fmt: skip
        a += a_g
        drift = np.diff(u, prepend=0.0)
        theta, top = -ops.nodeDisp(AXIS, 3), ops.nodeDisp(AXIS + self.n, 1)
        if self.link is None:
            shear = np.append(self.k * drift, 0.0)
            links = self.m * a - np.diff(shear) + self.c @ u_t
        else:
            links = self.link * (np.array([ops.nodeDisp(int(AXIS + at), 1) for at in self.at]) - u)
        found = {"theta_rad": theta, "tip_deflection_m": top - self.height * math.sin(theta)}
        for name, values in (
            ("storey_{}_drift", drift / self.heights),
            ("floor_{}_acceleration_g", a / G),
            ("link_{}_force_N", links),
        ):
            found |= {name.format(i): x for i, x in zip(self.floors, values, strict=True)}
        above, below, moments = self._rigid(a_g, links) if self.is_rigid else self._bent(a_g)
        # the inertia of the width is in the base here, and over the height in rwmf
        side = 1 if self.is_rigid else -1
        moments = moments + side * self.width * self.turn * (1 - np.arange(self.n + 1) / self.n)
        mid = self.n // 2
        found |= {
            "wall_shear_base_N": above[0],
            "wall_moment_base_N_m": moments[0],
            "wall_shear_mid_N": max(above[mid], below[mid], key=abs),
            "wall_moment_mid_N_m": moments[mid],
        }
        for i, at in zip(self.floors, self.at, strict=True):
            found[f"wall_shear_{i}_N"] = below[at]
            if at < self.n:
                found[f"wall_shear_{i}_above_N"] = above[at]
            found[f"wall_moment_{i}_N_m"] = moments[at]
        found["wall_shear_N"] = max((*above, *below), key=abs)
        found["wall_moment_N_m"] = max(moments, key=abs)
        return found

    def _bent(self, a_g: float) -> tuple[Array, Array, Array]:
        """Return shears above and below the nodes of a wall that bends, and moments."""
        beams = range(AXIS, AXIS + self.n)
        ends = np.array(
            [np.add(ops.eleResponse(i, "localForce"), ops.eleResponse(i, "localDampingForce"))
             for i in beams]
        )  # fmt: skip
        # inertia of half a beam: the beams carry constant shear
        nodes = (*beams, AXIS + self.n)
        share = self.m_w / self.n / 2 * np.array([ops.nodeAccel(i, 1) + a_g for i in nodes])
        above, below = share[:-1] - ends[:, 1], -ends[:, 1] - share[1:]
        return above, np.append(0.0, below), np.append(ends[:, 2], -ends[-1, 5])

    def _rigid(self, a_g: float, links: Array) -> tuple[Array, Array, Array]:
        """Return those of the rigid wall by equilibrium of all that is above."""
        n, piece = self.n, self.height / self.n
        held = np.zeros(n + 1)
        held[self.at] = links
        middles = (np.arange(n) + 0.5) * piece
        theta = -ops.nodeDisp(AXIS, 3)
        inertia = self.m_w / n * (self.turn * middles + a_g - G * theta)
        above = np.cumsum((held[1:] + inertia)[::-1])[::-1]
        moments = np.cumsum(((above - inertia / 2) * piece)[::-1])[::-1]
        return above, np.append(0.0, above - inertia), np.append(moments, 0.0)


def _store(name: str, folder: Path) -> None:
    """Compute a variant; store its history and its peaks."""
    motion, _, variant = name.partition("_")
    engine = Engine(
        dt=2.5e-5 if variant == "rigid" else 5e-5, axial_ratio=1.0 if motion == "own" else 1e3
    )
    motion = "elcentro" if motion == "own" else motion
    rows, found = Building(engine, **VARIANTS[variant]).go(ground(motion))
    facts = {"engine": version(), **asdict(engine)}
    write(folder / f"bent_wall_{name}.csv", facts, rows, ("t_s", *STORED))
    peaks = read_peaks() if PEAKS.is_file() else {}
    peaks[name] = found
    keys = list(dict.fromkeys(key for values in peaks.values() for key in values))
    with (folder / PEAKS.name).open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["peak", *peaks])
        for key in keys:
            table.writerow([key, *(f"{values.get(key, 0.0):.6g}" for values in peaks.values())])


if __name__ == "__main__":
    names = [f"{motion}_{variant}" for motion in MOTIONS for variant in VARIANTS]
    store_cases(__doc__, "opensees", [*names, *(f"own_{variant}" for variant in OWN)], _store)
