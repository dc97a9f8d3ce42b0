"""Validation of command-line arguments while they are parsed."""

from __future__ import annotations

import argparse
import math
import re
from abc import abstractmethod
from collections.abc import Callable
from typing import Any, TypeVar

from rwmf.errors import OutputError
from rwmf.kernel.names import is_name_of_folder, problem_of_name, shorten

_TARGET = re.compile(r"(\w+)=([^@x]+)(?:@([^@x]+))?(?:x([^@x]+))?")
_LIMITS = re.compile(r"limits@([^@x]+)(?:x([^@x]+))?")
_MOST_NUMBERS = 1_000_000
_UNITS = ("g", "m/s2", "cm/s2")
# suffixes of figures
_FIGURE = re.compile(r"(avif|eps|jpe?g|pdf|pgf|png|ps|svgz?|tiff?|webp)", re.IGNORECASE)
_T = TypeVar("_T")


class Kept(argparse.Action):
    """An option whose values are kept in another way than under its name."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,  # noqa: ANN401 (of the type)
        option_string: str | None = None,
    ) -> None:
        """Keep the values."""
        self.keep(namespace, values)

    @abstractmethod
    def keep(self, namespace: argparse.Namespace, values: Any) -> None:  # noqa: ANN401
        """Keep values of the option."""


class Parts(Kept):
    """Keep the parts of one word as attributes.

    Attributes
    ----------
    further : dict
        Names of the parts with their defaults.
    """

    def __init__(self, parts: list[str], default: str | None = None, **settings: Any) -> None:  # noqa: ANN401 (of argparse)
        # without a destination argparse does not convert the default
        super().__init__(**settings | {"dest": argparse.SUPPRESS})
        values = settings["type"](default) if default else [None] * len(parts)
        self.further = dict(zip(parts, values, strict=True))

    def keep(self, namespace: argparse.Namespace, values: Any) -> None:  # noqa: ANN401
        """Set all parts."""
        for name, value in zip(self.further, values, strict=True):
            setattr(namespace, name, value)


class Outputs(Kept):
    """Keep a file as ``out``, a figure by its suffix as ``plot``; one of each, or a list of files.

    Attributes
    ----------
    further : dict
        Defaults of both.
    """

    def __init__(self, has_data: bool = True, **settings: Any) -> None:  # noqa: ANN401 (of argparse)
        super().__init__(**settings)
        self.has_data = has_data
        self.further = {"out": self.default, "plot": None}

    def keep(self, namespace: argparse.Namespace, values: str) -> None:
        """Add a file."""
        is_figure = not self.has_data or _FIGURE.fullmatch(values.rpartition(".")[2]) is not None
        name = "plot" if is_figure else "out"
        before = getattr(namespace, name)
        if is_figure:
            written_file(values)
        if before is not None and not isinstance(before, list):
            kinds = "one file and one figure" if self.has_data else "one figure"
            raise argparse.ArgumentError(self, f"allowed is {kinds}")
        setattr(namespace, name, values if before is None else [*before, values])


def _must_be(wanted: str) -> Callable[[Callable[[str], _T]], Callable[[str], _T]]:
    """Make a decorator for the type of an option: an error names the word and the wanted form."""

    def decorate(read: Callable[[str], _T]) -> Callable[[str], _T]:
        def convert(word: str) -> _T:
            try:
                return read(word)
            except (ValueError, argparse.ArgumentTypeError):
                text = f"{shorten(word)}: must be {wanted}"
                raise argparse.ArgumentTypeError(text) from None

        return convert

    return decorate


def number(above: float = -math.inf, below: float = math.inf) -> Callable[[str], float]:
    """Make the type of an option with a finite number."""
    texts = {
        (False, False): "a finite number",
        (True, False): f"a finite number > {above:g}",
        (False, True): f"a finite number < {below:g}",
        (True, True): f"in ({above:g}, {below:g})",
    }

    @_must_be(texts[above > -math.inf, below < math.inf])
    def read(word: str) -> float:
        value = float(word)
        if not (math.isfinite(value) and above < value < below):
            raise ValueError
        return value

    return read


@_must_be("a finite number >= 0")
def not_negative(word: str) -> float:
    """Read a number that may be zero."""
    value = number()(word)
    if value < 0:
        raise ValueError
    return value


def whole(lowest: int, highest: int) -> Callable[[str], int]:
    """Make the type of an option with a whole number."""

    @_must_be(f"a whole number in [{lowest}, {highest}]")
    def read(word: str) -> int:
        value = int(word)
        if not lowest <= value <= highest:
            raise ValueError
        return value

    return read


@_must_be("FIRST:LAST:N or finite numbers with commas between them, at most " + str(_MOST_NUMBERS))
def numbers(word: str) -> list[float]:
    """Read ``FIRST:LAST:N`` with both ends, or comma-separated numbers."""
    # imported here so that help and other error messages need not wait for it
    import numpy as np

    from rwmf.kernel.numbers import short_decimal

    read = number()
    if ":" in word:
        first, last, n = word.split(":")
        points = np.linspace(read(first), read(last), whole(1, _MOST_NUMBERS)(n))
        return [short_decimal(x) for x in points.tolist()]
    return [read(item) for item in word.split(",")]


def written_file(word: str) -> str:
    """Read the name of a file to write."""
    problem = problem_of_name(word)
    if problem is None and is_name_of_folder(word):
        problem = "is a folder, not a file"
    if problem is not None:
        raise OutputError(f"{shorten(word)}: {problem}")
    return word


@_must_be("KEY=LOW:HIGH")
def bounds(word: str) -> tuple[str, tuple[float, float]]:
    """Read ``KEY=LOW:HIGH``."""
    key, _, ends = word.partition("=")
    low, _, high = ends.partition(":")
    return key, (number()(low), number()(high))


@_must_be("LOW:HIGH in Hz")
def band(word: str) -> tuple[float, float]:
    """Read ``LOW:HIGH``, ``LOW:`` or ``:HIGH`` in Hz."""
    low, colon, high = word.partition(":")
    read = number(above=0)
    if not colon or not (low or high):
        raise ValueError
    return (read(low) if low else 0.0, read(high) if high else math.inf)


@_must_be("KEY=NUMBER")
def weight(word: str) -> tuple[str, float]:
    """Read ``KEY=NUMBER``."""
    key, sign, value = word.partition("=")
    return key, number()(value if key and sign else "")


def target(word: str) -> dict[str, object]:
    """Read a target: a percentile of a quantity, or a probability of collapse."""
    read = number()
    if limits := _LIMITS.fullmatch(word):
        scale = {"scale": read(limits[2])} if limits[2] else {}
        return {"quantity": "limits", "percentile": read(limits[1])} | scale
    parts = _TARGET.fullmatch(word)
    is_collapse = parts is not None and parts[1] == "collapse"
    if parts is None or (parts[3] is None) != is_collapse:
        wanted = "KEY=LIMIT@PERCENTILE, limits@PERCENTILE or collapse=PROBABILITY, and xFACTOR"
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must be {wanted}")
    found: dict[str, object] = {"quantity": parts[1]}
    if is_collapse:
        found["probability"] = read(parts[2])
    else:
        found |= {"limit": read(parts[2]), "percentile": read(parts[3])}
    return found | ({"scale": read(parts[4])} if parts[4] else {})


def unit(word: str) -> tuple[str | None, float | None]:
    """Read ``UNIT``, ``UNIT,S`` or ``,S``."""
    name, comma, dt = word.partition(",")
    if name not in _UNITS and (name or not comma):
        wanted = f"must be one of {', '.join(_UNITS)}, with an interval in s behind a comma"
        raise argparse.ArgumentTypeError(f"{shorten(word)}: {wanted}")
    return name or None, number(above=0)(dt) if comma else None


def engine(word: str) -> tuple[str, int]:
    """Read ``NAME``, or ``NAME:N`` of processes and dask; an address belongs to the name."""
    name, _, last = word.rpartition(":")
    if name.lower() not in ("processes", "dask") or not last.isdecimal():
        return word, 0
    return name, whole(0, 4096)(last)


def intensity(word: str) -> tuple[str, float | None, float | None, list[float] | None]:
    """Read ``KIND[:PERIODS[@DAMPING]]`` as kind, period, damping and periods of an average."""
    kind, _, rest = word.partition(":")
    times, at, damping = rest.partition("@")
    periods = numbers(times) if rest else None
    xi = number(above=0)(damping) if at else None
    if periods is None or kind == "average_acceleration":
        return kind, None, xi, periods
    if len(periods) > 1:
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must have one period")
    return kind, periods[0], xi, None


@_must_be("first_mode, roof, or forces with commas between them")
def pattern(word: str) -> tuple[str, list[float] | None]:
    """Read the name of a load pattern, or forces on the floors."""
    return (word, None) if word in ("first_mode", "roof") else ("floors", numbers(word))


def resamples(word: str) -> tuple[int, float, int]:
    """Read ``N[,SHARE[,SEED]]``."""
    items = word.split(",")
    items += ["1000", "0.95", "0"][len(items) :]
    if len(items) > 3:
        raise argparse.ArgumentTypeError(f"{shorten(word)}: must be N,SHARE,SEED")
    return whole(0, 10**6)(items[0]), number(0, 1)(items[1]), whole(0, 10**6)(items[2])
