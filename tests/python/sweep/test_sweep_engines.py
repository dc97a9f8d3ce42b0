"""Sweeps on other engines: processes, Dask with a worker that dies, MPI; parts of the batch."""

import os
import shutil
import signal
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import Runner, run_words
from rwmf import cli
from rwmf.errors import InputError
from rwmf.sweeps.executors import open_executor
from scenes import coupled

CASE_SOLVER = {"method": "dop853", "rtol": 1e-6, "t_end": 4.0}
GRID = {"e": np.linspace(0.7, 0.95, 12), "T_s": [0.5, 1.0], "gamma": [5.0, 50.0]}


def _sweep(**how: object) -> xr.Dataset:
    return rwmf.sweep(coupled(solver=CASE_SOLVER), GRID, **how)


def test_processes() -> None:
    with open_executor("processes", 2) as executor:
        xr.testing.assert_identical(_sweep(executor=executor), _sweep())


@pytest.mark.parametrize("end", ["without guard", "shut down"])
def test_an_executor_without_workers_says_what_to_do(end: str, tmp_path: Path) -> None:
    """Processes that are spawned read the script again."""
    coupled(solver=CASE_SOLVER).to_namelist(tmp_path / "case.nml")
    shut = "engine.shutdown()\n" if end == "shut down" else ""
    (tmp_path / "script.py").write_text(
        "import multiprocessing, rwmf\n"
        "from concurrent.futures import ProcessPoolExecutor\n"
        "context = multiprocessing.get_context('spawn')\n"
        f"engine = ProcessPoolExecutor(1, mp_context=context)\n{shut}"
        "rwmf.sweep('case.nml', {'e': [0.8, 0.9]}, executor=engine)\n",
        encoding="utf-8",
    )
    done = run_words([sys.executable, "script.py"], tmp_path)
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("rwmf.errors.InputError: executor: has no workers")
    assert "`if __name__ == '__main__':`" in last


def test_unknown_engines() -> None:
    with pytest.raises(InputError, match="allowed are threads"), open_executor("steam"):
        pass


def test_dask_with_a_worker_that_is_killed(tmp_path: Path) -> None:
    """Two workers; one is killed in the middle: nothing is lost, the result has the same bits."""
    distributed = pytest.importorskip("distributed")
    case = coupled(motion={"kind": "sine", "cycles": 40.0}, solver={"t_end": 60.0})
    grid = {"e": np.linspace(0.7, 0.95, 60), "T_s": [0.2, 0.5]}
    reports: list[int] = []
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(**options, silence_logs=50) as client:
        pids = list(client.run(os.getpid).values())

        def kill() -> None:
            while len(reports) < 5:
                time.sleep(0.01)
            os.kill(pids[0], signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        found = rwmf.sweep(
            case,
            grid,
            executor=client.get_executor(),
            chunk=2,
            progress=lambda done, _: reports.append(done),
        )
        killer.join()
        assert reports[-1] == 120
        assert pids[0] not in client.run(os.getpid).values()
    xr.testing.assert_identical(found, rwmf.sweep(case, grid, chunk=2))


def test_mpi_with_two_ranks(tmp_path: Path) -> None:
    pytest.importorskip("mpi4py")
    if shutil.which("mpiexec") is None:
        pytest.skip("no MPI on this machine")
    coupled(solver=CASE_SOLVER).to_namelist(tmp_path / "case.nml")
    text = "&sweep case = 'case.nml' / &grid e = 0.8, 0.9 T_s = 0.5, 1.0, 1.5 /\n"
    (tmp_path / "sweep.nml").write_text(text, encoding="ascii")
    ranks = ["mpiexec", "--allow-run-as-root", "--oversubscribe", "-n", "2"]
    command = [sys.executable, "-m", "mpi4py.futures", "-m", "rwmf", "sweep", "sweep.nml"]
    words = [*ranks, *command, "--engine", "mpi", "--out", "mpi.nc"]
    done = run_words(words, tmp_path, PYTHONPATH=os.pathsep.join(sys.path))
    assert done.returncode == 0, done.stderr
    assert run_words([*command[:2], *command[4:]], tmp_path).returncode == 0
    assert (tmp_path / "mpi.nc").read_bytes() == (tmp_path / "sweep.nc").read_bytes()


@pytest.mark.parametrize("parts", [1, 2, 5])
def test_parts_of_the_batch_program(batch: Runner, tmp_path: Path, parts: int) -> None:
    case = coupled(
        solver=CASE_SOLVER,
        spectrum={"T_s_min": 0.5, "T_s_max": 1.5, "n": 5, "gamma": [5.0, 50.0], "b": [0.5, 1.0]},
    )
    case.to_namelist(tmp_path / "case.nml")
    assert batch("case.nml").returncode == 0
    names = []
    for k in range(parts, 0, -1):
        assert batch("case.nml", "--part", f"{k}/{parts}").returncode == 0
        names.append(str(tmp_path / f"case.part-{k}-of-{parts}.spectrum.csv"))
    whole = tmp_path / "case.spectrum.csv"
    if parts > 1:
        assert cli.main(["sweep", "--out", str(tmp_path / "merged.csv"), "--merge", *names]) == 0
        assert (tmp_path / "merged.csv").read_bytes() == whole.read_bytes()
        assert cli.main(["sweep", "--out", str(tmp_path / "again.csv"), "--merge", *names[1:]]) == 2


@pytest.mark.parametrize("word", ["0/2", "3/2", "1", "a/b", "1/2/3", ""])
def test_parts_that_are_refused(batch: Runner, tmp_path: Path, word: str) -> None:
    coupled(spectrum={"T_s": [1.0]}).to_namelist(tmp_path / "case.nml")
    found = batch("case.nml", "--part", word)
    assert found.returncode == 2
    assert "must be K/N" in found.stderr
    assert len(list(tmp_path.iterdir())) == 1
