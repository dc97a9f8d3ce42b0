"""The section at the base on a strip without tension: printed numbers, equilibrium, every scene."""

import doctest
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import rwmf
import xarray as xr
from checkout import Runner
from refused import refusals
from scenes import bare_frame, block, coupled, read_table
from scipy.integrate import quad
from scipy.optimize import brentq

WIDTH, THICKNESS, K = 4.0, 0.35, 1e10
WALL = {"h": 9.6, "b": 2.0, "thickness": THICKNESS, "density": 2500.0, "m_w": None}
SECTION = {"k": K, "E": 3e10}
DEMANDS = ("contact_length_min_m", "toe_stress_max_Pa", "toe_strain_max")


def _section(force: npt.ArrayLike, theta: npt.ArrayLike, **changes: float | None) -> xr.Dataset:
    given: dict[str, Any] = {"width": WIDTH, "thickness": THICKNESS, "k": K} | changes
    return rwmf.sections.base_section(force, theta, **given)


def test_printed_moments() -> None:
    """Moments of an independent computation, to every printed digit (MN m)."""
    found = _section(3.07e6, [0.001, 0.005, 0.01]).moment.values / 1e6
    assert [f"{value:.6f}" for value in found] == ["4.784601", "5.533847", "5.711385"]


def test_force_and_stiffness_of_a_u_shaped_plate() -> None:
    """Plastic moments at both tangent points; bending energy of the semicircle."""
    E, stress, width, thickness, diameter = 200e9, 350e6, 0.12, 0.01, 0.1
    plate = rwmf.sections.ufp(width, thickness, diameter, stress=stress, modulus=E)
    assert f"{plate.F_p / 1e3:.3f} {plate.F_y / 1e3:.3f}" == "21.000 14.000"
    assert plate.F_p * diameter == pytest.approx(2 * stress * width * thickness**2 / 4, rel=1e-14)
    inertia, radius = width * thickness**3 / 12, diameter / 2
    # displacement under 1 N: the moment is radius cos(angle)
    moved = quad(lambda x: (radius * math.cos(x)) ** 2 * radius / (E * inertia), 0, math.pi)[0]
    assert plate.k == pytest.approx(1 / moved, rel=1e-12)
    with pytest.raises(rwmf.InputError, match=r"^thickness = 0: must be a finite number > 0"):
        rwmf.sections.ufp(0.12, 0, 0.1, stress=350e6)


def test_plate_rolls_until_it_breaks() -> None:
    """Strain of the fibre that the bend straightens; printed constants of the fatigue law."""
    plate = rwmf.sections.ufp(0.12, 0.01, 0.1, stress=350e6, leg=0.06)
    # the outer fibre of the half circle is longer than its middle
    outer, middle = math.pi * (0.1 + 0.01) / 2, math.pi * 0.1 / 2
    assert plate.strain == pytest.approx((outer / middle - 1) / 2, rel=1e-14)
    # the middle of the bend moves by half of the stroke
    assert plate.stroke == 0.12
    assert rwmf.sections.fatigue_cycles(0.191) == 1.0
    per_decade = rwmf.sections.fatigue_cycles(0.00191) / rwmf.sections.fatigue_cycles(0.0191)
    assert math.log10(per_decade) == pytest.approx(1 / 0.458, rel=1e-12)
    assert plate.cycles == pytest.approx(18.66, abs=0.005)


def test_footings_of_published_tables() -> None:
    """Square and long footings by hand, beside the formulas of ASCE 41 with whole sides."""
    G, nu, a = 40e6, 0.3, 4.0
    square = rwmf.sections.footing(G, nu, a, a)
    # 4.7 and 4.0 are the sums of coefficients at L = B
    assert square.K_z == pytest.approx(4.7 * G * 2.0 / 0.7, rel=1e-14)
    assert square.K_r == pytest.approx(4.0 * G * 8.0 / 0.7, rel=1e-14)
    assert square.c_z == pytest.approx(math.sqrt(2 * 0.7 / 0.4 * G * 1800.0), rel=1e-14)
    for width, thickness in ((9.0, 2.0), (2.0, 9.0)):
        found = rwmf.sections.footing(G, nu, width, thickness, density=1900.0)
        ratio = 4.5
        assert found.K_z == pytest.approx(G * 2.0 / 0.7 * (1.55 * ratio**0.75 + 0.8), rel=1e-14)
        turn = 0.47 * ratio**2.4 + 0.034 if width > thickness else 0.4 * ratio + 0.1
        assert found.K_r == pytest.approx(G * 8.0 / 0.7 * turn, rel=1e-2)
        # springs of the modulus under the whole base
        inertia = thickness * width**3 / 12
        assert found.k_r * inertia == pytest.approx(found.K_r, rel=1e-14)
        assert found.k_z * width * thickness == pytest.approx(found.K_z, rel=1e-14)
    assert rwmf.sections.footing(G, 0.49, a, a).c_z == 2.5 * math.sqrt(G * 1800.0)


