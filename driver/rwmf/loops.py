"""Force-displacement loops of the springs in a case: frame or storeys, cable, fuses."""

from rwmf.figures.loops import Loop, draw, find_loops

__all__ = [
    "Loop",
    "draw",
    "find_loops",
]
