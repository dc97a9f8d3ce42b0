"""Pulse of a study: any kind, with variable amplitude and period; origin of results."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

from rwmf import _library
from rwmf._files.names import readable
from rwmf.case import Case
from rwmf.errors import InputError


def origin_of(case: Case) -> dict[str, str]:
    """Return the attributes that a study shares with a sweep."""
    return {
        "version": _library.version(),
        "case": readable(case.to_namelist()),
        "warnings": "\n".join(case.kernel.motion_warnings()),
    }


@dataclass(frozen=True)
class Pulse:
    """The pulse of a case.

    Attributes
    ----------
    case : Case
        The case.
    t_0 : float
        Beginning of the pulse [s].
    periods : float
        Duration of the pulse over its period T_p [-]; the shape is independent of T_p.
    """

    case: Case
    t_0: float
    periods: float

    @classmethod
    def of(cls, case: Case, study: str) -> Self:
        """Return the pulse of a case."""
        motion = case.motion
        if motion is None or motion.kind in ("record", "none"):
            raise InputError(f"{study}: the case needs a pulse in &motion")
        t_0 = float(motion.t_0)
        T_p = float(motion.T_p) if "T_p" in motion else 2 * math.pi / float(motion.omega_p)
        end = case.kernel.end_of_motion()
        return cls(case, t_0, (end - t_0) / T_p)

    def resized(self, a_max_g: float, T_p: float, follow: float) -> Case:
        """Return the case with another amplitude and period."""
        pulse = {"a_max_g": a_max_g, "v_p": None, "omega_p": None, "T_p": T_p}
        t_end = self.t_0 + self.periods * T_p + follow
        return self.case.replace(
            motion=pulse, solver={"t_end": t_end}, output={"conditioning": False}
        )
