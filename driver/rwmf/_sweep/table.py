"""The table of a sweep over points: numbers and scenes of its rows, identified by a checksum."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt

__all__ = ["POINT", "Table"]

# name of the dimension
POINT = "point"


@dataclass(frozen=True, eq=False)
class Table:
    """What differs from point to point.

    Attributes
    ----------
    columns : dict of str to numpy.ndarray, each shape (points,)
        Numbers by the names of their coordinates.
    scenes : numpy.ndarray, shape (points,)
        Number of each point's scene, in the order of their first points.
    """

    columns: dict[str, npt.NDArray[np.float64]]
    scenes: npt.NDArray[np.uint32]

    def to_bytes(self) -> bytes:
        """Write the scenes, then the columns in their order.

        Returns
        -------
        bytes
            Numbers of four and eight bytes, the lowest byte first.
        """
        columns = [column.astype("<f8", copy=False).tobytes() for column in self.columns.values()]
        return b"".join([self.scenes.astype("<u4", copy=False).tobytes(), *columns])

    @classmethod
    def from_bytes(cls, content: bytes, n: int, names: Sequence[str]) -> Self:
        """Read what `to_bytes` wrote.

        Parameters
        ----------
        content : bytes
            From `to_bytes`.
        n : int
            Number of points.
        names : sequence of str
            Names of the columns.

        Returns
        -------
        Table
            The table.
        """
        columns = {
            name: np.frombuffer(content, "<f8", n, 4 * n + 8 * n * i)
            for i, name in enumerate(names)
        }
        return cls(columns, np.frombuffer(content, "<u4", n))

    @functools.cached_property
    def sha256(self) -> str:
        """Checksum of all its bytes."""
        return hashlib.sha256(self.to_bytes()).hexdigest()
