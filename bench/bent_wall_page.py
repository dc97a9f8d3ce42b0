"""The page docs/validation/bending.md: OpenSees beside rwmf for bending walls.

``python bench/bent_wall_page.py`` writes it from the peaks of ``validation/opensees`` and from runs
of rwmf.
"""

import csv
import math
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path
from typing import Any

import rwmf
from common import ROOT, fill, table

Peaks = dict[str, float]
CASE = ROOT / "validation" / "six_storeys_wall.nml"
PEAKS = ROOT / "validation" / "opensees" / "bent_wall_peaks.csv"
# concrete: modulus [Pa], damping ratio of the wall, Poisson's ratio; stiffness of a link [N/m]
MODULUS, XI, NU, LINK = 30e9, 0.02, 0.2, 5e8
# end of the computation [s]
MOTIONS = {"elcentro": 6.0, "pulse": 3.0}
# variants of El Centro whose beams have the axial stiffness of the section, as a real wall has
OWN = ("bent", "springs", "shear", "shear_springs")
# key of the peaks, unit, factor to it
ROWS = {
    "storey_1_drift": ("drift of storey 1", "%", 100.0),
    "storey_6_drift": ("drift of storey 6", "%", 100.0),
    "floor_1_acceleration_g": ("acceleration of floor 1", "g", 1.0),
    "floor_2_acceleration_g": ("acceleration of floor 2", "g", 1.0),
    "floor_6_acceleration_g": ("acceleration of the roof", "g", 1.0),
    "wall_moment_base_N_m": ("M at the base", "MN m", 1e-6),
    "wall_moment_1_N_m": ("M at floor 1", "MN m", 1e-6),
    "wall_moment_2_N_m": ("M at floor 2", "MN m", 1e-6),
    "wall_moment_3_N_m": ("M at floor 3", "MN m", 1e-6),
    "wall_moment_4_N_m": ("M at floor 4", "MN m", 1e-6),
    "wall_shear_base_N": ("V at the base", "MN", 1e-6),
    "wall_shear_2_N": ("V below floor 2", "MN", 1e-6),
    "wall_shear_4_N": ("V below floor 4", "MN", 1e-6),
    "link_1_force_N": ("link of floor 1", "MN", 1e-6),
    "link_2_force_N": ("link of floor 2", "MN", 1e-6),
    "link_6_force_N": ("link of the roof", "MN", 1e-6),
}
# largest difference from OpenSees [%], infinite without a target, and the peaks that it is for
TARGETS = {
    "drift": (1.5, [f"storey_{i}_drift" for i in range(1, 7)]),
    "acceleration of the roof": (6.0, ["floor_6_acceleration_g"]),
    "M at floors 1 to 4": (5.0, [f"wall_moment_{i}_N_m" for i in range(1, 5)]),
    "M at the base": (math.inf, ["wall_moment_base_N_m"]),
}
MODES = (2, 3, 4, 6, 8)
TITLES = {
    "bent": "Rigid links",
    "springs": "Links of 500 MN/m",
    "shear": "Rigid links, wall with shear",
    "shear_springs": "Links of 500 MN/m, wall with shear",
}
MOTION_NAMES = {"elcentro": "El Centro times two", "pulse": "a sine of 0.6 g and 1 s"}
TEXT = Path(__file__).parent / "bent_wall_text.md"


def read_peaks() -> dict[str, Peaks]:
    """Return the stored peaks by variant and name."""
    with PEAKS.open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(stream)
    return {name: {row[0]: float(row[i]) for row in rows} for i, name in enumerate(head) if i > 0}


def page(peaks: dict[str, Peaks], pool: ProcessPoolExecutor) -> str:
    """Write the page; all runs of rwmf start before the first result is used."""

    def start(*words: object, **options: object) -> Future[Peaks]:
        return pool.submit(ours, *words, **options)

    compared: dict[tuple[str, str], dict[str, Any]] = {}
    for motion in MOTION_NAMES:
        for variant in TITLES:
            options = {"link": LINK} if "springs" in variant else {}
            columns: dict[str, Any] = {}
            if "shear" not in variant:
                columns["rigid"] = start(motion, 0, **options)
            if variant == "bent":
                columns["rigid FE"] = peaks[f"{motion}_rigid"]
            bending = options | ({"nu": NU} if "shear" in variant else {})
            columns |= {f"{n} modes": start(motion, n, **bending) for n in MODES}
            compared[motion, variant] = columns | {"OpenSees": peaks[f"{motion}_{variant}"]}
    changed = {
        "as above": compared["elcentro", "springs"]["3 modes"],
        "links 250 MN/m": start("elcentro", 3, link=LINK / 2),
        "links 1,000 MN/m": start("elcentro", 3, link=2 * LINK),
        "shear": compared["elcentro", "shear_springs"]["3 modes"],
        "damping 'modal'": start("elcentro", 3, link=LINK, damping="modal"),
        "xi 1 %": start("elcentro", 3, link=LINK, xi=0.01),
    }
    known = {key: _results(columns) for key, columns in compared.items()}
    parts = []
    for motion, words in MOTION_NAMES.items():
        parts.append(f"## {words[0].upper()}{words[1:]}\n")
        parts += [f"### {title}\n\n{demands(known[motion, x])}\n" for x, title in TITLES.items()]
    return fill(
        TEXT,
        tables="\n".join(parts),
        targets=targets(known),
        own_stiffness=own_stiffness(known, peaks),
        changed=demands(_results(changed)),
    )


