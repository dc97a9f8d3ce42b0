"""Walls and elements of a host in the kernel. One thread at a time may use an object."""

from __future__ import annotations

import ctypes
import functools
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_hosts as _hosts
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.kernel_case import KernelCase
from rwmf._library.kernel_thread import NoResult, wait_for
from rwmf._library.marshalling import fetch_text, message_buffer, raise_for
from rwmf._library.memory import Memory
from rwmf.errors import RwmfError

__all__ = ["KernelElement", "KernelWalls", "Saved", "event_names", "next_impact"]

_Reals = npt.NDArray[np.float64]
_Counts = npt.NDArray[np.int64]
_GROUND = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double, ctypes.c_void_p)
_REALS = 11
_COUNTS = 6
_FORCES = 3
_RESPONSES = 8


class Saved(NamedTuple):
    """Saved states of walls.

    Attributes
    ----------
    memory : Memory
        Memory in the kernel.
    n : int
        Number of walls.
    """

    memory: Memory
    n: int


class KernelWalls:
    """Walls in the kernel that advance together.

    Parameters
    ----------
    cases : sequence of KernelCase
        One case for all walls, or one for each.
    n : int
        Number of walls.
    t_begin : float
        Time of the initial state [s].
    peak : float
        Expected peak ground acceleration [m/s2]; 0 for the default.
    source : str
        Beginning of messages.

    Raises
    ------
    InputError
        When a case does not allow stepping, or a number is not acceptable.
    """

    def __init__(
        self, cases: Sequence[KernelCase], n: int, t_begin: float, peak: float, source: str
    ) -> None:
        self._message = message_buffer()
        self._control = np.zeros(2, dtype=np.int64)
        handles = [case.handle for case in cases]
        handle, status, length = _hosts.walls_create(handles, n, t_begin, peak, self._message)
        raise_for(status, self._message, length, source=source)
        self._memory = Memory(handle)
        self.n = n

    def advance(self, t: _Reals, a: _Reals, threads: int) -> None:
        """Advance all walls; after an error none of them has changed.

        Parameters
        ----------
        t : numpy.ndarray, shape (times,)
            Times [s]; the last one is the target.
        a : numpy.ndarray, shape (times, walls), (times, 1) or (times, 0)
            Ground accelerations [m/s2], in Fortran order; (times, 0): the motion of the case.
        threads : int
            Threads of the kernel, 0 for all.

        Raises
        ------
        InputError, NumericalError
            As the kernel reports them.
        Interrupted
            After Ctrl-C, with several walls.
        """
        message, handle = self._message, self._memory.handle
        if self.n == 1:
            status, length = _hosts.walls_advance(handle, t, a, 1, self._control, message)
            if status:
                raise_for(status, message, length)
            return

        def call(control: _Counts) -> tuple[int, int, int]:
            return (0, *_hosts.walls_advance(handle, t, a, threads, control, message))

        wait_for(call, message, "", NoResult, None)

    def advance_ground(self, t: float, function: Callable[[float], float]) -> None:
        """Advance the only wall under a computed acceleration.

        Parameters
        ----------
        t : float
            Time to advance to [s].
        function : callable
            Ground acceleration [m/s2] at a time [s].

        Raises
        ------
        InputError, NumericalError
            As the kernel reports them.
        Exception
            The first exception of `function`.
        """
        raised: list[BaseException] = []

        def ground(time: float, _: object) -> float:
            try:
                return float("nan") if raised else float(function(time))
            except BaseException as error:
                raised.append(error)
                return float("nan")

        callback = _GROUND(ground)
        address = ctypes.cast(callback, ctypes.c_void_p).value
        status, length = _hosts.wall_advance_ground(self._memory.handle, t, address, self._message)
        try:
            raise_for(status, self._message, length)
        except RwmfError:
            if raised:
                raise raised[0] from None
            raise

    def states(self) -> tuple[_Reals, _Counts]:
        """Return the states, written by the kernel into new arrays.

        Returns
        -------
        numpy.ndarray, shape (11, walls)
            Time reached, t, theta, theta_dot, theta_ddot, u_s, u_s_dot, u_s_ddot and the largest
            u_s, theta, theta_dot [s, rad, m].
        numpy.ndarray of int, shape (6, walls)
            Impacts, lift_offs, steps; at rest, overturned, collapsed.
        """
        reals = np.empty((_REALS, self.n))
        counts = np.empty((_COUNTS, self.n), dtype=np.int64)
        status, length = _hosts.walls_state(
            self._memory.handle, reals.T, counts.T, self._message
        )
        raise_for(status, self._message, length)
        return reals, counts

    def forces(self) -> _Reals:
        """Return the forces, written by the kernel into a new array.

        Returns
        -------
        numpy.ndarray, shape (3, walls)
            Link, frame_shear, cable [N], or [N/kg] without a mass in the case.
        """
        forces = np.empty((_FORCES, self.n))
        status, length = _hosts.walls_forces(self._memory.handle, forces.T, self._message)
        raise_for(status, self._message, length)
        return forces

    def events(self) -> tuple[_Counts, npt.NDArray[np.int32], _Reals]:
        """Return the events of the last advance, wall after wall.

        Returns
        -------
        numpy.ndarray of int, shape (walls,)
            Number of events of each wall.
        numpy.ndarray of int, shape (events,)
            Kinds.
        numpy.ndarray, shape (3, events)
            t [s], theta [rad], theta_dot [rad/s].
        """
        counts = np.empty(self.n, dtype=np.int64)
        _hosts.walls_event_counts(self._memory.handle, counts)
        total = int(counts.sum())
        kinds = np.empty(total, dtype=np.int32)
        reals = np.empty((3, total))
        if total:
            _hosts.walls_events(self._memory.handle, kinds, reals.T)
        return counts, kinds, reals

    def save(self) -> Saved:
        """Save the states of all walls.

        Returns
        -------
        Saved
            Argument of `restore`.
        """
        handle, status, length = _hosts.walls_save(self._memory.handle, self._message)
        raise_for(status, self._message, length)
        return Saved(Memory(handle), self.n)

    def restore(self, saved: Saved) -> None:
        """Restore the states of all walls.

        Parameters
        ----------
        saved : Saved
            From `save`, of as many walls.

        Raises
        ------
        InputError
            When the states are those of other walls.
        """
        status, length = _hosts.walls_restore(
            self._memory.handle, saved.memory.handle, self._message
        )
        raise_for(status, self._message, length)


