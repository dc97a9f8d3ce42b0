"""The wall as an element of a host in Python that owns the frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Generic, NamedTuple, TypeVar, overload

import numpy as np

from rwmf.case.arguments import checked
from rwmf.case.case import CaseLike, kernel_for_host
from rwmf.errors import InputError, warn
from rwmf.hosts.wall import Closable, Guard, NotPickled
from rwmf.kernel.numbers import Array, is_whole, show, to_number, to_shaped
from rwmf.kernel.stepping import KernelMember, Saved, event_names

_Real = TypeVar("_Real", float, Array)
_NO_MASS = np.empty((0, 0), order="F")


class ElementSnapshot(NotPickled):
    """Saved state of an element, from `save`.

    Parameters
    ----------
    owner : Element
        The element.
    saved : Saved
        State in the kernel.
    """

    def __init__(self, owner: Element, saved: Saved) -> None:
        self.owner = owner
        self.saved = saved


class ElementEvent(NamedTuple):
    """First event of a step.

    Attributes
    ----------
    kind : str
        ``impact``, ``lift_off``; of springs ``branch`` and ``peak``.
    tau : float
        Time since the beginning of the step [s].
    side : int
        Side of a lift-off, otherwise that of the wall.
    """

    kind: str
    tau: float
    side: int


class ElementResponse(NamedTuple, Generic[_Real]):
    """Response of an element; forces in N if the case has `m_w`, otherwise per kg of the wall.

    For several motions each value has one more dimension in front.

    Attributes
    ----------
    force : float or numpy.ndarray, shape (dofs,)
        Resisting forces [N].
    stiffness, damping, mass : float or numpy.ndarray, shape (dofs, dofs)
        Derivatives of the forces by displacements [N/m], velocities [N s/m], accelerations [kg].
    theta, theta_dot, theta_ddot : float
        Rotation [rad] and its rates [rad/s, rad/s2].
    cable : float
        Tension of the tendon [N].
    hold : numpy.ndarray, shape (2,)
        Smallest and largest force of the host on u at which a wall at rest stays there [N]; NaN
        while it rocks.
    fuses : numpy.ndarray, shape (2,)
        Tension of the left and of the right fuse [N].
    """

    force: _Real
    stiffness: _Real
    damping: _Real
    mass: _Real
    theta: _Real
    theta_dot: _Real
    theta_ddot: _Real
    cable: _Real
    hold: Array
    fuses: Array


class Element(Closable[KernelMember]):
    """A wall without frame: resisting forces and tangents at a motion of the host.

    The host owns masses, springs and dampers of the frame. The element has the state of its springs
    and the side on which the wall rocks. A response is a trial from the committed state; `commit`
    keeps the last one, `revert` drops it. A context manager. Units are SI, angles in rad.

    Its degrees of freedom are the displacement u of the straight wall at the link, and one for
    each mode of `&bending`. Link springs (`&storeys coupling = 'springs'`) add one for each floor.

    Parameters
    ----------
    case : Case, path, or mapping of str to mapping
        The case, or its groups. Frame and motion have no effect, but for links and masses of the
        impact rule ``coupled``. In a file or in groups ``T_s`` and ``xi_s`` of `&frame` and
        ``t_end`` of `&solver` may be absent.

    Attributes
    ----------
    dofs : int
        Number of degrees of freedom.
    modes : int
        Number of modes of `&bending`.
    links : int
        Number of links between wall and host: 1, or one for each floor.

    Raises
    ------
    InputError
        When an effect of the case does not allow an element.
    """

    @checked
    def __init__(self, case: CaseLike | Mapping[str, Mapping[str, object]]) -> None:
        given, source = kernel_for_host(case)
        kernel = KernelMember(given, source)
        self._guard = Guard(kernel, "Element")
        self.dofs, self.links, self.modes = kernel.dofs, kernel.links, kernel.modes
        warn(given.motion_warnings())

    @property
    def side(self) -> int:
        """Committed side: 1 or -1 while the wall rocks, 0 at rest; 1 for a hinged wall."""
        with self._guard as kernel:
            return kernel.committed()[0]

    @property
    def is_broken(self) -> bool:
        """True if the tendon has broken, in the committed state."""
        with self._guard as kernel:
            return kernel.committed()[1]

    @overload
    def respond(
        self,
        u: float,
        u_dot: float,
        u_ddot: float,
        u_g_ddot: float,
        side: int | None = None,
        v_g_ddot: float = 0.0,
    ) -> ElementResponse[float]: ...

    @overload
    def respond(
        self,
        u: Array | Sequence[object],
        u_dot: object,
        u_ddot: object,
        u_g_ddot: object,
        side: object = None,
        v_g_ddot: object = 0.0,
    ) -> ElementResponse[Array]: ...

    def respond(
        self,
        u: object,
        u_dot: object,
        u_ddot: object,
        u_g_ddot: object,
        side: object = None,
        v_g_ddot: object = 0.0,
    ) -> ElementResponse[float] | ElementResponse[Array]:
        """Compute forces and tangents at a trial motion, or at each of many.

        At rest u counts as 0, and its force and tangents are 0. With many motions each is a trial
        from the committed state; `commit` keeps the last one.

        Parameters
        ----------
        u, u_dot, u_ddot : float or array_like, shape (dofs,); of many motions (..., dofs)
            Displacements relative to the ground [m] and their rates [m/s, m/s2]. With one degree of
            freedom the last dimension is left out.
        u_g_ddot : float or array_like
            Ground acceleration of each motion [m/s2].
        side : int or array_like, optional
            1 or -1: respond as a wall on this side whose springs have not moved, and leave the
            state alone.
        v_g_ddot : float or array_like, optional
            Vertical ground acceleration [m/s2], for a case with a vertical record.

        Returns
        -------
        ElementResponse
            Numbers for one motion of one degree of freedom, otherwise arrays.

        Raises
        ------
        InputError
            When an argument is no finite number, or the wall cannot follow the motion.
        """
        n = self.dofs
        given = [
            to_shaped(name, value)
            for name, value in (("u", u), ("u_dot", u_dot), ("u_ddot", u_ddot))
        ]
        if n == 1:
            given = [values[..., np.newaxis] for values in given]
        for name, values in zip(("u", "u_dot", "u_ddot"), given, strict=True):
            if values.ndim == 0 or values.shape[-1] != n:
                raise InputError(
                    f"{name}: has the shape {values.shape}: must end with {n}, the dofs"
                )
        grounds = [to_shaped("u_g_ddot", u_g_ddot), to_shaped("v_g_ddot", v_g_ddot)]
        sides = np.zeros(()) if side is None else _side(side)
        shapes = [
            *(values.shape[:-1] for values in given),
            *(values.shape for values in grounds),
            sides.shape,
        ]
        try:
            shape = np.broadcast_shapes(*shapes)
        except ValueError:
            shape = (0,)
        if 0 in shape:
            text = ", ".join(map(str, shapes))
            raise InputError(f"u to side: have the shapes {text}: must be one motion or as many")
        table = np.concatenate(
            [np.broadcast_to(values, (*shape, n)).reshape(-1, n) for values in given]
            + [np.broadcast_to(values, shape).reshape(-1, 1) for values in grounds],
            axis=1,
        )
        flat = np.broadcast_to(sides, shape).ravel().astype(np.int32)
        with self._guard as kernel:
            found = kernel.respond(flat, table).reshape(*shape, -1)
        return _response(found, n)

    def commit(self) -> None:
        """Keep the state of the last trial response."""
        with self._guard as kernel:
            kernel.change(1)

    def revert(self) -> None:
        """Return to the committed state."""
        with self._guard as kernel:
            kernel.change(2)

    def restart(self) -> None:
        """Return to the state after creation: at rest, with springs that have not moved."""
        with self._guard as kernel:
            kernel.change(3)

    def save(self) -> ElementSnapshot:
        """Save the committed and the trial state.

        Returns
        -------
        ElementSnapshot
            Argument of `restore`, any number of times.
        """
        with self._guard as kernel:
            return ElementSnapshot(self, kernel.save())

    def restore(self, snapshot: ElementSnapshot) -> None:
        """Restore a saved state.

        Parameters
        ----------
        snapshot : ElementSnapshot
            From `save` of this element.

        Raises
        ------
        InputError
            When it is no snapshot of this element.
        """
        if not isinstance(snapshot, ElementSnapshot) or snapshot.owner is not self:
            raise InputError(f"snapshot = {show(snapshot)}: must be from save() of this element")
        with self._guard as kernel:
            kernel.restore(snapshot.saved)

    def place(self, side: int) -> None:
        """Set the side of a wall that is committed at u = 0: after a lift-off, or for rest.

        Parameters
        ----------
        side : int
            1 or -1; 0 for rest.

        Raises
        ------
        InputError
            When the wall is not on its base, or is hinged.
        """
        if not is_whole(side) or side not in (-1, 0, 1):
            raise InputError(f"side = {show(side)}: must be 1, -1, or 0 for rest")
        with self._guard as kernel:
            kernel.place(int(side))

    def motion_of_links(self, u: object, u_dot: object, u_ddot: object) -> Array:
        """Return the motion of the wall at its links.

        Parameters
        ----------
        u, u_dot, u_ddot : float or array_like, shape (dofs,)
            Displacements [m] and their rates [m/s, m/s2].

        Returns
        -------
        numpy.ndarray, shape (3 + dofs, links)
            Displacement [m], velocity [m/s] and acceleration [m/s2] of each link; then the
            derivatives of the displacement by each degree of freedom [-].

        Raises
        ------
        InputError
            When an argument is not acceptable.
        """
        motion = self._vector("u", u), self._vector("u_dot", u_dot), self._vector("u_ddot", u_ddot)
        with self._guard as kernel:
            return kernel.links_of(np.concatenate(motion))

    @checked
    def next_event(
        self,
        dt: float,
        begin: object,
        end: object,
        u_g_ddot: tuple[float, float],
        push: tuple[float, float] = (0.0, 0.0),
        has_branches: bool = False,
    ) -> ElementEvent | None:
        """Find the first event of a step from the committed state.

        Parameters
        ----------
        dt : float
            Length of the step [s].
        begin, end : array_like, shape (3,) or (3, dofs)
            Displacement [m], velocity [m/s], acceleration [m/s2] at both ends; the displacement
            between is a cubic.
        u_g_ddot : tuple of float
            Ground acceleration at both ends [m/s2].
        push : tuple of float
            Force of the host on u at both ends [N], for a wall at rest; linear between.
        has_branches : bool
            Whether ends of branches of springs are events, too. Steps that end there keep the order
            of the host's method.

        Returns
        -------
        ElementEvent or None
            The event, None without one.

        Raises
        ------
        InputError
            When an argument is not acceptable.
        """
        grounds = np.zeros(4)
        grounds[::2] = to_shaped("u_g_ddot", u_g_ddot, (2,))
        numbers = np.concatenate(
            [
                [dt],
                to_shaped("push", push, (2,)),
                grounds,
                self._motion("begin", begin),
                self._motion("end", end),
            ]
        )
        with self._guard as kernel:
            kind, tau, side = kernel.next_event(numbers, has_branches)
        return ElementEvent(event_names()[kind - 1], tau, side) if kind else None

    def land(self, u: object, u_dot: object, host_mass: object = None) -> Array:
        """Apply the impact of a wall that is committed at u = 0, and change its side.

        Parameters
        ----------
        u, u_dot : float or array_like, shape (dofs,)
            Displacements [m] and velocities before the impact [m/s].
        host_mass : float or array_like, shape (dofs, dofs), optional
            Masses of the host [kg], over which the rule ``coupled`` balances momentum; by default
            those of the case.

        Returns
        -------
        numpy.ndarray, shape (dofs,)
            Velocities after the impact [m/s].

        Raises
        ------
        InputError
            When the wall is at rest, away from its base, or moves away from it.
        """
        velocities = self._vector("u_dot", u_dot).copy()
        mass = self._mass(host_mass)
        with self._guard as kernel:
            kernel.land(self._vector("u", u), velocities, mass)
        return velocities

    @checked
    def settles(
        self,
        dt: float,
        motion: object,
        u_g_ddot: float,
        push: float,
        host_mass: object = None,
    ) -> bool:
        """Tell whether the host may put the wall to rest after an impact.

        Parameters
        ----------
        dt : float
            Step of the host [s].
        motion : array_like, shape (3,) or (3, dofs)
            Displacement [m], velocity [m/s], acceleration [m/s2] after the impact.
        u_g_ddot : float
            Ground acceleration [m/s2].
        push : float
            Force of the host on u of the wall at rest [N].
        host_mass : float or array_like, shape (dofs, dofs), optional
            As in `land` [kg].

        Returns
        -------
        bool
            True when all following flights together are shorter than a step.

        Raises
        ------
        InputError
            When an argument is not acceptable.
        """
        head = [dt, to_number("push", push), to_number("u_g_ddot", u_g_ddot), 0.0]
        numbers = np.concatenate([head, self._motion("motion", motion)])
        mass = self._mass(host_mass)
        with self._guard as kernel:
            return kernel.settles(numbers, mass)

    def _vector(self, name: str, value: object) -> Array:
        n = self.dofs
        return to_shaped(name, value, *([(), (1,)] if n == 1 else [(n,)])).reshape(n)

    def _motion(self, name: str, value: object) -> Array:
        """Return displacements, velocities and accelerations, one after the other."""
        n = self.dofs
        return to_shaped(name, value, (3, n), *([(3,)] if n == 1 else [])).ravel()

    def _mass(self, value: object) -> Array:
        """Return masses of the host as a matrix; empty for those of the case."""
        if value is None:
            return _NO_MASS
        n = self.dofs
        array = to_shaped("host_mass", value, (n, n), *([(), (1,)] if n == 1 else []))
        return np.asfortranarray(array.reshape(n, n))


def _response(found: Array, n: int) -> ElementResponse[float] | ElementResponse[Array]:
    """Split the values of responses."""
    shape = found.shape[:-1]
    forces, tangents, rest = np.split(found, [n, n + 3 * n * n], axis=-1)
    matrices = tangents.reshape(*shape, 3, n, n)
    hold, fuses = rest[..., :2], rest[..., 6:]
    stiffness, damping, mass = (matrices[..., k, :, :] for k in range(3))
    if n == 1:
        forces = forces[..., 0]
        stiffness, damping, mass = (values[..., 0, 0] for values in (stiffness, damping, mass))
    numbers = [forces, stiffness, damping, mass, *(rest[..., k] for k in range(2, 6))]
    values: list[Any] = list(map(float, numbers)) if n == 1 and not shape else numbers
    return ElementResponse(*[*values, hold, fuses])


def _side(value: object) -> Array:
    """Return sides."""
    sides = to_shaped("side", value)
    if not np.all(np.abs(sides) == 1):
        raise InputError(f"side = {show(value)}: must be 1 or -1")
    return sides
