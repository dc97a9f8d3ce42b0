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
    """Turn the kernel's status into an exception; its message begins with the case's file."""
    if status == 0:
        return
    text = decode(message, min(length, message.size))
    if source and not text.startswith(source):
        text = f"{source}: {text}"
    if status == _INTERRUPTED:
        raise Interrupted(text)
    raise (OutputError if writing else _ERRORS.get(status, NumericalError))(text)


def fetch_text(procedure: Callable[..., int], *arguments: object) -> str:
    """Ask for a text; a second time with the room that it needs when the first is too small."""
    size = FIRST_BUFFER
    while True:
        buffer = np.zeros(size, dtype=np.int8)
        length = int(procedure(*arguments, buffer))
        if length <= size:
            return decode(buffer, length)
        size = length


def summary_item(line: str, real: float, count: int) -> tuple[str, Any]:
    """Key and typed value of a line ``key<TAB>kind<TAB>text`` and the numbers that go with it."""
    key, kind, text = line.split("\t", 2)
    if kind == "list":
        return key, text.split("\t") if text else []
    return key, {"real": real, "int": count, "logical": bool(count), "text": text}[kind]


def split_table(text: str) -> list[list[str]]:
    return [line.split("\t") for line in text.splitlines()]


def message_buffer() -> npt.NDArray[np.int8]:
    return np.zeros(_MESSAGE_BYTES, dtype=np.int8)


def encode(text: str) -> bytes:
    # file names that are not UTF-8 come as surrogates and go back to the same bytes
    return text.encode("utf-8", "surrogateescape")


def decode(buffer: npt.NDArray[np.int8], length: int) -> str:
    return buffer[:length].tobytes().decode("utf-8", "surrogateescape")
