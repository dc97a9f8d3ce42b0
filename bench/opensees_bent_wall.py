"""The building with a wall that bends: OpenSees beside rwmf, and the page of it.

``python bench/opensees_bent_wall.py [NAME ...]`` computes variants of
``validation/six_storeys_wall.nml`` in OpenSees, and stores them in ``validation/opensees``:
``bent_wall_peaks.csv`` and ``bent_wall_NAME.csv``. It needs RWMF_OPENSEES, a Python that has
``openseespy``. ``--page`` writes ``docs/validation/bending.md`` from the stored peaks and from runs
of rwmf.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import rwmf
from opensees_cases import ask
from reproduce.engines import write

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))
STORE = ROOT / "validation" / "opensees"
PEAKS = STORE / "bent_wall_peaks.csv"
PAGE = ROOT / "docs" / "validation" / "bending.md"
# concrete: modulus [Pa], damping ratio of the wall, Poisson's ratio; stiffness of a link [N/m]
MODULUS, XI, NU, LINK = 30e9, 0.02, 0.2, 5e8
G = 9.81
# end of the computation [s]
MOTIONS = {"elcentro": 6.0, "pulse": 3.0}
VARIANTS: dict[str, dict[str, Any]] = {
    "rigid": {"is_rigid": True},
    "bent": {},
    "springs": {"link": LINK},
    "shear": {"nu": NU},
    "shear_springs": {"nu": NU, "link": LINK},
}
# variants of El Centro whose beams have the axial stiffness of the section, as a real wall has
OWN = ("bent", "springs", "shear", "shear_springs")
STORED = (
    "theta_rad",
    "tip_deflection_m",
    "storey_1_drift",
    "storey_6_drift",
    "floor_2_acceleration_g",
    "floor_6_acceleration_g",
    "link_6_force_N",
    "wall_moment_base_N_m",
    "wall_moment_2_N_m",
)


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation: none of them belongs to the structure.

    Attributes
    ----------
    elements : int
        Number of beams over the height of the wall.
    stiffness : float
        Stiffness of the pad under each corner [N/m].
    contact_ratio : float
        Stiffness of the spring without tension over that of its pad [-].
    damping_ratio : float
        Of the rigid wall that moves vertically on both its pads [-].
    axial_ratio : float
        Axial stiffness of the wall over that of its section [-].
    rigid_beta : float
        Damping of the beams of a rigid wall over their stiffness [s].
    blow, rigid_blow : float
        Time after a landing in which the forces of the wall, or all demands of a rigid one, do not
        count [s].
    landed : float
        Rotation below which both corners are down [rad].
    turn_interval : float
        Interval of the mean angular acceleration [s].
    dt : float
        Time step [s].
    integrator : tuple
        Integrator of OpenSees and its parameters.
    stored_interval : float
        Interval of the stored history [s].
    stored : tuple of str
        Columns of the stored history.
    """

    elements: int = 24
    stiffness: float = 1e12
    contact_ratio: float = 10.0
    damping_ratio: float = 1.0
    axial_ratio: float = 1e3
    rigid_beta: float = 1e-4
    blow: float = 1e-3
    rigid_blow: float = 25e-3
    landed: float = 4e-6
    turn_interval: float = 1e-3
    dt: float = 5e-5
    integrator: tuple[str | float, ...] = ("Newmark", 0.5, 0.25)
    stored_interval: float = 0.02
    stored: tuple[str, ...] = STORED


def main() -> None:
    """Compute variants, or write the page."""
    names = [f"{motion}_{variant}" for motion in MOTIONS for variant in VARIANTS]
    names += [f"own_{variant}" for variant in OWN]
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="example: python bench/opensees_bent_wall.py elcentro_springs",
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of {', '.join(names)}")
    parser.add_argument("--page", action="store_true", help=f"write {PAGE.name} instead")
    options = parser.parse_args()
    if options.page:
        from bent_wall_page import page

        PAGE.write_text(page(read_peaks()), encoding="utf-8")
        return
    for name in options.names or names:
        started = time.perf_counter()
        motion, _, variant = name.partition("_")
        engine = Engine(dt=2.5e-5 if variant == "rigid" else 5e-5)
        if motion == "own":
            motion, engine = "elcentro", replace(engine, axial_ratio=1.0)
        found = ask("bent_wall.py", scene(motion, **VARIANTS[variant]), asdict(engine))
        store(name, found, engine)
        print(f"{name}: {time.perf_counter() - started:.0f} s", flush=True)


