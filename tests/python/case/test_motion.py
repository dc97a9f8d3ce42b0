"""A motion from arrays is a record without a file: same rules, same bits, same places."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest
import rwmf
import scenes
from refused import refusals
from rwmf.run.simulation import start

_DT = 0.02
_A = np.sin(np.arange(200) * _DT * 7.0) * np.exp(-np.arange(200) * _DT)


def coupled(**groups: object) -> rwmf.Case:
    """Return the coupled scene with another motion."""
    return scenes.coupled().replace(motion=None).replace(**groups)


def block(**groups: object) -> rwmf.Case:
    """Return the free-standing block with another motion."""
    return scenes.block().replace(motion=None).replace(**groups)


def _written(tmp_path: Path, text: str, **keys: object) -> dict[str, object]:
    path = tmp_path / f"record_{len(list(tmp_path.iterdir()))}.txt"
    path.write_text(text, encoding="utf-8")
    return {"kind": "record", "file": str(path)} | keys


def _bits(case: rwmf.Case) -> list[bytes]:
    run = rwmf.simulate(case, 0.05)
    return [run[name].values.tobytes() for name in run.data_vars if name != "seconds"]


def test_arrays_and_files_give_the_same_bits(tmp_path: Path) -> None:
    column = _written(tmp_path, "\n".join(map(repr, _A.tolist())), dt=_DT, unit="g")
    motion = rwmf.Motion(_A, dt=_DT, unit="g", name="one")
    expected = _bits(coupled(motion=column))
    assert _bits(coupled(motion=motion)) == expected
    assert _bits(scenes.coupled().replace(motion=motion)) == expected
    scaled = _bits(coupled(motion=column | {"scale": 1.5}))
    assert _bits(coupled(motion={"file": motion, "scale": 1.5})) == scaled
    assert _bits(coupled(motion=motion).replace(motion={"scale": 1.5})) == scaled
    times = np.cumsum(np.linspace(0.01, 0.03, _A.size)) - 0.01
    rows = zip(times.tolist(), _A.tolist(), strict=True)
    columns = _written(tmp_path, "\n".join(f"{t!r} {a!r}" for t, a in rows), unit="cm/s2")
    uneven = rwmf.Motion(_A, times=times, unit="cm/s2")
    assert _bits(coupled(motion=uneven)) == _bits(coupled(motion=columns))
    vertical = {key: value for key, value in columns.items() if key != "kind"}
    both = coupled(motion=column, vertical=vertical)
    assert _bits(coupled(motion=motion, vertical=uneven)) == _bits(both)
    half = {"vertical": {"scale": 0.5}}
    assert _bits(coupled(motion=motion, vertical=uneven).replace(**half)) == _bits(
        both.replace(vertical={"scale": 0.5})
    )


def test_spectra_take_motions() -> None:
    motion = rwmf.Motion(_A, dt=_DT, unit="g")
    periods = np.linspace(0.3, 1.5, 7)
    once = rwmf.spectrum(coupled(motion=motion), T_s=periods)
    twice = rwmf.spectrum(coupled(motion={"file": motion, "scale": 2.0}), T_s=periods)
    assert (once.status == "ok").all()
    assert not np.array_equal(once.u_s_max, twice.u_s_max)


def test_a_motion_is_replaced_like_a_file() -> None:
    motion = rwmf.Motion(_A, dt=_DT, unit="g", name="it's one")
    case = coupled(motion=motion)
    assert case.motion.file == "it's one"
    assert case.motions == {"motion": motion}
    assert case.inputs == ()
    # changing a choice parses the text, which contains the name only
    edited = case.replace(model={"formulation": "exact"})
    assert edited.motions == {"motion": motion}
    pulse = case.replace(motion=None).replace(
        motion={"kind": "one_sine", "a_max_g": 0.4, "T_p": 1.0}, solver={"t_end": 4.0}
    )
    assert pulse.motions == {}
    other = rwmf.Motion(2 * _A, dt=_DT, unit="g", name="it's one")
    assert case.replace(motion=other) != case
    assert case.replace(motion=motion) == case
    assert block(motion=motion).motion.kind == "record"
    with pytest.raises(rwmf.InputError, match="belongs into motion or vertical"):
        case.replace(wall={"h": motion})


def test_motions_are_pickled_and_compared() -> None:
    motion = rwmf.Motion(_A, dt=_DT, unit="g", name="one")
    again = pickle.loads(pickle.dumps(motion))
    assert again == motion
    assert hash(again) == hash(motion)
    assert copy.deepcopy(motion) is motion
    assert motion != rwmf.Motion(_A, dt=_DT, unit="g", name="two")
    assert motion != rwmf.Motion(_A, dt=2 * _DT, unit="g", name="one")
    case = coupled(motion=motion).replace(motion={"scale": 1.5})
    back = pickle.loads(pickle.dumps(case))
    assert back == case
    assert hash(back) == hash(case)
    assert _bits(back) == _bits(case)
    with pytest.raises(ValueError, match="read-only"):
        motion.values[0] = 1.0
    with pytest.raises(AttributeError, match="cannot be changed"):
        motion.name = "other"  # type: ignore[misc]


def test_a_motion_is_written_beside_its_case(tmp_path: Path) -> None:
    times = np.arange(200) * _DT
    case = coupled(
        motion={"file": rwmf.Motion(_A, dt=_DT, unit="g"), "scale": 1.5},
        vertical=rwmf.Motion(_A, times=times, unit="m/s2"),
    )
    with pytest.raises(rwmf.InputError, match=r"to_namelist\(path\) writes it beside"):
        case.to_namelist()
    case.to_namelist(tmp_path / "quake.nml")
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "quake.nml",
        "quake_motion.txt",
        "quake_vertical.txt",
    ]
    assert _bits(rwmf.Case.from_namelist(tmp_path / "quake.nml")) == _bits(case)


def test_outputs_name_the_motion(tmp_path: Path) -> None:
    motion = rwmf.Motion(_A, dt=_DT, unit="g", name="synthetic 7")
    case = coupled(motion=motion).replace(motion={"scale": 1.5})
    with start(case) as run:
        run.write(case.text, "case.nml", str(tmp_path))
    text = next(tmp_path.glob("*summary*")).read_text(encoding="utf-8")
    assert "# record: synthetic 7" in text
    assert motion.checksum in text
    assert "scale = 1.5" in text


test_samples_are_checked = refusals(
    lambda values, keys: rwmf.Motion(values, **{"unit": "g"} | keys),
    ([1.0], {"dt": 0.1}, "1 samples: must be at least 2"),
    ([1.0, np.nan], {"dt": 0.1}, "sample 2: acceleration nan is not a finite number"),
    ([1.0, 2.0], {"times": [1.0, 1.0]}, "sample 2: time 1.0 s after 1.0 s"),
    ([1.0, 2.0], {"times": [1.0, np.inf]}, "sample 2: time inf"),
    ([1.0, 2.0], {"times": [1.0]}, "2 accelerations at 1 times"),
    ([[1.0, 2.0]], {"dt": 0.1}, "must have one dimension"),
    (["a", "b"], {"dt": 0.1}, "must be an array of numbers"),
    ([1.0, 2.0], {}, "exactly one of dt and times"),
    ([1.0, 2.0], {"dt": 0.1, "times": [0.0, 0.1]}, "exactly one of dt and times"),
    ([1.0, 2.0], {"dt": -0.1}, "dt = -0.1: must be a number > 0"),
    ([1.0, 2.0], {"dt": 0.1, "unit": "mm"}, "unit = 'mm': must be 'g', 'm/s2' or 'cm/s2'"),
    ([1.0, 2.0], {"dt": 0.1, "name": " "}, "must be printable text"),
    ([1.0, 2.0], {"dt": 0.1, "name": "a\nb"}, "must be printable text"),
)


def test_what_a_case_makes_of_samples_is_checked() -> None:
    huge = rwmf.Motion([0.0, 1.0e300], dt=0.1, unit="g", name="huge")
    with pytest.raises(rwmf.InputError, match=r"file = 'huge'.*overflow"):
        coupled(motion={"file": huge, "scale": 1.0e10})
    with pytest.raises(rwmf.InputError, match="overflow"):
        coupled(motion=huge).replace(motion={"scale": 1.0e10})
    early = rwmf.Motion([0.0, 1.0], times=[-2.0, -1.0], unit="g")
    with pytest.raises(rwmf.InputError, match="before t = 0"):
        block(motion=early, solver=None)


@pytest.mark.parametrize("header", ["from a table\n0.1 s", ["from a table", "0.1 s"]])
def test_every_line_of_a_header_is_a_comment(header: str | list[str], tmp_path: Path) -> None:
    rwmf.Motion([0.5, -0.25], dt=0.1, unit="m/s2").write(tmp_path / "a.txt", header)
    assert (tmp_path / "a.txt").read_text() == "# from a table\n# 0.1 s\n0.5\n-0.25\n"
