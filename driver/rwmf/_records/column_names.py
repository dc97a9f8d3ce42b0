"""Names of columns in files of users: quantity and unit, as the file states them."""

from __future__ import annotations

import re
from dataclasses import dataclass

from rwmf._library import unit_named

__all__ = [
    "ACCELERATION",
    "ColumnName",
    "convert",
    "known_words",
    "read_column_name",
    "unit_in_text",
    "unit_of_cell",
]

ACCELERATION = "acceleration"
_G = 9.81
# dimension and factor of units beside those of records, which the kernel knows
_UNITS = {
    "rad/s": ("frequency", 0.15915494309189535),
    **dict.fromkeys(("%", "percent"), ("share", 0.01)),
    **dict.fromkeys(("-", "1"), ("number", 1.0)),
    **dict.fromkeys(
        ("1/year", "1/yr", "1/a", "peryear", "/year", "/yr", "year-1", "yr-1"), ("rate", 1.0)
    ),
    **dict.fromkeys(("year", "years", "yr", "yrs", "a"), ("years", 1.0)),
}  # fmt: skip
# bases of accelerations, and of lengths over other powers of the second
_BASES = {"": 1.0, "g": _G, "m/s2": 1.0, "cm/s2": 0.01}
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")
# units other than s and g, and logarithms, in a sentence
_IN_TEXT = re.compile(
    r"(?<![\w/])(?:[cm]?m|in|ft)\s*/\s*s(?:ec)?(?:\s*/\s*s(?:ec)?|\s*[*^]*\s*2|\u00b2)|"
    r"(?<![\w/])(?:[cm]?m)\s*[.\u00b7*]?\s*s\s*\^?-2|\bgals?\b|%\s*g\b|"
    r"\b(?:ms|msec|milliseconds?|hz|log10|log|ln)\b",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class ColumnName:
    """Name of a column.

    Attributes
    ----------
    words : str
        Its words in lower case, without the unit.
    unit : str
        The unit as the file writes it; '' without one.
    """

    words: str
    unit: str

    @property
    def dimension(self) -> str:
        """Dimension of the unit; '' without a unit."""
        return _find_unit(self.unit)[0]

    @property
    def factor(self) -> float:
        """Factor to SI units; 1 without a unit."""
        return _find_unit(self.unit)[1]

    @property
    def tokens(self) -> list[str]:
        """Words, numbers and marks of the name, without separators."""
        return re.findall(r"[^\W\d_]+|\d+(?:\.\d+)?|[^\w\s(),.=\[\]:\"'-]", self.words)

    @property
    def numbers(self) -> list[float]:
        """Numbers in the name."""
        return [float(token) for token in self.tokens if token[0].isdigit()]

    def consists_of(self, words: frozenset[str], *dimensions: str) -> bool:
        """Check that all words of the name are known, and its unit has a dimension."""
        tokens = [token for token in self.tokens if not token[0].isdigit()]
        return words.issuperset(tokens) and self.dimension in ("", *dimensions)


def known_words(text: str) -> frozenset[str]:
    """Return the words of a text."""
    return frozenset(text.split())


def read_column_name(cell: str) -> ColumnName:
    """Split 'Sa [m/s2]', 'PGA (g)', 'T_s', 'Sa in gal' into name and unit."""
    text = " ".join(cell.strip().strip("\"'").split())
    for match in reversed(list(_BRACKETS.finditer(text))):
        unit = unit_of_cell(match[1])
        if unit is not None:
            return ColumnName((text[: match.start()] + text[match.end() :]).strip().lower(), unit)
    if re.fullmatch(r".+/\s*g", text, re.IGNORECASE):
        return ColumnName(text.rpartition("/")[0].strip().lower(), "g")
    for mark in "_ ":
        words = text.split(mark)
        for i in range(1, len(words)):
            unit = unit_of_cell(("/" if mark == "_" else " ").join(words[i:]))
            # 'poe in 50 years' has no unit
            is_span = unit != "%" and re.fullmatch(r"\W?[\d.]+", words[i - 1]) is not None
            if unit is not None and unit not in ("1", "-") and not is_span:
                return ColumnName(mark.join(words[:i]).strip(" ,").lower(), unit)
    return ColumnName(text.lower(), "")


def unit_of_cell(cell: str) -> str | None:
    """Return the unit that a cell below a name holds."""
    unit = cell.strip().strip("\"'[]()").removeprefix("in ").strip().lower()
    # the superscript as a byte of Latin-1
    unit = unit.replace("\udcb2", "2").encode("utf-8", errors="replace").decode()
    return unit if _find_unit(unit)[0] else None


def _find_unit(unit: str) -> tuple[str, float]:
    """Return dimension and factor to SI units; '' and 1 for no unit."""
    known = _UNITS.get("".join(unit.split()))
    if known is not None or not unit:
        return known or ("", 1.0)
    dimension, base, times, over = unit_named(unit)
    return dimension, times / over * _BASES[base]


def convert(name: ColumnName, unit: str) -> float | None:
    """Return the factor from the unit of a column to another one."""
    dimension, factor = _find_unit(unit)
    if not name.unit:
        return 1.0
    # exactly 1 for the same unit
    return name.factor / factor if dimension == name.dimension else None


def unit_in_text(text: str) -> str | None:
    """Find a unit other than s and g, or a logarithm, in a sentence."""
    found = _IN_TEXT.search(text)
    return None if found is None else found[0]
