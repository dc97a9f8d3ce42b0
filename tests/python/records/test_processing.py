"""Corrections of records: what each step does, in closed form, and what the file says."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import Runner
from refused import refusals

DT = 0.01
T = DT * np.arange(4001)


def _motion(values: np.ndarray) -> rwmf.Motion:
    return rwmf.Motion(values, dt=DT, unit="m/s2", name="test")


@pytest.mark.parametrize(
    ("frequency", "gain"),
    # twice through a filter of four poles at 1 and 10 Hz: a half at a corner, unity between
    [(1.0, 0.5), (10.0, 0.5), (3.16, 1.0)],
)
def test_filter_halves_the_amplitude_at_a_corner_and_shifts_nothing(
    frequency: float, gain: float
) -> None:
    wave = np.sin(2 * np.pi * frequency * T)
    found = rwmf.records.process(_motion(wave), band=(1.0, 10.0), poles=4)
    n = (found.motion.values.size - T.size) // 2
    # zeros of 1.5 poles over the lower corner, half at each end
    assert n == pytest.approx(0.5 * 1.5 * 4 / 1.0 / DT, abs=1)
    middle = slice(n + 1500, n + 2500)
    filtered = found.motion.values[middle]
    assert filtered == pytest.approx(gain * wave[1500:2500], abs=0.01)
    assert "Butterworth, 4 poles, 1 to 10 Hz" in found.steps[0]


@pytest.mark.parametrize("order", [0, 1, 3])
def test_baseline_of_its_order_goes_and_the_rest_stays(order: int) -> None:
    drift = np.polynomial.Polynomial(0.1 * (-0.3) ** np.arange(order + 1))(T / T[-1])
    gone = rwmf.records.process(_motion(drift), baseline=order).motion.values
    assert np.abs(gone).max() < 2e-6, "velocities are integrated on straight lines"
    quake = np.sin(7.0 * T) * np.exp(-0.1 * T)
    once = rwmf.records.process(_motion(quake + drift), baseline=order).motion
    alone = rwmf.records.process(_motion(quake), baseline=order).motion
    assert once.values == pytest.approx(alone.values, abs=2e-6), "linear"
    again = rwmf.records.process(once, baseline=order).motion
    assert again.values == pytest.approx(once.values, abs=1e-6)


def test_samples_are_taken_from_the_straight_lines() -> None:
    uneven = rwmf.Motion([0.0, 1.0, -1.0, 0.5], times=[0.0, 0.1, 0.25, 0.3], unit="g", name="u")
    with pytest.raises(rwmf.InputError, match="uneven: resample is needed"):
        rwmf.records.process(uneven, baseline=0)
    found = rwmf.records.process(uneven, resample=0.05)
    assert found.motion.values == pytest.approx([0.0, 0.5, 1.0, 1 / 3, -1 / 3, -1.0, 0.5])
    assert found.steps == ("resampled on straight lines to dt = 0.05 s",)
    with pytest.raises(rwmf.InputError, match=r"above the interval of 0\.01 s"):
        rwmf.records.process(_motion(np.sin(T)), resample=0.02)


def test_taper_leaves_the_middle() -> None:
    found = rwmf.records.process(_motion(np.ones(T.size)), taper=2.0).motion.values
    assert found[0] == found[-1] == 0.0
    assert found[100] == found[-101] == pytest.approx(0.5)
    assert (found[200:-200] == 1.0).all()


test_steps_that_no_record_takes = refusals(
    lambda words: rwmf.records.process(_motion(np.sin(T)), **words),
    ({}, "no step is given"),
    ({"band": (5.0, 1.0)}, "rising frequencies"),
    ({"band": (0.0, np.inf)}, "rising frequencies"),
    ({"band": (0.1, 50.0)}, "half of the sampling frequency, 50 Hz"),
    ({"taper": 30.0}, "half of the record"),
)


def test_the_file_lists_its_steps_and_is_read_as_it_is(command: Runner, tmp_path: Path) -> None:
    raw = _motion(np.sin(7.0 * T) * np.exp(-0.1 * T) + 0.01)
    raw.write(tmp_path / "raw.txt")
    words = ["raw.txt", "--unit", "m/s2,0.01", "--out", "new.txt"]
    steps = ["--resample", "0.005", "--baseline", "1", "--taper", "1", "--band", "0.1:"]
    found = command("records", "convert", *words, *steps)
    assert found.returncode == 0, found.stderr
    expected = rwmf.records.process(raw, resample=0.005, baseline=1, taper=1.0, band=(0.1, np.inf))
    header = [x for x in (tmp_path / "new.txt").read_text().splitlines() if x.startswith("# ")]
    assert header[0].startswith("# raw, from raw.txt (CRC-32 ")
    assert [x.split(". ", 1)[1] for x in header[1:5]] == list(expected.steps)
    # unit and interval are in the file
    read = rwmf.records.read(tmp_path / "new.txt")
    assert (read.unit, read.dt) == ("m/s2", 0.005)
    assert np.array_equal(read.values, expected.motion.values)
    assert [line for line in found.stdout.splitlines() if line[:2] in ("1.", "2.", "3.", "4.")]
    found = command("records", "convert", *words[:3], *steps, "--force", "--out", "raw.txt")
    assert found.returncode == 2 and "is read by this run" in found.stderr
    case = rwmf.Case.from_text(
        f"&frame T_s = 1.0, xi_s = 0.05 /\n&motion kind = 'record', file = '{tmp_path}/new.txt' /"
    )
    assert case.kernel.end_of_motion() == pytest.approx(read.times[-1])
