"""The wall of a coupling, in coordinates in which its links move linearly."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rwmf._hosts.element import Element, ElementEvent
from rwmf._numbers import show, to_array, to_items
from rwmf.case import Case
from rwmf.coupling.host import Reals, Wholes
from rwmf.errors import InputError

# groups of the frame, which the host owns
_FRAME = ("frame", "storeys", "yielding", "p_delta")


class WallResponse(NamedTuple):
    """Resisting forces of the wall and their derivatives.

    Attributes
    ----------
    force : numpy.ndarray, shape (n,)
        Forces [N].
    stiffness, damping, mass : numpy.ndarray, shape (n, n)
        Derivatives [N/m], [N s/m], [kg].
    theta, theta_dot : float
        Rotation [rad] and its rate [rad/s].
    """

    force: Reals
    stiffness: Reals
    damping: Reals
    mass: Reals
    theta: float
    theta_dot: float


class Split(NamedTuple):
    """Coordinates of the wall by their owner: y = own z + follow u_links.

    Attributes
    ----------
    integrated : numpy.ndarray of int, shape (own,)
        Coordinates that the wall integrates.
    own : numpy.ndarray, shape (n, own)
        Derivatives of the coordinates by those that the wall integrates.
    follow : numpy.ndarray, shape (n, links)
        Derivatives by the displacements of the links of the host.
    tied : numpy.ndarray of int, shape (tied,)
        Links whose displacement is a condition.
    balanced : numpy.ndarray of int, shape (balanced,)
        Coordinates whose balance is a condition.
    """

    integrated: Wholes
    own: Reals
    follow: Reals
    tied: Wholes
    balanced: Wholes


class CoupledWall:
    """An element whose links move by ``links @ y``.

    The coordinates y are u of the straight wall, p = q cos(theta) for each mode q of `&bending`,
    and the floors on link springs. Rigid links of a wall that bends move by a linear combination of
    u and p. So displacements, velocities and accelerations of wall and frame agree in each step.

    Attributes
    ----------
    element : Element
        The element.
    n : int
        Number of coordinates.
    modes : int
        Number of modes.
    links : numpy.ndarray, shape (links, n)
        Displacements of the links of the host by unit coordinates.
    shares : numpy.ndarray, shape (links,)
        Heights of the links over that of the highest one.
    none : WallResponse
        Response of zeros.
    """

    def __init__(self, case: Case, links: int, heights: object) -> None:
        given = _heights(case, heights, links)
        is_on_springs = case.storeys is not None and case.storeys.coupling == "springs"
        if case.bending is not None and links > 1 and not is_on_springs:
            case = _at_heights(case, given)
        self.element = Element(case)
        self.n, self.modes = self.element.dofs, self.element.modes
        self._is_on_springs = is_on_springs
        still = np.zeros(self.n)
        # derivatives of the displacements of the wall at the links
        by_u = self.element.motion_of_links(still, still, still)[3:].T
        if is_on_springs:
            _compare(case, given, links, by_u[:, 0])
            self.shares: Reals = by_u[:, 0]
            self.links: Reals = np.eye(self.n)[1 + self.modes :]
        elif self.n == 1:
            self.shares = given / given[-1]
            self.links = self.shares[:, np.newaxis]
        else:
            self.shares, self.links = by_u[:, 0], by_u
        no = np.zeros((self.n, self.n))
        self.none = WallResponse(no[0], no, no, no, 0.0, 0.0)
        self._splits = [self._split(is_held) for is_held in (False, True)]

    def split(self, is_held: bool) -> Split:
        """Return the coordinates by their owner."""
        return self._splits[is_held]

    def _split(self, is_held: bool) -> Split:
        n, links = self.n, len(self.links)
        first = 1 if is_held else 0
        follow = np.zeros((n, links))
        index, tied = np.arange(1, 1 + self.modes), np.arange(0)
        if self._is_on_springs:
            index = np.arange(first, 1 + self.modes)
            follow[1 + self.modes :] = np.eye(links)
        own = np.eye(n)[:, index]
        if not self._is_on_springs:
            tied = np.arange(links if is_held else links - 1)
            if not is_held:
                # u follows the highest link
                own[0] = -self.links[-1, 1:]
                follow[0, -1] = 1.0
        return Split(index, own, follow, tied, np.arange(first, n))

    def element_motion(self, y: Reals) -> tuple[Reals, Reals]:
        """Return the motion in the coordinates of the element."""
        by_y = np.eye(self.n)
        if not self.modes or self._is_on_springs or not self.element.side:
            return y, by_y
        # the highest link of a wall that is bent by q = 1 m moves by u + cos(theta)
        bent = np.zeros_like(y)
        bent[:, 0], bent[0, 1] = y[:, 0], 1.0
        at_links = self.element.motion_of_links(*bent)[:, -1]
        c, c_dot, c_ddot = at_links[:3] - y[:, 0]
        by_u = at_links[3] - 1.0
        p, p_dot, p_ddot = y[:, 1:]
        x = y.copy()
        x[0, 1:] = q = p / c
        x[1, 1:] = q_dot = (p_dot - q * c_dot) / c
        x[2, 1:] = (p_ddot - 2 * q_dot * c_dot - q * c_ddot) / c
        by_y[1:, 1:] /= c
        by_y[1:, 0] = -q * by_u / c
        return x, by_y

    def respond(self, y: Reals, ground: float) -> WallResponse:
        """Compute a trial response.

        The derivatives leave out the change of the coordinates' own derivatives, which vanishes
        with the square of a step.
        """
        if self.n == 1:
            u, u_dot, u_ddot = y[:, 0].tolist()
            r = self.element.respond(u, u_dot, u_ddot, ground)
            return WallResponse(
                np.array([r.force]), np.array([[r.stiffness]]), np.array([[r.damping]]),
                np.array([[r.mass]]), r.theta, r.theta_dot,
            )  # fmt: skip
        x, by_y = self.element_motion(y)
        found = self.element.respond(x[0], x[1], x[2], ground)
        return WallResponse(
            by_y.T @ found.force,
            by_y.T @ found.stiffness @ by_y,
            by_y.T @ found.damping @ by_y,
            by_y.T @ found.mass @ by_y,
            float(found.theta),
            float(found.theta_dot),
        )

    def next_event(
        self,
        h: float,
        begin: Reals,
        end: Reals,
        grounds: tuple[float, float],
        push: tuple[float, float],
    ) -> ElementEvent | None:
        """Find the first event of a step, as `Element.next_event`."""
        x_0, x = self.element_motion(begin)[0], self.element_motion(end)[0]
        return self.element.next_event(h, x_0, x, grounds, push=push, has_branches=True)

    def deflection(self, y: Reals) -> float:
        """Return the deflection of the top."""
        # the deflections of the modes are 1 at the top
        return float(self.element_motion(y)[0][0, 1 : 1 + self.modes].sum())

    def push(self, forces: Reals) -> float:
        """Return the force on u of forces at the links."""
        return float(self.links[:, 0] @ forces)


def _heights(case: Case, heights: object, links: int) -> Reals:
    """Return the heights of the links, by default those of the case; 1 for a single link."""
    if heights is None and links == 1:
        return np.ones(1)
    if heights is None:
        storeys = [] if case.storeys is None else to_items(case.storeys["height"]) or []
        if len(storeys) != links:
            raise InputError(f"heights: must be given with {links} links")
        heights = np.cumsum(storeys)
    values = to_array("heights", heights, above=0.0)
    if len(values) != links or np.any(np.diff(values) <= 0):
        raise InputError(f"heights = {show(heights)}: must be {links} increasing heights")
    return values


def _at_heights(case: Case, heights: Reals) -> Case:
    """Return a case whose element has its links at heights [m]."""
    storeys = {"n": len(heights), "m": 1.0, "k": 1.0, "coupling": "every_floor"}
    alone = case.without(*(name for name in _FRAME if getattr(case, name) is not None))
    try:
        return alone.replace(
            frame={"xi_s": 0.0}, storeys=storeys | {"height": np.diff(heights, prepend=0).tolist()}
        )
    except InputError as error:
        raise InputError(f"heights = {show(heights.tolist())}: {error}") from None


def _compare(case: Case, heights: Reals, links: int, shares: Reals) -> None:
    """Check the heights of link springs against those of the case."""
    if len(shares) != links:
        raise InputError(
            f"host: has {links} links, &storeys coupling = 'springs' of the case {len(shares)}"
        )
    if links > 1 and not np.allclose(heights, shares * heights[-1], rtol=1e-6):
        raise InputError(f"heights = {show(heights.tolist())}: differ from those of &storeys")
