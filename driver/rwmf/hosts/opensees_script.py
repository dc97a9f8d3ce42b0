"""Scripts for OpenSeesPy of the building of a case, their runs, and demands beside rwmf."""

from __future__ import annotations

import importlib.util
import json
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np

from rwmf.case import Case
from rwmf.errors import InputError, NumericalError
from rwmf.hosts.si_building import Base, BentWall, Building, Device, Frame, Law
from rwmf.run.simulation import simulate

# angular frequency of the wall on both its corners [rad/s], and the step that resolves it [s]
_CORNER_RATE = 8000.0
_STEP_OF_WALL, _STEP_OF_FRAME = 2.5e-5, 2e-4
# angular frequency of the frame on the mast that keeps its line straight [rad/s]
_MAST_RATE = 2000.0
# accelerations do not count for so long after a contact: 16 decay times of a pad; 12 of a mast [s]
_BLOW, _BLOW_OF_MAST = 2e-3, 6e-3
# elements over the height of a wall that bends; axial stiffness of the wall over that of a pad
_ELEMENTS, _AXIAL = 24, 2.0
# springs under a base that gives
_STRIPS = 60
# part of the vertical vibration on them in a step [rad]
_RADIANS = 0.02
# length of a link that remains horizontal [m]
_LONG = 100.0


def opensees_script(case: Case) -> str:
    """Write a script for OpenSeesPy."""
    return _Script(case, Building(case)).text()


def _shown(x: object) -> str:
    """Return a value as Python: numbers with nine digits."""
    return f"{float(x):.9g}" if isinstance(x, float | np.floating) else json.dumps(x)


