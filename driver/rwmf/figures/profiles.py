"""Profiles of demands over the height of a building, and envelopes inside its wall."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError
from rwmf.figures.histories import members
from rwmf.figures.levels import levels_of_storeys
from rwmf.figures.styles import COLOURS, LIMIT, MARKERS, YIELD, Panels, legend_above, make_panels
from rwmf.kernel.numbers import Array
from rwmf.run.arguments import dataset_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


_PERCENTILES = (16, 50, 84)
_BAND = 0.25  # opacity
# panels from left to right: variable, label in newtons and over the weight, names of the sections
_PANELS = (
    ("wall_shear_{}_max", "largest shear (kN)", "largest shear over $m_w g$"),
    ("wall_moment_{}_max", "largest moment (kN m)", "largest moment over $m_w g$ (m)"),
    ("link_{}_force_max", "largest link force (kN)", "largest link force over $m_w g$"),
)


class _Section(NamedTuple):
    """A section of the wall: its name in the variables, and its height [m]."""

    name: str
    z: float


@checked
def envelope_quantities(case: CaseLike) -> list[str]:
    """Name the quantities that `envelope` draws, for a sweep or a spectrum.

    Parameters
    ----------
    case : Case or path
        With ``&wall``.

    Returns
    -------
    list of str
        Names of shears and moments at the sections and of forces of the links: in N and N m where
        the case has a mass.
    """
    case = case_of(case)
    has_mass = case.wall is not None and "m_w" in case.wall
    unit = "" if has_mass else "_over_m_w_g"
    return [
        name.format(section.name) + unit
        for name, _, _ in _PANELS
        for section in _sections(case, name)
    ]


@checked
def envelope(
    dataset: xr.Dataset,
    case: CaseLike,
    axes: Axes | Sequence[Axes] | np.ndarray | None = None,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> Panels:
    """Draw the largest shear and moment in the wall, and the link forces, over the height.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate` with ``&output reactions``, or from `rwmf.sweep` with
        `envelope_quantities`, for example over the records of a suite.
    case : Case or path
        The case, for the heights.
    axes : matplotlib axes or sequence of axes, optional
        One for each of shear, moment and, beside a frame, link force; otherwise a new figure.
    **line
        Arguments of ``Axes.plot``, for example ``label`` and ``color`` to compare several.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes. Points are at the base, at mid-height and on both sides of every floor.
        Stars are the largest values over the height of one run. For several runs the line is the
        median and the band covers 16 to 84 %.

    Raises
    ------
    InputError
        When the dataset lacks an envelope, or when axes and panels differ in number.
    """
    case = case_of(case)
    dataset = dataset_of(dataset, "rwmf.simulate or rwmf.sweep")
    shown = [panel for panel in _PANELS if _sections(case, panel[0])]
    panels = make_panels(axes, len(shown), across=True)
    top, heights = _height(case), [z for _, z in _floors(case)] or [_height(case)]
    for ax, (name, in_newtons, over_weight) in zip(panels, shown, strict=True):
        sections = _sections(case, name)
        unit, factor = _unit_of(dataset, name.format(sections[0].name))
        values = np.array([_values(dataset, name.format(s.name) + unit) for s in sections])
        look = {"color": COLOURS[0], "marker": MARKERS[0], "markersize": 3} | line
        _draw_band(ax, factor * values, np.array([s.z for s in sections]), look)
        _mark_largest(ax, dataset, name.format("").replace("__", "_"), (unit, factor), look)
        ticks = [0.0, *heights[:: 1 + len(heights) // 8]]
        _finish(ax, over_weight if unit else in_newtons, 1.02 * top, ticks)
    return _named(panels, "height above the base (m)", 1)


def _finish(ax: Axes, label: str, top: float, ticks: Sequence[float]) -> None:
    """Label a panel over the height."""
    ax.set_xlabel(label)
    # range of everything drawn, including earlier calls
    ax.autoscale(axis="x")
    ax.set(xlim=(0, None), ylim=(0, top), yticks=ticks)


def _named(panels: Panels, label: str, columns: int) -> Panels:
    """Label the height, and what is drawn if it has names."""
    panels[0].set_ylabel(label)
    if panels[0].get_legend_handles_labels()[1]:
        legend_above(panels[0], columns, is_tight=True)
    return panels


def has_envelopes(dataset: xr.Dataset) -> bool:
    """Tell whether a run has the envelopes of wall and links."""
    return "wall_shear_1_max_over_m_w_g" in dataset


def _height(case: Case) -> float:
    if case.wall is None:
        raise InputError("no envelopes of forces: the case has no &wall")
    return 2 * float(case.wall.h)


def _floors(case: Case) -> list[_Section]:
    """List the floors from the ground up."""
    if case.storeys is not None:
        heights = np.cumsum(case.storeys.height)
        return [_Section(str(i + 1), float(z)) for i, z in enumerate(heights)]
    return [_Section("1", _height(case))] if case.frame is not None else []


def _sections(case: Case, name: str) -> list[_Section]:
    """List the sections of a panel from the base to the roof."""
    top, floors = _height(case), _floors(case)
    if name.startswith("link"):
        links = case.storeys.coupling if case.storeys is not None else ""
        return floors if links in ("every_floor", "springs") else floors[-1:]
    found = [_Section("base", 0.0)]
    for number, z in floors:
        found += [_Section(number, z), _Section(f"{number}_above", z)]
    if all(abs(z - top / 2) > 1e-6 * top for _, z in floors):
        found.insert(1 + 2 * sum(z < top / 2 for _, z in floors), _Section("mid", top / 2))
    return found


def _unit_of(dataset: xr.Dataset, name: str) -> tuple[str, float]:
    """Find the ending of the variables, and the factor that makes kilonewtons of newtons."""
    for ending, factor in (("", 1e-3), ("_over_m_w_g", 1.0)):
        if name + ending in dataset:
            return ending, factor
    raise InputError(
        f"dataset: has no {name}: must be the dataset of rwmf.simulate with &output reactions, or "
        "of rwmf.sweep with rwmf.plot.envelope_quantities(case)"
    )


def _values(dataset: xr.Dataset, name: str) -> Array:
    if name not in dataset:
        raise InputError(f"dataset: has no {name}: must be of the same case")
    return np.asarray(dataset[name].values, dtype=float).ravel()


def _draw_band(ax: Axes, values: Array, z: Array, look: dict[str, Any]) -> None:
    """Draw one run as a line; several as their median inside a band."""
    if values.shape[1] == 1:
        ax.plot(values[:, 0], z, clip_on=False, **look)
        return
    low, middle, high = np.nanpercentile(values, _PERCENTILES, axis=1)
    label = look.get("label", "median")
    ax.plot(middle, z, clip_on=False, **look | {"label": label})
    ax.fill_betweenx(z, low, high, color=look["color"], alpha=_BAND, linewidth=0,
                     label=f"16 to 84 %, {values.shape[1]} runs")  # fmt: skip


def _mark_largest(
    ax: Axes, dataset: xr.Dataset, name: str, unit: tuple[str, float], look: dict[str, Any]
) -> None:
    """Mark the largest value over the whole height where the dataset has one of a single run."""
    height = f"{name}_height"
    if height not in dataset or dataset[height].size != 1 or name + unit[0] not in dataset:
        return
    ax.plot(unit[1] * _values(dataset, name + unit[0]), _values(dataset, height), "*",
            color=look["color"], markersize=9, clip_on=False)  # fmt: skip


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
        values = _profile_values(dataset, name)
        label, factor = DEMANDS[name]
        line_style = {"color": COLOURS[0], "marker": MARKERS[0], "markersize": 3} | line
        if name.startswith("floor"):
            ax.plot(factor * values, np.arange(1, values.size + 1), clip_on=False, **line_style)
        else:
            _draw_storeys(ax, factor * values, line_style | {"marker": None})
        if name == _DRIFTS:
            _draw_beside_drifts(ax, dataset, case, line_style | {"marker": None})
        _finish(ax, label, values.size, range(0, values.size + 1, 1 + values.size // 8))
    return _named(panels, "floor", 2)


def demands_of(dataset: xr.Dataset) -> list[str]:
    """Return the panels of `profile` for a dataset."""
    found = [name for name in DEMANDS if members(dataset, name)]
    if "storey_{i}_shear_max" in found:
        found.remove("storey_{i}_shear_max_over_m_w_g")
    return found if _DRIFTS in found else []


def _profile_values(dataset: xr.Dataset, name: str) -> Array:
    return np.array([float(dataset[member]) for member in members(dataset, name)])


def _draw_storeys(ax: Axes, values: Array, line_style: dict[str, Any]) -> None:
    """Draw one number per storey as a stepped line."""
    ax.plot(np.repeat(values, 2), np.repeat(np.arange(values.size + 1), 2)[1:-1], **line_style)


def _draw_beside_drifts(
    ax: Axes, dataset: xr.Dataset, case: Case | None, line_style: dict[str, Any]
) -> None:
    """Draw residual drifts, and the drifts of first yield and collapse."""
    factor = DEMANDS[_DRIFTS][1]
    residuals = np.abs(_profile_values(dataset, _RESIDUALS))
    if residuals.size:
        label = f"{line_style['label']}, residual" if "label" in line_style else "residual"
        _draw_storeys(ax, factor * residuals, line_style | {"linestyle": ":", "label": label})
    if case is None:
        return
    drifts = _profile_values(dataset, _DRIFTS)
    levels = levels_of_storeys(dataset, case, drifts.size)
    for label, values, line in (
        ("yield", levels.first_yield, YIELD),
        ("limit", levels.limit, LIMIT),
    ):
        if values.size == drifts.size and values.min() <= 1.5 * drifts.max():
            _draw_storeys(ax, factor * values, line | {"label": label})
