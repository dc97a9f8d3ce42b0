"""Engineering studies: each computes a labelled dataset from a case."""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.assess.pulses import equal_response, overturning_map
from rwmf.assess.table import demand_percentiles
from rwmf.assess.wall_effect import restitution, wall_effect

__all__ = [
    "demand_percentiles",
    "equal_response",
    "overturning_map",
    "restitution",
    "wall_effect",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("studies")