class _Script:
    """Lines of a script."""

    def __init__(self, case: Case, building: Building) -> None:
        self.case, self.building = case, building
        self.lines: list[str] = []
        self.notes: list[str] = []
        self.k = building.m_w * _CORNER_RATE**2 / 2  # of the pad below a corner
        self.materials = self.elements = 0
        self.tendons: list[tuple[int, str, int]] = []
        # points off the axis and the corners, each with its number
        self.spare: dict[tuple[float, float], int] = {}
        self.floors: list[tuple[int, float, float]] = []
        self.linked = 0
        # of the first pair of walls: elements of the coupling, nodes of its ends
        self.coupled: tuple[list[int], list[int]] = ([], [])
        self.corners: list[int] = []
        coupling = building.frame.coupling if building.m_w and building.frame else ""
        self.has_links = coupling in ("every_floor", "springs")
        self.has_mast = self.has_links and building.bent is None
        # node of the rotation, and places of the nodes of the wall
        self.turned = 4 if building.bent is None else 1
        self.places: dict[int, tuple[float, float]] = {}
        self.masses: dict[int, float] = {}
        self.axis_at: dict[float, int] = {}
        # of the link
        self.length = building.link if math.isfinite(building.link) else _LONG
        self.blow = _BLOW_OF_MAST if self.has_mast else _BLOW

    def text(self) -> str:
        """Return the script."""
        given = self.building
        self._title("model")
        self.lines += ["ops.wipe()"]
        self._do("model", "basic", "-ndm", 2, "-ndf", 3)
        if given.m_w:
            self._wall()
            self._corners()
            self._devices()
            self._tendons()
            self._couplings()
        if given.frame is not None:
            self._frame(given.frame)
        self._start()
        self._motion()
        has_mass = self.case.wall is None or self.case.wall.get("m_w") is not None
        head, analysis = (
            files("rwmf.hosts").joinpath(f"opensees_{part}.txt").read_text("utf-8")
            for part in ("head", "analysis")
        )
        head = head.format(
            # as in a string of Python, in ASCII: the name of a file must not end the docstring
            source=json.dumps(self.case.label)[1:-1],
            scale="" if has_mass else "; masses and forces over the mass of the wall",
            notes="\n".join(self.notes or ["* nothing"]),
        )
        return head + self._constants() + "\n".join(self.lines) + "\n" + analysis

    def _constants(self) -> str:
        given = self.building
        values = {
            "G": given.g,
            "DT": self._step(),
            "T_END": given.t_end,
            "ALPHA": given.alpha if given.m_w else 0.0,
            "WEIGHT": given.m_w * given.g,
            "INTERVAL": given.dt,
            "BLOW": self.blow,
            "CORNERS": self.corners,
            "GIVES": given.base is not None,
            "TURNED": self.turned,
            "TOP": 5 if given.bent is not None else 0,
            "HEIGHT": 2 * given.h,
            "DRIFT_LIMIT": 0.0 if self.case.p_delta is None else self.case.p_delta.drift_limit,
        }
        lines = [f"{name} = {value!r}" for name, value in values.items()]
        lines += [
            "# of the first wall: element, its response, and the place of the force in it",
            f"TENDONS = {self.tendons!r}",
            f"COUPLING, COUPLED = {self.coupled!r}",
            f"LINKED = {self.linked}  # node of u_s when the links are springs",
            "# node, displacement over that of the node, height of the storey below",
            f"FLOORS = {[(n, float(s), float(z)) for n, s, z in self.floors]!r}",
            *self._samples("A", given.a, "horizontal"),
        ]
        if given.a_v.size:
            lines += self._samples("A_V", given.a_v, "vertical")
        return "\n".join(lines) + "\n"

    def _step(self) -> float:
        """Return the step [s]: that of the frame, of the pads, or of the strip under the base."""
        given = self.building
        if given.base is None:
            return _STEP_OF_WALL if given.m_w else _STEP_OF_FRAME
        rate = math.sqrt(2 * given.b * given.base.k / given.m_w)
        return min(_STEP_OF_FRAME, _RADIANS / rate)

    def _samples(self, name: str, values: np.ndarray, way: str) -> list[str]:
        rows = [", ".join(f"{x:.9g}" for x in values[i : i + 8]) for i in range(0, values.size, 8)]
        return [f"# {way} acceleration of the ground [m/s2]", f"{name} = [",
                *(f"    {row}," for row in rows), "]"]  # fmt: skip

    def _do(self, name: str, *words: object) -> None:
        self.lines.append(f"ops.{name}({', '.join(map(_shown, words))})")

    def _title(self, words: str) -> None:
        self.lines += ["", f"# {words}"]

    def _note(self, *lines: str) -> None:
        self.notes += [f"* {lines[0]}", *(f"  {line}" for line in lines[1:])]

    def _material(self, kind: str, *words: object) -> int:
        self.materials += 1
        self._do("uniaxialMaterial", kind, self.materials, *words)
        return self.materials

    def _element(self, kind: str, *words: object) -> int:
        self.elements += 1
        self._do("element", kind, self.elements, *words)
        return self.elements

    def _beam(self, *ends: int) -> None:
        """Put a stiff beam between two nodes of a wall."""
        area, b = 1e4 * self.k * self.building.b, self.building.b
        self._element("elasticBeamColumn", *ends, area, 1.0, area * b * b, 1)

    def _spring(self, kind: str, low: int, high: int, material: int, direction: int) -> int:
        """Put an element with a material between two nodes."""
        return self._element(kind, low, high, "-mat", material, "-dir", direction)

    def _tie(self, frame: Frame, i: int, node: int) -> None:
        """Link a floor, counted from 1, to a node."""
        if not frame.k_link.size:
            self._do("equalDOF", node, 100 + i, 1)
            return
        self.linked = node
        link = self._material("Elastic", float(frame.k_link[i - 1]))
        self._spring("zeroLength", node, 100 + i, link, 1)

    def _node(self, node: int, x: float, z: float, *fixed: int) -> None:
        self._do("node", node, x, z)
        if fixed:
            self._do("fix", node, *fixed)

    # wall: nodes 1 base, 2 and 3 corners, 4 middle, 5 top, 6 corner of the link; 11 to 13 ground.
    # A wall that bends has also 7, top of the straight axis, and from 301 on those of the axis.
    # Nodes of further walls are higher by 1000 each; their couplings are between 8 and 9. From 501
    # on there are two for each further point, of the ground and of the wall.

    def _walls(self) -> list[tuple[int, float]]:
        """Return of each wall what its nodes are higher by, and the place of its axis [m]."""
        return [(1000 * i, i * self.building.spacing) for i in range(self.building.walls)]

    def _wall(self) -> None:
        given = self.building
        h, b, m = given.h, given.b, given.m_w
        self.places = {1: (0.0, 0.0), 2: (-b, 0.0), 3: (b, 0.0), 5: (0.0, 2 * h), 6: (-b, 2 * h)}
        self.masses = {4: m}
        if given.bent is None:
            self._note("the wall is a frame of stiff beams with its mass in the middle")
            self._title("wall: base, corners, middle, top, corner of the link; ground below")
            self.places[4] = (0.0, h)
            beams = [(1, 2), (1, 3), (1, 4), (4, 5), (5, 6)]
            inertia = {4: m * (h * h + b * b) / 3}
        else:
            self._title("wall: base, corners, top, straight axis, nodes between; ground below")
            axis = self._axis()
            beams = [(1, 2), (1, 3), (5, 6), (1, 7)]
            inertia = {1: m * b * b / 3}
        if given.coupling is not None:
            middle = given.spacing / 2
            self.places |= {8: (middle, h), 9: (-middle, h)}
            beams += [(4, 8), (4, 9)]
        self._do("geomTransf", "Corotational", 1)
        places, masses = self.places, self.masses
        self.places, self.masses = {}, {}
        for first, axis_x in self._walls():
            self.places |= {first + node: (axis_x + x, z) for node, (x, z) in places.items()}
            self.masses |= {first + node: mass for node, mass in masses.items()}
            for node in sorted(places):
                self._node(first + node, *self.places[first + node])
            for node, mass in masses.items():
                self._do("mass", first + node, mass, mass, inertia.get(node, 0.0))
            for low, high in beams:
                self._beam(first + low, first + high)
            for node, x in ((11, 0.0), (12, -b), (13, b)):
                self._node(first + node, axis_x + x, 0.0, 1, 1, 1)
        if given.bent is not None:
            self._bend(given.bent, axis)

    def _axis(self) -> list[int]:
        """Place nodes of a wall that bends, one at each floor; share its mass among them."""
        given, length = self.building, 2 * self.building.h
        ends = np.cumsum(given.frame.height) if self.has_links and given.frame else np.ones(1)
        ends = np.append(0.0, ends * length / ends[-1])
        z = [0.0]
        for below, above in pairwise(ends):
            pieces = math.ceil((above - below) / length * _ELEMENTS - 1e-9)
            z += list(np.linspace(below, above, pieces + 1)[1:])
        nodes = [1, *range(301, 299 + len(z)), 5]
        self.places |= {node: (0.0, float(x)) for node, x in zip(nodes, z, strict=True)}
        self.places[7] = (0.0, length)
        piece = np.append(0.0, np.append(np.diff(z), 0.0))
        share = given.m_w / length * (piece[1:] + piece[:-1]) / 2
        self.masses = {node: float(m) for node, m in zip(nodes, share, strict=True)}
        self.axis_at = {round(x, 6): node for node, x in zip(nodes, z, strict=True)}
        return nodes

    def _bend(self, bent: BentWall, axis: list[int]) -> None:
        """Put beams between the nodes of the axis."""
        self._title("beams of the wall, with damping")
        self._note(
            f"the wall is a chain of {len(axis) - 1} beams with lumped masses on a stiff base. It",
            "has all modes; rwmf has those of &bending. The inertia of the width turns with the",
            "base. A stiff mast on the base holds the tendon, which does not bend the wall",
        )
        axial = _AXIAL * self.k * 2 * self.building.h
        self._do("damping", "SecStif", 2, bent.delay)
        if math.isinf(bent.shear_stiffness):
            for ends in pairwise(axis):
                shape = (axial, 1.0, bent.stiffness, 1, "-damp", 2)
                self._element("elasticBeamColumn", *ends, *shape)
            return
        section = (1.0, axial, bent.stiffness, 1.0, bent.shear_stiffness / axial)
        self._do("section", "Elastic", 1, *section)
        self._do("beamIntegration", "Lobatto", 1, 1, 3)
        for ends in pairwise(axis):
            self._element("forceBeamColumn", *ends, 1, 1, "-damp", 2)

    def _corners(self) -> None:
        given, k = self.building, self.k
        if given.is_pinned:
            self._title("hinge of the base")
            self._do("fix", 1, 1, 1, 0)
            return
        if given.base is not None:
            self._strip(given.base)
            return
        self._title("corners: no-tension springs in a groove, on a pad with critical damping")
        self._note(
            "each corner is on a pad of spring and dashpot that absorbs the blow; rwmf balances",
            "momenta at an instant. A pad returns exp(-2) = 14 % of the velocity: the corner hops.",
            f"Accelerations do not count for {1e3 * self.blow:g} ms after each contact of a corner",
        )
        slope = math.sqrt(0.5)
        groove = ("-orient", slope, slope, 0.0, -slope, slope, 0.0)
        spring = self._material("ENT", 100 * k)
        pad = self._material("Elastic", k, 2 * k / math.sqrt(2 * k / given.m_w))
        pads = ("-mat", pad, pad, "-dir", 1, 2)
        springs = ("-mat", spring, spring, "-dir", 1, 2, *groove)
        for first, axis_x in self._walls():
            for side, x in ((first, -given.b), (first + 1, given.b)):
                self._node(22 + side, axis_x + x, 0.0, 0, 0, 1)
                self._element("zeroLength", 12 + side, 22 + side, *pads)
                self.corners.append(self._element("zeroLength", 22 + side, 2 + side, *springs))

    def _strip(self, base: Base) -> None:
        """Put springs without tension under the base."""
        b = self.building.b
        self._title("springs of the base, without tension, with damping in contact")
        self._note(
            f"the base is on {_STRIPS} springs without tension. Their dashpots act while they are",
            "pressed in; rwmf bounds the damped stress at zero",
        )
        self._do("fix", 1, 1, 0, 0)
        spring = self._material("ENT", base.k * 2 * b / _STRIPS)
        tags = []
        for i in range(_STRIPS):
            x = b * ((2 * i + 1) / _STRIPS - 1)
            self._node(600 + i, x, 0.0)
            self._node(800 + i, x, 0.0, 1, 1, 1)
            self._beam(1, 600 + i)
            tags.append(
                self._element("zeroLength", 800 + i, 600 + i, "-mat", spring, "-dir", 2,
                              "-doRayleigh", 1)
            )  # fmt: skip
        self._do("region", 1, "-ele", *tags, "-rayleigh", 0.0, base.delay, 0.0, 0.0)

    def _point(self, wall: tuple[int, float], d: float, z: float) -> tuple[int, int]:
        """Return the nodes of the ground and of a wall at a distance from its axis, at a height."""
        (first, axis_x), given = wall, self.building
        bases = {(0.0, 0.0): 1, (-given.b, 0.0): 2, (given.b, 0.0): 3}
        if (d, z) in bases:
            return first + 10 + bases[d, z], first + bases[d, z]
        node = first + 501 + 2 * self.spare.setdefault((d, z), len(self.spare))
        if node + 1 not in self.places:
            self._node(node, axis_x + d, z, 1, 1, 1)
            self._node(node + 1, axis_x + d, z)
            self.places[node + 1] = (axis_x + d, z)
            self._beam(first + self.turned, node + 1)
        return node, node + 1

    def _devices(self) -> None:
        """Put fuses, dampers and restraints between points of the walls and the ground."""
        given = self.building
        if given.devices:
            self._title("devices, on the vertical displacement of their points")
            self._note("devices under the base follow the vertical displacement of their point")
        for device in given.devices:
            materials = self._materials_of(device)
            walls = self._walls()
            if device.is_restraint:
                walls = walls[:1] if device.offset < 0 else walls[-1:]
            for wall in walls:
                self._link_vertically(*self._point(wall, device.offset, device.height), materials)

    def _materials_of(self, device: Device) -> list[int]:
        """Write the materials of a spring and a dashpot."""
        found = [self._law(device.law)] if device.law is not None else []
        if device.c and device.exponent == 1:
            found.append(self._material("Elastic", 0.0, device.c))
        elif device.c:
            found.append(self._material("Viscous", device.c, device.exponent))
        return found

    def _couplings(self) -> None:
        """Put springs and dashpots between the edges of the walls."""
        coupling = self.building.coupling
        if coupling is None:
            return
        self._title("couplings between the walls, on stiff arms to the middle of the gap")
        self._note("couplings follow the vertical displacement of the edges; walls do not touch")
        materials = self._materials_of(coupling)
        for first, _ in self._walls()[:-1]:
            ends = (first + 8, first + 1009)
            elements = self._link_vertically(*ends, materials)
            if not first:
                self.coupled = (elements, list(ends))

    def _link_vertically(self, low: int, high: int, materials: list[int]) -> list[int]:
        """Put elements between two nodes at one place."""
        return [self._spring("zeroLength", low, high, material, 2) for material in materials]

    def _tendons(self) -> None:
        given = self.building
        for tendon in given.tendons:
            self._title("tendon")
            # strain of the truss, displacement of the vertical spring
            unit = tendon.height if tendon.is_straight else 1.0
            k = max(tendon.k, 1e-9 * self.k) * unit
            if math.isinf(tendon.force_y):
                material = self._material("Elastic", k)
            else:
                material = self._material("Steel01", tendon.force_y, k, tendon.hardening)
                self._note("a tendon that has gone slack pushes")
            force = tendon.force
            if given.base is not None:
                # stressed on the settled wall
                force += tendon.k * (given.m_w * given.g + force) / (2 * given.b * given.base.k)
            material = self._material("InitStressMaterial", material, force)
            if not math.isinf(tendon.elongation_at_rupture):
                strain = tendon.elongation_at_rupture / unit
                material = self._material("MinMax", material, "-max", strain)
            if not tendon.is_straight:
                self._note("the cable of Eq. (1) follows the uplift a sin(theta) of its foot")
            for wall in self._walls():
                low, high = self._point(wall, tendon.offset, 0.0)
                if tendon.is_straight:
                    if (tendon.offset, tendon.height) == (0.0, 2 * given.h):
                        high = wall[0] + (5 if given.bent is None else 7)
                    else:
                        high = self._point(wall, tendon.offset, tendon.height)[1]
                    tag = self._element("corotTruss", low, high, 1.0, material)
                    response = (tag, "axialForce", 0)
                else:
                    (tag,) = self._link_vertically(low, high, [material])
                    response = (tag, "force", 4)
                if not wall[0]:
                    self.tendons.append(response)

    def _law(self, law: Law) -> int:
        """Write the material of a spring."""
        if math.isinf(law.force_y):
            return self._material("Elastic", law.k)
        values, hardening = law.values, float(law.values["hardening"])
        if values["law"] == "elastic_plastic":
            return self._material("Steel01", law.force_y, law.k, hardening)
        if values["law"] == "flag":
            flag = (law.k, hardening * law.k, law.force_y, float(values["flag_height"]))
            return self._material("SelfCentering", *flag)
        u_y = law.force_y / law.k
        cap, post_cap = float(values["cap"]), float(values["post_cap"])
        side = ((cap - 1) * u_y, post_cap * u_y, 1e3, law.force_y, 1 + hardening * (cap - 1))
        # four numbers for one or four
        wear = np.broadcast_to(np.multiply(values.get("lambda") or 0.0, u_y), 4).tolist()
        powers = np.broadcast_to(np.array(values["lambda_exponent"], dtype=float), 4).tolist()
        words = [law.k, *2 * (*side, float(values["residual"])), *wear, *powers, 1.0, 1.0]
        if values["law"] == "peak_oriented":
            return self._material("IMKPeakOriented", *words)
        pinch = float(values["pinch_force"]), float(values["pinch_displacement"])
        return self._material("IMKPinching", *words, *pinch)

    # frame: nodes 100 ground, 101 and so on floors, 201 and so on the mast

    def _frame(self, frame: Frame) -> None:
        given, n = self.building, frame.m.size
        x = -given.b - self.length if given.m_w and not (self.has_links and given.bent) else 0.0
        self._title("frame: floors, springs of the storeys")
        self._node(100, x, 0.0, 1, 1, 1)
        z = np.cumsum(frame.height)
        if given.m_w:
            z *= 2 * given.h / z[-1]
        for i in range(n):
            node = 101 + i
            self._node(node, x, float(z[i]), 0, 1, 1)
            self._do("mass", node, float(frame.m[i]), 0.0, 0.0)
            self._spring("twoNodeLink", node - 1, node, self._law(frame.laws[i]), 2)
            if frame.lean[i]:
                lean = self._material("Elastic", -float(frame.lean[i]))
                self._spring("twoNodeLink", node - 1, node, lean, 2)
        if any(frame.lean):
            self._note("gravity leans on the frame by springs of negative stiffness, W/h")
        self._dashpots(frame.c)
        if self.has_mast:
            self._mast(frame, x, z)
        elif self.has_links:
            self._hold(frame, z)
        if given.m_w and (self.has_mast or not self.has_links):
            self._link(frame, (200 if self.has_mast else 100) + n)
        nodes = [101] * frame.floors if frame.coupling == "reduced" else range(101, 101 + n)
        self.floors = list(zip(nodes, frame.share, frame.floor_heights, strict=True))

    def _dashpots(self, c: np.ndarray) -> None:
        """Put a dashpot between every pair of masses, and from each to the ground."""
        self._title("dashpots for the matrix of damping")
        if c.shape[0] > 1:
            self._note("damping has a dashpot between each pair of floors, some of them negative")
        for i in range(c.shape[0]):
            for j in range(i, c.shape[0]):
                value = float(c[i].sum() if i == j else -c[i, j])
                if abs(value) > 1e-9 * c[i, i]:
                    dashpot = self._material("Elastic", 0.0, value)
                    self._spring("twoNodeLink", 101 + i, 100 if i == j else 101 + j, dashpot, 2)

    def _mast(self, frame: Frame, x: float, z: np.ndarray) -> None:
        """Link the floors to a stiff mast with a hinge, which is on the line of the wall."""
        self._title("mast that is on a line, as the wall is, and holds the floors")
        self._note(
            "a stiff mast with a hinge holds the floors on a straight line, or by the springs of",
            "coupling = 'springs'. Its top is linked to the wall; forces of single links are not",
            "reported",
        )
        self._do("geomTransf", "Linear", 2)
        self._do("damping", "SecStif", 1, 2 / _MAST_RATE)
        stiffness = float(frame.m.sum()) * _MAST_RATE**2 * float(z[-1]) ** 3
        self._node(200, x, 0.0, 1, 1, 0)
        for i, height in enumerate(z, start=1):
            self._node(200 + i, x, float(height), 0, 1, 0)
            self._tie(frame, i, 200 + i)
            ends = (199 + i, 200 + i)
            shape = (1.0, stiffness, 1.0)
            self._element("elasticBeamColumn", *ends, *shape, 2, "-damp", 1)

    def _hold(self, frame: Frame, z: np.ndarray) -> None:
        """Link the floors to the axis of a wall that bends."""
        self._title("links of the floors to the axis of the wall")
        self._note("floors are linked to the axis of the wall, in rwmf to a point of its left side")
        for i, height in enumerate(z, start=1):
            self._tie(frame, i, self.axis_at[round(float(height), 6)])

    def _link(self, frame: Frame, roof: int) -> None:
        given = self.building
        self._title("link from the roof to the left top corner of each wall")
        length = self.length
        if not math.isfinite(given.link):
            self._note(f"the link is {length:g} m long, with a dashpot against vibrations")
        both = 1 / (given.walls / float(frame.m[-1]) + 1 / given.m_w)
        damping = 2 * math.sqrt(self.k * both)
        link = self._material("Elastic", self.k * length, damping * length)
        for first, axis_x in self._walls():
            node = roof
            if first:
                node = first + 10
                self._node(node, axis_x - given.b - length, 2 * given.h, 0, 1, 1)
                self._do("equalDOF", roof, node, 1)
            self._element("corotTruss", node, first + 6, 1.0, link)

    # loads and motion

    def _start(self) -> None:
        """Load the wall with its weight, and turn it."""
        given = self.building
        if not given.m_w:
            return
        self._title("weight of the wall")
        self._do("timeSeries", "Constant", 1)
        self._do("pattern", "Plain", 1, 1)
        for node, mass in self.masses.items():
            self._do("load", node, 0.0, -mass * given.g, 0.0)
        if given.theta or given.theta_dot:
            self._turn()
            return
        for name, *words in (
            ("constraints", "Plain"), ("numberer", "RCM"), ("system", "BandGeneral"),
            ("test", "NormDispIncr", 1e-10, 50, 0), ("algorithm", "Newton"),
            ("integrator", "LoadControl", 1.0), ("analysis", "Static"),
        ):  # fmt: skip
            self._do(name, *words)
        self.lines.append('assert ops.analyze(1) == 0, "the wall finds no rest"')
        self._do("wipeAnalysis")
        self._do("setTime", 0.0)

    def _turn(self) -> None:
        """Rotate the wall about a corner, and give it its velocity."""
        given = self.building
        theta, rate = given.theta, given.theta_dot
        side = math.copysign(1.0, theta or rate)
        pivot = 0.0 if given.is_pinned else side * given.b
        s, c = math.sin(theta), math.cos(theta)
        for node, (x, z) in sorted(self.places.items()):
            arm = x - pivot - node // 1000 * given.spacing
            moved = (pivot + arm * c + z * s - x, -arm * s + z * c - z, -theta)
            speeds = (rate * (z * c - arm * s), -rate * (arm * c + z * s), -rate)
            for dof, way, speed in zip((1, 2, 3), moved, speeds, strict=True):
                self._do("setNodeDisp", node, dof, way, "-commit")
                self._do("setNodeVel", node, dof, speed, "-commit")

    def _motion(self) -> None:
        frame = self.building.frame
        self._title("motion of the ground")
        for tag, name in ((2, "A"), (3, "A_V"))[: 2 if self.building.a_v.size else 1]:
            path = f'ops.timeSeries("Path", {tag}, "-dt", INTERVAL, "-values", *{name})'
            self.lines.append(path)
            self._do("pattern", "UniformExcitation", tag, tag - 1, "-accel", tag)
        if frame is not None and frame.coupling == "reduced":
            self._title("the first mode is pushed with more mass than it has")
            self._do("pattern", "Plain", 4, 2)
            self._do("load", 101, float(frame.m[0] - frame.push[0]), 0.0, 0.0)


