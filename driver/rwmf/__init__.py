"""Dynamic response of post-tensioned rocking wall-moment frames.

Five lines from a case to a picture::

    import rwmf

    case = rwmf.Case.from_namelist("inputs/fig12_one_cosine.nml")
    history = rwmf.simulate(case, dt=0.01)
    spectrum = rwmf.spectrum(case, gamma=[5, 1800])
    rwmf.plot.spectrum(spectrum)
"""

from rwmf import loops, plot, studies
from rwmf._library import version as _kernel_version
from rwmf.case import Case
from rwmf.cost import Cost, cost
from rwmf.errors import InputError, Interrupted, NumericalError, OutputError, RwmfError
from rwmf.simulation import simulate
from rwmf.spectrum import spectrum
from rwmf.sweep import sweep

__all__ = [
    "Case",
    "Cost",
    "InputError",
    "Interrupted",
    "NumericalError",
    "OutputError",
    "RwmfError",
    "__version__",
    "cost",
    "loops",
    "plot",
    "simulate",
    "spectrum",
    "studies",
    "sweep",
]

__version__ = _kernel_version()