def test_concrete_of_a_toe() -> None:
    """Mander's strength by hand: r = 0.05 gives 1.310110."""
    plain, tied = (rwmf.sections.toe(40e6, 19.2, pressure=p) for p in (0.0, 2e6))
    assert plain == pytest.approx((40e6, 4700e6 * math.sqrt(40), 1.152, 0.002), rel=1e-14)
    assert tied.f_c / 40e6 == pytest.approx(1.310110, abs=5e-7)
    assert tied.strain == pytest.approx(0.002 * (1 + 5 * 0.310110), abs=1e-8)
    coupled(wall=WALL, base_section={"f_c": tied.f_c, "E": tied.E, "length": tied.length})


def test_examples_of_the_docstrings() -> None:
    assert doctest.testmod(rwmf.sections).failed == 0


@pytest.mark.parametrize("f_c", [None, 2.3e6, 3e6, 4e6, 2e7])
@pytest.mark.parametrize("theta", [0.0, 1e-6, 1e-4, 2.5e-4, 2.8e-4, 1e-3, 0.02, -0.02])
def test_stresses_balance_the_force(theta: float, f_c: float | None) -> None:
    """Springs that only press, up to f_c, integrated over the base in full and partial contact."""
    force, strength = 3.07e6, f_c or math.inf

    def stress(x: float, settlement: float) -> float:
        return min(strength, max(0.0, K * (settlement + abs(theta) * x)))

    def resultant(settlement: float, power: int) -> float:
        knee = -settlement / abs(theta) if theta else -WIDTH
        start = min(max(knee, -WIDTH / 2), WIDTH / 2)
        crushed = (strength / K - settlement) / abs(theta) if theta else WIDTH
        parts = sorted({start, min(max(crushed, start), WIDTH / 2), WIDTH / 2})
        return sum(
            quad(lambda x: THICKNESS * x**power * stress(x, settlement), *span, epsabs=1e-3)[0]
            for span in pairwise(parts)
        )

    reach = abs(theta) * WIDTH + 2 * force / (K * THICKNESS * WIDTH)
    settled = brentq(lambda s: resultant(s, 0) - force, -reach, reach, xtol=1e-18, rtol=1e-15)
    found = _section(force, theta, E=3e10, f_c=f_c)
    assert float(found.moment) == pytest.approx(resultant(settled, 1), rel=1e-8, abs=1e-3)
    assert float(found.toe_stress) == pytest.approx(stress(2.0, settled), rel=1e-8)
    strain = K * (settled + abs(theta) * WIDTH / 2) / 3e10
    assert float(found.toe_strain) == pytest.approx(strain, rel=1e-8)
    if float(found.toe_stress) < strength:
        assert float(found.toe_strain) == float(found.toe_stress) / 3e10
    contact = min(WIDTH, 2.0 + settled / abs(theta)) if theta else WIDTH
    assert float(found.contact_length) == pytest.approx(contact, rel=1e-8)


def test_a_force_above_the_strength_of_the_base() -> None:
    """No equilibrium: the stress is f_c everywhere, and the settlement goes on continuously."""
    most = 3e6 * WIDTH * THICKNESS
    for theta in (0.0, 1e-3):
        found = _section(np.array([1 - 1e-9, 1 + 1e-9, 2.0]) * most, theta, E=3e10, f_c=3e6)
        assert found.toe_stress.values.tolist()[1:] == [3e6, 3e6]
        assert found.moment.values.tolist()[1:] == [0.0, 0.0]
        assert found.contact_length.values.tolist()[1:] == [WIDTH, WIDTH]
        below, above, twice = found.toe_strain.values
        assert above == pytest.approx(below, rel=1e-4)
        assert twice - above == pytest.approx(3e6 / 3e10, rel=1e-8)