_COMPARED_IMPACTS = 10


@dataclass(frozen=True)
class Demand:
    """A demand of both programs.

    Attributes
    ----------
    name : str
        Key of the demand; of an impact its number and unit.
    ours, theirs : float
        Values of rwmf and of OpenSees.
    """

    name: str
    ours: float
    theirs: float

    @property
    def difference(self) -> float:
        """Relative difference [-]; of an impact that of the times [s]."""
        if self.name.startswith("impact"):
            return self.theirs - self.ours
        return self.theirs / self.ours - 1 if self.ours else self.theirs


def run_opensees(script: str | os.PathLike[str]) -> dict[str, object]:
    """Run an exported script."""
    python = os.environ.get("RWMF_OPENSEES")
    if not python and importlib.util.find_spec("openseespy"):
        python = sys.executable
    if not python:
        raise InputError(
            "no openseespy: install it with `pip install openseespy`, or set the environment "
            "variable RWMF_OPENSEES to a Python that has it"
        )
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "answer.json"
        done = subprocess.run(
            [python, os.fspath(script), str(answer)], capture_output=True, text=True, check=False
        )
        if not answer.is_file():
            last = done.stderr.strip().splitlines()
            raise NumericalError(f"{script}: {last[-1] if last else 'OpenSees gives no answer'}")
        found: dict[str, object] = json.loads(answer.read_text(encoding="utf-8"))
        return found


