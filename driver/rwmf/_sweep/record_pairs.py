"""Horizontal pairs and vertical components of one station."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rwmf._arguments import checked
from rwmf._records.reader import VERTICAL, component_of
from rwmf._sweep.record_sets import RecordFile, components
from rwmf.case import Motion
from rwmf.errors import InputError


@dataclass(frozen=True)
class RecordPair:
    """Components of a record.

    Attributes
    ----------
    name : str
        Name of the record.
    first, second : RecordFile
        Its horizontal components.
    vertical : RecordFile, optional
        Its vertical component.
    """

    name: str
    first: RecordFile
    second: RecordFile
    vertical: RecordFile | None = None


@checked
def pairs(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    folder: str | os.PathLike[str] = "",
    unit: str | None = None,
    dt: float | None = None,
) -> tuple[RecordPair, ...]:
    """Group components into horizontal pairs, with the vertical component where there is one.

    Components belong together by the row of a list, by their file, or by the names of PEER, ESM,
    K-NET and KiK-net. Other names end in ``_x``, ``_y``, ``_z`` or ``-1``, ``-2``, ``-3``.

    Parameters
    ----------
    words : iterable of str, path, RecordFile or Motion
        As for `rwmf.find_records`.
    folder : str or path
        Folder of relative paths.
    unit : str, optional
        Unit of the samples of files that do not give it.
    dt : float, optional
        Sampling interval [s] of files of one column.

    Returns
    -------
    tuple of RecordPair
        In the order of their first components.

    Raises
    ------
    InputError
        When a record has another number of horizontal components than two.
    """
    groups: dict[tuple[str, str], list[tuple[str, RecordFile]]] = {}
    for record, title, direction in components(words, folder, unit, dt):
        path = Path(record.path)
        key, part = component_of(path.name if record.path else f"{record.name}.txt")
        if direction is not None:
            key, part = path.name, direction
        groups.setdefault((str(path.parent), title or key or path.parent.name), []).append(
            (part, record)
        )
    found = []
    for (_, name), members in groups.items():
        vertical = [record for part, record in members if part == VERTICAL]
        level = [record for part, record in members if part != VERTICAL]
        if len(level) != 2 or len(vertical) > 1:
            names = ", ".join(record.name for _, record in members)
            raise InputError(
                f"records: {name}: has {len(level)} horizontal and {len(vertical)} vertical "
                f"components ({names}): must be 2, and at most 1"
            )
        found.append(RecordPair(name, level[0], level[1], vertical[0] if vertical else None))
    return tuple(found)
