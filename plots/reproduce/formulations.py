"""The two forms of the model in every figure, and possible contents of the lost Table 1."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

__all__ = ["ETAS", "EXACT", "FORMULATIONS", "PUBLISHED", "SHIPPED_ETAS", "Changes", "Formulation"]

Changes = Mapping[str, Mapping[str, object] | None]


@dataclass(frozen=True, eq=False)
class Formulation:
    """A formulation with its rule of restitution.

    Attributes
    ----------
    key : str
        Short name.
    label : str
        Name in a legend.
    changes : mapping
        Keys to replace in a shipped case.
    """

    key: str
    label: str
    changes: Changes


PUBLISHED = Formulation("published", "as published, e = 0.9", MappingProxyType({}))
EXACT = Formulation(
    "exact",
    "exact, momentum balance",
    MappingProxyType(
        {
            "model": {"formulation": "exact"},
            "impact": {"rule": "coupled", "e": None},
        }
    ),
)
FORMULATIONS = (PUBLISHED, EXACT)

# eta_0 and eta_alpha: from no cable to one that prestresses the wall with five times its weight
ETAS = ((0.0, 0.0), (1.0, 1.0), (1.0, 5.0), (0.5, 20.0), (5.0, 50.0))
# those of the shipped cases
SHIPPED_ETAS = (1.0, 5.0)
