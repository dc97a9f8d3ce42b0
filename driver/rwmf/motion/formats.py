"""Channels of records, and the formats of the networks that publish them."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rwmf.case import Motion
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.names import shorten
from rwmf.kernel.numbers import Array, show
from rwmf.kernel.tables import unit_named

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


def free_numbers(lines: Sequence[str], first: int) -> Array:
    """Read numbers separated by blanks."""
    words = [line.split() for line in lines]
    return _numbers(words, first)


def fixed_numbers(lines: Sequence[str], first: int, count: int, layout: tuple[int, int]) -> Array:
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


def _numbers(rows: list[list[str]], first: int) -> Array:
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


def in_base_unit(values: Array, text: str, key: str) -> tuple[Array, str]:
    """Convert accelerations to a unit of a motion."""
    quantity, base, times, over = tables.unit_named(_CODE.sub("", text))
    if quantity != "acceleration":
        raise InputError(
            f"{key} = {text.strip()!r}: must be a unit of accelerations: g, m/s2, cm/s2 or gal"
        )
    return (values if times == over == 1 else values * times / over), base


def check_count(values: Array, stated: float, key: str) -> None:
    """Compare the number of samples with that of the header."""
    if values.size != stated:
        raise InputError(
            f"the file has {values.size} numbers where its header says {key} = {stated:g}"
        )


def check_peak(values: Array, stated: str | None, key: str) -> None:
    """Compare the largest sample with the peak of the header."""
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


_CSMNC = re.compile(
    r"CORRECTED ACCELERATION\s+UNIT:\s*(?P<unit>\S+)\s+NO\. OF POINTS:\s*(?P<n>\d+)\s+"
    r"EQUALLY SPACED INTERVALS OF:\s*(?P<dt>\S+)\s+SEC\s+PEAK VALUE:\s*(?P<peak>\S+)"
)
_CSMNC_LINES = 20
_COMPONENT = re.compile(r"COMP\.\s*(\S+)")


def read_csmnc(lines: list[str], name: str) -> list[Channel]:
    """Read a file of the China Strong Motion Network Centre."""
    text = "\n".join(lines[:_CSMNC_LINES])
    header = _CSMNC.search(text)
    if header is None:
        raise InputError("the header has no UNIT, NO. OF POINTS, INTERVALS and PEAK VALUE in order")
    # lines of text end the header
    ends = text[: header.end()].count("\n")
    begin = next(
        (i for i in range(ends + 1, len(lines)) if re.match(r"\s*[-+.\d]", lines[i])), len(lines)
    )
    numbers = free_numbers(lines[begin:], begin + 1)
    check_count(numbers, header_number("NO. OF POINTS", header["n"]), "NO. OF POINTS")
    check_peak(numbers, header["peak"], "PEAK VALUE")
    values, unit = in_base_unit(numbers, header["unit"], "the header has UNIT")
    component = _COMPONENT.search(text)
    dt = header_number("INTERVALS", header["dt"])
    motion = Motion(values, dt=dt, unit=unit, name=name)
    return [Channel(motion, component[1] if component else "", "CSMNC")]


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


def read_dyna(lines: list[str], name: str) -> list[Channel]:
    """Read an ASCII file of the Engineering Strong Motion database or ITACA."""
    n = next((i for i, line in enumerate(lines) if ":" not in line), len(lines))
    header = {
        key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines[:n])
    }
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
    return [Channel(motion, direction, "ESM")]


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
    for item in tables.read_record("\n".join(table).encode("latin-1"), None, None):
        check_count(item.values, seconds * rate, "DurationTime(s) times SamplingFrequency(Hz)")
        if item.times is None or not np.allclose(np.diff(item.times) * rate, 1, rtol=0, atol=0.1):
            raise InputError(f"the times do not have the header's {rate:g} Hz")
        motion = Motion(item.values, dt=1 / rate, unit=item.unit, name=f"{name}-{item.name}")
        channels.append(Channel(motion, item.name, "K-NET CSV", is_complete=False))
    return channels


ACCELERATION = "acceleration"
_G = 9.81
# dimension and factor of units beside those of records, which the kernel knows
_UNITS = {
    "rad/s": ("frequency", 0.15915494309189535),
    **dict.fromkeys(("%", "percent"), ("share", 0.01)),
    **dict.fromkeys(("-", "1"), ("number", 1.0)),
    **dict.fromkeys(
        ("1/year", "1/yr", "1/a", "peryear", "/year", "/yr", "year-1", "yr-1"), ("rate", 1.0)
    ),
    **dict.fromkeys(("year", "years", "yr", "yrs", "a"), ("years", 1.0)),
}  # fmt: skip
# bases of accelerations, and of lengths over other powers of the second
_BASES = {"": 1.0, "g": _G, "m/s2": 1.0, "cm/s2": 0.01}
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")
# units other than s and g, and logarithms, in a sentence
_IN_TEXT = re.compile(
    r"(?<![\w/])(?:[cm]?m|in|ft)\s*/\s*s(?:ec)?(?:\s*/\s*s(?:ec)?|\s*[*^]*\s*2|\u00b2)|"
    r"(?<![\w/])(?:[cm]?m)\s*[.\u00b7*]?\s*s\s*\^?-2|\bgals?\b|%\s*g\b|"
    r"\b(?:ms|msec|milliseconds?|hz|log10|log|ln)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class ColumnName:
    """Name of a column.

    Attributes
    ----------
    words : str
        Its words in lower case, without the unit.
    unit : str
        The unit as the file writes it; '' without one.
    """

    words: str
    unit: str

    @property
    def dimension(self) -> str:
        """Dimension of the unit; '' without a unit."""
        return _find_unit(self.unit)[0]

    @property
    def factor(self) -> float:
        """Factor to SI units; 1 without a unit."""
        return _find_unit(self.unit)[1]

    @property
    def tokens(self) -> list[str]:
        """Words, numbers and marks of the name, without separators."""
        return re.findall(r"[^\W\d_]+|\d+(?:\.\d+)?|[^\w\s(),.=\[\]:\"'-]", self.words)

    @property
    def numbers(self) -> list[float]:
        """Numbers in the name."""
        return [float(token) for token in self.tokens if token[0].isdigit()]

    def consists_of(self, words: frozenset[str], *dimensions: str) -> bool:
        """Check that all words of the name are known, and its unit has a dimension."""
        tokens = [token for token in self.tokens if not token[0].isdigit()]
        return words.issuperset(tokens) and self.dimension in ("", *dimensions)


def known_words(text: str) -> frozenset[str]:
    """Return the words of a text."""
    return frozenset(text.split())


def read_column_name(cell: str) -> ColumnName:
    """Split 'Sa [m/s2]', 'PGA (g)', 'T_s', 'Sa in gal' into name and unit."""
    text = " ".join(cell.strip().strip("\"'").split())
    for match in reversed(list(_BRACKETS.finditer(text))):
        unit = unit_of_cell(match[1])
        if unit is not None:
            return ColumnName((text[: match.start()] + text[match.end() :]).strip().lower(), unit)
    if re.fullmatch(r".+/\s*g", text, re.IGNORECASE):
        return ColumnName(text.rpartition("/")[0].strip().lower(), "g")
    for mark in "_ ":
        words = text.split(mark)
        for i in range(1, len(words)):
            unit = unit_of_cell(("/" if mark == "_" else " ").join(words[i:]))
            # 'poe in 50 years' has no unit
            is_span = unit != "%" and re.fullmatch(r"\W?[\d.]+", words[i - 1]) is not None
            if unit is not None and unit not in ("1", "-") and not is_span:
                return ColumnName(mark.join(words[:i]).strip(" ,").lower(), unit)
    return ColumnName(text.lower(), "")


def unit_of_cell(cell: str) -> str | None:
    """Return the unit that a cell below a name holds."""
    unit = cell.strip().strip("\"'[]()").removeprefix("in ").strip().lower()
    # the superscript as a byte of Latin-1
    unit = unit.replace("\udcb2", "2").encode("utf-8", errors="replace").decode()
    return unit if _find_unit(unit)[0] else None


def _find_unit(unit: str) -> tuple[str, float]:
    """Return dimension and factor to SI units; '' and 1 for no unit."""
    known = _UNITS.get("".join(unit.split()))
    if known is not None or not unit:
        return known or ("", 1.0)
    dimension, base, times, over = unit_named(unit)
    return dimension, times / over * _BASES[base]


def convert(name: ColumnName, unit: str) -> float | None:
    """Return the factor from the unit of a column to another one."""
    dimension, factor = _find_unit(unit)
    if not name.unit:
        return 1.0
    # exactly 1 for the same unit
    return name.factor / factor if dimension == name.dimension else None


def unit_in_text(text: str) -> str | None:
    """Find a unit other than s and g, or a logarithm, in a sentence."""
    found = _IN_TEXT.search(text)
    return None if found is None else found[0]


def read_by_kernel(content: bytes, name: str, unit: str | None, dt: float | None) -> list[Channel]:
    """Read the channels of an AT2 file or a table."""
    found = tables.read_record(content, unit, dt)
    is_alone = len(found) == 1
    return [
        Channel(
            Motion(
                item.values,
                dt=item.dt,
                times=item.times,
                unit=item.unit,
                name=name if is_alone else f"{name}-{item.name}",
            ),
            "" if is_alone else item.name,
            item.format,
            is_complete=is_alone,
        )
        for item in found
    ]


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


def read_cosmos(lines: list[str], name: str) -> list[Channel]:
    """Read the accelerations of a COSMOS file, format 1.20."""
    if _COSMOS_VERSION not in lines[0]:
        raise InputError("the version of the format is not 01.20, which alone is read")
    return _channels(lines, name, "COSMOS", _COSMOS, _read_cosmos)


def _read_cosmos(lines: list[str], i: int, match: re.Match[str]) -> tuple[Array, str, float]:
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
    return values, unit, dt


def read_cgs(lines: list[str], name: str) -> list[Channel]:
    """Read the accelerations of volume 1 or 2 of the California Geological Survey (CSMIP)."""
    return _channels(lines, name, "CGS", _CGS, _read_cgs)


def _read_cgs(lines: list[str], i: int, match: re.Match[str]) -> tuple[Array, str, float]:
    if match["rate"] is None:
        dt = header_number("the interval", match["dt"])
    else:
        dt = 1 / header_number("pts/sec", match["rate"])
    numbers, text = _block(lines, i, match), match["raw"] or match["unit"]
    values, unit = in_base_unit(numbers, text, f"line {i + 1}: unit")
    peaks = [found[1] for line in lines[:i] if (found := _CGS_PEAK.search(line))]
    check_peak(values, peaks[-1] if peaks else None, "the largest acceleration")
    return values, unit, dt


def _channels(
    lines: list[str],
    name: str,
    dialect: str,
    pattern: re.Pattern[str],
    read: Callable[[list[str], int, re.Match[str]], tuple[Array, str, float]],
) -> list[Channel]:
    """Read the blocks of accelerations behind lines of a pattern."""
    places = [(i, match) for i, line in enumerate(lines) if (match := pattern.match(line))]
    if not places:
        raise InputError("the file has no block of accelerations")
    channels = []
    for number, (i, match) in enumerate(places, 1):
        values, unit, dt = read(lines, i, match)
        title = name if len(places) == 1 else f"{name}-{number}"
        motion = Motion(values, dt=dt, unit=unit, name=title)
        named = (found[1] for line in reversed(lines[:i]) if (found := _CHANNEL.match(line)))
        channels.append(Channel(motion, next(named, ""), dialect, len(places) == 1))
    return channels


def _block(lines: list[str], i: int, match: re.Match[str]) -> Array:
    """Read the numbers behind a line that gives count and layout."""
    layout = (int(match["per"]), int(match["width"]))
    if min(layout) < 1:
        raise InputError(f"line {i + 1}: has no usable format of the numbers")
    return fixed_numbers(lines[i + 1 :], i + 2, int(match["n"]), layout)


def _real_header(lines: list[str]) -> Array:
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
