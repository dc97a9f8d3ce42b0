"""Rows of one call as spectra of one period list each, in the place of the kernel's own."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf import _library
from rwmf._sweep.axes import Entries, put_number
from rwmf.case.namelist import compose, parse_value
from rwmf.errors import InputError, NumericalError
from rwmf.quantities import ending_of

Array = npt.NDArray[np.float64]


def _entries(case: _library.KernelCase) -> Entries:
    entries: Entries = {}
    for name, kind, text, _, origin in case.describe():
        group, key = name.split(".", 1)
        entries.setdefault(group, {})
        if origin == "given":
            entries[group][key] = parse_value(kind, text)
    return entries


def _row(base: Entries, columns: Sequence[str], row: Array) -> Entries:
    entries = {group: dict(keys) for group, keys in base.items()}
    for name, value in zip(columns, row.tolist(), strict=True):
        put_number(entries, name, value)
    if "scale" in columns:
        motion = entries["motion"]
        if motion.get("kind") == "record":
            motion.setdefault("scale", 1.0)
        for key in ("scale", "a_max_g", "v_p"):
            if key in motion:
                motion[key] = float(str(motion[key])) * row[columns.index("scale")]
    return entries


def _stops(columns: Sequence[str], values: Array) -> list[int]:
    """Where rows end that differ in a growing period alone."""
    n = len(values)
    if "T_s" not in columns:
        return list(range(1, n + 1))
    others = np.delete(values, columns.index("T_s"), axis=1)
    same = (np.diff(others, axis=0) == 0).all(1) & (np.diff(values[:, columns.index("T_s")]) > 0)
    return [*(np.flatnonzero(~same) + 1).tolist(), n]


@contextmanager
def start_rows(
    case: _library.KernelCase,
    source: str,
    columns: Sequence[str],
    values: Array,
    quantities: Sequence[str],
    threads: int,
    progress: Callable[[int], None] | None,
) -> Iterator[Any]:
    """Compute rows."""
    base = _entries(case)
    found: dict[str, Any] = {key: np.full((1, 1, len(values)), np.nan) for key in quantities}
    found["status"] = np.zeros((1, 1, len(values)), dtype="<U24")
    first = 0
    for stop in _stops(columns, values):
        if progress:
            progress(first)
        part = slice(first, stop)
        entries = _row(base, columns, values[first])
        if "T_s" in entries.get("frame", {}):
            entries["spectrum"] = {"T_s": tuple(values[part, columns.index("T_s")])}
            entries["spectrum"]["quantities"] = tuple(quantities) or ("u_s_max_m",)
        try:
            case = _library.read_case(compose(entries), source, case)
            if "spectrum" in entries:
                with _library.start_spectrum(case, source, threads, progress) as spectrum:
                    results = spectrum.values()
                for key in (*quantities, "status"):
                    found[key][0, 0, part] = results[key].ravel()
            else:
                with _library.start_simulation(case, source) as run:
                    summary = run.summary()
                for key in quantities:
                    found[key][0, 0, part] = summary.get(key, np.nan)
                found["status"][0, 0, part] = ending_of(summary)
        except InputError:
            found["status"][0, 0, part] = "refused"
        except NumericalError:
            found["status"][0, 0, part] = "failed"
        first = stop
    yield SimpleNamespace(values=lambda: found)
