"""Ground motions and records over time, with their response spectra."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Motion
from rwmf.case.arguments import checked
from rwmf.errors import InputError
from rwmf.figures import styles
from rwmf.kernel.numbers import Array, to_array
from rwmf.motion.intensity import G
from rwmf.motion.waveform import Waveform, pseudo_accelerations, waveform_of
from rwmf.run.arguments import dataset_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_THIN = 1.0
_HISTORIES = {
    "a": r"$\ddot u_g$ (g)",
    "v": r"$\dot u_g$ (m/s)",
    "u": r"$u_g$ (m)",
}


def draw_records(figure: Figure, records: Mapping[str, Mapping[str, Array]]) -> None:
    """Draw acceleration, velocity, displacement, spectrum and build-up of energy."""
    parts: Any = figure.subfigures(1, 2, width_ratios=[1.5, 1.0])
    left, right = parts
    panels = dict(zip(_HISTORIES, left.subplots(3, 1, sharex=True), strict=True))
    spectrum, energy = right.subplots(2, 1, height_ratios=[1.8, 1.0])
    for i, (name, curves) in enumerate(records.items()):
        look = {"color": styles.COLOURS[i % len(styles.COLOURS)], "lw": _THIN}
        for key, ax in panels.items():
            ax.plot(curves["t"], curves[key], **look)
        energy.plot(curves["t"], curves["energy"], **look)
        spectrum.loglog(curves["periods"], curves["Sa"], label=styles.plain(name), **look)
    for key, label in _HISTORIES.items():
        panels[key].set_ylabel(label)
    panels["u"].set_xlabel("time $t$ (s)")
    energy.set(xlabel="time $t$ (s)", ylabel="Arias share")
    spectrum.set(xlabel="period $T$ (s)", ylabel="$S_a$(5 %) (g)")
    for axis in (spectrum.xaxis, spectrum.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    styles.legend_below(figure, spectrum)


def draw_selection(
    figure: Figure, periods: Array, target: Array, spectra: Array, label: str
) -> None:
    """Draw the scaled spectra of a suite, their geometric mean and the target."""
    ax = figure.subplots()
    for i, spectrum in enumerate(spectra):
        ax.loglog(
            periods, spectrum, color=styles.GREY, lw=0.8, label="components" if i == 0 else None
        )
    mean = np.exp(np.log(spectra).mean(axis=0))
    ax.loglog(periods, mean, color=styles.COLOURS[0], lw=2.0, label="geometric mean")
    ax.loglog(periods, target, **styles.ALONE, label="target")
    ax.set(xlabel="period $T$ (s)", ylabel=label)
    styles.label_plainly(ax.xaxis)
    styles.label_plainly(ax.yaxis)
    ax.legend()


# shortest period of a spectrum [s]
_SHORTEST = 1e-3
_PERIODS = np.geomspace(0.05, 4.0, 120)


@checked
def ground_motion(
    dataset: xr.Dataset | Motion,
    axes: Axes | Sequence[Axes] | np.ndarray | None = None,
    *,
    T_s: Sequence[float] | np.ndarray = _PERIODS,
    damping: float = 0.05,
    **line: Any,  # noqa: ANN401 (as matplotlib)
) -> styles.Panels:
    """Draw a ground acceleration over time, and the pseudo-acceleration of linear oscillators.

    The spectrum is exact for straight lines between the samples, and includes the free vibration
    after them, as that of `rwmf records info`.

    Parameters
    ----------
    dataset : xarray.Dataset or Motion
        From `rwmf.simulate`, with a history that is as fine as the record; or a motion.
    axes : sequence of axes, optional
        Two, for time and for periods; otherwise a new figure.
    T_s : sequence of float
        Periods of the spectrum [s].
    damping : float
        Damping ratio of the spectrum [-].
    **line
        Arguments of ``Axes.plot``, for example ``label``.

    Returns
    -------
    numpy.ndarray, shape (2,)
        The axes. A point marks the peak of the ground. Samples in g are multiples of 9.81 m/s2.

    Raises
    ------
    InputError
        When there is no ground motion, or when a period or the damping is not acceptable.
    """
    wave = _waveform_of(dataset)
    t, a = wave.t, wave.a
    periods = to_array("T_s", T_s, above=_SHORTEST, least=1)
    over_time, over_period = panels = styles.make_panels(axes, 2, across=True)
    look = {"color": styles.COLOURS[0]} | line
    i = int(np.argmax(np.abs(a)))
    over_time.plot(t, a, linewidth=0.8, **look)
    over_time.plot(t[i], a[i], "o", color=look["color"], markersize=4)
    title = f"peak {abs(a[i]) / G:.3g} g at {t[i]:.2f} s"
    over_time.set(title=title, xlabel="time $t$ (s)", ylabel="ground acceleration (m/s²)")
    over_time.margins(x=0)
    over_period.plot(periods, pseudo_accelerations(wave, periods, damping), **look)
    title = f"linear oscillators, damping {100 * damping:g} %"
    over_period.set(title=title, xlabel="period (s)", ylabel="pseudo-acceleration (m/s²)")
    over_period.set(xlim=(0, periods.max()), ylim=(0, None))
    if "label" in look:
        over_period.legend()
    return panels


def _waveform_of(motion: xr.Dataset | Motion) -> Waveform:
    """Return the known part of a ground acceleration."""
    if isinstance(motion, Motion):
        return waveform_of(motion, G)
    dataset = dataset_of(motion, "rwmf.simulate with an interval, or a Motion", "time", "u_g_ddot")
    a = np.asarray(dataset["u_g_ddot"].values, dtype=float)
    known = np.isfinite(a)
    if known.sum() < 2:
        raise InputError("dataset: has fewer than two rows with a ground acceleration")
    return Waveform(np.asarray(dataset["time"].values, dtype=float)[known], a[known])
