"""A building with a rocking wall in OpenSees: reads a scene as JSON, writes its answer as JSON.

``python bent_wall.py FILE < SCENE`` is called by ``bench/opensees_bent_wall.py`` with a Python that
has ``openseespy``, and imports nothing else. The wall is a chain of corotational beams with lumped
masses on a rigid base. Each end of the base is on a spring without tension (ENT), on a pad of
spring and dashpot. A key holds the middle of the base sideways. The tendon is a truss to the top
of a stiff mast that turns with the base. Like that of a tendon in a duct, its force does not bend
the wall. Floors are masses with springs and dashpots between them; links are springs, or rigid.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import openseespy.opensees as ops

Scene = dict[str, Any]

# nodes: ground, its corners, corners of the base, pads, top of the mast; axis of the wall from
# AXIS up, floors from FLOOR + 1 up
GROUND, GROUND_LEFT, GROUND_RIGHT = 1, 2, 3
LEFT, RIGHT, PAD_LEFT, PAD_RIGHT, MAST = 4, 5, 6, 7, 8
FLOOR, AXIS = 20, 100
# materials
NO_TENSION, PAD, TENDON, STRESSED = 1, 2, 3, 4
STOREY, DASHPOT, LINK = 20, 100, 60
SIDES = ((LEFT, PAD_LEFT, GROUND_LEFT, -1.0), (RIGHT, PAD_RIGHT, GROUND_RIGHT, 1.0))


def main() -> None:
    """Compute the scene of the standard input."""
    given = json.load(sys.stdin)
    scene, engine = given["scene"], given["engine"]
    build_wall(scene, engine)
    build_corners(scene, engine)
    build_tendon(scene, engine)
    build_frame(scene, engine)
    prepare(scene, engine)
    history, peaks = Run(scene, engine).go()
    answer = {"version": ops.version(), "history": history, "peaks": peaks}
    Path(sys.argv[1]).write_text(json.dumps(answer), encoding="utf-8")


def build_wall(scene: Scene, engine: Scene) -> None:
    """Chain of beams on a stiff base."""
    wall, n = scene["wall"], engine["elements"]
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.geomTransf("Corotational", 1)
    ops.node(GROUND, 0.0, 0.0)
    ops.fix(GROUND, 1, 1, 1)
    piece = 2 * wall["h"] / n
    for i in range(n + 1):
        ops.node(AXIS + i, 0.0, i * piece)
    ops.fix(AXIS, 1, 0, 0)
    lay_masses(wall, n)
    area = engine["axial_ratio"] * wall["area"]
    ops.damping("SecStif", 1, engine["rigid_beta"] if wall["is_rigid"] else wall["beta"])
    if wall["is_rigid"]:
        # as stiff as the base; the mass is in the middle
        shape = (100.0, engine["stiffness"] * 2 * wall["h"], 1e4)  # A, E, I
        for i in range(n):
            ends = (AXIS + i, AXIS + i + 1)
            ops.element("elasticBeamColumn", AXIS + i, *ends, *shape, 1, "-damp", 1)
        return
    if wall["shear_modulus"] is None:
        for i in range(n):
            ends = (AXIS + i, AXIS + i + 1)
            shape = (area, wall["modulus"], wall["inertia"])
            ops.element("elasticBeamColumn", AXIS + i, *ends, *shape, 1, "-damp", 1)
        return
    shape = (area, wall["inertia"], wall["shear_modulus"], 5 / 6 * wall["area"] / area)
    ops.section("Elastic", 1, wall["modulus"], *shape)
    ops.beamIntegration("Lobatto", 1, 1, 3)
    for i in range(n):
        ends = (AXIS + i, AXIS + i + 1)
        ops.element("forceBeamColumn", AXIS + i, *ends, 1, 1, "-damp", 1)


def lay_masses(wall: Scene, n: int) -> None:
    """Lump the masses; the inertia of the width turns with the base."""
    m = wall["m_w"]
    width = m * wall["b"] ** 2 / 3
    if wall["is_rigid"]:
        ops.mass(AXIS + n // 2, m, m, m * wall["h"] ** 2 / 3 + width)
        return
    for i in range(n + 1):
        lump = m / n / (2 if i in (0, n) else 1)
        ops.mass(AXIS + i, lump, lump, width if i == 0 else 0.0)


def build_corners(scene: Scene, engine: Scene) -> None:
    """No-tension springs on pads with the dashpot of a plastic impact."""
    k, b, m = engine["stiffness"], scene["wall"]["b"], scene["wall"]["m_w"]
    delay = 2 * engine["damping_ratio"] / math.sqrt(2 * k / m)
    ops.uniaxialMaterial("ENT", NO_TENSION, k * engine["contact_ratio"])
    ops.uniaxialMaterial("Elastic", PAD, k, k * delay)
    stiff = (b, k * engine["contact_ratio"] * b, b)  # A, E, I
    for corner, pad, ground, side in SIDES:
        ops.node(corner, side * b, 0.0)
        ops.node(ground, side * b, 0.0)
        ops.fix(ground, 1, 1, 1)
        ops.node(pad, side * b, 0.0)
        ops.fix(pad, 1, 0, 1)
        ops.element("elasticBeamColumn", 10 + corner, AXIS, corner, *stiff, 1)
        ops.element("zeroLength", 20 + corner, ground, pad, "-mat", PAD, "-dir", 2)
        ops.element("zeroLength", 30 + corner, pad, corner, "-mat", NO_TENSION, "-dir", 2)


def build_tendon(scene: Scene, engine: Scene) -> None:
    """Tendon from the ground to the top of a mast that turns with the base."""
    tendon, wall, k = scene["tendon"], scene["wall"], engine["stiffness"]
    if tendon is None:
        return
    ops.node(MAST, 0.0, 2 * wall["h"])
    ops.element("elasticBeamColumn", 41, AXIS, MAST, 100.0, k * 2 * wall["h"], 1e4, 1)
    ops.uniaxialMaterial("Elastic", TENDON, tendon["k"] * 2 * wall["h"])
    ops.uniaxialMaterial("InitStressMaterial", STRESSED, TENDON, tendon["force"])
    ops.element("corotTruss", 42, GROUND, MAST, 1.0, STRESSED)


def build_frame(scene: Scene, engine: Scene) -> None:
    """Floors beside the nodes of the wall at their heights."""
    frame, links = scene["frame"], scene["links"]
    for i, (m, k, z) in enumerate(zip(frame["m"], frame["k"], frame["z"], strict=True), start=1):
        ops.node(FLOOR + i, 0.0, z)
        ops.fix(FLOOR + i, 0, 1, 1)
        ops.mass(FLOOR + i, m, 0.0, 0.0)
        ops.uniaxialMaterial("Elastic", STOREY + i, k)
        below = FLOOR + i - 1 if i > 1 else GROUND
        ops.element("twoNodeLink", 50 + i, below, FLOOR + i, "-mat", STOREY + i, "-dir", 2)
        at = axis_node(scene, engine, z)
        if links is None:
            ops.equalDOF(at, FLOOR + i, 1)
        else:
            ops.uniaxialMaterial("Elastic", LINK + i, links[i - 1])
            ops.element("zeroLength", 60 + i, at, FLOOR + i, "-mat", LINK + i, "-dir", 1)
    build_dashpots(frame["c"])


def build_dashpots(c: list[list[float]]) -> None:
    """Dashpots between all pairs of floors and to the ground, for the matrix of damping."""
    n, tag = len(c), 0
    for i in range(n):
        for j in range(i, n):
            value = sum(c[i]) if i == j else -c[i][j]
            if abs(value) < 1e-9 * c[i][i]:
                continue
            tag += 1
            ops.uniaxialMaterial("Elastic", DASHPOT + tag, 0.0, value)
            other = GROUND if i == j else FLOOR + 1 + j
            ends = (FLOOR + 1 + i, other)
            ops.element("twoNodeLink", 200 + tag, *ends, "-mat", DASHPOT + tag, "-dir", 2)


def axis_node(scene: Scene, engine: Scene, z: float) -> int:
    """Return the node of the wall at a height."""
    return AXIS + round(z / (2 * scene["wall"]["h"]) * engine["elements"])


def prepare(scene: Scene, engine: Scene) -> None:
    """Load the wall with its weight; then set the ground in motion."""
    wall, n = scene["wall"], engine["elements"]
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    weight = wall["m_w"] * scene["g"]
    if wall["is_rigid"]:
        ops.load(AXIS + n // 2, 0.0, -weight, 0.0)
    else:
        for i in range(n + 1):
            ops.load(AXIS + i, 0.0, -weight / n / (2 if i in (0, n) else 1), 0.0)
    solver(("LoadControl", 1.0), "Static")
    if ops.analyze(1) != 0:
        raise RuntimeError("the wall finds no rest")
    ops.wipeAnalysis()
    ops.setTime(0.0)
    ops.timeSeries("Path", 2, "-dt", scene["dt"], "-values", *scene["a"])
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    solver(engine["integrator"], "Transient")


def solver(integrator: list[Any] | tuple[Any, ...], analysis: str) -> None:
    """Newton's method on the full matrix."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50, 0)
    ops.algorithm("Newton")
    ops.integrator(*integrator)
    ops.analysis(analysis)


