"""The table of quantities names all reported quantities, and no others: scenes of every kind."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pairs
import pytest
import rwmf
from checkout import ROOT
from random_cases import random_cases
from rwmf.case.namelist import compose
from rwmf.cli.many_cases import _spectrum_object
from rwmf.run import quantities, simulation
from rwmf.run.quantities import ORDINATES as SWEPT
from rwmf.run.quantities import QUANTITIES

_KINDS = {"real": float, "int": int, "logical": bool, "text": str, "list": list}
# quantities that no effect reports by itself
_FURTHER: list[pairs.Groups] = [
    {"wall": {"h": 2.0, "b": 0.5, "m_w": 1000.0}, "cable": pairs.CABLE},
    {"output": {"reactions": True, "friction_limit": 0.01}},
    {"wall": {"h": 2.0, "b": 0.5, "shear_key": True, "m_w": 1000.0}},
    {"solver": {"t_end": 1.0, "verify": True}},
    {
        "wall": {"h": 2.0, "b": 0.5, "density": 2400.0, "thickness": 0.2},
        "base_section": {"E": 3e10, "length": 0.5},
    },
]
Report = tuple[dict[str, Any], list[str]]


def _named(output: str) -> list[str]:
    return [key for key, row in QUANTITIES.items() if output in row.outputs.split()]


def _scenes(folder: Path) -> Iterator[rwmf.Case]:
    """Return every input, random scenes, every effect by itself, and some more."""
    for path in sorted((ROOT / "inputs").glob("*.nml")):
        text = path.read_text(encoding="utf-8").replace("records/", f"{folder}/")
        case = rwmf.Case.from_text(text, folder / path.name)
        yield case.replace(solver={"t_end": 0.5, "verify": None, "accuracy": None})
    for case in random_cases(20, 16, folder):
        yield case.replace(solver={"t_end": 0.5})
    # with a mass: forces are reported in N as well
    effects = [_with_mass(groups) for groups in map(pairs.joined, pairs.EFFECTS.values())]
    for groups in (*effects, *(pairs.SCENE | more for more in _FURTHER)):
        yield rwmf.Case.from_text(compose(groups), folder / "pair.nml")


def _with_mass(groups: pairs.Groups) -> pairs.Groups:
    if "wall" not in groups:
        return groups
    return groups | {"wall": groups["wall"] | {"m_w": 1000.0}}


def _report(case: rwmf.Case) -> Report:
    with simulation.start(case) as run:
        return run.summary(), run.history()[0]


@pytest.fixture(scope="module")
def reports(
    elcentro: Path, pacoima: Path, tmp_path_factory: pytest.TempPathFactory
) -> list[Report]:
    """Keys and columns in the kernel's own order."""
    folder = tmp_path_factory.mktemp("scenes")
    pairs.prepare(folder)
    for path in (elcentro, pacoima):
        (folder / path.name).symlink_to(path)
    found = []
    for case in _scenes(folder):
        asked = {"dt": 0.1, "energy": True, "reactions": True}
        found += [_report(case.replace(output=None)), _report(case.replace(output=asked))]
    return found


def _places(keys: list[str]) -> list[int]:
    """Places in the table; a number of a storey does not count."""
    order = list(QUANTITIES)
    return [order.index(re.sub(r"(?<=_)\d+(?=_)", "{i}", key)) for key in keys]


@pytest.mark.parametrize("output", ["run", "history"])
def test_table_is_what_is_reported(reports: list[Report], output: str) -> None:
    """All reported quantities are in the table, in its order, and every row is reported."""
    order = list(QUANTITIES)
    seen: set[str] = set()
    for summary, columns in reports:
        places = _places(list(summary) if output == "run" else columns)
        assert places == sorted(places)
        seen |= {order[place] for place in places}
    # no effect of today limits a drift, and no wall of the inputs leaves its base
    awaited = {"collapsed", "t_collapse_s", "t_flight_first_s"} if output == "run" else set()
    assert seen | awaited == set(_named(output))


def test_kinds(reports: list[Report]) -> None:
    """Values in Python have the type in the table."""
    for summary, _ in reports:
        for key, value in summary.items():
            assert type(value) is _KINDS[quantities.find(key).kind], key


