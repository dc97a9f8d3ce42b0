"""Public functions answer arguments of a wrong type with errors of the package."""

import contextlib
import datetime
import functools
import inspect
import types
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import rwmf
import xarray as xr
from rwmf.assess.cost import Cost
from rwmf.kernel.tables import schema
from scenes import bare_frame, coupled

# values that are wrong for most arguments
WRONG: dict[str, Any] = {
    "None": None,
    "true": True,
    "bytes": b"x",
    "text": "x",
    "surrogate": "\ud800",
    "complex": 1 + 2j,
    "nan": np.nan,
    "infinity": -np.inf,
    "masked": np.ma.masked,
    "masked array": np.ma.array([1.0, 2.0], mask=[False, True]),
    "complex array": np.array([1.0, 2j]),
    "text array": np.array(["1", "2"]),
    "logical array": np.array([True, False]),
    "object array": np.array([1.0, object()], dtype=object),
    "two dimensions": np.ones((2, 2)),
    "nested": [[1.0, 2.0]],
    "ragged": [[1.0], [1.0, 2.0]],
    "mixed": [True, 2.0],
    "text list": ["1"],
    "date": datetime.datetime(2020, 1, 1),
    "time difference": np.timedelta64(1, "s"),
    "huge": 10**400,
    "huge list": [10**400, 1.0],
    "negative": -1,
    "pandas NA": pd.NA,
    "pandas series": pd.array([1, None], dtype="Int64"),
    "object": object(),
    "empty": [],
    "mapping": {"a": 1},
    "set": {1.0, 2.0},
    "empty array": np.array([]),
    "largest": 1e308,
    "smallest": 1e-308,
    "path": Path("nowhere"),
    "long text": "x" * 5000,
    "nothing in a list": [None],
    "function": lambda *_, **__: None,
    "class": rwmf.Response,
    "empty dataset": xr.Dataset(),
    "dataset": xr.Dataset({"u": ("x", [1.0])}, {"x": [0.5]}),
    "data array": xr.DataArray([1.0], dims="record"),
    "other case": bare_frame(),
}
_CLASSES = ("Case", "Motion", "records.RecordFile", "Response")
# results of other functions, and functions without arguments
_NOT_CALLED = {"plot.style", "hosts.ElementResponse", "hosts.Host",
               "hosts.WallEvent", "hosts.WallState"}  # fmt: skip
# needs the package openseespy
_NOT_CALLED |= {"hosts.OpenSeesHost"}


def _motion(name: str = "short") -> rwmf.Motion:
    return rwmf.Motion([0.0, 1.0, -1.0, 0.0] * 3, dt=0.05, unit="m/s2", name=name)


def _still(_: float) -> float:
    return 0.0


def _host() -> rwmf.hosts.FunctionHost:
    return rwmf.hosts.FunctionHost([5.0], [[0.1]], [[40.0]], _still, [0])


@functools.cache
def _case() -> rwmf.Case:
    fuse = {"eta_y": 0.2, "stroke_y": 0.004}
    case = coupled(solver={"t_end": 0.4, "method": "dop853", "rtol": 1e-4}, fuse=fuse)
    return case.replace(output={"dt": 0.02})


def _soft() -> rwmf.Case:
    return rwmf.Case.from_text(
        "&wall h=2.0, b=0.5 / &base k_t_over_m_w=2.0e4, xi=0.2 / &motion kind='none' / "
        "&solver t_end=0.4 /"
    )


@functools.cache
def _found() -> dict[str, Any]:
    """Datasets for the functions that draw them."""
    case = _case()
    grid = {"T_s": [0.5, 1.0]}
    records = [_motion()]
    stripes = rwmf.stripes(case, [*records, _motion("other")], [0.1, 0.4, 1.5], "u_s_max")
    limit = float(stripes["u_s_max"].median())
    return {
        "run": rwmf.simulate(case),
        "curve": rwmf.pushover(case, 0.01, steps=2),
        "spectrum": rwmf.spectrum(case, **grid),
        "fragility": rwmf.fragility(stripes, limit, resamples=5),
        "stripes": stripes,
        "risk": rwmf.risk((0.9, 0.4), (2e-4, 2.5)),
        "wall": rwmf.studies.wall_effect(case, grid),
        "equal": rwmf.studies.equal_response(case, [0.5], 0.01, tolerance=0.5),
        "sweep": rwmf.sweep(case, grid, records),
        "no variables": xr.Dataset(),
        "map": rwmf.studies.overturning_map(case, [5.0, 6.0], [1.0, 9.0], tolerance=1.0),
    }


