"""Datasets of results; that of one run has storeys and floors as dimensions, and a headline."""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import cache
from html import escape
from typing import TYPE_CHECKING, Any, Self, TypeVar, cast, overload

import numpy as np
import pandas as pd
import xarray as xr
from xarray.plot.accessor import DatasetPlotAccessor

from rwmf.errors import InputError
from rwmf.kernel.numbers import Array
from rwmf.run.headline import grouped, headline, is_complete
from rwmf.run.quantities import INSTANT, QUANTITIES, Quantity

if TYPE_CHECKING:
    from rwmf.figures.styles import Panels

# dimensions of quantities with a number
LEVELS = ("storey", "floor", "mode", "tendon", "fuse", "restraint")

# columns of a static curve that no history has: name, unit and meaning
OWN = {
    "roof_drift": ("roof_drift", "1", "displacement of the roof over its height"),
    "roof_displacement_m": ("roof_displacement", "m", "displacement of the roof"),
    **{
        f"energy_{name}_J_per_kg": (f"energy_{name}", "J/kg", f"{text}, over the reference mass")
        for name, text in (
            ("stored", "energy of springs, cable, wall and weights"),
            ("work", "work of the load along the path"),
            ("released", "energy that jumps of free floors would give to motion"),
        )
    },
}


class Response(xr.Dataset):  # type: ignore[no-untyped-call]
    """Response of a case: the dataset of `rwmf.simulate`.

    A quantity of every storey or floor is one variable: ``storeys_drift_max`` over the dimension
    ``storey``, ``floors_acceleration_max_g`` over ``floor``. Coordinates are the numbers from the
    ground up, ``storey_height`` (from floor to floor) and ``floor_height`` (above the base) [m]. A
    name with a number is the value of that storey or floor: ``response["storey_3_drift_max"]``.
    Floors without a value, for example without a link, are NaN. Modes, tendons, fuses and
    restraints are numbered likewise, elements in the order of their `offset`.

    Printing shows the headline, the scalars by group, and the names of the histories.

    Parameters
    ----------
    data_vars, coords, attrs : mapping, optional
        As those of `xarray.Dataset`.

    Raises
    ------
    InputError
        When `xarray.Dataset` refuses an argument.
    """

    __slots__ = ()

    def __init__(self, data_vars: Any = None, coords: Any = None, attrs: Any = None) -> None:  # noqa: ANN401 (as xarray)
        """Make a dataset as xarray does."""
        try:
            super().__init__(data_vars, coords, attrs)
        except (AttributeError, TypeError, ValueError) as error:
            raise InputError(f"Response: must have the arguments of a Dataset: {error}") from error

    @overload
    def __getitem__(self, key: Hashable) -> xr.DataArray: ...
    @overload
    def __getitem__(self, key: Iterable[Hashable]) -> Self: ...

    def __getitem__(self, key: Hashable | Iterable[Hashable]) -> Self | xr.DataArray:
        """Return a variable, or a dataset of several; names may have the number of a storey."""
        if isinstance(key, list):
            numbered = {name: self[name] for name in key if self._numbered(name) is not None}
            return xr.Dataset.__getitem__(self.assign(numbered) if numbered else self, key)
        found = self._numbered(key)
        return cast("xr.DataArray", super().__getitem__(key)) if found is None else found

    def __contains__(self, key: object) -> bool:
        """Tell whether the dataset has a variable; names may have the number of a storey."""
        return super().__contains__(key) or self._numbered(key) is not None

    def __getattr__(self, name: str) -> xr.DataArray:
        """Return a variable, which may have the number of a storey, or an attribute."""
        found = None if name.startswith("_") else self._numbered(name)
        return cast("xr.DataArray", super().__getattr__(name)) if found is None else found

    def _numbered(self, name: object) -> xr.DataArray | None:
        """Return the variable of one storey or floor; None for other names."""
        parts = (
            re.fullmatch(r"([a-z_]+?)_(\d+)((?:_\w+)?)", name) if isinstance(name, str) else None
        )
        if parts is None or name in self._variables:
            return None
        over_levels = f"{parts[1]}s{parts[3]}"
        dims = self._variables[over_levels].dims if over_levels in self._variables else ()
        for level in LEVELS:
            if level in dims and level in self._variables:
                places = np.flatnonzero(self._variables[level].values == int(parts[2]))
                found = xr.Dataset.__getitem__(self, over_levels)[{level: places}]
                if not found.size or found.isnull().all():
                    return None
                meaning = str(found.attrs.get("long_name", ""))
                meaning = meaning.replace(f"each {level}", f"{level} {parts[2]}")
                one = found.squeeze(level).drop_vars([level, f"{level}_height"], errors="ignore")
                return one.rename(parts[0]).assign_attrs(long_name=meaning)
        return None

    def flat(self) -> dict[str, Any]:
        """Return the scalars of the run with the keys of ``rwmf run --json``.

        Returns
        -------
        dict
            Values by key; a quantity of every storey or floor has a key for each.
        """
        found: dict[str, Any] = {}
        for name, (quantity, key) in _names_of_runs().items():
            if name not in self._variables or key in found:
                continue
            values = xr.Dataset.__getitem__(self, name)
            if values.dims == () and not quantity.level:
                found[key] = values.item()
            elif values.dims == (quantity.level,):
                for number, value in zip(values[quantity.level].values, values.values, strict=True):
                    if not np.isnan(value):
                        found[key.replace("{i}", str(number))] = value.item()
        return found | {key: self.attrs[key] for key in QUANTITIES if key in self.attrs}

    def headline(self) -> str:
        """Return the main results: six lines with displacement, drifts, forces and events.

        Returns
        -------
        str
            The lines, followed by one for each warning.

        Raises
        ------
        InputError
            When the dataset is not a complete run, for example a selection of variables.
        """
        scalars = self.flat()
        if not is_complete(scalars):
            raise InputError("headline: the dataset must have all scalars of rwmf.simulate")
        lines = headline(scalars, self.attrs.get("tendon_yield_over_m_w_g"))
        return "\n".join([*lines, *self._warnings()])

    def _warnings(self) -> list[str]:
        """Return a line for each warning."""
        lines = str(self.attrs.get("warnings", "")).splitlines()
        return [f"{'warning':26s}{line}" for line in lines]

    def __repr__(self) -> str:
        """Show the headline, the scalars by group, and the names of the histories."""
        scalars = self.flat()
        if not is_complete(scalars):
            return "\n".join([super().__repr__(), *self._warnings()])
        sizes = ", ".join(f"{name} {size}" for name, size in self.sizes.items())
        known = {name for name, (_, key) in _names_of_runs().items()}
        others = [
            f"{name} [{values.attrs.get('units', '1')}]"
            for name, values in self.data_vars.items()
            if name not in known or "time" in values.dims
        ]
        lines = [f"<rwmf.Response> {sizes}", self.headline(), *grouped(scalars, has_names=True)]
        return "\n".join([*lines, *([f"over time: {', '.join(others)}"] if others else [])])

    def table(self) -> pd.DataFrame:
        """Return the history as a table: a row for each time, a column for each quantity.

        Returns
        -------
        pandas.DataFrame
            Over the time [s], or over the steps of a static curve. A quantity of every storey or
            floor has a column for each: ``storey_1_drift``. The attribute ``units`` maps the
            columns to their units.

        Raises
        ------
        InputError
            When the dataset has no history.
        """
        over = "step" if "step" in self.dims else "time"
        if over not in self.dims:
            raise InputError(
                "table: no history: simulate with an interval, simulate(case, dt=0.01)"
            )
        columns, units = {}, {}
        for name, values in self.data_vars.items():
            if values.dims[:1] != (over,):
                continue
            parts = {str(name): values}
            for level in values.dims[1:]:
                # storeys_drift of storey 2 is storey_2_drift
                before, _, after = f"{name}_".partition("s_")
                parts = {
                    f"{before}_{number}_{after}".rstrip("_"): values.isel({level: i})
                    for i, number in enumerate(self[level].values.tolist())
                }
            for column, part in parts.items():
                columns[column] = part.values
                units[column] = str(values.attrs.get("units", ""))
        found = pd.DataFrame(columns, index=pd.Index(self[over].values, name=over))
        found.attrs["units"] = units
        return found.dropna(axis="columns", how="all")

    def to_dataframe(self, dim_order: Sequence[Hashable] | None = None) -> pd.DataFrame:
        """Convert as xarray does, a history without events, a curve without marks; see `table`.

        Parameters
        ----------
        dim_order : sequence of str, optional
            Order of the dimensions in the index.

        Returns
        -------
        pandas.DataFrame
            A row for each combination of time and storey.
        """
        beside = {"time": "event", "step": "mark"}
        others = [other for over, other in beside.items() if {over, other} <= set(self.dims)]
        return xr.Dataset.to_dataframe(self.drop_dims(others), dim_order)

    @property
    def plot(self) -> Plot:  # type: ignore[override]
        """Draw the history or curve, ``response.plot()``; methods of xarray: ``plot.scatter``."""
        return Plot(self)

    def _repr_html_(self) -> str:
        """Show the headline in a notebook, above the folded table of xarray."""
        table = str(super()._repr_html_())
        lines = [self.headline()] if is_complete(self.flat()) else self._warnings()
        text = "\n".join(lines)
        if not text:
            return table
        folded = f"<details><summary>all variables</summary>{table}</details>"
        return f"<pre>{escape(text)}</pre>{folded}"


