"""Sweeps: equality with single runs, labels, axes, refusals."""

import math
import threading
import zlib
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from refused import refusals
from rwmf.errors import InputError
from rwmf.motion.record_sets import find_records
from scenes import bare_frame, block, coupled, record

# a method and a tolerance that make small tests quick
QUICK = {"method": "dop853", "rtol": 1e-6, "t_end": 4.0}
PERIODS = [0.5, 1.0, 2.0]


def test_values_are_those_of_single_runs() -> None:
    case = coupled(solver=QUICK)
    grid = {"e": [0.8, 0.9], "formulation": ["exact", "published"], "gamma": [5.0, 100.0]}
    found = rwmf.sweep(case, grid | {"T_s": PERIODS})
    assert found["u_s_max"].dims == ("e", "formulation", "b", "gamma", "T_s")
    for place in ({"e": 0.8, "formulation": "published"}, {"e": 0.9, "formulation": "exact"}):
        groups = {"impact": {"e": place["e"]}, "model": {"formulation": place["formulation"]}}
        single = rwmf.spectrum(case.replace(**groups), T_s=PERIODS, gamma=[5.0, 100.0])
        np.testing.assert_array_equal(found["u_s_max"].sel(place), single["u_s_max"])


def test_dataset_for_an_xarray_user() -> None:
    found = rwmf.sweep(coupled(solver=QUICK), {"T_s": PERIODS, "eta": [(1, 5), (0, 0)]})
    assert found["u_s_max"].attrs["units"] == "m"
    assert found["T_s"].attrs["units"] == "s"
    assert found["eta_alpha"].dims == ("eta",)
    assert float(found["u_s_max"].sel(T_s=1.02, method="nearest")["T_s"]) == 1.0
    assert found["status"].attrs["flag_meanings"] == "ok overturned"
    assert "&wall" in found.attrs["case"]
    assert found.attrs["version"] == rwmf.__version__
    found["u_s_max"].isel(eta=0).squeeze().plot()


def test_scale_acts_on_every_motion(elcentro: Path) -> None:
    pulse = bare_frame(solver=QUICK)
    recorded = bare_frame(motion=record(elcentro, scale=0.5), solver=QUICK)
    for case in (pulse, recorded):
        found = rwmf.sweep(case, {"scale": [1.0, 2.0]})["u_s_max"].values.ravel()
        # the bare frame is linear
        assert found[1] == pytest.approx(2 * found[0], rel=1e-5)


def test_records_run_to_their_end(elcentro: Path, tmp_path: Path) -> None:
    column = tmp_path / "short.txt"
    column.write_text("0\n1\n-1\n0\n", encoding="ascii")
    # neither key nor header gives a unit
    nameless = tmp_path / "nameless.csv"
    nameless.write_text("0,1\n1,-1\n", encoding="ascii")
    suite = find_records([nameless]) + find_records([column], unit="m/s2", dt=0.5)
    with pytest.raises(InputError, match="nameless"):
        rwmf.sweep(bare_frame(solver=QUICK), {}, suite)
    suite = find_records([elcentro], unit="g") + find_records([column], unit="m/s2", dt=0.5)
    found = rwmf.sweep(bare_frame(solver=QUICK), {"T_s": PERIODS}, suite)
    assert found["record"].values.tolist() == ["elcentro", "short"]
    alone = bare_frame(motion=record(elcentro), solver=QUICK | {"t_end": None})
    np.testing.assert_array_equal(
        found["u_s_max"].sel(record="elcentro"), rwmf.spectrum(alone, T_s=PERIODS)["u_s_max"]
    )
    checksums = [f"{zlib.crc32(path.read_bytes()):08x}" for path in (elcentro, column)]
    assert found["record_crc32"].values.tolist() == checksums


def test_folder_of_at2_files(tmp_path: Path) -> None:
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        text = "title\nsecond\nthird\nNPTS=   3, DT=   .5000 SEC,\n  .0  .1E+00  -.1E+00\n"
        (tmp_path / folder / "a.AT2").write_text(text, encoding="ascii")
    suite = find_records([tmp_path])
    assert [item.name for item in suite] == ["one/a", "two/a"]
    found = rwmf.sweep(bare_frame(), {"t_end": [3.0]}, suite)["u_s_max"].values.ravel()
    assert found[0] == found[1] > 0


def test_other_quantities(elcentro: Path) -> None:
    """More than displacements, also of a wall without a frame."""
    names = ("theta_max_over_alpha", "impacts", "u_s_max")
    motion = record(elcentro, scale=2.0)
    case = block(motion=motion, solver=QUICK)
    found = rwmf.sweep(case, {"b": [0.4, 0.6]}, quantities=names)
    for b in (0.4, 0.6):
        single = rwmf.simulate(case.replace(wall={"b": b}))
        at = found.sel(b=b)
        assert float(at["theta_max_over_alpha"]) == float(single["theta_max_over_alpha"])
        assert float(at["impacts"]) == float(single["impacts"])
    # there is no frame whose displacement could be reported
    assert np.isnan(found["u_s_max"]).all()
    assert "quantities: u_s_max applies to no scene of the sweep" in found.attrs["warnings"]
    assert "impacts" not in found.attrs["warnings"]


