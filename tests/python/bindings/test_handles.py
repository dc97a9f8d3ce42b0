"""A case is read once and lives in the kernel; results are seen there, not copied, and safely."""

import copy
import gc
import multiprocessing
import pickle
import shutil
import sys
import threading
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT, run_words
from rwmf.kernel import results
from rwmf.run import simulation
from scenes import coupled, record

# growth of a process that does nothing but make and drop cases: an allocator's slack
_SLACK_BYTES = 8 * 2**20


@pytest.fixture
def case_file(elcentro: Path, tmp_path: Path) -> Path:
    """Write a case with a separate record beside it."""
    shutil.copy(elcentro, tmp_path / "rec.csv")
    path = tmp_path / "case.nml"
    motion = record(tmp_path / "rec.csv")
    coupled(motion=motion, solver={"t_end": 4.0}).to_namelist(path)
    return path


def _resident_bytes() -> int:
    pages = int(Path("/proc/self/statm").read_text(encoding="utf-8").split()[1])
    return pages * 4096


def _digest(dataset: object) -> list[bytes]:
    """Bits of a run, but for the seconds that it took."""
    return [data.values.tobytes() for name, data in dataset.data_vars.items() if name != "seconds"]


def test_the_record_is_read_once(case_file: Path) -> None:
    """A case keeps the contents read from its files, and edited cases inherit them."""
    case = rwmf.Case.from_namelist(case_file)
    expected = float(rwmf.simulate(case, 0.02).u_s_max)
    case_file.with_name("rec.csv").unlink()
    assert float(rwmf.simulate(case).u_s_max) == expected
    assert float(rwmf.simulate(case, 0.02).u_s_max) == expected
    edited = case.replace(frame={"T_s": 0.7}).replace(frame={"T_s": case.frame.T_s})
    assert float(rwmf.simulate(edited).u_s_max) == expected
    assert float(rwmf.spectrum(case, T_s=case.frame.T_s).u_s_max.squeeze()) > 0
    assert copy.deepcopy(case) is case
    assert copy.copy(case) is case
    assert float(rwmf.simulate(case.replace(motion={"scale": 2.0})).u_s_max) != expected
    with pytest.raises(rwmf.InputError, match="does not exist"):
        case.replace(motion={"file": "other.csv"})
    with pytest.raises(rwmf.InputError, match="does not exist"):
        pickle.loads(pickle.dumps(case))


