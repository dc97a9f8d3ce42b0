"""The page docs/validation/bending.md: OpenSees beside the reference program for bending walls."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import Future, ProcessPoolExecutor
from pathlib import Path
from typing import Any

from bending import BentWall
from bending_demands import Demands
from bending_parts import Ground, Groups
from opensees_bent_wall import LINK, MODULUS, MOTIONS, NU, XI, G, building, ground, scene

Peaks = dict[str, float]
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
MODES = {"bent": (2, 3, 4, 6), "springs": (2, 3, 6)}
TITLES = {
    "bent": "Rigid links",
    "springs": "Links of 500 MN/m",
    "shear": "Rigid links, wall with shear",
    "shear_springs": "Links of 500 MN/m, wall with shear",
}
MOTION_NAMES = {"elcentro": "El Centro times two", "pulse": "a sine of 0.6 g and 1 s"}
TEXT = Path(__file__).parent / "bent_wall_text.md"


def page(peaks: dict[str, Peaks]) -> str:
    """Write the page.

    Parameters
    ----------
    peaks : dict
        Stored peaks of OpenSees by variant and name.

    Returns
    -------
    str
        Text in Markdown.
    """
    with ProcessPoolExecutor() as pool:
        return _page(peaks, pool)


def _page(peaks: dict[str, Peaks], pool: ProcessPoolExecutor) -> str:
    """Write the page; all runs of the reference program are under way from the start."""

    def start(*words: object, **options: object) -> Future[Peaks]:
        return pool.submit(ours, *words, **options)

    parts, tables = [], []
    for motion, words in MOTION_NAMES.items():
        parts.append(f"\n## {words[0].upper()}{words[1:]}\n")
        rigid = {"rigid": start(motion, 0), "OpenSees rigid": peaks[f"{motion}_rigid"]}
        for variant, title in TITLES.items():
            options: dict[str, Any] = {}
            if "springs" in variant:
                options["link"] = LINK
            if "shear" in variant:
                options["nu"] = NU
            columns = dict(rigid) if variant == "bent" else {}
            for modes in MODES.get(variant, (3,)):
                columns[f"{modes} modes"] = start(motion, modes, **options)
            columns["OpenSees"] = peaks[f"{motion}_{variant}"]
            parts.append(f"### {title}\n\n@{len(tables)}@\n")
            tables.append(columns)
    changed = {
        "as above": start("elcentro", 3, link=LINK),
        "links 250 MN/m": start("elcentro", 3, link=LINK / 2),
        "links 1,000 MN/m": start("elcentro", 3, link=2 * LINK),
        "shear": start("elcentro", 3, link=LINK, nu=NU),
        "damping 'modal'": start("elcentro", 3, link=LINK, damping="modal"),
        "xi 1 %": start("elcentro", 3, link=LINK, xi=0.01),
    }
    text = TEXT.read_text(encoding="utf-8")
    text = text.replace("TABLES", "\n".join(parts)).replace("CHANGED", f"@{len(tables)}@")
    for i, columns in enumerate([*tables, changed]):
        known = {k: v.result() if isinstance(v, Future) else v for k, v in columns.items()}
        text = text.replace(f"@{i}@", table(known))
    return text


def table(columns: dict[str, Peaks]) -> str:
    """Return rows of demands; the difference of the last two columns where the last is OpenSees."""
    names = list(columns)
    compares = names[-1] == "OpenSees"
    heads = ["quantity", "unit", *names, *(["difference"] if compares else [])]
    lines = [_row(heads), _row(["---"] * len(heads))]
    for key, (label, unit, factor) in ROWS.items():
        values = [columns[name].get(key, 0.0) * factor for name in names]
        cells = [label, unit, *(f"{x:.4g}" for x in values)]
        if compares:
            cells.append(f"{100 * (values[-2] / values[-1] - 1):+.1f} %")
        lines.append(_row(cells))
    return "\n".join(lines)


def _row(cells: Iterable[str]) -> str:
    return f"| {' | '.join(cells)} |"


def ours(
    motion: str, modes: int, *, link: float | None = None, nu: float | None = None,
    xi: float = XI, damping: str = "stiffness",
) -> Peaks:  # fmt: skip
    """Return the peaks of the reference program by the names of the stored ones."""
    groups: Groups = building(link) | {"solver": {"t_end": MOTIONS[motion]}}
    m_w = groups["wall"]["m_w"]
    if modes:
        stiffness = MODULUS * scene(motion)["wall"]["inertia"] / m_w
        bending = {"EI_over_m_w": stiffness, "modes": modes, "xi": xi, "damping": damping}
        groups["bending"] = bending if nu is None else bending | {"nu": nu}
    dt, a = ground(motion)
    shaking = Ground.pulse({"kind": "one_sine", "a_max_g": 0.6, "T_p": 1.0}, G)
    if motion == "elcentro":
        shaking = Ground.lines([i * dt for i in range(a.size)], a.tolist())
    wall = BentWall(groups, shaking)
    found = {}
    for key, value in Demands(wall).largest(wall.follow()).items():
        name = key.replace("_max", "")
        for ending, unit in (("_over_m_w_g_m", "_N_m"), ("_over_m_w_g", "_N")):
            if name.endswith(ending):
                name, value = name.removesuffix(ending) + unit, value * m_w * G
        found[name] = value
    return found