def _calls(folder: Path) -> dict[str, dict[str, Any]]:
    """Give each public function arguments with which it works, besides its defaults."""
    case, found, records = _case(), _found(), [_motion()]
    grid = {"T_s": [0.5]}
    limit = float(found["stripes"]["u_s_max"].median())
    limited = case.replace(limits={"u_s_max_m": 1.0})
    samples = folder / "samples.txt"
    _motion().write(samples)
    ax, both = plt.figure().subplots(), plt.figure().subplots(1, 2)
    suite = {"case": case, "grid": grid, "records": records}
    return {
        "simulate": {"case": case, "dt": 0.1},
        "spectrum": {"case": case, "T_s": [1.0], "gamma": 5.0, "b": 0.5, "threads": 1,
                     "quantities": ["u_s_max"]},
        "sweep": suite | {"quantities": ["u_s_max"], "threads": 1,
                          "intensity": "peak_acceleration"},
        "ida": {"case": case, "records": records, "levels": [0.1], "quantities": "u_s_max",
                "limits": {"u_s_max": 0.01}, "tolerance": 0.5, "highest": 0.2, "period": None,
                "damping": None, "intensity": None, "periods": None, "threads": 1, "file": None,
                "restart": False, "unit": None, "dt": None},
        "stripes": {"case": case, "records": records, "levels": [0.1], "quantities": "u_s_max"},
        "cloud": {"case": case, "records": records, "quantities": "u_s_max", "factors": [1.0]},
        "fragility": {"table": found["stripes"], "limit": limit, "quantities": "u_s_max",
                      "method": "counts", "dispersions": 0.2, "mce": 0.5,
                      "shape_factor": (1.0, 4.0, "Dmax"), "resamples": 5, "confidence": 0.9},
        "risk": {"fragility": (0.9, 0.4), "hazard": (2e-4, 2.5), "levels": [0.5, 1.0]},
        "records.find_records": {"words": records},
        "records.intensity": {"motion": _motion(), "kind": "average_acceleration", "damping": 0.05,
                              "periods": [0.5]},
        "design": {"case": case, "bounds": {"eta_0": [0.0, 1.0]}, "cost": {"eta_0": 1.0},
                   "targets": [{"quantity": "u_s_max", "limit": 1.0, "percentile": 50}],
                   "records": (), "designs": 1, "threads": 1},
        "gradient": {"case": case, "parameters": ["T_s"], "quantities": ["u_s_max"], "threads": 1},
        "pushover": {"case": case, "drifts": [0.01], "pattern": "floors", "forces": [1.0],
                     "steps": 2},
        "Element": {"case": case},
        "Wall": {"case": case},
        "Walls": {"cases": case, "n": 1, "threads": 1},
        "sections.base_section": {"N": [1e6], "theta": [0.01], "width": 4.0, "thickness": 0.3,
                                  "k": 1e10, "f_c": 4e7},
        "checks": {"case": limited, "result": found["run"]},
        "sections.fatigue_cycles": {"strain": 0.02, "strain_1": 0.2, "slope": -0.5},
        "sections.footing": {"G": 4e7, "nu": 0.3, "width": 6.0, "thickness": 2.0, "density": 2e3},
        "sections.toe": {"f_c": 4e7, "height": 19.2},
        "sections.ufp": {"stress": 3e8, "width": 0.1, "thickness": 0.01, "diameter": 0.1,
                         "leg": 0.05},
        "hosts.FunctionHost": {"mass": [1.0], "damping": [[0.1]], "restoring": [[40.0]],
                                  "ground": _still, "links": [0]},
        "hosts.couple": {"case": case, "host": _host(), "ground": _still, "dt": 0.05,
                            "t_end": 0.1, "tolerance": 1e-6},
        "plot.checks": {"found": rwmf.checks(limited, found["run"])},
        "explore": {"case": str(folder / "none.nml"), "open_browser": False},
        "cost": {"case": "none.nml"},
        "plot.loops": {"dataset": found["run"], "case": case},
        "plot.find_loops": {"dataset": found["run"], "case": case},
        "plot.ida": {"dataset": found["stripes"], "ax": ax, "quantity": "u_s_max"},
        "plot.cloud": {"dataset": found["stripes"], "ax": ax, "quantity": "u_s_max"},
        "plot.fragility": {"dataset": found["fragility"], "ax": ax},
        "plot.hazard": {"curve": (2e-4, 2.5), "ax": ax, "levels": [0.1, 1.0]},
        "plot.deaggregation": {"dataset": found["risk"], "ax": ax},
        "studies.demand_percentiles": {"table": found["stripes"], "quantities": "u_s_max",
                                       "q": [50.0]},
        "plot.equal_response": {"dataset": found["equal"], "ax": ax},
        "plot.overturning_map": {"dataset": found["map"], "ax": ax},
        "plot.wall_effect": {"dataset": found["wall"], "ax": ax},
        "plot.envelope": {"dataset": found["run"], "case": case},
        "plot.envelope_quantities": {"case": case},
        "plot.ground_motion": {"dataset": found["run"], "axes": both, "T_s": [0.5]},
        "plot.history": {"dataset": found["run"], "axes": ax, "variables": ["u_s"], "case": case},
        "plot.make_panels": {"axes": ax, "n": 1},
        "plot.pushover": {"curve": found["curve"], "ax": ax, "history": found["run"]},
        "plot.profile": {"dataset": found["run"], "axes": ax, "case": case},
        "plot.spectrum": {"dataset": found["spectrum"], "ax": ax, "legend": False},
        "plot.work_precision": {"cost": None, "ax": ax},
        "quantile": {"dataset": found["sweep"], "q": 0.5},
        "records.export": {"name": "none", "path": str(folder / "r.txt")},
        "records.info": {"path": str(samples), "unit": "m/s2", "dt": 0.1},
        "records.pairs": {"words": [*records, _motion()]},
        "records.process": {"motion": _motion(), "resample": 0.05, "baseline": 1, "taper": 0.1,
                            "band": [0.5, 5.0], "poles": 2},
        "records.read": {"path": str(samples), "unit": "g", "dt": 0.1, "channel": 1},
        "records.asce7": {"S_DS": 1.0, "S_D1": 0.6},
        "records.eurocode8": {"a_g": 0.2},
        "records.select": {"words": records, "target_spectrum": [[0.1, 1.0], [1.0, 1.0]],
                           "band": (0.2, 0.5), "n": 1, "limits": (1e-6, 1e6)},
        "records.sequence": {"main": _motion(), "after": _motion(), "pause": 1.0},
        "studies.equal_response": {"case": case, "T_p": [0.5], "target": 0.01, "tolerance": 0.9,
                                   "threads": 1},
        "studies.overturning_map": {"case": case, "omega_over_p": [5.0], "amplitude": [1.0],
                                    "tolerance": 1.0, "threads": 1},
        "studies.restitution": {"case": _soft()},
        "studies.wall_effect": suite,
    }  # fmt: skip


