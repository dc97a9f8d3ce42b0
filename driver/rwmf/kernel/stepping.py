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
from rwmf.errors import InputError
from rwmf.kernel.kernel_case import KernelCase
from rwmf.kernel.marshalling import Memory, call, fetch_text, message_buffer, raise_for, wait_for
from rwmf.kernel.numbers import Array, Wholes, float_of, show

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
    """Walls in the kernel that advance together."""

    def __init__(
        self, cases: Sequence[KernelCase], n: int, t_begin: float, peak: float, source: str
    ) -> None:
        self._message = message_buffer()
        self._control = np.zeros(2, dtype=np.int64)
        handles = [case.handle for case in cases]
        self._memory = Memory(*call(_hosts.walls_create, handles, n, t_begin, peak, source=source))
        self.n = n
        # time reached [s], and processor time of a second of motion in the last call
        self._t, self._pace = t_begin, math.inf

    def advance(self, t: Array, a: Array, threads: int) -> None:
        """Advance all walls; after an error none of them has changed."""
        message, handle = self._message, self._memory.handle
        target = float(t[-1]) if t.size else self._t
        span = target - self._t
        begun = time.perf_counter()
        if self.n == 1 and not self._pace * span > _SHORT_SECONDS:
            status, length = _hosts.walls_advance(handle, t, a, 1, self._control, message)
            if status:
                raise_for(status, message, length)
        else:
            asked = (handle, t, a, threads)
            wait_for(lambda *buffers: _hosts.walls_advance(*asked, *buffers), "", lambda: None)
        self._t = target
        if span > 0:
            self._pace = (time.perf_counter() - begun) / span

    def advance_ground(self, t: float, function: Callable[[float], float]) -> None:
        """Advance the only wall under a computed acceleration."""
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

    def states(self) -> tuple[Array, Wholes]:
        """Return the states, written by the kernel into new arrays."""
        reals = np.empty((_REALS, self.n))
        counts = np.empty((_COUNTS, self.n), dtype=np.int64)
        call(_hosts.walls_state, self._memory.handle, reals.T, counts.T)
        return reals, counts

    def forces(self) -> Array:
        """Return the forces, written by the kernel into a new array."""
        forces = np.empty((_FORCES, self.n))
        call(_hosts.walls_forces, self._memory.handle, forces.T)
        return forces

    def events(self) -> tuple[Wholes, npt.NDArray[np.int32], Array]:
        """Return the events of the last advance, wall after wall."""
        counts = np.empty(self.n, dtype=np.int64)
        _hosts.walls_event_counts(self._memory.handle, counts)
        total = int(counts.sum())
        kinds = np.empty(total, dtype=np.int32)
        reals = np.empty((3, total))
        if total:
            _hosts.walls_events(self._memory.handle, kinds, reals.T)
        return counts, kinds, reals

    def save(self) -> Saved:
        """Save the states of all walls."""
        return Saved(Memory(*call(_hosts.walls_save, self._memory.handle)), self.n, self._t)

    def restore(self, saved: Saved) -> None:
        """Restore the states of all walls."""
        call(_hosts.walls_restore, self._memory.handle, saved.memory.handle)
        self._t = saved.t


def _ground_of(value: object) -> float:
    """Return the acceleration that a function of the caller returns."""
    number = float_of(value)
    if number is None:
        raise InputError(f"function: returns {show(value)}: must return a number")
    return number


@contextmanager
def _signals_in(raised: list[BaseException]) -> Iterator[None]:
    """Keep exceptions of the handler of Ctrl-C, which the kernel loses in its callbacks."""
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
    """A wall in the kernel with the state of its springs; returns forces to motions of a host."""

    def __init__(self, case: KernelCase, source: str) -> None:
        self._memory = Memory(*call(_hosts.member_create, case.handle, source=source))
        counts = _hosts.member_info(self._memory.handle)[0]
        self.dofs, self.modes, _, self.links = (int(n) for n in counts[:4])

    def committed(self) -> tuple[int, bool, float]:
        """Return the committed state."""
        counts, u = _hosts.member_info(self._memory.handle)
        return int(counts[4]), bool(counts[5]), float(u)

    def respond(self, sides: npt.NDArray[np.int32], motion: Array) -> Array:
        """Compute the responses to trial motions; the last one sets the trial state."""
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
        """Change the state."""
        call(_hosts.member_change, self._memory.handle, change)

    def place(self, side: int) -> None:
        """Set the side of a wall that is committed at u = 0."""
        call(_hosts.member_place, self._memory.handle, side)

    def save(self) -> Saved:
        """Save the committed and the trial state."""
        return Saved(Memory(_hosts.member_save(self._memory.handle)), 1)

    def restore(self, saved: Saved) -> None:
        """Restore a saved state."""
        _hosts.member_restore(self._memory.handle, saved.memory.handle)

    def links_of(self, motion: Array) -> Array:
        """Return the motion of the wall at its links."""
        found = np.empty((3 + self.dofs, self.links))
        call(_hosts.member_links, self._memory.handle, motion, found.T)
        return found

    def next_event(self, numbers: Array, has_branches: bool) -> tuple[int, float, int]:
        """Find the first event of a step."""
        asked = (numbers, int(has_branches))
        ((kind, tau, side),) = call(_hosts.member_next_event, self._memory.handle, *asked)
        return int(kind), float(tau), int(side)

    def land(self, displacements: Array, velocities: Array, mass: Array) -> None:
        """Apply an impact: change the velocities and the side."""
        call(_hosts.member_land, self._memory.handle, displacements, velocities, mass)

    def settles(self, numbers: Array, mass: Array) -> bool:
        """Tell whether the wall may be put to rest after an impact."""
        return bool(*call(_hosts.member_rests, self._memory.handle, numbers, mass))


@functools.cache
def event_names() -> tuple[str, ...]:
    """List the names of the kinds of events 1, 2, ..."""
    return tuple(fetch_text(_kernel.event_names).splitlines())
