"""Walls that step with the time loop of a host in Python; guards of objects in the kernel."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Sequence
from typing import Generic, NamedTuple, NoReturn, TypeGuard, TypeVar

import numpy as np
import numpy.typing as npt

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked, texts_of
from rwmf.errors import InputError, warn
from rwmf.kernel import numbers
from rwmf.kernel.marshalling import Closing
from rwmf.kernel.stepping import KernelWalls, Saved, event_names

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


class Closable(NotPickled, Closing, Generic[_K]):
    """Base of objects that lend one of the kernel until they are closed; a context manager."""

    _guard: Guard[_K]

    def close(self) -> None:
        """Free the memory. Every later call but `close` is an error."""
        self._guard.close()


_Real = TypeVar("_Real", float, numbers.Array)
_Count = TypeVar("_Count", int, numbers.Wholes)
_Flag = TypeVar("_Flag", bool, numbers.Truths)


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
        Wholes since the beginning; steps of the integrator.
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

    wall: numbers.Wholes
    kind: npt.NDArray[np.str_]
    t: numbers.Array
    theta: numbers.Array
    theta_dot: numbers.Array


# first part of the way to the horizon that is searched for an event
_FIRST_PART = 1 / 64
# growth of the pieces that approach an event
_WIDENING = 4.0
_MOST_WALLS = 10**7


class WallSnapshot(NotPickled):
    """Saved state of a wall or of many walls, from `save`.

    Parameters
    ----------
    saved : Saved
        State in the kernel.
    """

    def __init__(self, saved: Saved) -> None:
        self.saved = saved


class _Stepping(Closable[KernelWalls]):
    """Calls common to one wall and many."""

    def __init__(
        self, cases: Sequence[Case], n: int, t_begin: float, peak: float | None, threads: int
    ) -> None:
        self._threads = threads
        source = cases[0].kernel_source() if len(cases) == 1 else ""
        kernel = KernelWalls([case.kernel for case in cases], n, t_begin, peak or 0.0, source)
        self._guard = Guard(kernel, type(self).__name__)
        self._no_motion = np.empty((1, 0), order="F")
        warn(dict.fromkeys(line for case in cases for line in case.kernel.motion_warnings()))

    @property
    def t(self) -> float:
        """Time reached [s]; an overturned wall goes on in time, its state does not."""
        with self._guard as kernel:
            return float(kernel.states()[0][0, 0])

    def advance(self, t: float) -> None:
        """Advance to a later time under the motion of the case, none without `&motion`.

        A failed call changes nothing.

        Parameters
        ----------
        t : float
            Time to advance to [s].

        Raises
        ------
        InputError
            When the time is before the present one, or the object is closed.
        NumericalError
            When the integration fails.
        """
        target = t if type(t) is float else numbers.to_number("t", t)
        with self._guard as kernel:
            kernel.advance(np.array([target]), self._no_motion, self._threads)

    def advance_samples(self, t: object, a: object) -> None:
        """Advance to the last of n >= 2 samples of the ground acceleration.

        Between the samples the acceleration is linear. A first value other than the last one of the
        call before is a jump. A failed call changes nothing.

        Parameters
        ----------
        t : array_like, shape (n,)
            Times [s], strictly increasing from the present one.
        a : array_like, shape (n,); of `Walls` also (walls, n)
            Ground accelerations [m/s2].

        Raises
        ------
        InputError
            When times or accelerations are not acceptable, or the object is closed.
        NumericalError
            When the integration fails.
        """
        times = t if _is_plain(t) else numbers.to_array("t", t)
        with self._guard as kernel:
            values = _columns(a, kernel.n, times.size)
            kernel.advance(times, values, self._threads)

    def save(self) -> WallSnapshot:
        """Save the present state.

        With ``adams`` and ``bdf`` this restarts the integrator; with the others it has no effect on
        the results.

        Returns
        -------
        WallSnapshot
            Argument of `restore`, any number of times.
        """
        with self._guard as kernel:
            return WallSnapshot(kernel.save())

    def restore(self, snapshot: WallSnapshot) -> None:
        """Restore a saved state; a repeated step has the bits of the first one.

        Parameters
        ----------
        snapshot : WallSnapshot
            From `save` of this object, or of one made from the same cases.

        Raises
        ------
        InputError
            When it is no snapshot, or that of another wall.
        """
        if not isinstance(snapshot, WallSnapshot):
            raise InputError(f"snapshot = {numbers.show(snapshot)}: must be the result of save()")
        with self._guard as kernel:
            if snapshot.saved.n != kernel.n:
                raise InputError(
                    f"snapshot: has {snapshot.saved.n} walls: must have {kernel.n}, "
                    "as the object that restores it"
                )
            kernel.restore(snapshot.saved)


class Wall(_Stepping):
    """A wall with its frame that steps with the time loop of a host.

    A context manager: the ``with`` block frees the wall. The interpreter lock is released during
    the integration; a call from a second thread waits. Ctrl-C acts at the end of a call. Units are
    SI, angles in rad.

    Parameters
    ----------
    case : Case or path
        The case; `&output`, `&spectrum` and `t_end` have no effect.
    t_begin : float
        Time of the initial state [s].
    peak : float, optional
        Expected peak ground acceleration [m/s2], which sets the absolute tolerance unless `&solver
        atol` does. The default is the peak of the case's motion, or g/10 without one.

    Raises
    ------
    InputError
        When the case does not allow stepping, or a number is not acceptable.
    """

    @checked
    def __init__(self, case: CaseLike, t_begin: float = 0.0, peak: float | None = None) -> None:
        super().__init__([case_of(case)], 1, t_begin, peak, 1)

    def __repr__(self) -> str:
        """Show the time."""
        return f"<Wall at t = {self.t:g} s>" if self._guard.is_open else "<Wall, closed>"

    @property
    def state(self) -> WallState[float, int, bool]:
        """Present state: t, theta, u_s with their rates [s, rad, m], counts and flags."""
        with self._guard as kernel:
            reals, counts = kernel.states()
        flags = map(bool, counts[3:, 0].tolist())
        return WallState(*reals[1:8, 0].tolist(), *counts[:3, 0].tolist(), *flags)

    @property
    def maxima(self) -> WallMaxima[float]:
        """Largest ``|u_s|`` [m], ``|theta|`` [rad] and ``|theta_dot|`` [rad/s] so far."""
        with self._guard as kernel:
            return WallMaxima(*kernel.states()[0][8:, 0].tolist())

    @property
    def forces(self) -> WallForces[float]:
        """Present forces [N], in N/kg without a mass in the case."""
        with self._guard as kernel:
            return WallForces(*kernel.forces()[:, 0].tolist())

    @property
    def events(self) -> list[WallEvent]:
        """Events of the last advance in order of time."""
        with self._guard as kernel:
            _, kinds, reals = kernel.events()
        names = event_names()
        return [
            WallEvent(names[kind - 1], *values)
            for kind, values in zip(kinds.tolist(), reals.T.tolist(), strict=True)
        ]

    @checked
    def advance_ground(self, t: float, function: Callable[[float], float]) -> None:
        """Advance under an acceleration that a function computes.

        Parameters
        ----------
        t : float
            Time to advance to [s].
        function : callable
            Ground acceleration [m/s2] at a time [s], smooth between the present time and `t`. It
            must depend on its argument only. An exception that it raises ends the call, which then
            has changed nothing.

        Raises
        ------
        InputError
            When the time is before the present one, or the wall is closed.
        NumericalError
            When the integration fails.
        """
        target = numbers.to_number("t", t)
        with self._guard as kernel:
            kernel.advance_ground(target, function)

    @checked
    def next_event(
        self,
        horizon: float,
        kinds: Sequence[str] = ("impact", "lift_off", "rest", "overturned", "collapsed"),
    ) -> WallEvent | None:
        """Advance to the next event under the motion of the case, at most to a horizon.

        The wall then is just after the event. Like every stop between knots, this changes the
        results within the tolerance.

        Parameters
        ----------
        horizon : float
            Latest time [s].
        kinds : sequence of str
            Kinds of events that end the advance, as in `WallEvent`.

        Returns
        -------
        WallEvent or None
            The event; None if the horizon comes first.

        Raises
        ------
        InputError
            When the horizon is before the present time, a kind is unknown, or the wall is closed.
        NumericalError
            When the integration fails.
        """
        wanted, end = _kinds(kinds), horizon
        before = self.save()
        begin = self.t
        way = (end - begin) * _FIRST_PART
        while True:
            target = min(begin + way, end)
            self.advance(target)
            found = next((event for event in self.events if event.kind in wanted), None)
            if found is not None:
                return self._stop_at(found, before, end)
            if target >= end:
                return None
            self.restore(before)
            way *= 2

    def _stop_at(self, event: WallEvent, before: WallSnapshot, end: float) -> WallEvent:
        """Repeat the way up to an event; other steps may place it a little later."""
        self.restore(before)
        self.advance(event.t)
        width = float(np.spacing(event.t))
        while True:
            found = next((here for here in self.events if here.kind == event.kind), None)
            t = self.t
            if found is not None or t >= end:
                return found or event
            self.advance(min(t + width, end))
            width *= _WIDENING


class Walls(_Stepping):
    """Walls that advance together, in threads of the kernel.

    All calls have the meaning of those of `Wall`. Each wall has the bits of a single `Wall`,
    whatever the number of threads. After a failed call no wall has changed; the message begins
    with the number of the wall, from 1. Ctrl-C stops a call.

    Parameters
    ----------
    cases : Case, path, or sequence of them
        The case of all walls, or the case of each.
    n : int, optional
        Number of walls; that of `cases` by default.
    t_begin : float
        Time of the initial states [s].
    peak : float, optional
        As for `Wall` [m/s2].
    threads : int
        Threads of the kernel, 0 for all.

    Raises
    ------
    InputError
        When a case does not allow stepping, or an argument is not acceptable.
    """

    @checked
    def __init__(
        self,
        cases: CaseLike | Sequence[CaseLike],
        n: int | None = None,
        t_begin: float = 0.0,
        peak: float | None = None,
        threads: int = 0,
    ) -> None:
        is_one = isinstance(cases, Case | str | os.PathLike)
        items = numbers.to_items([cases] if is_one else cases)
        if items is None:
            raise InputError(
                f"cases = {numbers.show(cases)}: must be a Case, a path, or a list of them"
            )
        each = [case_of(case) for case in items]
        if not each:
            raise InputError("cases: must be one case or more")
        number = len(each) if n is None else numbers.to_whole("n", n, 1, _MOST_WALLS)
        if len(each) not in (1, number):
            raise InputError(f"n = {number}: must be {len(each)}, the number of cases")
        super().__init__(each, number, t_begin, peak, threads)
        self._n = number

    def __len__(self) -> int:
        """Return the number of walls."""
        return self._n

    def __repr__(self) -> str:
        """Show the number of walls."""
        return f"<{self._n} Walls{'' if self._guard.is_open else ', closed'}>"

    @property
    def state(self) -> WallState[numbers.Array, numbers.Wholes, numbers.Truths]:
        """Present states as arrays of shape (walls,), which the kernel has written."""
        with self._guard as kernel:
            reals, counts = kernel.states()
        return WallState(*reals[1:8], *counts[:3], *(flag != 0 for flag in counts[3:]))

    @property
    def maxima(self) -> WallMaxima[numbers.Array]:
        """Largest ``|u_s|`` [m], ``|theta|`` [rad] and ``|theta_dot|`` [rad/s] of each wall."""
        with self._guard as kernel:
            return WallMaxima(*kernel.states()[0][8:])

    @property
    def forces(self) -> WallForces[numbers.Array]:
        """Present forces of each wall [N], in N/kg without a mass in its case."""
        with self._guard as kernel:
            return WallForces(*kernel.forces())

    @property
    def events(self) -> WallEvents:
        """Events of the last advance, wall after wall."""
        with self._guard as kernel:
            counts, kinds, reals = kernel.events()
        wall = np.repeat(np.arange(counts.size), counts)
        return WallEvents(wall, np.array(event_names())[kinds - 1], *reals)


def _is_plain(value: object, ndim: int = 1) -> TypeGuard[numbers.Array]:
    """Check for an array that the kernel reads as it is."""
    return (
        type(value) is np.ndarray
        and value.dtype == np.float64
        and value.ndim == ndim
        and value.flags.c_contiguous
    )


def _columns(a: object, walls: int, times: int) -> numbers.Array:
    """Return accelerations as (times, walls) or (times, 1) in Fortran order."""
    rows = a if _is_plain(a, 1) or _is_plain(a, 2) else numbers.to_shaped("a", a)
    if rows.shape not in ((times,), (walls, times)):
        allowed = f"({times},)" if walls == 1 else f"({times},) or ({walls}, {times})"
        raise InputError(f"a: has the shape {rows.shape}: must have {allowed}, as many as t")
    return rows.reshape(-1, times).T


def _kinds(kinds: Sequence[str]) -> set[str]:
    """Check kinds of events."""
    known = event_names()
    wanted = set(texts_of("kinds", kinds))
    for kind in wanted or {""}:
        if kind not in known:
            raise InputError(f"kinds = {numbers.show(kind)}: must be of {', '.join(known)}")
    return wanted
