"""Flexibility and inertia of the frame of a host at its links."""

from __future__ import annotations

import numpy as np

from rwmf.coupling.host import Host, Reals, end_rates
from rwmf.errors import InputError

__all__ = ["LinkedFrame"]

# flexibilities that are kept, and the digits by which their steps differ
_MOST_KEPT = 8
_DIGITS = 6
# part of the step that shows masses and accelerations of the host
_INSTANT = 1e-4
# relative difference of masses that two such parts show
_SAME_MASS = 1e-2


class LinkedFrame:
    """A host as its links show it.

    Attributes
    ----------
    by_force : numpy.ndarray, shape (dofs, links)
        Accelerations of the frame by unit forces at the links [1/kg].
    mass : numpy.ndarray, shape (links, links)
        Mass of the frame at the links [kg].
    """

    def __init__(self, host: Host, dt: float, force: float) -> None:
        self._host, self._dt, self._force = host, dt, force
        self._instant = _INSTANT * dt
        self._flexibilities: dict[float, Reals] = {}
        self.by_force: Reals = self._increments(self._instant) * 4 / self._instant**2
        at_links = self.by_force[host.links]
        # without a mass the acceleration would grow as the step shrinks
        longer = 10 * self._instant
        again = self._increments(longer)[host.links] * 4 / longer**2
        if not np.allclose(at_links, again, rtol=_SAME_MASS) or not np.all(np.diag(again) > 0):
            raise InputError("host: a link has no mass")
        self.mass: Reals = np.asarray(np.linalg.inv(at_links), dtype=np.float64)

    def _increments(self, h: float) -> Reals:
        """Increments of the frame in a step by unit forces on the frame at the links [m/N]."""
        links = len(self._host.links)
        base = self._host.attempt(np.zeros(links), h)
        columns = [
            (self._host.attempt(self._force * unit, h) - base) / self._force
            for unit in np.eye(links)
        ]
        return np.array(columns).T

    def motion(self) -> Reals:
        """Return the committed motion of the links."""
        return np.array([values[self._host.links] for values in self._host.motion()])

    def flexibility(self, h: float, is_new: bool) -> Reals:
        """Return the displacements of the links by unit forces at the end of a step."""
        # whole steps differ by the rounding of the times
        part = round(h / self._dt, _DIGITS)
        if is_new or part not in self._flexibilities:
            if len(self._flexibilities) > _MOST_KEPT:
                self._flexibilities.clear()
            self._flexibilities[part] = self._increments(h)[self._host.links]
        return self._flexibilities[part]

    def with_link_velocities(self, at_links: Reals) -> Reals:
        """Return the velocities of the frame after impulses at the links."""
        links = self._host.links
        _, velocities, _ = self._host.motion()
        change = at_links - velocities[links]
        return np.asarray(
            velocities + self.by_force @ np.linalg.solve(self.by_force[links], change)
        )

    def free_accelerations(self, velocities: Reals) -> Reals:
        """Return the accelerations without forces at the links, and set the velocities."""
        host, h = self._host, self._instant
        _, _, accelerations = host.motion()
        host.set_rates(velocities, accelerations)
        increment = host.attempt(np.zeros(len(host.links)), h)
        return end_rates(increment, h, velocities, accelerations)[1]
