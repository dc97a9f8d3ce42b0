"""Walls and members of a host in the kernel. One thread at a time may use an object."""

from __future__ import annotations

import ctypes
import functools
import math
import signal
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from types import FrameType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf._kernel import rwmf_bindings_python_hosts as _hosts
from rwmf._kernel import rwmf_bindings_python_kernel as _kernel
from rwmf._library.kernel_case import KernelCase
from rwmf._library.kernel_thread import NoResult, wait_for
from rwmf._library.marshalling import fetch_text, message_buffer, raise_for
from rwmf._library.memory import Memory
from rwmf._numbers import float_of, show
from rwmf.errors import InputError

__all__ = ["KernelMember", "KernelWalls", "Saved", "event_names"]

_Reals = npt.NDArray[np.float64]
_Counts = npt.NDArray[np.int64]
_GROUND = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double, ctypes.c_void_p)
# calls that are expected to take longer wait in another thread, so that Ctrl-C ends them
_SHORT_SECONDS = 0.05
_REALS = 11
_COUNTS = 6
_FORCES = 3
# values of a response besides forces and tangents
_DEVICES = 8


class Saved(NamedTuple):
    """Saved states of walls, or that of a member.

    Attributes
    ----------
    memory : Memory
        Memory in the kernel.
    n : int
        Number of walls.
    t : float
        Time reached [s].
    """

    memory: Memory
    n: int
    t: float = 0.0


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
        # time reached [s], and processor time of a second of motion in the last call
        self._t, self._pace = t_begin, math.inf

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
            After Ctrl-C; a call of one wall that is short does not wait for it.
        """
        message, handle = self._message, self._memory.handle
        target = float(t[-1]) if t.size else self._t
        span = target - self._t
        begun = time.perf_counter()
        if self.n == 1 and not self._pace * span > _SHORT_SECONDS:
            status, length = _hosts.walls_advance(handle, t, a, 1, self._control, message)
            if status:
                raise_for(status, message, length)
        else:

            def call(control: _Counts) -> tuple[int, int, int]:
                return (0, *_hosts.walls_advance(handle, t, a, threads, control, message))

            wait_for(call, message, "", NoResult, None)
        self._t = target
        if span > 0:
            self._pace = (time.perf_counter() - begun) / span

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
                return math.nan if raised else _ground_of(function(time))
            except BaseException as error:
                raised.append(error)
                return math.nan

        callback = _GROUND(ground)
        address = ctypes.cast(callback, ctypes.c_void_p).value
        with _signals_in(raised):
            status, length = _hosts.wall_advance_ground(
                self._memory.handle, t, address, self._message
            )
        if status == 0:
            self._t = t
        if raised:
            raise raised[0] from None
        raise_for(status, self._message, length)

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
        status, length = _hosts.walls_state(self._memory.handle, reals.T, counts.T, self._message)
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
        return Saved(Memory(handle), self.n, self._t)

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
        self._t = saved.t


def _ground_of(value: object) -> float:
    """Return the acceleration that a function of the caller returns."""
    number = float_of(value)
    if number is None:
        raise InputError(f"function: returns {show(value)}: must return a number")
    return number


@contextmanager
def _signals_in(raised: list[BaseException]) -> Iterator[None]:
    """Keep exceptions of the handler of Ctrl-C, which are lost in a function called by the kernel.

    Parameters
    ----------
    raised : list
        Receives the exceptions.

    Yields
    ------
    None
        Control to the block.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return

    def keep(number: int, frame: FrameType | None) -> None:
        try:
            handler(number, frame)
        except BaseException as error:
            raised.append(error)

    signal.signal(signal.SIGINT, keep)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)


