"""Responses of the shipped cases in both forms of the model: every simulation runs once."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

import numpy as np
import numpy.typing as npt
import xarray as xr
from rwmf import Case, simulate, spectrum, sweep

__all__ = ["COARSE", "ETAS", "EXACT", "FORMULATIONS", "PERIODS", "PUBLISHED", "SHIPPED_ETAS",
           "Array", "Changes", "Formulation", "Responses", "View"]  # fmt: skip

Array = npt.NDArray[np.float64]
Changes = Mapping[str, Mapping[str, object] | None]
_Kept = TypeVar("_Kept")


def _periods(first: float, n: int) -> tuple[float, ...]:
    return tuple(float(T_s) for T_s in np.round(np.linspace(first, 3.0, n), 10))


# order 8 with adaptive steps; four digits more than a figure or a verdict needs
_SOLVER = {"method": "dop853", "rtol": 1e-8}
# periods of bands, and of claims checked for several cables [s]
COARSE = _periods(0.05, 60)
# of the largest increments of the cable force [s]
PERIODS = _periods(0.2, 57)
# eta_0 and eta_alpha that the lost Table 1 may have held: from no cable to one that prestresses the
# wall with five times its weight
ETAS = ((0.0, 0.0), (1.0, 1.0), (1.0, 5.0), (0.5, 20.0), (5.0, 50.0))
# those of the shipped cases
SHIPPED_ETAS = (1.0, 5.0)


@dataclass(frozen=True, eq=False)
class Formulation:
    """A formulation with its rule of restitution.

    Attributes
    ----------
    label : str
        Name in a legend.
    changes : mapping
        Keys to replace in a shipped case.
    """

    label: str
    changes: Changes


PUBLISHED = Formulation("as published, e = 0.9", MappingProxyType({}))
EXACT = Formulation(
    "exact, momentum balance",
    MappingProxyType(
        {"model": {"formulation": "exact"}, "impact": {"rule": "coupled", "e": None}},
    ),
)
FORMULATIONS = (PUBLISHED, EXACT)


class Responses:
    """Cases of the folders of inputs and of the validation, and their responses."""

    def __init__(self, inputs: Path, validation: Path) -> None:
        self.inputs = inputs
        self.validation = validation
        self._results: dict[Hashable, object] = {}

    def keep(self, key: Hashable, make: Callable[[], _Kept]) -> _Kept:
        """Return what was made for a key, or make it."""
        if key not in self._results:
            self._results[key] = make()
        return self._results[key]  # type: ignore[return-value]

    def shipped(self, name: str) -> Case:
        """Read a case of the folder of inputs."""
        return self.keep(name, lambda: Case.from_namelist(self.inputs / f"{name}.nml"))

    def engine_case(self, name: str) -> Case:
        """Read a case of the validation."""
        return Case.from_namelist(self.validation / f"{name}.nml")

    def alone(self, name: str) -> xr.Dataset:
        """Simulate the frame of a shipped case without its wall."""
        return self.keep(("alone", name), lambda: simulate(self.shipped(name).without_wall()))

    def spectrum_alone(self, name: str, T_s: tuple[float, ...] | None = None) -> Array:
        """Return the largest displacements of the frame without wall [m]; T_s [s] as in `View`."""
        case = self.shipped(name).without_wall()
        found = self.keep(("alone", name, T_s), lambda: spectrum(case, T_s=T_s and list(T_s)))
        return np.asarray(found["u_s_max"].values)


@dataclass(frozen=True, eq=False)
class View:
    """Responses of the shipped cases in one form with one cable.

    Attributes
    ----------
    of : Responses
        The cases.
    form : Formulation
        The form of the model.
    etas : tuple of float
        eta_0 and eta_alpha of the cable.
    """

    of: Responses
    form: Formulation
    etas: tuple[float, float] = SHIPPED_ETAS

    def case(self, name: str) -> Case:
        """Return a shipped case."""
        cable = {"eta_0": self.etas[0], "eta_alpha": self.etas[1]}
        return self.of.shipped(name).replace(solver=_SOLVER, cable=cable, **self.form.changes)

    def history(self, name: str, *, reactions: bool = False) -> xr.Dataset:
        """Simulate a shipped case."""
        output = {"output": {"reactions": True}} if reactions else {}
        key = (name, self.form, self.etas, reactions)
        return self.of.keep(key, lambda: simulate(self.case(name).replace(**output)))

    def value(self, name: str, quantity: str) -> float:
        """Return a number of a history."""
        return float(self.history(name)[quantity])

    def engine_case(self, name: str) -> xr.Dataset:
        """Simulate a case of the validation."""
        case = self.of.engine_case(name)
        if self.form is PUBLISHED:
            linear = {"cable": {"law": "linear"}} if case.cable is not None else {}
            impact = {"rule": "constant", "e": 0.9}
            case = case.replace(model={"formulation": "published"}, impact=impact, **linear)
        return simulate(case)

    def spectrum(self, name: str, T_s: tuple[float, ...] | None = None) -> xr.Dataset:
        """Compute the spectrum of a shipped case; T_s [s] as the case has it when absent."""
        key = ("spectrum", name, self.form, self.etas, T_s)
        return self.of.keep(key, lambda: spectrum(self.case(name), T_s=T_s and list(T_s)))

    def peaks(self, name: str, gamma: float) -> Array:
        """Return the largest displacements over `COARSE` [m]; infinite where it overturns."""
        curve = self.spectrum(name, COARSE).isel(b=0).sel(gamma=gamma)
        return np.where(curve["status"].values == "overturned", np.inf, curve["u_s_max"].values)

    def increments(self, gamma: float) -> Array:
        """Return the largest increments of the cable force over the weight, over `PERIODS`."""
        key = "cable_force_increment_max_over_m_w_g"
        name = "fig11_cable_stiff_frame_heavy_wall"
        case = self.case(name).replace(frame={"gamma": gamma}, output=None)
        found = self.of.keep(
            ("increments", gamma, self.form, self.etas),
            lambda: sweep(case, points={"T_s": list(PERIODS)}, quantities=(key,)),
        )
        return np.asarray(found[key].values.ravel())
