"""A validation case in CalculiX: finite elements, a deformable wall that may lift off.

``python bench/calculix_cases.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/calculix/CASE.csv``. Needs the program ``ccx`` (Debian: ``apt-get install
calculix-ccx``).

The wall is a mesh of solid elements (30 GPa, Poisson's ratio 0.2) on a foundation, with contact and
friction between them. The solver is given neither the kinematics of rocking nor a restitution
factor. The frame is a sliding block of solid elements, held by a spring and a dashpot. It follows
the left top corner of the wall. A point mass is unsuitable, because the solver omits it from its
energy balance. In a step with contact the solver attributes the missing energy to an impact and
cuts the time increment until nothing moves. The cable is a spring with the prestress at rest.
"""

import os
import re
import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
from engines import Array, cable_of, case_of, frame_of, pulse_of, slip, store_cases
from reproduce.engines import write

Grid = npt.NDArray[np.int64]
# durations [s]: the first impacts of the heavy wall, which show restitution and lever arm, and the
# complete validation case of the paper
UNTIL = {"g5": 1.2, "g1800": 6.0}
THICKNESS = 0.2  # of the wall [m]
# nodes of the lower face of a solid element, steps in width and thickness
_RING = ((0, 0), (1, 0), (1, 1), (0, 1))
_HEAD = re.compile(r"\s*(displacements|velocities).*time\s+(\S+)")
# keep freed memory: to return it after every increment takes half of the time
_ENVIRONMENT = {
    "MALLOC_MMAP_THRESHOLD_": "1000000000",
    "MALLOC_TRIM_THRESHOLD_": "1000000000",
    "OMP_NUM_THREADS": "1",
}


@dataclass(frozen=True)
class Settings:
    """Numbers of the computation: none of them belongs to the structure."""

    # Contact of the nodes of the wall's base with the face of the foundation
    support: str = "nodes"
    nx: int = 4  # elements over the width of the wall
    nz: int = 8  # elements over its height
    dt: float = 5e-4  # largest time step [s]
    dt_min: float = 1e-4  # smallest time step [s]
    stored_interval: float = 1e-3  # interval of the stored history [s]
    modulus: float = 30e9  # Young's modulus of the wall [N/m2]
    alpha: float = -0.05  # numerical damping of the integration by Hilber, Hughes and Taylor [-]
    friction: float = 0.35  # coefficient of friction of wall and foundation [-]
    stiffness: float = 1e11  # pressure of the contact over its overclosure [N/m3]
    # Pressure of the contact over the velocity of closing [N s/m3]. The impedance of the paper's
    # foundation, the square root of 300 GPa times 2400 kg/m3, is 2.7e7: radiated energy of an
    # impact does not return.
    damping: float = 3e7
    stick: float = 1e11  # shear of the contact over the displacement before it slides [N/m3]
    tension: float = 1e3  # pull that the smoothed law of the contact may exert at most [N/m2]
    gap: float = 1e-5  # largest clearance at which contact is checked [m]


def number(x: float) -> str:
    """Write a number with a decimal point: without one the solver reads a degree of freedom."""
    return f"{x:.9e}"


def numbers(*values: float) -> str:
    """Write the numbers of a line."""
    return ", ".join(map(number, values))