class Run:
    """Steps of a scene, with demands of each.

    Forces on sections are those of the beams, with the inertia of half a beam up to its end. The
    rigid wall has all its mass in the middle; its forces follow from the motion and the links.
    """

    def __init__(self, scene: Scene, engine: Scene) -> None:
        self.scene, self.engine = scene, engine
        self.wall, self.frame = scene["wall"], scene["frame"]
        self.n, self.floors = engine["elements"], len(scene["frame"]["m"])
        self.at = [axis_node(scene, engine, z) - AXIS for z in self.frame["z"]]
        self.middle = self.n // 2
        self.is_up, self.blow_until = False, 0.0
        self.rates: list[float] = []
        self.turn = 0.0

    def go(self) -> tuple[dict[str, list[float]], dict[str, float]]:
        """Return rows at the stored interval, and the largest magnitudes of all steps."""
        dt = self.engine["dt"]
        stride = round(self.engine["stored_interval"] / dt)
        history: dict[str, list[float]] = {}
        peaks: dict[str, float] = {}
        for step in range(1, round(self.scene["t_end"] / dt) + 1):
            if ops.analyze(1, dt) != 0:
                raise RuntimeError(f"no convergence at {ops.getTime():g} s")
            self._follow_turn()
            found = self.observe(step * dt)
            is_blow = self._is_blow(step * dt, found["theta_rad"])
            for name, value in found.items():
                if is_blow and (self.wall["is_rigid"] or name.startswith("wall")):
                    continue
                if abs(value) > peaks.get(name, 0.0):
                    peaks[name] = abs(value)
            if step % stride == 0:
                history.setdefault("t_s", []).append(step * dt)
                for name in self.engine["stored"]:
                    history.setdefault(name, []).append(found[name])
        return history, peaks

    def _is_blow(self, t: float, theta: float) -> bool:
        """Return whether a corner lands: forces of the blow are impulses, not demands."""
        was_up, self.is_up = self.is_up, abs(theta) > self.engine["landed"]
        if was_up and not self.is_up:
            self.blow_until = t + self.engine["rigid_blow" if self.wall["is_rigid"] else "blow"]
        return t < self.blow_until

    def _follow_turn(self) -> None:
        """Take the mean angular acceleration: that of a step rings on the pads after a blow."""
        self.rates.append(-ops.nodeVel(AXIS, 3))
        steps = len(self.rates) - 1
        if steps == round(self.engine["turn_interval"] / self.engine["dt"]):
            first = self.rates.pop(0)
            self.turn = (self.rates[-1] - first) / (steps * self.engine["dt"])
        if not self.is_up and not self.wall["is_rigid"]:
            self.rates, self.turn = [], 0.0

    def observe(self, t: float) -> dict[str, float]:
        """Return demands by the names of rwmf."""
        g, heights = self.scene["g"], self.frame["height"]
        a_g = ground_acceleration(self.scene, t)
        u = [ops.nodeDisp(FLOOR + 1 + i, 1) for i in range(self.floors)]
        u_t = [ops.nodeVel(FLOOR + 1 + i, 1) for i in range(self.floors)]
        a = [ops.nodeAccel(FLOOR + 1 + i, 1) + a_g for i in range(self.floors)]
        theta, top = -ops.nodeDisp(AXIS, 3), ops.nodeDisp(AXIS + self.n, 1)
        found = {"theta_rad": theta, "tip_deflection_m": top - 2 * self.wall["h"] * math.sin(theta)}
        before = 0.0
        for i in range(self.floors):
            found[f"storey_{i + 1}_drift"] = (u[i] - before) / heights[i]
            found[f"floor_{i + 1}_acceleration_g"] = a[i] / g
            before = u[i]
        links = self.links(u, u_t, a)
        found |= {f"link_{i + 1}_force_N": links[i] for i in range(self.floors)}
        found |= self.rigid_forces(a_g, links) if self.wall["is_rigid"] else self.forces(a_g)
        return found

    def links(self, u: list[float], u_t: list[float], a: list[float]) -> list[float]:
        """Return the forces with which the links pull the floors along."""
        if self.scene["links"] is not None:
            return [
                k * (ops.nodeDisp(AXIS + at, 1) - u[i])
                for i, (k, at) in enumerate(zip(self.scene["links"], self.at, strict=True))
            ]
        k, c, m = self.frame["k"], self.frame["c"], self.frame["m"]
        drift = [u[i] - (u[i - 1] if i else 0.0) for i in range(self.floors)]
        shear = [k[i] * drift[i] for i in range(self.floors)] + [0.0]
        damping = [sum(x * y for x, y in zip(row, u_t, strict=True)) for row in c]
        return [m[i] * a[i] + shear[i] - shear[i + 1] + damping[i] for i in range(self.floors)]

    def forces(self, a_g: float) -> dict[str, float]:
        """Return shears and moments of the wall that bends: at base, middle, floors; largest."""
        half = self.wall["m_w"] / self.n / 2
        ends = [
            [x + y for x, y in zip(force, damping, strict=True)]
            for force, damping in (
                (ops.eleResponse(i, "localForce"), ops.eleResponse(i, "localDampingForce"))
                for i in range(AXIS, AXIS + self.n)
            )
        ]
        # inertia of half a beam: the beams carry constant shear
        share = [half * (ops.nodeAccel(AXIS + i, 1) + a_g) for i in range(self.n + 1)]
        above = [share[i] - ends[i][1] for i in range(self.n)]
        below = [0.0] + [-ends[i][1] - share[i + 1] for i in range(self.n)]
        moments = [ends[i][2] for i in range(self.n)] + [-ends[-1][5]]
        # the inertia of the width is in the base here, and over the height in rwmf; moments of
        # beams are counterclockwise, rotations clockwise
        width = self.wall["m_w"] * self.wall["b"] ** 2 / 3 * self.turn
        moments = [x - width * (1 - i / self.n) for i, x in enumerate(moments)]
        return self._named(above, below, moments)

    def _named(
        self, above: list[float], below: list[float], moments: list[float]
    ) -> dict[str, float]:
        found = {"wall_shear_base_N": above[0], "wall_moment_base_N_m": moments[0]}
        mid = self.middle
        found["wall_shear_mid_N"] = max(above[mid], below[mid], key=abs)
        found["wall_moment_mid_N_m"] = moments[mid]
        for i, at in enumerate(self.at, start=1):
            found[f"wall_shear_{i}_N"] = below[at]
            if at < self.n:
                found[f"wall_shear_{i}_above_N"] = above[at]
            found[f"wall_moment_{i}_N_m"] = moments[at]
        found["wall_shear_N"] = max(above + below, key=abs)
        found["wall_moment_N_m"] = max(moments, key=abs)
        return found

    def rigid_forces(self, a_g: float, links: list[float]) -> dict[str, float]:
        """Return shears and moments of the rigid wall by equilibrium of all that is above."""
        n, wall, piece = self.n, self.wall, 2 * self.wall["h"] / self.n
        theta, turn = -ops.nodeDisp(AXIS, 3), self.turn
        width = wall["m_w"] * wall["b"] ** 2 / 3 * turn
        held = dict(zip(self.at, links, strict=True))
        above, below, moments = [0.0] * (n + 1), [0.0] * (n + 1), [0.0] * (n + 1)
        for i in range(n, 0, -1):
            below[i] = above[i] + held.get(i, 0.0)
            middle = (i - 0.5) * piece
            inertia = wall["m_w"] / n * (turn * middle + a_g - self.scene["g"] * theta)
            above[i - 1] = below[i] + inertia
            moments[i - 1] = moments[i] + (below[i] + inertia / 2) * piece
        moments = [moments[i] + width * (1 - i / n) for i in range(n + 1)]
        return self._named(above, below, moments)


def ground_acceleration(scene: Scene, t: float) -> float:
    """Return the acceleration of the ground, linear between the samples [m/s2]."""
    a, place = scene["a"], t / scene["dt"]
    i = int(place + 1e-9)
    return a[i] + (place - i) * (a[i + 1] - a[i]) if i + 1 < len(a) else a[-1]


if __name__ == "__main__":
    main()
