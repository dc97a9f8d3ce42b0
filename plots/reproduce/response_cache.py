"""Cache of the responses: every simulation runs once for all figures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import xarray as xr
from rwmf._simulation import simulate
from rwmf._spectrum import spectrum
from rwmf.case import Case

from reproduce.formulations import SHIPPED_ETAS, Changes, Formulation

__all__ = ["COARSE", "ResponseCache"]

# order 8 with adaptive steps: ten times faster than the default here, at the same accuracy
_METHOD = "dop853"
# four digits more than a figure or a verdict needs
_RTOL = 1e-8
# periods of bands, and of claims checked for several cables [s]
COARSE = tuple(float(T_s) for T_s in np.round(np.linspace(0.05, 3.0, 60), 10))


class ResponseCache:
    """Cases of the folder of inputs and their responses."""

    def __init__(
        self, inputs: Path, validation: Path, report: Callable[[str], None] | None = None
    ) -> None:
        self.inputs = inputs
        self.validation = validation
        self.report = report or (lambda _: None)
        self._results: dict[tuple[object, ...], xr.Dataset] = {}
        self._cases: dict[str, Case] = {}

    def case(
        self,
        name: str,
        form: Formulation,
        etas: tuple[float, float] = SHIPPED_ETAS,
        changes: Changes | None = None,
    ) -> Case:
        """Return a shipped case in one of the forms."""
        if name not in self._cases:
            self._cases[name] = Case.from_namelist(self.inputs / f"{name}.nml")
        case = self._cases[name].replace(
            solver={"method": _METHOD, "rtol": _RTOL},
            cable={"eta_0": etas[0], "eta_alpha": etas[1]},
            **form.changes,
        )
        return case.replace(**changes) if changes else case

    def history(
        self,
        name: str,
        form: Formulation,
        etas: tuple[float, float] = SHIPPED_ETAS,
        changes: Changes | None = None,
    ) -> xr.Dataset:
        """Simulate a shipped case; arguments as in `case`."""
        key = ("history", name, form.key, etas, repr(changes))
        if key not in self._results:
            self._results[key] = simulate(self.case(name, form, etas, changes))
        return self._results[key]

    def frame_alone(self, name: str) -> xr.Dataset:
        """Simulate the frame of a shipped case without its wall."""
        key = ("frame", name)
        if key not in self._results:
            case = Case.from_namelist(self.inputs / f"{name}.nml")
            removed = dict.fromkeys(("wall", "cable", "impact"))
            self._results[key] = simulate(case.replace(frame={"gamma": None}, **removed))
        return self._results[key]

    def spectrum(
        self,
        name: str,
        form: Formulation,
        etas: tuple[float, float] = SHIPPED_ETAS,
        T_s: tuple[float, ...] | None = None,
    ) -> xr.Dataset:
        """Compute the spectrum of a shipped case; T_s [s] as the case has it when absent."""
        key = ("spectrum", name, form.key, etas, T_s)
        if key not in self._results:
            case = self.case(name, form, etas)
            self._results[key] = spectrum(case, T_s=None if T_s is None else list(T_s))
        return self._results[key]

    def spectrum_alone(self, name: str, T_s: tuple[float, ...] | None = None) -> xr.Dataset:
        """Compute the spectrum of the frame without wall; T_s [s] as in `spectrum`."""
        key = ("spectrum alone", name, T_s)
        if key not in self._results:
            case = Case.from_namelist(self.inputs / f"{name}.nml")
            removed = dict.fromkeys(("wall", "cable", "impact"))
            bare = case.replace(
                frame={"gamma": None}, spectrum={"gamma": None, "b": None}, **removed
            )
            self._results[key] = spectrum(bare, T_s=None if T_s is None else list(T_s))
        return self._results[key]
