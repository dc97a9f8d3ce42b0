"""Formats of single networks: ESM and ITACA (DYNA), K-NET and KiK-net."""

from __future__ import annotations

import itertools
import re

import numpy as np

from rwmf import _library
from rwmf._records.channels import (
    Channel,
    check_count,
    check_peak,
    free_numbers,
    header_number,
    in_base_unit,
)
from rwmf.case import Motion
from rwmf.errors import InputError

__all__ = ["is_dyna", "is_nied", "is_nied_csv", "read_dyna", "read_nied", "read_nied_csv"]

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
