"""Arguments of a design from the group `&design` of its case."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rwmf._sweep.sweep_file import located
from rwmf.case import Case
from rwmf.errors import InputError

__all__ = ["DESIGNS", "DesignRequest", "request_of"]

# designs of the first stage without the group
DESIGNS = 300
_PERCENTILE = 84.0


@dataclass(frozen=True)
class DesignRequest:
    """Arguments of `rwmf.design` that a case gives.

    Attributes
    ----------
    bounds : dict of str to (float, float)
        Lower and upper bound by key.
    targets : tuple of dict
        Limits of the case, and the probability of collapse.
    cost : dict of str to float
        Weights by key.
    records : tuple of str
        Files or patterns from the current folder.
    left_out : tuple of str or None
        Records that judge the design; None for every fourth one.
    unit : str or None
        Unit of the records.
    designs : int
        Number of designs of the first stage.
    """

    bounds: dict[str, tuple[float, float]]
    targets: tuple[dict[str, Any], ...]
    cost: dict[str, float]
    records: tuple[str, ...]
    left_out: tuple[str, ...] | None
    unit: str | None
    designs: int


def request_of(case: Case) -> DesignRequest | None:
    """Read the group `&design` of a case."""
    group = case.design
    if group is None:
        return None
    names = group.parameters
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"parameters: {twice[0]}: is given twice")
    targets: list[dict[str, Any]] = []
    if case.limits is not None:
        share: dict[str, Any] = {"percentile": group.get("percentile", _PERCENTILE)}
        if "probability" in group:
            share = {"probability": group.probability}
        targets.append({"quantity": "limits"} | share)
    if "collapse_probability" in group:
        targets.append(
            {"quantity": "collapse", "probability": group.collapse_probability}
            | {"scale": group.collapse_scale}
        )
    folder = Path(case.source or "").parent
    return DesignRequest(
        dict(zip(names, zip(group.low, group.high, strict=True), strict=True)),
        tuple(targets),
        dict(zip(names, group.cost, strict=True)),
        tuple(located(folder, word) for word in (group.records if "records" in group else ())),
        tuple(located(folder, word) for word in group.left_out) if "left_out" in group else None,
        group.unit if "unit" in group else None,
        group.designs,
    )
