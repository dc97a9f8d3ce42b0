"""Derivatives of results: closed forms, keys that follow, bounds, lists, kinks and suites."""

import cmath
import contextlib
import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from random_cases import random_cases
from refused import refusals
from rwmf.assess import lanes
from rwmf.assess.lanes import (
    derivative_at,
    find_parameters,
    offsets_of,
    resolution,
    valid_range,
)
from scenes import bare_frame, coupled

SIX_STOREYS = Path(__file__).parents[3] / "inputs" / "six_storeys_by_dimensions.nml"


def _height_of_ball(g: float, e: float) -> float:
    """Height at 5 s of a ball dropped from 50 m, with bounces."""
    t, v = math.sqrt(100 / g), math.sqrt(100 * g)
    while True:
        v *= e
        if t + 2 * v / g > 5.0:
            return v * (5.0 - t) - g * (5.0 - t) ** 2 / 2
        t += 2 * v / g


@pytest.mark.parametrize(("number", "truth"), [(0, 1.874722712499), (1, 56.524758424985)])
def test_bouncing_ball(number: int, truth: float) -> None:
    point = [9.8, 0.8]
    offsets = offsets_of((True, True))
    values = []
    for offset in offsets:
        moved = list(point)
        moved[number] *= 1 + offset
        values.append(_height_of_ball(*moved))
    found = derivative_at(offsets, np.array(values), _height_of_ball(*point))
    assert found.derivative / point[number] == pytest.approx(truth, rel=1e-9)
    assert not found.is_kink


def test_the_accuracy_of_a_case_does_not_count() -> None:
    case = coupled(solver={"t_end": 1.0})
    found = rwmf.gradient(case, "xi_s", "u_s_max")
    asked = case.replace(solver={"accuracy": 1e-4, "accuracy_of": "u_s_max_m"})
    assert rwmf.gradient(asked, "xi_s", "u_s_max").identical(found)
    with pytest.raises(rwmf.InputError, match="unit = 'ft': must be 'g', 'm/s2' or 'cm/s2'"):
        rwmf.gradient(case, "xi_s", unit="ft")


def test_slopes_that_differ_are_a_kink() -> None:
    offsets = offsets_of((True, True))
    found = derivative_at(offsets, np.maximum(3 * offsets, offsets), 0.0)
    assert found.is_kink
    assert found.derivative == pytest.approx(2.0)
    assert abs(found.jump) == pytest.approx(2.0)
    one_sided = offsets_of((False, True))
    assert (one_sided > 0).all()
    smooth = derivative_at(one_sided, np.exp(2 * one_sided), 1.0)
    assert smooth.derivative == pytest.approx(2.0, rel=1e-9)


def test_differences_of_large_numbers_have_a_coarse_resolution() -> None:
    values = np.linspace(2.0, 2.001, 7) * np.sqrt(2) - 2.8
    assert resolution(values) == pytest.approx(2.0**-51, rel=0)
    assert resolution(np.sqrt(np.linspace(0.2, 0.3, 9))) <= 2.0**-53
    assert resolution(np.array([2.0, 2.0])) == 0.0


def test_range_ends_where_the_prediction_errs_by_a_tenth() -> None:
    """For x + x**2 the error over the smaller of change and prediction is x, for -x x/(1 - x)."""
    offsets = np.array([0.03, 0.1, 0.3, -0.03, -0.1, -0.3])
    found = valid_range(offsets, offsets + offsets**2, 1.0, 0.0)
    assert 0.08 < found <= 1 / 11
    assert valid_range(offsets, 0 * offsets, 0.0, 1e-12) == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("t_end", "energy", "truth"),
    [
        (2.643128, 0.15656237659, -1.53658265203),
        (5.893398, 0.33953402589, -2.20160495891),
        (7.915363, 0.42692086227, -1.75246905806),
    ],
)
def test_energy_lost_by_a_block(t_end: float, energy: float, truth: float) -> None:
    """A block of 2 x 0.5 m let go at 0.6 alpha loses (1 - e**2N) of its energy in N impacts."""
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        impact={"rule": "constant", "e": 0.911764705882},
        initial={"theta_over_alpha": 0.6},
        motion={"kind": "none"},
        model={"formulation": "exact"},
        solver={"t_end": t_end},
        output={"energy": True},
    )
    found = rwmf.gradient(case, "e", "energy_impact_J_per_kg")
    assert float(found["value"].item()) == pytest.approx(energy, rel=1e-9)
    assert float(found["derivative"].item()) == pytest.approx(truth, rel=1e-9)
    assert not found["is_kink"].item()


