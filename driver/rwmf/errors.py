"""Exceptions of the package; each also derives from the matching built-in exception."""

from __future__ import annotations

import logging
import re
import sys
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

__all__ = [
    "LOG",
    "InputError",
    "Interrupted",
    "NumericalError",
    "OutputError",
    "RwmfError",
    "RwmfWarning",
    "call_depth",
    "did_you_mean",
    "no_line_numbers",
    "placed",
    "warn",
    "without_lines",
]

# silent unless the user configures logging
LOG = logging.getLogger("rwmf")
LOG.addHandler(logging.NullHandler())

_PACKAGE = str(Path(__file__).parent)
# number of public functions that are running, one inside the other
call_depth: ContextVar[int] = ContextVar("call_depth", default=0)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Suggest a known word for an unknown one, for the message of an error."""
    import difflib

    by_lower = {name.lower(): name for name in known}
    near = difflib.get_close_matches(word.lower(), by_lower, n=1)
    return f", did you mean {by_lower[near[0]]}?" if near else ""


def without_lines(message: str) -> str:
    """Remove line numbers from a message about text that the user has not written."""
    return re.sub(r" \(line \d+\)", "", message)


@contextmanager
def no_line_numbers() -> Iterator[None]:
    """Remove line numbers from messages about text that the user has not written."""
    try:
        yield
    except InputError as error:
        raise InputError(without_lines(str(error))) from None


class RwmfError(Exception):
    """Base of all errors of the package.

    Attributes
    ----------
    exit_status : int
        Exit status of the command line for this error.
    """

    exit_status = 1


class NumericalError(RwmfError, RuntimeError):
    """The integration failed, for example because of too many steps."""

    exit_status = 1


class InputError(RwmfError, ValueError):
    """A case, a record or an argument is not acceptable; the message gives the allowed values."""

    exit_status = 2


class OutputError(RwmfError, OSError):
    """A file cannot be written; existing files of that name are unchanged."""

    exit_status = 2


@contextmanager
def placed(place: str) -> Iterator[None]:
    """Put a place before the message of an input error."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}{error}") from None


# Ctrl-C stopped a running kernel; Python ends with the status of the signal for this type alone
Interrupted = KeyboardInterrupt


class RwmfWarning(UserWarning):
    """Warning about a result: the model, the input or the accuracy."""


def warn(lines: Iterable[str]) -> None:
    """Emit warnings about a result at the line of the user that called the package.

    A function that another public function of the package has called emits none.
    """
    if call_depth.get() > 1:
        return
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(_PACKAGE):
        level, frame = level + 1, frame.f_back
    for line in lines:
        LOG.info("warning: %s", line)
        warnings.warn(line, RwmfWarning, stacklevel=level)
