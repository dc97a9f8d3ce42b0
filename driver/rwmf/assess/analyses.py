"""Incremental dynamic analyses, stripes and clouds: tables of runs under scaled records."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import numpy as np
import pandas as pd
import xarray as xr

from rwmf.assess.table import describe, read_table, refuse_least, table_of, write_table
from rwmf.case import Case, CaseLike, Motion
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError
from rwmf.kernel import files, tables
from rwmf.kernel.names import readable
from rwmf.kernel.numbers import Array, Truths, show, to_array, to_number
from rwmf.motion.intensity import Intensity, choose_intensity, scale_to_one
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.run.quantities import default_quantity, fallen, find_quantities
from rwmf.sweeps.computation import SweepOptions, path_of_store, sweep
from rwmf.sweeps.plan import united

Designs = CaseLike | Mapping[str, CaseLike] | Sequence[CaseLike]
Records = Sequence[str | os.PathLike[str] | RecordFile | Motion]
_MEASURE = ("intensity", "period", "damping", "periods")
# relative width of the interval in which the capacity of a record lies
_TOLERANCE = 0.02
# steps of the hunt beyond the levels, upwards and downwards, and its ends
_UP, _DOWN = 1.5, 0.5
_HIGHEST, _LOWEST = 4.0, 1 / 64
# columns that say which design and record a run has, by their numbers
_KEYS = ["case", "number"]


class AnalysisOptions(SweepOptions, total=False):
    """Arguments that `ida`, `stripes` and `cloud` share.

    Attributes
    ----------
    intensity : str, optional
        A kind of `rwmf.records.intensity`; otherwise the scene's default.
    period, damping : float, optional
        Period [s] and damping ratio [-] of the oscillator, both or none; several designs need them
        unless their own are equal.
    periods : sequence of float, optional
        Periods of an ``average_acceleration`` [s].
    file : str or path, optional
        CSV or NetCDF file to write. Finished chunks are kept beside it: repeating the call
        continues an interrupted analysis and gives the same bytes.
    restart : bool
        Discard an earlier analysis in `file`.
    """

    intensity: str | None
    period: float | None
    damping: float | None
    periods: Sequence[float] | None
    file: str | os.PathLike[str] | None
    restart: bool


class Suite(NamedTuple):
    """Designs and records of an analysis.

    Attributes
    ----------
    kind : str
        ``ida``, ``stripes`` or ``cloud``.
    designs : dict of str to Case
        The structures by name.
    records : tuple of RecordFile
        The suite, with the factors that runs multiply.
    units : numpy.ndarray, shape (records,)
        Factors that scale each record to an intensity of one.
    quantities : tuple of str
        Stored demands.
    measure : Intensity
        Measure of the intensity.
    """

    kind: str
    designs: dict[str, Case]
    records: tuple[RecordFile, ...]
    units: Array
    quantities: tuple[str, ...]
    measure: Intensity


@checked
def ida(
    case: Designs,
    records: Records,
    levels: Sequence[float],
    quantities: str | Sequence[str] | None = None,
    *,
    limits: Mapping[str, float] | None = None,
    tolerance: float = _TOLERANCE,
    highest: float | None = None,
    **further: Unpack[AnalysisOptions],
) -> xr.Dataset:
    """Run an incremental dynamic analysis: levels of intensity, then each record's capacity.

    All records run at all levels. Then each record is scaled further until it reaches its
    capacity, and between the two nearest levels the capacity is bisected in the logarithm. The
    capacity is the lowest run level at which the wall overturns, the frame collapses or the
    magnitude of a demand exceeds its limit.

    Parameters
    ----------
    case : Case, path, mapping or sequence
        The structure, or several designs: a mapping of names to cases, or paths.
    records : sequence of str, path, Motion or RecordFile
        The suite, see `rwmf.records.find_records`.
    levels : sequence of float
        Intensities: accelerations over g [-], others in SI units.
    quantities : str or sequence of str, optional
        Stored demands; otherwise ``u_s_max``, or ``theta_max_over_alpha`` for a wall alone.
    limits : mapping of str to float, optional
        Limits of quantities that count as capacity, in the quantity's unit.
    tolerance : float
        Relative width of the interval that contains the capacity.
    highest : float, optional
        Highest intensity of the search; otherwise four times the highest level.
    **further
        ``intensity``, ``period`` [s], ``damping`` [-] and ``periods`` [s] (the measure), ``file``,
        ``restart``, and ``threads``, ``executor``, ``progress``, ``chunk``, ``unit`` and ``dt`` as
        for `rwmf.sweep`.

    Returns
    -------
    xarray.Dataset
        Table over ``row``: ``design``, ``record``, ``intensity``, ``scale`` (factor on the record),
        the quantities up to a collapse, and ``status``. Statuses are ok, overturned, collapsed and
        names of errors. Rows ascend in intensity for each design and record.

    Raises
    ------
    InputError
        When an argument is not acceptable, or when `file` holds another analysis.
    OutputError
        When the file cannot be written.
    Interrupted
        After Ctrl-C; finished chunks are kept beside `file`.
    """
    found = _limits(limits)
    suite, options = _suite("ida", case, records, [*(quantities or ()), *found], further)
    ladder = np.unique(levels)
    top = _HIGHEST * float(ladder[-1])
    if highest is not None:
        top = to_number("highest", highest, above=0.0)
        if top < ladder[-1]:
            raise InputError(f"highest = {top:g}: must be >= the highest level {ladder[-1]:g}")
    search = _Search(found, tolerance, top, float(ladder[0]) * _LOWEST)
    settings = {"levels": ladder.tolist()} | dataclasses.asdict(search)
    return _run(suite, options, settings, search)


@checked
def stripes(
    case: Designs,
    records: Records,
    levels: Sequence[float],
    quantities: str | Sequence[str] | None = None,
    **further: Unpack[AnalysisOptions],
) -> xr.Dataset:
    """Run all records at all levels of intensity.

    Parameters
    ----------
    case, records, levels, quantities
        As for `rwmf.ida`.
    **further
        As for `rwmf.ida`.

    Returns
    -------
    xarray.Dataset
        Table of `rwmf.ida`, with one row per design, record and level.

    Raises
    ------
    InputError, OutputError, Interrupted
        As `rwmf.ida`.
    """
    suite, options = _suite("stripes", case, records, quantities, further)
    return _run(suite, options, {"levels": np.unique(levels).tolist()})


@checked
def cloud(
    case: Designs,
    records: Records,
    quantities: str | Sequence[str] | None = None,
    *,
    factors: Sequence[float] = (1.0,),
    **further: Unpack[AnalysisOptions],
) -> xr.Dataset:
    """Run records with their own intensities.

    Parameters
    ----------
    case, records, quantities
        As for `rwmf.ida`.
    factors : sequence of float
        Factors on all records [-].
    **further
        As for `rwmf.ida`.

    Returns
    -------
    xarray.Dataset
        Table of `rwmf.ida`, with one row per design, record and factor.

    Raises
    ------
    InputError, OutputError, Interrupted
        As `rwmf.ida`.
    """
    suite, options = _suite("cloud", case, records, quantities, further)
    found = np.unique(to_array("factors", factors, above=0.0, least=1))
    return _run(suite, options, {"factors": found.tolist()})


def designs_of(case: Designs) -> dict[str, Case]:
    """Return the designs of an argument by name."""
    if isinstance(case, Mapping):
        for name in case:
            if not isinstance(name, str):
                raise InputError(f"case: {show(name)}: the name of a design is a text")
        found = {name: case_of(item) for name, item in case.items()}
    else:
        items: list[Any] = list(case) if isinstance(case, list | tuple) else [case]
        cases = [case_of(item) for item in items]
        names = [
            Path(item.label.removesuffix(" (edited)")).stem or f"design {i}"
            for i, item in enumerate(cases, 1)
        ]
        if len(names) == 1 and names[0].startswith("design "):
            names = ["design"]
        if len(set(names)) < len(names):
            raise InputError(f"case: two designs have the same name: {', '.join(names)}")
        found = dict(zip(names, cases, strict=True))
    if not found:
        raise InputError("case: there is no design")
    # the runs of an analysis have one structure; axes of a spectrum do not apply
    return {
        name: item.without("spectrum") if "spectrum" in item.groups else item
        for name, item in found.items()
    }


def _limits(limits: Mapping[str, float] | None) -> dict[str, float]:
    if limits is None:
        return {}
    if not isinstance(limits, Mapping):
        raise InputError(f"limits = {show(limits)}: must be quantities with numbers")
    found = {}
    for word, value in limits.items():
        (name,) = find_quantities((str(word),))
        refuse_least([name])
        found[name] = to_number(f"limits: {name}", value)
    return found


@dataclasses.dataclass(frozen=True)
class _Search:
    """Search for the capacity of a record.

    Attributes
    ----------
    limits : dict of str to float
        Limits of quantities that count as capacity.
    tolerance : float
        Relative width of the last interval.
    highest, lowest : float
        Ends of the search, intensities over g.
    """

    limits: dict[str, float]
    tolerance: float
    highest: float
    lowest: float

    def reached(self, table: xr.Dataset) -> Truths:
        """Find the runs at or above capacity."""
        found = fallen(table)
        for name, limit in self.limits.items():
            found |= np.abs(table[name].values) > limit
        return found

    def next_level(self, levels: Array, reached: Truths) -> float | None:
        """Return the next level of one record, None at the end of its search."""
        if not reached.any():
            top = float(levels.max())
            return min(_UP * top, self.highest) if top < self.highest else None
        first = float(levels[reached].min())
        below = levels[levels < first]
        if not below.size:
            return max(_DOWN * first, self.lowest) if first > self.lowest else None
        last = float(below.max())
        if first <= last * (1 + self.tolerance):
            return None
        middle = math.sqrt(last * first)
        return middle if last < middle < first else None


def _suite(
    kind: str,
    case: Designs,
    records: Records,
    quantities: str | Sequence[str] | None,
    further: AnalysisOptions,
) -> tuple[Suite, dict[str, Any]]:
    """Read designs and records, and scale the records to one measure of intensity."""
    options: dict[str, Any] = dict(further)
    known = AnalysisOptions.__annotations__
    unknown = [name for name in options if name not in known]
    if unknown:
        raise InputError(f"{kind}: {unknown[0]}: is no argument; further are {', '.join(known)}")
    designs = designs_of(case)
    word, period, damping, periods = [options.pop(item, None) for item in _MEASURE]
    measures = {
        name: choose_intensity(item, word, period, damping, (), periods)
        for name, item in designs.items()
    }
    measure, *others = measures.values()
    if any(other != measure for other in others):
        labels = "; ".join(f"{name}: {item.label}" for name, item in measures.items())
        raise InputError(f"the designs differ in intensity, give period and damping ({labels})")
    found = find_records(records, unit=options.pop("unit", None), dt=options.pop("dt", None))
    first = next(iter(designs.values()))
    scaled = scale_to_one(first, found, measure)
    units = np.array([one.scale / own.scale for one, own in zip(scaled, found, strict=True)])
    limited = first.kernel.limited_demands()
    names = tuple(find_quantities((*(quantities or (default_quantity(first),)), *limited)))
    used = found if kind == "cloud" else scaled
    return Suite(kind, designs, used, units, names, measure), options


def _run(
    suite: Suite,
    options: dict[str, Any],
    settings: Mapping[str, Any],
    search: _Search | None = None,
) -> xr.Dataset:
    """Run all stages of an analysis, and write its file."""
    file, restart = options.pop("file", None), options.pop("restart", False)
    attributes = _attributes(suite, settings)
    path = None if file is None else Path(file)
    if path is not None:
        inputs = [record.path for record in suite.records if record.path]
        for case in suite.designs.values():
            inputs += map(str, case.inputs)
        files.check_outputs([path], inputs)
        if path.exists() and not _is_other(path, attributes["request"], restart):
            return read_table(path)
    stages = _Stages(suite, options, path, restart)
    steps = settings["levels" if "levels" in settings else "factors"]
    points = itertools.product(suite.designs, range(len(suite.records)), steps)
    table, warnings = stages.run(list(points))
    while search is not None and (further := list(_next_points(suite, table, search))):
        more, others = stages.run(further)
        warnings += others
        table = pd.concat([table, more])
    columns = table.sort_values([*_KEYS, "intensity"]).drop(columns=_KEYS)
    # stages of a search repeat the warnings of the first one with other numbers
    lines = [
        f"{name}: {line}"
        for name in suite.designs
        for line in united([text for design, text in warnings if design == name])
    ]
    found = table_of(columns, attributes | {"warnings": "\n".join(lines)})
    if path is not None:
        write_table(found, path)
        stages.remove()
    return found


def _is_other(path: Path, request: str, restart: bool) -> bool:
    """Compare the analysis of a file; refuse a different one, discard it at a restart."""
    old = describe(path)
    if restart:
        files.remove(path)
        return True
    if old == request:
        return False
    a, b = json.loads(old), json.loads(request)
    keys = sorted(key for key in {*a, *b} if a.get(key) != b.get(key))
    raise InputError(
        f"{path}: holds another analysis, which differs in {', '.join(keys)}: restart to discard "
        "it, or write to another file"
    )


def _next_points(
    suite: Suite, table: pd.DataFrame, search: _Search
) -> Iterator[tuple[str, int, float]]:
    """Yield the next run of every record whose search goes on."""
    reached = search.reached(table_of(table.drop(columns=_KEYS), {}))
    names = list(suite.designs)
    for (i, record), own in table.reset_index().groupby(_KEYS):
        level = search.next_level(own["intensity"].to_numpy(), reached[own.index])
        if level is not None:
            yield names[i], record, level


@dataclasses.dataclass
class _Stages:
    """Sweeps of an analysis, one for each design and stage."""

    _suite: Suite
    _options: dict[str, Any]
    _path: Path | None
    _restart: bool
    _stage: int = 0
    _files: list[Path] = dataclasses.field(default_factory=list)

    def run(
        self, points: list[tuple[str, int, float]]
    ) -> tuple[pd.DataFrame, list[tuple[str, str]]]:
        """Run points (design, number of the record, factor) and return columns and warnings."""
        parts, warnings = [], []
        for number, design in enumerate(self._suite.designs):
            own = [(record, step) for name, record, step in points if name == design]
            if own:
                found, lines = self._sweep(number, design, own)
                parts.append(found)
                warnings += [(design, line) for line in lines]
        self._stage += 1
        return pd.concat(parts), warnings

    def _sweep(
        self, number: int, design: str, own: list[tuple[int, float]]
    ) -> tuple[pd.DataFrame, list[str]]:
        suite = self._suite
        which = np.array([record for record, _ in own])
        steps = np.array([step for _, step in own])
        unit, power = suite.units[which], suite.measure.power
        is_cloud = suite.kind == "cloud"
        factors = steps if is_cloud else steps ** (1 / power)
        names = np.array([record.name for record in suite.records], dtype=object)
        file = None
        if self._path is not None:
            file = self._path.with_name(f"{self._path.name}.stage-{self._stage}-{number}.nc")
            self._files.append(file)
        found = sweep(
            suite.designs[design],
            records=suite.records,
            points={"record": names[which], "scale": factors},
            quantities=suite.quantities,
            file=file,
            restart=self._restart,
            **self._options,
        )
        with found:
            meanings = np.array(found["status"].attrs["flag_meanings"].split(), dtype=object)
            columns = {
                "design": np.full(which.size, design, dtype=object),
                "record": names[which],
                "intensity": (steps / unit) ** power if is_cloud else steps,
                "scale": factors if is_cloud else factors * unit,
                **{name: found[name].values for name in suite.quantities},
                "status": meanings[found["status"].values],
                "case": np.full(which.size, number),
                "number": which,
            }
            return pd.DataFrame(columns), str(found.attrs["warnings"]).splitlines()

    def remove(self) -> None:
        """Remove the files of all stages after the table is complete."""
        for path in self._files:
            files.remove(path)
            files.remove(path_of_store(path))


def _attributes(suite: Suite, settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes of a table: all that is needed to repeat the analysis."""
    cases = {
        # the records replace a motion in memory, which only its name describes
        name: readable(case.text if set(case.motions) == {"motion"} else case.to_namelist())
        for name, case in suite.designs.items()
    }
    records = {
        record.name: {"crc32": record.crc32, "format": record.format()} for record in suite.records
    }
    version = tables.version()
    request = {
        "version": version,
        "analysis": suite.kind,
        "cases": cases,
        "records": records,
        "quantities": suite.quantities,
        "intensity": suite.measure.attributes,
        **settings,
    }
    return {
        "title": "Runs of rocking wall-moment frames under scaled records",
        "source": f"rwmf {version}",
        "version": version,
        "analysis": suite.kind,
        "g": float(next(iter(suite.designs.values())).model.g),
        "cases": json.dumps(cases),
        "records": json.dumps(records),
        **suite.measure.attributes,
        "intensity_label": suite.measure.label,
        "intensity_unit": "g" if suite.measure.is_over_g else suite.measure.unit,
        **({"levels": settings["levels"]} if "levels" in settings else {}),
        "request": json.dumps(request, sort_keys=True),
    }
