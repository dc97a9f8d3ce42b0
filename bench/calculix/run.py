"""A validation case in CalculiX: finite elements, a deformable wall that may lift off.

``python bench/calculix/run.py [CASE] [--until T]`` reads ``validation/CASE.nml`` and writes
``validation/calculix/CASE.csv``. Needs the program ``ccx`` (Debian: ``apt-get install
calculix-ccx``).

The wall is a mesh of solid elements (30 GPa, Poisson's ratio 0.2); the frame is a point mass with
spring and dashpot whose horizontal displacement is that of the wall's left top corner; the cable is
a spring with the prestress at rest. Each bottom corner stands on struts that carry compression
only: surface contact in CalculiX cuts the time step at every impact until the run stands still.
The solver is given neither the kinematics of rocking nor a restitution factor.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf

Array = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[2]
THICKNESS = 0.2  # m
COLUMNS = ("t_s", "theta_rad", "theta_dot_rad_s", "left_uplift_m", "right_uplift_m", "u_s_m")


@dataclass(frozen=True)
class Mesh:
    """Numbers of the computation: none of them belongs to the structure.

    Attributes
    ----------
    nx, nz : int
        Elements over the width and over the height of the wall.
    dt : float
        Time step [s].
    stored_interval : float
        Interval of the stored history [s].
    strut_stiffness : float
        Of each of the eight struts under the corners, in compression [N/m].
    modulus : float
        Young's modulus of the wall [N/m2].
    alpha : float
        Numerical damping of the integration by Hilber, Hughes and Taylor [-].
    """

    nx: int = 4
    nz: int = 8
    dt: float = 5e-4
    stored_interval: float = 1e-3
    strut_stiffness: float = 1e10
    modulus: float = 30e9
    alpha: float = -0.05


class Deck:
    """Input file of the solver for one case.

    Parameters
    ----------
    case : rwmf.Case
        A case with wall, frame and cable.
    mesh : Mesh
        Numbers of the computation.
    until : float
        End of the computation [s].
    """

    def __init__(self, case: rwmf.Case, mesh: Mesh, until: float) -> None:
        self.case, self.mesh, self.until = case, mesh, until
        self.h, self.b = case.wall.h, case.wall.b
        self.nodes: dict[int, tuple[float, float, float]] = {}
        self.elements: dict[str, list[list[int]]] = {"WALL": []}
        self.wall = self._block("WALL", (-self.b, self.b), (0.0, 2 * self.h), mesh.nx, mesh.nz)
        # the frame's mass, its anchor, and the two ends of the cable in the ground
        self.mass = self._add(-self.b - 4.0, 2 * self.h, 0.0)
        self.anchor = self._add(-self.b - 5.0, 2 * self.h, 0.0)
        self.feet = [self._add(0.0, 0.0, y) for y in (0.0, THICKNESS)]
        self.struts: list[tuple[int, int]] = []
        for side, y in product((0, 1), (0, 1)):
            corner = int(self.wall[-side, 0, y])
            x = self.nodes[corner][0]
            for way in (-1.0, 1.0):
                self.struts.append((self._add(x + way, -1.0, THICKNESS * y), corner))

    def _add(self, x: float, z: float, y: float) -> int:
        number = len(self.nodes) + 1
        self.nodes[number] = (x, y, z)
        return number

    def _block(
        self, name: str, xs: tuple[float, float], zs: tuple[float, float], nx: int, nz: int
    ) -> npt.NDArray[np.int64]:
        """Mesh a block with one element over the thickness; node numbers [x][z][y]."""
        grid = np.empty((nx + 1, nz + 1, 2), dtype=np.int64)
        for i, x in enumerate(np.linspace(*xs, nx + 1)):
            for k, z in enumerate(np.linspace(*zs, nz + 1)):
                for j, y in enumerate((0.0, THICKNESS)):
                    grid[i, k, j] = self._add(float(x), float(z), y)
        for i in range(nx):
            for k in range(nz):
                ring = [(i, k, 0), (i + 1, k, 0), (i + 1, k, 1), (i, k, 1)]
                lower = [int(grid[i_, k_, j]) for i_, k_, j in ring]
                upper = [int(grid[i_, k_ + 1, j]) for i_, k_, j in ring]
                self.elements[name].append(lower + upper)
        return grid

    def text(self) -> str:
        """Compose the input file."""
        return "\n".join(
            [*self._mesh_lines(), *self._structure_lines(), *self._support_lines(),
             *self._static_lines(), *self._dynamic_lines(), ""]
        )  # fmt: skip

    def _mesh_lines(self) -> Iterator[str]:
        yield "*NODE, NSET=ALL"
        for number, place in self.nodes.items():
            yield f"{number}, " + ", ".join(f"{x:.9g}" for x in place)
        number = 0
        for name, elements in self.elements.items():
            yield f"*ELEMENT, TYPE=C3D8I, ELSET={name}"
            for nodes in elements:
                number += 1
                yield f"{number}, " + ", ".join(map(str, nodes))
        yield "*NSET, NSET=WALLNODES"
        yield from (f"{node}," for node in self.wall.ravel())

    def _structure_lines(self) -> Iterator[str]:
        m, g, E = self.case.wall.m_w, self.case.model.g, self.mesh.modulus
        density = m / (4 * self.h * self.b * THICKNESS)
        yield f"*MATERIAL, NAME=MWALL\n*ELASTIC\n{E:.9g}, 0.2\n*DENSITY\n{density:.9g}"
        yield "*SOLID SECTION, ELSET=WALL, MATERIAL=MWALL"
        m_s = self.case.frame.gamma * m
        omega = 2 * math.pi / self.case.frame.T_s
        yield f"*ELEMENT, TYPE=MASS, ELSET=EMASS\n90001, {self.mass}\n*MASS, ELSET=EMASS\n{m_s:.9g}"
        yield f"*ELEMENT, TYPE=SPRING1, ELSET=ESPRING\n90002, {self.mass}"
        yield f"*SPRING, ELSET=ESPRING\n1\n{m_s * omega**2:.9g}"
        yield f"*ELEMENT, TYPE=DASHPOTA, ELSET=EDASH\n90003, {self.anchor}, {self.mass}"
        yield f"*DASHPOT, ELSET=EDASH\n\n{2 * self.case.frame.xi_s * m_s * omega:.9g}"
        yield from self._cable_lines(m * g)
        yield "*BOUNDARY\nWALLNODES, 2, 2"
        for node in (self.anchor, *self.feet, *(foot for foot, _ in self.struts)):
            yield f"{node}, 1, 3"
        yield f"{self.mass}, 2, 3"
        yield "*NSET, NSET=OUT"
        for node in (self.wall[0, 0, 0], self.wall[-1, 0, 0], self.mass):
            yield f"{node},"
        # the frame follows the left top corner
        for node in self.wall[0, -1]:
            yield f"*EQUATION\n2\n{node}, 1, 1., {self.mass}, 1, -1."

    def _cable_lines(self, weight: float) -> Iterator[str]:
        h, b, cable = self.h, self.b, self.case.cable
        alpha = math.atan2(b, h)
        length = math.sqrt(
            4 * h**2 + 2 * b**2 * (1 - math.cos(alpha)) + 4 * h * b * math.sin(alpha)
        )
        k = (cable.eta_alpha - cable.eta_0) * weight / (length - 2 * h)
        middle = self.wall[self.mesh.nx // 2, -1]
        yield "*ELEMENT, TYPE=SPRINGA, ELSET=ECABLE"
        for i, (foot, top) in enumerate(zip(self.feet, middle, strict=True)):
            yield f"{90010 + i}, {foot}, {top}"
        yield "*SPRING, ELSET=ECABLE, NONLINEAR"
        # half of the cable on each face of the wall
        for elongation in (-0.01, 0.0, 0.5):
            force = 0.5 * (cable.eta_0 * weight + k * elongation)
            yield f"{force:.9e}, {elongation:.9e}"

    def _support_lines(self) -> Iterator[str]:
        """Struts that carry compression only: a corner that presses is held, a free one is not."""
        yield "*ELEMENT, TYPE=SPRINGA, ELSET=ESTRUT"
        for number, (foot, corner) in enumerate(self.struts, start=90020):
            yield f"{number}, {foot}, {corner}"
        stiffness = self.mesh.strut_stiffness
        weight = self.case.wall.m_w * self.case.model.g * (1 + self.case.cable.eta_0)
        # so short that they carry the wall at rest without moving: each leans by 45 degrees
        gap = weight * math.sqrt(2) / len(self.struts) / stiffness
        yield "*SPRING, ELSET=ESTRUT, NONLINEAR"
        yield f"{-stiffness:.9e}, {gap - 1.0:.12f}\n0., {gap:.12f}\n0., 5."

    def _static_lines(self) -> Iterator[str]:
        g = self.case.model.g
        yield "*STEP, NLGEOM, INC=1000\n*STATIC\n1., 1."
        # the dynamic step refuses to begin without the energies of the one before it
        yield f"*DLOAD\nWALL, GRAV, {g:.9g}, 0., 0., -1.\n*EL FILE, FREQUENCY=1000000\nENER"
        yield "*END STEP"

    def _dynamic_lines(self) -> Iterator[str]:
        case, dt = self.case, self.mesh.dt
        motion = case.motion
        period = 2 * math.pi / motion.omega_p
        cycles = motion.cycles if motion.kind == "sine" else 1.0
        wave = np.cos if motion.kind == "one_cosine" else np.sin
        t = np.linspace(0.0, cycles * period, round(500 * cycles) + 1)
        values = wave(motion.omega_p * t)
        yield "*AMPLITUDE, NAME=MOTION"
        yield from (f"{a:.9g}, {v:.9g}" for a, v in zip(t, values, strict=True))
        yield f"{t[-1] + 1e-7:.9g}, 0.\n1e3, 0."
        a_max = motion.a_max_g * case.model.g
        m_s = case.frame.gamma * case.wall.m_w
        yield f"*STEP, NLGEOM, INC=1000000\n*DYNAMIC, DIRECT, ALPHA={self.mesh.alpha:g}"
        yield f"{dt:.9g}, {self.until:.9g}"
        yield f"*DLOAD, AMPLITUDE=MOTION\nWALL, GRAV, {a_max:.9g}, -1., 0., 0."
        yield f"*CLOAD, AMPLITUDE=MOTION\n{self.mass}, 1, {-m_s * a_max:.9g}"
        every = round(self.mesh.stored_interval / dt)
        yield f"*NODE PRINT, NSET=OUT, FREQUENCY={every}\nU, V\n*END STEP"

    def history(self, output: str) -> Array:
        """Read `COLUMNS` from what the solver printed."""
        rows: dict[float, dict[tuple[str, int], list[float]]] = {}
        kind, t = "", 0.0
        for line in output.splitlines():
            if match := re.match(r"\s*(displacements|velocities).*time\s+(\S+)", line):
                # the static step before the motion took one second
                kind, t = match[1], float(match[2]) - 1.0
            elif kind and line.split() and line.split()[0].isdigit():
                number, *values = line.split()
                rows.setdefault(t, {})[kind, int(number)] = [float(x) for x in values]
        return np.array([self._row(t, row) for t, row in sorted(rows.items())])

    def _row(self, t: float, row: dict[tuple[str, int], list[float]]) -> list[float]:
        left, right = int(self.wall[0, 0, 0]), int(self.wall[-1, 0, 0])
        u_l, u_r = row["displacements", left], row["displacements", right]
        v_l, v_r = row["velocities", left], row["velocities", right]
        across, up = 2 * self.b + u_r[0] - u_l[0], u_l[2] - u_r[2]
        rate = (v_l[2] - v_r[2]) * across - up * (v_r[0] - v_l[0])
        u_s = row["displacements", self.mass][0]
        return [t, math.atan2(up, across), rate / (across**2 + up**2), u_l[2], u_r[2], u_s]


def main() -> None:
    """Compute the case that the command line names."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="example: python bench/calculix/run.py g5 --until 1.2",
    )
    parser.add_argument("case", nargs="?", default="g5", metavar="CASE", help="g5 or g1800")
    parser.add_argument("--until", type=float, default=1.2, metavar="T", help="end [s]")
    for name, default in asdict(Mesh()).items():
        parser.add_argument(f"--{name.replace('_', '-')}", type=type(default), default=default)
    parser.add_argument("--out", type=Path, default=ROOT / "validation" / "calculix")
    options = parser.parse_args()
    mesh = Mesh(**{name: getattr(options, name) for name in asdict(Mesh())})
    case = rwmf.Case.from_namelist(ROOT / "validation" / f"{options.case}.nml")
    started = time.perf_counter()
    history = compute(Deck(case, mesh, options.until))
    facts = {"engine": solver_version(), **asdict(mesh)}
    options.out.mkdir(parents=True, exist_ok=True)
    lines = [f"# {json.dumps(facts)}", ",".join(COLUMNS)]
    lines += [f"{row[0]:.4f}," + ",".join(f"{x:.6g}" for x in row[1:]) for row in history]
    (options.out / f"{options.case}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{options.case}: {len(history)} rows, {time.perf_counter() - started:.0f} s")


