"""How a motion can end before its time. These are results, not errors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

__all__ = ["ENDINGS", "ending_of"]

# as a status; the summary of a run has a logical of the same name where it can happen
ENDINGS = ("overturned", "collapsed")


def ending_of(summary: Mapping[str, Any]) -> str:
    """Tell how a run ended.

    Parameters
    ----------
    summary : mapping
        Its named scalars.

    Returns
    -------
    str
        'overturned', 'collapsed', or 'ok' at the end of its time.
    """
    return next((name for name in ENDINGS if summary.get(name)), "ok")
