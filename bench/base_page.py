"""The page docs/validation/base.md: a base that gives beside published closed forms.

``.venv/bin/python bench/base_page.py`` writes it. Forces and moments of the program follow from the
accelerations of its runs, by the balance of the rigid wall.
"""

import math
import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np
import rwmf
import xarray as xr
from common import ROOT, fill, table
from rwmf import sections, studies
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

G = 9.81
PAGE = ROOT / "docs" / "validation" / "base.md"
TEXT = ROOT / "bench" / "base_text.md"
# half height and half width [m], stiffness of the base over m_w [1/(m s2)]
H, B, KAPPA = 2.0, 0.5, 2e4
# M over that of a rigid corner on a half space, at rotations: Avgenakis and Psycharis 2020
HALF_SPACE = {0.002: 0.89, 0.005: 0.96, 0.01: 0.98, 0.02: 0.99}


def run(groups: str, dt: float, t_end: float, folder: Path | None = None) -> xr.Dataset:
    """Run a case from its groups, with a history."""
    text = f"{groups}\n&solver rtol=1e-10, t_end={t_end!r} /\n"
    case = rwmf.Case.from_text(text, folder / "case.nml") if folder else rwmf.Case.from_text(text)
    return rwmf.simulate(case.replace(output={"dt": dt, "conditioning": False}))


def held_moment(kappa: float, theta: float, base: str = "", h: float = H, b: float = B) -> float:
    """Moment of the base under a wall held at a rotation, over m_w [m2/s2], from theta''."""
    alpha = math.atan2(b, h)
    start = run(
        f"&wall h={h!r}, b={b!r} /\n&base k_t_over_m_w={kappa!r}{base} /\n"
        f"&initial theta_over_alpha={theta / alpha!r} /\n&motion kind='none' /",
        1e-3,
        1e-3,
    )
    s, c = math.sin(theta), math.cos(theta)
    inertia = (4 * h**2 + b**2) / 3 - (h * s) ** 2
    return (G * h * s - inertia * float(start.theta_ddot[0])) / c


def winkler_moment(kappa: float, theta: float, b: float = B) -> float:
    """Return the closed form of a strip without tension (Chopra and Yim 1985)."""
    s = math.sin(theta)
    contact = math.sqrt(2 * G / (kappa * s))
    return G * (b - contact / 3) if contact < 2 * b else 2 * kappa * b**3 * s / 3


def two_spring_moment(kappa: float, theta: float, b: float = B) -> float:
    """Two springs with the stiffness of the strip in full contact (Psycharis and Jennings 1983)."""
    arm = b / math.sqrt(3)
    return min(2 * kappa * b * arm**2 * math.sin(theta), G * arm)


def moments() -> str:
    """Compare moments at held rotations."""
    lifts = G / (2 * B**2 * KAPPA)
    rows = []
    for ratio in (0.5, 1.0, 2.0, 5.0, 20.0, 100.0):
        theta = ratio * lifts
        found, strip = held_moment(KAPPA, theta), winkler_moment(KAPPA, theta)
        rows.append(
            [
                f"{ratio:g}",
                f"{found / (G * B):.6f}",
                f"{strip / (G * B):.6f}",
                f"{abs(found / strip - 1):.0e}",
                f"{two_spring_moment(KAPPA, theta) / (G * B):.4f}",
            ]
        )
    heads = ["rotation over that at uplift", "rwmf", "strip", "difference", "two springs"]
    return table(heads, rows)