def _public() -> dict[str, Callable[..., Any]]:
    """Every function of the package and of its public modules."""
    found: dict[str, Callable[..., Any]] = {}
    for name in rwmf.__all__:
        item = getattr(rwmf, name)
        if isinstance(item, types.ModuleType):
            names = getattr(item, "__all__")  # noqa: B009 (of any module)
            found |= {f"{name}.{word}": getattr(item, word) for word in names}
        else:
            found[name] = item
    return {
        name: item
        for name, item in found.items()
        if callable(item) and not (inspect.isclass(item) and issubclass(item, BaseException))
    }


def _arguments(name: str, folder: Path) -> dict[str, Any]:
    """Give each argument of a public function its default, or another right value."""
    parameters = inspect.signature(_public()[name]).parameters.values()
    defaults = {item.name: item.default for item in parameters if item.default is not item.empty}
    return defaults | _calls(folder)[name]


def _refused(call: Callable[..., Any], **arguments: Any) -> str:  # noqa: ANN401 (any value)
    """Call with wrong arguments; anything else than an own error comes out."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            call(**arguments)
        except rwmf.RwmfError as error:
            return str(error)
        finally:
            plt.close("all")
    return ""


# right values with which the function waits for a browser, or computes for seconds
_WAITING = {("explore", "case"): ("None", "other case"), ("cost", "case"): ("other case",),
            ("ida", "levels"): ("smallest",), ("ida", "tolerance"): ("smallest",)}  # fmt: skip


@pytest.mark.parametrize("name", sorted(set(_public()) - _NOT_CALLED - {*_CLASSES}))
def test_functions_refuse_what_they_cannot_use(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each argument in turn is each wrong value; the others are right."""
    monkeypatch.chdir(tmp_path)
    call = _public()[name]
    right = _arguments(name, tmp_path)
    known = [word for word, item in inspect.signature(call).parameters.items()
             if item.kind is not item.VAR_KEYWORD]  # fmt: skip
    assert set(known) <= set(right), "a new argument: give it a value that works"
    for argument in right:
        for kind, value in WRONG.items():
            if kind in _WAITING.get((name, argument), ()):
                continue
            try:
                _refused(call, **(right | {argument: value}))
            except Exception as error:
                pytest.fail(f"{name}({argument}={kind}): {type(error).__name__}: {error}")


