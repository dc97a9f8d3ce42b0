"""Coefficients of the paper's equation of motion."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from rwmf.case import CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.kernel.numbers import to_array, to_items


@checked
def paper_coefficients(case: CaseLike, theta: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Compute the coefficients A_i and B_i of Eq. (15) of the paper.

    theta_ddot = A_1 theta_dot**2 + A_2 theta_dot + A_3 u_g_ddot + A_4 for theta < 0, and the same
    with B_i for theta > 0.

    Parameters
    ----------
    case : Case or path
        The case. Its wall, frame, cable and g count, and nothing else.
    theta : float or sequence of float
        Rotations [rad]. At 0 the sign of the zero selects A_i (-0.0) or B_i.

    Returns
    -------
    numpy.ndarray, shape (4,) or (n, 4)
        The coefficients [-], [1/s], [1/m], [1/s2].

    Raises
    ------
    InputError
        When the case has no wall or no period, or theta is no array of numbers.

    Examples
    --------
    >>> wall = {"h": 2.0, "b": 0.5}
    >>> block = rwmf.Case(wall=wall, solver={"t_end": 1.0})
    >>> rwmf.paper_coefficients(block, 0.0)[3] < 0 < rwmf.paper_coefficients(block, -0.0)[3]
    True
    """
    rotations = to_array("theta", [theta] if to_items(theta) is None else theta, least=1)
    found = case_of(case).kernel.paper_coefficients(rotations)
    return found[0] if to_items(theta) is None else found
