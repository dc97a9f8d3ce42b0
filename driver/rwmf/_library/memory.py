"""Memory of the kernel behind handles.

Cases and results stay in the kernel as long as Python refers to them, even through an array only;
large arrays are not copied.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel

__all__ = ["Memory", "MemoryView"]


class Memory:
    """Memory of the kernel behind a handle, released with the last reference."""

    __slots__ = ("handle",)

    def __init__(self, handle: int) -> None:
        self.handle = int(handle)

    def __del__(self, release: Callable[[int], None] = _kernel.release) -> None:
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