# objects with methods, and right arguments of each method with arguments
_OBJECTS: dict[str, Callable[[], Any]] = {
    "Wall": lambda: rwmf.Wall(_case()),
    "Walls": lambda: rwmf.Walls(_case(), 2),
    "Element": lambda: rwmf.Element(_case()),
    "FunctionHost": lambda: _host(),
    "Response": lambda: _found()["run"],
    "Checks": lambda: rwmf.checks(_case().replace(limits={"u_s_max_m": 1.0}), _found()["run"]),
}
_STEP = {"t": [0.0, 0.1], "a": [0.0, 1.0]}
_MOTION = {"u": 0.0, "u_dot": 0.0, "u_ddot": 0.0}
_METHODS: dict[str, dict[str, Any]] = {
    "Wall.advance": {"t": 0.1},
    "Wall.advance_samples": _STEP,
    "Wall.advance_ground": {"t": 0.1, "function": _still},
    "Wall.next_event": {"horizon": 0.1, "kinds": ["impact"]},
    "Wall.restore": {"snapshot": None},
    "Walls.advance": {"t": 0.1},
    "Walls.advance_samples": _STEP,
    "Walls.restore": {"snapshot": None},
    "Element.respond": _MOTION | {"u_g_ddot": 0.0, "side": None, "v_g_ddot": 0.0},
    "Element.motion_of_links": _MOTION,
    "Element.place": {"side": 1},
    "Element.restore": {"snapshot": None},
    "Element.next_event": {"dt": 0.1, "begin": [0.0] * 3, "end": [0.1, 0.0, 0.0],
                           "u_g_ddot": (0.0, 0.0), "push": (0.0, 0.0), "has_branches": False},
    "Element.land": {"u": 0.0, "u_dot": 0.0, "host_mass": None},
    "Element.settles": {"dt": 0.1, "motion": [0.0] * 3, "u_g_ddot": 0.0, "push": 0.0,
                        "host_mass": None},
    "FunctionHost.attempt": {"forces": [0.0], "h": 0.1},
    "FunctionHost.commit": {"forces": [0.0], "h": 0.1},
    "FunctionHost.set_rates": {"velocities": [0.0], "accelerations": [0.0]},
}  # fmt: skip
# methods that xarray inherits to a response are its own
_INHERITED = set(dir(xr.Dataset))


def _public_methods() -> list[str]:
    """Every method with arguments of the objects."""
    found = []
    for name, make in _OBJECTS.items():
        for word, method in inspect.getmembers(make(), callable):
            own = not word.startswith("_") and not (name == "Response" and word in _INHERITED)
            if own and inspect.signature(method).parameters:
                found.append(f"{name}.{word}")
    return found


def test_an_empty_measurement_is_refused() -> None:
    assert "rwmf.cost" in _refused(rwmf.plot.work_precision, cost=Cost({}, [], [], 1e-6, None))


