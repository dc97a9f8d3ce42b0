"""A case in the kernel: read and validated once, whoever computes from it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_cases as _cases
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.marshalling import encode, fetch_text, message_buffer, raise_for, split_table
from rwmf._library.memory import Memory
from rwmf.errors import InputError, without_lines

__all__ = ["Changes", "KernelCase", "Samples", "SceneAxis", "keep_samples", "read_case"]


class SceneAxis(NamedTuple):
    """What an axis of a spectrum is in a scene.

    Attributes
    ----------
    value : float, optional
        What the scene has without the axis; None for nothing.
    unit : str
        Its unit, '1' for none.
    meaning : str
        What it is, and what follows it.
    """

    value: float | None
    unit: str
    meaning: str


class Samples:
    """Samples of a ground motion, checked.

    Parameters
    ----------
    memory : Memory
        Of the kernel.
    """

    def __init__(self, memory: Memory) -> None:
        self._memory = memory

    @property
    def handle(self) -> int:
        """The handle, good as long as this object."""
        return self._memory.handle


class Changes(NamedTuple):
    """Keys of a case that get other numbers.

    Attributes
    ----------
    names : tuple of str
        ``group.key`` each.
    sizes : tuple of int
        How many numbers each gets: one, any number for a list, or 0, which takes the key out.
    """

    names: tuple[str, ...]
    sizes: tuple[int, ...]


class KernelCase:
    """A case as the kernel has read it: any number of threads may compute from it at once.

    Parameters
    ----------
    memory : Memory
        Of the kernel.
    origin : KernelCase, optional
        Of a changed case: that which was read.
    source : str
        What a message begins with.
    """

    def __init__(self, memory: Memory, origin: KernelCase | None = None, source: str = "") -> None:
        self._memory = memory
        self._source = source
        # what was read: of a changed case that with the samples of its records
        self._origin = origin
        self._looked_up: tuple[Changes, Memory] | None = None
        # whether the lines of the text are the user's
        self.has_lines: bool = origin is None or origin.has_lines

    @property
    def handle(self) -> int:
        """The handle, good as long as this object."""
        return self._memory.handle

    def find(self, changes: Changes) -> Memory:
        """Look up keys that change; the last ones are remembered.

        Parameters
        ----------
        changes : Changes
            The keys.

        Returns
        -------
        Memory
            For `changed`.

        Raises
        ------
        InputError
            When the case has no such key, or it holds no numbers.
        """
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
        """Make a case with other numbers; it shares the samples of the records, and their motion.

        Parameters
        ----------
        found : Memory
            From `find`.
        numbers : numpy.ndarray, shape (n,)
            One for each key, of lists theirs one after the other; logicals as 1 and 0.
        source : str
            What a message begins with.

        Returns
        -------
        KernelCase
            The other case.

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        message = message_buffer()
        handle, status, n = _cases.case_change(
            self.handle, found.handle, numbers, encode(source), message
        )
        raise_for(status, message, n)
        return KernelCase(Memory(handle), self._origin or self, source)

    def ordinates(self) -> int:
        """Count the ordinates of the case's spectrum.

        Returns
        -------
        int
            Their number, 0 without `&spectrum`.
        """
        return int(_cases.ordinates(self.handle))

    def describe(self) -> list[list[str]]:
        """One row a value: ``group.key``, type, value, unit, ``given`` or ``default``.

        Returns
        -------
        list of list of str
            In the kernel's order.
        """
        return split_table(fetch_text(_kernel.describe, self.handle))

    def inventory(self) -> dict[str, list[str]]:
        """List what the case will simulate and report.

        Returns
        -------
        dict of str to list of str
            ``effects``, ``absent`` (effects that are not simulated), ``states``, ``events``,
            ``scalars``, ``columns`` when there is a history, and ``notes`` (sentences).

        Raises
        ------
        InputError, NumericalError
            When the case cannot be simulated.
        """
        rows = split_table(self._ask(_kernel.inventory))
        return {word: [name for name in names if name] for word, *names in rows}

    def applicable(self) -> list[str]:
        """List the keys of the quantities that a spectrum of the scene may be asked for.

        Returns
        -------
        list of str
            In the order of the kernel's table.

        Raises
        ------
        InputError, NumericalError
            When the case cannot be simulated.
        """
        return self._ask(_kernel.applicable).split("\t")

    def axes(self) -> dict[str, SceneAxis]:
        """Say which axes the scene has in a spectrum, and what they are in it.

        Returns
        -------
        dict of str to SceneAxis
            ``b``, ``gamma`` and ``T_s`` as far as the scene has them, the slowest first.
        """
        rows = split_table(fetch_text(_kernel.axes_of_case, self.handle))[:-1]
        return {
            name: SceneAxis(float(value) if value else None, unit, meaning)
            for name, value, unit, meaning in rows
        }

    def default_quantity(self) -> str:
        """Key of what is reported of the scene where nothing else is asked for.

        Returns
        -------
        str
            That of the displacement of the frame, without one of the rotation.
        """
        return fetch_text(_kernel.axes_of_case, self.handle).splitlines()[-1]

    def spectrum_method(self) -> str:
        """Name the method by which a spectrum or a sweep of the case is computed.

        Returns
        -------
        str
            What `&solver method` says, of ``auto`` what that means there.
        """
        return fetch_text(_kernel.spectrum_method, self.handle)

    def warnings(self, keys: Iterable[str] = ()) -> list[str]:
        """List what the user should know about the case, in its spectrum if it has one.

        Parameters
        ----------
        keys : iterable of str, optional
            Quantities that are reported; otherwise those that the case asks for.

        Returns
        -------
        list of str
            One line each.
        """
        asked = encode("\t".join(keys))
        text = fetch_text(_kernel.case_warnings, self.handle, asked)
        return [line for line in text.split("\t") if line]

    def _ask(self, procedure: Callable[..., tuple[int, int, int]]) -> str:
        """Fetch a text that the kernel may refuse."""

        def call(buffer: npt.NDArray[np.int8]) -> int:
            message = message_buffer()
            length, status, n = procedure(self.handle, buffer, message)
            with self.own_lines():
                raise_for(status, message, n, source=self._source)
            return length

        return fetch_text(call)

    @contextmanager
    def own_lines(self) -> Iterator[None]:
        """Take numbers of lines out of messages where the text is not the user's.

        Yields
        ------
        None
            Nothing.

        Raises
        ------
        InputError
            In the place of one that is raised inside.
        """
        try:
            yield
        except InputError as error:
            if self.has_lines:
                raise
            raise InputError(without_lines(str(error))) from None

    def end_of_motion(self) -> float:
        """When the ground has come to rest, at the end of pulse or record; 0 without motion [s].

        Returns
        -------
        float
            The time [s].
        """
        return float(_kernel.end_of_motion(self.handle))

    def peak_of_motion(self) -> float:
        """Largest horizontal acceleration of the ground [m/s2].

        Returns
        -------
        float
            The acceleration, 0 without motion.
        """
        return float(_kernel.peak_of_motion(self.handle))


