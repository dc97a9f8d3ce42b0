"""What the result of a study says about where it comes from."""

from __future__ import annotations

from rwmf import _library
from rwmf._files.names import readable
from rwmf.case import Case

__all__ = ["origin_of"]


def origin_of(case: Case) -> dict[str, str]:
    """Give the attributes that a sweep has as well.

    Parameters
    ----------
    case : Case
        Of the study.

    Returns
    -------
    dict of str to str
        Version of the kernel, text of the case, and what its user should know.
    """
    return {
        "version": _library.version(),
        "case": readable(case.to_namelist()),
        "warnings": "\n".join(case.kernel.warnings()),
    }
