"""Content of figures: all lines inside the axes and distinct; plotting never simulates."""

from __future__ import annotations

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.legend import Legend
from rwmf.figures.histories import members
from rwmf.figures.styles import COLOURS, make_panels, new_figure, series, tint


def test_coinciding_lines_differ_twice() -> None:
    for n in range(2, 13):
        looks = [series(i, n) for i in range(n)]
        assert len({look["color"] for look in looks}) == n
        assert len({str(look["linestyle"]) for look in looks}) == min(n, 6)
        widths = [look["linewidth"] for look in looks]
        assert widths == sorted(widths, reverse=True)
        assert min(-np.diff(widths)) > (0.3 if n <= 6 else 0.1)
        assert [look["zorder"] for look in looks] == sorted(look["zorder"] for look in looks)


def test_a_history_shows_the_ground_and_every_storey() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "storeys_full.nml")
    run = rwmf.simulate(case, dt=0.05)
    assert members(run, "floor_{i}") == [f"floor_{i}" for i in range(1, 6)]
    assert members(run, "storey_{i}_drift") == [f"storey_{i}_drift" for i in range(1, 6)]
    assert members(run, "nowhere_{i}") == []
    panels = rwmf.plot.history(run)
    labels = [ax.get_ylabel() for ax in panels]
    assert labels[0] == "ground acceleration\n" r"$\ddot u_g$ (m/s²)"
    assert panels[-1].get_xlabel() == "time $t$ (s)"
    legends = [item for item in panels[-1].get_children() if isinstance(item, Legend)]
    assert ["impact"] in [[text.get_text() for text in item.get_texts()] for item in legends]
    assert "floor displacement\n$u_i$ (m)" in labels
    drifts = panels[labels.index("interstorey drift\n(%)")].get_legend()
    assert drifts.get_title().get_text() == "storey"
    assert [text.get_text() for text in drifts.get_texts()] == ["1", "2", "3", "4", "5"]
    for name, same in (("storeys_drift", "storey_{i}_drift"), ("floors", "floor_{i}")):
        (ax,), (other,) = (rwmf.plot.history(run, variables=[word]) for word in (name, same))
        assert [line.get_label() for line in ax.lines] == [line.get_label() for line in other.lines]
        assert ax.get_ylabel() == other.get_ylabel()
    for name in ("nowhere", "u_s_max", "floor", "storeys_drift_max"):
        with pytest.raises(ValueError, match=f"{name}: is not in the history"):
            rwmf.plot.history(run, variables=[name])


def test_forces_are_in_kn_and_ticks_of_many_impacts_apart() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig12_one_cosine.nml")
    run = rwmf.simulate(case, dt=0.05)
    labels = [ax.get_ylabel() for ax in rwmf.plot.history(run)]
    assert "tendon force $P/(m_wg)$" in labels
    wall = {"density": 2500.0, "thickness": 0.3}
    heavy = rwmf.simulate(case.replace(wall=wall), dt=0.05)
    panels = rwmf.plot.history(heavy)
    labels = [ax.get_ylabel() for ax in panels]
    force = panels[labels.index("tendon force $P$ (kN)")]
    assert force.lines[0].get_ydata() == pytest.approx(heavy["cable_force"].values)
    assert force.yaxis.get_major_formatter()(2.0e3) == "2"
    n = int((heavy["event"] == "impact").sum())
    ticks = force.lines[-1].get_xdata()
    assert n > 100 > ticks.size > 1
    assert np.diff(ticks).min() >= float(heavy["time"][-1]) / 120
    legends = [item for item in panels[-1].get_children() if isinstance(item, Legend)]
    assert legends[0].get_texts()[0].get_text() == f"one or more of {n} impacts"


def _areas(ax: Axes) -> dict[tuple[float, ...], float]:
    """Area of the regions of a map by their colour."""
    found: dict[tuple[float, ...], float] = {}
    for region in ax.collections:
        assert isinstance(region, PolyCollection)
        colour = tuple(np.round(region.get_facecolor()[0][:3], 6))
        for path in region.get_paths():
            x, y = path.vertices.T
            area = 0.5 * abs(float(np.dot(x, np.roll(y, 1)) - np.dot(y, np.roll(x, 1))))
            found[colour] = found.get(colour, 0.0) + area
    return found