def contract() -> str:
    """Compare the moment of a wall with B = 4 m and N = 3.07 MN, and of one whose toe crushes."""
    mass, k, t = 3.07e6 / G, 1e10, 0.35
    kappa, rows = k * t / mass, []
    for theta in map(math.asin, (0.001, 0.005, 0.01)):
        found = held_moment(kappa, theta, h=8.0, b=2.0) * mass
        expected = winkler_moment(kappa, theta, 2.0) * mass
        section = sections.base_section(3.07e6, theta, width=4.0, thickness=t, k=k)
        rows.append(
            [f"elastic, {theta:.3f}", f"{found / 1e6:.6f}", f"{expected / 1e6:.6f}",
             f"{float(section.moment) / 1e6:.6f}"]
        )  # fmt: skip
    for theta in map(math.asin, (0.005, 0.01)):
        # the toe crushes: an elastic core next to a contact with the strength
        strength = 30e6
        core = strength / (k * math.sin(theta))
        length = 3.07e6 / (strength * t) + core / 2
        moment = 3.07e6 * 2.0 - t * strength * (
            (length - core) ** 2 / 2 + (length - core) * core / 2 + core**2 / 6
        )
        found = held_moment(kappa, theta, f", d_y={strength / k!r}, strips=200", 8.0, 2.0) * mass
        rows.append([f"crushes, {theta:.3f}", f"{found / 1e6:.6f}", f"{moment / 1e6:.6f}", ""])
    return table(["strip, rotation (rad)", "rwmf", "closed form", "`rwmf.base_section`"], rows)


def energy(theta: float) -> tuple[float, float, float]:
    """Potential of a quasi-static settlement, z and dz/dtheta."""
    s, c = abs(math.sin(theta)), math.cos(theta)
    if s <= G / (2 * B**2 * KAPPA):
        z, slope = -G / (2 * B * KAPPA), 0.0
        strain = KAPPA * (B * z**2 + B**3 * s**2 / 3)
    else:
        contact = math.sqrt(2 * G / (KAPPA * s))
        # the free end of the contact is z = s (b - contact)
        z = s * (B - contact)
        slope = c * (B - contact / 2)
        strain = KAPPA * s**2 * contact**3 / 6
    return strain + G * (z + H * c), z, slope


def closed_period(start: float) -> float:
    """Period of free rocking from a rotation, the settlement following statically."""

    def time(angle: float) -> float:
        theta = start * math.sin(angle)
        potential, _, slope = energy(theta)
        gone = energy(start)[0] - potential
        inertia = (4 * H**2 + B**2) / 3 + slope**2 - 2 * H * math.sin(theta) * slope
        return start * math.cos(angle) * math.sqrt(inertia / (2 * gone))

    parts = sorted({0.0, math.asin(min(1.0, G / (2 * B**2 * KAPPA) / start)), math.pi / 2})
    return 4 * sum(quad(time, a, e * (1 - 1e-12), epsabs=1e-11)[0] for a, e in pairwise(parts))


def measured_period(start: float) -> float:
    """Twice the time between the first two zeros of the rotation of an elastic base."""
    guess = closed_period(start)
    response = run(
        f"&wall h={H}, b={B} /\n&base k_t_over_m_w={KAPPA} /\n&motion kind='none' /\n"
        f"&initial theta_over_alpha={start / math.atan2(B, H)!r} /",
        guess / 4000,
        guess,
    )
    theta, time = response.theta.values, response.time.values
    at = np.flatnonzero(theta[:-1] * theta[1:] < 0)[:2]
    zeros = time[at] - theta[at] * (time[at + 1] - time[at]) / (theta[at + 1] - theta[at])
    return float(2 * (zeros[1] - zeros[0]))


def periods() -> str:
    """Compare periods of free rocking over the amplitude."""
    lifts, rows = G / (2 * B**2 * KAPPA), []
    linear = 2 * math.pi / 17.43760745762313
    for ratio in (0.5, 1.0, 2.0, 5.0, 20.0, 100.0):
        found, expected = measured_period(ratio * lifts), closed_period(ratio * lifts)
        rows.append(
            [f"{ratio:g}", f"{found / linear:.5f}", f"{expected / linear:.5f}",
             f"{found / expected - 1:+.1e}"]
        )  # fmt: skip
    return table(["amplitude over rotation at uplift", "rwmf", "closed form", "difference"], rows)


def released(damping: float, stiffness: float, time: np.ndarray) -> np.ndarray:
    """Motion of a linear oscillator that is let go at 1."""
    root = np.sqrt(complex(damping**2 / 4 - stiffness))
    if root == 0:
        return np.exp(-damping / 2 * time) * (1 + damping / 2 * time)
    motion = np.cosh(root * time) + damping / 2 / root * np.sinh(root * time)
    return np.exp(-damping / 2 * time) * motion.real