def test_failures_and_overturning_carry_a_status() -> None:
    case = coupled(solver=QUICK)
    found = rwmf.sweep(case, {"max_steps": [20.0], "T_s": PERIODS})
    assert found["status"].attrs["flag_meanings"].split()[int(found["status"][0, 0, 0, 0])] == (
        "too_many_steps"
    )
    assert np.isnan(found["u_s_max"]).all()
    found = rwmf.sweep(
        block(initial={"theta_over_alpha": 0.5}),
        {"theta_over_alpha": [0.5, 1.2]},
        quantities=["theta_max_over_alpha"],
    )
    assert found["status"].values.ravel().tolist() == [0, 1]


@pytest.mark.parametrize("chunk", [1, 2, 100])
@pytest.mark.parametrize("threads", [1, 3])
def test_chunks_and_threads_do_not_matter(chunk: int, threads: int) -> None:
    case = coupled(solver=QUICK | {"t_end": 2.0})
    grid = {"e": [0.8, 0.9], "T_s": [0.5, 0.7, 1.0]}
    found = rwmf.sweep(case, grid, chunk=chunk, threads=threads)
    xr.testing.assert_equal(found, rwmf.sweep(case, grid))


test_grids_that_are_refused = refusals(
    lambda grid: rwmf.sweep(coupled(), grid),
    ({"dance": [1]}, "dance: no key"),
    ({"dt": [0.1]}, "several groups"),
    ({"e": []}, "list of values"),
    ({"e": [0.9, 0.9]}, "twice"),
    ({"e": [0.9, 1.1]}, "e = 1.1"),
    ({"e": [math.nan]}, "finite"),
    ({"eta": [1, 5]}, "2 numbers"),
    ({"T_s": [1.0, -1.0]}, "T_s"),
    ({"formulation": ["other"]}, "formulation"),
    ({"t_s": [1.0], "frame.T_s": [2.0]}, "t_s and frame.T_s: both set frame.T_s"),
    ({"eta": [(1, 5)], "eta_0": [3.0]}, "eta and eta_0: both set cable.eta_0"),
    ({"spectrum.n": [3]}, "spectrum.n: no axis"),
    ({5: [3.0]}, "a text"),
    ({"T_s": "exact"}, "T_s = 'exact': must be a finite number"),
    ({"b": [0.5, "wide"]}, "b = 'wide': must be a finite number"),
    ({"T_s": [[1, 2], [3]]}, "T_s.*a list of values"),
    ({"gamma": [5.0, 5.0]}, "gamma.*twice"),
    ({"n_pulses": "abc"}, "n_pulses = 'abc'"),
)


def test_other_input_errors(tmp_path: Path) -> None:
    for words in (["nothing.AT2"], ["*.AT2"], ["fema:moon"]):
        with pytest.raises(InputError, match="records"):
            rwmf.sweep(coupled(), {}, [tmp_path / words[0] if ":" not in words[0] else words[0]])
    with pytest.raises(InputError, match="quantities: love"):
        rwmf.sweep(coupled(), quantities=["love"])
    with pytest.raises(InputError, match="no such effect"):
        rwmf.sweep(block(), {"gamma": [5.0]}, quantities=["impacts"])
    with pytest.raises(InputError, match="1 <= K <= N"):
        rwmf.sweep(coupled(), part=(3, 2))
    with pytest.raises(InputError, match="needs a file"):
        rwmf.sweep(coupled(), part=(1, 2))


def test_an_error_in_the_progress_function_stops_all_kernels() -> None:
    case = coupled(motion={"kind": "sine", "cycles": 1e6}, solver={"t_end": 1e6})
    reports: list[tuple[int, int]] = []

    def fail(done: int, total: int) -> None:
        reports.append((done, total))
        if len(reports) > 2:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        rwmf.sweep(case, {"e": np.linspace(0.8, 0.9, 16)}, threads=2, progress=fail)
    # a thread that waits for a call ends after a second without one; a kernel at work would go on
    for thread in threading.enumerate():
        if thread.name.startswith("rwmf"):
            thread.join(timeout=30)
            assert not thread.is_alive()


def test_letters_and_groups_of_an_axis_do_not_matter() -> None:
    """The key defines an axis, whatever its spelling; without it nothing is computed."""
    case = coupled(solver=QUICK | {"t_end": 2.0})
    spellings = {
        "T_s": ("t_s", "frame.T_s", "FRAME.t_S", "spectrum.T_s"),
        "gamma": ("Gamma", "frame.GAMMA", "spectrum.gamma"),
        "b": ("B", "wall.b"),
        "scale": ("Scale",),
        "e": ("E", "Impact.E"),
        "a_max_g": ("A_MAX_G", "motion.a_max_g"),
    }
    for name, others in spellings.items():
        expected = rwmf.sweep(case, {name: [0.4, 0.8]})
        assert expected["u_s_max"].sizes[name] == 2
        assert len(np.unique(expected["u_s_max"])) == 2
        for other in others:
            xr.testing.assert_identical(rwmf.sweep(case, {other: [0.4, 0.8]}), expected)
    pairs = [(1, 5), (0, 0)]
    xr.testing.assert_identical(rwmf.sweep(case, {"ETA": pairs}), rwmf.sweep(case, {"eta": pairs}))


def test_scale_acts_on_the_amplitude_of_another_axis() -> None:
    """Both orders of the grid give the same result."""
    case = bare_frame(solver=QUICK)
    amplitude, scale = {"a_max_g": [0.2, 0.4]}, {"scale": [1.0, 2.0]}
    for grid in (amplitude | scale, scale | amplitude):
        found = rwmf.sweep(case, grid)["u_s_max"].squeeze()
        twice = found.sel(scale=2.0) / found.sel(scale=1.0)
        np.testing.assert_allclose(twice, 2.0, rtol=1e-5)
