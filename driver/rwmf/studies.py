"""Engineering studies: each computes a labelled dataset from a case."""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.assess.studies import equal_response, overturning_map, restitution, wall_effect
from rwmf.assess.table import demand_percentiles

__all__ = [
    "demand_percentiles",
    "equal_response",
    "overturning_map",
    "restitution",
    "wall_effect",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("studies")
