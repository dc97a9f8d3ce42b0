"""A rocking wall in OpenSees: reads a scene as JSON, writes the history to a file as JSON.

``python wall.py FILE < SCENE`` is called by ``bench/opensees_cases.py`` with a Python that has
``openseespy``, and imports nothing else. The wall is a frame of stiff corotational beams with its
mass in the middle. Each corner of its base is in a groove of two springs without tension (ENT) at
right angles. They release the corner at lift-off and hold it in place under compression. The groove
is on a pad of spring and dashpot, which absorbs the impact. The corner can leave the pad, so that
the dashpot never pulls.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import openseespy.opensees as ops

Scene = dict[str, Any]

# nodes: base, corners, centroid, top, corner of the link; fixed nodes; pads; frame
BASE, LEFT, RIGHT, CENTROID, TOP, LINKED = 1, 2, 3, 4, 5, 6
GROUND, GROUND_LEFT, GROUND_RIGHT, PAD_LEFT, PAD_RIGHT = 11, 12, 13, 22, 23
FRAME, FRAME_BASE = 7, 17
# materials
NO_TENSION, PAD, CABLE, STRESSED, COLUMN, LINK = 1, 2, 3, 4, 5, 6
WALL = (BASE, LEFT, RIGHT, CENTROID, TOP, LINKED)


def main() -> None:
    """Compute the scene of the standard input."""
    given = json.load(sys.stdin)
    scene, engine = given["scene"], given["engine"]
    build_wall(scene, engine)
    build_corners(scene, engine)
    if scene["cable"] is not None:
        build_cable(scene)
    if scene["frame"] is not None:
        build_frame(scene, engine)
    prepare(scene, engine)
    answer = {"version": ops.version(), "rows": run(scene, engine)}
    Path(sys.argv[1]).write_text(json.dumps(answer), encoding="utf-8")


def build_wall(scene: Scene, engine: Scene) -> None:
    """Mass and rotational inertia of the wall on beams that hardly bend."""
    h, b, m = scene["h"], scene["b"], scene["m_w"]
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for node, (x, z) in places(scene).items():
        ops.node(node, x, z)
    for node, x in ((GROUND, 0.0), (GROUND_LEFT, -b), (GROUND_RIGHT, b)):
        ops.node(node, x, 0.0)
        ops.fix(node, 1, 1, 1)
    ops.mass(CENTROID, m, m, m * (h * h + b * b) / 3)
    ops.geomTransf("Corotational", 1)
    area = engine["stiffness"] * engine["beam_ratio"] * b
    pairs = ((BASE, LEFT), (BASE, RIGHT), (BASE, CENTROID), (CENTROID, TOP), (TOP, LINKED))
    for element, (i, j) in enumerate(pairs, start=1):
        ops.element("elasticBeamColumn", element, i, j, area, 1.0, area * b * b, 1)


def places(scene: Scene) -> dict[int, tuple[float, float]]:
    """Return the points of the upright wall, with the middle of its base at the origin."""
    h, b = scene["h"], scene["b"]
    return {
        BASE: (0.0, 0.0),
        LEFT: (-b, 0.0),
        RIGHT: (b, 0.0),
        CENTROID: (0.0, h),
        TOP: (0.0, 2 * h),
        LINKED: (-b, 2 * h),
    }


def build_corners(scene: Scene, engine: Scene) -> None:
    """No-tension corners on pads, or (springs) with damping by their current stiffness."""
    k, b = engine["stiffness"], scene["b"]
    # critical for the wall that falls flat on both corners
    delay = 2 * engine["damping_ratio"] / math.sqrt(2 * k / scene["m_w"])
    slope = math.sqrt(0.5)
    groove = ("-orient", slope, slope, 0.0, -slope, slope, 0.0)
    on_pads = engine["corners"] == "pads"
    ops.uniaxialMaterial("ENT", NO_TENSION, k * (engine["groove_ratio"] if on_pads else 1.0))
    ops.uniaxialMaterial("Elastic", PAD, k, k * delay)
    sides = ((LEFT, PAD_LEFT, GROUND_LEFT, -b), (RIGHT, PAD_RIGHT, GROUND_RIGHT, b))
    for corner, pad, ground, x in sides:
        below = ground
        if on_pads:
            below = pad
            ops.node(pad, x, 0.0)
            ops.fix(pad, 0, 0, 1)
            ops.element("zeroLength", 30 + corner, ground, pad, "-mat", PAD, PAD, "-dir", 1, 2)
        springs = ("-mat", NO_TENSION, NO_TENSION, "-dir", 1, 2, "-doRayleigh", 1)
        ops.element("zeroLength", 20 + corner, below, corner, *springs, *groove)
    if not on_pads and delay > 0:
        ops.region(1, "-ele", 20 + LEFT, 20 + RIGHT, "-rayleigh", 0.0, delay, 0.0, 0.0)


def build_cable(scene: Scene) -> None:
    """Tendon from the middle of the base to the middle of the top."""
    cable = scene["cable"]
    ops.uniaxialMaterial("Elastic", CABLE, cable["stiffness"] * 2 * scene["h"])
    ops.uniaxialMaterial("InitStressMaterial", STRESSED, CABLE, cable["force"])
    ops.element("corotTruss", 41, GROUND, TOP, 1.0, STRESSED)


def build_frame(scene: Scene, engine: Scene) -> None:
    """Mass on spring and dashpot, linked to the left top corner by a long stiff truss."""
    frame, length, k = scene["frame"], engine["link_length"], engine["stiffness"]
    x, z = -scene["b"] - length, 2 * scene["h"]
    ops.node(FRAME, x, z)
    ops.fix(FRAME, 0, 1, 1)
    ops.mass(FRAME, frame["m"], 0.0, 0.0)
    ops.node(FRAME_BASE, x, z)
    ops.fix(FRAME_BASE, 1, 1, 1)
    ops.uniaxialMaterial("Elastic", COLUMN, frame["k"], frame["c"])
    ops.element("zeroLength", 51, FRAME_BASE, FRAME, "-mat", COLUMN, "-dir", 1)
    # damping of the link against vibrations after an impact
    both = 1 / (1 / frame["m"] + 1 / scene["m_w"])
    ops.uniaxialMaterial("Elastic", LINK, k * length, 2 * math.sqrt(k * both) * length)
    ops.element("corotTruss", 52, FRAME, LINKED, 1.0, LINK)


def prepare(scene: Scene, engine: Scene) -> None:
    """Load the wall with its weight, or rotate it; then apply the ground motion."""
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(CENTROID, 0.0, -scene["m_w"] * scene["g"], 0.0)
    solver(("LoadControl", 1.0), "Static")
    if scene["theta_0"] is None:
        if ops.analyze(1) != 0:
            raise RuntimeError("the wall finds no rest")
    else:
        turn(scene)
    ops.wipeAnalysis()
    # the middle of a step is where the pulses jump: the sum over it has half of either side
    ops.setTime(-engine["dt"] / 2)
    if scene["motion"] is not None:
        pulse = scene["motion"]
        shift = math.pi / 2 if pulse["cosine"] else 0.0
        wave = (0.0, pulse["cycles"] * pulse["period"], pulse["period"])
        ops.timeSeries("Trig", 2, *wave, "-factor", pulse["a_max"], "-shift", shift)
        ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    solver(engine["integrator"], "Transient")


def turn(scene: Scene) -> None:
    """Rotate the wall about its right corner by the initial rotation."""
    theta, b = scene["theta_0"], scene["b"]
    sine, cosine = math.sin(theta), math.cos(theta)
    for node, (x, z) in places(scene).items():
        u = b + (x - b) * cosine + z * sine - x
        w = -(x - b) * sine + z * cosine - z
        for dof, value in enumerate((u, w, -theta), start=1):
            ops.setNodeDisp(node, dof, value, "-commit")


def solver(integrator: list[Any] | tuple[Any, ...], analysis: str) -> None:
    """Newton's method on the full matrix."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50, 0)
    ops.algorithm("Newton")
    ops.integrator(*integrator)
    ops.analysis(analysis)


