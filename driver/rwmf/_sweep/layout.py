"""Dimensions, coordinates and chunks of a sweep, from which its file is written."""

from __future__ import annotations

import difflib
import functools
import hashlib
import itertools
import json
from dataclasses import dataclass, field, fields
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from rwmf._files.names import readable
from rwmf._sweep.axes import POINT, Coordinate, Scenes

__all__ = ["Layout", "Rows", "difference"]

Places = npt.NDArray[np.int64]
_SHOWN_LINES = 20
# separator between the text of a layout, which never contains it, and its columns
_END = b"\0"


class Rows(NamedTuple):
    """Runs of one chunk.

    Attributes
    ----------
    positions : tuple of numpy.ndarray, each shape (rows,)
        Positions along each dimension.
    places : numpy.ndarray, shape (rows,)
        Indices of the runs in the whole sweep, with the last dimension fastest.
    """

    positions: tuple[Places, ...]
    places: Places


@dataclass(frozen=True)
class Layout:
    """Shape and identity of a sweep.

    Runs with the same scene along each dimension differ in numbers only and form a group. A chunk
    is a part of a group: neighbours in the order of the dimensions.

    Attributes
    ----------
    version : str
        Version of the kernel.
    case : str
        Namelist text common to all runs.
    coordinates : tuple of Coordinate
        Labels of all dimensions.
    scene_of : dict of str to numpy.ndarray, each shape (positions,)
        Scene number of each position by name of the dimension, slowest dimension first; a single
        scene where the positions differ in numbers only.
    block : int
        Largest number of runs in a chunk.
    quantities : tuple of str
        Quantities stored for each run.
    motion_crc32 : str
        Checksum of the case's own record, '' without one.
    method : str
        Method of all runs, '' when they differ.
    warnings : str
        Conservation laws that some runs violate, in one line; '' for none.
    intensity : dict of str to str or float
        Attributes of the intensity that a factor on the ground motion sets; empty without one.
    """

    version: str
    case: str
    coordinates: tuple[Coordinate, ...]
    scene_of: dict[str, Scenes]
    block: int
    quantities: tuple[str, ...]
    motion_crc32: str = ""
    method: str = ""
    warnings: str = ""
    intensity: dict[str, str | float] = field(default_factory=dict)

    @property
    def dims(self) -> tuple[str, ...]:
        """Names of all dimensions."""
        return tuple(self.scene_of)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of all dimensions."""
        return tuple(map(len, self.scene_of.values()))

    @property
    def n_chunks(self) -> int:
        """Count the chunks."""
        return int(self._first_chunks[-1])

    @functools.cached_property
    def _members(self) -> list[tuple[Places, Places]]:
        """Return the positions along each dimension grouped by scene, and each scene's start."""
        found = []
        for scenes in self.scene_of.values():
            begins = np.concatenate([[0], np.cumsum(np.bincount(scenes))])
            found.append((np.argsort(scenes, kind="stable"), begins))
        return found

    @functools.cached_property
    def _first_chunks(self) -> Places:
        """Return the number of the first chunk of each group, and of all chunks."""
        sizes = np.ones(1, dtype=np.int64)
        for _, begins in self._members:
            sizes = np.multiply.outer(sizes, np.diff(begins)).ravel()
        return np.concatenate([[0], np.cumsum(-(-sizes // self.block))])

    def chunk_size(self, number: int) -> int:
        """Count the runs of a chunk."""
        _, start, stop = self._part(number)
        return stop - start

    def rows(self, number: int) -> Rows:
        """Find the runs of a chunk."""
        members, start, stop = self._part(number)
        rest = np.arange(start, stop)
        places = np.zeros(stop - start, dtype=np.int64)
        positions: list[Places] = []
        stride = 1
        for size, member in zip(reversed(self.shape), reversed(members), strict=True):
            rest, inside = np.divmod(rest, len(member))
            positions.insert(0, member[inside])
            places += stride * positions[0]
            stride *= size
        return Rows(tuple(positions), places)

    def _part(self, number: int) -> tuple[list[Places], int, int]:
        """Return a group's positions along each dimension, and a chunk's range in the group."""
        group = int(np.searchsorted(self._first_chunks, number, "right")) - 1
        first, following = self._first_chunks[group : group + 2].tolist()
        members: list[Places] = []
        for order, begins in reversed(self._members):
            group, scene = divmod(group, len(begins) - 1)
            members.insert(0, order[begins[scene] : begins[scene + 1]])
        # all chunks of a group have equal length
        size = 1
        for member in members:
            size *= len(member)
        n = following - first
        start, stop = (size * i // n for i in (number - first, number - first + 1))
        return members, start, stop

    def labels(self, item: Coordinate) -> npt.NDArray[Any]:
        """Return the labels of all positions of a dimension."""
        if isinstance(item.values, np.ndarray):
            return item.values
        values = np.array([readable(value) for value in item.values])
        return values[self.scene_of[item.dimension]]

    def to_text(self) -> str:
        """Convert the layout to JSON; equal texts mean equal sweeps."""
        found = {item.name: getattr(self, item.name) for item in fields(self)}
        found["coordinates"] = [_entry(item) for item in self.coordinates]
        del found["scene_of"]
        found["dimensions"] = [{"name": n, "size": len(s)} for n, s in self.scene_of.items()]
        found["table"] = self._sha256
        return json.dumps(found, indent=1, sort_keys=True)

    def _arrays(self) -> list[memoryview]:
        """Return the bytes of all scenes, then of all columns, in little-endian order."""
        columns = [item.values for item in self.coordinates if item.column]
        arrays = [np.ascontiguousarray(scenes, "<u4") for scenes in self.scene_of.values()]
        return [item.data.cast("B") for item in (*arrays, *(np.asarray(c, "<f8") for c in columns))]

    @functools.cached_property
    def _sha256(self) -> str:
        found = hashlib.sha256()
        for part in self._arrays():
            found.update(part)
        return found.hexdigest()

    def parts(self) -> list[bytes | memoryview]:
        """Return the bytes of text and columns without copying them."""
        return [self.to_text().encode(), _END, *self._arrays()]

    @classmethod
    def from_bytes(cls, content: bytes) -> Self:
        """Read the bytes of `parts`."""
        text, _, rest = content.partition(_END)
        found: dict[str, Any] = json.loads(text)
        del found["table"]
        place = 0

        def take(dtype: str, dimension: str) -> npt.NDArray[Any]:
            nonlocal place
            values = np.frombuffer(rest, dtype, sizes[dimension], place)
            place += values.nbytes
            return values

        sizes = {item["name"]: item["size"] for item in found.pop("dimensions")}
        found["scene_of"] = {name: take("<u4", name) for name in sizes}
        for entry in found["coordinates"]:
            has_column = entry["column"]
            entry["values"] = (
                take("<f8", entry["dimension"]) if has_column else tuple(entry["values"])
            )
        found["coordinates"] = tuple(Coordinate(**entry) for entry in found["coordinates"])
        found["quantities"] = tuple(found["quantities"])
        return cls(**found)

    @staticmethod
    def text_of(content: bytes) -> str:
        """Extract the text from the bytes of `parts`."""
        return content.partition(_END)[0].decode()


def _entry(item: Coordinate) -> dict[str, Any]:
    """Return the entry of a coordinate in the text."""
    values = list(item.values)
    if isinstance(item.values, np.ndarray):
        values = [] if item.dimension == POINT else item.values.tolist()
    return vars(item) | {"values": values}


def difference(old: str, new: str) -> str:
    """Show the difference of two layouts."""
    lines = difflib.unified_diff(_lines(old), _lines(new), lineterm="", n=0)
    changed = [line for line in lines if line[0] in "+-" and line[:3] not in ("---", "+++")]
    shown = list(itertools.islice(changed, _SHOWN_LINES))
    if len(changed) > len(shown):
        shown.append(f"... and {len(changed) - len(shown)} lines more")
    return "\n".join(shown)


def _lines(text: str) -> list[str]:
    """Return one line per value, and the case's text as in its namelist."""
    found = json.loads(text)
    lines: list[str] = found.pop("case").splitlines()
    for item in found.pop("coordinates"):
        lines.append(f"{item['name']} = {', '.join(str(value) for value in item['values'])}")
    lines.append(f"columns (SHA-256 of all) = {found.pop('table', '')}")
    return lines + [f"{key} = {value}" for key, value in sorted(found.items())]
