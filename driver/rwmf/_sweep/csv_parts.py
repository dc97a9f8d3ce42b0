"""Merging of spectrum parts from the batch program into one CSV file."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

from rwmf._files import files
from rwmf.case.namelist import read_text
from rwmf.errors import InputError

__all__ = ["merge_csv"]

# line below the version, written by rwmf-batch --part
_PART = re.compile(r"# part (\d{1,9})/(\d{1,9})$")


@dataclass(frozen=True)
class _Part:
    """One file: its number, the lines common to all parts, its lines of numbers."""

    path: str
    k: int
    n: int
    head: tuple[str, ...]
    rows: tuple[str, ...]


def merge_csv(parts: Sequence[str | os.PathLike[str]], file: str | os.PathLike[str]) -> None:
    """Join the parts of a spectrum into the file of an undivided run, byte for byte."""
    found = sorted((_read(os.fspath(path)) for path in parts), key=lambda part: part.k)
    first = found[0]
    for part in found:
        if (part.n, part.head) != (first.n, first.head):
            raise InputError(f"{part.path}: is not a part of the same case as {first.path}")
    if [part.k for part in found] != list(range(1, first.n + 1)):
        given = ", ".join(str(part.k) for part in found)
        raise InputError(f"merge: needs the parts 1 to {first.n} once each, has {given}")
    text = "".join([*first.head, *_interleave(found)])
    files.check_outputs([file], parts)
    files.write_bytes(file, text.encode("utf-8", "surrogateescape"))


def _read(path: str) -> _Part:
    lines = [f"{line}\n" for line in read_text(path).removesuffix("\n").split("\n")]
    marks = [i for i, line in enumerate(lines) if _PART.match(line.rstrip("\n"))]
    if len(marks) != 1:
        raise InputError(f"{path}: is not written by rwmf-batch --part K/N")
    match = _PART.match(lines.pop(marks[0]).rstrip("\n"))
    heads = [i for i, line in enumerate(lines) if not line.startswith("#")]
    start = heads[0] + 1 if heads else len(lines)
    k, n = (int(word) for word in match.groups()) if match else (0, 0)
    return _Part(path, k, n, tuple(lines[:start]), tuple(lines[start:]))


def _interleave(parts: list[_Part]) -> list[str]:
    """Return the rows of an undivided run: periods were dealt to the parts in turn."""
    curves = [_curves(part) for part in parts]
    if len({len(found) for found in curves}) > 1:
        raise InputError("merge: the parts do not have the same mass ratios and widths")
    rows: list[str] = []
    for same in zip(*curves, strict=True):
        # the first parts may have one period more
        for turn in range(len(same[0])):
            rows += [curve[turn] for curve in same if turn < len(curve)]
    return rows


def _curves(part: _Part) -> list[list[str]]:
    """Return the rows grouped by width and mass ratio, the columns before the period."""
    names = part.head[-1].rstrip("\n").split(",")
    n = names.index("T_s_s") if "T_s_s" in names else 0
    curves: dict[tuple[str, ...], list[str]] = {}
    for row in part.rows:
        curves.setdefault(tuple(row.split(",")[:n]), []).append(row)
    return list(curves.values())
