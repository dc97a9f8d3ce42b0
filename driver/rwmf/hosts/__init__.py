"""Results of walls and elements that advance with a program of yours."""

from rwmf.hosts.element import ElementEvent, ElementResponse, ElementSnapshot
from rwmf.hosts.states import WallEvent, WallEvents, WallForces, WallMaxima, WallState
from rwmf.hosts.wall import WallSnapshot

__all__ = [
    "ElementEvent",
    "ElementResponse",
    "ElementSnapshot",
    "WallEvent",
    "WallEvents",
    "WallForces",
    "WallMaxima",
    "WallSnapshot",
    "WallState",
]
