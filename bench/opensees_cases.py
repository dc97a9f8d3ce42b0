"""The validation cases in OpenSees, the program that earthquake engineers use.

``python bench/opensees_cases.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/opensees/CASE.csv``. Needs the environment variable RWMF_OPENSEES, a Python that has
``openseespy`` from PyPI; it may be this one.

The wall is a frame of stiff corotational beams on corners without tension. The cable is a
corotational truss with an initial stress, the frame a mass on a spring. OpenSees gets neither the
kinematics of
rocking nor a restitution. The frame of six storeys has springs of Steel01 for the storeys, leaning
columns of corotational trusses, and modal damping.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import rwmf
from reproduce.engines import write
from reproduce.six_storeys import CASES as FRAMES
from reproduce.six_storeys import COLUMNS, FULL, VARIANTS, variant, write_peaks

Array = npt.NDArray[np.float64]

HERE = Path(__file__).resolve().parent / "opensees"
ROOT = HERE.parents[1]
WALLS = ("free", "block", "g5", "g1800", "disc")
AVERAGE_ACCELERATION = ("Newmark", 0.5, 0.25)


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation of a wall: none of them belongs to the structure.

    Attributes
    ----------
    corners : str
        ``pads``: springs without tension on pads of spring and dashpot; ``springs``: springs
        without tension on the ground, damped in proportion to their current stiffness.
    stiffness : float
        Of a pad, of each spring of ``springs`` and of the link [N/m].
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

    corners: str = "pads"
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


class NoOpenSeesError(Exception):
    """The environment names no Python with OpenSees."""


class EngineStoppedError(Exception):
    """OpenSees did not reach the end."""


def main() -> None:
    """Compute the cases that the command line names, all of them otherwise."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], epilog="example: python bench/opensees_cases.py g5"
    )
    words = (*WALLS, *FRAMES)
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"any of {', '.join(words)}")
    parser.add_argument("--out", type=Path, default=ROOT / "validation" / "opensees")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    try:
        for name in options.cases or words:
            started = time.perf_counter()
            (store_frame if name in FRAMES else store_wall)(name, options.out)
            print(f"{name}: {time.perf_counter() - started:.0f} s", flush=True)
    except NoOpenSeesError as error:
        sys.exit(str(error))


def store_wall(name: str, folder: Path) -> None:
    """Compute a wall and store its history."""
    case = rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")
    facts, history = compute_wall(case, Engine())
    write(folder / f"{name}.csv", facts, history)


def store_frame(name: str, folder: Path) -> None:
    """Compute all variants of a frame; store the history of the full one and the peaks of all."""
    case = rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")
    peaks = {}
    for words in VARIANTS:
        facts, rows, peaks[words] = compute_frame(variant(case, words), FrameEngine())
        if words == FULL:
            write(folder / f"{name}.csv", facts, rows, COLUMNS)
    write_peaks(folder / f"{name}_peaks.csv", peaks)


def compute_wall(case: rwmf.Case, engine: Engine) -> tuple[dict[str, Any], Array]:
    """Compute a wall with or without frame and cable."""
    found = ask("wall.py", wall_scene(case), asdict(engine))
    rows = np.array(found["rows"])
    standing = rows[np.abs(rows[:, 1]) > 1e-4, 6]
    slip = float(np.ptp(standing)) if standing.size else 0.0
    facts = {"engine": found["engine"], "slip_max_m": float(f"{slip:.3g}"), **asdict(engine)}
    return facts, rows[:, :6]


def compute_frame(case: rwmf.Case, engine: FrameEngine) -> tuple[dict[str, Any], Array, Array]:
    """Compute a frame of storeys."""
    found = ask("frame.py", frame_scene(case, engine), asdict(engine))
    facts = {"engine": found["engine"], **asdict(engine)}
    return facts, np.array(found["rows"]), np.array(found["peaks"])


