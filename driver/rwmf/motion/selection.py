"""Pairs of components; targets, scaling of records to them, and a greedy choice."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rwmf.case import Motion
from rwmf.case.arguments import checked
from rwmf.errors import InputError, placed, warn
from rwmf.kernel import files
from rwmf.kernel.files import path_of
from rwmf.kernel.names import shorten
from rwmf.kernel.numbers import Array, Truths, show, to_array, to_items, to_number, to_whole
from rwmf.kernel.progress import Reports, reporting
from rwmf.motion import formats
from rwmf.motion.intensity import DAMPING, G, waveform_of_record
from rwmf.motion.record_sets import (
    SUITE_HEADER,
    VERTICAL,
    RecordFile,
    component_of,
    components,
    decimal_point,
    find_records,
    read_bytes,
    separator_of,
)
from rwmf.motion.waveform import pseudo_accelerations


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
        As for `rwmf.records.find_records`.
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


_ROLES = {
    "period": (
        formats.known_words("t tn period periods natural vibration structural fundamental"),
        "time",
    ),
    "frequency": (
        formats.known_words("f fn freq frequency frequencies natural omega"),
        "frequency",
    ),
    formats.ACCELERATION: (
        formats.known_words(
            "sa psa se sae rs a s t spectral pseudo acceleration accelerations accel acc response "
            "spectrum target design elastic code site ec asce uhs mce mcer dbe year years yr "
            "horizontal mean median geomean geometric max rotd damped damping of critical %"
        ),
        formats.ACCELERATION,
    ),
}
# words by which a line of names is recognised, at its begin and anywhere in a name
_FIRST = formats.known_words("t tn f fn omega se sae sv sd psv psd log ln velocity displacement")
_ANYWHERE = formats.known_words("period periods freq frequency sa psa acceleration")
_DAMPING = re.compile(
    r"([\d.]+)\s*%\s*(?:of critical )?damp|([\d.]+)\s*%\s*[\])]|damp\w*\W+([\d.]+)\s*%"
)
_FORM = "must have two columns, as Period (s),Sa (g)"


def read_target(path: Path, damping: float) -> Array:
    """Read a target spectrum."""
    lines = read_bytes(path).decode("utf-8-sig", errors="surrogateescape").splitlines()
    number = re.compile(r"\s*[\"']?[-+]?\.?\d")
    first = next((i for i, line in enumerate(lines) if number.match(line)), len(lines))
    with placed(f"target: {path}, "):
        names, at = _names_above(lines[:first], damping)
        table = _numbers(lines, first)
    if not table:
        raise InputError(f"target: {path}: {_FORM}")
    with placed(f"target: {path}, {'' if names is None else f'line {at}: '}"):
        return _converted(table, names)


def _names_above(
    lines: list[str], damping: float
) -> tuple[tuple[formats.ColumnName, ...] | None, int]:
    """Return the names of the columns, and their line; None without names."""
    found: tuple[formats.ColumnName, ...] | None = None
    at = 0
    stated: tuple[int, str] | None = None
    for i, line in enumerate(lines, 1):
        text = line.strip().lstrip("#%!").strip()
        if not text:
            continue
        _check_damping(text, damping, i)
        cells = _split(text)
        units = [unit for unit in map(formats.unit_of_cell, cells) if unit is not None]
        names = tuple(map(formats.read_column_name, cells))
        is_comment = line.startswith(("#", "%", "!"))
        if found is not None and len(cells) == len(units) == 2:
            # a line of units below the names
            found = tuple(
                formats.ColumnName(name.words, unit)
                for name, unit in zip(found, units, strict=True)
            )
        elif len(names) == 2 and any(map(_is_column, names)):
            found, at = names, i
        elif (unit := formats.unit_in_text(text)) is not None:
            stated = (i, unit)
        elif len(cells) > 1 and not is_comment and i == len(lines):
            raise InputError(f"line {i}: the columns are {shorten(text)}: {_FORM}")
    if stated is not None and not (found and all(name.unit for name in found)):
        raise InputError(
            f"line {stated[0]}: states {stated[1]}: name the columns with their units, as "
            "Period (s),Sa (m/s2)"
        )
    return found, at


def _is_column(name: formats.ColumnName) -> bool:
    is_first = not _FIRST.isdisjoint(name.tokens[:1])
    return is_first or not _ANYWHERE.isdisjoint(name.tokens)


def _split(text: str) -> list[str]:
    """Split a line of names at its separators, or behind the brackets of the first one."""
    mark = separator_of(text)
    if mark in text:
        return [cell.strip(" ,") for cell in text.split(mark) if cell.strip(" ,")]
    match = re.fullmatch(r"(.+?[\])])\s+(\S.*)", text) or re.fullmatch(r"(\S+)\s+(\S+)", text)
    return [text] if match is None else [match[1], match[2]]


def _check_damping(text: str, damping: float, line: int) -> None:
    match = _DAMPING.search(text.lower())
    if match is None:
        return
    stated = next(part for part in match.groups() if part is not None)
    if not math.isclose(float(stated), 100 * damping, rel_tol=1e-6):
        raise InputError(f"line {line}: states {stated} % damping, where damping = {damping:g}")


def _kind(name: formats.ColumnName) -> str:
    """Return period, frequency or acceleration; '' for another name."""
    for kind, (words, dimension) in _ROLES.items():
        if name.consists_of(words, dimension) and (name.tokens or name.dimension == dimension):
            return kind
    return ""


def _numbers(lines: list[str], first: int) -> list[tuple[int, float, float]]:
    """Return line number and both numbers of every row."""
    found = []
    mark = separator_of(lines[first]) if first < len(lines) else ","
    for i in range(first, len(lines)):
        text = lines[i].partition("#")[0].strip()
        if not text.strip(" ,;\t"):
            continue
        cells = text.split(mark) if mark in text and mark != "\t" else text.split()
        cells = [decimal_point(cell.strip(), mark).strip("\"'") for cell in cells if cell.strip()]
        if len(cells) != 2:
            raise InputError(f"line {i + 1}: has {len(cells)} columns: {_FORM}")
        try:
            x, y = (math.nan if "_" in cell else float(cell) for cell in cells)
        except ValueError:
            x = y = math.nan
        if not (0 < x < math.inf and 0 < y < math.inf):
            raise InputError(f"line {i + 1}: {shorten(text)}: must be two finite numbers > 0")
        found.append((i + 1, x, y))
    return found


def _converted(
    table: list[tuple[int, float, float]], names: tuple[formats.ColumnName, ...] | None
) -> Array:
    """Return periods [s] and accelerations [g] by the names of their columns."""
    lines, x, y = (np.array(column) for column in zip(*table, strict=True))
    if names is None:
        names = (formats.ColumnName("period", ""), formats.ColumnName("sa", ""))
    if _kind(names[0]) == formats.ACCELERATION:
        names, x, y = names[::-1], y, x
    position, value = names
    kind = _kind(position)
    factor = formats.convert(value, "g")
    if (
        kind not in ("period", "frequency")
        or _kind(value) != formats.ACCELERATION
        or factor is None
    ):
        shown = " and ".join(f"{name.words} [{name.unit}]" for name in names)
        raise InputError(f"the columns are {shown}: {_FORM}")
    x = x * position.factor
    if kind == "frequency":
        x = 1 / x
    order = np.argsort(x, kind="stable")
    same = np.flatnonzero(np.diff(x[order]) == 0)
    if same.size:
        i = order[same[0] + 1]
        raise InputError(f"the period {x[i]:g} s is given twice, again in line {lines[i]:.0f}")
    return np.stack([x[order], y[order] * factor])


# periods of a band, evenly spaced in their logarithm
_PERIODS = 50
_NOT_ZERO = 1e-300
# largest pseudo-accelerations outside these limits point to a wrong unit [g]
_SMALLEST, _LARGEST = 1e-3, 5.0


@dataclass(frozen=True, eq=False)
class Selection:
    """Records scaled to a target spectrum.

    Attributes
    ----------
    records : tuple of RecordFile
        Components with their factors, in the order of the choice.
    names : tuple of str
        Name of the record of each component; both components of a pair have one name and factor.
    misfit : float
        Root of the mean square of ln(mean / target) over the band; the mean is geometric [-].
    periods : array, shape (n,)
        Periods of the band [s].
    target : array, shape (n,)
        Target spectrum [g].
    spectra : array, shape (components, n)
        Scaled spectra of the components [g].
    """

    records: tuple[RecordFile, ...]
    names: tuple[str, ...]
    misfit: float
    periods: Array
    target: Array
    spectra: Array

    @checked
    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a list of records with factors, which `rwmf.records.find_records` reads.

        Each record needs a separate file, or both horizontal channels of one file.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        InputError
            When a record is in memory.
        OutputError
            When the file cannot be written.
        """
        target = Path(path)
        lines = [SUITE_HEADER]
        for name, record in zip(self.names, self.records, strict=True):
            if not record.path:
                raise InputError(f"{record.name}: is in memory: a list of records names files")
            same = [item for item in self.records if item.path == record.path]
            if record.array is not None and record.name != Path(record.path).stem and len(same) < 2:
                raise InputError(f"{record.name}: is one channel of {record.path}: export it first")
            file = os.path.relpath(record.path, target.absolute().parent)
            line = f"{file},{record.scale!r},{name}"
            if any(mark in file + name for mark in ',\n"'):
                raise InputError(f"{record.path}: a list cannot hold this name")
            if line not in lines:
                lines.append(line)
        files.write_bytes(target, ("\n".join(lines) + "\n").encode())


