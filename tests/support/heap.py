"""Memory in use by this process, to the byte."""

import ctypes
import gc
import sys
from collections.abc import Callable

_FIELDS = [
    "arena", "pieces", "small", "maps", "mapped", "most", "freed", "used", "free", "releasable",
]  # fmt: skip


class _Info(ctypes.Structure):
    """``struct mallinfo2`` of glibc, with our words."""

    _fields_ = [(name, ctypes.c_size_t) for name in _FIELDS]


def _in_use() -> tuple[int, int]:
    """Return bytes of malloc, and blocks of Python's own allocator."""
    gc.collect()
    query = ctypes.CDLL(None).mallinfo2
    query.restype = _Info
    info = query()
    return info.used + info.mapped, sys.getallocatedblocks()


def growth(cycle: Callable[[int], None], n: int) -> tuple[int, int]:
    """Return the growth of memory by cycles, after some that fill all caches.

    Parameters
    ----------
    cycle : callable
        Makes a number of cycles.
    n : int
        The number.

    Returns
    -------
    heap : int
        Growth of the heap [B].
    blocks : int
        Growth of the number of blocks of Python.
    """
    cycle(max(10, n // 10))
    heap = blocks = sys.maxsize
    # a leak grows in each round, a cache in some of them only
    for _ in range(5):
        before = _in_use()
        cycle(n)
        after = _in_use()
        heap, blocks = min(heap, after[0] - before[0]), min(blocks, after[1] - before[1])
        if heap <= 0 and blocks <= 1:
            break
    return heap, blocks