def test_grids(elcentro: Path) -> None:
    del elcentro
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig12_one_cosine.nml")
    found = rwmf.spectrum(case, T_s=[0.5])
    assert set(_spectrum_object(found)) == set(_named("spectrum"))
    swept = rwmf.sweep(case, {"T_s": [0.5], "gamma": [5.0]})
    assert set(swept) == {QUANTITIES[key].name or key for key in _named("sweep")}
    for name, row in SWEPT.items():
        assert name in row.names("ordinate")
        assert row.kind in ("real", "int", "logical")


def test_names_of_variables_are_without_units() -> None:
    """Attributes of a run have no dimension, apart from its cost and method."""
    for key, row in QUANTITIES.items():
        if "run" in row.outputs.split() and not row.name:
            assert row.found in ("work", "error") or row.kind in ("text", "list") or key == "rtol"
        suffix = "_" + row.unit.replace("/", "_per_" if row.unit == "J/kg" else "_")
        for output in ("history", "run"):
            for name in row.names(output)[:1]:
                assert not name.endswith(suffix) or name in ("T_s", "u_s"), name


def test_a_name_without_unit_stands_beside_one_that_has_it() -> None:
    """Each kind of dataset has the names; requests accept both names, in any letters."""
    scene = pairs.SCENE | {"wall": {"h": 2.0, "b": 0.5, "m_w": 1000.0}, "cable": pairs.CABLE}
    case = rwmf.Case.from_text(compose(scene)).replace(
        output={"dt": 0.01, "energy": True, "reactions": True}
    )
    run = rwmf.simulate(case)
    both = {name: row.names("run") for name, row in QUANTITIES.items() if row.unit == "J/kg"}
    assert both["energy_impact_J_per_kg"] == ("energy_impact_end", "energy_impact_J_per_kg")
    for first, second in (names for names in both.values() if names[1] in run):
        assert run[first].identical(run[second].rename(first))
        assert float(run[first]) == float(run[first.removesuffix("_end")][-1])
    assert run["pivot_normal"].identical(run["pivot_normal_N"].rename("pivot_normal"))
    assert all("units" in run[name].attrs for name in run.data_vars)
    names = ["Energy_impact_END", "energy_input_J_per_kg"]
    grid = rwmf.spectrum(case, T_s=[0.5], quantities=names)
    ends = ["energy_impact_end", "energy_input_end"]
    assert set(grid) == {
        "status",
        *ends,
        *(f"energy_{part}_J_per_kg" for part in ("impact", "input")),
    }
    shown = _spectrum_object(grid)
    assert {"energy_impact_J_per_kg", "energy_input_J_per_kg"} <= set(shown)
    assert not set(ends) & set(shown)
    swept = rwmf.sweep(case, {"T_s": [0.5]}, quantities=names)
    assert set(swept) == {"energy_impact_end", "energy_input_J_per_kg", "status"}
    assert float(swept["energy_impact_end"].squeeze()) == float(grid["energy_impact_end"].squeeze())


def test_drift_of_the_frame_is_that_of_its_roof() -> None:
    for key in ("frame_drift", "frame_drift_max"):
        assert "roof, over the wall's height" in QUANTITIES[key].meaning


def test_numbers_of_storeys() -> None:
    row = quantities.find("floor_12_m")
    assert (row.name, row.meaning) == ("floor_12", "displacement of floor 12")
    assert quantities.find("storey_3_residual_drift").unit == "1"


def test_every_ratio_to_a_weight_has_its_force() -> None:
    """Each quantity in N names its ratio, and each ratio to a weight has a quantity in N."""
    text = (ROOT / "src/rwmf/problem/quantity_rows.table").read_text(encoding="utf-8")
    rows = re.findall(r"^([^#\s]\S*), (.*?) \|.*\n((?: .*\n)+)", text, re.MULTILINE)
    assert [key for key, _, _ in rows] == list(QUANTITIES)[: len(rows)]
    ratios = {key: re.findall(r"\bratio = ([\w{}]+)", body) for key, _, body in rows}
    for key, unit, _ in rows:
        assert len(ratios[key]) == (unit in ("N", "N m")), key
        # the name in N of the first two is that of wall and frame together
        if (place := re.search("_over_(m_w_g|weight|m_s_g)", key)) and key not in (
            "base_shear_over_m_w_g",
            "base_shear_max_over_m_w_g",
        ):
            assert ratios[f"{key[: place.start()]}_N{key[place.end() :]}"] == [key]