def _peak_after_a_sine(T_s: complex, a: complex, omega: complex) -> complex:
    """Amplitude of free vibration of an undamped frame after one sine."""
    natural = 2 * math.pi / T_s
    r = omega / natural
    return 2 * r * a / (natural**2 * (1 - r**2)) * cmath.sin(cmath.pi / r)


def test_linear_frame() -> None:
    """All derivatives of an undamped frame; the damping ratio 0 has differences on one side."""
    T_s, a, omega = 1.0, 0.1, 9.0
    case = bare_frame(
        frame={"T_s": T_s, "xi_s": 0.0},
        motion={"kind": "one_sine", "a_max_g": a, "omega_p": omega},
        solver={"t_end": 6.0},
    )
    found = rwmf.gradient(case, ("T_s", "a_max_g", "omega_p", "xi_s", "g"))
    arguments = (T_s, a * 9.81, omega)
    sign = math.copysign(1.0, _peak_after_a_sine(*arguments).real)
    peak = sign * _peak_after_a_sine(*arguments).real
    assert float(found["value"][0]) == pytest.approx(peak, rel=1e-8)
    slopes = []
    for i in range(3):
        moved: list[complex] = list(arguments)
        moved[i] += 1e-20j
        slopes.append(sign * _peak_after_a_sine(*moved).imag / 1e-20)
    truth = [slopes[0], slopes[1] * 9.81, slopes[2]]
    computed = found["derivative"].values[0]
    assert np.allclose(computed[:3], truth, rtol=1e-7)
    assert (abs(computed[:3] - truth) <= found["error"].values[0, :3]).all()
    assert computed[4] * 9.81 == pytest.approx(peak, rel=1e-7)
    assert found["valid_within"].values[0, 1] == pytest.approx(0.3)
    # a frame with some damping has differences on both sides
    damped = rwmf.sweep(case, points={"xi_s": [0.0, 1e-5, 2e-5]})["u_s_max"].values
    slope = (4 * damped[1] - damped[2] - 3 * damped[0]) / 2e-5
    assert computed[3] == pytest.approx(slope, rel=1e-4)


def test_a_period_and_its_frequency() -> None:
    omega = coupled().motion.omega_p
    first = rwmf.gradient(coupled(), "omega_p", ("u_s_max", "theta_max_over_alpha"))
    case = coupled(motion={"omega_p": None, "T_p": 2 * math.pi / omega})
    second = rwmf.gradient(case, "T_p", ("u_s_max", "theta_max_over_alpha"))
    one = (first["derivative"] * first["parameter_value"]).values
    other = (second["derivative"] * second["parameter_value"]).values
    assert np.allclose(one, -other, rtol=1e-7)


_WALL = """&wall h = 6, b = 1.8 /
&impact rule = 'coupled' /
&motion kind = 'one_sine', a_max_g = 0.6, omega_p = 6 /
&solver t_end = 1.4 /
"""
_OF_KEYS = {
    "defaults": """&frame T_s = 0.7, gamma = 3, xi_s = 0.02 /
&cable eta_0 = 0.8 /
&p_delta /
&damper c_over_m_w = 0.1 /
&inerter inertance_over_m_w = 0.4 /
&vertical ratio = 0.3 /
""",
    "link": """&frame T_s = 0.7, gamma = 3, xi_s = 0.02 /
&link L = 20 /
&p_delta /
&fuse eta_y = 0.05, stroke_y = 0.01 /
&yielding u_y = 0.05 /
&model formulation = 'exact', overturning_angle = 1.0 /
""",
    "storeys": """&frame xi_s = 0.03 /
&storeys m_over_m_w = 1, k_over_m_w = 900, height = 4, n = 3, coupling = 'full' /
&cable eta_0 = 0.5, law = 'linear' /
&p_delta /
""",
}


def _real_keys(case: rwmf.Case) -> list[str]:
    """Keys of a case with one real number that a gradient accepts."""
    found = []
    for group, keys in case.groups.items():
        for key in keys:
            with contextlib.suppress(rwmf.InputError):
                item = find_parameters(case, [f"{group}.{key}"])[0]
                if not item.is_list and group not in ("solver", "model"):
                    value = float(lanes.value_of(case, item)[0])
                    lanes.allowed_changes(case, item, value, lanes.scale_of(item, value))
                    found.append(item.name)
    return found


