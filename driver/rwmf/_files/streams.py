"""Standard output and error of the command: closed, full, or without a name's letters."""

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

__all__ = ["ReaderGoneError", "guarded"]

_STANDARD_ERROR = 2
# name of the handler of letters that a stream cannot show
_ANYWAY = "rwmf"


class ReaderGoneError(BrokenPipeError):
    """Whoever reads the output through a pipe has seen enough."""


class _Stream(io.FileIO):
    """A standard stream. A full or closed one loses what is printed, but stops no computation.

    Attributes
    ----------
    error : OSError, optional
        The first one.
    """

    def __init__(self, descriptor: int) -> None:
        super().__init__(descriptor, "w", closefd=False)
        self.error: OSError | None = None

    def write(self, data: Buffer) -> int:
        """Take all bytes; only a reader of the output who has seen enough ends the command."""
        if self.error is None:
            try:
                return super().write(data)
            except OSError as error:
                self.error = error
                if isinstance(error, BrokenPipeError) and self.fileno() != _STANDARD_ERROR:
                    raise ReaderGoneError from error
        return memoryview(data).nbytes


@contextmanager
def guarded() -> Iterator[list[OSError]]:
    """Look after the standard streams of the process.

    Yields
    ------
    list of OSError
        Filled when the block ends: why the standard output could not be written.
    """
    _fill()
    codecs.register_error(_ANYWAY, _show_anyway)
    errors: list[OSError] = []
    usual = {name: getattr(sys, name) for name in ("stdout", "stderr")}
    raw: dict[str, _Stream] = {}
    for name, stream in usual.items():
        # what stands in for a stream, as in tests, is not the command's business
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
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        usual.encoding,
        _ANYWAY,
        line_buffering=usual.line_buffering,
        write_through=usual.write_through,
    )


def _fill() -> None:
    """Let no file of results get the number of a standard stream that the caller has closed.

    What is printed would go into it. What takes the number instead can only be read, so that
    printing on a closed standard output fails as on a full one.
    """
    while (descriptor := os.open(os.devnull, os.O_RDONLY)) <= _STANDARD_ERROR:
        os.set_inheritable(descriptor, True)
    os.close(descriptor)
    if sys.stdout is None:
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
        # by its name, as `guarded` looks for it
        setattr(sys, "__stdout__", sys.stdout)  # noqa: B010
    if sys.stderr is None:
        # without it messages would go to the standard output
        sys.stderr = Path(os.devnull).open("w")  # noqa: SIM115


def _show_anyway(error: UnicodeError) -> tuple[str | bytes, int]:
    """Print names that are no UTF-8 as their bytes, letters that a terminal lacks as numbers."""
    try:
        return codecs.lookup_error("surrogateescape")(error)
    except UnicodeError:
        return codecs.lookup_error("backslashreplace")(error)
