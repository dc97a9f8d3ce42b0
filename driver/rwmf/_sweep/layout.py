"""What a sweep is, as text: dimensions, coordinates and chunks, enough to write its file."""

from __future__ import annotations

import difflib
import itertools
import json
from dataclasses import asdict, dataclass
from typing import Any, Self

from rwmf._sweep.axes import Coordinate

__all__ = ["Layout", "difference"]

_SHOWN_LINES = 20


@dataclass(frozen=True)
class Layout:
    """Shape and identity of a sweep.

    Attributes
    ----------
    version : str
        Version of the kernel.
    case : str
        Namelist text of what all runs have in common.
    coordinates : tuple of Coordinate
        Labels of all dimensions.
    outer : tuple of (name, size)
        Dimensions that chunks are single points of, slowest first.
    inner : tuple of (name, size)
        Dimensions inside the chunks.
    block : int
        Largest extent of a chunk along the last inner dimension.
    quantities : tuple of str
        What is kept of each run.
    motion_crc32 : str
        Checksum of the case's own record, '' without one.
    warnings : str
        What is not conserved in some of its runs, in one line; '' for nothing.
    """

    version: str
    case: str
    coordinates: tuple[Coordinate, ...]
    outer: tuple[tuple[str, int], ...]
    inner: tuple[tuple[str, int], ...]
    block: int
    quantities: tuple[str, ...]
    motion_crc32: str = ""
    warnings: str = ""

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of all dimensions."""
        return tuple(name for name, _ in (*self.outer, *self.inner))

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of all dimensions."""
        return tuple(size for _, size in (*self.outer, *self.inner))

    @property
    def blocks(self) -> list[slice]:
        """Parts of the last inner dimension."""
        if not self.inner:
            return [slice(None)]
        size = self.inner[-1][1]
        return [slice(i, min(i + self.block, size)) for i in range(0, size, self.block)]

    @property
    def n_chunks(self) -> int:
        """Count the chunks."""
        n = len(self.blocks)
        for _, size in self.outer:
            n *= size
        return n

    def place(self, number: int) -> tuple[tuple[int, ...], slice]:
        """Return the positions along the outer dimensions, and the part of the last inner one.

        Parameters
        ----------
        number : int
            Of the chunk.

        Returns
        -------
        tuple of int
            Positions along the outer dimensions.
        slice
            Part of the last inner dimension.
        """
        number, block = divmod(number, len(self.blocks))
        positions = []
        for _, size in reversed(self.outer):
            number, position = divmod(number, size)
            positions.append(position)
        return tuple(reversed(positions)), self.blocks[block]

    def chunk_shape(self, number: int) -> tuple[int, ...]:
        """Shape of one chunk's arrays.

        Parameters
        ----------
        number : int
            Of the chunk.

        Returns
        -------
        tuple of int
            Sizes along the inner dimensions.
        """
        sizes = [size for _, size in self.inner]
        if sizes:
            part = self.place(number)[1]
            sizes[-1] = part.stop - part.start
        return tuple(sizes)

    def to_text(self) -> str:
        """Write it as JSON; equal texts are equal sweeps.

        Returns
        -------
        str
            The text.
        """
        return json.dumps(asdict(self), indent=1, sort_keys=True)

    @classmethod
    def from_text(cls, text: str) -> Self:
        """Read what `to_text` wrote.

        Parameters
        ----------
        text : str
            From `to_text`.

        Returns
        -------
        Layout
            The layout.
        """
        found: dict[str, Any] = json.loads(text)
        found["coordinates"] = tuple(
            Coordinate(**(entry | {"values": tuple(entry["values"])}))
            for entry in found["coordinates"]
        )
        for key in ("outer", "inner"):
            found[key] = tuple((name, size) for name, size in found[key])
        found["quantities"] = tuple(found["quantities"])
        return cls(**found)


def difference(old: str, new: str) -> str:
    """Show how two layouts differ.

    Parameters
    ----------
    old, new : str
        From `Layout.to_text`.

    Returns
    -------
    str
        Lines with '-' for the old and '+' for the new one, shortened.
    """
    lines = difflib.unified_diff(_lines(old), _lines(new), lineterm="", n=0)
    changed = [line for line in lines if line[0] in "+-" and line[:3] not in ("---", "+++")]
    shown = list(itertools.islice(changed, _SHOWN_LINES))
    if len(changed) > len(shown):
        shown.append(f"... and {len(changed) - len(shown)} lines more")
    return "\n".join(shown)


def _lines(text: str) -> list[str]:
    """Give one line a value; those of the case's text as in its namelist."""
    found = json.loads(text)
    lines: list[str] = found.pop("case").splitlines()
    for item in found.pop("coordinates"):
        lines.append(f"{item['name']} = {', '.join(str(value) for value in item['values'])}")
    return lines + [f"{key} = {value}" for key, value in sorted(found.items())]
