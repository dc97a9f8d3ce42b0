"""Cases as functional mock-up units, validated and simulated by FMPy."""

from __future__ import annotations

import functools
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest
import rwmf
from checkout import ROOT, run_words
from fmpy import fmi3
from fmpy.validation import validate_fmu
from rwmf.errors import InputError
from rwmf.hosts.fmu import export_fmu
from rwmf.run.simulation import start

WALL = "&wall h = 5.0, b = 1.2, m_w = 40e3 / &impact rule = 'coupled' /"
BLOCK = "&wall h = 1.0, b = 0.25, m_w = 1e3 / &impact rule = 'constant', e = 0.9 /"
FRAME = "&frame T_s = 0.8, gamma = 3.0, xi_s = 0.04 /"
CABLE = "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss' /"
PULSE = "&motion kind = 'one_sine', a_max_g = 0.7, T_p = 0.8 / &solver t_end = 3.0 /"
STOREYS = (
    "&frame xi_s = 0.03 / &storeys n = 4, m = 25e3, k = 25e6, height = 2.5, coupling = '{}', "
    "distribution = 'linear' /"
)
CASES = {
    "block": BLOCK + PULSE.replace("0.7,", "0.3,"),
    "frame": "&frame T_s = 0.8, xi_s = 0.04, m_s = 1e5 /" + PULSE,
    "yielding": WALL
    + FRAME
    + "&yielding u_y = 0.03, law = 'bouc_wen' / &output energy = T /"
    + PULSE,
    "tendon": WALL + FRAME + CABLE.replace("/", ", eta_y = 1.1 /") + PULSE,
    "fuses": WALL + FRAME + CABLE + "&fuse F_y = 40e3, k = 2e7, hardening = 0.02 /" + PULSE,
    "storeys": WALL + STOREYS.format("full") + CABLE + "&yielding storey_u_y = 0.012 /" + PULSE,
    "every floor": WALL + STOREYS.format("every_floor") + CABLE + "&vertical ratio = 0.5 /" + PULSE,
    "bending": WALL + FRAME + CABLE + "&bending EI_over_m_w = 1e5 /" + PULSE,
    "hinge": "&wall h = 5.0, b = 1.2, m_w = 40e3, base = 'pinned' /" + FRAME + PULSE,
    "no motion": WALL + FRAME + "&solver t_end = 2.0 /",
}
DT = 0.02


def quake(n: int = 150) -> rwmf.Motion:
    """Return a record of one sample in 20 ms."""
    t = DT * np.arange(n)
    values = 6.0 * np.sin(9.0 * t) * np.exp(-((t - 1.2) ** 2)) + np.sin(40 * t)
    return rwmf.Motion(values, dt=DT, unit="m/s2", name="quake")


def recorded(text: str = WALL + FRAME + CABLE) -> rwmf.Case:
    """Return a case under that record."""
    whole = text + "&motion kind = 'none' / &solver t_end = 2.98 /"
    return rwmf.Case.from_text(whole).replace(motion=quake())


def summary(case: rwmf.Case) -> dict[str, Any]:
    """Return the numbers of a run by their keys."""
    case = case.replace(output={"dt": None, "reactions": True, "conditioning": False})
    with start(case) as run:
        return dict(run.summary())


@functools.cache
def impacts() -> list[float]:
    """Return the instants of the impacts of the recorded run."""
    run = rwmf.simulate(recorded(), dt=0.1)
    return [float(t) for t in run.event_time[run.event == "impact"]]


class Unit:
    """An instance of a unit in FMPy, with the messages of its logger.

    Parameters
    ----------
    path : Path
        The FMU.
    **options : bool or callable or None
        Of the instantiation.
    """

    def __init__(self, path: Path, **options: bool | Callable[..., None] | None) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        folder = path.with_suffix(".unzipped")
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        self.messages: list[str] = []
        self.fmu = fmi3.FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="wall",
        )
        log: Callable[..., None] = lambda *a: self.messages.append(a[3].decode())  # noqa: E731
        self.fmu.instantiate(logMessage=log, **options)

    def begin(self, t: float = 0.0, **values: float) -> Unit:
        """Initialize with parameters and inputs; ``__`` in a name is a dot."""
        self.fmu.enterInitializationMode(startTime=t)
        for name, value in values.items():
            self.set(name.replace("__", "."), value)
        self.fmu.exitInitializationMode()
        return self

    def set(self, name: str, value: float) -> None:
        """Set a variable."""
        variable = self.variables[name]
        getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    def __getitem__(self, name: str) -> float:
        """Return the value of a variable."""
        variable = self.variables[name]
        found: list[float] = getattr(self.fmu, f"get{variable.type}")([variable.valueReference])
        return found[0]

    def outputs(self) -> dict[str, float]:
        """Return all outputs."""
        names = [v.name for v in self.description.modelVariables if v.causality == "output"]
        return {name: self[name] for name in names}

    def error(self, call: Callable[[], Any]) -> str:
        """Return the message of a refused call."""
        self.messages.clear()
        with pytest.raises(fmpy.fmi1.FMICallException) as raised:
            call()
        assert raised.value.status == fmi3.fmi3Error
        return self.messages[0]


