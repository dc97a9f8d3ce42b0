"""Cases in the kernel, read and validated once for all computations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from rwmf._kernel import rwmf_bindings_python_cases as _cases
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf.errors import no_line_numbers
from rwmf.kernel.marshalling import Memory, call, encode, fetch_text, split_table
from rwmf.kernel.numbers import Array


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
        names = encode(" ".join(changes.names))
        found = Memory(*call(_cases.changes_find, self.handle, names, changes.sizes))
        self._looked_up = (changes, found)
        return found

    def changed(self, found: Memory, numbers: Array, source: str) -> KernelCase:
        """Make a case with other numbers; it shares the records' samples and the motion."""
        handles = (self.handle, found.handle)
        memory = Memory(*call(_cases.case_change, *handles, numbers, encode(source)))
        return KernelCase(memory, self._origin or self, source)

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

    def paper_coefficients(self, theta: Array) -> Array:
        """Compute the coefficients of Eq. (15)."""
        found = np.empty((theta.size, 4), order="F")
        with self.own_lines():
            call(_kernel.paper_coefficients, self.handle, theta, found, source=self._source)
        return found

    def _ask(self, procedure: Callable[..., tuple[int, int, int]]) -> str:
        """Fetch a text, and raise the error of the kernel if there is one."""
        with self.own_lines():
            return fetch_text(
                lambda buffer: call(procedure, self.handle, buffer, source=self._source)[0]
            )

    def own_lines(self) -> AbstractContextManager[None]:
        """Remove line numbers from messages about text that the user has not written."""
        return nullcontext() if self.has_lines else no_line_numbers()

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
    samples: Mapping[str, Memory] = MappingProxyType({}),
    *,
    is_for_host: bool = False,
) -> KernelCase:
    """Read and validate a case; that of an element may lack keys that only a run needs."""
    kept = (known, samples.get("motion"), samples.get("vertical"))
    others = [0 if item is None else item.handle for item in kept]
    texts = (encode(text), encode(source))
    return KernelCase(
        Memory(*call(_cases.case_read, *texts, others, int(is_for_host))), source=source
    )


def keep_samples(values: Array, times: Array | None) -> Memory:
    """Check samples of a ground motion and store them in the kernel."""
    times = np.zeros(0) if times is None else times
    return Memory(*call(_cases.samples_keep, values, times))
