"""One group of a case: typed values with their units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from html import escape
from keyword import iskeyword
from types import MappingProxyType
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from rwmf.case.namelist import Value, format_value, parse_value
from rwmf.kernel import tables
from rwmf.kernel.numbers import show


class Group(Mapping[str, Value]):
    """The values of one namelist group, by attribute or by key; keys match in any case.

    Attributes
    ----------
    given : frozenset of str
        The keys given in the case; the others have the kernel's defaults.
    derived : frozenset of str
        Ratios derived from dimensional keys.
    units : mapping of str to str
        Units of the values, by the names of the kernel.
    in_si : mapping of str to (float or tuple of float, str)
        Dimensional values of ratios to the mass or the weight of the wall, with their units (kg,
        N, N/m or N s/m). Empty without a mass in the case.
    """

    __slots__ = ("_name", "_raw", "_values", "derived", "given", "in_si", "units")

    derived: frozenset[str]
    given: frozenset[str]
    in_si: Mapping[str, tuple[Value, str]]
    units: Mapping[str, str]
    _name: str
    _raw: dict[str, Value]
    _values: dict[str, Value]

    def __init__(self, name: str, rows: list[list[str]]) -> None:
        put = super().__setattr__
        put("_name", name)
        put("_values", {key: parse_value(kind, text) for key, kind, text, *_ in rows})
        put("units", MappingProxyType({key: unit for key, _, _, unit, *_ in rows}))
        put("given", frozenset(row[0] for row in rows if row[4] == "given"))
        put("derived", frozenset(row[0] for row in rows if row[4] == "derived"))
        both = [row for row in rows if len(row) > 5]
        si = {row[0]: (parse_value(row[1], row[5]), row[6]) for row in both if row[6]}
        put("in_si", MappingProxyType(si))
        put("_raw", {row[0]: parse_value(row[1], row[7]) for row in both if row[7]})

    def as_given(self) -> dict[str, Value]:
        """Return the given values, before rules convert them."""
        return {key: self._raw.get(key, self._values[key]) for key in self if key in self.given}

    def __getitem__(self, key: str) -> Value:
        """Return the value of a key."""
        for name, value in self._values.items():
            if name.lower() == key.lower():
                return value
        raise KeyError(key)

    if not TYPE_CHECKING:
        # type checkers use the declared keys

        def __getattr__(self, name: str) -> Value:
            """Return the value of a key."""
            # copy and pickle look up private names before they exist
            if name.startswith("_"):
                raise AttributeError(name)
            try:
                return self[name]
            except KeyError:
                known = ", ".join(self._values)
                raise AttributeError(
                    f"&{self._name} of this case has no {name}; it has {known}"
                ) from None

    def __dir__(self) -> list[str]:
        """List the attributes, with the keys that have a value."""
        return [*super().__dir__(), *(key for key in self if not iskeyword(key))]

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse: a case never changes."""
        raise AttributeError(
            f"a case cannot be changed; case.replace({self._name}={{{name!r}: {show(value)}}}) "
            "returns another one"
        )

    def __iter__(self) -> Iterator[str]:
        """Iterate over the keys."""
        return iter(self._values)

    def __len__(self) -> int:
        """Count the keys."""
        return len(self._values)

    def __repr__(self) -> str:
        """Show the given values, then the defaults in parentheses."""
        given = ", ".join(self._show(key) for key in self if key in self.given)
        others = ", ".join(self._show(key) for key in self if key not in self.given)
        return given + ("  " if given and others else "") + (f"({others})" if others else "")

    def _repr_html_(self) -> str:
        """Show a table in a notebook: values, units and meanings; defaults are grey."""
        return f"<table>{self._html_rows()}</table>"

    def _html_rows(self) -> str:
        """Return the rows of the table: group, key, value, meaning; given keys first."""
        names = sorted(self, key=lambda key: key not in self.given)
        meanings = {row.key: row.meaning for row in tables.schema() if row.group == self._name}
        rows = []
        for key in names:
            grey = "" if key in self.given else ' style="color:gray"'
            value = self._show(key).removeprefix(f"{key} = ")
            cells = (f"&{self._name}" if key == names[0] else "", key, value, meanings.get(key, ""))
            rows.append(
                f"<tr{grey}>"
                + "".join(f'<td style="text-align:left">{escape(cell)}</td>' for cell in cells)
                + "</tr>"
            )
        return "".join(rows)

    def _show(self, key: str) -> str:
        unit = self.units[key]
        value = self._values[key]
        if key not in self.given:
            # remove the round-off of a derived product
            value = _rounded(value)
        shown = f"{key} = {_shorten(value)}" + (f" {unit}" if unit.strip("-") else "")
        if key not in self.in_si:
            return shown
        numbers, unit = self.in_si[key]
        rounded = np.vectorize(lambda number: float(f"{number:.6g}"))(numbers).tolist()
        return f"{shown} [{_shorten(tuple(rounded) if np.ndim(numbers) else rounded)} {unit}]"


def _rounded(value: Value) -> Value:
    """Round numbers to 15 digits: 2999 times 0.01 s is 29.99 s."""
    if isinstance(value, tuple):
        return tuple(_rounded(item) for item in value)  # type: ignore[return-value]
    return float(f"{value:.15g}") if isinstance(value, float) else value


def _shorten(value: Value) -> str:
    """Return the text of a value, for a long list of its ends."""
    if isinstance(value, tuple) and len(value) > 8:
        return f"{value[0]!r}, ..., {value[-1]!r} ({len(value)} values)"
    return format_value(value)
