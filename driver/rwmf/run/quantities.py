"""Table of the quantities that the kernel reports."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.names import shorten
from rwmf.kernel.numbers import Truths

if TYPE_CHECKING:
    import xarray as xr

    from rwmf.case import Case

# beginning of the key of a peak's sensitivity to the motion
SENSITIVITY = "sensitivity_"
# endings of a motion before its planned time, as statuses; they are results, not errors. The
# summary of a run has a logical of the same name where such an ending is possible
ENDINGS = ("overturned", "collapsed")


@dataclass(frozen=True)
class Quantity:
    """A column of the history, a scalar of a run, or an output of a spectrum, sweep or comparison.

    Attributes
    ----------
    key : str
        Column or key in the kernel; ``{i}`` is the number of a floor or storey.
    name : str
        Variable of a dataset, see `names`; '' for an attribute of a run's dataset, or when absent.
    unit : str
        Its unit: '1' for numbers without one, '' for texts.
    kind : str
        'real', 'int', 'logical', 'text' or 'list'.
    found : str
        'row', 'peak', 'time', 'end', 'count', 'whether', 'before', 'axis', 'work' or 'error'.
    outputs : str
        Words 'history', 'run', 'ordinate', 'spectrum', 'sweep', 'cost': outputs that have it.
    group : str
        Group that the case must have; '' for none.
    asked_by : str
        Key of `&output` that requests it; '' when every run has it.
    needs : str
        Other requirements.
    meaning : str
        Definition.
    """

    key: str
    name: str
    unit: str
    kind: str
    found: str
    outputs: str
    group: str
    asked_by: str
    needs: str
    meaning: str

    def names(self, output: str) -> tuple[str, ...]:
        """Return the names of its variable in a dataset.

        Names carry no unit; the attributes of the variable do. The final value of a quantity that
        is also a column of the history ends with ``_end``. Energies at the end and reactions in N
        also have a name with the unit, for existing programs.
        """
        if not self.name:
            return ()
        plain = self.name.removesuffix(_SUFFIXES.get(self.unit, ""))
        if "run" not in self.outputs.split() or "history" not in self.outputs.split():
            return tuple(dict.fromkeys((plain, self.name)))
        return (plain,) if output == "history" else (f"{plain}_end", self.name)

    def called(self, word: str) -> str:
        """Choose one of its names in a grid."""
        names = self.names("ordinate")
        return next((name for name in names if name.lower() == word.lower()), (*names, self.key)[0])

    @property
    def level(self) -> str:
        """Dimension of a numbered quantity: 'storey', 'floor', 'fuse' ...; '' for the others."""
        if "{i}" not in self.key:
            return ""
        # the sensitivity of a peak has the dimension of the peak
        own = QUANTITIES.get(self.key.removeprefix("sensitivity_"), self)
        numbered = re.search(r"(\w+) \{i\}", own.meaning)
        return numbered[1] if numbered else "mode"

    @property
    def over_levels(self) -> Quantity:
        """The quantity over all storeys or floors: ``storeys_drift`` for ``storey_{i}_drift``."""
        meaning = re.sub(r"(\w+) \{i\}", r"each \1", self.meaning)
        return replace(self, name=self.name.replace("_{i}", "s"), meaning=meaning)

    @property
    def limit_key(self) -> str:
        """Key of `&limits` for the quantity; a list over floors or storeys is a plural."""
        return self.key.replace("_{i}", "s")

    @property
    def attributes(self) -> dict[str, str]:
        """Attributes of its variable."""
        return {"units": self.unit, "long_name": self.meaning}


# units at the end of names in the kernel's table
_SUFFIXES = {"J/kg": "_J_per_kg", "N": "_N"}
QUANTITIES = {row[0]: Quantity(*row) for row in tables.quantities()}
# peaks without a column in a history: the value at one step, as in a static curve, by its key
INSTANT = {
    item.key.replace("_max", ""): replace(
        item,
        key=item.key.replace("_max", ""),
        name=item.name.replace("_max", ""),
        outputs="history",
        found="row",
        meaning=item.meaning.removeprefix("largest "),
    )
    for item in QUANTITIES.values()
    if item.found == "peak"
    and "_max" in item.key
    and item.key.replace("_max", "") not in QUANTITIES
}
# dimensions of the grids of spectra and sweeps that the kernel iterates over
AXES = {"b": QUANTITIES["b_m"], "gamma": QUANTITIES["gamma"], "T_s": QUANTITIES["T_s_s"]}


_KEYS = {key.lower(): key for key in QUANTITIES} | {
    name.lower(): key
    for key, item in QUANTITIES.items()
    if "run" in item.outputs.split()
    for name in item.names("run")
}


def keys_of(names: Iterable[str]) -> list[str]:
    """Translate names of variables into keys; keys and unknown words stay."""
    found = []
    for name in names:
        word = name.lower()
        # the number of a floor or storey lies between underscores
        numbered = re.match(r"[a-z_]+?_(\d{1,4})(?=_)", word)
        number = numbered[1] if numbered else "{i}"
        key = _KEYS.get(word.replace(f"_{number}_", "_{i}_", 1), name)
        found.append(key.replace("{i}", number))
    return found


def names_by_key(names: Iterable[object]) -> dict[str, str]:
    """Map the key of each quantity to its first name in a dataset."""
    words = [str(name) for name in names]
    found: dict[str, str] = {}
    for key, word in zip(keys_of(words), words, strict=True):
        found.setdefault(key, word)
    return found


def find(key: str) -> Quantity:
    """Look up a column of a history or a key of a summary."""
    quantity, number = find_numbered(key)
    if not number:
        return quantity
    return Quantity(*(text.replace("{i}", str(number)) for text in astuple(quantity)))


def find_numbered(key: str) -> tuple[Quantity, int]:
    """Look up a column of a history or a key of a summary in the table of quantities."""
    number = next((part for part in key.split("_") if part.isdigit()), "0")
    if int(number):
        key = key.replace(f"_{number}_", "_{i}_")
    return QUANTITIES.get(key) or INSTANT[key], int(number)


def ending_of(summary: Mapping[str, Any]) -> str:
    """Return the ending of a run."""
    return next((name for name in ENDINGS if summary.get(name)), "ok")


def fallen(dataset: xr.Dataset) -> Truths:
    """Find the runs of a sweep, a spectrum or a table that overturned or collapsed."""
    status = dataset["status"]
    # a sweep has numbers, the others names
    names = str(status.attrs.get("flag_meanings", "")).split()
    codes = [names.index(name) if names else name for name in ENDINGS if name in names or not names]
    return np.isin(status.values, codes)


def is_least(name: str) -> bool:
    """Tell a smallest value, which falls with the demand; strokes count by their size."""
    return re.search(r"_min(_|$)", name) is not None and "stroke" not in name


_LIST = "the list: reference/outputs.md"


class _Table(dict[str, Quantity]):
    """Quantities by name; a name with the number of a floor or storey gets the numbered row."""

    def __missing__(self, name: str) -> Quantity:
        try:
            found = find(*keys_of([name]))
        except (KeyError, StopIteration):
            raise KeyError(name) from None
        if "ordinate" not in found.outputs.split():
            raise KeyError(name)
        return found


ORDINATES = _Table(
    (name, quantity)
    for quantity in QUANTITIES.values()
    if "ordinate" in quantity.outputs.split()
    for name in quantity.names("ordinate")
)


def default_quantity(case: Case) -> str:
    """Return the name of the quantity that a sweep stores by default."""
    return QUANTITIES[case.kernel.default_quantity()].names("ordinate")[0]


def find_quantities(names: tuple[str, ...]) -> dict[str, Quantity]:
    """Look up the quantities to store."""
    by_key = _Table((quantity.key, quantity) for quantity in ORDINATES.values())
    requested: dict[str, Quantity] = {}
    unknown: list[str] = []
    for name, key in zip(names, keys_of(names), strict=True):
        try:
            quantity = by_key[key]
        except KeyError:
            unknown.append(name)
        else:
            requested[quantity.called(name)] = quantity
    if not names:
        raise InputError(f"quantities: none is given; {_LIST}")
    if unknown:
        meant = [tables.meant_quantity(word) for word in unknown]
        hints = [
            f"{shorten(word)}: is unknown"
            + (f", did you mean {QUANTITIES[key].names('ordinate')[0]}?" if key else ".")
            for word, key in zip(unknown, meant, strict=True)
        ]
        raise InputError(f"quantities: {' '.join(hints)} {_LIST.capitalize()}")
    return requested


def find_quantity(case: Case, names: Sequence[str] | None, study: str) -> str:
    """Look up the quantity of a study; the default is that of the scene."""
    found = find_quantities(tuple(names or (default_quantity(case),)))
    if len(found) > 1:
        raise InputError(f"{study}: quantities = {', '.join(found)}: must be one quantity")
    return next(iter(found))


def refuse_missing(found: xr.Dataset, names: Sequence[str], label: str) -> None:
    """Refuse quantities that no complete run has."""
    words = found["status"].attrs["flag_meanings"].split()
    is_complete = found["status"].values == (words.index("ok") if "ok" in words else -1)
    for name in names:
        if is_complete.any() and np.isnan(found[name].values[is_complete]).all():
            raise InputError(f"{label}: {name}: a run of this case has no such result")