def scene(
    motion: str, *, is_rigid: bool = False, link: float | None = None, nu: float | None = None
) -> dict[str, Any]:
    """Return the numbers of a variant, in N, kg, m, s."""
    from bending_parts import Frame, Shapes

    groups = building(link)
    case = rwmf.Case.from_namelist(ROOT / "validation" / "six_storeys_wall.nml")
    wall, m_w = case.wall, case.wall.m_w
    frame = Frame(groups, 2 * wall.h, G)
    inertia = wall.thickness * (2 * wall.b) ** 3 / 12
    shear = 0.0 if nu is None else (1 + nu) * wall.b**2 / (5 * wall.h**2)
    square = Shapes(1, 2 * wall.h, shear).squares[0]
    omega = math.sqrt(square * MODULUS * inertia / m_w / (2 * wall.h) ** 3)
    cable = case.cable
    dt, a = ground(motion)
    return {
        "wall": {
            "h": wall.h,
            "b": wall.b,
            "m_w": m_w,
            "area": 2 * wall.b * wall.thickness,
            "inertia": inertia,
            "modulus": MODULUS,
            "shear_modulus": None if nu is None else MODULUS / 2 / (1 + nu),
            "beta": 2 * XI / omega,
            "is_rigid": is_rigid,
        },
        "g": G,
        "tendon": {
            "k": cable.strands * cable.strand_area * cable.modulus / cable.length,
            "force": cable.strands * cable.strand_area * cable.initial_stress,
        },
        "frame": {
            "m": (np.array(case.storeys.m_over_m_w) * m_w).tolist(),
            "k": (np.array(case.storeys.k_over_m_w) * m_w).tolist(),
            "height": list(case.storeys.height),
            "z": np.cumsum(case.storeys.height).tolist(),
            "c": (frame.damping * m_w).tolist(),
        },
        "links": None if link is None else [link] * len(case.storeys.height),
        "dt": dt,
        "a": a.tolist(),
        "t_end": MOTIONS[motion],
    }


def building(link: float | None) -> dict[str, dict[str, Any]]:
    """Return the groups of the building without bending, for its matrix of damping."""
    case = rwmf.Case.from_namelist(ROOT / "validation" / "six_storeys_wall.nml")
    storeys = {x: list(case.storeys[x]) for x in ("m_over_m_w", "k_over_m_w", "height")}
    storeys |= {"coupling": "every_floor"}
    if link is not None:
        storeys |= {"coupling": "springs", "k_link_over_m_w": link / case.wall.m_w}
    return {
        "wall": {"h": case.wall.h, "b": case.wall.b, "m_w": case.wall.m_w},
        "frame": {"xi_s": case.frame.xi_s},
        "storeys": storeys,
        "cable": {x: case.cable[x] for x in ("eta_0", "eta_alpha", "law")},
        "impact": {"rule": "coupled"},
    }


def ground(motion: str) -> tuple[float, np.ndarray]:
    """Return interval [s] and ground acceleration: El Centro times two, or a sine of 0.6 g, 1 s."""
    if motion == "elcentro":
        file = ROOT / "inputs" / "records" / "elcentro.csv"
        return 0.02, 2 * G * np.loadtxt(file, delimiter=",", skiprows=5, usecols=1)
    t = np.arange(1001) * 1e-3
    return 1e-3, np.append(0.6 * G * np.sin(2 * math.pi * t), [0.0, 0.0])


def store(name: str, found: dict[str, Any], engine: Engine) -> None:
    """Store the history and the peaks of a variant."""
    columns = ("t_s", *STORED)
    facts = {"engine": f"OpenSees {found['version']}", **asdict(engine)}
    rows = np.array([found["history"][key] for key in columns]).T
    write(STORE / f"bent_wall_{name}.csv", facts, rows, columns)
    peaks = read_peaks() if PEAKS.is_file() else {}
    peaks[name] = found["peaks"]
    keys = list(dict.fromkeys(key for values in peaks.values() for key in values))
    with PEAKS.open("w", encoding="utf-8", newline="") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(["peak", *peaks])
        for key in keys:
            table.writerow([key, *(f"{values.get(key, 0.0):.6g}" for values in peaks.values())])


def read_peaks() -> dict[str, dict[str, float]]:
    """Return the stored peaks by variant and name."""
    with PEAKS.open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(stream)
    return {name: {row[0]: float(row[i]) for row in rows} for i, name in enumerate(head) if i > 0}


if __name__ == "__main__":
    main()