def test_full_contact_joins_partial_contact() -> None:
    """Value and slope are continuous where the contact is just the width."""
    force = 2e6
    edge = 2 * force / (K * THICKNESS * WIDTH**2)
    for name in ("toe_stress", "moment", "contact_length"):
        below, at, above = _section(force, edge * np.array([1 - 1e-7, 1, 1 + 1e-7]))[name].values
        assert at == pytest.approx(below, rel=2e-7)
        assert at == pytest.approx(above, rel=2e-7)
    assert float(_section(force, edge).contact_length) == pytest.approx(WIDTH, rel=1e-15)
    assert float(_section(force, edge).moment) == pytest.approx(force * WIDTH / 6, rel=1e-15)
    at_rest = _section(force, 0.0)
    assert float(at_rest.toe_stress) == force / (WIDTH * THICKNESS)
    assert float(at_rest.moment) == 0.0


def test_no_force_no_contact() -> None:
    found = _section([0.0, -1.0], 0.01)
    for name in ("contact_length", "toe_stress", "moment"):
        assert found[name].values.tolist() == [0.0, 0.0]


test_wrong_arguments = refusals(
    lambda force, theta, changes: _section(force, theta, **changes),
    ([1.0, 2.0], [1.0, 2.0, 3.0], {}, "theta = .*: must be one number, or as many as N"),
    ("x", 0.1, {}, "N = "),
    (1e6, 0.1, {"k": -1.0}, "k = -1.0: must be a finite number > 0"),
    (1e6, 0.1, {"width": 0.0}, "width = 0.0: must be a finite number > 0"),
    (1e6, 0.1, {"thickness": None}, "thickness = "),
    (1e6, 0.1, {"E": 0.0}, "E = 0.0: must be a finite number > 0"),
    (1e6, 0.1, {"f_c": 0.0}, "f_c = 0.0: must be a finite number > 0"),
)


def _storeys(coupling: str, **changes: dict[str, object] | None) -> rwmf.Case:
    return coupled(
        wall=WALL,
        frame={"gamma": None, "T_s": None, "xi_s": 0.03},
        storeys={"n": 6, "m": 60e3, "height": 3.2, "k": 9e7, "coupling": coupling}
        | ({"k_link": 1e8} if coupling == "springs" else {}),
        model={"formulation": "exact"},
        impact={"rule": "coupled", "e": None},
        motion={"kind": "one_sine", "a_max_g": 0.5, "omega_p": None, "T_p": 1.0},
        solver={"t_end": 4.0},
        **changes,
    )


BENDING = {"E": 3e10, "modes": 2}
SCENES = {
    "single mass": lambda: coupled(wall=WALL, solver={"t_end": 3.0}),
    "block": lambda: block(wall=WALL, initial={"theta_over_alpha": 0.3}, solver={"t_end": 2.0}),
    **{
        name: (lambda name=name: _storeys(name))
        for name in ("reduced", "full", "every_floor", "springs")
    },
    "bending": lambda: _storeys("every_floor", bending=BENDING),
    "bending, springs": lambda: _storeys("springs", bending=BENDING),
    "vertical": lambda: _storeys("full", vertical={"ratio": 0.5}),
}


@pytest.mark.parametrize(
    ("name", "f_c"), [*((name, None) for name in SCENES), ("single mass", 5e6), ("bending", 1e7)]
)
def test_maxima_are_those_of_the_formulas(name: str, f_c: float | None) -> None:
    """Columns are the formula at the pivot's force; peaks bound them; the motion is the same."""
    case, section = SCENES[name](), SECTION | {"f_c": f_c}
    with_strip = case.replace(base_section=section, output={"reactions": True, "dt": 2e-3})
    run = rwmf.simulate(with_strip)
    theirs = _section(run.pivot_normal.values, run.theta.values, E=3e10, f_c=f_c)
    for column in ("contact_length", "toe_stress", "toe_strain"):
        np.testing.assert_allclose(run[column].values, theirs[column].values, rtol=1e-13)
    assert float(run.toe_stress_max) >= run.toe_stress.values.max() * (1 - 1e-9)
    assert float(run.contact_length_min) <= run.contact_length.values.min() * (1 + 1e-9)
    # a bending wall is struck at its landings: columns miss the shortest peaks
    if "bending" not in name:
        assert float(run.toe_stress_max) == pytest.approx(run.toe_stress.values.max(), rel=2e-3)
    crushes = f_c is not None and float(run.toe_stress_max) == f_c
    assert ("the toe crushes" in run.attrs["warnings"]) == crushes
    assert (float(run.toe_strain_max) == float(run.toe_stress_max) / 3e10) != crushes
    without = rwmf.simulate(case.replace(output={"reactions": True, "dt": 2e-3})).flat()
    found = run.flat()
    for key, value in without.items():
        if key not in ("seconds", "rhs_evaluations", "warnings"):
            assert found[key] == value or math.isnan(value), key


