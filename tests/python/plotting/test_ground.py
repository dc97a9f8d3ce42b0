"""The figure of a ground motion has the spectrum of the kernel's linear frame."""

from __future__ import annotations

import numpy as np
import pytest
import rwmf
from scenes import bare_frame

pytest.importorskip("matplotlib")

PERIODS = np.array([0.05, 0.1, 0.3, 0.7, 1.5, 3.0])


@pytest.mark.parametrize("damping", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("unit", ["g", "m/s2", "cm/s2"])
def test_spectrum_is_that_of_the_kernel(damping: float, unit: str) -> None:
    """A motion in any unit, and the dataset of a run."""
    factor = {"g": 9.81, "m/s2": 1.0, "cm/s2": 0.01}[unit]
    t = np.arange(400) * 0.02
    values = np.exp(-0.2 * t) * np.sin(9.0 * t) * np.sin(0.7 * t) * 3.0 / factor
    motion = rwmf.Motion(values, dt=0.02, unit=unit, name="made up")
    case = bare_frame(frame={"xi_s": damping}, solver={"t_end": t[-1]}).replace(motion=motion)
    expected = rwmf.spectrum(case, T_s=PERIODS)["u_s_max"].values * (2 * np.pi / PERIODS) ** 2
    for item in (motion, rwmf.simulate(case, dt=0.02)):
        over_time, over_period = rwmf.plot.ground_motion(item, T_s=PERIODS, damping=damping)
        drawn = over_period.lines[0].get_ydata()
        assert drawn == pytest.approx(expected, rel=1e-7)
        assert over_time.lines[0].get_ydata()[:400] == pytest.approx(factor * values, abs=1e-12)
        assert f"peak {np.abs(values).max() * factor / 9.81:.3g} g" in over_time.get_title()


def test_refusals() -> None:
    run = rwmf.simulate(bare_frame())
    with pytest.raises(rwmf.InputError, match="must be the dataset of"):
        rwmf.plot.ground_motion(run)
    motion = rwmf.Motion([0.0, 1.0], dt=0.1, unit="g")
    for words, message in (({"damping": 1.0}, "damping = 1"), ({"T_s": [0.0]}, "T_s")):
        with pytest.raises(rwmf.InputError, match=message):
            rwmf.plot.ground_motion(motion, **words)  # type: ignore[arg-type]
