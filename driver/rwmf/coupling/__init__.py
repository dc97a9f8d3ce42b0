"""Coupling of the wall with a frame that another program integrates.

::

    host = rwmf.coupling.OpenSeesHost(ops, nodes=[2])
    run = rwmf.coupling.couple(case, host, ground, dt=0.001, t_end=10.0)

`couple` owns the time loop: every step is iterated until wall and host agree on the force and the
motion of the link. Units are SI.
"""

from rwmf.coupling.function_host import FunctionHost
from rwmf.coupling.host import CoupledRun, CouplingEnergy, Host
from rwmf.coupling.opensees_host import OpenSeesHost
from rwmf.coupling.pair import couple

__all__ = ["CoupledRun", "CouplingEnergy", "FunctionHost", "Host", "OpenSeesHost", "couple"]