def run(scene: Scene, engine: Scene) -> list[list[float]]:
    """Return the rows of the history: means of the steps before and after their instants."""
    dt = engine["dt"]
    each = round(engine["stored_interval"] / dt)
    rows = []
    for i in range(round(scene["t_end"] / engine["stored_interval"]) + 1):
        if i > 0:
            advance(each - 1, dt)
        before = observe(scene)
        advance(1, dt)
        after = observe(scene)
        mean = [(x + y) / 2 for x, y in zip(before, after, strict=True)]
        rows.append([i * engine["stored_interval"], *mean])
    return rows


def advance(steps: int, dt: float) -> None:
    """Make time steps."""
    if steps > 0 and ops.analyze(steps, dt) != 0:
        raise RuntimeError(f"no convergence at {ops.getTime():.3f} s")


def observe(scene: Scene) -> list[float]:
    """Return theta, theta', uplifts of the corners, u_s, and the place of the corner down."""
    theta = -ops.nodeDisp(CENTROID, 3)
    return [
        theta,
        -ops.nodeVel(CENTROID, 3),
        ops.nodeDisp(LEFT, 2),
        ops.nodeDisp(RIGHT, 2),
        ops.nodeDisp(FRAME, 1) if scene["frame"] is not None else math.nan,
        ops.nodeDisp(RIGHT if theta > 0 else LEFT, 1),
    ]


if __name__ == "__main__":
    main()
