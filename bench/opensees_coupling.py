"""Frames of OpenSeesPy coupled with a wall of rwmf, beside the kernel's own frames.

``python bench/opensees_coupling.py [SCENE ...]`` computes each scene with four steps, halved three
times, writes ``validation/opensees/coupling.csv`` and prints it as a table. It needs
``openseespy`` in the same Python (``rwmf[opensees]``).
"""

import importlib
import sys
from dataclasses import replace
from types import ModuleType
from typing import NamedTuple

import numpy as np
import rwmf
from common import ROOT, read_rows, table, write_rows
from rwmf.hosts.si_building import Building, Frame, Law

from exported_scenes import CABLE, FRAME, WALL  # isort: skip

STORE = ROOT / "validation" / "opensees" / "coupling.csv"
FUSES = "&fuse F_y = 40e3, k = 2e7, hardening = 0.02 /"
BENDING = "&bending EI = 3e9, xi = 0.02, modes = 2 /"
# three storeys
STOREYS = (
    "&frame xi_s = 0.03 / &storeys n = 3, m = 40e3, k = 40e6, height = 3.3333333333333335, "
    "distribution = 'linear', coupling = "
)
ROOF, FLOORS = f"{STOREYS}'full' /", f"{STOREYS}'every_floor' /"
SPRINGS = f"{STOREYS}'springs', k_link = 5e6 /"
SCENES = {
    "one mass": FRAME + CABLE,
    "three storeys, wall at the roof": ROOF + CABLE,
    "three storeys, wall at every floor": FLOORS + CABLE,
    "yielding fuses, tendon that yields": ROOF + CABLE.replace(" /", ", eta_y = 0.85 /") + FUSES,
    "yielding columns, wall at the roof": ROOF
    + CABLE
    + "&yielding storey_u_y = 0.008, hardening = 0.05 /",
    "wall that bends at every floor, fuses": FLOORS + BENDING + FUSES,
    "link springs at every floor": SPRINGS + CABLE,
    "wall that bends, link springs": SPRINGS + BENDING + CABLE,
}
END = """&solver rtol = 1e-10, t_end = 4.0 /
&output reactions = .true. / &model formulation = 'exact' /"""
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


def motion() -> rwmf.Motion:
    """Ground acceleration with two frequencies that ends after 2 s."""
    t = np.arange(0, T_END + 2 * SAMPLES, SAMPLES)
    a = 4.0 * np.sin(2 * np.pi * t / 0.9) + 2.0 * np.sin(2 * np.pi * t / 0.37)
    return rwmf.Motion(np.where(t < 2.0, a, 0.0), dt=SAMPLES, unit="m/s2")


def case_of(scene: str) -> rwmf.Case:
    """Make the case of a scene."""
    return rwmf.Case.from_text(WALL + SCENES[scene] + END).replace(motion=motion())


def frame_of(case: rwmf.Case) -> Frame:
    """Return the frame that the kernel has beside the wall of a case."""
    frame = Building(case.without("bending") if case.bending else case).frame
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
        host = rwmf.hosts.OpenSeesHost(ops, nodes)
        run = rwmf.hosts.couple(
            case, host, lambda t: float(np.interp(t, times, values)), dt, T_END, **heights
        )
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
            )
        )
        print(rows[-1], len(ours), len(theirs), run.energy, file=sys.stderr, flush=True)
    return rows


def main() -> None:
    """Compute all scenes, or those given; print the table."""
    ops = importlib.import_module("openseespy.opensees")
    kinds = (str, *[float] * (len(Row._fields) - 1))
    known = [Row(*row) for row in read_rows(STORE, kinds)]
    for scene in sys.argv[1:] or SCENES:
        known = [row for row in known if row.scene != scene] + compare(ops, scene)
    rows = sorted(known, key=lambda row: list(SCENES).index(row.scene))
    # steps have more than three digits
    write_rows(STORE, Row._fields, (row._replace(dt_ms=f"{row.dt_ms:g}") for row in rows))
    heads = (
        "scene",
        "step [ms]",
        "largest $u_s$",
        "first impacts [ms]",
        "history of $u_s$",
        "order",
    )
    cells = (
        (row.scene, f"{row.dt_ms:g}", f"{row.u_s_max_error:.1e}", f"{row.impacts_error_ms:.1e}",
         f"{row.history_error:.1e}", "" if np.isnan(row.order) else f"{row.order:.2f}")
        for row in rows
    )  # fmt: skip
    print(table(heads, cells))


if __name__ == "__main__":
    main()
