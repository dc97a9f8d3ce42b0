"""The table of rows: one run in each, as dataset, CSV file or NetCDF file.

Columns are ``design``, ``record``, ``intensity``, ``scale``, the quantities and ``status``. The
attributes hold everything that is needed to repeat the runs; in CSV they stand in the first line,
a comment.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr

from rwmf.case.arguments import array_of, checked
from rwmf.errors import InputError
from rwmf.kernel import files
from rwmf.kernel.files import new_file, path_of
from rwmf.kernel.names import readable, shorten
from rwmf.kernel.numbers import Array, Wholes, first_masked, show, to_array, to_items
from rwmf.run.arguments import dataset_of
from rwmf.run.quantities import ENDINGS, fallen, find_quantities, is_least
from rwmf.sweeps import netcdf
from rwmf.sweeps.points import is_netcdf, read_csv, read_netcdf

TEXTS = ("design", "record", "status")
COLUMNS = (*TEXTS, "intensity", "scale")
_MARK = "# rwmf "
_LABELS = {
    "design": {"long_name": "case of the run"},
    "record": {"long_name": "ground motion"},
    "intensity": {"units": "g", "long_name": "intensity of the scaled record"},
    "scale": {"units": "1", "long_name": "factor on the record"},
    "status": {"long_name": "ok, overturned, collapsed, or the name of an error"},
}
# statuses of failed runs, without a result or with an inaccurate one
_FAILED = ("inaccurate", "refused", "input", "interrupted", "numerical_failure", "too_many_steps",
           "out_of_memory", "wall_jumps")  # fmt: skip
# statuses by the words, in lower case, that another program may write
_STATUSES = {name: name for name in ("ok", *ENDINGS, *_FAILED)} | {
    "collapse": "collapsed",
    "overturn": "overturned",
    "overturning": "overturned",
    "no collapse": "ok",
    "survived": "ok",
}
_WEIGHTS = ("weight", "weights")
# columns that state the end of a run where the table has no status
_ENDED = ("collapse", *ENDINGS)


def table_of(
    columns: Mapping[str, Any],
    attributes: Mapping[str, Any],
    lines: Wholes | None = None,
) -> xr.Dataset:
    """Make a table from its columns."""
    found = {str(name): np.asarray(values) for name, values in columns.items()}
    if "intensity" not in found:
        raise InputError(f"table: has no column intensity, only {', '.join(found) or 'none'}")
    x = found["intensity"]
    n = x.size
    places = [f"row {i + 1}" for i in range(n)] if lines is None else [f"line {i}" for i in lines]
    has_status = "status" in found
    found.setdefault("design", np.full(n, "", dtype=object))
    found.setdefault("record", np.array([str(i) for i in range(n)], dtype=object))
    found.setdefault("scale", np.ones(n))
    found.setdefault("status", np.full(n, "ok", dtype=object))
    for name, values in found.items():
        if values.shape != (n,):
            raise InputError(f"table: {name}: has the shape {values.shape}: must be ({n},)")
        if name in TEXTS:
            texts = [str(value) for value in values.tolist()]
            if name == "status":
                texts = _statuses(texts, places)
            found[name] = np.array(texts, dtype=object)
        elif name.lower() in _WEIGHTS:
            raise InputError(f"table: {name}: rows have no weights: leave out the column")
        elif not has_status and name.lower() in _ENDED:
            raise InputError(f"table: {name}: state the ends of runs in the column status")
        elif values.dtype.kind not in "iuf":
            raise InputError(f"table: {name}: must be a column of numbers")
        else:
            found[name] = values.astype(float)
    x = found["intensity"]
    wrong = ~(np.isfinite(x) & (x > 0))
    if n == 0 or wrong.any():
        i = int(np.argmax(wrong)) if n else 0
        where, value = (f", {places[i]}", f"{x[i]:g}") if n else ("", "no row")
        raise InputError(f"table{where}: intensity = {value}: must be finite numbers > 0")
    names = ["design", "record", "intensity", "scale"]
    names += [name for name in found if name not in COLUMNS]
    columns = {
        name: ("row", found[name], _LABELS.get(name) or _labels(name))
        for name in [*names, "status"]
    }
    dataset = xr.Dataset(columns, attrs=attributes)
    unit = str(dataset.attrs.get("intensity_unit", "g"))
    dataset["intensity"].attrs |= {"units": unit}
    return dataset


def _statuses(words: list[str], places: Sequence[str]) -> list[str]:
    """Return the statuses of the rows; an unknown word could hide a collapse."""
    found = [_STATUSES.get(word.strip().lower()) for word in words]
    if None in found:
        i = found.index(None)
        raise InputError(
            f"table, {places[i]}: status = {show(words[i])}: must be one of {', '.join(_STATUSES)}"
        )
    return [status for status in found if status is not None]


def _labels(name: str) -> dict[str, str]:
    try:
        (quantity,) = find_quantities((name,)).values()
    except InputError:
        return {}
    return quantity.attributes


def quantities_of(table: xr.Dataset) -> list[str]:
    """List the demands of a table."""
    return [str(name) for name in table.data_vars if name not in COLUMNS]


def read_table(source: Any) -> xr.Dataset:  # noqa: ANN401 (several forms)
    """Read a table of rows."""
    if isinstance(source, list | tuple):
        return join([read_table(item) for item in source])
    if isinstance(source, str | os.PathLike):
        path = Path(path_of("table", source))
        try:
            return _read_file(path)
        except InputError as error:
            text = str(error)
            raise InputError(text if text.startswith(str(path)) else f"{path}: {text}") from error
    if isinstance(source, xr.Dataset):
        if len(source.sizes) != 1:
            raise InputError(
                f"table: has the dimensions {', '.join(map(str, source.sizes)) or 'none'}: must "
                "have one, its rows"
            )
        columns = {str(name): source[name].values for name in source.variables}
        columns.pop(str(next(iter(source.sizes))), None)
        return table_of(columns, source.attrs)
    if hasattr(source, "columns") and hasattr(source, "to_numpy"):
        return table_of({name: source[name].to_numpy() for name in source.columns}, {})
    if isinstance(source, Mapping):
        return table_of(_arrays(source), {})
    raise InputError(
        f"table = {show(source)}: must be a path, a dataset, a mapping or a pandas.DataFrame"
    )


def _arrays(columns: Mapping[Any, Any]) -> dict[str, npt.NDArray[Any]]:
    found = {}
    for name, values in columns.items():
        masked = first_masked(values)
        if masked is not None:
            raise InputError(f"table: {show(name)}: the value at position {masked} is masked")
        try:
            found[str(name)] = np.atleast_1d(np.asarray(values))
        except Exception as error:
            raise InputError(f"table: {show(name)}: must be a column of values") from error
    return found


def _read_file(path: Path) -> xr.Dataset:
    if is_netcdf(path):
        if not path.is_file():
            raise InputError(f"{path}: the file does not exist, or is no regular file")
        return read_table(read_netcdf(path))
    columns, lines = read_columns(path, set(TEXTS), "table")
    with path.open(encoding="utf-8", errors="replace") as file:
        first = file.readline()
    attributes = {}
    if first.startswith(_MARK):
        try:
            attributes = json.loads(first.removeprefix(_MARK))
        except ValueError as error:
            raise InputError(f"{path}, line 1: the attributes are damaged: {error}") from error
    return table_of(columns, attributes, lines)


def read_columns(
    path: Path, texts: set[str], content: str
) -> tuple[dict[str, npt.NDArray[Any]], Wholes]:
    """Read the columns of a CSV file."""
    if not Path(path_of(content, path)).is_file():
        raise InputError(f"{path}: the {content} does not exist, or is no regular file")
    return read_csv(path, lambda name: name not in texts)


def join(tables: Sequence[xr.Dataset]) -> xr.Dataset:
    """Join tables whose intensities have one measure."""
    if not tables:
        raise InputError("table: the list is empty")
    first = tables[0]
    for table in tables[1:]:
        keys = {key for key in (*first.attrs, *table.attrs) if key.startswith("intensity")}
        for key in sorted(keys):
            old, new = first.attrs.get(key), table.attrs.get(key)
            if old is not None and new is not None and not _same(old, new):
                raise InputError(f"tables: differ in {key}: {old} and {new}: give both one measure")
    if len(tables) == 1:
        return first
    columns = pd.concat([table.to_dataframe() for table in tables])
    attributes = {
        key: value
        for key, value in first.attrs.items()
        if all(key in table.attrs and _same(table.attrs[key], value) for table in tables)
    }
    for key in ("cases", "records"):
        if all(key in table.attrs for table in tables):
            parts: dict[str, Any] = {}
            for table in tables:
                parts |= json.loads(table.attrs[key])
            attributes[key] = json.dumps(parts)
    warnings = [line for table in tables for line in warnings_of(table)]
    return table_of(columns, attributes | {"warnings": "\n".join(dict.fromkeys(warnings))})


def warnings_of(dataset: xr.Dataset) -> list[str]:
    """Return the warnings about a result."""
    return str(dataset.attrs.get("warnings", "")).splitlines()


def _same(old: object, new: object) -> bool:
    return bool(np.array_equal(np.asarray(old), np.asarray(new)))


def write_table(table: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a table as CSV or NetCDF; equal tables give equal bytes."""
    if is_netcdf(Path(path)):
        write_dataset(table, path)
        return
    names = [str(name) for name in table.data_vars]
    attributes = {key: np.asarray(value).tolist() for key, value in table.attrs.items()}
    lines = [_MARK + json.dumps(attributes, sort_keys=True), ",".join(names)]
    columns = [_cells(table[name].values) for name in names]
    lines += [",".join(row) for row in zip(*columns, strict=True)]
    files.write_bytes(path, ("\n".join(lines) + "\n").encode())


