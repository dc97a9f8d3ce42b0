"""Formats of the kernel: AT2, one column, two columns; and tables of several components."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import cast

import numpy as np

from rwmf._records.channels import Channel, Values, free_numbers
from rwmf.case import Case, Motion
from rwmf.errors import InputError

__all__ = ["Header", "read_by_kernel", "read_header", "read_table"]

# separators, and the exponents of Fortran
_TO_PLAIN = str.maketrans({",": " ", ";": " ", "D": "E", "d": "e"})
_TIME = re.compile(r"t|time\b.*|t\W.*", re.IGNORECASE)
_BRACKETS = re.compile(r"[\[(](.*?)[\])]")
# unit as in a header, without powers and blanks: unit of a motion
_UNITS = {
    "g": "g",
    "m/s2": "m/s2",
    "m/s/s": "m/s2",
    "m/sec2": "m/s2",
    "cm/s2": "cm/s2",
    "cm/s/s": "cm/s2",
    "cm/sec2": "cm/s2",
    "gal": "cm/s2",
}


@dataclass(frozen=True)
class Header:
    """The line of names above a table.

    Attributes
    ----------
    line : int
        Number of lines up to it, itself included.
    columns : tuple of str
        Names of the columns without units.
    units : tuple of str
        Units of the columns, '' where none is given.
    """

    line: int
    columns: tuple[str, ...]
    units: tuple[str, ...]

    @property
    def unit(self) -> str | None:
        """The one unit of all accelerations, None without one."""
        known = {_UNITS[unit] for unit in self.units if unit in _UNITS}
        return known.pop() if len(known) == 1 else None

    @property
    def has_components(self) -> bool:
        """True for a table of times and several accelerations."""
        return len(self.columns) > 2 and _TIME.fullmatch(self.columns[0]) is not None


def read_header(lines: list[str]) -> Header | None:
    """Find the line of names above a table.

    Parameters
    ----------
    lines : list of str
        The lines of the file.

    Returns
    -------
    Header or None
        Names and units; None when the first line that is no comment begins with a number.
    """
    for i, line in enumerate(lines):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        if not text[0].isalpha() and text[0] not in "\"'":
            return None
        mark = next((mark for mark in ",;\t" if mark in text), None)
        cells = [cell.strip().strip("\"'") for cell in text.split(mark)]
        if mark is None:
            # blanks may stand before a bracket
            cells = re.findall(r"[^\s\[(]+\s*(?:[\[(].*?[\])])?", text)
        found = [_name_and_unit(cell) for cell in cells]
        return Header(i + 1, tuple(name for name, _ in found), tuple(unit for _, unit in found))
    return None


def _name_and_unit(cell: str) -> tuple[str, str]:
    """Split 'a [m/s2]', 'a (g)', 'a_g' and 'a_m_s2' into name and unit."""
    match = _BRACKETS.search(cell)
    if match is not None:
        return cell[: match.start()].strip(), _plain_unit(match[1])
    words = cell.split("_")
    for i in range(1, len(words)):
        unit = _plain_unit("/".join(words[i:]))
        if unit in _UNITS:
            return "_".join(words[:i]), unit
    return cell.strip(), ""


def _plain_unit(text: str) -> str:
    return re.sub(r"[\s^*]", "", text.lower()).replace("\u00c2", "").replace("\u00b2", "2")


def read_by_kernel(lines: list[str], case: Case, name: str) -> list[Channel]:
    """Return the samples of a file that the kernel has read and validated.

    Parameters
    ----------
    lines : list of str
        The lines of the file.
    case : Case
        Case with this record.
    name : str
        Name of the motion.

    Returns
    -------
    list of Channel
        Its channel.

    Raises
    ------
    InputError
        When the samples differ from the kernel's.
    """
    keys = case.motion.as_given()
    unit, dt = str(keys.get("unit", "g")), keys.get("dt")
    peak, last = case.kernel.peak_of_motion(), case.kernel.end_of_motion()
    if "unit" not in keys:
        begin = next(i for i, line in enumerate(lines, 1) if _is_at2_header(line))
        # text may follow the numbers
        rows = [line for line in lines[begin:] if not re.search("[A-CF-Za-cf-z#]", line)]
        values = free_numbers([_plain(line) for line in rows], begin + 1)
        # the interval is a decimal number
        dt = float(f"{last / (values.size - 1):.15g}")
        motion, dialect = Motion(values, dt=dt, unit=unit, name=name), "AT2"
    else:
        table = _columns(lines)
        values, times = table[-1], table[0] if len(table) == 2 else None
        interval = cast("float | None", dt)
        motion = Motion(values, dt=interval, times=times, unit=unit, name=name)
        dialect = "one column" if times is None else "two columns"
    factor = {"g": float(case.model.g), "m/s2": 1.0, "cm/s2": 0.01}[unit]
    largest = float(np.abs(values).max()) * factor
    if abs(largest - peak) > 1e-12 * peak or abs(motion.times[-1] - last) > 1e-9 * abs(last):
        raise InputError("the samples differ from those of the kernel; please report this file")
    return [Channel(motion, "", dialect)]


def _is_at2_header(line: str) -> bool:
    lower = line.strip().lower()
    return "npts" in lower and "dt" in lower and not lower.startswith("#")


def _plain(line: str) -> str:
    """Return a line with blanks between numbers that Python can read."""
    return line.translate(_TO_PLAIN)


def _columns(lines: list[str]) -> Values:
    """Return the columns of the lines that hold numbers, shape (columns, n)."""
    rows = [words for line in lines if (words := _plain(line).split()) and words[0][0] != "#"]
    if not _is_number(rows[0][0]):
        rows = rows[1:]
    return np.array([[float(word) for word in row] for row in rows]).T


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def read_table(lines: list[str], header: Header, name: str, unit: str | None) -> list[Channel]:
    """Read a table of times and several components below a line of names.

    Parameters
    ----------
    lines : list of str
        The lines of the file.
    header : Header
        Its names and units.
    name : str
        Name of the motions; that of the column is added.
    unit : str, optional
        Unit of all accelerations, unless the header gives it.

    Returns
    -------
    list of Channel
        One per column of accelerations.

    Raises
    ------
    InputError
        When a line has another number of columns or a word that is not a number.
    """
    count = len(header.columns)
    cells = [_plain(line).split() for line in lines]
    for i in range(header.line, len(lines)):
        if cells[i] and not cells[i][0].startswith("#") and len(cells[i]) != count:
            raise InputError(f"line {i + 1}: {len(cells[i])} columns where the header has {count}")
    table = free_numbers(
        [_plain(line.partition("#")[0]) for line in lines[header.line :]], header.line + 1
    )
    if header.units[0] not in ("", "s", "sec"):
        raise InputError(f"the times are in {header.units[0]!r}: must be in s")
    times, *components = table.reshape(-1, count).T
    channels = []
    for column, given, values in zip(header.columns[1:], header.units[1:], components, strict=True):
        own = _UNITS.get(given, unit)
        if own is None:
            raise InputError(f"the column {column!r} needs the key unit: 'g', 'm/s2' or 'cm/s2'")
        motion = Motion(values, times=times, unit=own, name=f"{name}-{column}")
        channels.append(Channel(motion, column, "table", is_complete=False))
    return channels
