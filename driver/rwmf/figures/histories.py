"""Figures of histories and spectra."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from itertools import count, product, takewhile
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError
from rwmf.figures import styles
from rwmf.figures.levels import draw_levels, levels_of_frame, levels_of_storeys
from rwmf.run.arguments import dataset_of
from rwmf.run.quantities import AXES, ENDINGS, QUANTITIES

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


# default panels of `history` from top to bottom, with their labels; {i} means every floor or storey
PANELS = {
    "u_g_ddot": r"ground acceleration $\ddot u_g$",
    "v_g_ddot": r"vertical acceleration $\ddot v_g$",
    "theta": r"wall rotation $\theta$",
    "theta_dot": r"angular velocity $\dot\theta$",
    "u_s": "frame displacement $u_s$",
    "floor_{i}": "floor displacement $u_i$",
    "storey_{i}_drift": "interstorey drift (%)",
    "floor_{i}_acceleration_g": "floor acceleration (g)",
    "cable_force_over_m_w_g": "tendon force $P/(m_wg)$",
    "contact_length": "contact length",
    "base_height": "height of the base's middle",
    "base_slip": "slip of the base",
    "frame_force_over_m_s_g": "frame force $F_s/(m_sg)$",
    "fuse_left_force_over_m_w_g": "left fuse $F_l/(m_wg)$",
    "fuse_right_force_over_m_w_g": "right fuse $F_r/(m_wg)$",
}
# labels of panels; other variables have the meaning in their attributes
_WORDS = PANELS | {
    "cable_force": "tendon force $P$",
    "frame_force": "frame force $F_s$",
    "fuse_left_force": "left fuse $F_l$",
    "fuse_right_force": "right fuse $F_r$",
}
# smallest distance of the ticks of two impacts over the width of a panel
_APART = 1 / 120
# letters in a line of the label of a panel, and of a figure with one panel
_LETTERS, _LETTERS_ALONE = 20, 45
_FLOORS, _DRIFTS = "floor_{i}", "storey_{i}_drift"
# names of one storey or floor by those of all
_NUMBERED = {item.over_levels.name: item.name for item in QUANTITIES.values()
             if item.level and "history" in item.outputs.split()}  # fmt: skip
# lines per column of a legend as high as its panel
_ROWS = 6
_UNITS = {"rad/s2": "rad/s²", "m/s2": "m/s²", "1": ""}
_ROTATION = "theta_max_over_alpha"


@checked
def history(
    dataset: xr.Dataset,
    axes: Axes | Sequence[Axes] | np.ndarray | None = None,
    variables: Sequence[str] | None = None,
    *,
    case: CaseLike | None = None,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> styles.Panels:
    """Draw variables against time, one panel each; ticks at the bottom mark impacts.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate`, with a history.
    axes : matplotlib axes or sequence of axes, optional
        One for each variable; otherwise a new figure.
    variables : sequence of str, optional
        Names of variables over time; ``{i}`` instead of a number draws all floors or storeys in one
        panel. The default is the members of `PANELS` in the dataset, with ``u_s`` as the roof among
        the floors, and with forces in kN where the case has masses. Storey drifts and floor
        accelerations need ``&output reactions``.
    case : Case or path, optional
        The simulated case; adds faint lines for first yield and the limits of collapse behind
        displacements and drifts.
    **line
        Arguments of ``Axes.plot``, for example ``label``.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes. A dotted line marks the time of overturning or collapse.

    Raises
    ------
    InputError
        When the dataset has no history or no such variable, or when the numbers of axes and
        variables differ.
    """
    case = None if case is None else case_of(case)
    dataset = dataset_of(dataset, "rwmf.simulate")
    if "time" not in dataset.coords:
        raise InputError(
            "dataset: no history to plot: must be the dataset of rwmf.simulate with an interval, "
            "simulate(case, dt=0.01)"
        )
    names = list(variables or panels_of(dataset))
    panels = styles.make_panels(axes, len(names))
    for ax, name in zip(panels, names, strict=True):
        _draw_panel(ax, dataset, name, case, line)
    _mark_end(panels, dataset)
    _explain_impacts(panels[-1], dataset)
    panels[-1].set_xlabel("time $t$ (s)")
    return panels


def panels_of(dataset: xr.Dataset) -> list[str]:
    """Return the default panels of `history` for a dataset, forces in N where it has them."""
    names = [name for name in PANELS if members(dataset, name)]
    forces = [name.partition("_over_")[0] for name in names]
    found = [force if force in dataset else name for name, force in zip(names, forces, strict=True)]
    return [name for name in found if name != "u_s" or _FLOORS not in found]


def _draw_panel(
    ax: Axes, dataset: xr.Dataset, name: str, case: Case | None, line: dict[str, Any]
) -> None:
    """Draw the lines of one panel, their labels, and the levels behind them."""
    name = _NUMBERED.get(name, name)
    found = [member for member in members(dataset, name) if "time" in dataset[member].dims]
    if not found:
        raise InputError(f"{name}: is not in the history")
    factor = 100.0 if name == _DRIFTS else 1.0
    for i, member in enumerate(found):
        # from the ground upwards; a panel of one variable needs no label
        line_style = (
            styles.storey(i, len(found)) | {"label": str(i + 1) if len(found) > 1 else None} | line
        )
        ax.plot(dataset["time"], factor * dataset[member], **line_style)
    if case is not None and name == _DRIFTS:
        draw_levels(ax, levels_of_storeys(dataset, case, len(found)), factor, "%")
    elif case is not None and name == "u_s" and case.storeys is None:
        draw_levels(ax, levels_of_frame(dataset, case), factor, "m")
    if len(found) > 1:
        title, columns = name.split("_")[0], -(-len(found) // _ROWS)
        styles.legend_beside(ax, title, columns, is_tight=True)
    ax.set_ylabel(_axis_label(ax, dataset[found[0]], name))
    ax.margins(x=0)
    _mark_impacts(ax, dataset)


def _mark_end(panels: np.ndarray, dataset: xr.Dataset) -> None:
    """Mark the overturning or collapse that ends the motion."""
    if "event_time" not in dataset.coords:
        return
    ends = np.flatnonzero(np.isin(dataset["event"].values, ENDINGS))
    for k in ends[-1:]:
        t, kind = float(dataset["event_time"][k]), str(dataset["event"].values[k])
        for ax in panels:
            ax.axvline(t, **styles.LIMIT)
        panels[0].set_title(
            f"{styles.plain(kind)} at {t:.2f} s", color=styles.COLOURS[1], loc="left"
        )


def members(dataset: xr.Dataset, name: str) -> list[str]:
    """Return the variables of a panel."""
    numbered = (name.format(i=i) for i in count(1))
    found = list(takewhile(lambda member: member in dataset, numbered)) if "{i}" in name else [name]
    return [member for member in found if member in dataset]


@checked
def spectrum(
    dataset: xr.Dataset,
    ax: Axes | None = None,
    bare: xr.Dataset | None = None,
    quantities: str | Sequence[str] | None = None,
    *,
    legend: bool = True,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> Axes:
    """Draw the largest displacement of the frame, or another quantity, against the period.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.spectrum`; one line for each mass ratio and half width.
    ax : matplotlib axes, optional
        Axes to draw in; otherwise a new figure.
    bare : xarray.Dataset, optional
        Spectrum of the frame without wall, drawn dotted for comparison.
    quantities : str, optional
        Variable of the dataset; otherwise ``u_s_max``, or the first variable without it.
    legend : bool
        Add a legend beside the axes for several lines.
    **line
        Arguments of ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. Crosses mark ordinates that overturned or collapsed, at the upper edge for
        rotations of overturned walls; failed ordinates are gaps.

    Raises
    ------
    InputError
        When the dataset or `bare` has no such quantity.
    """
    dataset_of(dataset, "rwmf.spectrum", "T_s", "status")
    others = [str(name) for name in dataset["status"].dims if name not in AXES]
    if others:
        raise InputError(
            f"dataset: has the dimension {others[0]}: must be the dataset of rwmf.spectrum, or of "
            f"one motion, dataset.isel({others[0]}=0)"
        )
    if bare is not None:
        dataset_of(bare, "rwmf.spectrum", "T_s", "status")
    if quantities is not None and len(quantities) != 1:
        raise InputError("plot.spectrum: quantities: must be one quantity")
    usual = "u_s_max" if "u_s_max" in dataset else str(next(iter(dataset.data_vars)))
    quantity = usual if quantities is None else str(quantities[0])
    if quantity not in dataset:
        names = ", ".join(str(name) for name in dataset.data_vars if name != "status")
        raise InputError(f"{quantity}: is not in the spectrum, which has {names}")
    if bare is not None and (quantity not in bare or bare[quantity].dims != ("T_s",)):
        raise InputError(f"bare: must be a spectrum of the frame alone, with {quantity} over T_s")
    axes: Axes = styles.make_panels(ax, 1)[0]
    curves = _curves(dataset)
    for i, (label, curve) in enumerate(curves):
        line_style = {**styles.series(i, len(curves)), "label": label or None} | line
        status = curve["status"].values
        # those of a sweep are numbers
        if names_of_status := str(curve["status"].attrs.get("flag_meanings", "")).split():
            status = np.array(names_of_status)[status]
        has_fallen = np.isin(status, ENDINGS)
        periods, values = curve["T_s"].values, curve[quantity].values
        # the rotation of an overturned wall is meaningless: crosses at the upper edge
        on_side = (status == ENDINGS[0]) & (quantity == _ROTATION)
        (drawn,) = axes.plot(periods, np.where(on_side, np.nan, values), **line_style)
        cross: dict[str, Any] = {"color": drawn.get_color(), "markersize": 4}
        inside = has_fallen & ~on_side
        axes.plot(periods[inside], values[inside], "x", **cross)
        if on_side.any():
            cross |= {"transform": axes.get_xaxis_transform(), "clip_on": False}
            axes.plot(periods[on_side], np.ones(on_side.sum()), "x", **cross)
    if bare is not None:
        axes.plot(bare["T_s"], bare[quantity], label="frame alone", **styles.ALONE)
    axes.set_xlabel(styles.period_label(dataset["T_s"]))
    drawn_values = dataset[quantity]
    axes.set_ylabel(_axis_label(axes, drawn_values, quantity, _LETTERS_ALONE))
    if not (dataset[quantity] < 0).any():
        axes.set_ylim(bottom=0)
    axes.margins(x=0)
    if legend and (len(curves) > 1 or bare is not None):
        styles.legend_beside(axes, _legend_title(dataset))
    return axes


def _curves(dataset: xr.Dataset) -> list[tuple[str, xr.Dataset]]:
    """Return the lines of a spectrum with labels; a parameter with one value needs none."""
    dims = [name for name in ("b", "gamma") if name in dataset.dims]
    curves = []
    for place in product(*(range(dataset.sizes[name]) for name in dims)):
        curve = dataset.isel(dict(zip(dims, place, strict=True)))
        several = {name: float(curve[name]) for name in dims if dataset.sizes[name] > 1}
        parts = [f"{several['gamma']:g}"] if "gamma" in several else []
        parts += [f"b = {several['b']:g} m"] if "b" in several else []
        curves.append((", ".join(parts), curve))
    return curves


def _legend_title(dataset: xr.Dataset) -> str | None:
    if dataset.sizes.get("gamma", 0) < 2:
        return None
    is_plain = dataset["gamma"].attrs.get("long_name") in (None, AXES["gamma"].meaning)
    return r"$\gamma = m_s/m_w$" if is_plain else r"$\gamma$"


def _times_of_impacts(dataset: xr.Dataset) -> tuple[list[float], int]:
    """Return times for ticks that do not merge to a bar [s], and the number of impacts."""
    if "event_time" not in dataset.coords:
        return [], 0
    times = dataset["event_time"].values[dataset["event"].values == "impact"]
    apart = _APART * float(np.ptp(dataset["time"].values))
    shown: list[float] = []
    for t in times:
        if not shown or t - shown[-1] >= apart:
            shown.append(float(t))
    return shown, times.size


def _mark_impacts(ax: Axes, dataset: xr.Dataset) -> None:
    times, _ = _times_of_impacts(dataset)
    if not times:
        # an unclipped line without points has no extent that a layout could use
        return
    ax.plot(
        times,
        np.zeros(len(times)),
        "|",
        color=styles.GREY,
        markersize=5,
        markeredgewidth=0.6,
        transform=ax.get_xaxis_transform(),
        clip_on=False,
        zorder=3,
    )


def _explain_impacts(ax: Axes, dataset: xr.Dataset) -> None:
    """Add a legend for the ticks of impacts, below the axes and beside other legends."""
    from matplotlib.legend import Legend
    from matplotlib.lines import Line2D

    times, n = _times_of_impacts(dataset)
    if not n:
        return
    label = "impact" if n == len(times) else f"one or more of {n} impacts"
    tick = Line2D([], [], color=styles.GREY, marker="|", linestyle="none", markersize=5)
    legend = Legend(
        ax, [tick], [label], loc="upper right", bbox_to_anchor=(1.0, -0.2),
        borderpad=0.0, handletextpad=0.0, frameon=False,
    )  # fmt: skip
    ax.add_artist(legend).set_clip_on(False)


def _axis_label(ax: Axes, variable: xr.DataArray, name: str, letters: int = _LETTERS) -> str:
    """Return the words for a variable, with the unit of the axis, in short lines."""
    unit = styles.label_in_large_units(ax.yaxis, variable.attrs.get("units", ""))
    unit = _UNITS.get(unit, styles.plain(unit))
    words = _WORDS.get(name) or styles.plain(
        variable.attrs.get("long_name", name.replace("_", " "))
    )
    text = f"{words} ({unit})" if unit else str(words)
    # a formula has no space at which a line could end
    length = len(re.sub(r"[\\${}_]|dot|theta", "", text))
    return text if length <= letters else textwrap.fill(text, letters, break_long_words=False)
