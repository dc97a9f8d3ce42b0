"""Time loop that couples a wall with the frame of a host."""

from __future__ import annotations

import math
from collections.abc import Callable

from rwmf._arguments import case_of, checked
from rwmf._numbers import show, to_number
from rwmf.case import CaseLike
from rwmf.coupling.coupled_run import CoupledRun
from rwmf.coupling.coupled_wall import CoupledWall
from rwmf.coupling.host import Host
from rwmf.coupling.pair import Pair
from rwmf.errors import InputError, warn

__all__ = ["couple"]


@checked
def couple(
    case: CaseLike,
    host: Host,
    ground: Callable[[float], float],
    dt: float,
    t_end: float,
    heights: object = None,
    tolerance: float = 1e-10,
) -> CoupledRun:
    """Step a wall and the frame of a host together.

    Impacts and lift-offs end a step at their instant. At an impact the balance of momentum over
    the masses of the host changes the velocities (rule ``coupled``), or the factor of the case.

    Parameters
    ----------
    case : Case or path
        Wall with `m_w`, tendon, fuses, `&bending`, impact rule and other effects of an `Element`.
        Its frame and motion have no effect, but for link springs of `&storeys`.
    host : Host
        The frame at rest, for example an `OpenSeesHost` or a `FunctionHost`.
    ground : callable
        Ground acceleration [m/s2] at a time [s], the one of the host; linear within a step.
    dt : float
        Step [s]. With `&bending`, at most a twentieth of the period of the highest mode.
    t_end : float
        End [s].
    heights : array_like, shape (links,), optional
        Heights of the links above the base, from the ground up [m], by default those of `&storeys`.
        Needed for several links. A rigid wall keeps them on a straight line; the highest is the
        link of the case. A wall that bends has its highest link at 2h.
    tolerance : float
        Difference between the forces of wall and frame, over the weight of the wall [-].

    Returns
    -------
    CoupledRun
        Histories, events, maxima and energies.

    Raises
    ------
    InputError
        When the case does not allow an element, or an argument is not acceptable.
    NumericalError
        When an iteration does not converge, or the wall overturns.
    """
    if not hasattr(host, "links") or not callable(getattr(host, "attempt", None)):
        raise InputError(f"host = {show(host)}: must be an OpenSeesHost, a FunctionHost or a Host")
    given = case_of(case)
    mass = None if given.wall is None else given.wall.get("m_w")
    if mass is None:
        raise InputError("case: a coupling needs &wall m_w, the mass of the wall")
    weight = to_number("m_w", mass) * given.model.g
    wall = CoupledWall(given, len(host.links), heights)
    warn(given.kernel.motion_warnings())
    pair = Pair(wall, host, ground, dt, weight, tolerance)
    begin = host.time()
    for number in range(1, math.ceil((t_end - begin) / dt * (1 - 1e-12)) + 1):
        pair.advance(min(begin + number * dt, t_end))
    return pair.run
