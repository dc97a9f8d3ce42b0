"""What sweeps and studies do not take yet, said in one place."""

from __future__ import annotations

from rwmf.case import Case
from rwmf.errors import InputError

__all__ = ["refuse_storeys"]


def refuse_storeys(case: Case) -> None:
    """Refuse a case whose period and mass ratio are those of its storeys.

    Parameters
    ----------
    case : Case
        Of a sweep or a study.

    Raises
    ------
    InputError
        When the case has `&storeys`.
    """
    if "storeys" in case.groups:
        raise InputError(
            "&storeys: not taken by sweeps and studies yet, but for u_s_max of a frame alone over "
            "T_s: period and mass ratio follow from the storeys, which no axis sets"
        )
