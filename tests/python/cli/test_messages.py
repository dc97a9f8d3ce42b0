"""Messages of the program: suggestions, written files, numbers, optional packages."""

import re
import subprocess
import tomllib
from importlib import import_module, metadata
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from rwmf import cli
from rwmf._renamed import renamed
from rwmf.cli.command_table import COMMANDS
from rwmf.errors import InputError
from rwmf.kernel import names as _extras
from rwmf.kernel import tables
from rwmf.run.quantities import QUANTITIES
from scenes import coupled


@pytest.mark.parametrize(
    ("word", "key"),
    [
        ("IDR", "storey_drift_max"),
        ("max IDR", "storey_drift_max"),
        ("idr_3", "storey_drift_max"),
        ("interstorey drift", "storey_drift_max"),
        ("inter-story drift", "storey_drift_max"),
        ("Interstory_Drift_max", "storey_drift_max"),
        ("PFA", "floor_acceleration_max_g"),
        ("peak floor acceleration", "floor_acceleration_max_g"),
        ("RIDR", "storey_residual_drift_max"),
        ("roof displacement", "u_s_max_m"),
        ("tendon force", "tendon_force_max_over_m_w_g"),
        ("base shear", "base_shear_max_over_weight"),
        ("theta_max", "theta_max_over_alpha"),
        ("ductilty", "ductility"),
        ("something else", ""),
    ],
)
def test_words_of_the_field(word: str, key: str) -> None:
    """Suggestions name a quantity wherever one is expected."""
    assert tables.meant_quantity(word) == key
    if not key:
        return
    case = coupled(solver={"t_end": 0.2})
    name = QUANTITIES[key].names("ordinate")[0]
    for call in (
        lambda: rwmf.sweep(case, {"T_s": [1.0]}, quantities=[word]),
        lambda: rwmf.spectrum(case, T_s=[1.0], quantities=[word]),
        lambda: rwmf.Case.from_text(f"{case.text}\n&spectrum T_s = 1, quantities = '{word}' /"),
    ):
        with pytest.raises(InputError, match=rf"did you mean ({re.escape(name)}|{key})\?"):
            call()


def test_every_key_misspelled_is_found() -> None:
    """A letter less, by the table of quantities."""
    for key, item in QUANTITIES.items():
        if key.startswith("sensitivity_"):
            continue
        if "ordinate" in item.outputs.split() and "{" not in key and len(key) > 6:
            assert tables.meant_quantity(key[:-3] + key[-2:]) != ""


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        ({"wall": {"hh": 2.0}}, "&wall: hh: unknown key, did you mean h?"),
        ({"wal": {"h": 2.0}}, "no group &wal, did you mean wall?"),
        ({"wall": {"gamma": 2.0}}, "&wall: gamma: unknown key, did you mean gamma of &frame"),
        ({"wall": {"h = 1 b": 2.0}}, "&wall: h = 1 b: unknown key"),
    ],
)
def test_unknown_keys_of_a_case(groups: dict[str, dict[str, float]], message: str) -> None:
    for make in (lambda: rwmf.Case(**groups), lambda: coupled().replace(**groups)):
        with pytest.raises(InputError) as caught:
            make()
        assert message in str(caught.value)


def test_lines_are_those_of_the_user(tmp_path: Path) -> None:
    """A text has lines, keys and values of Python have none."""
    case = coupled()
    with pytest.raises(InputError, match=r"h = -2.0 \(line 1\)"):
        rwmf.Case.from_text("&wall h = -2.0, b = 0.5 /")
    case.to_namelist(tmp_path / "case.nml")
    read = rwmf.Case.from_namelist(tmp_path / "case.nml")
    for call in (
        lambda: rwmf.Case(wall={"h": -2.0, "b": 0.5}),
        lambda: case.replace(wall={"h": -2.0}),
        lambda: read.replace(wall={"h": -2.0}, frame={"xi_s": 0.1}, fuse={"eta_y": 1.0}),
        lambda: rwmf.sweep(case, {"wall.h": [-2.0, 1.0], "T_s": [1.0]}),
        lambda: rwmf.spectrum(read, T_s=[-1.0]),
    ):
        with pytest.raises(InputError) as caught:
            call()
        assert "(line" not in str(caught.value)


