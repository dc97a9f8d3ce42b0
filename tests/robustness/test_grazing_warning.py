"""A wall that turns back at or slightly above its base: the run warns of the decision."""

import pytest
import rwmf

# Far shorter than the period: the wall is back at its base as the pulse ends, and comes down with
# hardly any velocity or does not come down at all.
SHORT_PULSE = """
&wall b = 11.76, h = 31.93 /
&frame gamma = 1.18e7, T_s = 15.43, xi_s = 0 /
&cable eta_0 = 0, eta_alpha = 0.283 /
&impact rule = 'constant', e = 0 /
&motion kind = 'one_cosine', a_max_g = 0.0991, T_p = 0.00876 /
&model formulation = 'published' /
&solver t_end = 46.3, method = '{method}', rtol = {rtol} /
"""

BOUNCING = """
&wall b = 0.5, h = 2.0 /
&impact rule = 'constant', e = 0.7 /
&motion kind = 'none' /
&initial theta_over_alpha = 0.5 /
&solver t_end = 20.0, method = '{method}', rtol = 1e-6 /
"""

METHODS = ["dop853", "taylor", "adams", "bdf"]


def is_warned(text: str) -> bool:
    """Return True for a run that warns of grazing."""
    result = rwmf.simulate(rwmf.Case.from_text(text))
    return "turns back on its base" in result.attrs["warnings"]


@pytest.mark.parametrize("method", METHODS)
def test_a_grazing_wall_is_told_of(method: str) -> None:
    """`adams` errs by 5 % here at this tolerance, the others by less than 1 %."""
    assert is_warned(SHORT_PULSE.format(method=method, rtol=1e-6))


@pytest.mark.parametrize("method", METHODS)
def test_chatter_is_no_grazing(method: str) -> None:
    """Flights that end by themselves turn back at their tops, however low."""
    assert not is_warned(BOUNCING.format(method=method))


@pytest.mark.parametrize("method", ["adams", "bdf"])
def test_multistep_methods_are_told_of_at_tighter_tolerances(method: str) -> None:
    """They err by 1e-3 here at 1e-9."""
    assert is_warned(SHORT_PULSE.format(method=method, rtol=1e-9))


def test_a_tighter_tolerance_decides() -> None:
    """A doubtful result at 1e-9 is certain at 1e-11."""
    assert not is_warned(SHORT_PULSE.format(method="dop853", rtol=1e-11))


@pytest.mark.parametrize(
    ("method", "error"),
    [("dop853", 1e-6), ("taylor", 1e-6), ("adams", 0.1), ("bdf", 0.02)],
)
def test_no_step_jumps_over_a_short_pulse(method: str, error: float) -> None:
    """At rtol 1e-6, against the value at 1e-12: the flight after the pulse is not lost."""
    runs = [
        rwmf.simulate(rwmf.Case.from_text(SHORT_PULSE.format(method=name, rtol=rtol)))
        for name, rtol in ((method, 1e-6), ("dop853", 1e-12))
    ]
    assert int(runs[0]["impacts"]) == int(runs[1]["impacts"])
    assert float(runs[0]["u_s_max"]) == pytest.approx(float(runs[1]["u_s_max"]), rel=error)