def compute(deck: Deck) -> Array:
    """Run the solver in a folder of its own and return the history."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.inp").write_text(deck.text(), encoding="utf-8")
        with (Path(folder) / "log").open("w") as log:
            subprocess.run(
                ["ccx", "case"], cwd=folder, stdout=log, stderr=log, check=False, env=_environment()
            )
        found = deck.history((Path(folder) / "case.dat").read_text(encoding="utf-8"))
        if not len(found) or found[-1, 0] < deck.until - 2 * deck.mesh.stored_interval:
            tail = (Path(folder) / "log").read_text(errors="replace")[-2000:]
            raise RuntimeError(f"the solver stopped early, {len(found)} rows:\n{tail}")
    return found


def _environment() -> dict[str, str]:
    """Keep freed memory: to return it after every increment takes half of the time."""
    keep = {"MALLOC_MMAP_THRESHOLD_": "1000000000", "MALLOC_TRIM_THRESHOLD_": "1000000000"}
    return {**os.environ, **keep, "OMP_NUM_THREADS": "1"}


def solver_version() -> str:
    """Ask the solver for its version."""
    found = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    match = re.search(r"Version\s+(\S+)", found)
    return f"CalculiX {match[1] if match else 'unknown'}"


if __name__ == "__main__":
    main()