def test_methods_with_arguments_refuse_what_they_cannot_use() -> None:
    """Each argument in turn is each wrong value, in a new object."""
    missing = set(_public_methods()) - {*_METHODS}
    assert not missing, "a new method: give its arguments values that work"
    for name, right in _METHODS.items():
        kind_of_object, _, method = name.partition(".")
        for argument in right:
            for kind, value in WRONG.items():
                call = getattr(_OBJECTS[kind_of_object](), method)
                try:
                    _refused(call, **(right | {argument: value}))
                except Exception as error:
                    pytest.fail(f"{name}({argument}={kind}): {type(error).__name__}: {error}")


@pytest.mark.parametrize("kind", WRONG)
def test_a_response_is_made_as_a_dataset_or_refused(kind: str) -> None:
    for argument in ("data_vars", "coords", "attrs"):
        _refused(rwmf.Response, **{argument: WRONG[kind]})
    with contextlib.suppress(KeyError, ValueError, TypeError):
        # the answers of a mapping
        _found()["run"][WRONG[kind]]


def _methods() -> Iterator[tuple[str, Callable[[Any], object]]]:
    case = _case()
    yield from (
        ("from_namelist", rwmf.Case.from_namelist),
        ("from_text", rwmf.Case.from_text),
        ("from_text source", lambda x: rwmf.Case.from_text("&wall h = 2 /", x)),
        ("without", case.without),
        ("to_namelist", case.to_namelist),
        ("group", lambda x: rwmf.Case(wall=x)),
        ("name of a key", lambda x: case.replace(wall={x: 1.0} if _is_hashable(x) else {"x": 1})),
        ("Motion", lambda x: rwmf.Motion(x, dt=0.1, unit="g")),
        ("Motion dt", lambda x: rwmf.Motion([0.0, 1.0], dt=x, unit="g")),
        ("Motion times", lambda x: rwmf.Motion([0.0, 1.0], times=x, unit="g")),
        ("Motion unit", lambda x: rwmf.Motion([0.0, 1.0], dt=0.1, unit=x)),
        ("Motion name", lambda x: rwmf.Motion([0.0, 1.0], dt=0.1, unit="g", name=x)),
        ("write", _motion().write),
        *(
            (f"RecordFile {word}", functools.partial(_record_file, word))
            for word in ("name", "path", "crc32", "unit", "dt", "scale", "array")
        ),
    )


def _record_file(word: str, value: object) -> rwmf.records.RecordFile:
    return rwmf.records.RecordFile(**({"name": "a", "path": "", "crc32": ""} | {word: value}))  # type: ignore[arg-type]


def _is_hashable(value: object) -> bool:
    try:
        hash(value)
    except TypeError:
        return False
    return True


