"""Seeded generator of random scenes: all formulations, pulses and records."""

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import rwmf

_FORMULATIONS = ("published", "symmetric", "exact")


def random_cases(n: int, seed: int, records: Path) -> Iterator[rwmf.Case]:
    """Yield scenes within the range of engineering practice.

    Parameters
    ----------
    n
        Number of cases.
    seed
        The same seed gives the same cases.
    records
        Folder with `elcentro.csv` and `pacoima.csv` as `rwmf records export` writes them.

    Yields
    ------
    rwmf.Case
        h 0.5 to 8 m, tan(alpha) 0.1 to 0.6, gamma 2 to 20000, T_s 0.16 to 3.2 s, e 0.7 to 1.
    """
    generator = np.random.default_rng(seed)
    for _ in range(n):
        text, source = _random_text(generator, records)
        yield rwmf.Case.from_text(text, source=source)


def with_storeys(case: rwmf.Case, n: int) -> rwmf.Case:
    """Put a frame of equal storeys and of the same first period in the place of a case's frame.

    Parameters
    ----------
    case
        With a wall, and a frame of one degree of freedom.
    n
        Number of storeys.

    Returns
    -------
    rwmf.Case
        All modes; the floors together weigh as much as the frame, 20 walls at most.
    """
    mass = min(case.frame.gamma, 20.0) / n
    # lowest frequency of a chain of equal masses and springs
    lowest = 2 * math.sin(math.pi / (4 * n + 2))
    stiffness = mass * (2 * math.pi / (case.frame.T_s * lowest)) ** 2
    return case.replace(
        frame={"T_s": None, "gamma": None},
        storeys={
            "m_over_m_w": [mass] * n,
            "k_over_m_w": [stiffness] * n,
            "height": [2 * case.wall.h / n] * n,
            "coupling": "full",
        },
        model={"formulation": "exact"},
    )


def _random_text(generator: np.random.Generator, records: Path) -> tuple[str, Path]:
    x = [float(value) for value in generator.random(14)]
    h = 0.5 + 7.5 * x[0]
    formulation = _FORMULATIONS[int(3 * x[1])]
    law = "truss" if formulation != "published" and x[2] < 0.3 else "linear"
    eta_0 = 3 * x[3]
    lines = [
        f"&wall h = {h!r}, b = {h * (0.1 + 0.5 * x[4])!r} /",
        f"&frame T_s = {0.16 * 20 ** x[5]!r}, gamma = {2 * 10 ** (4 * x[6])!r},"
        f" xi_s = {0.1 * x[7]!r} /",
        f"&cable eta_0 = {eta_0!r}, eta_alpha = {eta_0 + 10 * x[8]!r}, law = '{law}' /",
        f"&impact e = {0.7 + 0.3 * x[9]!r} /",
        f"&model formulation = '{formulation}' /",
    ]
    if x[10] < 0.4:
        # the second one is in PEER's AT2 format, which has its unit
        file = "'elcentro.csv', unit = 'g'" if x[11] < 0.5 else "'pacoima.csv'"
        lines.append(f"&motion kind = 'record', file = {file}, scale = {0.5 + 2 * x[12]!r} /")
    else:
        kind = "one_sine" if x[10] < 0.7 else "one_cosine"
        omega = 2 * math.pi / (0.3 + 2 * x[11])
        lines.append(
            f"&motion kind = '{kind}', a_max_g = {0.05 + 0.8 * x[12]!r}, omega_p = {omega!r} /"
        )
        lines.append("&solver t_end = 10.0 /")
    return "\n".join(lines) + "\n", records / "random.nml"
