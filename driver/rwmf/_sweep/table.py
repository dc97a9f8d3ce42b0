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

    def parts(self) -> list[memoryview]:
        """Give the bytes of the scenes, then those of the columns in their order.

        Returns
        -------
        list of memoryview
            Numbers of four and eight bytes, the lowest byte first.
        """
        arrays = [np.ascontiguousarray(column, "<f8") for column in self.columns.values()]
        return [np.ascontiguousarray(self.scenes, "<u4").data.cast("B")] + [
            array.data.cast("B") for array in arrays
        ]

    @classmethod
    def from_bytes(cls, content: bytes, n: int, names: Sequence[str]) -> Self:
        """Read the bytes of `parts`.

        Parameters
        ----------
        content : bytes
            All parts, one behind the other.
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
        found = hashlib.sha256()
        for part in self.parts():
            found.update(part)
        return found.hexdigest()
