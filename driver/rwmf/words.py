"""Words of the command line and of sweep files, checked where they are read."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from pathlib import Path

from rwmf.errors import OutputError
from rwmf.namelist import Value

__all__ = [
    "is_name_of_folder",
    "number",
    "problem_of_name",
    "readable",
    "shorten",
    "thread_count",
    "whole",
    "written_file",
]

# bytes of one part of a path, and of a whole one, that Linux takes
_NAME_BYTES = 255
_PATH_BYTES = 4095
# letters of a wrong word in a message
_SHOWN = 80
_MOST_THREADS = 2**31 - 1


def shorten(word: object) -> str:
    """Show a word in a message, a long one by its beginning."""
    text = str(word)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}... ({len(text)} letters)"


def number(above: float = -math.inf, below: float = math.inf) -> Callable[[str], float]:
    """Make the reader of an option that is a finite number.

    Parameters
    ----------
    above, below : float
        Ends of the range, which are not in it.

    Returns
    -------
    callable
        A type for `argparse`.
    """
    texts = {
        (False, False): "a finite number",
        (True, False): f"a finite number > {above:g}",
        (False, True): f"a finite number < {below:g}",
        (True, True): f"in ({above:g}, {below:g})",
    }
    allowed = texts[above > -math.inf, below < math.inf]

    def read(word: str) -> float:
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not (math.isfinite(value) and above < value < below):
            raise argparse.ArgumentTypeError(f"{shorten(word)}: must be {allowed}")
        return value

    return read


def whole(lowest: int, highest: int) -> Callable[[str], int]:
    """Make the reader of an option that is a whole number.

    Parameters
    ----------
    lowest, highest : int
        Ends of the range, both in it.

    Returns
    -------
    callable
        A type for `argparse`.
    """

    def read(word: str) -> int:
        try:
            value = int(word)
        except ValueError:
            value = lowest - 1
        if not lowest <= value <= highest:
            text = f"must be a whole number in [{lowest}, {highest}]"
            raise argparse.ArgumentTypeError(f"{shorten(word)}: {text}")
        return value

    return read


def thread_count(word: str) -> int:
    """Read a number of threads, 0 for all; the kernel says how many it takes."""
    return whole(0, _MOST_THREADS)(word)


def written_file(word: str) -> str:
    """Read the name of a file to write.

    Parameters
    ----------
    word : str
        The name, with folders or without.

    Returns
    -------
    str
        The same.

    Raises
    ------
    OutputError
        When no file can have that name.
    """
    problem = problem_of_name(word)
    if problem is None and is_name_of_folder(word):
        problem = "is a folder, not a file"
    if problem is not None:
        raise OutputError(f"{shorten(word)}: {problem}")
    return word


def is_name_of_folder(word: str) -> bool:
    """Tell whether a name can be nothing but a folder's: ``.``, ``..``, ``/``."""
    return Path(word).name in ("", "..")


def problem_of_name(word: str) -> str | None:
    """Say why no file can have a name.

    Parameters
    ----------
    word : str
        The name, with folders or without.

    Returns
    -------
    str or None
        What is wrong; None when a file may be called so.
    """
    raw = os.fsencode(word)
    if not raw:
        return "must not be empty"
    if b"\0" in raw:
        return "must not contain the character NUL"
    if len(raw) > _PATH_BYTES or any(len(part) > _NAME_BYTES for part in raw.split(b"/")):
        return f"a name has at most {_NAME_BYTES} bytes, a path {_PATH_BYTES}"
    return None


def readable(value: Value) -> Value:
    """Show bytes of a name that are no UTF-8 by their numbers: NetCDF holds UTF-8 only.

    Parameters
    ----------
    value : str or number
        A text, for example with names of files; numbers stay.

    Returns
    -------
    str or number
        What UTF-8 can hold.
    """
    if not isinstance(value, str):
        return value
    return value.encode("utf-8", "backslashreplace").decode()