def _results(columns: dict[str, Any]) -> dict[str, Peaks]:
    return {k: v.result() if isinstance(v, Future) else v for k, v in columns.items()}


def demands(columns: dict[str, Peaks]) -> str:
    """Return rows of demands; differences from the last column where that is OpenSees."""
    names = list(columns)
    compared = [f"{n} modes" for n in (3, MODES[-1])] if names[-1] == "OpenSees" else []
    rows = []
    for key, (label, unit, factor) in ROWS.items():
        cells = [label, unit, *(f"{columns[name][key] * factor:.4g}" for name in names)]
        rows.append([*cells, *(f"{difference(columns, name, key):+.1f} %" for name in compared)])
    return table(["peak", "unit", *names, *(f"diff. {name[0]}" for name in compared)], rows)


def targets(known: dict[tuple[str, str], dict[str, Peaks]]) -> str:
    """Return the largest differences from OpenSees beside their targets."""
    limits = ["-" if limit == math.inf else f"{limit:g} %" for limit, _ in TARGETS.values()]
    rows = [["target", "", *limits]]
    for (motion, variant), columns in known.items():
        for n in (3, MODES[-1]):
            cells = []
            for limit, keys in TARGETS.values():
                largest = max(abs(difference(columns, f"{n} modes", key)) for key in keys)
                cells.append(f"{largest:.1f} %" + ("" if largest <= limit else ", missed"))
            name = {"elcentro": "El Centro", "pulse": "sine"}[motion]
            rows.append([f"{name}, {_small(TITLES[variant])}", str(n), *cells])
    return table(["case", "modes", *TARGETS], rows)


def own_stiffness(known: dict[tuple[str, str], dict[str, Peaks]], peaks: dict[str, Peaks]) -> str:
    """Return the peaks of OpenSees with the wall's own axial stiffness, and differences from them.

    For each variant: the change from the stiff wall, and rwmf with three modes over the own one.
    """
    rows = []
    for key, (label, _, _) in ROWS.items():
        cells = [label]
        for variant in OWN:
            own, columns = peaks[f"own_{variant}"], known["elcentro", variant]
            cells.append(f"{100 * (own[key] / columns['OpenSees'][key] - 1):+.0f} %")
            cells.append(f"{100 * (columns['3 modes'][key] / own[key] - 1):+.0f} %")
        rows.append(cells)
    return table(["peak", *(x for y in OWN for x in (_small(TITLES[y]), "diff. 3"))], rows)


def _small(title: str) -> str:
    return title[0].lower() + title[1:]


def difference(columns: dict[str, Peaks], name: str, key: str) -> float:
    """Return the difference of a column from OpenSees [%]."""
    return 100 * (columns[name][key] / columns["OpenSees"][key] - 1)


def ours(
    motion: str, modes: int, *, link: float | None = None, nu: float | None = None,
    xi: float = XI, damping: str = "stiffness",
) -> Peaks:  # fmt: skip
    """Return the peaks of rwmf by the names of the stored ones; no modes: the rigid wall."""
    changes: dict[str, Any] = {"solver": {"t_end": MOTIONS[motion]}}
    if modes:
        changes["bending"] = {"E": MODULUS, "modes": modes, "xi": xi, "damping": damping}
        changes["bending"] |= {} if nu is None else {"nu": nu}
    if link is not None:
        changes["storeys"] = {"coupling": "springs", "k_link": link}
    if motion == "pulse":
        sine = {"kind": "one_sine", "a_max_g": 0.6, "T_p": 1.0}
        changes["motion"] = dict.fromkeys(("file", "unit", "scale")) | sine
    run = rwmf.simulate(rwmf.Case.from_namelist(CASE).replace(**changes))
    found = {
        "wall_moment_base_N_m": float(run["wall_moment_base_max"]),
        "wall_shear_base_N": float(run["wall_shear_base_max"]),
    }
    for name, key in (
        ("storey_{}_drift", "storeys_drift_max"),
        ("floor_{}_acceleration_g", "floors_acceleration_max_g"),
        ("wall_moment_{}_N_m", "wall_moments_max"),
        ("wall_shear_{}_N", "wall_shears_max"),
        ("link_{}_force_N", "links_force_max"),
    ):
        found |= {name.format(i): float(x) for i, x in enumerate(run[key].values, start=1)}
    return found


if __name__ == "__main__":
    with ProcessPoolExecutor() as pool:
        made = page(read_peaks(), pool)
    (ROOT / "docs" / "validation" / "bending.md").write_text(made, encoding="utf-8")
