"""Names of files: which there can be, and how messages and NetCDF show them."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeVar

__all__ = ["is_name_of_folder", "problem_of_name", "readable", "shorten"]

_T = TypeVar("_T")

# bytes of one part of a path, and of a whole one, that Linux takes
_NAME_BYTES = 255
_PATH_BYTES = 4095
# letters of a wrong word in a message
_SHOWN = 80


def shorten(word: object) -> str:
    """Show a word in a message, a long one by its beginning.

    Parameters
    ----------
    word : object
        What is shown as text.

    Returns
    -------
    str
        At most 80 letters of it, and how many there are.
    """
    text = str(word)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}... ({len(text)} letters)"


def is_name_of_folder(word: str) -> bool:
    """Tell whether a name can be nothing but a folder's: ``.``, ``..``, ``/``.

    Parameters
    ----------
    word : str
        The name.

    Returns
    -------
    bool
        Whether no file can have it.
    """
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
    try:
        raw = os.fsencode(word)
    except UnicodeEncodeError:
        return "must not contain a character that is none of UTF-8"
    if not raw:
        return "must not be empty"
    if b"\0" in raw:
        return "must not contain the character NUL"
    if len(raw) > _PATH_BYTES or any(len(part) > _NAME_BYTES for part in raw.split(b"/")):
        return f"a name has at most {_NAME_BYTES} bytes, a path {_PATH_BYTES}"
    return None


def readable(value: _T) -> _T | str:
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
