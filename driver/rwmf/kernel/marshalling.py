"""Texts, errors and memory between Python and the kernel."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf.errors import InputError, Interrupted, NumericalError, OutputError, RwmfError


class Memory:
    """Memory of the kernel behind a handle, released with the last reference."""

    __slots__ = ("handle",)

    def __init__(self, handle: int) -> None:
        self.handle = int(handle)

    def __del__(self, release: Callable[[int], None] = _kernel.release) -> None:
        """Release the memory."""
        release(self.handle)


class MemoryView:
    """Array interface for numpy to an array of the kernel; it keeps the memory alive."""

    def __init__(self, memory: Memory, address: int, shape: tuple[int, ...]) -> None:
        self.memory = memory
        # C order: the first index of Fortran, which varies fastest, is the last one here
        self.__array_interface__ = {
            "version": 3,
            "typestr": np.dtype(np.float64).str,
            "shape": tuple(int(n) for n in shape),
            "data": (int(address), False),
        }


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
    """Raise the exception for a status of the kernel; its message begins with the case's file."""
    if status == 0:
        return
    text = decode(message, min(length, message.size))
    if source and not text.startswith(source):
        text = f"{source}: {text}"
    if status == _INTERRUPTED:
        raise Interrupted(text)
    raise (OutputError if writing else _ERRORS.get(status, NumericalError))(text)


def call(procedure: Callable[..., Any], *arguments: object, source: str = "") -> list[Any]:
    """Call a procedure whose results end with status and length of a message; return the others."""
    message = message_buffer()
    found: list[Any]
    *found, status, length = procedure(*arguments, message)
    raise_for(status, message, length, source=source)
    return found


def fetch_text(procedure: Callable[..., int], *arguments: object) -> str:
    """Fetch a text, with a second call when the first buffer is too small."""
    size = FIRST_BUFFER
    while True:
        buffer = np.empty(size, dtype=np.int8)
        length = int(procedure(*arguments, buffer))
        if length <= size:
            return decode(buffer, length)
        size = length


def summary_item(line: str, real: float, count: int) -> tuple[str, Any]:
    """Return key and typed value of a line ``key<TAB>kind<TAB>text`` and its numbers."""
    key, kind, text = line.split("\t", 2)
    if kind == "list":
        return key, text.split("\t") if text else []
    return key, {"real": real, "int": count, "logical": bool(count), "text": text}[kind]


def split_table(text: str) -> list[list[str]]:
    """Split a text into rows and cells."""
    return [line.split("\t") for line in split_lines(text)]


def split_lines(text: str) -> list[str]:
    """Split a text at line feeds only: names of files may contain other separators, as U+2028."""
    lines = text.split("\n")
    return lines if lines[-1] else lines[:-1]


def message_buffer() -> npt.NDArray[np.int8]:
    """Allocate a buffer for a message of the kernel."""
    return np.empty(_MESSAGE_BYTES, dtype=np.int8)


def encode(text: str) -> bytes:
    """Encode a text for the kernel."""
    try:
        # surrogates in file names that are not UTF-8 become the original bytes
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        letter = f"U+{ord(text[error.start]):04X}"
        raise InputError(f"a text contains {letter}, which UTF-8 cannot encode") from None


def decode(buffer: npt.NDArray[np.int8], length: int) -> str:
    """Decode a text of the kernel."""
    return buffer[:length].tobytes().decode("utf-8", "surrogateescape")
