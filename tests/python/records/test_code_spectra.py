"""Target spectra of codes: points by hand, continuity at the corners, use in a selection."""

import numpy as np
import pytest
import rwmf
from refused import refusals
from rwmf.records import asce7, eurocode8


def _at(spectrum: np.ndarray, T: float) -> float:
    return float(np.exp(np.interp(np.log(T), np.log(spectrum[0]), np.log(spectrum[1]))))


@pytest.mark.parametrize(
    ("T", "Sa"),
    [(0.06, 0.7), (0.12, 1.0), (0.6, 1.0), (1.0, 0.6), (2.0, 0.3), (4.0, 0.15), (8.0, 0.0375)],
)
def test_asce7(T: float, Sa: float) -> None:
    """S_DS = 1 g and S_D1 = 0.6 g have corners at 0.12, 0.6 and T_L = 4 s."""
    assert _at(asce7(1.0, 0.6, 4.0), T) == pytest.approx(Sa, rel=1e-4)


@pytest.mark.parametrize(
    ("ground", "kind", "T", "Sa"),
    [
        ("A", 1, 0.075, 0.35), ("A", 1, 0.3, 0.5), ("A", 1, 1.0, 0.2), ("A", 1, 4.0, 0.025),
        ("B", 1, 0.5, 0.6), ("C", 1, 1.2, 0.2875), ("D", 1, 1.6, 0.3375), ("E", 1, 0.5, 0.7),
        ("A", 2, 0.5, 0.25), ("B", 2, 0.25, 0.675), ("C", 2, 0.1, 0.75), ("D", 2, 0.6, 0.45),
        ("E", 2, 2.4, 0.0416667),
    ],
)  # fmt: skip
def test_eurocode8(ground: str, kind: int, T: float, Sa: float) -> None:
    """Accelerations by hand for a_g = 0.2 g and 5 %."""
    assert _at(eurocode8(0.2, ground, kind), T) == pytest.approx(Sa, rel=1e-4)


def test_damping_of_eurocode8() -> None:
    assert _at(eurocode8(0.2, damping=0.15), 0.3) == pytest.approx(0.5 * np.sqrt(0.5), rel=1e-9)
    assert _at(eurocode8(0.2, damping=0.5), 0.3) == pytest.approx(0.5 * 0.55, rel=1e-9)


@pytest.mark.parametrize("spectrum", [asce7(1.2, 0.5), eurocode8(0.3, "C"), eurocode8(0.3, "D", 2)])
def test_spectra_are_continuous(spectrum: np.ndarray) -> None:
    assert np.all(np.diff(spectrum[0]) > 0)
    assert np.all(np.abs(np.diff(np.log(spectrum[1]))) <= 2.001 * np.diff(np.log(spectrum[0])))


def test_a_selection_takes_them() -> None:
    quake = rwmf.Motion(np.sin(np.arange(300) * 0.1), dt=0.02, unit="m/s2", name="one")
    target = eurocode8(0.25, "B")
    found = rwmf.records.select([quake], target, (0.2, 2.0), limits=(1e-3, 1e3))
    np.testing.assert_allclose(found.target[0], 0.75, rtol=1e-9)


test_numbers_outside_their_range = refusals(
    lambda call: call(),
    (lambda: asce7(1.0, 10.0), "T_L = 8: must be at least T_S = S_D1/S_DS = 10 s"),
    (lambda: asce7(0.0, 0.6), "S_DS = 0"),
    (lambda: eurocode8(0.2, "S1"), "ground_type = 'S1': must be one of A, B, C, D, E"),
    (lambda: eurocode8(0.2, spectrum_type=3), "spectrum_type = 3"),
    (lambda: eurocode8(-0.2), "a_g = -0.2"),
)