def read_case(
    text: str,
    source: str,
    known: KernelCase | None = None,
    motion: Samples | None = None,
    vertical: Samples | None = None,
) -> KernelCase:
    """Read and validate a case.

    Parameters
    ----------
    text : str
        Namelist text.
    source : str
        Path of its file, against whose folder the path of a record is resolved; '' when it was
        made in memory.
    known : KernelCase, optional
        Where both name the same record, its samples are taken and the file is not read again.
    motion, vertical : Samples, optional
        What `&motion file` and `&vertical file` are the names of: no file is read.

    Returns
    -------
    KernelCase
        What all computations start from.

    Raises
    ------
    InputError
        When the case is not acceptable.
    """
    message = message_buffer()
    others = [0 if kept is None else kept.handle for kept in (known, motion, vertical)]
    handle, status, n = _cases.case_read(encode(text), encode(source), others, message)
    raise_for(status, message, n)
    return KernelCase(Memory(handle), source=source)


def keep_samples(values: npt.NDArray[np.float64], times: npt.NDArray[np.float64] | None) -> Samples:
    """Check samples of a ground motion and keep them in the kernel.

    Parameters
    ----------
    values : numpy.ndarray, shape (n,)
        Accelerations.
    times : numpy.ndarray, shape (n,), or None
        Times [s]; None when the case gives the interval.

    Returns
    -------
    Samples
        For `read_case`.

    Raises
    ------
    InputError
        When a number is not finite, or times do not increase.
    """
    message = message_buffer()
    times = np.zeros(0) if times is None else times
    handle, status, n = _cases.samples_keep(values, times, message)
    raise_for(status, message, n)
    return Samples(Memory(handle))
