"""Histories and spectra: axes in, axes out. Nothing here simulates."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from rwmf.plotting.style import make_panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["PANELS", "history", "spectrum"]

# what `history` shows when it is not told, from top to bottom
PANELS = (
    "theta",
    "theta_dot",
    "u_s",
    "cable_force_over_m_w_g",
    "frame_force_over_m_s_g",
    "fuse_left_force_over_m_w_g",
    "fuse_right_force_over_m_w_g",
)
_SYMBOLS = {
    "theta": r"$\theta$",
    "theta_dot": r"$\dot\theta$",
    "theta_ddot": r"$\ddot\theta$",
    "u_s": r"$u_s$",
    "u_s_dot": r"$\dot u_s$",
    "u_s_max": r"$u_{s,\max}$",
    "theta_max_over_alpha": r"$\theta_{\max}/\alpha$",
    "theta_dot_max": r"$\dot\theta_{\max}$",
    "u_g_ddot": r"$\ddot u_g$",
    "cable_force_over_m_w_g": r"$P/(m_w g)$",
    "cable_force": r"$P$",
    "frame_force_over_m_s_g": r"$F_s/(m_s g)$",
    "fuse_left_force_over_m_w_g": r"$F_l/(m_w g)$",
    "fuse_right_force_over_m_w_g": r"$F_r/(m_w g)$",
}
_UNITS = {"rad/s2": "rad/s²", "m/s2": "m/s²", "1": ""}
# the dark end of viridis: the order of the lines is readable in grey and by colour-blind readers
_DARKEST, _LIGHTEST = 0.0, 0.82
_WIDEST, _NARROWEST = 2.6, 1.1
_BARE_COLOUR = "0.45"
# ordinates whose motion ended before its time
_FALLEN = ("overturned", "collapsed")


def history(
    dataset: xr.Dataset,
    axes: Axes | Sequence[Axes] | np.ndarray | None = None,
    variables: Sequence[str] | None = None,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> np.ndarray:
    """Draw variables against time, one panel each; impacts are ticks at the bottom.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate`, with a history.
    axes : matplotlib axes or sequence of axes, optional
        One for each variable; otherwise a new figure.
    variables : sequence of str, optional
        Names of variables over time; otherwise rotation, angular velocity, displacement and
        forces of cable, frame and fuses, as far as the dataset has them.
    **line
        Arguments of ``Axes.plot``, for example ``label``.

    Returns
    -------
    numpy.ndarray, shape (panels,)
        The axes.

    Raises
    ------
    ValueError
        When the dataset has no history, or when axes and variables differ in number.
    """
    if "time" not in dataset.coords:
        raise ValueError("no history to plot: simulate with an interval, simulate(case, dt=0.01)")
    names = list(variables or [name for name in PANELS if name in dataset])
    panels = make_panels(axes, len(names))
    time = dataset["time"].values
    for ax, name in zip(panels, names, strict=True):
        ax.plot(time, dataset[name].values, **({"color": "C0"} | line))
        ax.set_ylabel(_axis_label(dataset[name]))
        ax.margins(x=0)
        _mark_impacts(ax, dataset)
    panels[-1].set_xlabel("$t$ (s)")
    return panels


def spectrum(
    dataset: xr.Dataset,
    ax: Axes | None = None,
    bare: xr.Dataset | None = None,
    quantity: str = "u_s_max",
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> Axes:
    """Draw the largest displacement of the frame, or another quantity, against its period.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.spectrum`; one line for each mass ratio and half width.
    ax : matplotlib axes, optional
        Where to draw; otherwise a new figure.
    bare : xarray.Dataset, optional
        Spectrum of the frame without wall, drawn dashed for comparison.
    quantity : str
        Variable of the dataset.
    **line
        Arguments of ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. Ordinates that overturned or collapsed are crosses; failed ones are gaps.

    Raises
    ------
    ValueError
        When the dataset has no such quantity.
    """
    if quantity not in dataset:
        names = ", ".join(str(name) for name in dataset.data_vars if name != "status")
        raise ValueError(f"{quantity}: is not in the spectrum, which has {names}")
    axes: Axes = make_panels(ax, 1)[0]
    curves = _curves(dataset)
    shades = np.linspace(_DARKEST, _LIGHTEST, max(len(curves), 2))
    # a line under one that coincides with it stays visible when it is wider
    widths = np.linspace(_WIDEST if len(curves) > 1 else _NARROWEST, _NARROWEST, len(curves))
    for shade, width, (label, curve) in zip(shades, widths, curves, strict=False):
        colour = _viridis(float(shade))
        axes.plot(
            curve["T_s"],
            curve[quantity],
            **({"color": colour, "linewidth": width, "label": label or None} | line),
        )
        fallen = curve.isel(T_s=np.flatnonzero(np.isin(curve["status"].values, _FALLEN)))
        axes.plot(fallen["T_s"], fallen[quantity], "x", color=colour, markersize=4)
    if bare is not None:
        axes.plot(
            bare["T_s"],
            bare[quantity],
            color=_BARE_COLOUR,
            linestyle=(0, (4, 2)),
            label="frame alone",
            zorder=1,
        )
    axes.set_xlabel("$T_s$ (s)")
    axes.set_ylabel(_axis_label(dataset[quantity]))
    if not (dataset[quantity] < 0).any():
        axes.set_ylim(bottom=0)
    axes.margins(x=0)
    if len(curves) > 1 or bare is not None:
        # beside the axes: it cannot hide data there
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), title=_legend_title(dataset))
    return axes


def _curves(dataset: xr.Dataset) -> list[tuple[str, xr.Dataset]]:
    """Lines of a spectrum with their labels; a parameter with one value needs none."""
    if "gamma" not in dataset.dims:
        return [("", dataset)]
    several_b = dataset.sizes["b"] > 1
    several_gamma = dataset.sizes["gamma"] > 1
    curves = []
    for i, b in enumerate(dataset["b"].values):
        for j, gamma in enumerate(dataset["gamma"].values):
            parts = [f"{gamma:g}"] if several_gamma else []
            parts += [f"b = {b:g} m"] if several_b else []
            curves.append((", ".join(parts), dataset.isel(b=i, gamma=j)))
    return curves


def _legend_title(dataset: xr.Dataset) -> str | None:
    return r"$\gamma = m_s/m_w$" if dataset.sizes.get("gamma", 0) > 1 else None


def _mark_impacts(ax: Axes, dataset: xr.Dataset) -> None:
    if "event_time" not in dataset.coords:
        return
    times = dataset["event_time"].values[dataset["event"].values == "impact"]
    ax.plot(
        times,
        np.zeros(times.size),
        "|",
        color="0.5",
        markersize=5,
        markeredgewidth=0.6,
        transform=ax.get_xaxis_transform(),
        clip_on=False,
        zorder=3,
    )


def _axis_label(variable: xr.DataArray) -> str:
    name = str(variable.name)
    unit = variable.attrs.get("units", "")
    unit = _UNITS.get(unit, unit)
    return _SYMBOLS.get(name, name.replace("_", " ")) + (f" ({unit})" if unit else "")


def _viridis(x: float) -> tuple[float, float, float, float]:
    import matplotlib

    return matplotlib.colormaps["viridis"](x)
