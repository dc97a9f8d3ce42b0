"""A frame modelled in OpenSeesPy.

OpenSees has no command that takes a step back. A step that does not converge is taken back,
however, and leaves its last increment in the equation solver. So `OpenSeesHost.attempt` lets the
analysis fail after 1, 2, ... iterations of Newton's method and adds their increments.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from types import ModuleType

import numpy as np

from rwmf.errors import InputError, NumericalError
from rwmf.hosts.partner import IteratedHost, Reals, Wholes
from rwmf.kernel.numbers import show, to_items, to_whole

# a residual below this part of the largest force in the first iteration counts as round-off
_ROUNDING = 1e-6
_NEVER = -1.0


class OpenSeesHost(IteratedHost):
    """A frame that is the present model of OpenSeesPy.

    The model is complete before: masses at the linked nodes, and the ground acceleration as a
    `UniformExcitation`. This class makes the analysis (Newmark's average acceleration) and one load
    pattern. Constraints are handled by ``Plain``, so `equalDOF` is allowed. OpenSees then writes
    its messages to `log`, since every trial step ends with one.

    Parameters
    ----------
    ops : module
        ``openseespy.opensees``.
    nodes : sequence of int
        Tags of the nodes linked to the wall, from the ground up.
    dof : int
        Their horizontal degree of freedom, from 1.
    tolerance : float
        Residual force of an equilibrium of the frame [N].
    system : sequence
        Arguments of this command.
    tag : int
        Unused tag of a time series and a load pattern.
    log : path
        File for the messages of OpenSees.

    Raises
    ------
    InputError
        When a node does not exist, or its degree of freedom is fixed.
    """

    _most_iterations = 20

    def __init__(
        self,
        ops: ModuleType,
        nodes: Sequence[int],
        dof: int = 1,
        tolerance: float = 1e-6,
        system: Sequence[object] = ("BandGeneral",),
        tag: int = 987654,
        log: str = os.devnull,
    ) -> None:
        self._ops = ops
        self._tolerance = tolerance
        self._tag = tag
        self._dof = to_whole("dof", dof, 1)
        self._nodes = _existing(ops, nodes)
        ops.logFile(log, "-noEcho")
        ops.timeSeries("Constant", tag)
        ops.wipeAnalysis()
        ops.constraints("Plain")
        ops.numberer("RCM")
        ops.system(*system)
        ops.algorithm("Newton")
        ops.integrator("Newmark", 0.5, 0.25)
        self._ends_always(1)
        ops.analysis("Transient")
        self._load(np.zeros(len(self._nodes)))
        # numbers the equations; the step is taken back
        ops.analyze(1, 1e-9)
        self._places = [
            (equation, node, place)
            for node in ops.getNodeTags()
            for place, equation in enumerate(ops.nodeDOFs(node), start=1)
            if equation >= 0
        ]
        self._n = 1 + max(equation for equation, _, _ in self._places)
        found = {(node, place): equation for equation, node, place in self._places}
        for node in self._nodes:
            if (node, self._dof) not in found:
                raise InputError(f"nodes = {node}: degree of freedom {self._dof} is not free")
        self.links: Wholes = np.array([found[node, self._dof] for node in self._nodes])

    def _load(self, forces: Reals) -> None:
        """Put forces on the linked nodes."""
        ops, tag = self._ops, self._tag
        if tag in ops.getPatterns():
            ops.remove("loadPattern", tag)
        ops.pattern("Plain", tag, tag)
        for node, force in zip(self._nodes, forces.tolist(), strict=True):
            values = [0.0] * len(ops.nodeDisp(node))
            values[self._dof - 1] = force
            ops.load(node, *values)

    def _ends_always(self, iterations: int) -> None:
        """Let every step fail after a number of iterations."""
        self._ops.test("NormUnbalance", _NEVER, iterations)

    def motion(self) -> tuple[Reals, Reals, Reals]:
        """Return the committed displacements, velocities and accelerations.

        Returns
        -------
        tuple of numpy.ndarray, each of shape (equations,)
            Of translations in m and s, of rotations in rad and s.
        """
        ops = self._ops
        motion = np.zeros((3, self._n))
        for equation, node, place in self._places:
            motion[:, equation] = (
                ops.nodeDisp(node, place), ops.nodeVel(node, place), ops.nodeAccel(node, place),
            )  # fmt: skip
        u, v, a = motion
        return u, v, a

    def time(self) -> float:
        """Return the time of the domain.

        Returns
        -------
        float
            The time [s].
        """
        return float(self._ops.getTime())

    def _guess(self, h: float) -> Reals:
        return np.zeros(self._n)

    def _correct(
        self, increment: Reals, forces: Reals, h: float, iteration: int
    ) -> tuple[Reals, bool]:
        """Repeat the step with one iteration more, and take the last increment from the solver."""
        ops = self._ops
        if iteration == 1:
            self._load(forces)
        self._ends_always(iteration)
        if ops.analyze(1, h) == 0:
            raise NumericalError(f"t = {self.time():g} s: OpenSees kept a trial step")
        correction = np.array(ops.printX("-ret"))
        norms = ops.testNorms()[:iteration]
        residual = norms[-1]
        is_close = residual <= self._tolerance
        is_stuck = iteration > 1 and residual > norms[-2] / 2
        rounding = _ROUNDING * self._size(increment + correction, h)
        return correction, is_close or (is_stuck and residual <= rounding)

    def _size(self, increment: Reals, h: float) -> float:
        """Force that rounding is relative to [N]: 4 m u / h2 with a mass of 1 t at least."""
        return 1e3 + 4e3 * float(np.abs(increment).max()) / h**2

    def _make_step(self, forces: Reals, h: float) -> None:
        self._load(forces)
        # short steps end at the rounding of their inertia forces
        for tolerance in (self._tolerance, 1e3 * self._tolerance, 1e6 * self._tolerance):
            self._ops.test("NormUnbalance", tolerance, self._most_iterations)
            if self._ops.analyze(1, h) == 0:
                return
        raise NumericalError(f"t = {self.time():g} s: OpenSees does not converge")

    def set_rates(self, velocities: Reals, accelerations: Reals) -> None:
        """Replace the committed rates of all nodes.

        Parameters
        ----------
        velocities : numpy.ndarray, shape (equations,)
            Velocities [m/s, rad/s].
        accelerations : numpy.ndarray, shape (equations,)
            Accelerations [m/s2, rad/s2].
        """
        for equation, node, place in self._places:
            self._ops.setNodeVel(node, place, float(velocities[equation]), "-commit")
            self._ops.setNodeAccel(node, place, float(accelerations[equation]), "-commit")
        # the integrator keeps a copy of the motion; it reads the nodes again after a change
        self._ops.domainChange()


def _existing(ops: ModuleType, nodes: object) -> list[int]:
    """Return tags of nodes after checking that they exist."""
    tags = to_items(nodes)
    known = set(ops.getNodeTags())
    if not tags:
        raise InputError(f"nodes = {show(nodes)}: must be a list of tags")
    for tag in tags:
        if tag not in known:
            raise InputError(f"nodes = {show(tag)}: is no node of the model")
    return [int(tag) for tag in tags]
