"""Intensity measures against closed forms, fine integration and properties of the definitions."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from refused import refusals
from rwmf.errors import InputError
from scenes import coupled
from scipy.linalg import expm

_OPTIONS: dict[str, dict[str, Any]] = {
    "pseudo_acceleration": {"period": 0.7, "damping": 0.03},
    "average_acceleration": {"periods": [0.2, 0.5, 1.3]},
    "peak_acceleration": {},
    "peak_velocity": {},
    "peak_displacement": {},
    "arias": {},
    "cav": {},
    "housner": {"damping": 0.05},
    "duration_5_95": {},
}
_POWERS = {kind: {"arias": 2, "duration_5_95": 0}.get(kind, 1) for kind in _OPTIONS}


def _noise(seed: int, n: int = 60, *, is_even: bool = True) -> rwmf.Motion:
    """Return a motion that begins and ends with a jump."""
    chance = np.random.default_rng(seed)
    values = chance.standard_normal(n)
    if is_even:
        return rwmf.Motion(values, dt=0.05, unit="m/s2", name=f"noise {seed}")
    times = np.cumsum(chance.uniform(0.001, 0.2, n))
    return rwmf.Motion(values, times=times, unit="m/s2", name=f"uneven {seed}")


@pytest.mark.parametrize(
    ("kind", "options", "wanted", "digits"),
    [
        ("peak_velocity", {}, 0.361998, 6e-7),
        ("arias", {}, 1.72416181, 6e-9),
        ("cav", {}, 12.37087172, 6e-9),
        ("pseudo_acceleration", {"period": 0.05}, 4.12781, 6e-6),
        ("pseudo_acceleration", {"period": 0.1}, 6.36491, 6e-6),
        ("pseudo_acceleration", {"period": 0.2}, 8.04695, 6e-6),
        ("pseudo_acceleration", {"period": 0.5}, 9.01274, 6e-6),
        ("pseudo_acceleration", {"period": 1.0, "damping": 0.05}, 4.46369, 6e-6),
        ("pseudo_acceleration", {"period": 2.0}, 1.34733, 6e-6),
    ],
)
def test_el_centro(
    elcentro: Path, kind: str, options: dict[str, float], wanted: float, digits: float
) -> None:
    found = rwmf.records.intensity(elcentro, kind, unit="g", **options)  # type: ignore[arg-type]
    assert found == pytest.approx(wanted, abs=digits, rel=0)


@pytest.mark.parametrize("length", [0.05, 0.2, 0.49, 0.5, 0.8, 3.3])
def test_rectangular_pulse(length: float) -> None:
    """A short pulse has its largest response in the free vibration behind it."""
    pulse = rwmf.Motion([1.5, 1.5], dt=length, unit="m/s2")
    wanted = 3.0 * (math.sin(math.pi * length) if length < 0.5 else 1.0)
    found = rwmf.records.intensity(pulse, "pseudo_acceleration", period=1.0, damping=0.0)
    assert found == pytest.approx(wanted, rel=1e-13)


def test_one_line_with_a_change_of_sign() -> None:
    line = rwmf.Motion([-1.0, 2.0], dt=3.0, unit="m/s2")
    assert rwmf.records.intensity(line, "cav") == pytest.approx(2.5, rel=1e-15)
    assert rwmf.records.intensity(line, "arias", g=10.0) == pytest.approx(
        math.pi / 20 * 3, rel=1e-15
    )
    # v = -t + t^2/2 and u = -t^2/2 + t^3/6
    assert rwmf.records.intensity(line, "peak_velocity") == pytest.approx(1.5, rel=1e-15)
    assert rwmf.records.intensity(line, "peak_displacement") == pytest.approx(2 / 3, rel=1e-14)
    even = rwmf.Motion([1.0, 1.0, 1.0], dt=2.0, unit="m/s2")
    assert rwmf.records.intensity(even, "duration_5_95") == pytest.approx(3.6, rel=1e-14)


@pytest.mark.parametrize("is_even", [True, False])
@pytest.mark.parametrize(
    ("period", "damping"), [(0.013, 0.05), (0.05, 0.0), (0.3, 0.05), (2.0, 0.6), (50.0, 0.02)]
)
def test_against_fine_steps(period: float, damping: float, is_even: bool) -> None:
    """The transition matrix of the oscillator with its load, and 100 points in each step."""
    motion = _noise(3, 30, is_even=is_even)
    omega = 2 * math.pi / period
    system = np.zeros((4, 4))
    system[0, 1] = system[2, 3] = 1.0
    system[1, :3] = -(omega**2), -2 * damping * omega, -1.0
    state, largest = np.zeros(2), 0.0
    slopes = np.diff(motion.values) / np.diff(motion.times)
    loads = [*zip(np.diff(motion.times), motion.values[:-1], slopes, strict=True), (period, 0, 0)]
    for h, a, slope in loads:
        small = expm(system * h / 100)
        full = np.array([*state, a, slope])
        for _ in range(100):
            full = small @ full
            largest = max(largest, abs(full[0]))
        state = full[:2]
    found = rwmf.records.intensity(motion, "pseudo_acceleration", period=period, damping=damping)
    widest = max(h for h, *_ in loads[:-1]) * omega / 100
    assert -1e-9 < found / (omega**2 * largest) - 1 < max(1e-3, widest**2)


@pytest.mark.parametrize("kind", ["peak_velocity", "peak_displacement"])
def test_between_samples(kind: str) -> None:
    motion = _noise(8, is_even=False)
    t = np.unique(np.concatenate([np.linspace(a, b, 400) for a, b in
                                  zip(motion.times, motion.times[1:], strict=False)]))  # fmt: skip
    a = np.interp(t, motion.times, motion.values)
    h = np.diff(t)
    v = np.append(0, np.cumsum(h * (a[1:] + a[:-1]) / 2))
    u = np.append(0, np.cumsum(h * v[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6))
    dense = float(np.abs(v if kind == "peak_velocity" else u).max())
    assert -1e-12 < rwmf.records.intensity(motion, kind) / dense - 1 < 1e-4


@pytest.mark.parametrize("kind", _OPTIONS)
def test_further_samples_on_the_lines_change_nothing(kind: str) -> None:
    motion = _noise(11, is_even=False)
    middles = (motion.times[1:] + 2 * motion.times[:-1]) / 3
    times = np.sort(np.concatenate([motion.times, middles]))
    values = np.interp(times, motion.times, motion.values)
    finer = rwmf.Motion(values, times=times, unit="m/s2")
    found = [rwmf.records.intensity(item, kind, **_OPTIONS[kind]) for item in (motion, finer)]
    assert found[0] == pytest.approx(found[1], rel=1e-11)


def test_facts_of_files_that_a_motion_contradicts() -> None:
    motion, records = _noise(3), rwmf.records
    assert records.intensity(motion, "arias", unit="m/s2", dt=motion.dt) > 0
    for call in (
        lambda: records.intensity(motion, "arias", unit="g"),
        lambda: records.sequence(motion, motion, 1.0, dt=0.5),
        lambda: records.process(motion, taper=1.0, channel=2),
    ):
        with pytest.raises(rwmf.InputError, match=r"= \S+ belongs to files"):
            call()


@pytest.mark.parametrize("kind", _OPTIONS)
def test_units_signs_and_factors(kind: str) -> None:
    motion, options = _noise(5), _OPTIONS[kind]
    found = rwmf.records.intensity(motion, kind, **options)
    other = rwmf.Motion(motion.values * -300, dt=motion.dt, unit="cm/s2")
    scaled = rwmf.records.intensity(other, kind, **options)
    assert scaled == pytest.approx(found * 3.0 ** _POWERS[kind], rel=1e-12)
    in_g = rwmf.Motion(motion.values / 9.7, dt=motion.dt, unit="g")
    assert rwmf.records.intensity(in_g, kind, g=9.7, **options) == pytest.approx(
        found * (9.81 / 9.7 if kind == "arias" else 1.0), rel=1e-12
    )


def _turned(pair: tuple[rwmf.Motion, rwmf.Motion], angle: float) -> list[rwmf.Motion]:
    x, y = (item.values for item in pair)
    both = (math.cos(angle) * x + math.sin(angle) * y, math.cos(angle) * y - math.sin(angle) * x)
    return [rwmf.Motion(item, dt=pair[0].dt, unit="m/s2") for item in both]


@pytest.mark.parametrize("kind", [kind for kind in _OPTIONS if kind != "housner"])
def test_directions_of_a_pair(kind: str) -> None:
    options = _OPTIONS[kind]
    pair = (_noise(1), _noise(2))
    others = _turned(pair, 0.4321)
    for component in ("rotd00", "rotd50", "rotd84", "rotd100"):
        found = [rwmf.records.intensity(tuple(item), kind, component=component, **options)  # type: ignore[arg-type]
                 for item in (pair, others)]  # fmt: skip
        assert found[0] == pytest.approx(found[1], rel=1e-4)
    # every direction lies between the extremes
    low, high = (
        rwmf.records.intensity(pair, kind, component=component, **options)
        for component in ("rotd0", "rotd100")
    )
    for angle in (0.0, 0.7, 2.9):
        one = rwmf.records.intensity(_turned(pair, angle)[0], kind, **options)
        assert low * (1 - 1e-9) <= one <= high * (1 + 1e-9)


@pytest.mark.parametrize("kind", ["pseudo_acceleration", "peak_velocity", "cav", "arias"])
def test_equal_and_missing_components(kind: str) -> None:
    options, power = _OPTIONS[kind], _POWERS[kind]
    x = _noise(4)
    nothing = rwmf.Motion(np.zeros(x.values.size), dt=x.dt, unit="m/s2")
    alone = rwmf.records.intensity(x, kind, **options)

    def found(component: str, *pair: rwmf.Motion) -> float:
        return rwmf.records.intensity((pair[0], pair[1]), kind, component=component, **options)

    assert found("rotd100", x, x) == pytest.approx(alone * math.sqrt(2) ** power, rel=1e-9)
    assert found("rotd50", x, nothing) == pytest.approx(alone / math.sqrt(2) ** power, rel=1e-5)
    assert found("geometric_mean", x, x) == pytest.approx(alone, rel=1e-12)
    shorter = rwmf.Motion(x.values[:-3], dt=x.dt, unit="m/s2")
    padded = rwmf.Motion([*x.values[:-3], 0, 0, 0], dt=x.dt, unit="m/s2")
    assert found("rotd50", x, shorter) == found("rotd50", x, padded)


test_refusals = refusals(
    lambda kind, options: rwmf.records.intensity(_noise(1), kind, **options),
    ("pga", {}, "intensity = 'pga': must be one of"),
    ("peak_aceleration", {}, "did you mean peak_acceleration"),
    ("pseudo_acceleration", {}, "needs period"),
    ("pseudo_acceleration", {"period": 0.0}, "period = 0.0: must be"),
    ("pseudo_acceleration", {"period": 1.0, "damping": 1.0}, "damping = 1.0: must be"),
    ("average_acceleration", {"periods": []}, "periods"),
    ("average_acceleration", {"periods": [1.0, -1.0]}, "periods"),
    ("arias", {"period": 1.0}, "period: must not be given with intensity = 'arias'"),
    ("cav", {"component": "rotd50"}, "component: belongs to two components"),
)


@pytest.mark.parametrize(
    ("component", "kind", "message"),
    [
        ("rotd101", "cav", "component = 'rotd101': must be geometric_mean, rotd50"),
        ("larger", "cav", "component = 'larger'"),
        ("rotd50", "housner", "not for housner"),
    ],
)
def test_refused_components(component: str, kind: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        rwmf.records.intensity((_noise(1), _noise(2)), kind, component=component)
    slower = rwmf.Motion([0.0, 1.0, 0.0], dt=0.03, unit="m/s2")
    with pytest.raises(InputError, match="the same times"):
        rwmf.records.intensity((_noise(1), slower), "cav", component="rotd50")


@pytest.mark.parametrize("kind", [kind for kind, power in _POWERS.items() if power > 0])
def test_levels_are_intensities_for_every_design(kind: str) -> None:
    """One factor for each record, to the bit; a level gives its intensity."""
    options = _OPTIONS[kind]
    designs = [
        coupled(solver={"method": "dop853", "rtol": 1e-6, "t_end": 3.0}),
        coupled(frame={"T_s": 0.6, "xi_s": 0.02}, solver={"rtol": 1e-8}).without("cable"),
        coupled().without("frame"),
    ]
    records = rwmf.records.find_records([_noise(1), _noise(2)])
    analyses = [
        rwmf.sweep(case, {"scale": [0.3, 0.5]}, records, intensity=kind, **options)
        for case in designs
    ]
    formats = [list(item["record_format"].values) for item in analyses]
    assert formats[0] == formats[1] == formats[2]
    assert formats[0][0] != formats[0][1]
    assert list(analyses[0]["scale"].values) == [0.3, 0.5]
    own = float(formats[0][0].split("times ")[1])
    unit = 9.81 if "acceleration" in kind else 1.0
    one = dataclasses.replace(records[0], scale=own)
    assert rwmf.records.intensity(one, kind, **options) == pytest.approx(unit, rel=1e-12)
    # the run at level 0.5 has the factor of an intensity of 0.5
    factor = own * 0.5 ** (1 / _POWERS[kind])
    peak = rwmf.sweep(
        designs[2],
        {"scale": [0.5]},
        records[:1],
        quantities="theta_max_over_alpha",
        intensity=kind,
        **options,
    )["theta_max_over_alpha"]
    case = designs[2].replace(motion=records[0].array).replace(motion={"scale": factor})
    run = rwmf.simulate(case.replace(solver={"t_end": None}), dt=0.01)
    found = float(run["theta_max_over_alpha"])
    assert float(peak.squeeze()) == pytest.approx(found, rel=1e-6, abs=1e-12)


def test_a_duration_scales_nothing() -> None:
    with pytest.raises(InputError, match="does not change with a factor"):
        rwmf.sweep(coupled(), {"scale": [1.0]}, [_noise(1)], intensity="duration_5_95")
    with pytest.raises(InputError, match="levels of intensity = 'arias' must be >= 0"):
        rwmf.sweep(coupled(), {"scale": [-1.0]}, [_noise(1)], intensity="arias")
