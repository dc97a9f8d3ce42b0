"""The wall as an element of a host in Python that owns the frame."""

from __future__ import annotations

from types import TracebackType
from typing import Generic, NamedTuple, Self, TypeVar, overload

import numpy as np

from rwmf._arguments import case_of
from rwmf._hosts.guard import Guard, NotPickled
from rwmf._hosts.states import Reals
from rwmf._library.hosts import KernelElement, next_impact
from rwmf._numbers import is_whole, show, to_array, to_number
from rwmf.case import CaseLike
from rwmf.errors import InputError

__all__ = ["Element", "ElementResponse"]

_Real = TypeVar("_Real", float, Reals)


class ElementResponse(NamedTuple, Generic[_Real]):
    """Response of an element, or arrays with the shape of the motion.

    Forces are in N if the case has `m_w`, otherwise per kg of the wall.

    Attributes
    ----------
    force : float
        Resisting force on the link [N].
    stiffness, damping, mass : float
        Its derivatives by u [N/m], u_dot [N s/m] and u_ddot [kg].
    theta, theta_dot, theta_ddot : float
        Rotation [rad] and its rates [rad/s, rad/s2].
    cable : float
        Tension of the tendon [N].
    """

    force: _Real
    stiffness: _Real
    damping: _Real
    mass: _Real
    theta: _Real
    theta_dot: _Real
    theta_ddot: _Real
    cable: _Real


