"""What a sweep is: dimensions, coordinates and chunks, enough to write its file."""

from __future__ import annotations

import difflib
import functools
import itertools
import json
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from rwmf._files.names import readable
from rwmf._sweep.axes import Coordinate
from rwmf._sweep.table import POINT, Table

__all__ = ["Dimension", "Layout", "Rows", "difference"]

Places = npt.NDArray[np.int64]
_SHOWN_LINES = 20
# between the text of a layout, which has none, and its table
_END = b"\0"


@dataclass(frozen=True)
class Dimension:
    """One dimension of a sweep.

    Attributes
    ----------
    name : str
        Its name.
    size : int
        Number of positions.
    scenes : int
        Different scenes of the positions: 1 when they differ in numbers alone.
    """

    name: str
    size: int
    scenes: int = 1


@dataclass(frozen=True)
class Rows:
    """Runs of one chunk.

    Attributes
    ----------
    scenes : tuple of int
        Number of their common scene along each dimension.
    positions : tuple of numpy.ndarray, each shape (rows,)
        Positions along each dimension.
    places : numpy.ndarray, shape (rows,)
        Where the runs stand in the whole, counted with the last dimension fastest.
    """

    scenes: tuple[int, ...]
    positions: tuple[Places, ...]
    places: Places


@dataclass(frozen=True)
class Layout:
    """Shape and identity of a sweep.

    All runs with the same scene along each dimension differ in numbers alone. They are a group,
    and a chunk is a part of one: neighbours in the order of the dimensions.

    Attributes
    ----------
    version : str
        Version of the kernel.
    case : str
        Namelist text of what all runs have in common.
    coordinates : tuple of Coordinate
        Labels of all dimensions.
    dimensions : tuple of Dimension
        The dimensions, slowest first.
    block : int
        Largest number of runs in a chunk.
    quantities : tuple of str
        What is kept of each run.
    motion_crc32 : str
        Checksum of the case's own record, '' without one.
    method : str
        How all runs are computed, '' when they differ in it.
    warnings : str
        What is not conserved in some of its runs, in one line; '' for nothing.
    intensity : dict of str to str or float
        Attributes that say what a factor on the ground motion is a level of; empty for a factor.
    table : Table, optional
        Of the points; the text has its checksum.
    """

    version: str
    case: str
    coordinates: tuple[Coordinate, ...]
    dimensions: tuple[Dimension, ...]
    block: int
    quantities: tuple[str, ...]
    motion_crc32: str = ""
    method: str = ""
    warnings: str = ""
    intensity: dict[str, str | float] = field(default_factory=dict)
    table: Table | None = None

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of all dimensions."""
        return tuple(item.name for item in self.dimensions)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of all dimensions."""
        return tuple(item.size for item in self.dimensions)

    @property
    def n_chunks(self) -> int:
        """Count the chunks."""
        return int(self._first_chunks[-1])

    @functools.cached_property
    def _members(self) -> list[tuple[Places, Places]]:
        """Positions along each dimension, those of a scene together; where each scene begins."""
        found = []
        for item in self.dimensions:
            order = np.arange(item.size)
            counts = np.full(item.scenes, item.size // item.scenes)
            if item.name == POINT and self.table is not None:
                order = np.argsort(self.table.scenes, kind="stable")
                counts = np.bincount(self.table.scenes, minlength=item.scenes)
            found.append((order, np.concatenate([[0], np.cumsum(counts)])))
        return found

    @functools.cached_property
    def _first_chunks(self) -> Places:
        """Number of the first chunk of each group, and of all chunks."""
        sizes = np.ones(1, dtype=np.int64)
        for _, begins in self._members:
            sizes = np.multiply.outer(sizes, np.diff(begins)).ravel()
        return np.concatenate([[0], np.cumsum(-(-sizes // self.block))])

    def chunk_size(self, number: int) -> int:
        """Count the runs of a chunk.

        Parameters
        ----------
        number : int
            Of the chunk.

        Returns
        -------
        int
            Their number.
        """
        _, _, start, stop = self._part(number)
        return stop - start

    def rows(self, number: int) -> Rows:
        """Find the runs of a chunk.

        Parameters
        ----------
        number : int
            Of the chunk.

        Returns
        -------
        Rows
            In the order of the chunk.
        """
        scenes, members, start, stop = self._part(number)
        rest = np.arange(start, stop)
        places = np.zeros(stop - start, dtype=np.int64)
        positions: list[Places] = []
        stride = 1
        for size, member in zip(reversed(self.shape), reversed(members), strict=True):
            rest, inside = np.divmod(rest, len(member))
            positions.insert(0, member[inside])
            places += stride * positions[0]
            stride *= size
        return Rows(scenes, tuple(positions), places)

    def _part(self, number: int) -> tuple[tuple[int, ...], list[Places], int, int]:
        """Scenes of a chunk's group, its positions along each dimension, the chunk's part of it."""
        group = int(np.searchsorted(self._first_chunks, number, "right")) - 1
        first, following = self._first_chunks[group : group + 2].tolist()
        scenes: list[int] = []
        for item in reversed(self.dimensions):
            group, scene = divmod(group, item.scenes)
            scenes.insert(0, scene)
        members = [
            order[begins[scene] : begins[scene + 1]]
            for scene, (order, begins) in zip(scenes, self._members, strict=True)
        ]
        # chunks of a group are equally long
        size = 1
        for member in members:
            size *= len(member)
        n = following - first
        start, stop = (size * i // n for i in (number - first, number - first + 1))
        return tuple(scenes), members, start, stop

    def labels(self, item: Coordinate) -> npt.NDArray[Any]:
        """Give the labels of all positions of a dimension.

        Parameters
        ----------
        item : Coordinate
            One of the layout's.

        Returns
        -------
        numpy.ndarray, shape (positions,)
            Numbers, or texts as UTF-8 can hold them.
        """
        if self.table is not None and item.name in self.table.columns:
            return self.table.columns[item.name]
        values = np.array([readable(value) for value in item.values])
        if self.table is None or item.dimension != POINT:
            return values
        return values[self.table.scenes]

    def to_text(self) -> str:
        """Write it as JSON; equal texts are equal sweeps.

        Returns
        -------
        str
            The text, of a table its checksum.
        """
        found = asdict(replace(self, table=None))
        found["table"] = "" if self.table is None else self.table.sha256
        return json.dumps(found, indent=1, sort_keys=True)

    def parts(self) -> list[bytes | memoryview]:
        """Give the bytes of text and table, which are not copied.

        Returns
        -------
        list of bytes or memoryview
            All that `from_bytes` needs, one behind the other.
        """
        text = self.to_text().encode()
        return [text] if self.table is None else [text, _END, *self.table.parts()]

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Read the bytes of `parts`.

        Parameters
        ----------
        content : bytes
            All parts, one behind the other.

        Returns
        -------
        Layout
            The layout.
        """
        text, _, rest = content.partition(_END)
        found: dict[str, Any] = json.loads(text)
        found["coordinates"] = tuple(
            Coordinate(**(entry | {"values": tuple(entry["values"])}))
            for entry in found["coordinates"]
        )
        found["dimensions"] = tuple(Dimension(**entry) for entry in found["dimensions"])
        found["quantities"] = tuple(found["quantities"])
        has_table = bool(found.pop("table"))
        layout = cls(**found)
        if not has_table:
            return layout
        names = [c.name for c in layout.coordinates if c.dimension == POINT and not c.values]
        size = dict(zip(layout.dims, layout.shape, strict=True))[POINT]
        return replace(layout, table=Table.from_bytes(rest, size, names))

    @staticmethod
    def text_of(content: bytes) -> str:
        """Take the text out of the bytes of `parts`.

        Parameters
        ----------
        content : bytes
            All parts, one behind the other.

        Returns
        -------
        str
            As `to_text`.
        """
        return content.partition(_END)[0].decode()


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
    lines.append(f"points (SHA-256 of their table) = {found.pop('table', '') or 'none'}")
    return lines + [f"{key} = {value}" for key, value in sorted(found.items())]
