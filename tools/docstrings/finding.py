"""What is missing in a docstring."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

__all__ = ["Finding"]


class Finding(NamedTuple):
    """One thing that a docstring does not say.

    Attributes
    ----------
    path : path
        File.
    line : int
        Where the procedure, argument or component is declared.
    text : str
        Its name, and what is missing.
    """

    path: Path
    line: int
    text: str
