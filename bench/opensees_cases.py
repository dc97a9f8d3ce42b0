"""The validation cases in OpenSees, the program that earthquake engineers use.

``python bench/opensees_cases.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/opensees/CASE.csv``. Needs ``pip install '.[opensees]'``.

OpenSees gets neither the kinematics of rocking nor a restitution. The wall is a frame of stiff
corotational beams with its mass in the middle. Each corner of its base is in a groove of two
springs without tension (ENT) at right angles. They release the corner at lift-off and hold it in
place under compression. The groove is on a pad of spring and dashpot, which absorbs the impact. The
corner can leave the pad, so that the dashpot never pulls. The cable is a corotational truss with an
initial stress, the moment frame a mass on a spring.

The frame of six storeys has a `twoNodeLink` of Steel01 or of an elastic spring for the shear of
each storey. Beside it a stiff `corotTruss` is the leaning column that carries the weight above,
whose geometry gives P-Delta. Damping is modal, of the modes without gravity.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import openseespy.opensees as ops
import rwmf
from engines import Array, cable_of, case_of, frame_of, pulse_of, slip, store_cases
from reproduce.engines import write
from reproduce.six_storeys import CASES as FRAMES
from reproduce.six_storeys import COLUMNS, FULL, VARIANTS, variant, write_peaks

WALLS = ("free", "block", "g5", "g1800", "disc")
AVERAGE_ACCELERATION = ("Newmark", 0.5, 0.25)
# nodes: base, corners, centroid, top, corner of the link; fixed nodes; pads; frame
BASE, LEFT, RIGHT, CENTROID, TOP, LINKED = 1, 2, 3, 4, 5, 6
GROUND, GROUND_LEFT, GROUND_RIGHT, PAD_LEFT, PAD_RIGHT = 11, 12, 13, 22, 23
FRAME, FRAME_BASE = 7, 17
# materials
NO_TENSION, PAD, CABLE, STRESSED, SPRING, LINK, COLUMN = 1, 2, 3, 4, 5, 6, 100
SIDES = ((LEFT, PAD_LEFT, GROUND_LEFT), (RIGHT, PAD_RIGHT, GROUND_RIGHT))


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation of a wall: none of them belongs to the structure.

    Attributes
    ----------
    stiffness : float
        Of a pad and of the link [N/m].
    groove_ratio : float
        Stiffness of a spring without tension over that of its pad [-].
    damping_ratio : float
        Of the wall that moves vertically on both its corners [-].
    beam_ratio : float
        Axial stiffness of a beam as long as b over `stiffness` [-].
    link_length : float
        Length of the link from the left top corner to the frame [m].
    dt : float
        Time step [s].
    integrator : tuple
        Integrator of OpenSees and its parameters.
    stored_interval : float
        Interval of the stored history [s].
    """

    stiffness: float = 1e12
    groove_ratio: float = 100.0
    damping_ratio: float = 1.0
    beam_ratio: float = 1e4
    link_length: float = 100.0
    dt: float = 1e-5
    integrator: tuple[str | float, ...] = AVERAGE_ACCELERATION
    stored_interval: float = 2e-3


@dataclass(frozen=True)
class FrameEngine:
    """Numbers of the computation of a frame of storeys.

    Attributes
    ----------
    dt : float
        Time step [s].
    stored_interval : float
        Interval of the stored history [s].
    column_ratio : float
        Axial stiffness of the leaning columns over the largest of the storeys [-].
    integrator : tuple
        Integrator of OpenSees and its parameters.
    """

    dt: float = 1e-4
    stored_interval: float = 0.02
    column_ratio: float = 1e8
    integrator: tuple[str | float, ...] = AVERAGE_ACCELERATION


def begin(dofs: int) -> None:
    """Begin a plane model with so many degrees of freedom at a node."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", dofs)


def solver(integrator: Sequence[str | float], analysis: str, tolerance: float = 1e-10) -> None:
    """Newton's method on the full matrix."""
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", tolerance, 50, 0)
    ops.algorithm("Newton")
    ops.integrator(*integrator)
    ops.analysis(analysis)


def constant_load() -> None:
    """Let the loads that follow be constant."""
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)


def advance(steps: int, *dt: float) -> None:
    """Make steps, of a static analysis without `dt` [s]."""
    if steps > 0 and ops.analyze(steps, *dt) != 0:
        raise SystemExit(f"no convergence at {ops.getTime():g} s")


def shake(dt: float, a: Array) -> None:
    """Set the ground in motion by samples [m/s2], zero after the last."""
    ops.setTime(0.0)
    ops.timeSeries("Path", 2, "-dt", dt, "-values", *a.tolist())
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)


def version() -> str:
    """Return the name of the engine with its version."""
    return f"OpenSees {ops.version()}"