class KernelMember:
    """A wall in the kernel with the state of its springs; returns forces to motions of a host.

    Parameters
    ----------
    case : KernelCase
        The case.
    source : str
        Beginning of messages.

    Raises
    ------
    InputError
        When an effect of the case does not allow it.
    """

    def __init__(self, case: KernelCase, source: str) -> None:
        message = message_buffer()
        handle, status, length = _hosts.member_create(case.handle, message)
        raise_for(status, message, length, source=source)
        self._memory = Memory(handle)
        self.dofs, self.modes, self.floors, self.links = (int(n) for n in self._info()[:4])

    def _info(self) -> _Counts:
        counts: _Counts = _hosts.member_info(self._memory.handle)[0]
        return counts

    def committed(self) -> tuple[int, bool, float]:
        """Return the committed state.

        Returns
        -------
        int
            Side, 0 at rest.
        bool
            True if the tendon has broken.
        float
            Displacement of the link [m].
        """
        counts, u = _hosts.member_info(self._memory.handle)
        return int(counts[4]), bool(counts[5]), float(u)

    def respond(self, sides: npt.NDArray[np.int32], motion: _Reals) -> _Reals:
        """Compute the responses to trial motions; the last one sets the trial state.

        Parameters
        ----------
        sides : numpy.ndarray of int, shape (m,)
            0 for the committed state, else the side of a wall whose springs have not moved.
        motion : numpy.ndarray, shape (m, 3*dofs + 2)
            Displacements, velocities, accelerations [m, s]; u_g_ddot and v_g_ddot [m/s2].

        Returns
        -------
        numpy.ndarray, shape (m, dofs + 3*dofs**2 + 8)
            Forces [N]; stiffness, damping, mass; hold (2) [N], theta [rad], theta_dot,
            theta_ddot, cable [N], fuses (2) [N].

        Raises
        ------
        InputError
            When the wall cannot follow a motion; with several, the message begins with its number.
        """
        message = message_buffer()
        found = np.empty((sides.size, self.dofs + 3 * self.dofs**2 + _DEVICES))
        failed, status, length = _hosts.member_respond(
            self._memory.handle, sides, motion.T, found.T, message
        )
        if status:
            source = f"motion {failed}" if sides.size > 1 else ""
            raise_for(status, message, length, source=source)
        return found

    def change(self, change: int) -> None:
        """Change the state.

        Parameters
        ----------
        change : int
            1: keep the trial state; 2: return to the committed state; 3: to the first one.
        """
        message = message_buffer()
        status, length = _hosts.member_change(self._memory.handle, change, message)
        raise_for(status, message, length)

    def place(self, side: int) -> None:
        """Set the side of a wall that is committed at u = 0.

        Parameters
        ----------
        side : int
            1, -1, or 0 for rest.

        Raises
        ------
        InputError
            When the wall is not on its base, or the side is another one.
        """
        message = message_buffer()
        status, length = _hosts.member_place(self._memory.handle, side, message)
        raise_for(status, message, length)

    def save(self) -> Saved:
        """Save the committed and the trial state.

        Returns
        -------
        Saved
            Argument of `restore`.
        """
        return Saved(Memory(_hosts.member_save(self._memory.handle)), 1)

    def restore(self, saved: Saved) -> None:
        """Restore a saved state.

        Parameters
        ----------
        saved : Saved
            From `save` of this object.
        """
        _hosts.member_restore(self._memory.handle, saved.memory.handle)

    def links_of(self, motion: _Reals) -> _Reals:
        """Return the motion of the wall at its links.

        Parameters
        ----------
        motion : numpy.ndarray, shape (3*dofs,)
            Displacements, velocities, accelerations [m, s].

        Returns
        -------
        numpy.ndarray, shape (3 + dofs, links)
            Displacement [m], velocity [m/s], acceleration [m/s2] and derivatives [-].

        Raises
        ------
        InputError
            When the wall cannot follow the motion.
        """
        message = message_buffer()
        found = np.empty((3 + self.dofs, self.links))
        status, length = _hosts.member_links(self._memory.handle, motion, found.T, message)
        raise_for(status, message, length)
        return found

    def next_event(self, numbers: _Reals, has_branches: bool) -> tuple[int, float, int]:
        """Find the first event of a step.

        Parameters
        ----------
        numbers : numpy.ndarray, shape (7 + 6*dofs,)
            Step [s], pushes at both ends [N], u_g_ddot and v_g_ddot at both ends [m/s2], motions at
            both ends.
        has_branches : bool
            Whether ends of branches are events.

        Returns
        -------
        int
            Kind, 0 for none.
        float
            Time since the beginning [s].
        int
            Side of a lift-off.

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        message = message_buffer()
        event, status, length = _hosts.member_next_event(
            self._memory.handle, numbers, int(has_branches), message
        )
        raise_for(status, message, length)
        return int(event[0]), float(event[1]), int(event[2])

    def land(self, displacements: _Reals, velocities: _Reals, mass: _Reals) -> None:
        """Apply an impact: change the velocities and the side.

        Parameters
        ----------
        displacements, velocities : numpy.ndarray, shape (dofs,)
            Motion before the impact [m, m/s]; the velocities are changed.
        mass : numpy.ndarray, shape (dofs, dofs) or (0, 0)
            Masses of the host [kg]; empty for those of the case.

        Raises
        ------
        InputError
            When the wall is not on its base or moves away from it.
        """
        message = message_buffer()
        status, length = _hosts.member_land(
            self._memory.handle, displacements, velocities, mass, message
        )
        raise_for(status, message, length)

    def settles(self, numbers: _Reals, mass: _Reals) -> bool:
        """Tell whether the wall may be put to rest after an impact.

        Parameters
        ----------
        numbers : numpy.ndarray, shape (4 + 3*dofs,)
            Step [s], push [N], u_g_ddot and v_g_ddot [m/s2], motion after the impact.
        mass : numpy.ndarray, shape (dofs, dofs) or (0, 0)
            Masses of the host [kg]; empty for those of the case.

        Returns
        -------
        bool
            True when all following flights together are shorter than a step.

        Raises
        ------
        InputError
            When the wall is not on its base, or a number is not acceptable.
        """
        message = message_buffer()
        answer, status, length = _hosts.member_rests(self._memory.handle, numbers, mass, message)
        raise_for(status, message, length)
        return bool(answer)


@functools.cache
def event_names() -> tuple[str, ...]:
    """List the names of the kinds of events 1, 2, ...

    Returns
    -------
    tuple of str
        The names.
    """
    return tuple(fetch_text(_kernel.event_names).splitlines())
