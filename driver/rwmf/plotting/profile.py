"""Profiles of demands over the height of a building."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rwmf._arguments import case_of, checked, dataset_of
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.plotting.levels import levels_of_storeys
from rwmf.plotting.response import members
from rwmf.plotting.style import COLOURS, LIMIT, MARKERS, YIELD, Panels, legend_above, make_panels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["DEMANDS", "demands_of", "profile"]

Array = npt.NDArray[np.float64]

# panels of `profile` from left to right, with axis label and factor
DEMANDS = {
    "storey_{i}_drift_max": ("largest storey drift (%)", 100.0),
    "floor_{i}_acceleration_max_g": ("largest acceleration (g)", 1.0),
    "storey_{i}_shear_max": ("largest shear (kN)", 1e-3),
    "storey_{i}_shear_max_over_m_w_g": ("largest shear over $m_w g$", 1.0),
}
_DRIFTS, _RESIDUALS = "storey_{i}_drift_max", "storey_{i}_residual_drift"


@checked
def profile(
    dataset: xr.Dataset,
    axes: Axes | Sequence[Axes] | np.ndarray | None = None,
    *,
    case: CaseLike | None = None,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> Panels:
    """Draw the peak demands of storeys and floors over the height.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate`, for storeys with ``&output reactions``.
    axes : matplotlib axes or sequence of axes, optional
        One for each of drifts, accelerations and shears; otherwise a new figure.
    case : Case or path, optional
        The simulated case; adds faint lines for first yield and limits behind the drifts.
    **line
        Arguments of ``Axes.plot``, for example ``label`` and ``color`` for comparisons.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes. Drifts and shears are constant over a storey; residual drifts of yielding storeys
        are dotted.

    Raises
    ------
    InputError
        When the dataset has no demands of storeys, or when the numbers of axes and panels differ.
    """
    case = None if case is None else case_of(case)
    dataset = dataset_of(dataset, "rwmf.simulate")
    names = demands_of(dataset)
    if not names:
        raise InputError(
            "dataset: no demands of storeys: must be the dataset of rwmf.simulate for a case with "
            "&storeys and &output reactions = .true."
        )
    panels = make_panels(axes, len(names), across=True)
    for ax, name in zip(panels, names, strict=True):
        values = _values(dataset, name)
        label, factor = DEMANDS[name]
        line_style = {"color": COLOURS[0], "marker": MARKERS[0], "markersize": 3} | line
        if name.startswith("floor"):
            ax.plot(factor * values, np.arange(1, values.size + 1), clip_on=False, **line_style)
        else:
            _draw_storeys(ax, factor * values, line_style | {"marker": None})
        if name == _DRIFTS:
            _draw_beside_drifts(ax, dataset, case, line_style | {"marker": None})
        ax.set_xlabel(label)
        # range of everything drawn, including earlier calls
        ax.autoscale(axis="x")
        ax.set_xlim(left=0)
        ax.set_ylim(0, values.size)
        ax.set_yticks(np.arange(0, values.size + 1, 1 + values.size // 8))
    panels[0].set_ylabel("floor")
    if panels[0].get_legend_handles_labels()[1]:
        legend_above(panels[0], 2, is_tight=True)
    return panels


def demands_of(dataset: xr.Dataset) -> list[str]:
    """Return the panels of `profile` for a dataset."""
    found = [name for name in DEMANDS if members(dataset, name)]
    if "storey_{i}_shear_max" in found:
        found.remove("storey_{i}_shear_max_over_m_w_g")
    return found if _DRIFTS in found else []


def _values(dataset: xr.Dataset, name: str) -> Array:
    return np.array([float(dataset[member]) for member in members(dataset, name)])


def _draw_storeys(ax: Axes, values: Array, line_style: dict[str, Any]) -> None:
    """Draw one number per storey as a stepped line."""
    ax.plot(np.repeat(values, 2), np.repeat(np.arange(values.size + 1), 2)[1:-1], **line_style)


def _draw_beside_drifts(
    ax: Axes, dataset: xr.Dataset, case: Case | None, line_style: dict[str, Any]
) -> None:
    """Draw residual drifts, and the drifts of first yield and collapse."""
    factor = DEMANDS[_DRIFTS][1]
    residuals = np.abs(_values(dataset, _RESIDUALS))
    if residuals.size:
        label = f"{line_style['label']}, residual" if "label" in line_style else "residual"
        _draw_storeys(ax, factor * residuals, line_style | {"linestyle": ":", "label": label})
    if case is None:
        return
    drifts = _values(dataset, _DRIFTS)
    levels = levels_of_storeys(dataset, case, drifts.size)
    for label, values, line in (
        ("yield", levels.first_yield, YIELD),
        ("limit", levels.limit, LIMIT),
    ):
        if values.size == drifts.size and values.min() <= 1.5 * drifts.max():
            _draw_storeys(ax, factor * values, line | {"label": label})
