"""Cases in the kernel, read and validated once for all computations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_cases as _cases
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf.errors import InputError, without_lines
from rwmf.kernel.marshalling import (
    Memory,
    encode,
    fetch_text,
    message_buffer,
    raise_for,
    split_table,
)


class SceneAxis(NamedTuple):
    """Definition of a spectrum's axis in a scene.

    Attributes
    ----------
    value : float, optional
        Value in the scene without the axis; None if it has none.
    unit : str
        Unit, '1' for none.
    meaning : str
        Definition, and the properties that follow it.
    """

    value: float | None
    unit: str
    meaning: str


class Samples:
    """Validated samples of a ground motion."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory

    @property
    def handle(self) -> int:
        """Handle, valid as long as this object."""
        return self._memory.handle


class Changes(NamedTuple):
    """Keys of a case that get new numbers.

    Attributes
    ----------
    names : tuple of str
        ``group.key`` of each.
    sizes : tuple of int
        Numbers for each key: one, any number for a list, or 0 to remove the key.
    """

    names: tuple[str, ...]
    sizes: tuple[int, ...]


class KernelCase:
    """A case in the kernel, safe for concurrent computations."""

    def __init__(self, memory: Memory, origin: KernelCase | None = None, source: str = "") -> None:
        self._memory = memory
        self._source = source
        # the case that was read; it holds the samples of the records
        self._origin = origin
        self._looked_up: tuple[Changes, Memory] | None = None
        # True when line numbers refer to text of the user
        self.has_lines: bool = origin is None or origin.has_lines

    @property
    def handle(self) -> int:
        """Handle, valid as long as this object."""
        return self._memory.handle

    def find(self, changes: Changes) -> Memory:
        """Look up keys to change; the last ones are cached."""
        last = self._looked_up
        if last is not None and last[0] == changes:
            return last[1]
        message = message_buffer()
        handle, status, n = _cases.changes_find(
            self.handle, encode(" ".join(changes.names)), changes.sizes, message
        )
        raise_for(status, message, n)
        found = Memory(handle)
        self._looked_up = (changes, found)
        return found

    def changed(self, found: Memory, numbers: npt.NDArray[np.float64], source: str) -> KernelCase:
        """Make a case with other numbers; it shares the records' samples and the motion."""
        message = message_buffer()
        handle, status, n = _cases.case_change(
            self.handle, found.handle, numbers, encode(source), message
        )
        raise_for(status, message, n)
        return KernelCase(Memory(handle), self._origin or self, source)

    def ordinates(self) -> int:
        """Count the ordinates of the case's spectrum."""
        return int(_cases.ordinates(self.handle))

    def describe(self) -> list[list[str]]:
        """Return one row per value: ``group.key``, type, value, unit, ``given`` or ``default``."""
        return split_table(fetch_text(_kernel.describe, self.handle))

    def inventory(self) -> dict[str, list[str]]:
        """List effects and outputs of the case."""
        rows = split_table(self._ask(_kernel.inventory))
        return {word: [name for name in names if name] for word, *names in rows}

    def applicable(self) -> list[str]:
        """List the keys of the quantities available in a spectrum of the scene."""
        return self._ask(_kernel.applicable).split("\t")

    def axes(self) -> dict[str, SceneAxis]:
        """Return the axes that a spectrum of the scene can have, with their definitions."""
        rows = split_table(fetch_text(_kernel.axes_of_case, self.handle))[:-1]
        return {
            name: SceneAxis(float(value) if value else None, unit, meaning)
            for name, value, unit, meaning in rows
        }

    def default_quantity(self) -> str:
        """Return the key of the quantity that a spectrum reports by default."""
        return fetch_text(_kernel.axes_of_case, self.handle).splitlines()[-1]

    def spectrum_method(self) -> str:
        """Return the name of the method for a spectrum or a sweep of the case."""
        return fetch_text(_kernel.spectrum_method, self.handle)

    def warnings(self, keys: Iterable[str] = ()) -> list[str]:
        """Return the warnings about the case and its spectrum."""
        requested = encode("\t".join(keys))
        text = fetch_text(_kernel.case_warnings, self.handle, requested)
        return [line for line in text.split("\t") if line]

    def motion_warnings(self) -> list[str]:
        """Return the warnings about the motion of the case, whatever its outputs."""
        return self.warnings(("u_s_max_m",))

    def paper_coefficients(self, theta: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Compute the coefficients of Eq. (15)."""
        found = np.empty((theta.size, 4), order="F")
        message = message_buffer()
        status, n = _kernel.paper_coefficients(self.handle, theta, found, message)
        with self.own_lines():
            raise_for(status, message, n, source=self._source)
        return found

    def _ask(self, procedure: Callable[..., tuple[int, int, int]]) -> str:
        """Fetch a text, and raise the error of the kernel if there is one."""

        def call(buffer: npt.NDArray[np.int8]) -> int:
            message = message_buffer()
            length, status, n = procedure(self.handle, buffer, message)
            with self.own_lines():
                raise_for(status, message, n, source=self._source)
            return length

        return fetch_text(call)

    @contextmanager
    def own_lines(self) -> Iterator[None]:
        """Remove line numbers from messages about text that the user has not written."""
        try:
            yield
        except InputError as error:
            if self.has_lines:
                raise
            raise InputError(without_lines(str(error))) from None

    def limited_demands(self) -> list[str]:
        """Return the keys of the demands that `&limits` requests, with numbers of floors."""
        return fetch_text(_kernel.limited_demands, self.handle).split()

    def end_of_motion(self) -> float:
        """Return the end of the pulse or record; 0 without motion [s]."""
        return float(_kernel.end_of_motion(self.handle))

    def peak_of_motion(self) -> float:
        """Return the largest horizontal acceleration of the ground [m/s2]."""
        return float(_kernel.peak_of_motion(self.handle))


def read_case(
    text: str,
    source: str,
    known: KernelCase | None = None,
    motion: Samples | None = None,
    vertical: Samples | None = None,
) -> KernelCase:
    """Read and validate a case."""
    others = [0 if kept is None else kept.handle for kept in (known, motion, vertical)]
    return _read(text, source, others, is_for_host=False)


def read_host_case(text: str, source: str) -> KernelCase:
    """Read and validate a case for an element."""
    return _read(text, source, [0, 0, 0], is_for_host=True)


def _read(text: str, source: str, others: list[int], *, is_for_host: bool) -> KernelCase:
    message = message_buffer()
    handle, status, n = _cases.case_read(
        encode(text), encode(source), others, int(is_for_host), message
    )
    raise_for(status, message, n)
    return KernelCase(Memory(handle), source=source)


def keep_samples(values: npt.NDArray[np.float64], times: npt.NDArray[np.float64] | None) -> Samples:
    """Check samples of a ground motion and store them in the kernel."""
    message = message_buffer()
    times = np.zeros(0) if times is None else times
    handle, status, n = _cases.samples_keep(values, times, message)
    raise_for(status, message, n)
    return Samples(Memory(handle))
