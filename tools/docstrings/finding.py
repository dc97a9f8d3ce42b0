"""Finding of a missing item in a docstring."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

__all__ = ["Finding"]


class Finding(NamedTuple):
    """A missing item of a docstring.

    Attributes
    ----------
    path : path
        File.
    line : int
        Line of the declaration of the procedure, argument or component.
    text : str
        Its name, and the missing item.
    """

    path: Path
    line: int
    text: str