def compare_with_opensees(case: Case, answer: dict[str, object]) -> list[Demand]:
    """Simulate a case, and put its demands beside those of OpenSees."""
    is_bent = case.bending is not None
    response = simulate(case.replace(output={"reactions": True}), dt=1e-4 if is_bent else 1e-3)
    peaks = dict(answer["peaks"])  # type: ignore[call-overload]
    found = [
        Demand(name, float(response[name.removesuffix("_m")]), float(value))
        for name, value in peaks.items()
        if name.removesuffix("_m") in response
    ]
    if case.wall is None:
        return found
    times = _impacts(response["time"].to_numpy(), response["theta"].to_numpy(), is_bent)
    pairs = zip(times, list(answer["impacts"]), strict=False)  # type: ignore[call-overload]
    return found + [
        Demand(f"impact {i} [s]", ours, theirs)
        for i, (ours, theirs) in enumerate(pairs, start=1)
        if i <= _COMPARED_IMPACTS
    ]


def _impacts(t: np.ndarray, theta: np.ndarray, is_bent: bool) -> list[float]:
    """Return times of impacts between excursions above 2 % of the largest [s]."""
    known = np.isfinite(theta)
    t, theta = t[known], theta[known]
    # a wall that bends stays down for a while
    signs = np.sign(theta)
    is_change = signs[1:] != signs[:-1] if is_bent else signs[1:] * signs[:-1] < 0
    places = [0, *(np.flatnonzero(is_change) + 1), theta.size]
    peaks = [np.abs(theta[a:b]).max(initial=0.0) for a, b in pairwise(places)]
    limit, times, landed = 0.02 * max(peaks), [], None
    for i, place in enumerate(places[1:-1]):
        if peaks[i] > limit or (landed is not None and not is_bent):
            landed = _zero(t[: place + 1], theta[: place + 1])
        if landed is not None and peaks[i + 1] > limit:
            times.append(landed)
            landed = None
    return times


def _zero(t: np.ndarray, theta: np.ndarray) -> float:
    """Return the time between the last two samples at which a rotation is zero [s]."""
    # beyond the sample before a rest, its straight line; to the other side, that between
    first, last = (-3, -2) if theta[-1] == 0 else (-2, -1)
    slope = (theta[last] - theta[first]) / (t[last] - t[first])
    return float(t[last] - theta[last] / slope)
