"""Input file of CalculiX: a wall of solid elements with frame, cable and support.

The frame is a sliding block of solid elements, held by a spring and a dashpot. It follows the left
top corner of the wall. A point mass is unsuitable, because the solver omits it from its energy
balance. In a step with contact the solver attributes the missing energy to an impact and cuts the
time increment until nothing moves. The cable is a spring with the prestress at rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np
import numpy.typing as npt
import rwmf
from settings import THICKNESS, Settings

__all__ = ["Deck", "number", "numbers"]

Grid = npt.NDArray[np.int64]
# nodes of the lower face of a solid element, steps in width and thickness
_RING = ((0, 0), (1, 0), (1, 1), (0, 1))


def number(x: float) -> str:
    """Write a number with a decimal point: without one the solver reads a degree of freedom."""
    return f"{x:.9e}"


def numbers(*values: float) -> str:
    """Write the numbers of a line."""
    return ", ".join(map(number, values))


class Deck:
    """Input file for one case.

    Attributes
    ----------
    wall : numpy.ndarray of int, shape (nx + 1, nz + 1, 2)
        Nodes of the wall over width, height and thickness.
    base : list of int
        Elements of the wall's lowest row; their first face lies on the foundation.
    mass : int
        Node that carries the displacement of the frame.
    """

    def __init__(self, case: rwmf.Case, settings: Settings, until: float) -> None:
        self.case, self.settings, self.until = case, settings, until
        self.h, self.b = case.wall.h, case.wall.b
        self._nodes: list[str] = []
        self._places: list[tuple[float, float, float]] = []
        self._elements = 0
        self._lines: list[str] = []
        self.fixed: list[int] = []
        self.base: list[int] = []
        self.wall = self._add_wall()
        self.mass = self._add_frame()
        self._add_cable()
        self._raise_energy()

    def place(self, node: int) -> tuple[float, float, float]:
        """Return x, z and y of a node [m]."""
        return self._places[node - 1]

    def node(self, x: float, z: float, y: float = 0.0, *, fixed: bool = False) -> int:
        """Add a node at x, z, y [m] and return its number."""
        self._places.append((x, z, y))
        new = len(self._places)
        # the solver's second axis is the thickness
        self._nodes.append(f"{new}, {numbers(x, y, z)}")
        if fixed:
            self.fixed.append(new)
        return new

    def element(self, kind: str, group: str, nodes: Iterable[int]) -> int:
        """Add an element; the numbers are consecutive, because the solver visits every number."""
        self._elements += 1
        listed = ", ".join(str(int(node)) for node in nodes)
        self.write(f"*ELEMENT, TYPE={kind}, ELSET={group}", f"{self._elements}, {listed}")
        return self._elements

    def brick(
        self, group: str, xs: tuple[float, float], zs: tuple[float, float], ys: tuple[float, float]
    ) -> tuple[int, list[int]]:
        """Add one solid element between two corners; return its number and its nodes."""
        nodes = [self.node(xs[i], z, ys[j]) for z in zs for i, j in _RING]
        return self.element("C3D8", group, nodes), nodes

    def material(self, group: str, modulus: float, density: float) -> None:
        """Give a group of solid elements an elastic material [N/m2, kg/m3]."""
        self.write(f"*MATERIAL, NAME=M{group}", "*ELASTIC", numbers(modulus, 0.2))
        self.write("*DENSITY", number(density))
        self.write(f"*SOLID SECTION, ELSET={group}, MATERIAL=M{group}")

    def write(self, *lines: str) -> None:
        """Add lines to the description of the structure."""
        self._lines += lines

    def text(self) -> str:
        """Compose the input file."""
        watched = (self.wall[0, 0, 0], self.wall[-1, 0, 0], self.mass)
        lines = ["*NODE, NSET=ALL", *self._nodes, *self._lines]
        lines += ["*BOUNDARY", *(f"{node}, 1, 3" for node in self.fixed)]
        lines += ["*NSET, NSET=OUT", *(f"{node}," for node in watched)]
        return "\n".join([*lines, *self._static_lines(), *self._dynamic_lines(), ""])

    def _add_wall(self) -> Grid:
        """One element over the thickness; nothing moves out of the plane."""
        nx, nz = self.settings.nx, self.settings.nz
        grid = np.empty((nx + 1, nz + 1, 2), dtype=np.int64)
        for i, x in enumerate(np.linspace(-self.b, self.b, nx + 1)):
            for k, z in enumerate(np.linspace(0.0, 2 * self.h, nz + 1)):
                if k == 0 and 0 < i < nx:
                    z = self.settings.hollow
                grid[i, k] = [self.node(float(x), float(z), y) for y in (0.0, THICKNESS)]
        for k, i in np.ndindex(nz, nx):
            ring = [(i + x, y) for x, y in _RING]
            nodes = [grid[j, n, y] for n in (k, k + 1) for j, y in ring]
            new = self.element("C3D8I", "WALL", nodes)
            if k == 0:
                self.base.append(new)
        self.write("*BOUNDARY", *(f"{node}, 2, 2" for node in grid.ravel()))
        volume = 4 * self.h * self.b * THICKNESS
        self.material("WALL", self.settings.modulus, self.case.wall.m_w / volume)
        return grid

    def _add_frame(self) -> int:
        """Return the sliding block of 1 m3 beside the wall; the top corner moves with it."""
        x, z = -self.b - 4.0, 2 * self.h
        _, nodes = self.brick("FRAME", (x - 1.0, x), (z, z + 1.0), (0.0, 1.0))
        m_s = self.case.frame.gamma * self.case.wall.m_w
        self.material("FRAME", self.settings.modulus, m_s)
        self.write("*BOUNDARY", *(f"{node}, 2, 3" for node in nodes))
        mass, *others = nodes
        for node in (*others, *self.wall[0, -1]):
            self.write("*EQUATION", "2", f"{node}, 1, 1., {mass}, 1, -1.")
        omega = 2 * math.pi / self.case.frame.T_s
        self.element("SPRING1", "STIFFNESS", [mass])
        self.write("*SPRING, ELSET=STIFFNESS", "1", number(m_s * omega**2))
        anchor = self.node(x - 2.0, z, fixed=True)
        self.element("DASHPOTA", "DAMPING", (anchor, mass))
        damping = 2 * self.case.frame.xi_s * m_s * omega
        self.write("*DASHPOT, ELSET=DAMPING", "", number(damping))
        return mass

    def _add_cable(self) -> None:
        """Straight cable of the wall's axis, half of it on each face of the wall."""
        h, b, cable = self.h, self.b, self.case.cable
        weight = self.case.wall.m_w * self.case.model.g
        alpha = math.atan2(b, h)
        length = math.sqrt(
            4 * h**2 + 2 * b**2 * (1 - math.cos(alpha)) + 4 * h * b * math.sin(alpha)
        )
        k = (cable.eta_alpha - cable.eta_0) * weight / (length - 2 * h)
        for y, top in zip((0.0, THICKNESS), self.wall[self.settings.nx // 2, -1], strict=True):
            self.element("SPRINGA", "CABLE", (self.node(0.0, 0.0, y, fixed=True), top))
        self.write("*SPRING, ELSET=CABLE, NONLINEAR")
        for elongation in (-0.01, 0.0, 0.5):
            self.write(numbers(0.5 * (cable.eta_0 * weight + k * elongation), elongation))

    def _raise_energy(self) -> None:
        """Stretch a spring aside before the motion, so that the solver's energy check is content.

        In a step with contact the solver cuts the time increment when the balance of energies loses
        0.8 % of the largest energy so far. At the beginning this is next to nothing.
        """
        ends = [self.node(10.0 + x, 0.0, fixed=not x) for x in (0.0, 1.0)]
        self.element("SPRINGA", "RESERVE", ends)
        self.write("*SPRING, ELSET=RESERVE", number(2e6))
        self.write("*BOUNDARY", f"{ends[1]}, 2, 3")
        self.stretched = ends[1]

    def _static_lines(self) -> Iterator[str]:
        """Weight and prestress, one second before the motion begins."""
        yield "*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1."
        yield f"*BOUNDARY\n{self.stretched}, 1, 1, 1."
        # the dynamic step refuses to begin without the energies of the one before it
        yield f"*DLOAD\nWALL, GRAV, {number(self.case.model.g)}, 0., 0., -1."
        yield "*EL FILE, FREQUENCY=1000000\nENER\n*END STEP"

    def _dynamic_lines(self) -> Iterator[str]:
        """Motion of the ground as inertia forces of wall and frame."""
        motion, settings = self.case.motion, self.settings
        period = 2 * math.pi / motion.omega_p
        cycles = motion.cycles if motion.kind == "sine" else 1.0
        wave = np.cos if motion.kind == "one_cosine" else np.sin
        t = np.linspace(0.0, cycles * period, round(500 * cycles) + 1)
        yield "*AMPLITUDE, NAME=MOTION"
        yield from map(numbers, t, wave(motion.omega_p * t))
        yield f"{numbers(t[-1] + 1e-7, 0.0)}\n{numbers(1e3, 0.0)}"
        yield f"*STEP, NLGEOM, INC=1000000\n*DYNAMIC, ALPHA={settings.alpha:g}"
        yield numbers(settings.dt_min, self.until, settings.dt_min, settings.dt)
        yield "*DLOAD, AMPLITUDE=MOTION"
        a_max = number(motion.a_max_g * self.case.model.g)
        yield from (f"{group}, GRAV, {a_max}, -1., 0., 0." for group in ("WALL", "FRAME"))
        yield "*NODE PRINT, NSET=OUT, FREQUENCY=1\nU, V\n*END STEP"