class Element(NotPickled):
    """A wall without frame: the resisting force on the host's displacement at the link.

    The host owns masses, springs and dampers, and finds impact, rest and lift-off with the methods
    below (docs/howto/stepping-python.md). Trial responses never change the committed side. Units
    are SI, angles in rad.

    Parameters
    ----------
    case : Case or path
        The case; of `&frame` only the mass ratio is used, for the impact rule ``coupled``.

    Raises
    ------
    InputError
        When an effect of the case does not allow an element.
    """

    def __init__(self, case: CaseLike) -> None:
        given = case_of(case)
        self._guard = Guard(KernelElement(given.kernel, given.kernel_source()), "Element")
        self._committed = 0
        self._trial = 0

    def __enter__(self) -> Self:
        """Return the element, to be closed at the end of the block."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Free the memory. Every later call but `close` is an error."""
        self._guard.close()

    @property
    def side(self) -> int:
        """Committed side: 1 or -1 while the wall rocks; 0 at rest and at the beginning."""
        return self._committed

    @overload
    def respond(
        self, u: float, u_dot: float, u_ddot: float, u_g_ddot: float, side: int | None = None
    ) -> ElementResponse[float]: ...

    @overload
    def respond(
        self, u: Reals, u_dot: object, u_ddot: object, u_g_ddot: object, side: object = None
    ) -> ElementResponse[Reals]: ...

    def respond(
        self, u: object, u_dot: object, u_ddot: object, u_g_ddot: object, side: object = None
    ) -> ElementResponse[float] | ElementResponse[Reals]:
        """Compute force and tangents at a trial motion of the link, or at many.

        Parameters
        ----------
        u, u_dot, u_ddot : float or array_like
            Displacement of the link relative to the ground [m] and its rates [m/s, m/s2].
        u_g_ddot : float or array_like
            Ground acceleration [m/s2].
        side : int or array_like, optional
            1 or -1, the side on which the wall rocks. By default the committed side, or at rest the
            sign of `u`.

        Returns
        -------
        ElementResponse
            Numbers, or arrays of the common shape of the arguments.

        Raises
        ------
        InputError
            When an argument is no finite number, the wall cannot follow the displacement, or no
            side is known.
        """
        motion = np.broadcast_arrays(
            _numbers("u", u), _numbers("u_dot", u_dot), _numbers("u_ddot", u_ddot),
            _numbers("u_g_ddot", u_g_ddot),
        )  # fmt: skip
        table = np.array([values.ravel() for values in motion])
        shape = motion[0].shape
        sides = self._sides(side, motion[0])
        with self._guard as kernel:
            found = kernel.respond(sides, table)
            if not shape:
                self._trial = int(sides[0])
        if shape:
            return ElementResponse(*found.reshape(len(found), *shape))
        return ElementResponse(*found[:, 0].tolist())

    def _sides(self, side: object, u: Reals) -> np.ndarray[tuple[int], np.dtype[np.int32]]:
        """Return the side of each motion."""
        if side is None:
            given = np.sign(u) if self._committed == 0 else np.full(u.shape, self._committed)
        elif is_whole(side):
            given = np.full(u.shape, np.clip(side, -2, 2))
        else:
            given = np.broadcast_to(np.clip(_numbers("side", side), -2, 2), u.shape)
        return given.ravel().astype(np.int32)

    def commit(self, side: int | None = None) -> None:
        """Keep the trial state: the side of the last response to one motion.

        Parameters
        ----------
        side : int, optional
            Side to keep instead: after an impact the other one, 0 when the wall comes to rest.

        Raises
        ------
        InputError
            When the side is not 1, -1 or 0.
        """
        if side is not None and side not in (-1, 0, 1):
            raise InputError(f"side = {show(side)}: must be 1, -1, or 0 at rest")
        self._committed = self._trial = self._trial if side is None else int(side)

    def revert(self) -> None:
        """Drop the trial state."""
        self._trial = self._committed

    @property
    def velocity_factor(self) -> float:
        """Factor on the velocity of the link at an impact [-]."""
        with self._guard as kernel:
            return kernel.velocity_factor()

    def next_impact(
        self, dt: float, u_0: float, u_dot_0: float, u_1: float, u_dot_1: float
    ) -> float | None:
        """Find the first return of the rocking wall to its base within a step.

        Parameters
        ----------
        dt : float
            Length of the step [s].
        u_0, u_dot_0, u_1, u_dot_1 : float
            Displacement [m] and velocity [m/s] of the link at the beginning and at the end.

        Returns
        -------
        float or None
            Time since the beginning [s], None without an impact.

        Raises
        ------
        InputError
            When the wall rests, or a number is not acceptable.
        """
        return next_impact(self._committed, dt, u_0, u_dot_0, u_1, u_dot_1)

    def next_lift_off(
        self, dt: float, push_0: float, push_1: float, u_g_ddot_0: float, u_g_ddot_1: float
    ) -> tuple[int, float]:
        """Find the first lift-off of the resting wall within a step.

        Parameters
        ----------
        dt : float
            Length of the step [s].
        push_0, push_1 : float
            Force of the host on the wall at the beginning and at the end [N], linear between.
        u_g_ddot_0, u_g_ddot_1 : float
            Ground acceleration at the beginning and at the end [m/s2].

        Returns
        -------
        int
            Side, 0 without a lift-off.
        float
            Time since the beginning [s].

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        with self._guard as kernel:
            return kernel.next_lift_off(dt, push_0, push_1, u_g_ddot_0, u_g_ddot_1)

    def settles(
        self, dt: float, u_dot: float, push: float, u_g_ddot: float, host_mass: float
    ) -> bool:
        """Tell whether the host may put the wall to rest after an impact.

        Parameters
        ----------
        dt : float
            Step of the host [s].
        u_dot : float
            Velocity of the link after the impact [m/s].
        push : float
            Force of the host on the wall at rest [N].
        u_g_ddot : float
            Ground acceleration [m/s2].
        host_mass : float
            Mass of the host at the link [kg].

        Returns
        -------
        bool
            True when all following flights together are shorter than a step.

        Raises
        ------
        InputError
            When a number is not acceptable.
        """
        with self._guard as kernel:
            return kernel.settles(dt, u_dot, push, u_g_ddot, host_mass)


def _numbers(name: str, value: object) -> Reals:
    """Return finite numbers of any shape."""
    if type(value) is float or not np.ndim(value):  # type: ignore[arg-type]
        return np.array(to_number(name, value))
    array = np.asarray(value)
    return to_array(name, array.ravel()).reshape(array.shape)
