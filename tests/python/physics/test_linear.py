"""The frame alone is a linear oscillator: exact solutions and published values."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from scenes import bare_frame, coupled, record
from yielding import exact_peak

G = 9.81
# the kernel at rtol 1e-11 against the exact solution: its own tolerance with room for the
# accumulation over 31 s
EXACT = 1e-8
PULSE_G = 0.4

# largest |u_s| [m] under 0.4 g, 2 pi rad/s, one cycle, xi 0.05: the frame alone, and in the limit
# of a massless wall that multiplies the velocity by 0.9 at every u_s = 0
PULSES = {
    "one_sine": {
        0.4: (0.0243145, 0.0243145),
        0.6: (0.0780800, 0.0741901),
        1.0: (0.2683383, 0.2508017),
        1.4: (0.3815529, 0.3492759),
        2.0: (0.4552514, 0.4097627),
        3.0: (0.4989727, 0.4490755),
    },
    "one_cosine": {
        0.4: (0.0293545, 0.0276254),
        0.6: (0.0901227, 0.0858295),
        1.0: (0.2486668, 0.2138513),
        1.4: (0.2604366, 0.2396131),
        2.0: (0.2455490, 0.2191503),
        3.0: (0.1803829, 0.1648193),
    },
}
ELCENTRO = {
    0.4: (0.030185, 0.025058),
    0.6: (0.068536, 0.059204),
    1.0: (0.113067, 0.084989),
    1.5: (0.105580, 0.094833),
    2.0: (0.136513, 0.125826),
    3.0: (0.274796, 0.232089),
}
# peaks between the samples; the textbook's own are on its grid of 0.02 s
TEXTBOOK = [
    (0.02, 0.5, 0.068275),
    (0.02, 1.0, 0.151618),
    (0.02, 2.0, 0.189709),
    (0.05, 0.3, 0.016997),
    (0.05, 0.5, 0.057074),
    (0.05, 1.0, 0.113067),
    (0.05, 1.5, 0.105580),
    (0.05, 2.0, 0.136513),
    (0.05, 3.0, 0.274796),
]


def _last_digit(digits: int) -> float:
    """One unit of the last printed digit: some of the values are cut, not rounded."""
    return 10.0**-digits


def _peak(case: rwmf.Case) -> float:
    return float(rwmf.simulate(case)["u_s_max"])


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor"])
@pytest.mark.parametrize("T_s", [0.3, 1.0, 2.5])
def test_record_against_the_exact_solution(T_s: float, method: str, elcentro: Path) -> None:
    t, a = np.loadtxt(elcentro, delimiter=",", comments=("#", "t"), unpack=True)
    case = bare_frame(
        frame={"T_s": T_s, "xi_s": 0.05},
        motion=record(elcentro),
        solver={"t_end": None, "rtol": 1e-11, "method": method},
    )
    assert _peak(case) == pytest.approx(exact_peak(T_s, 0.05, t, G * a), rel=EXACT)


def test_small_record_against_the_exact_solution(tmp_path: Path) -> None:
    """Few large intervals, a first and a last sample that are jumps, strong damping."""
    t = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 2.5])
    a = np.array([1.0, -2.0, 0.5, 3.0, -1.0, 2.0])
    path = tmp_path / "saw.csv"
    np.savetxt(path, np.column_stack([t, a]))
    case = bare_frame(
        frame={"T_s": 0.8, "xi_s": 0.3},
        motion=record(path, unit="m/s2"),
        solver={"t_end": None, "rtol": 1e-11},
    )
    assert _peak(case) == pytest.approx(exact_peak(0.8, 0.3, t, a), rel=EXACT)


@pytest.mark.parametrize(("xi", "T_s", "expected"), TEXTBOOK)
def test_textbook_record(xi: float, T_s: float, expected: float, elcentro: Path) -> None:
    case = bare_frame(
        frame={"T_s": T_s, "xi_s": xi}, motion=record(elcentro), solver={"t_end": None}
    )
    assert _peak(case) == pytest.approx(expected, abs=_last_digit(6))


@pytest.mark.parametrize(
    ("kind", "T_s"), [(kind, T_s) for kind, column in PULSES.items() for T_s in column]
)
def test_pulse(kind: str, T_s: float) -> None:
    """The frame alone to the printed digits; a light wall within 0.1 % of its limit."""
    alone, limit = PULSES[kind][T_s]
    motion = {"kind": kind, "a_max_g": PULSE_G, "omega_p": 2 * math.pi}
    frame = {"T_s": T_s}
    bare = bare_frame(frame=frame, motion=motion)
    assert _peak(bare) == pytest.approx(alone, abs=_last_digit(7))
    wall = coupled(frame=frame | {"gamma": 1800.0}, motion=motion)
    assert _peak(wall) == pytest.approx(limit, rel=1e-3)


@pytest.mark.parametrize("T_s", list(ELCENTRO))
def test_elcentro(T_s: float, elcentro: Path) -> None:
    """The frame alone to the printed digits; a light wall within 0.35 % of its limit."""
    alone, limit = ELCENTRO[T_s]
    changes = {"motion": record(elcentro), "solver": {"t_end": None}}
    bare = bare_frame(frame={"T_s": T_s}, **changes)
    assert _peak(bare) == pytest.approx(alone, abs=_last_digit(6))
    wall = coupled(frame={"T_s": T_s, "gamma": 1800.0}, **changes)
    assert _peak(wall) == pytest.approx(limit, rel=3.5e-3)


@pytest.mark.parametrize("T_s", [0.6, 1.0, 2.0])
def test_limit_of_a_massless_wall(T_s: float, elcentro: Path) -> None:
    """At gamma = 1e8: the linear oscillator with u' -> e u' at u = 0, solved exactly.

    The remaining influence of the wall is of order 1/gamma.
    """
    t, a = np.loadtxt(elcentro, delimiter=",", comments=("#", "t"), unpack=True)
    part = t <= 8.0
    case = coupled(frame={"T_s": T_s, "gamma": 1e8}, motion=record(elcentro), solver={"t_end": 8.0})
    exact = exact_peak(T_s, 0.05, t[part], G * a[part], e=0.9)
    assert _peak(case) == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor", "dop853"])
@pytest.mark.parametrize("base", [None, "pinned"])
def test_pulse_that_begins_later(base: str | None, method: str) -> None:
    """A scene at rest until then responds as at once: long steps at rest have no effect."""
    wall = None if base is None else {"h": 2.0, "b": 0.5, "base": base}
    gamma = None if base is None else 5.0
    peaks = []
    for t_0 in (0.0, 0.3, 2.0):
        case = coupled(
            wall=wall,
            cable=None,
            impact=None,
            frame={"gamma": gamma},
            motion={"kind": "one_sine", "a_max_g": 0.1, "omega_p": 5.0, "t_0": t_0},
            solver={"t_end": 9.0, "method": method},
        )
        peaks.append(_peak(case))
    assert peaks == pytest.approx([peaks[0]] * 3, rel=1e-7)