def wall_scene(case: rwmf.Case) -> dict[str, Any]:
    """Return masses, sizes, spring, cable and pulse of a case with a wall."""
    wall, frame, cable = case.wall, None, None
    h, b, weight = wall.h, wall.b, wall.m_w * case.model.g
    if case.frame is not None:
        m_s, omega_s = case.frame.gamma * wall.m_w, 2 * math.pi / case.frame.T_s
        frame = {"m": m_s, "k": m_s * omega_s**2, "c": 2 * case.frame.xi_s * m_s * omega_s}
    alpha = math.atan2(b, h)
    if case.cable is not None:
        # about a corner, the middle of the top rises and moves sideways
        rise = 2 * h * math.cos(alpha) + b * math.sin(alpha)
        length = math.hypot(b * (1 - math.cos(alpha)) + 2 * h * math.sin(alpha), rise)
        gain = (case.cable.eta_alpha - case.cable.eta_0) * weight
        cable = {"stiffness": gain / (length - 2 * h), "force": case.cable.eta_0 * weight}
    return {
        "h": h,
        "b": b,
        "m_w": wall.m_w,
        "g": case.model.g,
        "frame": frame,
        "cable": cable,
        "theta_0": None if case.initial is None else case.initial.theta_over_alpha * alpha,
        "motion": _pulse(case),
        "t_end": case.solver.t_end,
    }


def _pulse(case: rwmf.Case) -> dict[str, Any] | None:
    motion = case.motion
    if motion.kind == "none":
        return None
    return {
        "a_max": motion.a_max_g * case.model.g,
        "period": 2 * math.pi / motion.omega_p,
        "cycles": motion.cycles if motion.kind == "sine" else 1.0,
        "cosine": motion.kind == "one_cosine",
    }


def frame_scene(case: rwmf.Case, engine: FrameEngine) -> dict[str, Any]:
    """Return masses, springs, strengths, weights and the ground motion of a bare frame."""
    storeys, motion = case.storeys, case.motion
    yielding, p_delta = case.yielding, case.p_delta
    if motion.kind == "record":
        t, a = np.loadtxt(case.inputs[1], delimiter=",", skiprows=5, unpack=True)
        dt, a, t_end = t[1] - t[0], a * motion.scale * case.model.g, t[-1]
    else:
        pulse, dt, t_end = _pulse(case), engine.dt, case.solver.t_end
        t = dt * np.arange(round(pulse["period"] / dt) + 1)
        a = np.append(pulse["a_max"] * np.sin(2 * math.pi * t / pulse["period"]), [0.0, 0.0])
    return {
        "g": case.model.g,
        "xi": case.frame.xi_s,
        "m": list(storeys.m_over_m_w),
        "k": list(storeys.k_over_m_w),
        "height": list(storeys.height),
        "u_y": None if yielding is None else list(yielding.storey_u_y),
        "hardening": None if yielding is None else yielding.hardening,
        "m_g_over_m_s": None if p_delta is None else p_delta.m_g_over_m_s,
        "dt": float(dt),
        "a": a.tolist(),
        "t_end": float(t_end),
    }


def ask(program: str, scene: dict[str, Any], engine: dict[str, Any]) -> dict[str, Any]:
    """Compute a scene by a program in the Python that has OpenSees."""
    python = os.environ.get("RWMF_OPENSEES")
    if not python:
        raise NoOpenSeesError("RWMF_OPENSEES names no Python that has openseespy")
    with tempfile.TemporaryDirectory() as place:
        answer = Path(place) / "answer.json"
        done = subprocess.run(
            [python, str(HERE / program), str(answer)],
            input=json.dumps({"scene": scene, "engine": engine}),
            text=True,
            capture_output=True,
            check=False,
        )
        if not answer.is_file():
            mark = "RuntimeError: "
            reasons = [line for line in done.stderr.splitlines() if line.startswith(mark)]
            why = reasons[-1].removeprefix(mark) if reasons else done.stderr[-2000:]
            raise EngineStoppedError(why)
        found = json.loads(answer.read_text(encoding="utf-8"))
    return {"engine": f"OpenSees {found['version']}", **found}


if __name__ == "__main__":
    main()
