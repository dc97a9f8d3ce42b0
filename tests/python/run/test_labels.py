"""Labels of results: single ones and ranges are found by the decimals that a user writes."""

import math

import numpy as np
import rwmf
from hypothesis import given
from hypothesis import strategies as st
from rwmf.cli.words import numbers
from rwmf.kernel.numbers import short_decimal
from scenes import coupled


def test_ranges_of_the_command_line_are_decimals() -> None:
    assert numbers("0.1:2:20") == [round(0.1 * i, 1) for i in range(1, 21)]
    assert numbers("0.1:3:59") == [round(0.05 * i, 2) for i in range(2, 61)]
    # thirds have no short decimals
    assert numbers("0:1:4") == [float(x) for x in np.linspace(0, 1, 4)]


def test_axes_of_sweeps_and_spectra_are_labels() -> None:
    found = rwmf.sweep(coupled(), {"T_s": numbers("0.1:2:20"), "e": [0.8, 0.9]})
    inner = found.sel(T_s=slice(0.3, 0.8), e=slice(0.85, 1.0))
    assert inner["T_s"].values.tolist() == [0.3, 0.4, 0.5, 0.6, 0.7, 0.8]
    assert inner["e"].values.tolist() == [0.9]
    spectrum = rwmf.spectrum(coupled(), T_s=[0.5, 1.0, 1.5], gamma=[5, 50])
    assert spectrum.sel(T_s=slice(0.5, 1.0), gamma=50)["u_s_max"].squeeze().shape == (2,)
    points = rwmf.sweep(coupled(), points={"T_s": [0.5, 1.0, 1.5], "e": [0.8, 0.85, 0.9]})
    assert points.sel(T_s=slice(0.6, 1.5))["e"].values.tolist() == [0.85, 0.9]


def test_times_and_periods_of_ranges_are_decimals() -> None:
    """In a run, a spectrum and a sweep over the periods of the same group alike."""
    case = coupled(spectrum={"T_s_min": 0.1, "T_s_max": 3.0, "n": 30}, solver={"t_end": 1.0})
    tenths = [round(0.1 * i, 1) for i in range(31)]
    run = rwmf.simulate(case.replace(output={"dt": 0.1}))
    assert run["time"].values.tolist() == tenths[:11]
    assert rwmf.spectrum(case)["T_s"].values.tolist() == tenths[1:]
    assert rwmf.sweep(case, {"e": [0.8]})["T_s"].values.tolist() == tenths[1:]
    log = rwmf.spectrum(
        case.replace(spectrum={"T_s_min": 0.01, "T_s_max": 10.0, "n": 4, "spacing": "log"})
    )
    assert log["T_s"].values.tolist() == [0.01, 0.1, 1.0, 10.0]


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_other_numbers_stay(x: float) -> None:
    """A change is rounding, and a short decimal is its own."""
    found = short_decimal(x)
    assert abs(found - x) <= 4 * math.ulp(x)
    assert short_decimal(found) == found
