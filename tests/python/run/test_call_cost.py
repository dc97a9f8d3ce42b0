"""Labels are those of xarray itself; threads, processes and forks may call at will."""

import multiprocessing
import pickle
import threading
import time
import warnings
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import run_python
from rwmf.run import response as _labels
from scenes import bare_frame, coupled

_MOTION = rwmf.Motion(np.sin(np.arange(300) * 0.1), dt=0.02, unit="m/s2")


def _case() -> rwmf.Case:
    return coupled().replace(motion=_MOTION, solver={"t_end": 3.0})


def _bits(_: int = 0) -> list[bytes]:
    case = _case().replace(frame={"T_s": 0.8})
    run = rwmf.simulate(case, 0.05)
    sweep = rwmf.spectrum(case, T_s=[0.5, 1.0], threads=2)
    return [run.u_s.values.tobytes(), sweep.u_s_max.values.tobytes()]


class _Earlier(xr.Dataset):
    """Of a version of xarray without the constructor from known parts."""

    __slots__ = ()
    _construct_direct = None


def test_datasets_are_those_of_xarray() -> None:
    """Also of a version of xarray without the quick way."""
    case = _case()
    made = [rwmf.simulate(case, 0.05), rwmf.simulate(case), rwmf.simulate(bare_frame(), 0.05)]
    made += [
        rwmf.spectrum(case, T_s=[0.5, 1.0], gamma=[3.0, 5.0]),
        rwmf.spectrum(bare_frame(), 1.0),
    ]
    for found in made:
        names = {**found.data_vars}
        variables = {name: (data.dims, data.values, data.attrs) for name, data in names.items()}
        coords = {name: (data.dims, data.values, data.attrs) for name, data in found.coords.items()}
        expected = xr.Dataset(variables, coords, found.attrs)
        assert found.identical(expected)
        assert set(found.indexes) == set(expected.indexes)
        assert found.sizes == expected.sizes
        assert all(found[name].dtype == expected[name].dtype for name in expected.variables)
        assert _labels.dataset(variables, coords, found.attrs, _Earlier).identical(expected)
    sweep = made[3]
    assert float(sweep.u_s_max.sel(T_s=0.5, gamma=3.0).squeeze()) > 0
    assert sweep.interp(T_s=0.7).u_s_max.shape == (1, 2)


def test_eight_threads() -> None:
    expected = _bits()
    with ThreadPoolExecutor(8) as executor:
        assert all(found == expected for found in executor.map(_bits, range(24)))


def test_threads_share_changes() -> None:
    """The case caches the keys of the last look-up, for all callers."""
    case = _case()

    def work(i: int) -> tuple[float, float]:
        one = case.replace(frame={"T_s": 0.5 + 0.01 * i})
        other = case.replace(wall={"b": 0.3 + 0.01 * i}, frame={"gamma": 3.0})
        return one.frame.T_s, other.wall.b

    with ThreadPoolExecutor(8) as executor:
        found = list(executor.map(work, range(400)))
    assert found == [(0.5 + 0.01 * i, 0.3 + 0.01 * i) for i in range(400)]


@pytest.mark.parametrize("way", ["spawn", "forkserver"])
def test_processes(way: str) -> None:
    expected = _bits()
    with ProcessPoolExecutor(2, multiprocessing.get_context(way)) as executor:
        assert all(found == expected for found in executor.map(_bits, range(4)))


@pytest.mark.parametrize("threads", [1, 2, 0])
def test_a_forked_child_computes(threads: int, tmp_path: Path) -> None:
    """Its parent has used threads of the kernel, which stay behind."""
    script = (
        "import os, sys, rwmf, numpy as np, threading\n"
        "from scenes import coupled\n"
        "case = coupled()\n"
        "grid = np.linspace(0.3, 2.0, 64)\n"
        "expected = rwmf.spectrum(case, T_s=grid, threads=2).u_s_max.values.tobytes()\n"
        "rwmf.simulate(case)\n"
        "child = os.fork()\n"
        "if child == 0:\n"
        f"    one = rwmf.spectrum(case, T_s=grid, threads={threads})\n"
        "    rwmf.simulate(case.replace(frame={'T_s': 0.7}))\n"
        "    os._exit(0 if one.u_s_max.values.tobytes() == expected else 1)\n"
        "_, status = os.waitpid(child, 0)\n"
        "again = rwmf.spectrum(case, T_s=grid, threads=2).u_s_max.values.tobytes()\n"
        "sys.exit(os.waitstatus_to_exitcode(status) or (again != expected))\n"
    )
    done = run_python(script, tmp_path)
    assert done.returncode == 0, done.stderr


def test_idle_threads_end() -> None:
    """A process that has computed has no thread more, a while later."""
    rwmf.simulate(_case())
    deadline = time.monotonic() + 10.0
    while any(one.name == "rwmf-kernel" for one in threading.enumerate()):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", rwmf.RwmfWarning)
        rwmf.simulate(_case())


@pytest.mark.parametrize("asked", [None, ("u_s_max", "impacts"), ("U_S_MAX",)])
def test_changed_cases_share_samples(asked: tuple[str, ...] | None) -> None:
    """A changed case shares data of its origin and gives the bits of a case that was read."""
    vertical = rwmf.Motion(_MOTION.values[::-1], dt=0.02, unit="m/s2", name="up")
    for changes in ({"frame": {"xi_s": 0.03}}, {"motion": {"scale": 4.0}}, {"model": {"g": 9.7}}):
        for case in (_case(), _case().replace(vertical=vertical)):
            changed = case.replace(**changes)
            fresh = pickle.loads(pickle.dumps(changed))
            found, expected = (
                rwmf.spectrum(one, T_s=[0.5, 1.0], gamma=[3.0, 5.0], quantities=asked)
                for one in (changed, fresh)
            )
            assert float(found.u_s_max.max()) > 0
            for name in found.data_vars:
                assert found[name].values.tobytes() == expected[name].values.tobytes()


def test_many_ordinates_of_several_quantities() -> None:
    """No text is composed for more periods than a text may have."""
    case = bare_frame()
    names = ("u_s_max", "energy_input_end")
    periods = np.linspace(0.2, 3.0, 10_500)
    found = rwmf.spectrum(case, T_s=periods, quantities=names)
    few = rwmf.spectrum(case, T_s=periods[::2100], quantities=names)
    for name in few.data_vars:
        assert found[name].values[::2100].tobytes() == few[name].values.tobytes()
    with pytest.raises(rwmf.InputError, match="u_max is unknown"):
        rwmf.spectrum(case, T_s=periods, quantities=["u_max"])
    with pytest.raises(rwmf.InputError, match="u_max"):
        rwmf.spectrum(case, T_s=periods, quantities=["u_s_max_m\tu_max"])
    with pytest.raises(rwmf.InputError, match="T_s"):
        rwmf.spectrum(case, T_s=[-1.0], quantities=names)
