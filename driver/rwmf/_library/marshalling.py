"""Texts and failures as they cross the border between Python and the kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf.errors import InputError, Interrupted, NumericalError, OutputError, RwmfError

FIRST_BUFFER = 65536
_MESSAGE_BYTES = 8192
_INTERRUPTED = 130
_ERRORS: dict[int, type[RwmfError]] = {1: NumericalError, 2: InputError}


def raise_for(
    status: int,
    message: npt.NDArray[np.int8],
    length: int,
    *,
    writing: bool = False,
    source: str = "",
) -> None:
    """Turn the kernel's status into an exception; its message begins with the case's file.

    Parameters
    ----------
    status : int
        Of the kernel; 0 is none.
    message : numpy.ndarray of bytes, shape (n,)
        The kernel's message.
    length : int
        Of the message [bytes]; it may be longer than what came.
    writing : bool
        Whether a file was to be written.
    source : str
        What a message begins with: the path of the case's file, or ''.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        When the status is not 0, by what it is.
    """
    if status == 0:
        return
    text = decode(message, min(length, message.size))
    if source and not text.startswith(source):
        text = f"{source}: {text}"
    if status == _INTERRUPTED:
        raise Interrupted(text)
    raise (OutputError if writing else _ERRORS.get(status, NumericalError))(text)


def fetch_text(procedure: Callable[..., int], *arguments: object) -> str:
    """Ask for a text; a second time with the room that it needs when the first is too small.

    Parameters
    ----------
    procedure : callable
        Fills the buffer that comes last and returns the length of the text [bytes].
    *arguments
        What it takes before.

    Returns
    -------
    str
        The text.
    """
    size = FIRST_BUFFER
    while True:
        buffer = np.empty(size, dtype=np.int8)
        length = int(procedure(*arguments, buffer))
        if length <= size:
            return decode(buffer, length)
        size = length


def summary_item(line: str, real: float, count: int) -> tuple[str, Any]:
    """Key and typed value of a line ``key<TAB>kind<TAB>text`` and the numbers that go with it.

    Parameters
    ----------
    line : str
        The line.
    real : float
        Value of a real.
    count : int
        Value of a whole number or of a logical.

    Returns
    -------
    str
        The key.
    float, int, bool, str or list of str
        The value.
    """
    key, kind, text = line.split("\t", 2)
    if kind == "list":
        return key, text.split("\t") if text else []
    return key, {"real": real, "int": count, "logical": bool(count), "text": text}[kind]


def split_table(text: str) -> list[list[str]]:
    """Split a text into rows and cells.

    Parameters
    ----------
    text : str
        One line a row, tabs between its cells.

    Returns
    -------
    list of list of str
        The cells.
    """
    return [line.split("\t") for line in text.splitlines()]


def message_buffer() -> npt.NDArray[np.int8]:
    """Make room for a message of the kernel.

    Returns
    -------
    numpy.ndarray of bytes, shape (8192,)
        The room.
    """
    return np.empty(_MESSAGE_BYTES, dtype=np.int8)


def encode(text: str) -> bytes:
    """Turn a text into what the kernel takes.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    bytes
        UTF-8, or the bytes that a name of a file really has.

    Raises
    ------
    InputError
        When UTF-8 cannot hold the text.
    """
    try:
        # file names that are not UTF-8 come as surrogates and go back to the same bytes
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        letter = f"U+{ord(text[error.start]):04X}"
        raise InputError(f"a text has {letter} in it, which is no character of UTF-8") from None


def decode(buffer: npt.NDArray[np.int8], length: int) -> str:
    """Turn what the kernel gives into a text.

    Parameters
    ----------
    buffer : numpy.ndarray of bytes, shape (n,)
        What the kernel has filled.
    length : int
        How much of it is the text [bytes].

    Returns
    -------
    str
        The text.
    """
    return buffer[:length].tobytes().decode("utf-8", "surrogateescape")