def vertical() -> list[list[str]]:
    """Compare the bounce on the base after a step of the vertical motion."""
    rows = []
    for xi in (0.0, 0.2, 1.0):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / "step.csv").write_text("0.0, 0.1\n0.5, 0.1\n", encoding="utf-8")
            response = run(
                f"&wall h={H}, b={B} /\n&base k_t_over_m_w={KAPPA}, xi={xi} /\n"
                "&motion kind='none' /\n&vertical file='step.csv', unit='g' /",
                1e-3,
                0.2,
                Path(name),
            )
        omega = math.sqrt(2 * B * KAPPA)
        free = released(2 * xi * omega, omega**2, response.time.values)
        expected = -G / omega**2 - 0.1 * G / omega**2 * (1 - free)
        error = np.max(np.abs(response.base_height.values - expected)) / (0.1 * G / omega**2)
        rows.append([f"bounce, xi = {xi}", f"{error:.0e}"])
    return rows


def rocking() -> list[list[str]]:
    """Compare damped rocking in full contact (viscoelastic: Palmeri and Makris 2008)."""
    rows = []
    for xi in (0.0, 0.2, 1.0):
        start = 1e-7 * math.atan2(B, H)
        response = run(
            f"&wall h={H}, b={B} /\n&base k_t_over_m_w={KAPPA}, xi={xi} /\n"
            "&initial theta_over_alpha=1e-7 /\n&motion kind='none' /",
            0.01,
            1.0,
        )
        inertia = (4 * H**2 + B**2) / 3
        stiffness = 2 * B**3 * KAPPA / 3
        damping = 2 * xi / math.sqrt(2 * B * KAPPA) * stiffness / inertia
        expected = start * released(damping, (stiffness - G * H) / inertia, response.time.values)
        error = np.max(np.abs(response.theta.values - expected)) / start
        rows.append([f"rocking in full contact, xi = {xi}", f"{error:.0e}"])
    return rows


def half_space() -> tuple[str, float]:
    """Fit the stiffness of the strip to the moments on a half space."""

    def worst(log_kappa: float) -> float:
        return max(
            abs(winkler_moment(10**log_kappa, theta) / (G * B) / ratio - 1)
            for theta, ratio in HALF_SPACE.items()
        )

    kappa = float(10 ** minimize_scalar(worst, bounds=(3, 7), method="bounded").x)
    rows = []
    for theta, ratio in HALF_SPACE.items():
        found = held_moment(kappa, theta) / (G * B)
        rows.append([f"{100 * theta:g} %", f"{found:.3f}", f"{ratio:.2f}",
                     f"{100 * (found / ratio - 1):+.1f} %"])  # fmt: skip
    return table(["rotation", "rwmf", "half space", "difference"], rows), kappa


def restitutions() -> str:
    """Tabulate the equivalent factor of a free block."""
    stiffnesses, rows = (2e4, 2e5, 2e6), []
    for xi in (0.0, 0.2, 1.0, 3.0):
        factors = [
            float(
                studies.restitution(
                    rwmf.Case.from_text(
                        f"&wall h={H}, b={B} /\n&base k_t_over_m_w={kappa}, xi={xi} /\n"
                        "&motion kind='none' /\n&solver rtol=1e-9, t_end=3.0 /\n"
                    )
                ).e
            )
            for kappa in stiffnesses
        ]
        rows.append([f"xi = {xi:g}", *(f"{e:.3f}" for e in factors)])
    heads = ["b/h = 0.25, let go at 0.5 alpha"]
    return table([*heads, *map("kappa = {:.0e}".format, stiffnesses)], rows)


def main() -> None:
    """Write the page."""
    half, kappa = half_space()
    parts = {
        "moments": moments(),
        "contract": contract(),
        "periods": periods(),
        "linear": table(["motion", "largest difference"], [*vertical(), *rocking()]),
        "half space": half,
        "fitted": f"{kappa * B / G:.3g}",
        "restitution": restitutions(),
    }
    PAGE.write_text(fill(TEXT, **parts), encoding="utf-8")


if __name__ == "__main__":
    main()