class KernelElement:
    """An element in the kernel.

    Parameters
    ----------
    case : KernelCase
        The case.
    source : str
        Beginning of messages.

    Raises
    ------
    InputError
        When an effect of the case does not allow an element.
    """

    def __init__(self, case: KernelCase, source: str) -> None:
        message = message_buffer()
        handle, status, length = _hosts.element_create(case.handle, message)
        raise_for(status, message, length, source=source)
        self._memory = Memory(handle)

    def respond(self, sides: npt.NDArray[np.int32], motion: _Reals) -> _Reals:
        """Compute the responses to motions of the link.

        Parameters
        ----------
        sides : numpy.ndarray of int, shape (n,)
            Side of each motion.
        motion : numpy.ndarray, shape (4, n)
            u [m], u_dot, u_ddot, u_g_ddot [m/s2].

        Returns
        -------
        numpy.ndarray, shape (8, n)
            Force [N], stiffness [N/m], damping [N s/m], mass [kg], theta [rad], theta_dot,
            theta_ddot, cable [N].

        Raises
        ------
        InputError
            When the wall cannot follow a motion; with several, the message begins with its number.
        """
        message = message_buffer()
        found = np.empty((_RESPONSES, sides.size))
        failed, status, length = _hosts.element_respond(
            self._memory.handle, sides, motion.T, found.T, message
        )
        if status:
            source = f"motion {failed}" if sides.size > 1 else ""
            raise_for(status, message, length, source=source)
        return found

    def velocity_factor(self) -> float:
        """Return the factor on the velocity of the link at an impact.

        Returns
        -------
        float
            The factor [-].
        """
        return float(_hosts.element_factor(self._memory.handle))

    def next_lift_off(self, *motion: float) -> tuple[int, float]:
        """Find the first lift-off in a step.

        Parameters
        ----------
        *motion : float
            Step [s], push at both ends [N], ground acceleration at both ends [m/s2].

        Returns
        -------
        int
            Side, or 0.
        float
            Time since the beginning of the step [s].

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        message = message_buffer()
        side, tau, status, length = _hosts.element_next_lift_off(
            self._memory.handle, motion, message
        )
        raise_for(status, message, length)
        return int(side), float(tau)

    def settles(self, *motion: float) -> bool:
        """Tell whether the wall may be put to rest after an impact.

        Parameters
        ----------
        *motion : float
            Step [s], velocity after the impact [m/s], push [N], ground acceleration [m/s2], mass
            of the host at the link [kg].

        Returns
        -------
        bool
            True when the following flights are shorter than a step.

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        message = message_buffer()
        answer, status, length = _hosts.element_settles(self._memory.handle, motion, message)
        raise_for(status, message, length)
        return bool(answer)


def next_impact(side: int, *motion: float) -> float | None:
    """Find the first impact in a step.

    Parameters
    ----------
    side : int
        1 or -1.
    *motion : float
        Step [s], displacement [m] and velocity [m/s] at its beginning and at its end.

    Returns
    -------
    float or None
        Time since the beginning of the step [s]; None without an impact.

    Raises
    ------
    InputError
        When a number is not acceptable.
    """
    message = message_buffer()
    found, tau, status, length = _hosts.element_next_impact(side, motion, message)
    raise_for(status, message, length)
    return float(tau) if found else None


@functools.cache
def event_names() -> tuple[str, ...]:
    """List the names of the kinds of events 1, 2, ...

    Returns
    -------
    tuple of str
        The names.
    """
    return tuple(fetch_text(_kernel.event_names).splitlines())