@pytest.mark.parametrize("kind", WRONG)
def test_methods_refuse_what_they_cannot_use(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, call in _methods():
        try:
            _refused(lambda call=call: call(WRONG[kind]))
        except Exception as error:
            pytest.fail(f"{name}({kind}): {type(error).__name__}: {error}")


_NEVER_NUMBERS = ("masked", "masked array", "complex", "complex array", "bytes", "huge", "date",
                  "pandas NA", "object array", "two dimensions", "mixed", "time difference",
                  "surrogate", "text array", "nan")  # fmt: skip


@pytest.mark.parametrize("kind", _NEVER_NUMBERS)
def test_every_key_refuses_what_is_no_number(kind: str) -> None:
    """By each edit, grid and column of a table of each number of the table of keys."""
    value = WRONG[kind]
    for group, key, kind_of_key, *_ in schema():
        if kind_of_key not in ("real", "integer", "real list"):
            continue
        edits: list[Callable[[], object]] = [
            lambda group=group, key=key: _case().replace(**{group: {key: value}}),
            lambda group=group, key=key: rwmf.Case(**{group: {key: value}}),
        ]
        if group not in ("spectrum", "output"):
            name = f"{group}.{key}"
            edits.append(lambda name=name: rwmf.sweep(_case(), {name: value}))
            edits.append(lambda name=name: rwmf.sweep(_case(), points={name: value}))
        for edit in edits:
            assert _refused(edit), f"{group}.{key} takes {kind}"


def test_messages_name_argument_value_and_what_is_allowed() -> None:
    case = _case()
    for call, words in (
        (lambda: rwmf.spectrum(case, T_s=[[1, 2]]), ("T_s", "(1, 2)", "one dimension")),
        (lambda: rwmf.spectrum(case, T_s=["1"]), ("T_s", "['1']", "finite numbers")),
        (lambda: rwmf.spectrum(case, T_s=WRONG["masked array"]), ("T_s", "position 1", "masked")),
        (lambda: case.replace(wall={"h": 10**400}), ("&wall", "h = ", "1329 bits", "numbers")),
        (lambda: case.replace(wall={"h": 2 + 1j}), ("&wall", "h = (2+1j)", "numbers")),
        (lambda: rwmf.simulate(case, np.ones(2)), ("dt", "array([1., 1.])", "number > 0")),
        (lambda: rwmf.simulate(3), ("case = 3", "a Case or the path")),  # type: ignore[arg-type]
        (lambda: rwmf.plot.history(case), ("dataset = Case", "rwmf.simulate")),  # type: ignore[arg-type]
        (lambda: rwmf.plot.spectrum(_found()["run"]), ("T_s", "rwmf.spectrum")),
    ):
        message = _refused(call)
        assert all(word in message for word in words), message


# datasets that a function draws beside the one that the table of calls gives it
_DRAWN = {("plot.spectrum", "friction")}


def test_figures_refuse_datasets_of_other_functions(tmp_path: Path) -> None:
    """Each message names the function whose dataset is needed."""
    datasets = {name: item for name, item in _found().items() if isinstance(item, xr.Dataset)}
    for name, right in _calls(tmp_path).items():
        if "dataset" not in right or name == "quantile":
            continue
        for word, item in datasets.items():
            message = _refused(_public()[name], **(right | {"dataset": item}))
            if message or not (item is right["dataset"] or (name, word) in _DRAWN):
                assert "dataset" in message, (name, word)
                assert "must be the dataset of rwmf." in message, (name, word)


def test_right_values_stay_right() -> None:
    """Any container of numbers is accepted."""
    case = _case()
    expected = rwmf.spectrum(case, T_s=[0.5, 1.0])
    for periods in (
        (0.5, 1.0),
        np.array([0.5, 1.0], dtype=np.float32),
        np.ma.array([0.5, 1.0], mask=[False, False]),
        np.array([0.5, 1.0], dtype=object),
        pd.Series([0.5, 1.0]),
        expected["T_s"],
        iter([0.5, 1.0]),
    ):
        assert rwmf.spectrum(case, T_s=periods)["u_s_max"].equals(expected["u_s_max"])  # type: ignore[arg-type]
    assert case.replace(wall={"h": np.array(3)}).wall.h == 3.0


# dollar signs would begin formulas, and a lone brace would end the drawing of one
_HOSTILE = r"a$b_{$c\q$"


def _hostile(dataset: xr.Dataset) -> xr.Dataset:
    """Return a dataset whose names of records and designs, meanings and units are no formulas."""
    found = dataset.copy(deep=True)
    for name, values in dataset.variables.items():
        if "long_name" in values.attrs:
            found[name].attrs["long_name"] = _HOSTILE
        if name in ("record", "design"):
            texts = np.array([f"{_HOSTILE}{value}" for value in values.values.flat])
            change = found.assign_coords if name in dataset.coords else found.assign
            found = change({name: (values.dims, texts.reshape(values.shape))})
    return found


# the table of calls has no measurement and no storeys for these
_REFUSED = {"plot.work_precision", "plot.profile"} | _NOT_CALLED


@pytest.mark.parametrize("name", sorted(
    {name for name in _public() if name.startswith("plot.")} - _REFUSED
))  # fmt: skip
def test_figures_show_any_name(name: str, tmp_path: Path) -> None:
    arguments = {
        word: _hostile(value) if isinstance(value, xr.Dataset) else value
        for word, value in _calls(tmp_path)[name].items()
    }
    _public()[name](**arguments)
    for number in plt.get_fignums():
        plt.figure(number).canvas.draw()
