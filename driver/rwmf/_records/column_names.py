"""Names of columns in files of users: quantity and unit, as the file states them."""

from __future__ import annotations

import re
from dataclasses import dataclass

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
# dimension and factor to SI units by the plain spelling of a unit
_UNITS = {
    "g": (ACCELERATION, _G),
    "gs": (ACCELERATION, _G),
    "%g": (ACCELERATION, 0.01 * _G),
    **dict.fromkeys(("mg", "milli-g"), (ACCELERATION, 0.001 * _G)),
    "gal": (ACCELERATION, 0.01),
    "gals": (ACCELERATION, 0.01),
    **{
        f"{length}/s2": (ACCELERATION, factor)
        for length, factor in (
            ("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)
        )
    },
    **{
        f"{length}/s": ("velocity", factor)
        for length, factor in (
            ("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("ft", 0.3048)
        )
    },
    **dict.fromkeys(("m", "meter", "metre"), ("displacement", 1.0)),
    "cm": ("displacement", 0.01),
    "mm": ("displacement", 0.001),
    "in": ("displacement", 0.0254),
    **dict.fromkeys(("s", "second", "seconds"), ("time", 1.0)),
    **dict.fromkeys(("ms", "millisecond", "milliseconds"), ("time", 0.001)),
    "hz": ("frequency", 1.0),
    "rad/s": ("frequency", 0.15915494309189535),
    **dict.fromkeys(("%", "percent"), ("share", 0.01)),
    **dict.fromkeys(("-", "1"), ("number", 1.0)),
    **dict.fromkeys(
        ("1/year", "1/yr", "1/a", "peryear", "/year", "/yr", "year-1", "yr-1"), ("rate", 1.0)
    ),
    **dict.fromkeys(("year", "years", "yr", "yrs", "a"), ("years", 1.0)),
}  # fmt: skip
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
        Plain spelling of the unit; '' without one.
    """

    words: str
    unit: str

    @property
    def dimension(self) -> str:
        """Dimension of the unit; '' without a unit."""
        return _UNITS[self.unit][0] if self.unit else ""

    @property
    def factor(self) -> float:
        """Factor to SI units; 1 without a unit."""
        return _UNITS[self.unit][1] if self.unit else 1.0

    @property
    def tokens(self) -> list[str]:
        """Words, numbers and marks of the name, without separators."""
        return re.findall(r"[^\W\d_]+|\d+(?:\.\d+)?|[^\w\s(),.=\[\]:\"'-]", self.words)

    @property
    def numbers(self) -> list[float]:
        """Numbers in the name."""
        return [float(token) for token in self.tokens if token[0].isdigit()]

    def consists_of(self, words: frozenset[str], *dimensions: str) -> bool:
        """Check that all words of the name are known, and its unit has a dimension.

        Parameters
        ----------
        words : frozenset of str
            The known words; numbers are always known.
        *dimensions : str
            The dimensions beside ''.

        Returns
        -------
        bool
            True when nothing in the name is unknown.
        """
        tokens = [token for token in self.tokens if not token[0].isdigit()]
        return words.issuperset(tokens) and self.dimension in ("", *dimensions)


def known_words(text: str) -> frozenset[str]:
    """Return the words of a text.

    Parameters
    ----------
    text : str
        Words with blanks between them.

    Returns
    -------
    frozenset of str
        The words.
    """
    return frozenset(text.split())


def read_column_name(cell: str) -> ColumnName:
    """Split 'Sa [m/s2]', 'PGA (g)', 'T_s', 'Sa in gal' into name and unit.

    Parameters
    ----------
    cell : str
        The name as in the file.

    Returns
    -------
    ColumnName
        Its words and unit; an unknown unit stays a word.
    """
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
    """Return the unit that a cell below a name holds.

    Parameters
    ----------
    cell : str
        The cell, with or without brackets.

    Returns
    -------
    str or None
        Its plain spelling; None for another content.
    """
    unit = _plain(cell.strip().strip("\"'[]()").removeprefix("in "))
    return unit if unit in _UNITS else None


def _plain(text: str) -> str:
    """Return the plain spelling of a unit: m/s2 for 'm s^-2', 'M/SEC/SEC' and 'mps2'."""
    text = re.sub(r"[\s^*\u00b7\u00c2]", "", text.lower()).strip(".")
    # the superscript in UTF-8 and as a byte of Latin-1
    text = re.sub("[\u00b2\udcb2]", "2", text).replace("\u207b", "-")
    text = re.sub(r"sec(?![a-z])", "s", text).replace("mps", "m/s")
    text = re.sub(r"^([cm]?m)s2$", r"\1/s2", text)
    text = re.sub(r"s-([12])$", r"/s\1", text).replace("//", "/").removesuffix("/s1")
    return re.sub(r"/\(?s[/.]?s\)?$", "/s2", text.replace("./", "/"))


def convert(name: ColumnName, unit: str) -> float | None:
    """Return the factor from the unit of a column to another one.

    Parameters
    ----------
    name : ColumnName
        The column.
    unit : str
        The other unit.

    Returns
    -------
    float or None
        The factor, 1 for a column without unit; None when the dimensions differ.
    """
    other = _UNITS.get(_plain(unit))
    if not name.unit:
        return 1.0
    if other is None or other[0] != name.dimension:
        return None
    # exactly 1 for the same unit
    return name.factor / other[1]


def unit_in_text(text: str) -> str | None:
    """Find a unit other than s and g, or a logarithm, in a sentence.

    Parameters
    ----------
    text : str
        The sentence.

    Returns
    -------
    str or None
        The unit as written; None without one.
    """
    found = _IN_TEXT.search(text)
    return None if found is None else found[0]
