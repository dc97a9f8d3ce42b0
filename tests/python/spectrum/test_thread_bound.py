"""More threads than anybody can mean are refused: by every way to a spectrum, with the number."""

from pathlib import Path

import pytest
import rwmf
from checkout import Runner
from rwmf.kernel import results

SCENE = "&frame xi_s = 0.05 /\n&solver t_end = 1.0 /\n&spectrum T_s = 1.0, 2.0 /\n"
TOO_MANY = ["100000", "99999999999"]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "scene.nml"
    path.write_text(SCENE, encoding="utf-8")
    return path


@pytest.mark.parametrize("threads", [-1, 100_000, 2**31, 99_999_999_999, 2.5, "two"])
def test_a_number_that_is_none(threads: int) -> None:
    with pytest.raises(rwmf.InputError, match=rf"threads = {threads!r}: must be 0 \(all\) to"):
        rwmf.spectrum(rwmf.Case.from_text(SCENE), threads=threads)


def test_many_threads_change_nothing() -> None:
    case = rwmf.Case.from_text(SCENE)
    one = rwmf.spectrum(case, threads=1)
    many = rwmf.spectrum(case, threads=200)
    assert many.attrs["threads"] == 200
    assert one.identical(many.assign_attrs(one.attrs))


@pytest.mark.parametrize("number", TOO_MANY)
def test_the_environment(
    number: str, file: Path, batch: Runner, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a new process, in which OpenMP reads it
    monkeypatch.setenv("OMP_NUM_THREADS", number)
    ended = batch(file)
    assert ended.returncode == 2
    assert "scene.nml: OMP_NUM_THREADS = " in ended.stderr


@pytest.mark.parametrize("number", TOO_MANY)
def test_a_sweep(number: str, monkeypatch: pytest.MonkeyPatch) -> None:
    case = rwmf.Case.from_text(SCENE)
    with pytest.raises(rwmf.InputError, match=f"threads = {number}: must be"):
        rwmf.sweep(case, grid={"xi_s": [0.02, 0.05]}, threads=int(number))
    monkeypatch.setenv("OMP_NUM_THREADS", number)
    with pytest.raises(rwmf.InputError, match=f"OMP_NUM_THREADS = {number}: must be"):
        rwmf.sweep(case, grid={"xi_s": [0.02, 0.05]})


def test_the_bound_is_that_of_the_kernel() -> None:
    assert results.check_threads(256) == 256
    assert results.check_threads(0) == 0
