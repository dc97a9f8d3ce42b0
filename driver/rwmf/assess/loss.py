"""Files for pelicun and OpenQuake; factors of FEMA P-695."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

import numpy as np
import xarray as xr

from rwmf.assess.table import quantities_of
from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.kernel import files
from rwmf.kernel.names import xml_text
from rwmf.kernel.numbers import Array, Truths, show, to_items, to_number
from rwmf.run.quantities import fallen

# expected epsilon of the rare motion by seismic design category
_EPSILONS = dict.fromkeys(("B", "C", "DMIN"), 1.0) | {"DMAX": 1.5}
_NAMES = "B, C, Dmin, Dmax"


def spectral_shape_factor(period: float, ductility: float, category: str) -> float:
    """Compute the spectral shape factor of the far-field record set of FEMA P-695.

    This is the formula behind Tables 7-1a and 7-1b. As in the tables, the factor is constant below
    0.5 s, above 1.5 s and above a ductility of 8.
    """
    period = to_number("shape factor: period", period, above=0.0)
    ductility = to_number("shape factor: ductility", ductility)
    if ductility < 1:
        raise InputError(f"shape factor: ductility = {ductility:g}: must be >= 1")
    expected = _EPSILONS.get(str(category).upper())
    if expected is None:
        raise InputError(f"shape factor: category = {show(category)}: must be one of {_NAMES}")
    of_records = 0.6 * (1.5 - min(max(period, 0.5), 1.5))
    slope = 0.14 * (min(ductility, 8.0) - 1.0) ** 0.42
    return math.exp(slope * (expected - of_records))


def shape_factor_of(value: object) -> float:
    """Return the spectral shape factor of an argument."""
    items = to_items(value)
    if items is not None and len(items) == 3:
        return spectral_shape_factor(items[0], items[1], str(items[2]))
    if items is not None:
        raise InputError(
            f"shape_factor = {show(value)}: must be a number, or period, ductility and category"
        )
    return to_number("shape_factor", value, above=0.0)


# quantity, type in pelicun, unit there; a later row is taken where an earlier one is missing
_DEMANDS = (
    (r"storey_(\d+)_drift_max", "PID", "rad"),
    (r"(roof)_drift_max", "PID", "rad"),
    (r"floor_(\d+)_acceleration_max_g", "PFA", "mps2"),
    (r"floor_(\d+)_velocity_max(?:_m_s)?", "PFV", "mps"),
    (r"storey_(\d+)_residual_drift_at_rest", "RID", "rad"),
    (r"storey_(\d+)_residual_drift", "RID", "rad"),
    (r"(roof)_residual_drift_at_rest", "RID", "rad"),
    (r"(roof)_residual_drift", "RID", "rad"),
)
_G = 9.81
_IMTS = {"peak_acceleration": "PGA", "average_acceleration": "AvgSA"}


def loss_quantities(case: Case) -> list[str]:
    """List the demands of a structure that pelicun takes."""
    found = _demands(case.replace(output={"reactions": True}).kernel.applicable())
    names = [name for name, _ in found.values()]
    # the drift of a roof is that of the only storey
    if "1-PID-2-1" in found or any(name.startswith("storey_1_") for name in names):
        names = [name for name in names if not name.startswith("roof_")]
    if not names:
        raise InputError("pelicun: the case has no storey or floor with demands")
    return names


def _demands(names: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Return name and unit of each demand by its column in pelicun."""
    found: dict[str, tuple[str, str]] = {}
    for pattern, kind, unit in _DEMANDS:
        for name in names:
            if match := re.fullmatch(pattern, name):
                place = "1" if match[1] == "roof" else match[1]
                found.setdefault(f"1-{kind}-{place}-1", (name, unit))
    return found


