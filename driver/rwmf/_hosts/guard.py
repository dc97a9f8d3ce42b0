"""Access to an object of the kernel: one thread at a time, not after its end."""

from __future__ import annotations

import threading
from typing import Generic, NoReturn, Self, TypeVar

from rwmf.errors import InputError

__all__ = ["Closable", "Guard", "NotPickled"]

_K = TypeVar("_K")


class NotPickled:
    """Base of objects whose memory belongs to the kernel."""

    def __reduce__(self) -> NoReturn:
        """Refuse pickling and copying."""
        name = type(self).__name__
        raise TypeError(f"{name} cannot be pickled or copied: create it from its case")


class Guard(Generic[_K]):
    """Lends an object of the kernel to one call at a time; other threads wait."""

    __slots__ = ("_is_busy", "_kept", "_lock", "_name")

    def __init__(self, kept: _K, name: str) -> None:
        self._kept: _K | None = kept
        self._name = name
        self._is_busy = False
        self._lock = threading.RLock()

    def __enter__(self) -> _K:
        self._lock.acquire()
        if self._kept is None or self._is_busy:
            problem = "is closed" if self._kept is None else "is in use: a call of it is not over"
            self._lock.release()
            raise InputError(f"this {self._name} {problem}")
        self._is_busy = True
        return self._kept

    def __exit__(self, *unused: object) -> None:
        self._is_busy = False
        self._lock.release()

    @property
    def is_open(self) -> bool:
        """False after `close`."""
        return self._kept is not None

    def close(self) -> None:
        """Drop the object; a second call has no effect."""
        if self._kept is not None:
            with self:
                self._kept = None


class Closable(NotPickled, Generic[_K]):
    """Base of objects that lend one of the kernel until they are closed; a context manager."""

    _guard: Guard[_K]

    def __enter__(self) -> Self:
        """Return the object, to be closed at the end of the block."""
        return self

    def __exit__(self, *unused: object) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Free the memory. Every later call but `close` is an error."""
        self._guard.close()
