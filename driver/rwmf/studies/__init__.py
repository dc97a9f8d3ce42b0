"""Engineering studies: each computes a labelled dataset from a case."""

from typing import TYPE_CHECKING

from rwmf._renamed import moved
from rwmf._risk.table import demand_percentiles
from rwmf.studies.equal_response import equal_response
from rwmf.studies.overturning import overturning_map
from rwmf.studies.restitution import restitution
from rwmf.studies.wall_effect import wall_effect

__all__ = ["demand_percentiles", "equal_response", "overturning_map", "restitution", "wall_effect"]


if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Name the replacement of an earlier spelling."""
        raise AttributeError(moved(f"studies.{name}"))