def test_regions_of_a_map_fill_it() -> None:
    """No gap and no overlap, whatever begins and ends between two frequencies."""
    outcomes = ((-1, 0), (-1, 1, -1, 0), (-1, 1, -1), (-1, 1, -1), (-1,))
    edges = ((2.0,), (1.5, 2.5, 3.0), (2.0, 3.5), (2.5, 3.8), ())
    omegas = np.arange(1.0, 6.0)
    scanned = np.array([[row[0], row[-1]] for row in outcomes])
    dataset = xr.Dataset(
        {
            "outcome": (("omega_over_p", "amplitude"), scanned),
            "boundary_omega_over_p": ("boundary", np.repeat(omegas, [len(row) for row in edges])),
            "boundary_amplitude": ("boundary", [y for row in edges for y in row]),
            "above": ("boundary", [x for row in outcomes for x in row[1:]]),
            "alpha": 0.25,
            "p": 1.9,
        },
        {"omega_over_p": omegas, "amplitude": [1.0, 4.0]},
        {"pulse": "one_sine"},
    )
    with new_figure(3.0) as figure:
        ax = rwmf.plot.overturning_map(dataset, figure.subplots())
        areas = _areas(ax)
        assert ax.get_title(loc="left") == r"$\alpha$ = 0.25 rad, $p$ = 1.9 rad/s, one-sine"
    assert len(areas) == 3
    assert sum(areas.values()) == pytest.approx(4.0 * 3.0)
    # from the middle of the first interval to that of the last, in which it ends below the top
    colour = tuple(np.round(to_rgb(tint(COLOURS[1], 0.5)), 6))
    assert areas[colour] == pytest.approx(0.5 * 1.0 + 1.25 + 1.4 + 0.5 * 1.3)


def test_a_map_says_its_wall_and_its_pulse() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "study_ricker.nml")
    found = rwmf.studies.overturning_map(case, [3.0], [0.5, 1.0], tolerance=0.1)
    assert float(found["e"]) == float(rwmf.simulate(case)["e"])
    assert found.attrs["pulse"] == "ricker"


def test_panels_are_as_many_as_axes() -> None:
    with new_figure(3.0) as figure, pytest.raises(ValueError, match="2 axes for 3 panels"):
        make_panels(figure.subplots(1, 2), 3)


def test_a_spectrum_with_a_wall_is_not_the_frame_alone() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig12_one_sine.nml")
    both = rwmf.spectrum(case, T_s=[0.5, 1.0], gamma=5.0, quantities=["u_s_max", "impacts"])
    alone = rwmf.spectrum(case.without_wall(), T_s=[0.5, 1.0])
    for bare, name in ((both, "u_s_max"), (alone, "impacts")):
        with pytest.raises(rwmf.InputError, match=f"bare: .* alone, with {name} over T_s"):
            rwmf.plot.spectrum(both, bare=bare, quantities=name)
    assert len(rwmf.plot.spectrum(both, bare=alone).lines) == 3


def test_forces_of_spectra_are_labelled_in_kilonewtons() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "six_storeys_by_dimensions.nml")
    found = rwmf.spectrum(case, quantities=["base_shear_max_N"], T_s=[0.6, 1.0])
    (name,) = (str(key) for key in found if str(key).startswith("base_shear_max"))
    with new_figure(6.0) as figure:
        ax = rwmf.plot.spectrum(found, ax=figure.subplots())
        figure.canvas.draw()
        assert ax.get_ylabel().endswith("(kN)")
        np.testing.assert_array_equal(ax.lines[0].get_ydata(), found[name].squeeze())
        labels = {tick.get_text(): tick.get_position()[1] for tick in ax.get_yticklabels()}
        assert labels["1000"] == 1e6


def test_an_acceleration_has_its_unit_in_the_label() -> None:
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig12_one_cosine.nml")
    found = rwmf.studies.equal_response(
        case.replace(spectrum=None), [1.0, 1.5], 1.0, tolerance=1e-2,
        quantities="floor_acceleration_max_g",
    )  # fmt: skip
    with new_figure(6.0) as figure:
        ax = rwmf.plot.equal_response(found, figure.subplots())
        assert ax.get_ylabel().endswith("floor acceleration = 1 g")