@checked
def select(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    target_spectrum: str | os.PathLike[str] | Sequence[Sequence[float]],
    band: tuple[float, float],
    n: int | None = None,
    *,
    limits: tuple[float, float] = (0.25, 4.0),
    damping: float = DAMPING,
    is_paired: bool = False,
    progress: Reports = None,
    unit: str | None = None,
    dt: float | None = None,
) -> Selection:
    """Scale records to a target spectrum, and choose those whose mean fits it best.

    The factor of a record makes the mean of ln(Sa) over the band that of the target. The choice is
    greedy: each step adds the record that makes the misfit of the geometric mean smallest.

    Parameters
    ----------
    words : iterable of str, path, RecordFile or Motion
        Candidates, as for `rwmf.records.find_records`.
    target_spectrum : str, path or (periods, pseudo-accelerations)
        Target spectrum, or its file with two columns: periods [s] or frequencies [Hz], and
        pseudo-accelerations [g] or in the unit of the column's name. It is interpolated in
        logarithms.
    band : (float, float)
        First and last period [s]; 50 periods between them, evenly spaced in their logarithm.
    n : int, optional
        Number of records; all candidates without it.
    limits : (float, float)
        Smallest and largest factor; records that need another one are left out.
    damping : float
        Damping ratio of the spectra [-].
    is_paired : bool
        True to take pairs of components with one factor for the geometric mean of their spectra.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal, or a function that is called with the numbers of
        finished and of all records.
    unit : str, optional
        Unit of the samples of files that do not give it.
    dt : float, optional
        Sampling interval [s] of files of one column.

    Returns
    -------
    Selection
        The records with factors, and spectra for a figure.

    Raises
    ------
    InputError
        When the band is not within the target, or too few records need factors within the limits.
    """
    low, high = _two("band", band)
    least, most = _two("limits", limits)
    periods = np.geomspace(low, high, _PERIODS)
    wanted = _target_at(target_spectrum, periods, damping)
    names, members = _candidates(words, is_paired, unit, dt)
    spectra = []
    with reporting(progress, "record") as report:
        for group in members:
            waves = [waveform_of_record(item, G) for item in group]
            found = [pseudo_accelerations(wave, periods, damping) for wave in waves]
            spectra.append(np.array(found) / G)
            if report is not None:
                report(len(spectra), len(members))
    # logarithms of the candidates over the target, before scaling
    logs = np.array([np.log(np.maximum(each, _NOT_ZERO)).mean(axis=0) for each in spectra])
    logs -= np.log(wanted)
    factors = np.exp(-logs.mean(axis=1))
    usable = [i for i, factor in enumerate(factors) if least <= factor <= most]
    count = len(usable) if n is None else n
    if not 0 < count <= len(usable):
        raise InputError(
            f"select: {len(usable)} of {len(names)} records need factors within limits = "
            f"({least:g}, {most:g}), n = {n}: widen the limits or give more records"
        )
    scaled = logs + np.log(factors)[:, None]
    chosen = _choose(scaled, usable, count)
    parts = [(names[i], item, factors[i]) for i in chosen for item in members[i]]
    return Selection(
        tuple(replace(item, scale=item.scale * float(factor)) for _, item, factor in parts),
        tuple(name for name, _, _ in parts),
        _misfit(scaled[chosen].mean(axis=0)),
        periods,
        wanted,
        np.concatenate([spectra[i] * factors[i] for i in chosen]),
    )


