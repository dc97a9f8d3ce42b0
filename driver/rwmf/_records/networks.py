"""Channels of records, and formats of networks: ESM and ITACA (DYNA), K-NET and KiK-net."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._files.names import shorten
from rwmf._numbers import show
from rwmf.case import Motion
from rwmf.errors import InputError

Values = npt.NDArray[np.float64]

_VERTICAL = re.compile(r"\b(up|u-d|ud|vert\w*|down|dn|dwn|z)\b", re.IGNORECASE)
# number of a unit in tables of COSMOS: 'cm/s^2 (4)'
_CODE = re.compile(r"\(\d+\)")
# accepted difference between the stated and the largest sample, beside the printed digits [-]
_PEAK = 2e-3


@dataclass(frozen=True)
class Channel:
    """A component of a record.

    Attributes
    ----------
    motion : Motion
        Its samples.
    direction : str
        Direction as in the file; '' when the file gives none.
    dialect : str
        Name of the file's format.
    is_complete : bool
        True when the file has this channel alone.
    """

    motion: Motion
    direction: str
    dialect: str
    is_complete: bool = True

    @property
    def is_vertical(self) -> bool:
        """True for a vertical component."""
        return _VERTICAL.search(self.direction) is not None


def free_numbers(lines: Sequence[str], first: int) -> Values:
    """Read numbers separated by blanks."""
    words = [line.split() for line in lines]
    return _numbers(words, first)


def fixed_numbers(lines: Sequence[str], first: int, count: int, layout: tuple[int, int]) -> Values:
    """Read numbers in columns of fixed width, which may touch."""
    per_line, width = layout
    used = lines[: -(-count // per_line)]
    cells = [
        [line[i : i + width] for i in range(0, min(len(line.rstrip()), per_line * width), width)]
        for line in used
    ]
    found = sum(map(len, cells))
    if found < count:
        # a line of text ends the numbers earlier than the missing cells of the last line
        _numbers(cells, first)
        raise InputError(f"the file has {found} numbers where its header says {count}")
    return _numbers(cells, first)[:count]


def _numbers(rows: list[list[str]], first: int) -> Values:
    """Convert the words of lines."""
    try:
        values = np.array([float(word) for row in rows for word in row])
    except ValueError:
        values = np.array([math.nan])
    if np.isfinite(values).all() and not any("_" in word for row in rows for word in row):
        return values
    for i, row in enumerate(rows):
        for word in row:
            if not _is_finite(word):
                raise InputError(
                    f"line {first + i}: {shorten(word.strip())!r} is not a finite number"
                )
    return values


def _is_finite(word: str) -> bool:
    try:
        return "_" not in word and math.isfinite(float(word))
    except ValueError:
        return False


def header_number(key: str, text: str | None, *, above: float = 0.0) -> float:
    """Return a number of a header."""
    if text is None:
        raise InputError(f"the header has no {key}")
    if not _is_finite(text) or float(text) <= above:
        raise InputError(
            f"the header has {key} = {show(text.strip())}: must be a number > {above:g}"
        )
    return float(text)


def in_base_unit(values: Values, text: str, key: str) -> tuple[Values, str]:
    """Convert accelerations to a unit of a motion."""
    quantity, base, times, over = _library.unit_named(_CODE.sub("", text))
    if quantity != "acceleration":
        raise InputError(
            f"{key} = {text.strip()!r}: must be a unit of accelerations: g, m/s2, cm/s2 or gal"
        )
    return (values if times == over == 1 else values * times / over), base


def check_count(values: Values, stated: float, key: str) -> None:
    """Compare the number of samples with that of the header."""
    if values.size != stated:
        raise InputError(
            f"the file has {values.size} numbers where its header says {key} = {stated:g}"
        )


def check_peak(values: Values, stated: str | None, key: str) -> None:
    """Compare the largest sample with the peak of the header.

    A file that is damaged, or another dialect of its format, rarely passes.
    """
    if stated is None or not stated.strip():
        return
    peak = abs(header_number(key, stated, above=-math.inf))
    largest = float(np.abs(values).max())
    digits = len(stated.strip().partition(".")[2])
    if abs(largest - peak) > _PEAK * peak + 10.0**-digits:
        raise InputError(
            f"the largest sample is {largest:.6g} where the header says {key} = {stated.strip()}: "
            "the file is damaged, or of another version of its format"
        )


_NIED_LINES = 17
_NIED_COLUMNS = re.compile(r"#\s*Time\s*,\s*RelativeTime\(s\),", re.IGNORECASE)
_GAIN = re.compile(r"([\d.]+)\s*\(gal\)\s*/\s*([\d.]+)")
# directions of KiK-net: three in the borehole, three at the surface
_KIK_NET = {
    "1": "N-S borehole",
    "2": "E-W borehole",
    "3": "U-D borehole",
    "4": "N-S surface",
    "5": "E-W surface",
    "6": "U-D surface",
}


def is_dyna(lines: list[str]) -> bool:
    """Recognise an ASCII file of ESM or ITACA."""
    return bool(lines) and lines[0].startswith("EVENT_NAME:")


def read_dyna(lines: list[str], name: str) -> list[Channel]:
    """Read an ASCII file of the Engineering Strong Motion database or ITACA."""
    n = next((i for i, line in enumerate(lines) if ":" not in line), len(lines))
    header = {
        key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines[:n])
    }
    dialect = "ESM"
    kind = header.get("DATA_TYPE", "ACCELERATION")
    if kind != "ACCELERATION":
        raise InputError(f"the header has DATA_TYPE = {kind}: must be ACCELERATION")
    dt = header_number("SAMPLING_INTERVAL_S", header.get("SAMPLING_INTERVAL_S"))
    numbers = free_numbers(lines[n:], n + 1)
    values, unit = in_base_unit(numbers, header.get("UNITS", ""), "the header has UNITS")
    check_count(values, header_number("NDATA", header.get("NDATA")), "NDATA")
    if unit == "cm/s2":
        check_peak(values, header.get("PGA_CM/S^2"), "PGA_CM/S^2")
    stream = header.get("STREAM", "")
    direction = "Z" if stream.endswith("Z") else stream
    motion = Motion(values, dt=dt, unit=unit, name=name)
    return [Channel(motion, direction, dialect)]


def is_nied(lines: list[str]) -> bool:
    """Recognise an ASCII file of K-NET or KiK-net."""
    return bool(lines) and lines[0].startswith("Origin Time")


def read_nied(lines: list[str], name: str) -> list[Channel]:
    """Read an ASCII file of K-NET or KiK-net; its mean is removed, as for the stated peak."""
    header = {line[:18].strip(): line[18:].strip() for line in lines[:_NIED_LINES]}
    if "Memo." not in header:
        raise InputError(f"the header ends before line {_NIED_LINES}, 'Memo.'")
    rate = header_number("Sampling Freq(Hz)", header.get("Sampling Freq(Hz)", "").rstrip("Hz"))
    gain = _GAIN.fullmatch(header.get("Scale Factor", ""))
    if gain is None:
        raise InputError(
            f"the header has Scale Factor = {header.get('Scale Factor')!r}: must be like "
            "2000(gal)/8388608"
        )
    counts = free_numbers(lines[_NIED_LINES:], _NIED_LINES + 1)
    seconds = header_number("Duration Time(s)", header.get("Duration Time(s)"))
    check_count(counts, seconds * rate, "Duration Time(s) times Sampling Freq(Hz)")
    factor = header_number("Scale Factor", gain[1]) / header_number("Scale Factor", gain[2])
    values = (counts - counts.mean()) * factor
    check_peak(values, header.get("Max. Acc. (gal)"), "Max. Acc. (gal)")
    direction = header.get("Dir.", "")
    motion = Motion(values, dt=1 / rate, unit="cm/s2", name=name)
    return [Channel(motion, _KIK_NET.get(direction, direction), "K-NET")]


def is_nied_csv(lines: list[str]) -> bool:
    """Recognise a CSV file of K-NET or KiK-net."""
    return bool(lines) and lines[0].lower().startswith(("#k-net", "#kik-net"))


def read_nied_csv(lines: list[str], name: str) -> list[Channel]:
    """Read the channels of a CSV file of K-NET or KiK-net."""
    begin = next((i for i, line in enumerate(lines) if _NIED_COLUMNS.match(line)), None)
    if begin is None:
        raise InputError("the header has no line '#Time,RelativeTime(s),...'")
    heads = [line.strip().removeprefix("#") for line in lines[:begin]]
    header = dict(itertools.pairwise(heads))
    rate = header_number("SamplingFrequency(Hz)", header.get("SamplingFrequency(Hz)"))
    seconds = header_number("DurationTime(s)", header.get("DurationTime(s)"))
    # without the column of dates; blank lines keep the numbers of lines in messages
    table = [""] * begin + [line.partition(",")[2] for line in lines[begin:]]
    channels = []
    for item in _library.read_record("\n".join(table).encode("latin-1"), None, None):
        check_count(item.values, seconds * rate, "DurationTime(s) times SamplingFrequency(Hz)")
        if item.times is None or not np.allclose(np.diff(item.times) * rate, 1, rtol=0, atol=0.1):
            raise InputError(f"the times do not have the header's {rate:g} Hz")
        motion = Motion(item.values, dt=1 / rate, unit=item.unit, name=f"{name}-{item.name}")
        channels.append(Channel(motion, item.name, "K-NET CSV", is_complete=False))
    return channels