@pytest.mark.parametrize(("share", "word"), [(0.59, ""), (0.61, "0.6 f_c"), (1.01, "crushes")])
def test_warnings_of_the_toe(share: float, word: str) -> None:
    """At a stress above 0.6 f_c, and at f_c; none below, and none without f_c."""
    case = coupled(wall=WALL, base_section=SECTION, solver={"t_end": 3.0})
    free = rwmf.simulate(case.replace(output={"reactions": True}))
    stress = float(free.toe_stress_max)
    output = {"reactions": True}
    run = rwmf.simulate(case.replace(base_section={"f_c": stress / share}, output=output))
    toe = [line for line in run.attrs["warnings"].splitlines() if "toe" in line]
    assert [word in line for line in toe] == ([True] if word else [])
    assert "toe" not in free.attrs["warnings"]


def test_two_keys_give_the_third() -> None:
    """K = E/length, whichever two are given; k alone has no strain."""
    case = coupled(wall=WALL, output={"reactions": True}, solver={"t_end": 3.0})
    keys = ({"k": K, "E": 2.5e10}, {"k": K, "length": 2.5}, {"E": 2.5e10, "length": 2.5})
    runs = [rwmf.simulate(case.replace(base_section=given)).flat() for given in keys]
    assert [[run[key] for key in DEMANDS] for run in runs[1:]] == [
        [runs[0][key] for key in DEMANDS]
    ] * 2
    alone = rwmf.simulate(case.replace(base_section={"k": K})).flat()
    assert "toe_strain_max" not in alone
    assert alone["toe_stress_max_Pa"] == runs[0]["toe_stress_max_Pa"]


def test_every_interface_has_the_same_bits(tmp_path: Path, batch: Runner) -> None:
    """Run, spectrum, sweep, and the batch program."""
    case = coupled(
        wall=WALL, base_section=SECTION, output={"reactions": True},
        solver={"t_end": 3.0, "method": "dop853"},
    )  # fmt: skip
    run = rwmf.simulate(case).flat()
    spectrum = rwmf.spectrum(case, T_s=case.frame.T_s, quantities=DEMANDS)
    sweep = rwmf.sweep(case, quantities=DEMANDS)
    names = ("contact_length_min", "toe_stress_max", "toe_strain_max")
    for key, name in zip(DEMANDS, names, strict=True):
        assert float(spectrum[name].squeeze()) == run[key]
        assert float(sweep[name].squeeze()) == run[key]
    path = tmp_path / "case.nml"
    case.to_namelist(path)
    done = batch(path)
    assert not done.returncode, done.stderr
    _, rows = read_table(tmp_path / "case.summary.csv")
    assert [float(rows[0][key]) for key in DEMANDS] == [run[key] for key in DEMANDS]


REFUSED = [
    ({"E": 3e10}, {}, r"&base_section.*: the key k is missing \(subgrade modulus\)"),
    ({"length": 2.0}, {}, r"&base_section.*: the key k is missing"),
    (SECTION | {"length": 2.0}, {}, "k = .*must not be given beside E and length"),
    (SECTION, {"wall": WALL | {"thickness": None, "density": None, "m_w": 1e5}}, "thickness"),
    (SECTION | {"k": -1.0}, {}, "k = -1.0: must be a number > 0"),
]


test_refused = refusals(
    lambda section, changes: coupled(**{"wall": WALL, **changes, "base_section": section}),
    *REFUSED,
)


def test_other_bases_are_refused() -> None:
    with pytest.raises(rwmf.InputError, match=r"&base_section.*base = 'pinned'"):
        coupled(wall=WALL | {"base": "pinned"}, impact=None, cable=None, base_section=SECTION)
    with pytest.raises(rwmf.InputError, match=r"&base_section.*&wall"):
        bare_frame(base_section=SECTION)