class Deck:
    """Input file for one case."""

    wall: Grid  # nodes over width, height and thickness, shape (nx + 1, nz + 1, 2)
    mass: int  # node that carries the displacement of the frame

    def __init__(self, case: rwmf.Case, settings: Settings, until: float) -> None:
        self.case, self.settings, self.until = case, settings, until
        self.h, self.b = case.wall.h, case.wall.b
        self._nodes: list[str] = []
        self._elements = 0
        self._lines: list[str] = []
        self._fixed: list[int] = []
        self.wall, base = self._add_wall()
        self.mass = self._add_frame()
        self._add_cable()
        self._raise_energy()
        self._add_contact(base)

    def text(self) -> str:
        """Compose the input file."""
        watched = (self.wall[0, 0, 0], self.wall[-1, 0, 0], self.mass)
        lines = ["*NODE, NSET=ALL", *self._nodes, *self._lines]
        lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in self._fixed)]
        lines += ["*NSET, NSET=OUT", *(f"{node}," for node in watched)]
        return "\n".join([*lines, *self._static_lines(), *self._dynamic_lines(), ""])

    def _node(self, x: float, z: float, y: float = 0.0, *, fixed: bool = False) -> int:
        """Add a node at x, z, y [m] and return its number."""
        new = len(self._nodes) + 1
        # the solver's second axis is the thickness
        self._nodes.append(f"{new}, {numbers(x, y, z)}")
        if fixed:
            self._fixed.append(new)
        return new

    def _element(self, kind: str, group: str, nodes: Iterable[int]) -> int:
        """Add an element; the numbers are consecutive, because the solver visits every number."""
        self._elements += 1
        listed = ", ".join(str(int(node)) for node in nodes)
        self._write(f"*ELEMENT, TYPE={kind}, ELSET={group}", f"{self._elements}, {listed}")
        return self._elements

    def _brick(
        self, group: str, xs: tuple[float, float], zs: tuple[float, float], ys: tuple[float, float]
    ) -> tuple[int, list[int]]:
        """Add one solid element between two corners; return its number and its nodes."""
        nodes = [self._node(xs[i], z, ys[j]) for z in zs for i, j in _RING]
        return self._element("C3D8", group, nodes), nodes

    def _material(self, group: str, modulus: float, density: float) -> None:
        """Give a group of solid elements an elastic material [N/m2, kg/m3]."""
        self._write(f"*MATERIAL, NAME=M{group}", "*ELASTIC", numbers(modulus, 0.2))
        self._write("*DENSITY", number(density))
        self._write(f"*SOLID SECTION, ELSET={group}, MATERIAL=M{group}")

    def _write(self, *lines: str) -> None:
        self._lines += lines

    def _add_wall(self) -> tuple[Grid, list[int]]:
        """One element over the thickness; nothing moves out of the plane. Return its lowest row."""
        nx, nz, base = self.settings.nx, self.settings.nz, []
        grid = np.empty((nx + 1, nz + 1, 2), dtype=np.int64)
        for i, x in enumerate(np.linspace(-self.b, self.b, nx + 1)):
            for k, z in enumerate(np.linspace(0.0, 2 * self.h, nz + 1)):
                grid[i, k] = [self._node(float(x), float(z), y) for y in (0.0, THICKNESS)]
        for k, i in np.ndindex(nz, nx):
            ring = [(i + x, y) for x, y in _RING]
            nodes = [grid[j, n, y] for n in (k, k + 1) for j, y in ring]
            new = self._element("C3D8I", "WALL", nodes)
            if k == 0:
                base.append(new)
        self._write("*BOUNDARY", *(f"{node}, 2, 2" for node in grid.ravel()))
        volume = 4 * self.h * self.b * THICKNESS
        self._material("WALL", self.settings.modulus, self.case.wall.m_w / volume)
        return grid, base

    def _add_frame(self) -> int:
        """Return the sliding block of 1 m3 beside the wall; the top corner moves with it."""
        x, z = -self.b - 4.0, 2 * self.h
        _, nodes = self._brick("FRAME", (x - 1.0, x), (z, z + 1.0), (0.0, 1.0))
        frame = frame_of(self.case)
        self._material("FRAME", self.settings.modulus, frame.m)
        self._write("*BOUNDARY", *(f"{node}, 2, 3" for node in nodes))
        mass, *others = nodes
        for node in (*others, *self.wall[0, -1]):
            self._write("*EQUATION", "2", f"{node}, 1, 1., {mass}, 1, -1.")
        self._element("SPRING1", "STIFFNESS", [mass])
        self._write("*SPRING, ELSET=STIFFNESS", "1", number(frame.k))
        anchor = self._node(x - 2.0, z, fixed=True)
        self._element("DASHPOTA", "DAMPING", (anchor, mass))
        self._write("*DASHPOT, ELSET=DAMPING", "", number(frame.c))
        return mass

    def _add_cable(self) -> None:
        """Straight cable of the wall's axis, half of it on each face of the wall."""
        k, force = cable_of(self.case)
        for y, top in zip((0.0, THICKNESS), self.wall[self.settings.nx // 2, -1], strict=True):
            self._element("SPRINGA", "CABLE", (self._node(0.0, 0.0, y, fixed=True), top))
        self._write("*SPRING, ELSET=CABLE, NONLINEAR")
        for elongation in (-0.01, 0.0, 0.5):
            self._write(numbers(0.5 * (force + k * elongation), elongation))

    def _raise_energy(self) -> None:
        """Stretch a spring aside before the motion, so that the solver's energy check is content.

        In a step with contact the solver cuts the time increment when the balance of energies loses
        0.8 % of the largest energy so far. At the beginning this is next to nothing.
        """
        ends = [self._node(10.0 + x, 0.0, fixed=not x) for x in (0.0, 1.0)]
        self._element("SPRINGA", "RESERVE", ends)
        self._write("*SPRING, ELSET=RESERVE", number(2e6))
        self._write("*BOUNDARY", f"{ends[1]}, 2, 3")
        self._stretched = ends[1]

    def _add_contact(self, base: list[int]) -> None:
        """Penalty contact with friction between the wall's base and a foundation that is fixed.

        The whole base may touch, not only its corners: the solver determines the contact points.
        """
        settings = self.settings
        x, y = 2.5 * self.b, THICKNESS / 2
        ground, nodes = self._brick("GROUND", (-x, x), (-0.5, 0.0), (-y, THICKNESS + y))
        self._material("GROUND", 300e9, 2400.0)
        self._fixed += nodes
        self._write("*SURFACE, NAME=BASE", *(f"{element}, S1" for element in base))
        self._write("*SURFACE, NAME=TOP", f"{ground}, S2")
        self._write("*CONTACT PAIR, INTERACTION=TOUCH, TYPE=NODE TO SURFACE", "BASE, TOP")
        self._write("*SURFACE INTERACTION, NAME=TOUCH")
        self._write("*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")
        self._write(numbers(settings.stiffness, settings.tension, settings.gap))
        self._write("*CONTACT DAMPING, TANGENT FRACTION=1.", numbers(settings.damping))
        self._write("*FRICTION", numbers(settings.friction, settings.stick))

    def _static_lines(self) -> Iterator[str]:
        """Weight and prestress, one second before the motion begins."""
        yield "*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1."
        yield f"*BOUNDARY\n{self._stretched}, 1, 1, 1."
        # the dynamic step refuses to begin without the energies of the one before it
        yield f"*DLOAD\nWALL, GRAV, {number(self.case.model.g)}, 0., 0., -1."
        yield "*EL FILE, FREQUENCY=1000000\nENER\n*END STEP"

    def _dynamic_lines(self) -> Iterator[str]:
        """Motion of the ground as inertia forces of wall and frame."""
        pulse, settings = pulse_of(self.case), self.settings
        end = pulse.cycles * 2 * np.pi / pulse.omega
        yield "*AMPLITUDE, NAME=MOTION"
        for t in np.linspace(0.0, end, round(500 * pulse.cycles) + 1):
            yield numbers(t, pulse.wave(pulse.omega * t))
        yield f"{numbers(end + 1e-7, 0.0)}\n{numbers(1e3, 0.0)}"
        yield f"*STEP, NLGEOM, INC=1000000\n*DYNAMIC, ALPHA={settings.alpha:g}"
        yield numbers(settings.dt_min, self.until, settings.dt_min, settings.dt)
        yield "*DLOAD, AMPLITUDE=MOTION"
        a_max = number(pulse.a_max)
        yield from (f"{group}, GRAV, {a_max}, -1., 0., 0." for group in ("WALL", "FRAME"))
        yield "*NODE PRINT, NSET=OUT, FREQUENCY=1\nU, V\n*END STEP"


def read_history(path: Path, deck: Deck) -> Array:
    """Read the rotation of the base, the uplifts of its corners and the displacements."""
    rows: dict[float, dict[tuple[str, int], list[float]]] = {}
    kind, t = "", 0.0
    for line in path.read_text(encoding="utf-8").splitlines():
        if match := _HEAD.match(line):
            # the static step before the motion took one second
            kind, t = match[1], float(match[2]) - 1.0
        elif kind and line.split() and line.split()[0].isdigit():
            node, *values = line.split()
            rows.setdefault(t, {})[kind, int(node)] = [float(x) for x in values]
    found = np.array([_row(t, row, deck) for t, row in sorted(rows.items())])
    interval = deck.settings.stored_interval
    times = interval * np.arange(1, int(found[-1, 0] / interval + 1e-6) + 1)
    columns = [np.interp(times, found[:, 0], column) for column in found.T[1:]]
    return np.column_stack([times, *columns])


def _row(t: float, row: dict[tuple[str, int], list[float]], deck: Deck) -> list[float]:
    left, right = int(deck.wall[0, 0, 0]), int(deck.wall[-1, 0, 0])
    u_l, u_r = row["displacements", left], row["displacements", right]
    v_l, v_r = row["velocities", left], row["velocities", right]
    across, up = 2 * deck.b + u_r[0] - u_l[0], u_l[2] - u_r[2]
    rate = (v_l[2] - v_r[2]) * across - up * (v_r[0] - v_l[0])
    theta = float(np.arctan2(up, across))
    u_s = row["displacements", deck.mass][0]
    down = u_r[0] if theta > 0 else u_l[0]
    return [t, theta, rate / (across**2 + up**2), u_l[2], u_r[2], u_s, down]


def _store(name: str, target: Path) -> None:
    deck = Deck(case_of(name), Settings(), UNTIL[name])
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "case.inp").write_text(deck.text(), encoding="utf-8")
        done = subprocess.run(["ccx", "case"], cwd=folder, capture_output=True, text=True,
                              check=False, env=os.environ | _ENVIRONMENT)  # fmt: skip
        found = read_history(folder / "case.dat", deck)
    if found[-1, 0] < deck.until - 2 * deck.settings.stored_interval:
        raise SystemExit(f"the solver stopped at {found[-1, 0]:g} s:\n{done.stdout[-2000:]}")
    said = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    version = re.search(r"Version\s+(\S+)", said)
    facts = {"engine": f"CalculiX {version[1] if version else 'unknown'}"}
    facts |= {"slip_max_m": slip(found), **asdict(deck.settings)}
    write(target / f"{name}.csv", facts, found[:, :6])


if __name__ == "__main__":
    store_cases(__doc__, "calculix", UNTIL, _store)
