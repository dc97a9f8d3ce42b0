"""Numbers of a case from dimensions and materials: steel plates, footings, concrete, the base."""

from rwmf.case.sections import Footing, Plate, Toe, base_section, fatigue_cycles, footing, toe, ufp

__all__ = [
    "Footing",
    "Plate",
    "Toe",
    "base_section",
    "fatigue_cycles",
    "footing",
    "toe",
    "ufp",
]
