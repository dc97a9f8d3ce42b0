"""A shear frame in OpenSees: reads a scene as JSON, writes the history to a file as JSON.

``python frame.py FILE < SCENE`` is called by ``bench/opensees_cases.py`` with a Python that has
``openseespy``, and imports nothing else. Each storey is a `twoNodeLink` of Steel01 or of an elastic
spring for its shear. Beside it a stiff `corotTruss` is the leaning column that carries the weight
above, whose geometry gives P-Delta. Damping is modal, of the modes without gravity.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import openseespy.opensees as ops

Scene = dict[str, Any]
COLUMN = 100  # material of the columns; those of the storeys have the number of the storey


def main() -> None:
    """Compute the scene of the standard input."""
    given = json.load(sys.stdin)
    scene, engine = given["scene"], given["engine"]
    build(scene, engine)
    damp(scene)
    load(scene)
    prepare(scene, engine)
    rows, peaks = run(scene, engine)
    answer = {"version": ops.version(), "rows": rows, "peaks": peaks}
    Path(sys.argv[1]).write_text(json.dumps(answer), encoding="utf-8")


def build(scene: Scene, engine: Scene) -> None:
    """Floors above each other, springs for the shear between them, and columns."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    ops.node(0, 0.0, 0.0)
    ops.fix(0, 1, 1)
    ops.uniaxialMaterial("Elastic", COLUMN, engine["column_ratio"] * max(scene["k"]))
    z = 0.0
    for i, (m, k, height) in enumerate(
        zip(scene["m"], scene["k"], scene["height"], strict=True), start=1
    ):
        z += height
        ops.node(i, 0.0, z)
        # negligible vertical mass; the eigenvalue solver does not accept zero
        ops.mass(i, m, 1e-6 * m)
        if scene["u_y"] is None:
            ops.uniaxialMaterial("Elastic", i, k)
        else:
            u_y = scene["u_y"][i - 1]
            ops.uniaxialMaterial("Steel01", i, k * u_y, k, scene["hardening"])
        ops.element("twoNodeLink", i, i - 1, i, "-mat", i, "-dir", 2)
        ops.element("corotTruss", COLUMN + i, i - 1, i, height, COLUMN)


def damp(scene: Scene) -> None:
    """Damping ratio of every mode; the frame has not been loaded yet."""
    ops.eigen(len(scene["m"]))
    ops.modalDamping(scene["xi"])


def load(scene: Scene) -> None:
    """Put the weights on the columns."""
    if scene["m_g_over_m_s"] is None:
        return
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    for i, m in enumerate(scene["m"], start=1):
        ops.load(i, 0.0, -scene["m_g_over_m_s"] * m * scene["g"])
    solver(("LoadControl", 1.0), "Static")
    if ops.analyze(1) != 0:
        raise RuntimeError("the columns do not carry the weights")
    ops.wipeAnalysis()


def prepare(scene: Scene, engine: Scene) -> None:
    """Set the ground in motion."""
    ops.setTime(0.0)
    ops.timeSeries("Path", 2, "-dt", scene["dt"], "-values", *scene["a"])
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    solver(engine["integrator"], "Transient")


def solver(integrator: list[Any] | tuple[Any, ...], analysis: str) -> None:
    """Newton's method on the full matrix."""
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 50, 0)
    ops.algorithm("Newton")
    ops.integrator(*integrator)
    ops.analysis(analysis)


def run(scene: Scene, engine: Scene) -> tuple[list[list[float]], list[float]]:
    """Return rows of time, drifts from the ground up and absolute accelerations in g; peaks."""
    dt, n = engine["dt"], len(scene["m"])
    stride = round(engine["stored_interval"] / dt)
    rows = [[0.0] * (2 * n + 1)]
    peaks = [0.0] * (2 * n)
    for step in range(1, round(scene["t_end"] / dt) + 1):
        if ops.analyze(1, dt) != 0:
            raise RuntimeError(f"no convergence at {ops.getTime():g} s")
        u = [ops.nodeDisp(i, 1) for i in range(n + 1)]
        values = [(u[i] - u[i - 1]) / scene["height"][i - 1] for i in range(1, n + 1)]
        ground = acceleration(scene, step * dt)
        values += [(ops.nodeAccel(i, 1) + ground) / scene["g"] for i in range(1, n + 1)]
        peaks = [max(peak, abs(value)) for peak, value in zip(peaks, values, strict=True)]
        if step % stride == 0:
            rows.append([step * dt, *values])
    return rows, peaks


def acceleration(scene: Scene, t: float) -> float:
    """Return the acceleration of the ground, linear between the samples [m/s2]."""
    a, place = scene["a"], t / scene["dt"]
    i = int(place + 1e-9)
    return a[i] + (place - i) * (a[i + 1] - a[i]) if i + 1 < len(a) else a[-1]


if __name__ == "__main__":
    main()