@pytest.mark.parametrize("text", _OF_KEYS.values(), ids=_OF_KEYS)
def test_every_key_has_the_derivative_of_the_case_as_written(text: str) -> None:
    """Defaults that follow from a parameter follow it, whatever else is requested."""
    case = rwmf.Case.from_text(_WALL + text).replace(solver={"rtol": 1e-9})
    names = _real_keys(case)
    assert len(names) >= 8
    name = "u_s_max"
    found = rwmf.gradient(case, names, name)
    for i, (key, scale) in enumerate(zip(names, found["parameter_scale"].values, strict=True)):
        item = find_parameters(case, [key])[0]
        value, step = float(found["parameter_value"][i]), 2e-4 * scale
        changes = [value + step, value - step] if value else [step, 2 * step]
        cases = [case.replace(**lanes.changed_entries(case, item, x)) for x in changes]
        peaks = [float(rwmf.simulate(other)[name]) for other in cases]
        slope = (peaks[0] - peaks[1]) / (changes[0] - changes[1])
        if not value:
            slope = (4 * peaks[0] - peaks[1] - 3 * float(found["value"][0])) / (2 * step)
        least = 1e-4 * float(found["value"][0]) / scale
        assert found["derivative"].values[0, i] == pytest.approx(slope, rel=1e-3, abs=least), key


def test_a_default_follows_beside_its_own_derivative() -> None:
    case = coupled(cable={"eta_0": 1.0, "eta_alpha": None})
    both = rwmf.gradient(case, ("eta_0", "eta_alpha"))["derivative"].values[0]
    stated = coupled(cable={"eta_0": 1.0, "eta_alpha": 1.0})
    parts = rwmf.gradient(stated, ("eta_0", "eta_alpha"))["derivative"].values[0]
    assert both[0] == pytest.approx(rwmf.gradient(case, "eta_0")["derivative"].values.item())
    assert both[0] == pytest.approx(parts.sum(), rel=1e-6)
    assert both[1] == pytest.approx(parts[1], rel=1e-6)


def test_numbers_of_lists() -> None:
    """A list changes by a factor; its derivative is that of one number for all."""
    one = rwmf.Case.from_namelist(SIX_STOREYS)
    n = one.storeys.n
    assert len(one.storeys.as_given()["m"]) == 1
    short = one.replace(solver={"t_end": 2.0})
    masses = short.replace(storeys={"m": [one.storeys.as_given()["m"][0]] * n})
    quantities = ("storey_1_drift_max", "u_s_max")
    single = rwmf.gradient(short, "m", quantities)
    whole = rwmf.gradient(masses, ("storeys.m", "m(2)"), quantities)
    assert whole["parameter"].values.tolist() == ["storeys.m", "m(2)"]
    assert np.allclose(whole["derivative"][:, 0], single["derivative"][:, 0], rtol=1e-6)
    floors = rwmf.gradient(masses, [f"m({i + 1})" for i in range(n)], quantities)
    assert np.allclose(floors["derivative"].sum("parameter"), single["derivative"][:, 0], rtol=1e-5)
    with pytest.raises(rwmf.InputError, match="has 6 numbers"):
        rwmf.gradient(masses, "m(7)")


test_refused_parameters = refusals(
    lambda parameter: rwmf.gradient(coupled(), parameter),
    ("n_pulses", "whole number"),
    ("law", "choice"),
    ("rtol", "setting of the solver"),
    ("output.dt", "setting of the output"),
    ("damper.c_over_m_w", "no &damper"),
    ("v_p", "gives a_max_g"),
    ("T_S_", "no key"),
    ("T_s(2)", "is no list"),
)


def test_refused_quantities_and_statistics() -> None:
    with pytest.raises(rwmf.InputError, match="storey_drift_max: a run of this case has no such"):
        rwmf.gradient(coupled(), "T_s", ("u_s_max", "storey_drift_max"))
    with pytest.raises(rwmf.InputError, match="over: needs a statistic"):
        rwmf.gradient(coupled(), "T_s", records=RECORDS[:1], over="scale")
    for result in ("a", [1.0, 2.0]):
        with pytest.raises(rwmf.InputError, match="must be one number"):
            rwmf.gradient(coupled(), "T_s", records=RECORDS[:1], statistic=lambda _, x=result: x)


