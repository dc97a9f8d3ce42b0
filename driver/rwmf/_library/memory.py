"""Memory of the kernel behind handles.

Cases and results stay in the kernel as long as Python refers to them, be it through an array alone:
the large arrays are not copied.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rwmf._kernel import rwmf_bindings_python_kernel as _kernel

__all__ = ["Memory", "MemoryView"]


class Memory:
    """Memory of the kernel behind a handle, given back when nothing refers to it any more.

    Parameters
    ----------
    handle : int
        Of the kernel.
    """

    __slots__ = ("handle",)

    def __init__(self, handle: int) -> None:
        self.handle = int(handle)

    def __del__(self, release: Callable[[int], None] = _kernel.release) -> None:
        release(self.handle)


class MemoryView:
    """What numpy needs to see an array of the kernel; the array keeps the memory alive.

    Parameters
    ----------
    memory : Memory
        That the array lies in.
    address : int
        Of its first number.
    shape : tuple of int
        In C's order.
    """

    def __init__(self, memory: Memory, address: int, shape: tuple[int, ...]) -> None:
        self.memory = memory
        # in C's order: the first index of Fortran, which runs fastest, is the last one here
        self.__array_interface__ = {
            "version": 3,
            "typestr": np.dtype(np.float64).str,
            "shape": tuple(int(n) for n in shape),
            "data": (int(address), False),
        }