def _choose(scaled: Array, usable: list[int], count: int) -> list[int]:
    """Add one record after the other; the first of equals."""
    chosen: list[int] = []
    total = np.zeros(scaled.shape[1])
    for size in range(1, count + 1):
        left = [i for i in usable if i not in chosen]
        best = min(left, key=lambda i: _misfit((total + scaled[i]) / size))
        chosen.append(best)
        total = total + scaled[best]
    return chosen


def _misfit(logs: Array) -> float:
    return math.sqrt(float((logs**2).mean()))


def _candidates(
    words: Iterable[str | os.PathLike[str] | RecordFile | Motion],
    is_paired: bool,
    unit: str | None,
    dt: float | None,
) -> tuple[list[str], list[tuple[RecordFile, ...]]]:
    if is_paired:
        sets = pairs(words, unit=unit, dt=dt)
        return [item.name for item in sets], [(item.first, item.second) for item in sets]
    records = find_records(words, unit=unit, dt=dt)
    return [record.name for record in records], [(record,) for record in records]


def _two(name: str, value: object) -> tuple[float, float]:
    ends = to_array(name, value, above=0.0, least=2)
    if ends.size != 2 or ends[0] >= ends[1]:
        raise InputError(f"{name} = {show(value)}: must be two numbers > 0, the smaller first")
    return float(ends[0]), float(ends[1])


