"""A case in the kernel: read and validated once, whoever computes from it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.marshalling import encode, fetch_text, message_buffer, raise_for, split_table
from rwmf._library.memory import Memory

__all__ = ["KernelCase", "SceneAxis", "read_case"]


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


class KernelCase:
    """A case as the kernel has read it: any number of threads may compute from it at once.

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

    def broken_laws(self) -> int:
        """Laws of conservation that the case asks to break.

        Returns
        -------
        int
            Bit 0 energy, bit 1 angular momentum at impacts.
        """
        return int(_kernel.broken_laws(self.handle))

    def _ask(self, procedure: Callable[..., tuple[int, int, int]]) -> str:
        """Fetch a text that the kernel may refuse."""

        def call(buffer: npt.NDArray[np.int8]) -> int:
            message = message_buffer()
            length, status, n = procedure(self.handle, buffer, message)
            raise_for(status, message, n)
            return length

        return fetch_text(call)

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


def read_case(text: str, source: str, known: KernelCase | None = None) -> KernelCase:
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
    handle, status, n = _kernel.case_read(
        encode(text), encode(source), 0 if known is None else known.handle, message
    )
    raise_for(status, message, n)
    return KernelCase(Memory(handle))