def compute_wall(case: rwmf.Case, engine: Engine) -> Array:
    """Return the history with the place of the corner down, with or without frame and cable."""
    _build_wall(case, engine)
    _build_corners(case, engine)
    k = engine.stiffness
    if cable := cable_of(case):
        # from the middle of the base to the middle of the top
        ops.uniaxialMaterial("Elastic", CABLE, cable[0] * 2 * case.wall.h)
        ops.uniaxialMaterial("InitStressMaterial", STRESSED, CABLE, cable[1])
        ops.element("corotTruss", 41, GROUND, TOP, 1.0, STRESSED)
    if frame := frame_of(case):
        # linked to the left top corner by a long stiff truss
        length = engine.link_length
        for node, fixed in ((FRAME, (0, 1, 1)), (FRAME_BASE, (1, 1, 1))):
            ops.node(node, -case.wall.b - length, 2 * case.wall.h)
            ops.fix(node, *fixed)
        ops.mass(FRAME, frame.m, 0.0, 0.0)
        ops.uniaxialMaterial("Elastic", SPRING, frame.k, frame.c)
        ops.element("zeroLength", 51, FRAME_BASE, FRAME, "-mat", SPRING, "-dir", 1)
        # damping of the link against vibrations after an impact
        both = 1 / (1 / frame.m + 1 / case.wall.m_w)
        ops.uniaxialMaterial("Elastic", LINK, k * length, 2 * math.sqrt(k * both) * length)
        ops.element("corotTruss", 52, FRAME, LINKED, 1.0, LINK)
    _prepare_wall(case, engine)
    dt, interval = engine.dt, engine.stored_interval
    rows = []
    for i in range(round(case.solver.t_end / interval) + 1):
        advance(round(interval / dt) - 1 if i else 0, dt)
        before = _observe(case)
        advance(1, dt)
        # means of the steps before and after an instant
        rows.append([i * interval, *np.mean([before, _observe(case)], axis=0)])
    return np.array(rows)


def _places(case: rwmf.Case) -> dict[int, tuple[float, float]]:
    """Return the points of the upright wall, with the middle of its base at the origin."""
    h, b = case.wall.h, case.wall.b
    return {BASE: (0.0, 0.0), LEFT: (-b, 0.0), RIGHT: (b, 0.0), CENTROID: (0.0, h),
            TOP: (0.0, 2 * h), LINKED: (-b, 2 * h)}  # fmt: skip


def _build_wall(case: rwmf.Case, engine: Engine) -> None:
    """Mass and rotational inertia of the wall on beams that hardly bend."""
    h, b, m = case.wall.h, case.wall.b, case.wall.m_w
    begin(3)
    for node, place in _places(case).items():
        ops.node(node, *place)
    for node, x in ((GROUND, 0.0), (GROUND_LEFT, -b), (GROUND_RIGHT, b)):
        ops.node(node, x, 0.0)
        ops.fix(node, 1, 1, 1)
    ops.mass(CENTROID, m, m, m * (h * h + b * b) / 3)
    ops.geomTransf("Corotational", 1)
    area = engine.stiffness * engine.beam_ratio * b
    pairs = ((BASE, LEFT), (BASE, RIGHT), (BASE, CENTROID), (CENTROID, TOP), (TOP, LINKED))
    for element, ends in enumerate(pairs, start=1):
        ops.element("elasticBeamColumn", element, *ends, area, 1.0, area * b * b, 1)


def _build_corners(case: rwmf.Case, engine: Engine) -> None:
    """No-tension corners on pads."""
    k, slope = engine.stiffness, math.sqrt(0.5)
    # critical for the wall that falls flat on both corners
    delay = 2 * engine.damping_ratio / math.sqrt(2 * k / case.wall.m_w)
    groove = ("-orient", slope, slope, 0.0, -slope, slope, 0.0)
    ops.uniaxialMaterial("ENT", NO_TENSION, k * engine.groove_ratio)
    ops.uniaxialMaterial("Elastic", PAD, k, k * delay)
    for corner, pad, ground in SIDES:
        ops.node(pad, *_places(case)[corner])
        ops.fix(pad, 0, 0, 1)
        ops.element("zeroLength", 30 + corner, ground, pad, "-mat", PAD, PAD, "-dir", 1, 2)
        springs = ("-mat", NO_TENSION, NO_TENSION, "-dir", 1, 2, "-doRayleigh", 1)
        ops.element("zeroLength", 20 + corner, pad, corner, *springs, *groove)


def _prepare_wall(case: rwmf.Case, engine: Engine) -> None:
    """Load the wall with its weight, or rotate it; then apply the ground motion."""
    constant_load()
    ops.load(CENTROID, 0.0, -case.wall.m_w * case.model.g, 0.0)
    solver(("LoadControl", 1.0), "Static")
    if case.initial is None:
        advance(1)
    else:
        b = case.wall.b
        theta = case.initial.theta_over_alpha * math.atan2(b, case.wall.h)
        sine, cosine = math.sin(theta), math.cos(theta)
        for node, (x, z) in _places(case).items():
            # about the right corner
            u = b + (x - b) * cosine + z * sine - x
            w = -(x - b) * sine + z * cosine - z
            for dof, value in enumerate((u, w, -theta), start=1):
                ops.setNodeDisp(node, dof, value, "-commit")
    ops.wipeAnalysis()
    # the middle of a step is where the pulses jump: the sum over it has half of either side
    ops.setTime(-engine.dt / 2)
    if pulse := pulse_of(case):
        period, shift = 2 * math.pi / pulse.omega, math.pi / 2 if pulse.wave is math.cos else 0.0
        ops.timeSeries("Trig", 2, 0.0, pulse.cycles * period, period, "-factor", pulse.a_max,
                       "-shift", shift)  # fmt: skip
        ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    solver(engine.integrator, "Transient")