def write_pelicun(table: xr.Dataset, folder: Path) -> list[tuple[Path, int]]:
    """Write the demands of each design and intensity, or cloud, as CSV files of pelicun.

    Separate files, ``..._collapsed.csv``, hold runs that overturned or collapsed, because their
    demands end there. They have no residual drifts. Failed runs are left out.
    """
    columns = _pelicun_columns(table)
    x = table["intensity"].values
    is_cloud = table.attrs.get("analysis") == "cloud"
    levels = np.unique(np.asarray(table.attrs.get("levels", x), dtype=float))
    if is_cloud:
        levels = np.array([math.nan])
    down = fallen(table)
    unit = str(table["intensity"].attrs.get("units", "g"))
    whole = np.all([np.isfinite(values) for values, _ in columns.values()], axis=0)
    # a collapsed run has no residual drift
    lasting = {name: item for name, item in columns.items() if "-RID-" not in name}
    finite = np.all([np.isfinite(values) for values, _ in lasting.values()], axis=0) & bool(lasting)
    with files.reported(folder):
        folder.mkdir(parents=True, exist_ok=True)
    written: list[tuple[Path, int]] = []
    stems: set[str] = set()
    for design in dict.fromkeys(table["design"].values.tolist()):
        for level in levels:
            own = (table["design"].values == design) & (is_cloud | (x == level))
            name = f"{design}_cloud" if is_cloud else f"{design}_{level:g}{unit}"
            stem = re.sub(r"[^\w.-]+", "_", name.lstrip("_"))
            while stem in stems:
                stem += "_"
            stems.add(stem)
            for ending, kept, chosen in (
                ("", columns, own & whole & ~down),
                ("_collapsed", lasting, own & finite & down),
            ):
                if chosen.any():
                    path = folder / f"{stem}{ending}.csv"
                    files.write_bytes(path, _pelicun_text(kept, chosen).encode())
                    written.append((path, int(chosen.sum())))
    return written


def _pelicun_columns(table: xr.Dataset) -> dict[str, tuple[Array, str]]:
    """Return values in pelicun's units, and the unit, by the name of the column there."""
    g = float(table.attrs.get("g", _G))
    names = quantities_of(table)
    found = {
        column: (np.abs(table[name].values) * (g if unit == "mps2" else 1.0), unit)
        for column, (name, unit) in _demands(names).items()
    }
    if not found:
        raise InputError(
            f"pelicun: none of {', '.join(names) or 'no quantity'} is a demand of it: give "
            "storey_1_drift_max, floor_1_acceleration_max_g and others"
        )
    return dict(sorted(found.items()))


def _pelicun_text(columns: dict[str, tuple[Array, str]], chosen: Truths) -> str:
    lines = ["," + ",".join(columns), "Units," + ",".join(unit for _, unit in columns.values())]
    rows = zip(*(values[chosen].tolist() for values, _ in columns.values()), strict=True)
    lines += [f"{i}," + ",".join(map(repr, row)) for i, row in enumerate(rows)]
    return "\n".join(lines) + "\n"


def nrml_text(fragility: xr.Dataset) -> str:
    """Write fragility curves as a fragility model in NRML 0.5, one function per design."""
    kind = str(fragility.attrs.get("intensity", ""))
    imt = _IMTS.get(kind)
    if kind == "pseudo_acceleration":
        imt = f"SA({float(fragility.attrs['intensity_period_s']):g})"
    if imt is None:
        known = ", ".join(("pseudo_acceleration", *_IMTS))
        raise InputError(f"NRML: intensity = {kind or 'unknown'}: must be one of {known}")
    designs = fragility if "design" in fragility.dims else fragility.expand_dims("design")
    x = designs["intensity"].values
    quantity = str(fragility.attrs["quantity"])
    limit = float(np.asarray(fragility["limit"].values).ravel()[0])
    # limit states are words
    quantity = re.sub(r"[^\w.-]+", "_", quantity)
    state = quantity if math.isnan(limit) else f"{quantity}_{limit:g}"
    version = xml_text(str(fragility.attrs.get("version", "")))
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<nrml xmlns="http://openquake.org/xmlns/nrml/0.5">',
        '<fragilityModel id="rwmf" assetCategory="buildings" lossCategory="structural">',
        f"  <description>rwmf {escape(version)}</description>",
        f"  <limitStates>{state}</limitStates>",
    ]
    for i, name in enumerate(designs["design"].values.tolist()):
        median = float(designs["median"].values[i])
        beta = float(designs["dispersion_total"].values[i])
        mean = median * math.exp(0.5 * beta**2)
        deviation = mean * math.sqrt(math.expm1(beta**2))
        lines += [
            f"  <fragilityFunction id={quoteattr(xml_text(str(name)) or 'design')} "
            'format="continuous" shape="logncdf">',
            f'    <imls imt="{imt}" noDamageLimit="0.0" minIML="{x.min():g}" '
            f'maxIML="{x.max():g}"/>',
            f'    <params ls="{state}" mean="{mean!r}" stddev="{deviation!r}"/>',
            "  </fragilityFunction>",
        ]
    return "\n".join([*lines, "</fragilityModel>", "</nrml>"]) + "\n"
