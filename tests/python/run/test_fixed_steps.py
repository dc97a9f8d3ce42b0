"""Fixed steps of common practice converge to the kernel's result, each method with its order."""

import math

import pytest
import rwmf
from rwmf.kernel.measure import measure_fixed_steps, measure_method
from scenes import bare_frame, block, coupled

NAMES = ("rk4", "newmark")


def _end_error(case: rwmf.Case, name: str, divisor: float) -> float:
    """Error of the rotation or displacement at the end over the largest one."""
    trusted = measure_method(case, "dop853", 1e-13, 0.0).values
    found = measure_fixed_steps(case, name, divisor, 0.0).values
    largest = trusted["u_s_max_m"]
    if not math.isnan(trusted["theta_max_rad"]):
        largest = trusted["theta_max_rad"]
    return abs(found["theta_end_rad"] - trusted["theta_end_rad"]) / largest


@pytest.mark.parametrize("name", NAMES)
def test_first_order_at_impacts(name: str) -> None:
    """An impact at the end of its step causes an error of the order of the step."""
    case = coupled(model={"formulation": "exact"}, solver={"t_end": 3.0})
    coarse, fine = (_end_error(case, name, divisor) for divisor in (10.0, 1000.0))
    # the missed part of a step differs from impact to impact, so the ratio is not exactly 100
    assert 20 < coarse / fine < 500
    assert fine < 1e-3


@pytest.mark.parametrize(("name", "order"), [("rk4", 4.0), ("newmark", 2.0)])
def test_order_without_impacts(name: str, order: float) -> None:
    # before the jump at the end of the pulse
    case = bare_frame(solver={"t_end": 0.9}, frame={"T_s": 0.7})
    coarse, fine = (_end_error(case, name, divisor) for divisor in (1.0, 2.0))
    assert math.log2(coarse / fine) == pytest.approx(order, abs=0.2)


@pytest.mark.parametrize("name", NAMES)
def test_rest(name: str) -> None:
    """A weak motion causes no uplift; a free block comes to rest."""
    weak = measure_fixed_steps(coupled(motion={"a_max_g": 0.001}), name, 1.0, 0.0)
    assert (weak.steps, weak.values["theta_max_rad"], weak.values["t_end_s"]) == (0, 0.0, 10.0)
    case = block(initial={"theta_over_alpha": 0.3}, impact={"rule": "housner", "e": None})
    free = measure_fixed_steps(case.replace(solver={"t_end": 30.0}), name, 10.0, 0.0)
    # the overshoot at an impact adds energy: walls with fixed steps may rattle forever
    assert abs(free.values["theta_end_rad"]) < 1e-3
    assert free.impacts > 5


@pytest.mark.parametrize("name", NAMES)
def test_overturning(name: str) -> None:
    strong = block(motion={"kind": "one_sine", "a_max_g": 1.5, "omega_p": 3.0})
    found = measure_fixed_steps(strong, name, 1.0, 0.0)
    assert found.overturned
    assert found.values["t_end_s"] < 10


def test_step() -> None:
    """The step is a hundredth of the pulse's period over the divisor."""
    found = measure_fixed_steps(coupled(motion={"T_p": 2.0, "omega_p": None}), "rk4", 4.0, 0.0)
    assert found.dt == pytest.approx(0.005, rel=1e-15)
