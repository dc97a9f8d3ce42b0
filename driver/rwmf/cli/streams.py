"""Standard streams of the command: closed, full, or with a limited character set."""

from __future__ import annotations

import codecs
import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Buffer


_STANDARD_ERROR = 2
# error handler for letters that a stream cannot encode
_ANYWAY = "rwmf"
# control characters of names, which could steer a terminal; line ends and tabs are the program's
_CONTROLS = {i: f"\\x{i:02x}" for i in (*range(32), *range(127, 160)) if chr(i) not in "\t\n\r"}


class ReaderGoneError(BrokenPipeError):
    """The reader of the output has closed the pipe."""


class _Stream(io.FileIO):
    """Standard stream whose output is lost when it is full or closed; computations continue.

    Attributes
    ----------
    error : OSError, optional
        The first error.
    """

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor, "w", closefd=False)
        self.error: OSError | None = None

    def write(self, data: Buffer) -> int:
        """Accept all bytes; only a reader that closes the pipe ends the command."""
        if self.error is None:
            try:
                return super().write(data)
            except OSError as error:
                self.error = error
                if isinstance(error, BrokenPipeError) and self.fileno() != _STANDARD_ERROR:
                    raise ReaderGoneError from error
        return memoryview(data).nbytes


class _Text(io.TextIOWrapper):
    """Text of a standard stream, with control characters as numbers."""

    def write(self, text: str) -> int:
        """Write a text."""
        return super().write(text.translate(_CONTROLS))


@contextmanager
def guarded() -> Iterator[list[OSError]]:
    """Handle errors of the standard streams of the process."""
    _fill()
    codecs.register_error(_ANYWAY, _show_anyway)
    errors: list[OSError] = []
    usual = {name: getattr(sys, name) for name in ("stdout", "stderr")}
    raw: dict[str, _Stream] = {}
    for name, stream in usual.items():
        # a replaced stream, as in tests, stays as it is
        if stream is getattr(sys, f"__{name}__"):
            raw[name] = _Stream(stream.fileno())
            setattr(sys, name, _wrapped(raw[name], stream))
    try:
        yield errors
    finally:
        for name in raw:
            with suppress(BrokenPipeError):
                getattr(sys, name).flush()
            setattr(sys, name, usual[name])
        if "stdout" in raw and raw["stdout"].error is not None:
            errors.append(raw["stdout"].error)


def _wrapped(raw: _Stream, usual: io.TextIOWrapper) -> io.TextIOWrapper:
    return _Text(
        io.BufferedWriter(raw),
        usual.encoding,
        _ANYWAY,
        # write_through, of PYTHONUNBUFFERED, would end in the buffer of bytes
        line_buffering=usual.line_buffering or usual.write_through,
    )


def _fill() -> None:
    """Occupy the descriptors of closed standard streams, so that no result file gets one.

    Printed text would otherwise go into the result file. The substitutes are read-only, so that
    printing on a closed standard output fails as on a full disk.
    """
    while (descriptor := os.open(os.devnull, os.O_RDONLY)) <= _STANDARD_ERROR:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
        # by its name, which `guarded` uses
        setattr(sys, "__stdout__", sys.stdout)  # noqa: B010
    if sys.stderr is None:
        # otherwise messages would go to the standard output
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115


def _show_anyway(error: UnicodeError) -> tuple[str | bytes, int]:
    """Print names that are not UTF-8 as bytes, and unsupported letters as numbers."""
    try:
        return codecs.lookup_error("surrogateescape")(error)
    except UnicodeError:
        return codecs.lookup_error("backslashreplace")(error)