def test_rank_among_collapses_has_no_derivative() -> None:
    fallen = coupled(model={"overturning_angle": 1e-6})
    found = rwmf.gradient(fallen, "T_s", records=RECORDS, statistic=0.5)
    assert found["value"].item() == math.inf
    assert math.isnan(found["derivative"].item())
    assert found["is_kink"].item()
    assert found["valid_within"].item() == 0.0


def test_refused_by_dependence() -> None:
    case = rwmf.Case.from_namelist(SIX_STOREYS)
    with pytest.raises(rwmf.InputError, match="initial_stress"):
        rwmf.gradient(case, "eta_0")
    with pytest.raises(rwmf.InputError, match="whole number"):
        rwmf.gradient(case, "strands")
    with pytest.raises(rwmf.InputError, match="sum"):
        rwmf.gradient(case, "h")
    with pytest.raises(rwmf.InputError, match="same number"):
        rwmf.gradient(coupled(), ("T_s", "frame.T_s"))
    with pytest.raises(rwmf.InputError, match="none is given"):
        rwmf.gradient(coupled(), ())


RECORDS = [
    rwmf.Motion(size * np.sin(np.arange(60) * 0.12), dt=0.02, unit="m/s2", name=f"wave {i}")
    for i, size in enumerate((1.0, 1.5, 2.0, 2.6))
]


def test_points_grid_and_records_have_gradients_of_their_own() -> None:
    case = coupled()
    how = {"points": {"eta_0": [0.5, 1.0]}, "grid": {"xi_s": [0.02, 0.05, 0.1]}}
    found = rwmf.gradient(case, ("T_s", "eta_0", "scale"), "u_s_max", records=RECORDS[:2], **how)
    assert found["derivative"].dims == ("quantity", "parameter", "record", "point", "xi_s")
    swept = rwmf.sweep(case, how["grid"], RECORDS[:2], points=how["points"])
    swept = swept["u_s_max"].squeeze().transpose("record", "point", "xi_s")
    assert np.allclose(found["value"].squeeze(), swept, rtol=1e-12)
    one = case.replace(
        motion=RECORDS[1], solver={"t_end": None}, cable={"eta_0": 0.5}, frame={"xi_s": 0.1}
    )
    alone = rwmf.gradient(one, ("T_s", "eta_0", "scale"), "u_s_max")
    cell = found.isel(record=1, point=0, xi_s=2)
    assert (cell["derivative"].values == alone["derivative"].values).all()
    assert cell["parameter_value"].values.tolist() == [case.frame.T_s, 0.5, 1.0]


def _switch(case: rwmf.Case) -> float:
    """Period at which two peaks are equal: the time of the largest one jumps there."""
    low, high = 0.3, 2.0
    for _ in range(12):
        periods = np.linspace(low, high, 33)
        times = rwmf.sweep(case, points={"T_s": periods}, quantities=("t_u_s_max",))
        place = int(np.argmax(abs(np.diff(times["t_u_s_max"].values))))
        low, high = periods[place], periods[place + 1]
    return float(low)


def test_a_change_of_peak_is_a_kink() -> None:
    case = bare_frame(motion={"kind": "one_sine"}, solver={"t_end": 6.0, "rtol": 1e-12})
    period = _switch(case)
    at = rwmf.gradient(case.replace(frame={"T_s": period}), ("T_s", "a_max_g"))
    assert at["is_kink"].values.tolist() == [[True, False]]
    near = rwmf.gradient(case.replace(frame={"T_s": period * 1.002}), "T_s")
    assert not near["is_kink"].item()
    assert near["valid_within"].item() < 0.01
    beside = rwmf.gradient(case.replace(frame={"T_s": period * (1 + 1e-5)}), "T_s")
    assert not beside["is_kink"].item()
    assert beside["derivative"].item() == pytest.approx(near["derivative"].item(), rel=0.05)


def test_prediction_holds_over_its_range() -> None:
    random = np.random.default_rng(3)
    names = ("T_s", "eta_0", "eta_alpha", "xi_s", "e", "a_max_g", "b")
    found = rwmf.gradient(coupled(), names).squeeze("quantity")
    good = 0
    for name in names:
        cell = found.sel(parameter=name)
        value, slope = float(cell["parameter_value"]), float(cell["derivative"])
        reach = float(cell["valid_within"]) * random.uniform(-1, 1, 20)
        run = rwmf.sweep(coupled(), points={name: value * (1 + reach)})["u_s_max"].values
        change = run - float(cell["value"])
        good += int((abs(change - slope * value * reach) <= 0.1 * abs(change) + 1e-10).sum())
    assert good >= 138


