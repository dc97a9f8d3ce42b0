"""Coupling of the wall with a frame that another program integrates.

::

    host = rwmf.coupling.OpenSeesHost(ops, nodes=[2])
    run = rwmf.coupling.couple(case, host, ground, dt=0.001, t_end=10.0)

`couple` owns the time loop: every step is iterated until wall and host agree on the force and the
motion of the link. Units are SI.
"""

from rwmf.hosts.couple import couple
from rwmf.hosts.opensees_host import OpenSeesHost
from rwmf.hosts.partner import CoupledRun, CouplingEnergy, FunctionHost, Host

__all__ = [
    "CoupledRun",
    "CouplingEnergy",
    "FunctionHost",
    "Host",
    "OpenSeesHost",
    "couple",
]
