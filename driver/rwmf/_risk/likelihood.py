"""Maximum of normal log-likelihoods with exact and censored observations, for many resamples.

The inverse standard deviation is a parameter (Olsen 1978), so that the log-likelihood is concave.
Newton's method with shorter steps therefore reaches its maximum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from rwmf._risk.normal import log_normal_cdf

__all__ = ["BELOW", "EXACT", "OVER", "Observations", "maximise"]

Array = npt.NDArray[np.float64]
# kinds of observations: of the value itself, of a value above, of a value below
EXACT, OVER, BELOW = 0, -1, 1
_ITERATIONS = 200
_CONVERGED = 1e-13
_HALVINGS = 40


@dataclass(frozen=True)
class Observations:
    """Observations of standard normal variables z = coefficients @ parameters.

    Attributes
    ----------
    coefficients : numpy.ndarray, shape (n, p)
        Linear map from the parameters to z. Where observations are exact, the last parameter is
        the inverse standard deviation.
    kinds : numpy.ndarray of int, shape (n,)
        ``EXACT`` (density of z), ``BELOW`` (probability up to z) or ``OVER`` (above z).
    """

    coefficients: Array
    kinds: npt.NDArray[np.int64]

    def value(self, weights: Array, parameters: Array) -> tuple[Array, Array, Array]:
        """Compute log-likelihoods with gradient and Hessian."""
        p = parameters.shape[1]
        z = parameters @ self.coefficients.T
        exact = self.kinds == EXACT
        value, slope, curvature = -0.5 * z**2, -z, -np.ones_like(z)
        sign = self.kinds[~exact]
        if sign.size:
            argument = sign * z[:, ~exact]
            logarithm, hazard = log_normal_cdf(argument)
            value[:, ~exact] = logarithm
            slope[:, ~exact] = sign * hazard
            curvature[:, ~exact] = -hazard * (argument + hazard)
        total = np.sum(weights * value, axis=1)
        gradient = (weights * slope) @ self.coefficients
        squares = np.einsum("np,nq->npq", self.coefficients, self.coefficients).reshape(
            len(z.T), -1
        )
        hessian = ((weights * curvature) @ squares).reshape(-1, p, p)
        if exact.any():
            n = weights[:, exact].sum(axis=1)
            scale = parameters[:, -1]
            with np.errstate(invalid="ignore", divide="ignore"):
                total = np.where(scale > 0, total + n * np.log(scale), -np.inf)
            gradient[:, -1] += n / scale
            hessian[:, -1, -1] -= n / scale**2
        return total, gradient, hessian


def maximise(observations: Observations, weights: Array, start: Array) -> Array:
    """Find the parameters of maximum likelihood of every resample."""
    found = np.tile(start.astype(float), (len(weights), 1))
    value, gradient, hessian = observations.value(weights, found)
    active = np.arange(len(weights))
    for _ in range(_ITERATIONS):
        # pseudo-inverse: a resample may leave one direction undetermined
        inverse = np.linalg.pinv(hessian, rcond=1e-14, hermitian=True)
        step = -np.einsum("bpq,bq->bp", inverse, gradient)
        for _ in range(_HALVINGS):
            trial = found[active] + step
            new = observations.value(weights[active], trial)
            worse = ~(new[0] >= value - 1e-13 * np.abs(value))
            if not worse.any():
                break
            step[worse] *= 0.5
        found[active] = trial
        size = np.abs(step).max(axis=1) / np.abs(trial).max(axis=1)
        kept = size > _CONVERGED
        active = active[kept]
        if not active.size:
            break
        value, gradient, hessian = (part[kept] for part in new)
    return found
