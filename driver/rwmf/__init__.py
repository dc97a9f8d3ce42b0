"""Dynamic response of post-tensioned rocking wall-moment frames.

Five lines from a case to a picture::

    import rwmf

    case = rwmf.Case.from_namelist("inputs/fig12_one_cosine.nml")
    history = rwmf.simulate(case, dt=0.01)
    spectrum = rwmf.spectrum(case, gamma=[5, 1800])
    rwmf.plot.spectrum(spectrum)

Modules are imported at the first use of a name.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rwmf import coupling, hosts, loops, plot, records, sections, studies
    from rwmf._checks.checks import Checks, LimitCheck, checks
    from rwmf._cost import Cost, cost
    from rwmf._design.design import Design, design
    from rwmf._explore import explore
    from rwmf._gradient.gradient import gradient
    from rwmf._hosts import Element, Wall, Walls
    from rwmf._paper import paper_coefficients
    from rwmf._pushover import pushover
    from rwmf._response import Response
    from rwmf._risk import cloud, fragility, ida, risk, stripes
    from rwmf._simulation import simulate
    from rwmf._spectrum import spectrum
    from rwmf._sweep import RecordFile, find_records, merge, sweep
    from rwmf._sweep.intensity import intensity
    from rwmf.case import Case, Motion
    from rwmf.errors import (
        InputError,
        Interrupted,
        NumericalError,
        OutputError,
        RwmfError,
        RwmfWarning,
    )
    from rwmf.studies.statistics import quantile

    __version__: str

__all__ = [
    "Case", "Checks", "Cost", "Design", "Element", "InputError", "Interrupted", "LimitCheck",
    "Motion", "NumericalError", "OutputError", "RecordFile", "Response", "RwmfError",
    "RwmfWarning", "Wall", "Walls", "__version__", "checks", "cloud", "cost", "coupling",
    "design", "explore", "find_records", "fragility", "gradient", "hosts", "ida", "intensity",
    "loops", "merge", "paper_coefficients", "plot", "pushover", "quantile", "records", "risk",
    "sections", "simulate", "spectrum", "stripes", "studies", "sweep",
]  # fmt: skip
# public names of each module
_HOMES = {
    "_checks.checks": "Checks LimitCheck checks",
    "_cost": "Cost cost",
    "_design.design": "Design design",
    "_explore": "explore",
    "_gradient.gradient": "gradient",
    "_hosts": "Element Wall Walls",
    "_paper": "paper_coefficients",
    "_pushover": "pushover",
    "_response": "Response",
    "_risk": "cloud fragility ida risk stripes",
    "_simulation": "simulate",
    "_spectrum": "spectrum",
    "_sweep": "RecordFile find_records merge sweep",
    "_sweep.intensity": "intensity",
    "case": "Case Motion",
    "errors": "InputError Interrupted NumericalError OutputError RwmfError RwmfWarning",
    "studies.statistics": "quantile",
}


def __getattr__(name: str) -> object:
    """Import a public name at its first use."""
    homes = [module for module, names in _HOMES.items() if name in names.split()]
    if name == "__version__":
        found: object = import_module("rwmf._library").version()
    elif homes:
        found = getattr(import_module(f"rwmf.{homes[0]}"), name)
    elif name in __all__:
        found = import_module(f"rwmf.{name}")
    else:
        raise AttributeError(import_module("rwmf._renamed").moved(name))
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """List the public names."""
    return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