def _target_at(
    target: str | os.PathLike[str] | Sequence[Sequence[float]], periods: Array, damping: float
) -> Array:
    """Interpolate the target spectrum [g]."""
    if isinstance(target, str | os.PathLike):
        table = read_target(Path(path_of("target_spectrum", target)), damping)
    else:
        rows = to_items(target) or []
        if len(rows) != 2:
            raise InputError(f"target_spectrum = {show(target)}: must be periods and accelerations")
        first, second = (to_array("target", row, above=0.0, least=2) for row in rows)
        if first.size != second.size:
            raise InputError(f"target: has {first.size} periods and {second.size} accelerations")
        table = np.stack([first, second])
        if np.any(np.diff(table[0]) <= 0):
            raise InputError("target: must be increasing periods > 0 and pseudo-accelerations > 0")
    if periods[0] < table[0, 0] * (1 - 1e-9) or periods[-1] > table[0, -1] * (1 + 1e-9):
        raise InputError(
            f"band = ({periods[0]:g}, {periods[-1]:g}): must be within the periods of the target, "
            f"{table[0, 0]:g} to {table[0, -1]:g} s"
        )
    peak = float(table[1].max())
    if not _SMALLEST < peak < _LARGEST:
        warn([f"target: the largest pseudo-acceleration is {peak:.4g} g: is it in g?"])
    return np.asarray(np.exp(np.interp(np.log(periods), np.log(table[0]), np.log(table[1]))))


