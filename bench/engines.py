"""Parts that the programs beside rwmf share: numbers of a case, and the stored histories."""

import argparse
import math
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import rwmf
from common import ROOT, spent

Array = npt.NDArray[np.float64]


class Spring(NamedTuple):
    """Mass [kg], stiffness [N/m] and damping [N s/m] of a frame."""

    m: float
    k: float
    c: float


class Pulse(NamedTuple):
    """Amplitude [m/s2], angular frequency [rad/s] and cycles of a pulse, and its wave."""

    a_max: float
    omega: float
    cycles: float
    wave: Callable[[float], float]

    def at(self, t: float) -> float:
        """Return the acceleration of the ground by Eqs (16) and (17) [m/s2]."""
        inside = 0.0 <= t <= self.cycles * 2 * math.pi / self.omega
        return self.a_max * self.wave(self.omega * t) if inside else 0.0


def case_of(name: str) -> rwmf.Case:
    """Read a case of the validation."""
    return rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")


def frame_of(case: rwmf.Case) -> Spring | None:
    """Return the moment frame as mass, spring and dashpot."""
    if case.frame is None:
        return None
    m, omega = case.frame.gamma * case.wall.m_w, 2 * math.pi / case.frame.T_s
    return Spring(m, m * omega**2, 2 * case.frame.xi_s * m * omega)


def cable_of(case: rwmf.Case) -> tuple[float, float] | None:
    """Return stiffness [N/m] and force at rest [N] of the straight cable in the wall's axis.

    P(0) = eta_0 m_w g and P(alpha) = eta_alpha m_w g.
    """
    if case.cable is None:
        return None
    h, b, weight = case.wall.h, case.wall.b, case.wall.m_w * case.model.g
    alpha = math.atan2(b, h)
    # about a corner, the middle of the top rises and moves sideways
    rise = 2 * h * math.cos(alpha) + b * math.sin(alpha)
    length = math.hypot(b * (1 - math.cos(alpha)) + 2 * h * math.sin(alpha), rise)
    gain = (case.cable.eta_alpha - case.cable.eta_0) * weight
    return gain / (length - 2 * h), case.cable.eta_0 * weight


def pulse_of(case: rwmf.Case) -> Pulse | None:
    """Return the pulse of a case."""
    motion = case.motion
    if motion.kind == "none":
        return None
    cycles = motion.cycles if motion.kind == "sine" else 1.0
    wave = math.cos if motion.kind == "one_cosine" else math.sin
    return Pulse(motion.a_max_g * case.model.g, motion.omega_p, cycles, wave)


def slip(rows: Array) -> float:
    """Return the range of the place of the corner that is down [m], the last column, rounded.

    Only rows where the wall is clearly lifted count.
    """
    lifted = rows[np.abs(rows[:, 1]) > 1e-4, 6]
    return float(f"{np.ptp(lifted):.3g}") if lifted.size else 0.0


def store_cases(
    about: str | None, engine: str, cases: Iterable[str], store: Callable[[str, Path], None]
) -> None:
    """Compute the cases that the command line names, all of them otherwise, and store them."""
    parser = argparse.ArgumentParser(description=(about or "").partition("\n")[0])
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"any of {', '.join(cases)}")
    parser.add_argument("--out", type=Path, default=ROOT / "validation" / engine)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.cases or cases:
        seconds = spent(lambda name=name: store(name, options.out), time.perf_counter)
        print(f"{name}: {seconds:.0f} s", flush=True)
