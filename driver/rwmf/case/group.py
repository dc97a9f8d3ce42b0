"""One group of a case: typed values with their units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NoReturn

from rwmf.case.namelist import Value, format_value, parse_value

__all__ = ["Group"]


class Group(Mapping[str, Any]):
    """The values of one namelist group, by attribute or by key; keys match in any case.

    Attributes
    ----------
    given : frozenset of str
        The keys that the case gives; the others hold the kernel's defaults.
    units : mapping of str to str
        Units of the values as the kernel names them.

    Parameters
    ----------
    name : str
        Name of the group.
    rows : list of list of str
        Key, type, value, unit, and 'given' or 'default', as the kernel describes them.
    """

    __slots__ = ("_given", "_name", "_units", "_values")

    _given: frozenset[str]
    _name: str
    _units: dict[str, str]
    _values: dict[str, Value]

    def __init__(self, name: str, rows: list[list[str]]) -> None:
        put = super().__setattr__
        put("_name", name)
        put("_values", {key: parse_value(kind, text) for key, kind, text, _, _ in rows})
        put("_units", {key: unit for key, _, _, unit, _ in rows})
        put("_given", frozenset(key for key, *_, origin in rows if origin == "given"))

    @property
    def given(self) -> frozenset[str]:
        """Keys that the case gives."""
        return self._given

    @property
    def units(self) -> dict[str, str]:
        """Units of the values."""
        return dict(self._units)

    def __getitem__(self, key: str) -> Any:  # noqa: ANN401 (the kernel's table knows the type)
        """Return the value of a key."""
        for name, value in self._values.items():
            if name.lower() == key.lower():
                return value
        raise KeyError(key)

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 (the kernel's table knows the type)
        """Return the value of a key."""
        # private names are looked up before they exist when a group is copied or unpickled
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError:
            known = ", ".join(self._values)
            raise AttributeError(
                f"&{self._name} of this case has no {name}; it has {known}"
            ) from None

    def __setattr__(self, name: str, value: object) -> NoReturn:
        """Refuse: a case never changes."""
        raise AttributeError(
            f"a case cannot be changed; case.replace({self._name}={{{name!r}: {value!r}}}) "
            "returns another one"
        )

    def __iter__(self) -> Iterator[str]:
        """Iterate over the keys."""
        return iter(self._values)

    def __len__(self) -> int:
        """Count the keys."""
        return len(self._values)

    def __repr__(self) -> str:
        """Show the values that are given, then the defaults in parentheses."""
        given = ", ".join(self._show(key) for key in self if key in self._given)
        others = ", ".join(self._show(key) for key in self if key not in self._given)
        return given + ("  " if given and others else "") + (f"({others})" if others else "")

    def _show(self, key: str) -> str:
        value = self._values[key]
        text = format_value(value)
        if isinstance(value, tuple) and len(value) > 8:
            text = f"{value[0]!r}, ..., {value[-1]!r} ({len(value)} values)"
        unit = self._units[key]
        return f"{key} = {text}" + (f" {unit}" if unit.strip("-") else "")