@pytest.mark.slow
def test_error_covers_the_truth(record_folder: Path) -> None:
    """Random scenes against larger steps at a tolerance of 1e-13, with two Richardson steps."""
    random = np.random.default_rng(8)
    covered, worst, n = 0, 0.0, 0
    for case in random_cases(40, 8, record_folder):
        keys = ("wall.h", "wall.b", "T_s", "gamma", "xi_s", "eta_0", "impact.e")
        names = [str(name) for name in random.choice(keys, 2, replace=False)]
        found = rwmf.gradient(case, names).squeeze("quantity")
        scale = np.abs(found["derivative"] * found["parameter_scale"]).max().item()
        scale = max(scale, abs(found["value"].item()))
        for name in names:
            cell = found.sel(parameter=name)
            p = cell["parameter_value"].item()
            steps = np.outer([3e-4, 1.5e-4, 7.5e-5], [1.0, -1.0])
            table = {name: (p * (1 + steps)).ravel(), "rtol": np.full(6, 1e-13)}
            run = rwmf.sweep(case, points=table)["u_s_max"].values.reshape(3, 2)
            slopes = (run[:, 0] - run[:, 1]) / (2 * steps[:, 0])
            first = (4 * slopes[1:] - slopes[:-1]) / 3
            if abs(first[1] - first[0]) > 1e-9 * scale:
                # larger steps meet a kink
                continue
            wrong = abs(cell["derivative"].item() * p - (16 * first[1] - first[0]) / 15)
            covered += wrong <= cell["error"].item() * p
            worst, n = max(worst, wrong / scale), n + 1
    assert n >= 60
    assert covered >= 0.99 * n
    assert worst < 1e-6


def test_statistic_of_a_suite() -> None:
    """The slope of a quantile is that of its record."""
    case = coupled()
    alone = rwmf.gradient(case, "b", records=RECORDS)
    assert not alone["is_kink"].any()
    order = np.argsort(alone["value"].values[0])
    found = rwmf.gradient(case, "b", records=RECORDS, statistic=0.7)
    truth = alone["derivative"].values[0, 0, order[2]]
    assert found["derivative"].item() == pytest.approx(truth, rel=1e-5)
    assert found["bootstrap_error"].item() > 0
    mean = rwmf.gradient(case, "b", records=RECORDS, statistic=np.mean)
    assert mean["derivative"].item() == pytest.approx(alone["derivative"].values.mean(), rel=1e-5)
    with pytest.raises(rwmf.InputError, match="records"):
        rwmf.gradient(case, "b", statistic=0.5)
    with pytest.raises(rwmf.InputError, match="share"):
        rwmf.gradient(case, "b", records=RECORDS, statistic=50)


def test_fragility_of_a_linear_frame() -> None:
    """Demands in proportion to the scale: the median capacity is the limit over them."""
    case = bare_frame(solver={"t_end": 4.0})
    levels = [0.2, 0.5, 1.0, 2.0, 5.0, 12.0]
    demands = rwmf.sweep(case, records=RECORDS)["u_s_max"].squeeze().values
    limit = float(demands.max())
    how = {"records": RECORDS, "grid": {"scale": levels}, "over": ("record", "scale")}
    capacities = limit / demands
    theta = np.exp(np.mean(np.log(capacities)))

    def median(values: np.ndarray) -> float:
        """Median intensity: in each record a line in logarithms between two levels."""
        at = (values > limit).argmax(axis=1)
        low, high = (np.log(values[np.arange(len(values)), i]) for i in (at - 1, at))
        below, above = (np.log(levels)[i] for i in (at - 1, at))
        part = (np.log(limit) - low) / (high - low)
        return float(np.exp(np.mean(below + part * (above - below))))

    found = rwmf.gradient(case, "T_s", statistic=median, **how)
    assert found["value"].item() == pytest.approx(theta, rel=1e-7)
    alone = rwmf.gradient(case, "T_s", records=RECORDS)
    slopes = -(alone["derivative"].values / alone["value"].values[:, None]).ravel()
    assert found["derivative"].item() == pytest.approx(theta * slopes.mean(), rel=1e-4)
    assert found["bootstrap_error"].item() > 0
