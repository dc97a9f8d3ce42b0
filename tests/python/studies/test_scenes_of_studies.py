"""Studies of storeys and of blocks: each computes runs, or is refused with a reason."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf import studies
from rwmf.errors import InputError
from rwmf.motion.record_sets import RecordFile, find_records
from scenes import bare_frame, block, coupled

SOLVER = {"method": "dop853", "rtol": 1e-8, "t_end": 4.0}
PULSE = {"kind": "one_sine", "a_max_g": 0.35, "omega_p": 6.0}
STOREYS = {
    "m_over_m_w": [2.0, 1.5, 1.0],
    "k_over_m_w": [900.0, 700.0, 400.0],
    "height": [1.5, 1.3, 1.2],
}
COUPLINGS = ("reduced", "every_floor", "full")
ROTATION = "theta_max_over_alpha"


def _storeys(coupling: str) -> rwmf.Case:
    frame = {"T_s": None, "gamma": None}
    lists = STOREYS | {"coupling": coupling}
    return coupled(storeys=lists, frame=frame, motion=PULSE, solver=SOLVER)


def _block() -> rwmf.Case:
    held = {"cable": {"eta_0": 0.1, "eta_alpha": 0.5}}
    return block(motion=PULSE, solver=SOLVER).replace(**held)


@pytest.fixture
def suite(tmp_path: Path) -> tuple[RecordFile, ...]:
    """Write two records of one column, strong enough to rock a block."""
    t = 0.02 * np.arange(150)
    for i, omega in enumerate((4.0, 6.0)):
        samples = 0.5 * np.sin(omega * t) * np.minimum(1.0, (3.0 - t))
        text = "".join(f"{value!r}\n" for value in samples.tolist())
        (tmp_path / f"sine{i}.txt").write_text(text, encoding="ascii")
    return find_records([tmp_path / "sine*.txt"], unit="g", dt=0.02)


def _under(case: rwmf.Case, record: RecordFile, factor: float = 1.0) -> rwmf.Case:
    motion = dict.fromkeys(case.motion) | record.motion() | {"scale": factor}
    return case.replace(motion=motion, solver={"t_end": None})


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_storeys_in_all_studies(coupling: str, suite: tuple[RecordFile, ...]) -> None:
    """At the period and the mass ratio of the storeys each study computes the run."""
    case = _storeys(coupling)
    axes = case.kernel.axes()
    grid = {"T_s": [axes["T_s"].value, 0.9]}
    runs = [rwmf.simulate(_under(case, record)) for record in suite]
    peaks = [float(run["u_s_max"]) for run in runs]
    effect = studies.wall_effect(case, grid, suite)
    np.testing.assert_array_equal(effect["u_s_max"].isel(T_s=0).squeeze(), peaks)
    alone = [
        float(rwmf.simulate(_under(case.without_wall(), record))["u_s_max"]) for record in suite
    ]
    np.testing.assert_allclose(effect["u_s_max_alone"].isel(T_s=0), alone, rtol=1e-9)
    found = studies.equal_response(case, [0.8], 0.02)
    motion = {"a_max_g": float(found["a_max_g"][0]), "omega_p": None, "T_p": 0.8}
    t_end = 0.8 + 10 * axes["T_s"].value
    run = rwmf.simulate(case.replace(motion=motion, solver={"t_end": t_end}))
    assert float(run["u_s_max"]) == pytest.approx(0.02, rel=1e-5)


@pytest.mark.parametrize("coupling", COUPLINGS)
def test_wall_effect_compares_the_same_frame(coupling: str) -> None:
    """At every period: floors that the wall keeps on a line have a longer one without it."""
    case = _storeys(coupling)
    own = case.kernel.axes()["T_s"].value
    found = studies.wall_effect(case, {"T_s": [own, 0.9]})
    softer = [k * (own / 0.9) ** 2 for k in STOREYS["k_over_m_w"]]
    same = case.replace(storeys={"k_over_m_w": softer})
    assert same.kernel.axes()["T_s"].value == pytest.approx(0.9)
    alone = rwmf.simulate(same.without_wall())["u_s_max"]
    at = found.sel(T_s=0.9).squeeze()
    assert float(at["u_s_max_alone"]) == pytest.approx(float(alone), rel=1e-6)
    both = rwmf.simulate(same)["u_s_max"]
    assert float(at["ratio"]) == pytest.approx(float(both / alone), rel=1e-6)


def test_storeys_that_yield_one_by_one_stay_so_without_the_wall() -> None:
    yielding = {"storey_u_y": [0.004], "law": "elastic_plastic"}
    case = _storeys("every_floor").replace(yielding=yielding)
    alone = case.without_wall()
    assert alone.storeys.coupling == "full"
    assert np.isfinite(studies.wall_effect(case, {"T_s": [0.5]})["ratio"]).all()


def test_intensity_of_storeys_is_of_a_linear_oscillator(suite: tuple[RecordFile, ...]) -> None:
    """That of the first period, however the storeys yield."""
    yielding = {"storey_u_y": [0.004], "law": "elastic_plastic"}
    case = _storeys("full").replace(yielding=yielding)
    found = rwmf.sweep(case, {"scale": [0.3]}, suite, intensity="pseudo_acceleration")
    T_s = case.kernel.axes()["T_s"].value
    oscillator = bare_frame(frame={"T_s": T_s}, solver=SOLVER)
    for i, record in enumerate(suite):
        peak = float(rwmf.simulate(_under(oscillator, record))["u_s_max"])
        factor = 0.3 * 9.81 / ((2 * math.pi / T_s) ** 2 * peak)
        run = rwmf.simulate(_under(case, record, factor))
        assert float(found["u_s_max"][i].squeeze()) == pytest.approx(
            float(run["u_s_max"]), rel=1e-5
        )
    assert "oscillator" in found["scale"].attrs["long_name"]


def test_equal_response_of_a_block() -> None:
    case = _block()
    own = case.kernel.axes()["T_s"].value
    found = studies.equal_response(case, [1.0], 0.3)
    motion = {"a_max_g": float(found["a_max_g"][0]), "omega_p": None, "T_p": 1.0}
    run = rwmf.simulate(case.replace(motion=motion, solver={"t_end": 1.0 + 10 * own}))
    assert float(run[ROTATION]) == pytest.approx(0.3, rel=1e-4)
    assert found.attrs["quantity"] == ROTATION


def test_intensity_of_a_block_is_the_peak_of_the_ground(suite: tuple[RecordFile, ...]) -> None:
    case = _block()
    levels = [0.3, 0.5]
    found = rwmf.sweep(
        case, {"scale": levels}, suite, quantities=(ROTATION,), intensity="peak_acceleration"
    )
    assert found["scale"].attrs["long_name"] == "peak ground acceleration over g"
    for i, record in enumerate(suite):
        peak = max(abs(float(line)) for line in Path(record.path).read_text("ascii").split())
        for k, level in enumerate(levels):
            run = rwmf.simulate(_under(case, record, level / peak))
            assert float(found[ROTATION][i, k].squeeze()) == pytest.approx(
                float(run[ROTATION]), rel=1e-6
            )


def test_what_makes_no_sense_says_why(suite: tuple[RecordFile, ...]) -> None:
    case = _block()
    with pytest.raises(InputError, match=r"wall effect: .* no &frame .* rwmf sweep"):
        studies.wall_effect(case, {"T_s": [2.0]})
    with pytest.raises(InputError, match=r"equal response: u_s_max: .*take its rotation"):
        studies.equal_response(case, [1.0], 0.1, quantities="u_s_max")
    with pytest.raises(InputError, match=r"the case needs &frame T_s, or .*; or take 'peak_acc"):
        rwmf.sweep(case, {"scale": [1.0]}, suite, intensity="pseudo_acceleration")
