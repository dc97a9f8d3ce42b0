"""Points: a table whose rows are runs with their own numbers, texts and ground motion."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import pytest
import rwmf
import xarray as xr
from dimensional import SCENES, groups_of, in_units
from refused import refusals, refused_files
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.motion.record_sets import find_records
from rwmf.sweeps.executors import open_executor
from scenes import bare_frame, block, coupled, record

QUICK = {"method": "dop853", "rtol": 1e-6, "t_end": 3.0}
N = 11
Column = npt.NDArray[np.float64]


def _design(n: int = N) -> dict[str, Column]:
    """Eight parameters of wall, frame, cable and motion."""
    chance = np.random.default_rng(3)
    ends = {
        "T_s": (0.4, 2.0),
        "gamma": (2.0, 50.0),
        "wall.b": (0.4, 0.6),
        "h": (1.8, 2.2),
        "xi_s": (0.02, 0.08),
        "eta_0": (0.5, 1.5),
        "e": (0.75, 0.95),
        "scale": (0.5, 1.5),
    }
    return {name: chance.uniform(*both, n) for name, both in ends.items()}


def _one(case: rwmf.Case, row: dict[str, float], names: list[str]) -> xr.Dataset:
    """Compute one row by itself."""
    scale = row["scale"]
    amplitude = "a_max_g" if "a_max_g" in case.motion.given else "scale"
    alone = case.replace(
        wall={"h": row["h"], "b": row["wall.b"]},
        frame={"gamma": row["gamma"], "xi_s": row["xi_s"]},
        cable={"eta_0": row["eta_0"]},
        impact={"e": row["e"]},
        motion={amplitude: scale * case.motion[amplitude]},
    )
    return rwmf.spectrum(alone, T_s=row["T_s"], quantities=names)


@pytest.mark.parametrize("method", ["dop853", "auto"])
@pytest.mark.parametrize("is_record", [False, True])
def test_rows_are_those_of_single_runs(method: str, is_record: bool, elcentro: Path) -> None:
    names = ["u_s_max", "theta_max_over_alpha", "impacts", "t_u_s_max"]
    names = names if method == "dop853" else names[:1]
    case = coupled(solver=QUICK | {"method": method})
    if is_record:
        case = case.replace(motion=record(elcentro))
    points = _design()
    found = rwmf.sweep(case, points=points, quantities=names)
    assert found["u_s_max"].dims == ("point",)
    for i in range(N):
        row = {name: float(values[i]) for name, values in points.items()}
        single = _one(case, row, names)
        for name in names:
            assert float(found[name][i]) == float(single[name].squeeze()), (i, name)
    assert len(np.unique(found["u_s_max"])) == N


def test_coordinates_of_a_table() -> None:
    points = _design() | {"formulation": np.array(["exact", "symmetric"] * 6)[:N]}
    found = rwmf.sweep(coupled(solver=QUICK), points=points)
    assert found.sizes == {"point": N}
    names = {"wall.b": "b"}
    for word, values in points.items():
        np.testing.assert_array_equal(found[names.get(word, word)], values)
    assert found["h"].attrs["units"] == "m"
    assert found["scale"].attrs["units"] == "1"
    alone = found.isel(point=found["formulation"] == "exact")
    assert alone.sizes["point"] == 6


def test_order_company_chunks_and_threads_do_not_matter() -> None:
    case = coupled(solver=QUICK)
    points = _design(40) | {"formulation": np.array(["exact", "symmetric", "published"] * 14)[:40]}
    found = rwmf.sweep(case, points=points)
    order = np.random.default_rng(1).permutation(40)
    other = rwmf.sweep(
        case, points={name: values[order] for name, values in points.items()}, chunk=3, threads=2
    )
    np.testing.assert_array_equal(other["u_s_max"], found["u_s_max"][order])
    np.testing.assert_array_equal(other["formulation"], found["formulation"][order])


def test_records_of_rows(elcentro: Path, tmp_path: Path) -> None:
    short = tmp_path / "short.txt"
    short.write_text("0\n1\n-1\n0\n", encoding="ascii")
    suite = find_records([elcentro], unit="g") + find_records([short], unit="m/s2", dt=0.5)
    case = bare_frame(solver=QUICK)
    T_s = [0.5, 1.0, 0.5, 2.0, 1.0]
    words: list[object] = ["short", "elcentro", "elcentro", str(short), suite[0]]
    found = rwmf.sweep(case, records=suite, points={"T_s": T_s, "record": words})
    assert found["record"].values.tolist() == ["short", "elcentro", "elcentro", "short", "elcentro"]
    assert len(set(found["record_crc32"].values.tolist())) == 2
    product = rwmf.sweep(case, {"T_s": [0.5, 1.0, 2.0]}, suite)["u_s_max"]
    for i in range(5):
        expected = product.sel(record=found["record"][i], T_s=T_s[i])
        assert float(found["u_s_max"][i]) == float(expected)
    # without the list of records: paths
    alone = rwmf.sweep(case, points={"T_s": T_s[1:3], "record": [elcentro] * 2}, unit="g")
    np.testing.assert_array_equal(alone["u_s_max"], found["u_s_max"][1:3])


def test_motions_from_arrays() -> None:
    """As an axis, in a column, as the case's own; on other engines they travel with the task."""
    chance = np.random.default_rng(5)
    one, two = (
        rwmf.Motion(chance.normal(size=200), dt=0.02, unit="m/s2", name=name)
        for name in ("one", "two")
    )
    case = coupled(solver=QUICK)
    product = rwmf.sweep(case, {"T_s": [0.5, 1.0]}, [one, two])
    assert product["record"].values.tolist() == ["one", "two"]
    points = {"T_s": [0.5, 1.0, 1.0, 0.5], "record": [two, one, two, one]}
    found = rwmf.sweep(case, points=points)
    for i in range(4):
        expected = product["u_s_max"].sel(record=found["record"][i], T_s=points["T_s"][i])
        assert float(found["u_s_max"][i]) == float(expected.squeeze())
    own = case.replace(motion=one, solver={"t_end": None})
    with open_executor("processes", 1) as executor:
        alone = rwmf.sweep(own, {"T_s": [0.5, 1.0]}, executor=executor)
    np.testing.assert_array_equal(alone["u_s_max"], product["u_s_max"].sel(record="one"))
    assert alone.attrs["motion_crc32"] == one.checksum
    other = rwmf.Motion([0.0, 1.0], dt=0.1, unit="g", name="one")
    with pytest.raises(InputError, match="needs another name"):
        rwmf.sweep(case, {}, [one, other])