def test_edits_in_another_folder(case_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A case keeps its contents in place after reading."""
    monkeypatch.chdir(case_file.parent)
    case = rwmf.Case.from_namelist(case_file.name)
    path = case.to_namelist()
    monkeypatch.chdir("/")
    assert case.replace(output=None).to_namelist() == path
    assert case.replace(motion={"scale": 2.0}).motion.scale == 2.0


def test_one_case_in_many_threads(case_file: Path) -> None:
    case = rwmf.Case.from_namelist(case_file)
    expected = _digest(rwmf.simulate(case, 0.02))

    def work(i: int) -> list[bytes]:
        if i % 4 == 0:
            rwmf.spectrum(case, T_s=[0.5, 1.0], threads=2)
        return _digest(rwmf.simulate(case, 0.02))

    with ThreadPoolExecutor(8) as executor:
        found = list(executor.map(work, range(24)))
    assert all(one == expected for one in found)


def test_arrays_outlive_their_run(case_file: Path) -> None:
    case = rwmf.Case.from_namelist(case_file)
    with simulation.start(case.replace(output={"dt": 0.01})) as run:
        columns, values = run.history()
        dataset = simulation.to_dataset(run, case)
        # not copied: the dataset shows the memory of the run
        assert np.shares_memory(dataset["u_s"].values, values)
    with pytest.raises(RuntimeError, match="released"):
        run.history()
    expected = values.copy()
    del case, run
    gc.collect()
    # memory that was given back would now be written over
    for _ in range(20):
        rwmf.simulate(rwmf.Case.from_namelist(case_file), 0.01)
    assert np.array_equal(values, expected, equal_nan=True)
    column = values[columns.index("u_s_m")]
    del values
    gc.collect()
    assert np.array_equal(column, expected[columns.index("u_s_m")])
    assert np.array_equal(dataset["u_s"].values, column)
    again = pickle.loads(pickle.dumps(dataset))
    assert again.identical(dataset)
    assert not np.shares_memory(again["u_s"].values, column)
    dataset["u_s"].values[:] = 0.0
    assert not np.array_equal(again["u_s"].values, dataset["u_s"].values)


def test_spectra_outlive_their_sweep(case_file: Path) -> None:
    case = rwmf.Case.from_namelist(case_file)
    first = rwmf.spectrum(case, T_s=[0.5, 1.0, 1.5])
    expected = first.u_s_max.values.copy()
    for _ in range(20):
        rwmf.spectrum(case, T_s=[0.7, 1.1, 1.6])
    assert np.array_equal(first.u_s_max.values, expected)


def test_arrays_are_dropped_in_any_thread(case_file: Path) -> None:
    case = rwmf.Case.from_namelist(case_file)
    kept = [rwmf.simulate(case, 0.01) for _ in range(8)]
    workers = [threading.Thread(target=kept.pop) for _ in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert not kept


def _peak(case: rwmf.Case) -> tuple[float, object]:
    dataset = rwmf.simulate(case, 0.05)
    return float(dataset.u_s_max), dataset


def test_cases_go_to_other_processes(case_file: Path) -> None:
    case = rwmf.Case.from_namelist(case_file)
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as executor:
        peak, dataset = executor.submit(_peak, case).result(timeout=120)
    expected = rwmf.simulate(case, 0.05)
    assert peak == float(expected.u_s_max)
    assert np.array_equal(dataset["theta"].values, expected["theta"].values)


def _run_program(*lines: str) -> str:
    """Output of a Python program that ends well, without a message except warnings of results."""
    words = [sys.executable, "-W", "ignore::UserWarning", "-c", "\n".join(lines)]
    found = run_words(words, ROOT)
    assert (found.returncode, found.stderr) == (0, "")
    return found.stdout


def test_a_forked_child_has_a_case_of_its_own(case_file: Path) -> None:
    assert (
        _run_program(
            "import os, rwmf",
            f"case = rwmf.Case.from_namelist({str(case_file)!r})",
            "child = os.fork()",
            "peak = float(rwmf.simulate(case, 0.05).u_s_max)",
            "del case",
            "if child: assert os.waitpid(child, 0)[1] == 0; print(peak > 0)",
        )
        == "True\n"
    )


def test_results_survive_the_end_of_the_interpreter(case_file: Path) -> None:
    """Arrays, cases and runs that live until exit do no harm there."""
    assert (
        _run_program(
            "import rwmf; from rwmf.run import simulation",
            f"case = rwmf.Case.from_namelist({str(case_file)!r})",
            "dataset = rwmf.simulate(case, 0.01)",
            "run = simulation.start(case).__enter__()",
            "class Last:",
            "    def __init__(self, it): self.it = it",
            "    def __del__(self): print(float(self.it[0]))",
            "last = Last(dataset['u_s'].values)",
            "circle = [case, dataset]; circle.append(circle)",
        )
        == "0.0\n"
    )


def test_cases_that_are_dropped_leave_no_memory(case_file: Path) -> None:
    text = case_file.read_text(encoding="utf-8")

    def make(n: int) -> None:
        for _ in range(n):
            case = rwmf.Case.from_text(text, case_file)
            assert case.kernel.end_of_motion() > 0
            with pytest.raises(rwmf.InputError):
                case.replace(frame={"T_s": -1.0})

    make(100)
    before = _resident_bytes()
    make(1000)
    assert _resident_bytes() - before < _SLACK_BYTES


def test_runs_that_are_dropped_leave_no_memory() -> None:
    case = coupled(solver={"t_end": 2.0}, output={"dt": 1e-4})

    def run(n: int) -> None:
        for _ in range(n):
            rwmf.simulate(case)

    run(10)
    before = _resident_bytes()
    # a history is 1 MiB
    run(100)
    assert _resident_bytes() - before < _SLACK_BYTES


def test_numbers_stay_numbers() -> None:
    """The kinds of the summary, and more scalars than are fetched at once."""
    balanced = {"rule": "coupled", "e": None}
    case = coupled(output={"energy": True, "reactions": True}, impact=balanced)
    with results.start_simulation(case.kernel, "") as run:
        whole = run.summary()
        room, results._FIRST_CAPACITY = results._FIRST_CAPACITY, 2
        try:
            assert run.summary() == whole
        finally:
            results._FIRST_CAPACITY = room
    assert type(whole["u_s_max_m"]) is float
    assert type(whole["impacts"]) is int
    assert type(whole["overturned"]) is bool
    assert type(whole["method"]) is str
    assert whole["effects"][:2] == ["wall", "frame"]
    assert whole["warnings"] == []
