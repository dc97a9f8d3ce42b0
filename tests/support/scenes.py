"""Cases that several tests start from."""

import csv
import math
from pathlib import Path

import rwmf

GROUPS: dict[str, dict[str, object]] = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05},
    "cable": {"eta_0": 1.0, "eta_alpha": 5.0, "law": "linear"},
    "impact": {"rule": "constant", "e": 0.9},
    "motion": {"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * math.pi},
    "model": {"formulation": "symmetric"},
    "solver": {"t_end": 10.0},
}


def coupled(**changes: dict[str, object] | None) -> rwmf.Case:
    """Wall, frame and cable under a one-cosine pulse, with changes."""
    return rwmf.Case(**GROUPS).replace(**changes)


def bare_frame(**changes: dict[str, object] | None) -> rwmf.Case:
    """Frame without wall under a one-cosine pulse, with changes."""
    removed = dict.fromkeys(("wall", "cable", "impact"))
    return rwmf.Case(**GROUPS).replace(**removed, **merged({"frame": {"gamma": None}}, changes))


def block(**changes: dict[str, object] | None) -> rwmf.Case:
    """Free-standing block without motion, with changes."""
    removed = dict.fromkeys(("frame", "cable"))
    quiet = {"kind": "none", "a_max_g": None, "omega_p": None}
    return rwmf.Case(**GROUPS).replace(**removed, **merged({"motion": quiet}, changes))


def record(path: Path, **changes: object) -> dict[str, object]:
    """Return `&motion` of a record in g, over all of its length."""
    pulse = dict.fromkeys(("a_max_g", "omega_p"))
    return {"kind": "record", "file": str(path), "unit": "g"} | pulse | changes


def merged(
    first: dict[str, dict[str, object]], second: dict[str, dict[str, object] | None]
) -> dict[str, dict[str, object] | None]:
    """Join changes of groups; the second overrides the first."""
    both: dict[str, dict[str, object] | None] = dict(first)
    for group, changes in second.items():
        both[group] = None if changes is None else (both.get(group) or {}) | changes
    return both


def read_table(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """Comment lines and rows of a CSV file of the project."""
    lines = path.read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    return comments, list(rows)


# of the wall of `retrofit` [N]
WEIGHT = 4 * 9.6 * 2.0 * 0.35 * 2500.0 * 9.81


# of the retrofit, by a run and by statics
LIMITS: dict[str, float | list[float]] = {
    "storey_drift_max": 0.01,
    "storeys_drift_max": [0.012, 0.012, 0.01, 0.01, 0.01, 0.008],
    "floor_acceleration_max_g": 0.8,
    "tendon_stress_max_Pa": 1.4e9,
    "wall_shears_max_N": [1.5e6, 1.2e6, 1e6, 8e5, 6e5, 4e5],
    "links_force_max_N": 5e5,
    "fuse_stroke_max_m": 0.05,
    "friction_demand_max": 0.5,
    "contact_length_min_m": 0.3,
    "toe_stress_max_Pa": 2.5e7,
    "toe_strain_max": 0.003,
}


def retrofit(coupling: str, **groups: object) -> rwmf.Case:
    """Six storeys with a wall, tendon and fuses, by their dimensions.

    Parameters
    ----------
    coupling : str
        Word of `&storeys`.
    **groups : dict
        Further groups.

    Returns
    -------
    rwmf.Case
        The case.
    """
    storeys = {"n": 6, "m": 1.5e5, "height": 3.2, "T_1": 1.05, "distribution": "linear",
               "coupling": coupling}  # fmt: skip
    return rwmf.Case(
        wall={"h": 9.6, "b": 2.0, "thickness": 0.35, "density": 2500.0},
        frame={"xi_s": 0.03},
        storeys=storeys | ({"k_link": 1e8} if coupling == "springs" else {}),
        cable={"strands": 20, "strand_area": 1.4e-4, "modulus": 1.95e11, "initial_stress": 6e8,
               "law": "truss"},
        fuse={"F_y": 3e5, "k": 1.5e8},
        impact={"rule": "coupled"},
        base_section={"k": 1e10, "E": 3e10},
        **groups,
    )  # fmt: skip
