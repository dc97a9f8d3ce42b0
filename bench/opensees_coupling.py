"""Frames of OpenSeesPy coupled with a wall of rwmf, beside the kernel's own frames.

``python bench/opensees_coupling.py [SCENE ...]`` computes each scene with four steps, halved three
times, writes ``validation/opensees/coupling.csv`` and prints it as a table. It needs
``openseespy`` in the same Python (``rwmf[opensees]``).
"""

from __future__ import annotations

import csv
import importlib
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
import rwmf
from rwmf.export.si_building import Frame, Law, read_building

ROOT = Path(__file__).resolve().parents[1]
STORE = ROOT / "validation" / "opensees" / "coupling.csv"
WALL = (
    "&wall h = 5.0, b = 1.2, m_w = 40e3 / &impact rule = 'coupled' /"
    "&solver rtol = 1e-10, t_end = 4.0 /\n"
)
CABLE = "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss' /\n"
END = "&output reactions = .true. / &model formulation = 'exact' /\n"
BENDING = "&bending EI = 3e9, xi = 0.02, modes = 2 /\n"


def storeys(coupling: str) -> str:
    """Write three storeys."""
    springs = ", k_link = 5e6" if coupling == "springs" else ""
    return (
        "&frame xi_s = 0.03 / &storeys n = 3, m = 40e3, k = 40e6, height = 3.3333333333333335, "
        f"coupling = '{coupling}', distribution = 'linear'{springs} /\n"
    )


SCENES = {
    "one mass": WALL + "&frame T_s = 0.8, gamma = 3.0, xi_s = 0.04 /" + CABLE,
    "three storeys, wall at the roof": WALL + storeys("full") + CABLE,
    "three storeys, wall at every floor": WALL + storeys("every_floor") + CABLE,
    "yielding fuses, tendon that yields": WALL
    + storeys("full")
    + "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss', eta_y = 0.85 /"
    + "&fuse F_y = 40e3, k = 2e7, hardening = 0.02 /\n",
    "yielding columns, wall at the roof": WALL
    + storeys("full")
    + CABLE
    + "&yielding storey_u_y = 0.008, hardening = 0.05 /",
    "wall that bends at every floor, fuses": WALL
    + storeys("every_floor")
    + BENDING
    + "&fuse F_y = 40e3, k = 2e7, hardening = 0.02 /\n",
    "link springs at every floor": WALL + storeys("springs") + CABLE,
    "wall that bends, link springs": WALL + storeys("springs") + BENDING + CABLE,
}
T_END = 4.0
# interval of the samples [s], and the longest step
SAMPLES = 0.01
# interval of samples whose largest is the peak to 1e-6 [s]
FINE = 2e-4
STEPS = tuple(SAMPLES / 2**k for k in (1, 2, 3, 4, 5))
# four steps of each scene; the contacts of this one are a few ms apart
FINER = ("wall that bends, link springs",)
COMPARED_IMPACTS = 10


class Row(NamedTuple):
    """One coupling beside the kernel."""

    scene: str
    sensitivity: float
    dt_ms: float
    u_s_max_error: float
    impacts_error_ms: float
    history_error: float
    order: float
    us_per_step: float


def motion() -> rwmf.Motion:
    """Ground acceleration with two frequencies that ends after 2 s."""
    t = np.arange(0, T_END + 2 * SAMPLES, SAMPLES)
    a = 4.0 * np.sin(2 * np.pi * t / 0.9) + 2.0 * np.sin(2 * np.pi * t / 0.37)
    return rwmf.Motion(np.where(t < 2.0, a, 0.0), dt=SAMPLES, unit="m/s2")


def case_of(scene: str) -> rwmf.Case:
    """Make the case of a scene."""
    case = rwmf.Case.from_text(SCENES[scene] + END)
    return case.replace(motion=motion())


def frame_of(case: rwmf.Case) -> Frame:
    """Return the frame that the kernel has beside the wall of a case."""
    frame = read_building(case.without("bending") if case.bending else case).frame
    assert frame is not None
    if not (case.bending and frame.coupling == "every_floor"):
        return frame
    # the floors of a wall that bends are damped in proportion to their stiffness
    k = [law.k for law in frame.laws]
    stiffness = np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    line = np.cumsum(frame.height)
    omega = np.sqrt(line @ stiffness @ line / (line @ (frame.m * line)))
    return replace(frame, c=2 * case.frame.xi_s / omega * stiffness)


