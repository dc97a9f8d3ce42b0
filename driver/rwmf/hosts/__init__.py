"""Hosts: results of walls and elements that step with your program, and coupling with a frame.

::

    host = rwmf.hosts.OpenSeesHost(ops, nodes=[2])
    run = rwmf.hosts.couple(case, host, ground, dt=0.001, t_end=10.0)

`couple` owns the time loop: every step is iterated until wall and host agree on the force and the
motion of the link. Units are SI.
"""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.hosts.coupling import couple
from rwmf.hosts.element import ElementResponse
from rwmf.hosts.partner import FunctionHost, Host, OpenSeesHost
from rwmf.hosts.wall import WallEvent, WallState

__all__ = [
    "ElementResponse",
    "FunctionHost",
    "Host",
    "OpenSeesHost",
    "WallEvent",
    "WallState",
    "couple",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("hosts")