class Plot(DatasetPlotAccessor):
    """Drawing of a response."""

    def __call__(self, *args: Any, **further: Any) -> Panels:  # type: ignore[override]  # noqa: ANN401 (as the function)
        """Draw with the further arguments of `rwmf.plot.history`, or of `rwmf.plot.pushover`."""
        if "step" in self._ds.dims:
            from rwmf.figures.results import pushover

            return np.array([pushover(self._ds, *args, **further)])
        from rwmf.figures.histories import history

        return history(self._ds, *args, **further)


@cache
def _names_of_runs() -> dict[str, tuple[Quantity, str]]:
    """Return quantity and key for each name of a scalar in a dataset."""
    return {
        name: (item, key)
        for key, item in QUANTITIES.items()
        if "run" in item.outputs.split()
        for name in (item.over_levels if item.level else item).names("run")
    }


def as_response(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset with names of single storeys and floors, for example one from a file."""
    if isinstance(dataset, Response) or not set(LEVELS) & set(dataset.dims):
        return dataset
    return Response(dataset.data_vars, dataset.coords, dataset.attrs)


def columns_by_key(curve: xr.Dataset) -> dict[str, Array]:
    """Return the columns of a curve by their keys, as in CSV and JSON."""
    keys = {name: key for key, (name, _, _) in OWN.items()}
    for key, quantity in (QUANTITIES | INSTANT).items():
        if "history" in quantity.outputs.split():
            item = quantity.over_levels if quantity.level else quantity
            keys.setdefault(item.names("history")[0], key)
    found = {}
    for name, values in curve.data_vars.items():
        if str(name) not in keys:
            continue
        # no negative zeros
        table = values.values.reshape(len(values), -1).T + 0.0
        for number, column in enumerate(table, 1):
            if not np.isnan(column).all():
                found[keys[str(name)].replace("{i}", str(number))] = column
    return found


def marks_of(curve: xr.Dataset) -> list[tuple[str, int, float]]:
    """List the marks of a curve: name, step and drift of the roof."""
    columns = (curve[name].values.tolist() for name in ("mark", "mark_step", "mark_roof_drift"))
    return list(zip(*columns, strict=True))


_Made = TypeVar("_Made", bound=xr.Dataset)
# dimensions, values and attributes of a variable, as xarray takes them
Labelled = tuple[tuple[str, ...], Any, Mapping[str, Any]]


def dataset(
    variables: Mapping[str, Labelled],
    coordinates: Mapping[str, Labelled],
    attributes: Mapping[str, Any],
    kind: type[_Made] = xr.Dataset,  # type: ignore[assignment]
) -> _Made:
    """Assemble arrays of matching dimensions into a dataset."""
    # xarray's constructor from known parts, which some versions lack
    make: Callable[..., _Made] | None = getattr(kind, "_construct_direct", None)
    if make is None:
        return kind(dict(variables), dict(coordinates), dict(attributes))
    sizes: dict[str, int] = {}
    indexes: dict[str, xr.indexes.PandasIndex] = {}
    made: dict[str, xr.Variable] = {}
    for name, (dims, values, attrs) in (*variables.items(), *coordinates.items()):
        # arrays need no conversion by xarray, which would import dask and SciPy where they exist
        variable = xr.Variable(dims, np.asarray(values), attrs, fastpath=True)
        sizes |= zip(dims, variable.shape, strict=True)
        if name in coordinates and dims == (name,):
            # the index already has this name and need not be copied to get one
            index = pd.Index(variable.values, name=name)
            indexes[name] = xr.indexes.PandasIndex(index, name, coord_dtype=variable.dtype)
            variable = indexes[name].create_variables({name: variable})[name]
        made[name] = variable
    return make(made, set(coordinates), sizes, dict(attributes), indexes)
