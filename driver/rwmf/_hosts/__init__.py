"""Walls and elements inside a host program in Python."""

from rwmf._hosts.element import Element, ElementEvent, ElementResponse, ElementSnapshot
from rwmf._hosts.states import WallEvent, WallEvents, WallForces, WallMaxima, WallState
from rwmf._hosts.wall import Wall, Walls, WallSnapshot

__all__ = [
    "Element",
    "ElementEvent",
    "ElementResponse",
    "ElementSnapshot",
    "Wall",
    "WallEvent",
    "WallEvents",
    "WallForces",
    "WallMaxima",
    "WallSnapshot",
    "WallState",
    "Walls",
]
