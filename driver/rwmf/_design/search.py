"""Search for the cheapest design: many starts, then gradients of the targets."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from rwmf._design.suite_runs import SuiteRuns
from rwmf._design.targets import Variable
from rwmf._extras import how_to_install
from rwmf.errors import InputError

__all__ = ["cheapest"]

Array = npt.NDArray[np.float64]
# designs of a generation for each variable, and the fewest
_GENERATION = (8, 16)
# designs from which gradients are followed, and the largest number of their steps
_STARTS, _STEPS = 3, 12
# step of the differences of a statistic over the range of a variable
_STEP = 5e-3
_SEED = 1963
_AT_BOUND = 1e-9


def cheapest(
    runs: SuiteRuns,
    variables: Sequence[Variable],
    cost: Callable[[Array], float],
    designs: int,
    guess: Array | None = None,
) -> Array:
    """Find the cheapest design that meets all targets, or else the one nearest to them.

    Differential evolution visits the whole range; from its best designs sequential quadratic
    programming follows gradients of the targets for the real variables.
    """
    try:
        from scipy.optimize import Bounds, NonlinearConstraint, differential_evolution
    except ImportError:
        raise InputError(f"a design needs SciPy: {how_to_install('design')}") from None
    low = np.array([item.low for item in variables])
    high = np.array([item.high for item in variables])
    n = max(_GENERATION[0] * len(variables), _GENERATION[1])

    def excess(x: Array) -> Array:
        columns = x.reshape(len(variables), -1)
        found = runs.utilisations(columns.T).T - 1
        return found if x.ndim > 1 else found[:, 0]

    differential_evolution(
        lambda x: np.array([cost(column) for column in x.reshape(len(variables), -1).T]),
        Bounds(low, high),
        constraints=NonlinearConstraint(excess, -np.inf, 0.0),
        integrality=[item.is_whole for item in variables],
        init=_first_generation(low, high, n, guess),
        maxiter=max(1, designs // n - 1),
        tol=1e-3,
        vectorized=True,
        updating="deferred",
        polish=False,
        seed=_SEED,
    )
    for start in _best(runs, cost, _STARTS):
        _descend(runs, variables, cost, start)
    return _best(runs, cost, 1)[0]


def _first_generation(low: Array, high: Array, n: int, guess: Array | None) -> Array:
    from scipy.stats import qmc

    random = qmc.LatinHypercube(len(low), seed=_SEED)
    found: Array = low + (high - low) * random.random(n)
    # the corner of the largest numbers is often the one that meets the targets
    found[0], found[1] = high, low
    if guess is not None:
        found[2] = np.clip(guess, low, high)
    return found


def _best(runs: SuiteRuns, cost: Callable[[Array], float], n: int) -> list[Array]:
    """Order the computed designs: cheapest first, those that miss a target by their excess."""
    rows = [np.array(row) for row in runs.values]
    worst = runs.utilisations(np.array(rows)).max(axis=1)
    costs = np.array([cost(row) for row in rows])
    misses = np.maximum(worst, 1.0)
    return [rows[i] for i in np.lexsort((costs, misses))[:n]]


def _descend(
    runs: SuiteRuns, variables: Sequence[Variable], cost: Callable[[Array], float], start: Array
) -> None:
    """Follow gradients of cost and targets; every design on the way is kept in `runs`."""
    from scipy.optimize import minimize

    real = np.array([not item.is_whole for item in variables])
    if not real.any():
        return
    low = np.array([item.low for item in variables])
    span = np.array([item.high for item in variables]) - low
    size = max(abs(cost(start)), 1e-300)

    def design(x: Array) -> Array:
        full = start.copy()
        # the optimiser stops a rounding error away from a bound
        near = np.where(x < _AT_BOUND, 0.0, np.where(x > 1 - _AT_BOUND, 1.0, x))
        full[real] = low[real] + near * span[real]
        return full

    def neighbours(x: Array) -> list[tuple[Array, Array, float]]:
        found = []
        for i in range(len(x)):
            up, down = x.copy(), x.copy()
            up[i], down[i] = min(x[i] + _STEP, 1.0), max(x[i] - _STEP, 0.0)
            found.append((design(up), design(down), up[i] - down[i]))
        return found

    def slope_of_cost(x: Array) -> Array:
        return np.array(
            [(cost(up) - cost(down)) / (step * size) for up, down, step in neighbours(x)]
        )

    def slopes(x: Array) -> Array:
        near = neighbours(x)
        both = runs.utilisations(np.array([item for pair in near for item in pair[:2]]))
        steps = np.array([step for *_, step in near])
        found: Array = -((both[::2] - both[1::2]) / steps[:, None]).T
        return found

    minimize(
        lambda x: cost(design(x)) / size,
        (start[real] - low[real]) / span[real],
        jac=slope_of_cost,
        method="SLSQP",
        bounds=[(0.0, 1.0)] * int(real.sum()),
        constraints={
            "type": "ineq",
            "fun": lambda x: 1 - runs.utilisations(design(x)[None])[0],
            "jac": slopes,
        },
        options={"maxiter": _STEPS, "ftol": 1e-4},
    )