def test_points_and_grids_combine(elcentro: Path) -> None:
    case = coupled(motion=record(elcentro), solver=QUICK)
    points = {"e": [0.8, 0.9, 0.85], "h": [2.0, 2.1, 1.9]}
    grid = {"formulation": ["exact", "published"], "xi_s": [0.02, 0.05], "T_s": [0.5, 1.0]}
    found = rwmf.sweep(case, grid, points=points)
    assert found["u_s_max"].dims == ("point", "formulation", "xi_s", "T_s")
    for i in range(3):
        alone = rwmf.sweep(
            case.replace(impact={"e": points["e"][i]}, wall={"h": points["h"][i]}), grid
        )
        expected = alone["u_s_max"].squeeze(["b", "gamma"], drop=True)
        np.testing.assert_array_equal(found["u_s_max"][i], expected)
    suite = find_records([elcentro], unit="g")
    product = rwmf.sweep(case, {"t_end": [3.0]}, suite, points=points | {"T_s": 1.0})
    assert product["u_s_max"].dims == ("record", "point", "t_end")
    np.testing.assert_array_equal(
        product["u_s_max"][0, :, 0],
        rwmf.sweep(case, points=points | {"T_s": 1.0})["u_s_max"],
    )


def test_a_grid_of_the_case_is_combined_too() -> None:
    case = coupled(solver=QUICK, spectrum={"T_s": [0.5, 1.0], "gamma": [5.0, 10.0]})
    found = rwmf.sweep(case, points={"e": [0.8, 0.9], "T_s": [0.7, 0.8]})
    assert found["u_s_max"].dims == ("point", "gamma")


