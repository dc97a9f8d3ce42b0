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
    from rwmf import hosts, plot, records, sections, studies
    from rwmf.assess.analyses import cloud, ida, stripes
    from rwmf.assess.annual import risk
    from rwmf.assess.cost import cost
    from rwmf.assess.design import design
    from rwmf.assess.fragility_curves import fragility
    from rwmf.assess.gradient import gradient
    from rwmf.assess.table import quantile
    from rwmf.case import Case, Motion
    from rwmf.errors import (
        InputError,
        Interrupted,
        NumericalError,
        OutputError,
        RwmfError,
        RwmfWarning,
    )
    from rwmf.explorer import explore
    from rwmf.hosts.element import Element
    from rwmf.hosts.wall import Wall, Walls
    from rwmf.run.checks import checks
    from rwmf.run.pushover import pushover
    from rwmf.run.response import Response
    from rwmf.run.simulation import simulate
    from rwmf.run.spectrum import spectrum
    from rwmf.sweeps.computation import sweep

    __version__: str

__all__ = [
    "Case", "Element", "InputError", "Interrupted", "Motion", "NumericalError", "OutputError",
    "Response", "RwmfError", "RwmfWarning", "Wall", "Walls", "__version__", "checks", "cloud",
    "cost", "design", "explore", "fragility", "gradient", "hosts", "ida", "plot", "pushover",
    "quantile", "records", "risk", "sections", "simulate", "spectrum", "stripes", "studies",
    "sweep",
]  # fmt: skip
# public names of each module
_HOMES = {
    "assess.analyses": "cloud ida stripes",
    "assess.annual": "risk",
    "assess.cost": "cost",
    "assess.design": "design",
    "assess.fragility_curves": "fragility",
    "assess.gradient": "gradient",
    "assess.table": "quantile",
    "case": "Case Motion",
    "errors": "InputError Interrupted NumericalError OutputError RwmfError RwmfWarning",
    "explorer": "explore",
    "hosts.element": "Element",
    "hosts.wall": "Wall Walls",
    "run.checks": "checks",
    "run.pushover": "pushover",
    "run.response": "Response",
    "run.simulation": "simulate",
    "run.spectrum": "spectrum",
    "sweeps.computation": "sweep",
}


def __getattr__(name: str) -> object:
    """Import a public name at its first use."""
    homes = [module for module, names in _HOMES.items() if name in names.split()]
    if name == "__version__":
        found: object = import_module("rwmf.kernel.tables").version()
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
