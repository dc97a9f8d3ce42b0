"""Trusted answers: the same equations in quadruple precision.

The extension `rwmf._reference` is the kernel compiled in quadruple precision with the extrapolated
midpoint rule of order 18. Each case is integrated at two tolerances; their difference bounds the
error of the answer.
"""

import numpy as np
import rwmf

RTOL_LOOSE = 1e-16
RTOL = 1e-19
_NAMES = (
    "u_s_max_m",
    "t_u_s_max_s",
    "theta_max_rad",
    "theta_dot_max_rad_s",
    "theta_end_rad",
    "theta_dot_end_rad_s",
    "t_end_s",
)


class NoAnswerError(Exception):
    """The reference cannot deliver either; the message is the kernel's."""


def solve(case: rwmf.Case, loose: float = RTOL_LOOSE, tight: float = RTOL) -> dict[str, float]:
    """Integrate a case in quadruple precision.

    Parameters
    ----------
    case : rwmf.Case
        The case; its method and tolerance are not used.
    loose, tight : float
        The two relative tolerances.

    Returns
    -------
    dict
        Values of the tighter run with units in their names, ``impacts``, ``overturned``, and
        ``error``: the relative change of the peak between both runs.

    Raises
    ------
    NoAnswerError
        When the integration fails.
    """
    from rwmf import _reference

    values, differences = np.full(len(_NAMES), np.nan), np.full(len(_NAMES), np.nan)
    message = np.zeros(4096, dtype=np.int8)
    control = np.zeros(2, dtype=np.int64)
    _, counts, status, length = _reference.rwmf_bindings_python_reference.solve(
        case.text.encode(), case.kernel_source().encode(), loose, tight, control, values,
        differences, np.zeros(1), message,
    )  # fmt: skip
    if status != 0:
        raise NoAnswerError(message[:length].tobytes().decode())
    answer = dict(zip(_NAMES, (float(value) for value in values), strict=True))
    peak = 0 if case.frame is not None else 2
    scale = max(abs(values[peak]), 1e-300)
    return answer | {
        "impacts": int(counts[2]),
        "overturned": int(counts[3]),
        "error": float(differences[peak]) / scale if values[peak] > 0 else 0.0,
    }