def _observe(case: rwmf.Case) -> list[float]:
    """Return theta, theta', uplifts of the corners, u_s, and the place of the corner down."""
    theta = -ops.nodeDisp(CENTROID, 3)
    u_s = ops.nodeDisp(FRAME, 1) if case.frame is not None else math.nan
    down = ops.nodeDisp(RIGHT if theta > 0 else LEFT, 1)
    return [theta, -ops.nodeVel(CENTROID, 3), ops.nodeDisp(LEFT, 2), ops.nodeDisp(RIGHT, 2), u_s,
            down]  # fmt: skip


def compute_frame(case: rwmf.Case, engine: FrameEngine) -> tuple[Array, Array]:
    """Return rows of time, drifts from the ground up and absolute accelerations in g; peaks."""
    storeys, g, dt = case.storeys, case.model.g, engine.dt
    n = len(storeys.height)
    _build_frame(case, engine)
    if case.p_delta is not None:
        constant_load()
        for i, m in enumerate(storeys.m_over_m_w, start=1):
            ops.load(i, 0.0, -case.p_delta.m_g_over_m_s * m * g)
        solver(("LoadControl", 1.0), "Static", 1e-12)
        advance(1)
        ops.wipeAnalysis()
    if case.motion.kind == "record":
        t, a = np.loadtxt(case.inputs[1], delimiter=",", skiprows=5, unpack=True)
        a, t_end = a * case.motion.scale * g, t[-1]
    else:
        pulse, t_end = pulse_of(case), case.solver.t_end
        t = dt * np.arange(round(2 * math.pi / pulse.omega / dt) + 1)
        a = np.append(pulse.a_max * np.sin(pulse.omega * t), [0.0, 0.0])
    interval = float(t[1] - t[0])
    shake(interval, a)
    solver(engine.integrator, "Transient", 1e-12)
    stride = round(engine.stored_interval / dt)
    rows, peaks = [np.zeros(2 * n + 1)], np.zeros(2 * n)
    for step in range(1, round(t_end / dt) + 1):
        advance(1, dt)
        drifts = np.diff([ops.nodeDisp(i, 1) for i in range(n + 1)]) / storeys.height
        ground = np.interp(step * dt / interval, np.arange(a.size), a)
        floors = [(ops.nodeAccel(i, 1) + ground) / g for i in range(1, n + 1)]
        values = np.append(drifts, floors)
        peaks = np.maximum(peaks, abs(values))
        if step % stride == 0:
            rows.append(np.append(step * dt, values))
    return np.array(rows), peaks


def _build_frame(case: rwmf.Case, engine: FrameEngine) -> None:
    """Floors above each other, springs for the shear between them, and columns."""
    storeys, yielding, z = case.storeys, case.yielding, 0.0
    begin(2)
    ops.node(0, 0.0, 0.0)
    ops.fix(0, 1, 1)
    ops.uniaxialMaterial("Elastic", COLUMN, engine.column_ratio * max(storeys.k_over_m_w))
    rows = zip(storeys.m_over_m_w, storeys.k_over_m_w, storeys.height, strict=True)
    for i, (m, k, height) in enumerate(rows, start=1):
        z += height
        ops.node(i, 0.0, z)
        # negligible vertical mass; the eigenvalue solver does not accept zero
        ops.mass(i, m, 1e-6 * m)
        if yielding is None:
            ops.uniaxialMaterial("Elastic", i, k)
        else:
            f_y = k * yielding.storey_u_y[i - 1]
            ops.uniaxialMaterial("Steel01", i, f_y, k, yielding.hardening)
        ops.element("twoNodeLink", i, i - 1, i, "-mat", i, "-dir", 2)
        ops.element("corotTruss", COLUMN + i, i - 1, i, height, COLUMN)
    # of every mode; the frame has not been loaded yet
    ops.eigen(len(storeys.height))
    ops.modalDamping(case.frame.xi_s)


def _store(name: str, folder: Path) -> None:
    """Store a history: of a frame that of the full variant, and the peaks of all."""
    case, peaks = case_of(name), {}
    if name in WALLS:
        rows = compute_wall(case, Engine())
        facts = {"engine": version(), "slip_max_m": slip(rows), **asdict(Engine())}
        write(folder / f"{name}.csv", facts, rows[:, :6])
        return
    for words in VARIANTS:
        rows, peaks[words] = compute_frame(variant(case, words), FrameEngine())
        if words == FULL:
            facts = {"engine": version(), **asdict(FrameEngine())}
            write(folder / f"{name}.csv", facts, rows, COLUMNS)
    write_peaks(folder / f"{name}_peaks.csv", peaks)


if __name__ == "__main__":
    store_cases(__doc__, "opensees", (*WALLS, *FRAMES), _store)
