"""Numbers of a case from dimensions and materials: steel plates, footings, concrete, the base."""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.case.sections import base_section, fatigue_cycles, footing, toe, ufp

__all__ = [
    "base_section",
    "fatigue_cycles",
    "footing",
    "toe",
    "ufp",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("sections")
