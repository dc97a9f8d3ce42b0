"""Attributes that document the origin of a study's result."""

from __future__ import annotations

from rwmf import _library
from rwmf._files.names import readable
from rwmf.case import Case

__all__ = ["origin_of"]


def origin_of(case: Case) -> dict[str, str]:
    """Return the attributes that a study shares with a sweep."""
    return {
        "version": _library.version(),
        "case": readable(case.to_namelist()),
        "warnings": "\n".join(case.kernel.motion_warnings()),
    }
