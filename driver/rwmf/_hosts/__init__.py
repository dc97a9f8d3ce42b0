"""Walls and elements inside a host program in Python."""

from rwmf._hosts.element import Element, ElementResponse
from rwmf._hosts.states import WallEvent, WallEvents, WallForces, WallMaxima, WallState
from rwmf._hosts.wall import Wall, Walls, WallSnapshot

__all__ = [
    "Element",
    "ElementResponse",
    "Wall",
    "WallEvent",
    "WallEvents",
    "WallForces",
    "WallMaxima",
    "WallSnapshot",
    "WallState",
    "Walls",
]
