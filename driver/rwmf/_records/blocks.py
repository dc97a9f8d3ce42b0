"""Formats with blocks of fixed-width numbers: COSMOS, and volumes 1 and 2 of the CGS (CSMIP)."""

from __future__ import annotations

import re

from rwmf._records.channels import (
    Channel,
    Values,
    check_peak,
    fixed_numbers,
    header_number,
    in_base_unit,
)
from rwmf.case import Motion
from rwmf.errors import InputError

__all__ = ["is_cgs", "is_cosmos", "read_cgs", "read_cosmos"]

_LAYOUT = r"\(?(?P<per>\d+)[efEF](?P<width>\d+)\.\d+[eEdD]?\d*\)"
_COSMOS = re.compile(
    r"\s*(?P<n>\d+)\s+acceleration pts,\s*approx\s+(?P<seconds>\d+\.?\d*)\s*secs,"
    r"\s*units=(?P<unit>[^,]*),\s*Format=" + _LAYOUT,
    re.IGNORECASE,
)
_REALS = re.compile(r"\s*(?P<n>\d+) Real-header values .*Format=\s*" + _LAYOUT, re.IGNORECASE)
_COSMOS_VERSION = "(Format v01.20"
# positions of numbers in the real header: interval of raw [s] and of processed data [ms], largest
# acceleration; and the text of an unknown number
_INTERVAL, _INTERVAL_MS, _LARGEST = 33, 61, 63
_UNKNOWN = -999.0
# accepted difference between duration and interval times number, as durations are rounded
_SECONDS = 1.01
_CGS_1 = r"Accelerogram points at\s*(?P<rate>[\d.]+) pts/sec in units of (?P<raw>\S+?)\.\s+Format:"
_CGS_2 = r"points of accel data equally spaced at\s*(?P<dt>[\d.]+) sec, in (?P<unit>\S+?)\."
_CGS = re.compile(rf"\s*(?P<n>\d+) (?:{_CGS_1}|{_CGS_2})\s*{_LAYOUT}", re.IGNORECASE)
_CGS_PEAK = re.compile(
    r"(?:Units of uncor data are sec and g\.\s+Max  =|Peak acceleration =)\s*(-?[\d.]+)"
)
_CHANNEL = re.compile(r"(?:Sta )?Cha\w*\s+[\d?]*:\s*(.*?)\s*(?:\(|from\b|$)")


def is_cosmos(lines: list[str]) -> bool:
    """Recognise a COSMOS file of accelerations."""
    return bool(lines) and "acceleration" in lines[0] and "(Format v" in lines[0]


def read_cosmos(lines: list[str], name: str) -> list[Channel]:
    """Read the accelerations of a COSMOS file, format 1.20."""
    if _COSMOS_VERSION not in lines[0]:
        raise InputError("the version of the format is not 01.20, which alone is read")
    places = _places(lines, _COSMOS)
    channels = []
    for number, (i, match) in enumerate(places, 1):
        reals = _real_header(lines[:i])
        values, unit = in_base_unit(_block(lines, i, match), match["unit"], f"line {i + 1}: units")
        is_raw = reals[_INTERVAL_MS] in (0.0, _UNKNOWN)
        dt = reals[_INTERVAL] if is_raw else reals[_INTERVAL_MS] / 1000
        seconds = float(match["seconds"])
        # whole seconds are printed
        if dt <= 0 or not abs(values.size * dt - seconds) <= _SECONDS:
            raise InputError(
                f"line {i + 1}: {values.size} points at the header's interval of {dt:g} s are not "
                f"the stated {seconds:g} s"
            )
        if reals[_LARGEST] not in (0.0, _UNKNOWN):
            check_peak(values, f"{reals[_LARGEST]:.6f}", "the largest acceleration")
        title = _title(name, number, len(places))
        motion = Motion(values, dt=dt, unit=unit, name=title)
        channels.append(Channel(motion, _direction(lines[:i]), "COSMOS", len(places) == 1))
    return channels


def is_cgs(lines: list[str]) -> bool:
    """Recognise volume 1 or 2 of the California Geological Survey."""
    begins = ("Uncorrected Accelerogram Data", "Corrected accelerogram ")
    return bool(lines) and lines[0].startswith(begins)


def read_cgs(lines: list[str], name: str) -> list[Channel]:
    """Read the accelerations of volume 1 or 2 of the California Geological Survey (CSMIP)."""
    places = _places(lines, _CGS)
    channels = []
    for number, (i, match) in enumerate(places, 1):
        if match["rate"] is None:
            dt = header_number("the interval", match["dt"])
        else:
            dt = 1 / header_number("pts/sec", match["rate"])
        numbers, text = _block(lines, i, match), match["raw"] or match["unit"]
        values, unit = in_base_unit(numbers, text, f"line {i + 1}: unit")
        peaks = [found[1] for line in lines[:i] if (found := _CGS_PEAK.search(line))]
        check_peak(values, peaks[-1] if peaks else None, "the largest acceleration")
        title = _title(name, number, len(places))
        motion = Motion(values, dt=dt, unit=unit, name=title)
        channels.append(Channel(motion, _direction(lines[:i]), "CGS", len(places) == 1))
    return channels


def _places(lines: list[str], pattern: re.Pattern[str]) -> list[tuple[int, re.Match[str]]]:
    """Find the lines that begin blocks of accelerations."""
    found = [(i, match) for i, line in enumerate(lines) if (match := pattern.match(line))]
    if not found:
        raise InputError("the file has no block of accelerations")
    return found


def _block(lines: list[str], i: int, match: re.Match[str]) -> Values:
    """Read the numbers behind a line that gives count and layout."""
    layout = (int(match["per"]), int(match["width"]))
    if min(layout) < 1:
        raise InputError(f"line {i + 1}: has no usable format of the numbers")
    return fixed_numbers(lines[i + 1 :], i + 2, int(match["n"]), layout)


def _real_header(lines: list[str]) -> Values:
    """Return the last real header before a block of numbers."""
    i, match = next(
        ((i, found) for i in reversed(range(len(lines))) if (found := _REALS.match(lines[i]))),
        (0, None),
    )
    if match is None:
        raise InputError("the header has no Real-header values")
    reals = _block(lines, i, match)
    if reals.size <= _LARGEST:
        raise InputError(f"line {i + 1}: {reals.size} Real-header values: must be 100")
    return reals


def _direction(lines: list[str]) -> str:
    """Return the direction of the last channel named in a header."""
    found = (_CHANNEL.match(line) for line in reversed(lines))
    return next((match[1] for match in found if match), "")


def _title(name: str, number: int, count: int) -> str:
    return name if count == 1 else f"{name}-{number}"