# first period of the spectra of codes, and number of periods besides the corners
_BEGIN, _BETWEEN = 0.01, 500
# last periods: no corner of ASCE 7 is beyond 16 s, Eurocode 8 ends at 4 s
_LAST_ASCE, _LAST_EUROCODE = 20.0, 4.0
# EN 1998-1:2004, tables 3.2 and 3.3: soil factor S and corners T_B, T_C and T_D [s]
_GROUNDS = (
    {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.2, 0.6, 2.0),
        "D": (1.35, 0.2, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.1, 0.25, 1.2),
        "D": (1.8, 0.1, 0.3, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
)


@checked
def asce7(S_DS: float, S_D1: float, T_L: float = 8.0) -> Array:
    """Return the design spectrum of ASCE/SEI 7-16, section 11.4.6, as a target of `select`.

    With T_0 = 0.2 S_D1/S_DS and T_S = S_D1/S_DS, the pseudo-acceleration is
    S_DS (0.4 + 0.6 T/T_0) below T_0, S_DS up to T_S (11.4-5), S_D1/T up to T_L (11.4-6) and
    S_D1 T_L/T^2 beyond (11.4-7), for 5 % damping. For the MCE_R spectrum give S_MS and S_M1.

    Parameters
    ----------
    S_DS, S_D1 : float
        Design accelerations at short periods and at 1 s [g].
    T_L : float
        Long-period transition [s].

    Returns
    -------
    array, shape (2, n)
        Periods [s] and pseudo-accelerations [g].

    Raises
    ------
    InputError
        When a number is not positive, or T_L is below T_S.
    """
    short, one = to_number("S_DS", S_DS, above=0.0), to_number("S_D1", S_D1, above=0.0)
    T_S, last = one / short, to_number("T_L", T_L, above=0.0)
    if last < T_S:
        raise InputError(f"T_L = {last:g}: must be at least T_S = S_D1/S_DS = {T_S:g} s")
    T_0 = 0.2 * T_S
    periods, regions = _regions(_LAST_ASCE, T_0, T_S, last)
    parts = [short * (0.4 + 0.6 * periods / T_0), np.full_like(periods, short), one / periods]
    return np.stack([periods, np.select(regions, parts, one * last / periods**2)])


@checked
def eurocode8(
    a_g: float, ground_type: str = "A", spectrum_type: int = 1, damping: float = 0.05
) -> Array:
    """Return the elastic spectrum of EN 1998-1:2004, section 3.2.2.2, as a target of `select`.

    With eta = sqrt(0.10/(0.05 + damping)) >= 0.55 (3.6), the acceleration is
    a_g S (1 + T/T_B (2.5 eta - 1)) up to T_B (3.2), 2.5 a_g S eta up to T_C (3.3),
    2.5 a_g S eta T_C/T up to T_D (3.4) and 2.5 a_g S eta T_C T_D/T^2 up to 4 s (3.5). S and the
    corners are the recommended ones of tables 3.2 and 3.3; national annexes may differ.

    Parameters
    ----------
    a_g : float
        Design acceleration on ground A, with the importance factor [g].
    ground_type : {'A', 'B', 'C', 'D', 'E'}
        Ground type.
    spectrum_type : int
        Spectrum type, 1, or 2 where no earthquake of a surface-wave magnitude above 5.5 governs.
    damping : float
        Damping ratio [-].

    Returns
    -------
    array, shape (2, n)
        Periods [s] and pseudo-accelerations [g].

    Raises
    ------
    InputError
        When a number is outside its range, or the ground type is not known.
    """
    grounds = _GROUNDS[to_whole("spectrum_type", spectrum_type, 1, 2) - 1]
    if not isinstance(ground_type, str) or ground_type not in grounds:
        raise InputError(f"ground_type = {show(ground_type)}: must be one of {', '.join(grounds)}")
    S, T_B, T_C, T_D = grounds[ground_type]
    eta = max(math.sqrt(0.1 / (0.05 + damping)), 0.55)
    peak = to_number("a_g", a_g, above=0.0) * S
    periods, regions = _regions(_LAST_EUROCODE, T_B, T_C, T_D)
    top = 2.5 * peak * eta
    rise = peak * (1 + periods / T_B * (2.5 * eta - 1))
    parts = [rise, np.full_like(periods, top), top * T_C / periods]
    return np.stack([periods, np.select(regions, parts, top * T_C * T_D / periods**2)])


def _regions(last: float, *corners: float) -> tuple[Array, list[Truths]]:
    """Return periods even in their logarithm with the corners between them, and their regions."""
    inner = [corner for corner in corners if _BEGIN < corner < last]
    periods = np.unique(np.concatenate([np.geomspace(_BEGIN, last, _BETWEEN), inner]))
    return periods, [periods < corners[0], *(periods <= corner for corner in corners[1:])]
