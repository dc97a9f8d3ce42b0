"""Stored results of OpenSees for a wall that bends: complete, and the targets of the page."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
import rwmf

ROOT = Path(__file__).resolve().parents[3]
STORE = ROOT / "validation" / "opensees"
# end of a history [s]
MOTIONS = {"elcentro": 6.0, "pulse": 3.0}
VARIANTS = ("rigid", "bent", "springs", "shear", "shear_springs")
NAMES = [f"{motion}_{variant}" for motion in MOTIONS for variant in VARIANTS]
# El Centro with the axial stiffness of the section
NAMES += [f"own_{variant}" for variant in VARIANTS[1:]]
FLOORS = range(1, 7)


def peaks() -> dict[str, dict[str, float]]:
    with (STORE / "bent_wall_peaks.csv").open(encoding="utf-8", newline="") as stream:
        head, *rows = csv.reader(stream)
    return {name: {row[0]: float(row[i]) for row in rows} for i, name in enumerate(head) if i > 0}


def test_peaks_of_all_variants_are_stored() -> None:
    stored = peaks()
    assert set(stored) == set(NAMES)
    keys = [f"storey_{i}_drift" for i in FLOORS] + [f"floor_{i}_acceleration_g" for i in FLOORS]
    keys += [f"link_{i}_force_N" for i in FLOORS] + [f"wall_shear_{i}_N" for i in FLOORS]
    keys += [f"wall_moment_{i}_N_m" for i in range(1, 6)]
    keys += ["theta_rad", "wall_moment_base_N_m", "wall_shear_base_N"]
    for name, values in stored.items():
        assert all(values[key] > 0 for key in keys), name


@pytest.mark.parametrize("name", NAMES)
def test_histories_are_complete_and_below_their_peaks(name: str) -> None:
    motion, _, variant = name.partition("_")
    first, head, *rows = (STORE / f"bent_wall_{name}.csv").read_text(encoding="utf-8").splitlines()
    facts = json.loads(first.removeprefix("# "))
    assert facts["engine"].startswith("OpenSees")
    assert facts["axial_ratio"] == (1.0 if motion == "own" else 1e3)
    values = np.array([row.split(",") for row in rows], float).T
    columns = dict(zip(head.split(","), values, strict=True))
    np.testing.assert_allclose(np.diff(columns["t_s"]), 0.02, atol=1e-9)
    assert columns["t_s"][-1] == pytest.approx(MOTIONS.get(motion, MOTIONS["elcentro"]))
    for key in ("theta_rad", "storey_6_drift", "floor_6_acceleration_g"):
        largest = np.abs(columns[key]).max()
        assert 0.3 * peaks()[name][key] < largest, key
        if variant != "rigid":
            assert largest <= peaks()[name][key] * (1 + 1e-5), key


@pytest.mark.parametrize(
    ("variant", "moment_limit"), [("bent", None), ("springs", 0.05), ("shear_springs", 0.05)]
)
def test_el_centro_with_three_modes_meets_the_targets(
    variant: str, moment_limit: float | None, elcentro: Path
) -> None:
    nml = ROOT / "validation" / "six_storeys_wall.nml"
    text = nml.read_text(encoding="utf-8").replace("../inputs/records/elcentro.csv", str(elcentro))
    bending = {"E": 30e9, "modes": 3, "xi": 0.02, "damping": "stiffness"}
    bending |= {"nu": 0.2} if "shear" in variant else {}
    changes = {"bending": bending, "solver": {"t_end": 6.0}}
    if "springs" in variant:
        changes["storeys"] = {"coupling": "springs", "k_link": 5e8}
    run = rwmf.simulate(rwmf.Case.from_text(text).replace(**changes))
    theirs = peaks()[f"elcentro_{variant}"]
    drifts = [theirs[f"storey_{i}_drift"] for i in FLOORS]
    np.testing.assert_allclose(run["storeys_drift_max"], drifts, rtol=0.015)
    roof = float(run["floors_acceleration_max_g"][-1])
    assert roof == pytest.approx(theirs["floor_6_acceleration_g"], rel=0.06)
    if moment_limit:
        moments = [theirs[f"wall_moment_{i}_N_m"] for i in range(1, 5)]
        np.testing.assert_allclose(run["wall_moments_max"][:4], moments, rtol=moment_limit)
        base = theirs["wall_moment_base_N_m"]
        assert float(run["wall_moment_base_max"]) == pytest.approx(base, rel=moment_limit)


def test_statements_on_the_axial_stiffness() -> None:
    """The page names the frequencies, and the demands that the wall's own stiffness changes."""
    page = (ROOT / "docs" / "validation" / "bending.md").read_text(encoding="utf-8")
    height, width, speed = 19.2, 4.0, math.sqrt(30e9 / 2500)
    axial = speed / 4 / height
    third = 7.8547574**2 / (2 * math.pi * height**2) * speed * width / math.sqrt(12)
    assert f"at {axial:.0f} Hz" in page
    assert f"({third:.0f} Hz)" in page
    stored, change = peaks(), {}
    for variant in VARIANTS[1:]:
        for key, own in stored[f"own_{variant}"].items():
            change[variant, key] = abs(own / stored[f"elcentro_{variant}"][key] - 1)
    base = [change[variant, "wall_moment_base_N_m"] for variant in VARIANTS[1:]]
    assert min(base) > 0.15
    for variant in ("springs", "shear_springs"):
        others = {key: x for (name, key), x in change.items() if name == variant}
        assert max(others.pop(f"wall_{x}") for x in ("moment_base_N_m", "shear_2_above_N")) > 0.09
        assert max(others.values()) < 0.075
    for variant in ("bent", "shear"):
        assert max(change[variant, f"storey_{i}_drift"] for i in FLOORS) < 0.01
        assert change[variant, "floor_6_acceleration_g"] < 0.01
        assert change[variant, "wall_shear_base_N"] > 0.1
