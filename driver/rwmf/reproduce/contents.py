"""What the report and the pages of the documentation show: figures and tables."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rwmf.reproduce import tables
from rwmf.reproduce.benefit import benefit_table
from rwmf.reproduce.tables import Table
from rwmf.reproduce.workshop import Workshop

__all__ = ["Contents", "collect"]


@dataclass(frozen=True)
class Contents:
    """Figures and tables.

    Attributes
    ----------
    figures : dict of str to path
        Picture (PNG) of each figure by its name in the gallery.
    claims, verdicts, benefit, tolerances, differences, restitution, contact, engines : Table
        From `tables` and `benefit`.
    """

    figures: dict[str, Path]
    claims: Table
    verdicts: Table
    benefit: Table
    tolerances: Table
    differences: Table
    restitution: Table
    contact: Table
    engines: Table


def collect(work: Workshop, figures: dict[str, Path]) -> Contents:
    """Judge, compare and measure.

    Parameters
    ----------
    work : Workshop
        Where responses come from.
    figures : dict of str to path
        As `Contents` has it.

    Returns
    -------
    Contents
        The figures and all tables.

    Raises
    ------
    InputError, NumericalError, Interrupted
        As the simulations and the readers of histories.
    """
    claims = tables.claims_table(work)
    return Contents(
        figures=figures,
        claims=claims,
        verdicts=tables.verdicts_table(claims),
        benefit=benefit_table(work),
        tolerances=tables.tolerances_table(work),
        differences=tables.differences_table(work),
        restitution=tables.restitution_table(work),
        contact=tables.contact_table(work),
        engines=tables.engines_table(work),
    )