def same(a: dict[str, float], b: dict[str, float]) -> bool:
    """Compare outputs bit by bit; NaN equals NaN."""
    return a.keys() == b.keys() and all(np.array_equal(a[key], b[key], equal_nan=True) for key in a)


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a unit of a wall with frame and tendon under the record."""
    path = tmp_path_factory.mktemp("fmu") / "record.fmu"
    export_fmu(recorded(), path)
    return path


@pytest.fixture(scope="module")
def link(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a unit of the same wall as an element."""
    path = tmp_path_factory.mktemp("fmu") / "link.fmu"
    export_fmu(recorded(), path, link=True)
    return path


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return the unit of a case, exported once."""
    folder = tmp_path_factory.mktemp("cases")

    def find(name: str) -> Path:
        path = folder / f"{name}.fmu"
        if not path.exists():
            export_fmu(rwmf.Case.from_text(CASES[name]), path)
        return path

    return find


@pytest.mark.parametrize("name", CASES)
def test_unit_is_valid_and_repeats_the_run(name: str, exported: Callable[[str], Path]) -> None:
    case, path = rwmf.Case.from_text(CASES[name]), exported(name)
    assert validate_fmu(str(path)) == []
    unit = Unit(path).begin()
    t_end = case.solver.t_end
    # a pulse has no knots to cut at: the results agree to the tolerance of the case
    times = np.sort(np.random.default_rng(7).uniform(0.0, t_end, 60))
    for a, b in zip([0.0, *times], [*times, t_end], strict=True):
        unit.fmu.doStep(a, b - a)
    expected = summary(case) if case.motion is not None else {}
    shared = unit.outputs().keys() & expected.keys()
    assert case.motion is None or len(shared) > 8
    # the moment at a hinge is round-off of the moments in the wall
    round_off = {"wall_moment_base_max_N_m": 1e-12 * expected.get("wall_moment_max_N_m", 0.0)}
    for key in sorted(shared):
        least = max(1e-9, round_off.get(key, 0.0))
        assert unit[key] == pytest.approx(expected[key], rel=2e-6, abs=least, nan_ok=True), key


def test_same_bits_as_the_run_at_the_samples_of_a_record(record: Path) -> None:
    outputs = [
        v.name for v in fmpy.read_model_description(str(record)).modelVariables
        if v.causality == "output"
    ]  # fmt: skip
    found = fmpy.simulate_fmu(str(record), output=outputs, output_interval=DT, stop_time=2.98)
    expected = summary(recorded())
    shared = set(outputs) & expected.keys()
    assert len(shared) > 30
    assert expected["impacts"] > 5
    for key in shared:
        assert found[key][-1] == expected[key], key
    run = rwmf.simulate(recorded(), dt=DT)
    np.testing.assert_allclose(found["theta_rad"], run.theta.values, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(found["u_s_m"], run.u_s.values, rtol=1e-12, atol=1e-15)


def test_same_bits_as_a_wall_that_steps_in_python(record: Path) -> None:
    """The wall of Python has the bits of a host in C (`tests/python/hosts`)."""
    unit = Unit(record).begin()
    with rwmf.Wall(recorded()) as wall:
        for i in range(149):
            unit.fmu.doStep(DT * i, DT)
            wall.advance(DT * i + DT)
            state, forces = wall.state, wall.forces
            assert unit["theta_rad"] == state.theta, i
            assert unit["theta_dot_rad_s"] == state.theta_dot, i
            assert unit["u_s_m"] == state.u_s, i
            assert unit["link_force"] == forces.link, i
        assert unit["u_s_max_m"] == wall.maxima.u_s_max
        assert unit["impacts"] == wall.state.impacts > 5


def test_samples_as_input_give_the_record(record: Path) -> None:
    own, given = Unit(record).begin(), Unit(record)
    values = quake().values
    given.begin(own_motion=False, ground_is_linear=True)
    for i in range(149):
        given.set("ground_acceleration", values[i])
        given.set("ground_acceleration_end", values[i + 1])
        own.fmu.doStep(DT * i, DT)
        given.fmu.doStep(DT * i, DT)
    for key in ("u_s_max_m", "theta_max_over_alpha", "base_shear_max_over_weight", "link_force"):
        assert given[key] == pytest.approx(own[key], rel=1e-11), key
    assert given["impacts"] == own["impacts"]


def test_constant_ground_acceleration(record: Path) -> None:
    whole, parts = Unit(record).begin(own_motion=False), Unit(record).begin(own_motion=False)
    for unit in (whole, parts):
        unit.set("ground_acceleration", 4.0)
    whole.fmu.doStep(0.0, 0.3)
    for i in range(3):
        parts.fmu.doStep(0.1 * i, 0.1)
    assert whole["lift_offs"] == 1
    assert parts["theta_rad"] == pytest.approx(whole["theta_rad"], rel=1e-8)
    assert whole["u_g_ddot_m_s2"] == 4.0


@pytest.mark.parametrize("name", ["fuses", "storeys", "bending", "yielding", "tendon"])
def test_restored_state_repeats_all_outputs(name: str, exported: Callable[[str], Path]) -> None:
    unit = Unit(exported(name)).begin()
    unit.fmu.doStep(0.0, 0.45)
    before = unit.outputs()
    state = unit.fmu.getFMUState()
    results = []
    for _ in range(2):
        unit.fmu.doStep(0.45, 0.3)
        unit.fmu.doStep(0.75, 1.1)
        results.append(unit.outputs())
        unit.fmu.setFMUState(state)
        assert same(unit.outputs(), before)
    assert same(*results)
    assert not same(results[0], before)
    unit.fmu.freeFMUState(state)


def test_state_belongs_to_its_parameters(record: Path) -> None:
    unit = Unit(record).begin(frame__T_s=0.9)
    unit.fmu.doStep(0.0, 1.0)
    state, before = unit.fmu.getFMUState(), unit.outputs()
    unit.fmu.reset()
    unit.begin(frame__T_s=0.5)
    unit.fmu.doStep(0.0, 0.5)
    unit.fmu.setFMUState(state)
    assert unit["frame.T_s"] == 0.9
    assert same(unit.outputs(), before)


@pytest.mark.parametrize("by", ["early return", "event mode", "request"])
def test_steps_end_at_the_impacts(by: str, record: Path) -> None:
    def ask(*arguments: object) -> None:
        _, t, can_set, can_get, _, can_return_early, wish, _ = arguments
        assert (can_set, can_get, can_return_early) == (False, True, True)
        asked.append(t)
        wish[0] = True

    asked: list[float] = []
    unit = Unit(
        record,
        earlyReturnAllowed=True,
        eventModeUsed=by == "event mode",
        intermediateUpdate=ask if by == "request" else None,
    ).begin()
    if by == "event mode":
        unit.fmu.enterStepMode()
    t, found = 0.0, []
    while t < 2.98:
        event, _, early, last = unit.fmu.doStep(t, min(0.5, 2.98 - t))
        assert event == (early and by == "event mode")
        assert last < t + 0.5 or not early
        if early:
            assert unit["theta_rad"] == 0.0
            found.append(last)
        if event:
            unit.fmu.enterEventMode()
            assert unit.fmu.updateDiscreteStates()[0] is False
            unit.fmu.enterStepMode()
        t = last if early else t + min(0.5, 2.98 - t)
    expected = impacts()
    assert found == pytest.approx(expected, abs=1e-9)
    assert unit["impacts"] == len(expected)
    assert asked == (found if by == "request" else [])


def test_impacts_are_told_without_an_early_return(record: Path) -> None:
    told: list[float] = []
    unit = Unit(record, intermediateUpdate=lambda _e, t, *_: told.append(t)).begin()
    unit.fmu.doStep(0.0, 2.98)
    assert told == pytest.approx(impacts(), abs=1e-9)


def test_parameters_are_those_of_the_case(tmp_path: Path) -> None:
    case = rwmf.Case.from_text(CASES["storeys"])
    first, other = tmp_path / "first.fmu", tmp_path / "other.fmu"
    strengths = [0.012, 0.012, 0.02, 0.012]
    case = case.replace(yielding={"storey_u_y": [0.012] * 4})
    export_fmu(case, first)
    export_fmu(case.replace(yielding={"storey_u_y": strengths}, frame={"xi_s": 0.05}), other)
    changed = Unit(first)
    changed.set("frame.xi_s", 0.05)
    changed.begin(**{"yielding__storey_u_y[3]": 0.02})
    expected = Unit(other).begin()
    for unit in (changed, expected):
        unit.fmu.doStep(0.0, 1.5)
    assert same(changed.outputs(), expected.outputs())
    plain = Unit(first).begin()
    plain.fmu.doStep(0.0, 1.5)
    assert not same(plain.outputs(), expected.outputs())


def test_instances_and_reset(record: Path) -> None:
    one, other = Unit(record).begin(), Unit(record).begin(motion__scale=0.5)
    for i in range(20):
        one.fmu.doStep(0.1 * i, 0.1)
        other.fmu.doStep(0.1 * i, 0.1)
    assert one["u_s_max_m"] > 1.2 * other["u_s_max_m"]
    results = one.outputs()
    other.fmu.terminate()
    assert other["u_s_max_m"] > 0
    other.fmu.reset()
    other.begin()
    assert other["motion.scale"] == 1.0
    for i in range(20):
        other.fmu.doStep(0.1 * i, 0.1)
    assert same(other.outputs(), results)
    one.fmu.freeInstance()
    assert same(other.outputs(), results)
    other.fmu.freeInstance()


def step(t: float, h: float) -> Callable[[Unit], Any]:
    return lambda unit: unit.fmu.doStep(t, h)


WRONG: dict[str, tuple[Callable[[Unit], Any], str]] = {
    "start": (step(0.1, 0.1), "begins at 0.1"),
    "no length": (step(0.0, 0.0), "must be positive"),
    "back": (step(0.0, -0.1), "must be positive"),
    "no number": (step(0.0, np.nan), "must be positive"),
    "nan": (lambda unit: unit.set("ground_acceleration", np.nan), "must be a finite number"),
    "infinite": (lambda unit: unit.set("ground_acceleration", np.inf), "must be a finite number"),
    "output": (lambda unit: unit.set("theta_rad", 0.1), "theta_rad is an output"),
    "fixed": (lambda unit: unit.set("frame.T_s", 0.5), "frame.T_s is fixed"),
    "type": (lambda unit: unit.fmu.getInt64([1]), "ground_acceleration is of another type"),
    "reference": (lambda unit: unit.fmu.getFloat64([999]), "999 is no value reference"),
    "no such type": (lambda unit: unit.fmu.getFloat32([1]), "no variable has this type"),
    "mode": (lambda unit: unit.fmu.exitInitializationMode(), "not allowed here (step mode)"),
    "event mode": (lambda unit: unit.fmu.enterEventMode(), "without event mode"),
    "serialise": (
        lambda unit: unit.fmu.serializeFMUState(unit.fmu.getFMUState()),
        "as the model description declares",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_call_is_refused_and_changes_nothing(name: str, record: Path) -> None:
    unit = Unit(record).begin()
    before = unit.outputs()
    call, message = WRONG[name]
    assert message in unit.error(lambda: call(unit))
    assert same(unit.outputs(), before)
    unit.fmu.doStep(0.0, 0.1)


def test_wrong_parameters_and_modes(record: Path, tmp_path: Path) -> None:
    unit = Unit(record)
    assert "instantiated" in unit.error(lambda: unit["theta_rad"])
    unit.fmu.enterInitializationMode(startTime=0.0, stopTime=1.0)
    unit.set("frame.T_s", -1.0)
    message = unit.error(unit.fmu.exitInitializationMode)
    assert "&frame: T_s" in message
    assert "-1" in message
    unit.set("frame.T_s", 0.8)
    unit.fmu.exitInitializationMode()
    assert "after the stop time" in unit.error(lambda: unit.fmu.doStep(0.0, 1.5))
    unit.set("ground_acceleration", 1.0)
    assert "set own_motion to false" in unit.error(lambda: unit.fmu.doStep(0.0, 0.5))
    with pytest.raises(Exception, match="instantiate"):
        other = Unit(record)
        other.fmu.guid = "other"
        other.fmu.instantiate(logMessage=lambda *a: other.messages.append(a[3].decode()))
    assert "instantiation token" in other.messages[-1]


@pytest.mark.parametrize(
    ("text", "link", "message"),
    [
        ("", True, "an element needs the group &wall"),
        ("&solver accuracy = 1e-6, t_end = 3.0 /", False, "accuracy needs the whole motion"),
        ("&fuse F_y = 40e3, k = 2e7 /", True, "fuse"),
        ("&storeys n = 2, m = 25e3, k = 25e6, height = 5.0, coupling = 'full' /", True, "storeys"),
    ],
)
def test_export_refuses(text: str, link: bool, message: str, tmp_path: Path) -> None:
    scene = WALL + ("&frame xi_s = 0.04 /" if "storeys" in text else FRAME) + text
    if not text:
        scene = "&frame T_s = 0.8, xi_s = 0.04 /"
    rest = PULSE if "solver" not in text else PULSE[: PULSE.index("&solver")]
    with pytest.raises(InputError, match=message):
        export_fmu(rwmf.Case.from_text(scene + rest), tmp_path / "x.fmu", link=link)
    assert not (tmp_path / "x.fmu").exists()


def test_link_has_the_force_of_the_wall(record: Path, link: Path) -> None:
    assert validate_fmu(str(link)) == []
    wall, element = Unit(record).begin(), Unit(link).begin(start_side=1)
    checked = 0
    for i in range(140):
        wall.fmu.doStep(DT * i, DT)
        if wall["at_rest"] or abs(wall["theta_rad"]) < 1e-4:
            continue
        if (wall["theta_rad"] > 0) != (element["side"] > 0):
            element.fmu.reset()
            element.begin(start_side=1 if wall["theta_rad"] > 0 else -1)
        for name, key in (("u", "u_s_m"), ("u_dot", "u_s_dot_m_s"), ("u_ddot", "u_s_ddot_m_s2")):
            element.set(name, wall[key])
        element.set("ground_acceleration", wall["u_g_ddot_m_s2"])
        assert element["force"] == pytest.approx(-wall["link_force"], rel=1e-8, abs=1.0)
        assert element["theta"] == pytest.approx(wall["theta_rad"], rel=1e-10)
        checked += 1
    assert checked > 50


def test_link_ends_a_step_at_its_impact(link: Path) -> None:
    unit = Unit(link, earlyReturnAllowed=True).begin(u=0.01, u_dot=-0.5, u_ddot=0.0)
    assert unit["side"] == 1
    _, _, early, last = unit.fmu.doStep(0.0, 0.1)
    assert early
    assert last == pytest.approx(0.02, rel=1e-12)
    assert (unit["side"], unit["impacts"]) == (-1, 1)
    assert 0 < unit["velocity_factor"] < 1
    unit.set("u", 0.0)
    unit.set("u_dot", -0.5 * unit["velocity_factor"])
    _, _, early, _ = unit.fmu.doStep(last, 0.01)
    assert not early
    # a resting wall carries the push of the frame until that lifts it
    rest = Unit(link, earlyReturnAllowed=True).begin()
    rest.set("push", 1e3)
    assert (rest["side"], rest["force"]) == (0, 1e3)
    assert rest.fmu.doStep(0.0, 0.1)[2] is False
    rest.set("push", 1e6)
    rest.fmu.doStep(0.1, 0.1)
    assert (rest["side"], rest["lift_offs"]) == (1, 1)


def test_unit_is_self_contained(record: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(record) as archive:
        archive.extractall(tmp_path)
        names = archive.namelist()
    (folder,) = (tmp_path / "binaries").iterdir()
    needed = run_words(["ldd", folder / "rwmf.so"], tmp_path)
    assert needed.returncode == 0
    for line in needed.stdout.splitlines():
        name, *where = line.split()
        system = Path(name).name.startswith(
            ("libc.", "libm.", "libgcc_s.", "ld-linux", "linux-vdso")
        )
        assert system or str(folder) in where[1], line
    assert "documentation/licenses/license.txt" in names
    for name in ("modelDescription.xml", "resources/case.nml", "resources/variables.txt"):
        assert str(ROOT).encode() not in (tmp_path / name).read_bytes()
    assert {"resources/motion.txt", "resources/case.nml"} < set(names)


@pytest.mark.parametrize("source", ["fmu.c", "unsupported.c"])
def test_signatures_are_those_of_the_standard(source: str, tmp_path: Path) -> None:
    """The headers of FMPy take the place of ours: another signature would be an error."""
    folder = Path(fmpy.__file__).parent / "c-code"
    command = ["gcc", "-std=gnu11", "-fsyntax-only", "-DRWMF_FMI3_H", f"-I{folder}"]
    command += ["-include", "fmi3Functions.h", f"-I{ROOT / 'include'}"]
    found = run_words([*command, ROOT / "src/bindings/fmi" / source], tmp_path)
    assert found.returncode == 0, found.stderr
