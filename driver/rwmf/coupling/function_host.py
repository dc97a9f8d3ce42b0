"""A frame given by functions of Python."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rwmf._arguments import function_of
from rwmf._numbers import show, to_array, to_items, to_shaped, to_whole
from rwmf.coupling.host import IteratedHost, Reals, Wholes, end_rates
from rwmf.errors import InputError

__all__ = ["FunctionHost"]

# relative size of an increment at which Newton's method has converged
_CONVERGED = 1e-13
# difference for a tangent, relative to the increment of a step
_DIFFERENCE = 1e-6


class FunctionHost(IteratedHost):
    """A frame given by its masses and functions for damping and restoring forces.

    Its equation is M u'' + d(u') + r(u) + f = -M u_g'', with all displacements horizontal and
    relative to the ground.

    Parameters
    ----------
    mass : array_like, shape (dofs,) or (dofs, dofs)
        Masses, or mass matrix [kg].
    damping : array_like, shape (dofs, dofs), or callable
        Matrix [N s/m], or damping forces [N] at velocities [m/s].
    restoring : array_like, shape (dofs, dofs), or callable
        Matrix [N/m], or restoring forces [N] at displacements [m]. A function is called for trial
        displacements in any order; a law with memory keeps its state until `on_commit`.
    ground : callable
        Ground acceleration [m/s2] at a time [s].
    links : sequence of int
        Degrees of freedom linked to the wall, from the ground up, counted from 0.
    on_commit : callable, optional
        Called with the displacements [m] at the end of each step.

    Raises
    ------
    InputError
        When an argument is not acceptable.
    """

    _most_iterations = 50

    def __init__(
        self,
        mass: object,
        damping: object,
        restoring: object,
        ground: Callable[[float], float],
        links: object,
        on_commit: Callable[[Reals], None] | None = None,
    ) -> None:
        self._mass = _matrix("mass", mass)
        n = len(self._mass)
        self._damping = _forces("damping", damping, n)
        self._restoring = _forces("restoring", restoring, n)
        self._ground = function_of("ground", ground)
        self._on_commit = None if on_commit is None else function_of("on_commit", on_commit)
        numbers = [to_whole("links", number, 0, n - 1) for number in to_items(links) or []]
        if not numbers:
            raise InputError(f"links = {show(links)}: must be numbers in [0, {n - 1}]")
        self.links: Wholes = np.array(numbers, dtype=np.int64)
        self._t = 0.0
        self._u, self._v, self._a = np.zeros((3, n))

    def motion(self) -> tuple[Reals, Reals, Reals]:
        """Return the committed displacements, velocities and accelerations [m, s].

        Returns
        -------
        tuple of numpy.ndarray, each of shape (dofs,)
            The motion.
        """
        return self._u, self._v, self._a

    def time(self) -> float:
        """Return the time of the committed motion.

        Returns
        -------
        float
            The time [s].
        """
        return self._t

    def _guess(self, h: float) -> Reals:
        return h * self._v

    def _correct(
        self, increment: Reals, forces: Reals, h: float, iteration: int
    ) -> tuple[Reals, bool]:
        """Take a step of Newton's method."""
        load = -self._mass.sum(axis=1) * self._ground(self._t + h)
        np.add.at(load, self.links, forces)
        speed = np.abs(self._v).max()
        size = max(h * speed + h * h * np.abs(self._a).max(), np.abs(increment).max())
        v, a = end_rates(increment, h, self._v, self._a)
        u = self._u + increment
        residual = load - self._mass @ a - self._damping(v) - self._restoring(u)
        matrix = (
            4 / h**2 * self._mass
            + 2 / h * _tangent(self._damping, v, speed + h)
            + _tangent(self._restoring, u, size + h * h)
        )
        correction = np.linalg.solve(matrix, residual)
        return correction, bool(np.abs(correction).max() <= _CONVERGED * size)

    def _make_step(self, forces: Reals, h: float) -> None:
        increment = self.attempt(forces, h)
        v, a = end_rates(increment, h, self._v, self._a)
        self._u, self._v, self._a = self._u + increment, v, a
        self._t += h
        if self._on_commit is not None:
            self._on_commit(self._u.copy())

    def set_rates(self, velocities: Reals, accelerations: Reals) -> None:
        """Replace the committed rates.

        Parameters
        ----------
        velocities : numpy.ndarray, shape (dofs,)
            Velocities [m/s].
        accelerations : numpy.ndarray, shape (dofs,)
            Accelerations [m/s2].
        """
        shape = self._u.shape
        self._v = to_shaped("velocities", velocities, shape)
        self._a = to_shaped("accelerations", accelerations, shape)


def _matrix(name: str, value: object, n: int | None = None) -> Reals:
    """Return a square matrix; a vector is its diagonal."""
    array = to_shaped(name, value)
    square = np.diag(array) if array.ndim == 1 else array
    if square.ndim != 2 or not square.size or len({*square.shape, n or len(square)}) > 1:
        size = "(dofs, dofs)" if n is None else f"({n}, {n})"
        raise InputError(f"{name}: has the shape {array.shape}: must have {size}")
    return square


def _forces(name: str, value: object, n: int) -> Callable[[Reals], Reals]:
    """Return a function for forces."""
    if not callable(value):
        return _Linear(_matrix(name, value, n))

    def compute(at: Reals) -> Reals:
        return to_array(name, value(at.copy()), least=n)

    return compute


class _Linear:
    """Forces by a matrix."""

    def __init__(self, matrix: Reals) -> None:
        self.matrix = matrix

    def __call__(self, at: Reals) -> Reals:
        return np.asarray(self.matrix @ at)


def _tangent(forces: Callable[[Reals], Reals], at: Reals, size: float) -> Reals:
    """Return the derivative of forces: of a function by differences."""
    if isinstance(forces, _Linear):
        return forces.matrix
    step = _DIFFERENCE * size
    here = forces(at)
    columns = [(forces(at + step * unit) - here) / step for unit in np.eye(len(at))]
    return np.array(columns).T