def _cells(values: npt.NDArray[Any]) -> Iterable[str]:
    if values.dtype.kind == "f":
        return [repr(value) for value in values.tolist()]
    return [_quoted(str(readable(value))) for value in values.tolist()]


def _quoted(text: str) -> str:
    is_special = set(text) & set(',;\t"\n\r') or text.startswith("#") or text != text.strip()
    return '"' + text.replace('"', '""') + '"' if is_special else text


def write_dataset(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset as NetCDF without a time stamp."""
    netcdf.check_package()
    texts = {
        str(name): item.copy(data=np.vectorize(readable, otypes="O")(item.values).astype(str))
        for name, item in dataset.variables.items()
        if item.dtype.kind in "UO" and item.size
    }
    attributes = {str(key): readable(value) for key, value in dataset.attrs.items()}
    with new_file(Path(path)) as (file, _):
        whole = dataset.assign(texts).assign_attrs(attributes)
        whole.dump_to_store(xr.backends.H5NetCDFStore(file))


def describe(path: Path) -> str:
    """Return the request that made the table of a file."""
    try:
        return str(read_table(path).attrs["request"])
    except (InputError, KeyError):
        raise InputError(f"{shorten(path)}: exists and is not the table of an analysis") from None


# median and one standard deviation of a normal distribution on both sides
_USUAL = (16.0, 50.0, 84.0)


@checked
def demand_percentiles(
    table: Any,  # noqa: ANN401 (several forms)
    quantities: str | Sequence[str] | None = None,
    q: Sequence[float] = _USUAL,
) -> xr.Dataset:
    """Compute percentiles of demands, by magnitude and ranks, over the records at each level.

    The demand of a record between two of its levels is interpolated; above its first overturning or
    collapse it is infinite.

    Parameters
    ----------
    table : xarray.Dataset or path
        Table of `rwmf.ida` or `rwmf.stripes`.
    quantities : str or sequence of str, optional
        Demands; all of the table when absent.
    q : sequence of float
        Percentages [%].

    Returns
    -------
    xarray.Dataset
        Each demand over ``design``, ``intensity`` and ``percentile``, infinite where so many
        records overturned or collapsed; ``collapsed`` and ``runs`` count records.

    Raises
    ------
    InputError
        When an argument is not acceptable, or when the table is a cloud.
    """
    rows = read_table(table)
    if rows.attrs.get("analysis") == "cloud":
        raise InputError("percentiles: the table is a cloud, without common levels of intensity")
    known = quantities_of(rows)
    names = [name for name in known if not is_least(name)] if quantities is None else quantities
    unknown = [name for name in names if name not in known]
    if unknown:
        listed = ", ".join(known) or "none"
        raise InputError(f"quantities: {show(unknown[0])}: is not in the table, which has {listed}")
    refuse_least(names)
    percent = to_array("q", q, least=1)
    if not ((percent >= 0) & (percent <= 100)).all():
        raise InputError(f"q = {show(q)}: must be in [0, 100] [%]")
    levels = np.unique(rows["intensity"].values)
    designs = list(dict.fromkeys(rows["design"].values.tolist()))
    shape = (len(designs), levels.size)
    found = {name: np.full((*shape, percent.size), math.nan) for name in names}
    counts = np.zeros((2, *shape), dtype=int)
    for i, design in enumerate(designs):
        own = rows.isel(row=np.flatnonzero(rows["design"].values == design))
        for name in names:
            values = _curves(own, name, levels)
            used = ~np.isnan(values).all(axis=0)
            # interpolation between a number and infinity would give infinity
            found[name][i, used] = np.nanquantile(
                values[:, used], percent / 100, axis=0, method="inverted_cdf"
            ).T
        where = np.searchsorted(levels, own["intensity"].values)
        counts[0, i] = np.bincount(where[fallen(own)], minlength=levels.size)
        counts[1, i] = np.bincount(where, minlength=levels.size)
    over = ("design", "intensity")
    return xr.Dataset(
        {name: ((*over, "percentile"), values, rows[name].attrs) for name, values in found.items()}
        | {"collapsed": (over, counts[0]), "runs": (over, counts[1])},
        coords={
            "design": ("design", np.array(designs, dtype=object)),
            "intensity": ("intensity", levels, rows["intensity"].attrs),
            "percentile": ("percentile", percent, {"units": "%"}),
        },
        attrs=rows.attrs,
    )


def _curves(rows: xr.Dataset, name: str, levels: Array) -> Array:
    """Interpolate each record's demand at the levels; NaN above its last run without collapse."""
    found = []
    names = rows["record"].values
    for record in dict.fromkeys(names.tolist()):
        own = rows.isel(row=np.flatnonzero(names == record))
        x, y, down = own["intensity"].values, np.abs(own[name].values), fallen(own)
        first = x[down].min() if down.any() else math.inf
        upright = (x < first) & ~np.isnan(y)
        order = np.argsort(x[upright], kind="stable")
        px, py = x[upright][order], y[upright][order]
        curve = np.full(levels.size, math.nan)
        if px.size:
            inside = levels <= px[-1]
            # a scaled record of no intensity has no demand
            curve[inside] = np.interp(levels[inside], [0.0, *px], [0.0, *py])
        if down.any():
            curve[levels > (px[-1] if px.size else 0.0)] = math.inf
        found.append(curve)
    return np.array(found)


def refuse_least(names: Iterable[str]) -> None:
    """Refuse smallest values as demands."""
    for name in filter(is_least, names):
        raise InputError(
            f"quantities: {name}: is a smallest value, which falls with the intensity: name a "
            "largest one"
        )


def with_overturning(dataset: xr.Dataset, name: str = "u_s_max") -> xr.DataArray:
    """Return a quantity of a sweep, infinite for overturning or collapse (a smallest: -inf)."""
    stands = dataset["status"].copy(data=~fallen(dataset))
    worst = -np.inf if is_least(name) else np.inf
    return dataset[name].where(stands, worst).assign_attrs(dataset[name].attrs)


@checked
def quantile(
    dataset: xr.Dataset,
    quantity: str = "u_s_max",
    q: float | Sequence[float] = (0.16, 0.5, 0.84),
    dim: str = "record",
) -> xr.DataArray:
    """Compute quantiles of a quantity over a suite; overturned and collapsed runs are infinite.

    Values keep their sign: take the magnitudes of residual drifts first. A smallest value, such as
    ``pivot_normal_min``, counts as minus infinity in such a run.

    A quantile is the value of a run, by ranks, because no number lies between a finite and an
    infinite one. It is infinite where too many runs overturned or collapsed; the quantiles of
    xarray would use the last peaks of such runs.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.sweep`, `rwmf.spectrum` or an incremental dynamic analysis.
    quantity : str
        Variable of the dataset.
    q : float or sequence of float
        Shares of the runs at or below the quantile, in [0, 1].
    dim : str
        Dimension of the suite.

    Returns
    -------
    xarray.DataArray
        Quantiles over ``quantile`` (unless `q` is one number) and the other dimensions, without
        failed runs.

    Raises
    ------
    InputError
        When the dataset lacks status, quantity or dimension, or a share is not in [0, 1].

    Examples
    --------
    >>> rwmf.quantile(rwmf.sweep(case, records=suite), "u_s_max", 0.84)  # doctest: +SKIP
    """
    dataset = dataset_of(dataset, "rwmf.sweep, rwmf.spectrum or a study", "status")
    if quantity not in dataset.data_vars or quantity == "status":
        names = ", ".join(str(name) for name in dataset.data_vars if name != "status")
        raise InputError(f"quantity = {show(quantity)}: is not in the dataset, which has {names}")
    shares = to_array("q", q, least=1)
    if not ((shares >= 0) & (shares <= 1)).all():
        raise InputError(f"q = {show(q)}: must be in [0, 1]")
    values = array_of(with_overturning(dataset, quantity), dim)
    # linear interpolation between a number and infinity would give infinity or NaN
    found = values.quantile(shares, dim, method="inverted_cdf", keep_attrs=True, skipna=True)
    return found.isel(quantile=0) if to_items(q) is None else found