@pytest.mark.parametrize("n", [101, 1000, 3000, 4096])
@pytest.mark.parametrize("dt", [0.01, 0.005, 0.0025, 1 / 3])
def test_times_are_displayed_as_written(n: int, dt: float) -> None:
    """The end of a record is n - 1 times dt; the round-off of the product is not shown."""
    motion = rwmf.Motion(np.resize([0.0, 1.0], n), dt=dt, unit="m/s2")
    case = coupled().replace(motion=motion, solver={"t_end": None})
    (shown,) = re.findall(r"t_end = ([0-9.e+-]+) s", repr(case))
    assert float(shown) == pytest.approx((n - 1) * dt, rel=1e-14)
    digits = len(shown.replace(".", "").strip("0"))
    assert digits <= (15 if dt == 1 / 3 else 7)


def test_run_names_what_it_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    coupled(solver={"t_end": 0.5}).to_namelist("case.nml")
    words = ["run", "case.nml", "--out", "a.svg", "--loops", "b.svg", "--out", "."]
    assert cli.main(words) == 0
    told = re.findall(r"^written: (.*)$", capsys.readouterr().out, re.MULTILINE)
    found = {path.name for path in tmp_path.iterdir()} - {"case.nml"}
    assert {Path(path).name for path in told} == found
    assert {"a.svg", "b.svg", "case.summary.csv"} <= found
    # a history of another run is not this one's
    (tmp_path / "case.history.csv").write_text("old")
    assert cli.main([*words, "--json"]) == 0
    both = capsys.readouterr()
    assert "written" not in both.out
    assert "case.history.csv" not in both.err
    assert "written: a.svg" in both.err


def test_optional_packages_are_those_of_the_project() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    wanted = tomllib.loads(text)["project"]["optional-dependencies"]
    assert {name: list(words) for name, words in _extras.PACKAGES.items()} == {
        name: wanted[name] for name in _extras.PACKAGES
    }


@pytest.mark.parametrize("purpose", _extras.PACKAGES)
def test_hints_fit_where_the_package_is(purpose: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "distribution", lambda _: object())
    assert f"'rwmf[{purpose}]'" in _extras.how_to_install(purpose)

    def missing(name: str) -> object:
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(metadata, "distribution", missing)
    hint = _extras.how_to_install(purpose)
    assert "rwmf[" not in hint
    assert all(word in hint for word in _extras.PACKAGES[purpose])


def test_functions_take_a_path(tmp_path: Path) -> None:
    """Each function that takes a case takes that of its namelist, as text or path."""
    case = coupled(solver={"t_end": 0.5})
    case.to_namelist(tmp_path / "case.nml")
    grid = {"T_s": [0.5]}
    for call in (
        lambda x: rwmf.simulate(x, 0.1),
        lambda x: rwmf.spectrum(x, T_s=[0.5]),
        lambda x: rwmf.sweep(x, grid),
        lambda x: rwmf.studies.wall_effect(x, grid),
        lambda x: rwmf.studies.overturning_map(x, [5.0], [1.0, 9.0], tolerance=1.0),
        lambda x: rwmf.studies.equal_response(x, [0.5], 0.05, tolerance=0.5),
    ):
        expected = call(rwmf.Case.from_namelist(tmp_path / "case.nml"))
        for path in (tmp_path / "case.nml", str(tmp_path / "case.nml")):
            found = call(path)
            for name in expected.data_vars:
                if name != "seconds":
                    assert found[name].equals(expected[name]), name


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_has_every_command_and_option(
    shell: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["--completion", shell]) == 0
    script = capsys.readouterr().out
    for name, command in COMMANDS.items():
        assert name.split()[-1] in script
        for word in command.words:
            assert not word.names[0].startswith("--") or word.names[0][2:] in script
    if shell == "bash":
        subprocess.run(["bash", "-n"], input=script, text=True, check=True)


def test_bash_completes_options_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["--completion", "bash"]) == 0
    script = capsys.readouterr().out
    for words, expected in (("rwmf spec", "spectrum"), ("rwmf study wall --ga", "--gamma")):
        line = f"COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _rwmf"
        done = subprocess.run(
            ["bash", "-c", f'{script}\n{line}; echo "${{COMPREPLY[@]}}"'],
            capture_output=True, text=True, check=True,
        )  # fmt: skip
        assert done.stdout.split() == [expected]


@pytest.mark.parametrize(("name", "new"), renamed("names").items())
def test_an_earlier_name_names_the_new_one(name: str, new: str) -> None:
    module, _, last = f"rwmf.{name}".rpartition(".")
    with pytest.raises(AttributeError, match=re.escape(f"it is now {new}")):
        getattr(import_module(module), last)
    if new.startswith("rwmf.") and " " not in new:
        home, _, word = new.rpartition(".")
        assert getattr(import_module(home), word)