def build(ops: ModuleType, frame: Frame) -> None:
    """Model the frame in OpenSees: floors 2, 3, ... above the ground, node 1."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.fix(1, 1)
    for i, law in enumerate(frame.laws):
        ops.node(i + 2, 0.0)
        ops.mass(i + 2, float(frame.m[i]))
        ops.uniaxialMaterial(*_material(i + 1, law))
        ops.element("zeroLength", i + 1, i + 1, i + 2, "-mat", i + 1, "-dir", 1)
    n = len(frame.laws)
    for i in range(n):
        for j in range(i, n):
            tag = 100 + n * i + j
            value = float(frame.c[i].sum() if i == j else -frame.c[i, j])
            ops.uniaxialMaterial("Elastic", tag, 0.0, value)
            ends = (i + 2, 1 if i == j else j + 2)
            ops.element("zeroLength", tag, *ends, "-mat", tag, "-dir", 1)
    given = motion()
    ops.timeSeries("Path", 1, "-dt", SAMPLES, "-values", *np.asarray(given.values).tolist())
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)


def _material(tag: int, law: Law) -> tuple[object, ...]:
    if np.isinf(law.force_y):
        return ("Elastic", tag, law.k)
    return ("Steel01", tag, law.force_y, law.k, float(law.values["hardening"]))


def roof_of(case: rwmf.Case, truth: rwmf.Response) -> tuple[np.ndarray, float]:
    """Return the displacements of the roof at the samples, and the largest [m]."""
    if case.storeys is None or case.storeys.coupling != "springs":
        return truth.u_s.values, float(truth.u_s_max)
    fine = rwmf.simulate(case, FINE).floors.values[:, -1]
    return truth.floors.values[:, -1], float(np.nanmax(np.abs(fine)))


def impacts_of(run: rwmf.Response) -> np.ndarray:
    """Return the times of the first impacts of a run [s]."""
    is_impact = run["event"].values == "impact"
    return np.asarray(run["event_time"].values[is_impact][:COMPARED_IMPACTS])


def compare(ops: ModuleType, scene: str) -> list[Row]:
    """Couple a scene with each step."""
    case = case_of(scene)
    frame = frame_of(case)
    truth = rwmf.simulate(case, SAMPLES)
    times, values = np.arange(len(motion().values)) * SAMPLES, np.asarray(motion().values)
    nodes = list(range(2, 2 + len(frame.laws)))
    roof, peak = roof_of(case, truth)
    heights = {"heights": np.cumsum(frame.height)} if frame.coupling == "every_floor" else {}
    nodes = nodes if frame.coupling in ("every_floor", "springs") else nodes[-1:]
    rows: list[Row] = []
    for dt in STEPS[1:] if scene in FINER else STEPS[:-1]:
        build(ops, frame)
        begun = time.perf_counter()
        host = rwmf.coupling.OpenSeesHost(ops, nodes)
        run = rwmf.coupling.couple(
            case, host, lambda t: float(np.interp(t, times, values)), dt, T_END, **heights
        )
        seconds = time.perf_counter() - begun
        history = np.interp(truth.time.values, run.t, run.u) - roof
        error = float(np.abs(history).max() / peak)
        ours = impacts_of(truth)
        theirs = np.array([event.t for event in run.events if event.kind == "impact"])
        impacts = (
            float(np.abs(theirs[: ours.size] - ours).max()) if theirs.size >= ours.size else np.nan
        )
        rows.append(
            Row(
                scene,
                float(truth["sensitivity_u_s_max"]),
                1e3 * dt,
                run.u_s_max / peak - 1,
                1e3 * impacts,
                error,
                np.log2(rows[-1].history_error / error) if rows else np.nan,
                1e6 * seconds / (T_END / dt),
            )
        )
        print(rows[-1], len(ours), len(theirs), run.energy, file=sys.stderr, flush=True)
    return rows


def read() -> list[Row]:
    """Read the stored rows."""
    with STORE.open(encoding="utf-8") as stream:
        return [Row(scene, *map(float, rest)) for scene, *rest in list(csv.reader(stream))[1:]]


def main() -> None:
    """Compute all scenes, or those given; print the table."""
    ops = importlib.import_module("openseespy.opensees")
    known = read() if STORE.is_file() else []
    stored = {scene: [row for row in known if row.scene == scene] for scene in SCENES}
    for scene in sys.argv[1:] or SCENES:
        stored[scene] = compare(ops, scene)
    rows = [row for scene in SCENES for row in stored[scene]]
    with STORE.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(Row._fields)
        for row in rows:
            numbers = {key: f"{x:.3g}" for key, x in row._asdict().items() if key != "scene"}
            numbers["dt_ms"] = f"{row.dt_ms:g}"
            writer.writerow([row.scene, *numbers.values()])
    print(table(rows))


def table(rows: list[Row]) -> str:
    """Write the rows as a table of a page."""
    lines = [
        "| scene | step [ms] | largest $u_s$ | first impacts [ms] | history of $u_s$ | order |",
        "|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {row.scene} | {row.dt_ms:g} | {row.u_s_max_error:.1e} | {row.impacts_error_ms:.1e} | "
        f"{row.history_error:.1e} | {'' if np.isnan(row.order) else f'{row.order:.2f}'} |"
        for row in rows
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
