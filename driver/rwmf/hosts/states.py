"""Values that a host queries from its walls, and guards of objects in the kernel."""

from __future__ import annotations

import threading
from typing import Generic, NamedTuple, NoReturn, Self, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf.errors import InputError

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
        """Take the object."""
        self._lock.acquire()
        if self._kept is None or self._is_busy:
            problem = "is closed" if self._kept is None else "is in use: a call of it is not over"
            self._lock.release()
            raise InputError(f"this {self._name} {problem}")
        self._is_busy = True
        return self._kept

    def __exit__(self, *unused: object) -> None:
        """Give it back."""
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
        """Give it back."""
        """Close it."""
        self.close()

    def close(self) -> None:
        """Free the memory. Every later call but `close` is an error."""
        self._guard.close()


Reals = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]
_Real = TypeVar("_Real", float, Reals)
_Count = TypeVar("_Count", int, Counts)
_Flag = TypeVar("_Flag", bool, Flags)


class WallState(NamedTuple, Generic[_Real, _Count, _Flag]):
    """State of a wall, or arrays of shape (walls,). Components that do not apply are 0.

    Attributes
    ----------
    t : float
        Time of the state [s]; that of the end for a wall that overturned or collapsed.
    theta, theta_dot, theta_ddot : float
        Rotation [rad] and its rates [rad/s, rad/s2].
    u_s, u_s_dot, u_s_ddot : float
        Displacement of the frame relative to the ground [m] and its rates [m/s, m/s2].
    impacts, lift_offs, steps : int
        Counts since the beginning; steps of the integrator.
    at_rest, overturned, collapsed : bool
        Whether the wall rests on its base, has overturned, or a drift has passed its limit.
    """

    t: _Real
    theta: _Real
    theta_dot: _Real
    theta_ddot: _Real
    u_s: _Real
    u_s_dot: _Real
    u_s_ddot: _Real
    impacts: _Count
    lift_offs: _Count
    steps: _Count
    at_rest: _Flag
    overturned: _Flag
    collapsed: _Flag


class WallForces(NamedTuple, Generic[_Real]):
    """Forces of a wall, or arrays of shape (walls,), in N; in N/kg without a mass in the case.

    Attributes
    ----------
    link : float
        Force of the wall on the frame [N], positive towards positive u_s.
    frame_shear : float
        Force of the frame's spring and damper [N].
    cable : float
        Tension of the tendon [N].
    """

    link: _Real
    frame_shear: _Real
    cable: _Real


class WallMaxima(NamedTuple, Generic[_Real]):
    """Largest magnitudes since the beginning, or arrays of shape (walls,).

    Attributes
    ----------
    u_s_max : float
        Displacement of the frame [m].
    theta_max : float
        Rotation [rad].
    theta_dot_max : float
        Rate of rotation [rad/s].
    """

    u_s_max: _Real
    theta_max: _Real
    theta_dot_max: _Real


class WallEvent(NamedTuple):
    """Event of the last advance.

    Attributes
    ----------
    kind : str
        ``impact``, ``peak``, ``lift_off``, ``rest``, ``overturned``, ``collapsed``; with springs
        ``branch``, ``rupture``, ``passage``.
    t : float
        Time [s].
    theta : float
        Rotation [rad].
    theta_dot : float
        Rate of rotation, before an impact [rad/s].
    """

    kind: str
    t: float
    theta: float
    theta_dot: float


class WallEvents(NamedTuple):
    """Events of the last advance of many walls, wall after wall.

    Attributes
    ----------
    wall : numpy.ndarray of int, shape (events,)
        Number of the wall, from 0.
    kind : numpy.ndarray of str, shape (events,)
        As in `WallEvent`.
    t, theta, theta_dot : numpy.ndarray, shape (events,)
        Time [s], rotation [rad], rate of rotation [rad/s].
    """

    wall: Counts
    kind: npt.NDArray[np.str_]
    t: Reals
    theta: Reals
    theta_dot: Reals
