"""Results of walls and elements that advance with a program of yours."""

from rwmf._hosts.element import ElementEvent, ElementResponse, ElementSnapshot
from rwmf._hosts.states import WallEvent, WallEvents, WallForces, WallMaxima, WallState
from rwmf._hosts.wall import WallSnapshot

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