def test_blocks_alone() -> None:
    case = block(motion={"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.8}, solver=QUICK)
    points = {"b": [0.4, 0.5, 0.45], "h": [2.0, 2.2, 2.1], "a_max_g": [0.3, 0.4, 0.5]}
    names = ["theta_max_over_alpha", "impacts"]
    found = rwmf.sweep(case, points=points, quantities=names)
    for i in range(3):
        single = rwmf.simulate(
            case.replace(
                wall={"b": points["b"][i], "h": points["h"][i]},
                motion={"a_max_g": points["a_max_g"][i]},
            )
        )
        for name in names:
            assert float(found[name][i]) == float(single[name])


def _as_frame(points: dict[str, object]) -> object:
    return pd.DataFrame(points, index=range(100, 100 + N))


def _as_structured(points: dict[str, object]) -> object:
    columns = {name: np.asarray(values) for name, values in points.items()}
    found = np.empty(N, dtype=[(name, values.dtype) for name, values in columns.items()])
    for name, values in columns.items():
        found[name] = values
    return found


def _as_dataset(points: dict[str, object]) -> xr.Dataset:
    found = xr.Dataset({name: ("sample", values) for name, values in points.items()})
    return found.assign_coords(sample=np.arange(N))


@pytest.mark.parametrize("form", [_as_frame, _as_structured, _as_dataset])
def test_forms_of_a_table(form: Callable[[dict[str, object]], object]) -> None:
    case = coupled(solver=QUICK)
    points: dict[str, object] = dict(_design())
    points["formulation"] = ["exact", "published", "exact"] + ["symmetric"] * (N - 3)
    expected = rwmf.sweep(case, points=points)
    xr.testing.assert_identical(rwmf.sweep(case, points=form(points)), expected)


def _write_csv(path: Path, points: dict[str, object]) -> None:
    columns = [np.asarray(values).tolist() for values in points.values()]
    rows = [", ".join(map(str, row)) for row in zip(*columns, strict=True)]
    path.write_text("\n".join(["# a design", ",".join(points), "", *rows]) + "\n", encoding="utf-8")


def test_files_of_a_table(elcentro: Path, tmp_path: Path) -> None:
    case = coupled(solver=QUICK)
    points: dict[str, object] = dict(_design())
    points["record"] = [elcentro.name] * N
    (tmp_path / elcentro.name).write_bytes(elcentro.read_bytes())
    _write_csv(tmp_path / "points.csv", points)
    _as_dataset(points).to_netcdf(tmp_path / "points.nc", engine="h5netcdf")
    given = points | {"record": [str(tmp_path / elcentro.name)] * N}
    expected = rwmf.sweep(case, points=given, unit="g")
    for name in ("points.csv", "points.nc"):
        found = rwmf.sweep(case, points=tmp_path / name, unit="g")
        xr.testing.assert_identical(found, expected)
    with pytest.raises(InputError, match="is read by this run"):
        rwmf.sweep(case, points=tmp_path / "points.nc", unit="g", file=tmp_path / "points.nc")


def test_rows_that_the_rules_refuse() -> None:
    """Both numbers of a row are allowed, their combination is not; the others go on."""
    case = coupled(solver=QUICK, cable={"eta_y": 8.0})
    points = {"T_s": [0.5, 1.0, 2.0], "eta_0": [1.0, 1.0, 1.0], "cable.eta_y": [8.0, 8.0, 8.0]}
    fine = rwmf.sweep(case, points=points)
    assert fine["status"].values.tolist() == [0, 0, 0]
    with pytest.raises(InputError, match="points, row 1: "):
        rwmf.sweep(case, points=points | {"cable.eta_y": [8.0, 0.5, 8.0]})
    # neither the least nor the greatest of its column
    refused = rwmf.sweep(
        case, points=points | {"eta_0": [0.2, 1.0, 2.0], "cable.eta_y": [0.5, 0.9, 8.0]}
    )
    names = refused["status"].attrs["flag_meanings"].split()
    assert [names[i] for i in refused["status"].values] == ["ok", "refused", "ok"]
    assert np.isnan(refused["u_s_max"].values).tolist() == [False, True, False]


test_points_that_are_refused = refusals(
    lambda points: rwmf.sweep(coupled(), points=points),
    ({"e": [0.9, 1.2]}, "points, row 1: .*e = 1.2"),
    ({"e": [0.9, np.nan]}, "points, row 1: impact.e = nan: must be a finite number"),
    ({"e": [0.9, "x"]}, "points, row 1: impact.e = 'x': must be a finite number"),
    ({"n_pulses": [1, 2.5]}, "row 1: motion.n_pulses = 2.5: must be a whole number"),
    ({"verify": [True, 2]}, "row 1: solver.verify = 2: must be true or false"),
    ({"formulation": ["exact", 1]}, "row 1: model.formulation = 1: must be a text"),
    ({"formulation": ["exact", "new"]}, "row 1: .*formulation"),
    ({"dance": [1]}, "points: dance: no key"),
    ({"e": [0.9], "impact.e": [0.8]}, "both set impact.e"),
    ({"e": [0.9, 0.8], "T_s": [1.0]}, "row 1: T_s: no value: the column ends after 1 rows"),
    ({"e": [[0.9], [0.8, 0.7]]}, "points, row 0: e = .0.9.: must be one value"),
    ({"e": [0.9, [0.8, 0.7]]}, "points, row 1: e = .0.8, 0.7.: must be one value"),
    ({"e": [0.9, np.ones(3)]}, "points, row 1: e = array.*: must be one value"),
    ({"record": ["a", ["b", "c"]]}, "points, row 1: record = ..b', 'c'.: must be one value"),
    ({"record": [["a"], ["b", "c"]]}, "points, row 0: record = ..a..: must be one value"),
    ({"e": []}, "points: has no row"),
    ({}, "points: has no row"),
    ({"eta": [[1, 5]]}, "points, row 0: eta = .1, 5.: must be one value"),
    ({"eta": [1.0]}, "give the columns cable.eta_0 and cable.eta_alpha"),
    ({"table_e": [1.0]}, "table_e = 1.0: must not be given with rule"),
    ({"record": ["moon"]}, "points, row 0: record = moon: is neither a file"),
    ({"record": [3]}, "points, row 0: record = 3: must be a record, its name or path"),
    ([1, 2], "points: list: must be a mapping"),
    ("nowhere.csv", "nowhere.csv: the file does not exist"),
)


def test_other_refusals(elcentro: Path) -> None:
    with pytest.raises(InputError, match="grid and points: both set T_s"):
        rwmf.sweep(coupled(), {"T_s": [1.0]}, points={"T_s": [1.0]})
    with pytest.raises(InputError, match="points: gamma: the case has no such effect"):
        rwmf.sweep(bare_frame(), points={"gamma": [1.0]})
    with pytest.raises(InputError, match="did you mean elcentro"):
        rwmf.sweep(coupled(), records=[elcentro], unit="g", points={"record": ["elcentr"]})
    many = xr.Dataset({"e": (("x", "y"), [[0.9]])})
    with pytest.raises(InputError, match="has the dimensions x, y"):
        rwmf.sweep(coupled(), points=many)


test_files_that_are_refused = refused_files(
    "p.csv",
    lambda path: rwmf.sweep(coupled(), points=path),
    ("", "has no line with the names"),
    ("e\n", "has no row below"),
    ("e,e\n1,1\n", "line 1: the column e is given twice"),
    ("e,T_s\n1\n", "line 2: T_s: no value: 1 values for 2 columns"),
    ("e,T_s\n.9,1\n.9,1,7\n", "line 3: '7': a value without a column: 3 values for 2"),
    ("# c\n\ne,T_s\n.9,1\n.8,x\n", "line 5: T_s = x: must be a finite number"),
    ("e\n.9\ninf\n", "line 3: impact.e = inf: must be a finite number"),
    ("e\n.9\n1.5\n", "line 3: .*e = 1.5"),
    ("e,formulation\n.9,exact\n.8,other\n", "line 3: .*formulation = 'other'"),
    ("verify\ntrue\nmaybe\n", "line 3: solver.verify = 'maybe': must be true or false"),
    ("love\n1\n", "love: no key"),
)


def _keys_of_a_scene() -> list[str]:
    """Numbers that the scenes below have a value of, by the table of keys."""
    kinds = {"real", "integer", "real list", "logical"}
    rows = [row for row in tables.schema() if row[2] in kinds]
    return [f"{row[0]}.{row[1]}" for row in rows if row[0] not in ("spectrum", "output")]


@pytest.mark.parametrize("key", _keys_of_a_scene())
def test_each_number_of_the_table_of_keys_is_a_column(key: str) -> None:
    """Lists of one number and the number of storeys too: a row is the run of that value."""
    group, name = key.split(".")
    tried = 0
    for scene in SCENES:
        for case in (rwmf.Case(**groups) for groups in (groups_of(scene), _of_one_number(scene))):
            known = case.groups.get(group, {})
            if name not in known or name not in case.groups[group].given:
                continue
            value = case.groups[group].as_given()[name]
            if isinstance(value, tuple) and len(value) > 1:
                continue
            tried += 1
            value = value[0] if isinstance(value, tuple) else value
            # its period belongs to the masses and stiffnesses that a column may set
            found = rwmf.sweep(case, points={key: [value, value]})
            assert not (found["status"] == "refused").any()
            assert "refused" not in found["status"].attrs["flag_meanings"].split(), (scene, key)
            quantity = str(next(iter(found.data_vars)))
            run = rwmf.simulate(case)
            np.testing.assert_allclose(found[quantity], float(run[quantity]), rtol=1e-6)
            break
        if tried:
            break


def _of_one_number(scene: str) -> dict[str, Any]:
    """Give the same scene as many equal storeys, each key one number."""
    groups = groups_of(scene)
    if "storeys" not in groups:
        return in_units(groups)
    storeys = {"n": 3, "m": 3e4, "k": 3e7, "height": 6.0}
    storeys |= {"coupling": groups["storeys"].get("coupling", "reduced")}
    if storeys["coupling"] == "springs":
        storeys["k_link"] = 1e9
    wall = {"wall": groups["wall"] | {"m_w": 5e4}} if "wall" in groups else {}
    changes: dict[str, Any] = {"storeys": storeys, "frame": {"xi_s": 0.05}} | wall
    if "storey_u_y" in groups.get("yielding", {}):
        changes["yielding"] = {"storey_F_y": 4e5}
    return groups | changes


def test_columns_of_storeys(tmp_path: Path) -> None:
    """Different numbers of storeys, masses and stiffnesses, in memory and in a file."""
    base = rwmf.Case(
        frame={"xi_s": 0.05},
        storeys={"n": 2, "m": 2e4, "k": 2e7, "height": 3.0, "coupling": "full"},
        motion={"kind": "one_sine", "a_max_g": 0.4, "T_p": 0.6},
        solver={"t_end": 3.0, "rtol": 1e-8},
    )
    table = {"storeys.n": [2, 3, 5, 3], "storeys.m": [2e4, 3e4, 2e4, 2e4],
             "storeys.k": [2e7, 2e7, 3e7, 4e7]}  # fmt: skip
    expected = []
    for n, m, k in zip(*table.values(), strict=True):
        run = rwmf.simulate(base.replace(storeys={"n": n, "m": m, "k": k}))
        expected.append(float(run["u_s_max"]))
    lines = [",".join(map(str, row)) for row in zip(*table.values(), strict=True)]
    (tmp_path / "p.csv").write_text("\n".join([",".join(table), *lines]) + "\n")
    for points in (table, tmp_path / "p.csv"):
        found = rwmf.sweep(base, points=points)
        np.testing.assert_allclose(found["u_s_max"], expected, rtol=1e-6)
        assert found["n"].values.tolist() == [2, 3, 5, 3]
    grid = rwmf.sweep(base, {"storeys.n": [2, 3], "storeys.m": [2e4], "storeys.k": [2e7]})
    assert float(grid["u_s_max"].sel(n=2).squeeze()) == pytest.approx(expected[0], rel=1e-6)
    with pytest.raises(InputError, match=r"storeys.n = 2.5: must be a whole number"):
        rwmf.sweep(base, points={"storeys.n": [2, 2.5]})
