"""From records to risk: analyses, fragility curves, annual frequencies, files of loss programs."""

import csv
import itertools
import json
import math
import re
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import rwmf
import xarray as xr
from refused import refusals, refused_files
from rwmf import cli, studies
from rwmf.errors import InputError
from scenes import coupled

BAKER: dict[str, Any] = {
    "levels": [0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0],
    "exceeded": [0, 0, 0, 4, 6, 13, 12, 16],
    "runs": 40,
}
LEVELS = [0.1, 0.2, 0.4]
OSCILLATOR: dict[str, Any] = {"period": 1.2, "damping": 0.05}


def frame(strength: float = 0.06) -> rwmf.Case:
    """Make a yielding frame that its weight brings down."""
    groups: dict[str, dict[str, object]] = {
        "frame": {"T_s": 1.2, "xi_s": 0.05},
        "yielding": {"f_y_over_m_s_g": strength, "hardening": 0.02},
        "p_delta": {"m_g_over_m_s": 2.0, "h_f": 8.0, "drift_limit": 0.1},
        "motion": {"kind": "none"},
        "model": {"formulation": "exact"},
        "solver": {"method": "dop853", "rtol": 1e-6, "t_end": 1.0},
    }
    return rwmf.Case(**groups)


def suite(n: int = 4) -> list[rwmf.Motion]:
    """Make filtered noise that grows and fades."""
    chance = np.random.default_rng(5)
    t = 0.02 * np.arange(500)
    envelope = (t / 3) ** 2 * np.exp(2 * (1 - t / 3))
    shape = np.hanning(15)
    return [
        rwmf.Motion(envelope * np.convolve(chance.standard_normal(t.size), shape, "same"),
                    dt=0.02, unit="m/s2", name=f"r{i}")
        for i in range(n)
    ]  # fmt: skip


@pytest.fixture(scope="module")
def table() -> xr.Dataset:
    """Run an analysis of two designs."""
    stronger = frame(0.09)
    designs = {"frame": frame(), "stronger": stronger}
    names = ["u_s_max", "roof_drift_max"]
    return rwmf.ida(designs, suite(), LEVELS, names, limits={"u_s_max": 0.4}, **OSCILLATOR)


def test_every_record_is_bracketed(table: xr.Dataset) -> None:
    """All levels run; each capacity lies between two runs 2 % apart."""
    rows = table.to_dataframe()
    for (_, _), own in rows.groupby(["design", "record"]):
        assert set(LEVELS) <= set(own["intensity"])
        assert own["intensity"].is_monotonic_increasing
        over = (own["status"] == "collapsed") | (own["u_s_max"] > 0.4)
        first = own["intensity"][over].min()
        last = own["intensity"][own["intensity"] < first].max()
        assert first <= last * 1.02 * (1 + 1e-12)
    # one factor for each record, whatever the design
    factors = (rows["scale"] / rows["intensity"]).groupby(rows["record"])
    assert (factors.max() / factors.min() < 1 + 1e-12).all()


def test_runs_are_those_of_a_sweep(table: xr.Dataset) -> None:
    """To the bit."""
    found = rwmf.sweep(frame(), {"scale": LEVELS}, suite(), intensity="pseudo_acceleration",
                       **OSCILLATOR)  # fmt: skip
    rows = table.to_dataframe().query("design == 'frame'")
    for i, record in enumerate(["r0", "r1", "r2", "r3"]):
        for j, level in enumerate(LEVELS):
            own = rows[(rows["record"] == record) & (rows["intensity"] == level)]
            assert own["u_s_max"].item() == found["u_s_max"].squeeze().values[i, j]


@pytest.mark.parametrize("kind", ["peak_velocity", "arias", "peak_acceleration"])
def test_measures_that_are_not_linear(kind: str) -> None:
    """The scaled record has the intensity of its row, in stripes and clouds."""
    motions = suite(2)
    rows = [
        *rwmf.stripes(frame(), motions, [0.3], intensity=kind).to_dataframe().itertuples(),
        *rwmf.cloud(frame(), motions, factors=[0.5], intensity=kind).to_dataframe().itertuples(),
    ]
    for row in rows:
        motion = motions[int(row.record[1:])]
        scaled = rwmf.Motion(motion.values * row.scale, dt=0.02, unit="m/s2", name="x")
        unit = 9.81 if kind == "peak_acceleration" else 1.0
        assert rwmf.records.intensity(scaled, kind) / unit == pytest.approx(row.intensity, rel=1e-9)


@pytest.mark.parametrize(("name", "stop"), [("t.csv", 1), ("t.nc", 5)])
def test_interrupted_and_resumed(name: str, stop: int, tmp_path: Path) -> None:
    """Files are equal to the byte; all other files are removed."""
    count = 0

    def interrupt(_: int, __: int) -> None:
        nonlocal count
        count += 1
        if count == stop:
            raise KeyboardInterrupt

    def analyse(folder: str, **how: Any) -> bytes:  # noqa: ANN401 (any option)
        path = tmp_path / folder / name
        path.parent.mkdir(exist_ok=True)
        rwmf.ida(frame(), suite(2), [0.2], tolerance=0.3, file=path, chunk=1, **how)
        assert list(path.parent.iterdir()) == [path]
        return path.read_bytes()

    whole = analyse("whole")
    with pytest.raises(rwmf.Interrupted, match="continues"):
        analyse("part", progress=interrupt, threads=1)
    assert analyse("part") == whole
    assert analyse("part", restart=True) == whole
    with pytest.raises(InputError, match=r"holds another analysis, which differs in .*levels"):
        rwmf.ida(frame(), suite(2), [0.3], tolerance=0.3, file=tmp_path / "part" / name)


def test_tables_survive_their_files(table: xr.Dataset, tmp_path: Path) -> None:
    from rwmf.assess.table import read_table, write_table

    for name in ("t.csv", "t.nc"):
        write_table(table, tmp_path / name)
        found = read_table(tmp_path / name)
        assert found.to_dataframe().equals(table.to_dataframe())
        assert {"cases", "records", "version", "levels"} <= set(found.attrs)
        assert "crc32" in json.loads(found.attrs["records"])["r0"]
        curve = rwmf.fragility(tmp_path / name)
        xr.testing.assert_equal(curve, rwmf.fragility(table))


def test_percentiles_are_infinite_where_records_collapse(table: xr.Dataset) -> None:
    found = studies.demand_percentiles(table, "u_s_max", q=[0, 50, 100]).isel(design=0)
    rows = table.to_dataframe().query("design == 'frame'")
    first = rows.query("status == 'collapsed'").groupby("record")["intensity"].min().sort_values()
    most = found["u_s_max"].sel(percentile=100).values
    assert np.isposinf(most[found["intensity"].values >= first.iloc[0]]).all()
    stands = rows.groupby("intensity").filter(lambda x: len(x) == 4 and (x.status == "ok").all())
    expected = stands.groupby("intensity")["u_s_max"].min()
    lowest = found["u_s_max"].sel(percentile=0, intensity=expected.index.values)
    np.testing.assert_array_equal(lowest, expected)


def test_demands_count_by_magnitude() -> None:
    """A residual drift to either side exceeds a limit, in curves and percentiles."""
    columns: dict[str, Any] = {
        "record": ["a", "a", "b", "b", "c", "c"],
        "intensity": [0.2, 0.4] * 3,
        "roof_residual_drift": [1e-3, 4e-3, -1e-3, -6e-3, 2e-3, -3e-3],
    }
    positive = columns | {"roof_residual_drift": np.abs(columns["roof_residual_drift"])}
    curves = [rwmf.fragility(item, 2.5e-3, resamples=0, method="capacities")
              for item in (columns, positive)]  # fmt: skip
    assert curves[0].identical(curves[1])
    found = [studies.demand_percentiles(item) for item in (columns, positive)]
    assert found[0].identical(found[1])


def test_smallest_values_are_no_demands() -> None:
    columns: dict[str, Any] = {
        "record": ["a", "a", "b", "b"],
        "intensity": [0.2, 0.4] * 2,
        "u_s_max": [0.1, 0.2, 0.1, 0.3],
        "pivot_normal_min": [0.8, 0.4, 0.7, 0.1],
    }
    assert "pivot_normal_min" not in studies.demand_percentiles(columns)
    table = rwmf.stripes(frame(), suite(1), LEVELS[:2], ["pivot_normal_min", "u_s_max"])
    assert list(table.data_vars).index("pivot_normal_min") < list(table.data_vars).index("u_s_max")
    drawn = [rwmf.plot.ida(table, quantity=name).get_xlabel() for name in (None, "u_s_max")]
    assert drawn[0] == drawn[1]
    for call in (
        lambda: rwmf.fragility(columns, 0.2, "pivot_normal_min"),
        lambda: studies.demand_percentiles(columns, "pivot_normal_min"),
        lambda: rwmf.ida(frame(), suite(1), LEVELS, limits={"pivot_normal_min": 0.0}),
    ):
        with pytest.raises(rwmf.InputError, match=r"pivot_normal_min\S*: is a smallest value"):
            call()


def test_records_replace_a_motion_in_memory() -> None:
    """A case whose motion is in memory needs no file for it."""
    first, second = suite(2)
    own = frame().replace(motion=first)
    found, other = (rwmf.stripes(case, [second], [0.1], "u_s_max") for case in (own, frame()))
    assert float(found["u_s_max"].squeeze()) == float(other["u_s_max"].squeeze())


def test_example_of_baker() -> None:
    found = rwmf.fragility(**BAKER)
    assert float(found["median"]) == pytest.approx(1.076116, abs=5e-7)
    assert float(found["dispersion"]) == pytest.approx(0.429237, abs=5e-7)
    low, high = found["median_band"].values
    assert low < 1.076 < high
    # order and repeated levels do not matter
    flipped = {k: v if k == "runs" else v[::-1] for k, v in BAKER.items()}
    assert float(rwmf.fragility(**flipped)["median"]) == float(found["median"])


def test_clouds_with_and_without_collapses() -> None:
    """Least squares in logarithms; censored runs move the median down."""
    chance = np.random.default_rng(2)
    x = np.exp(chance.uniform(-2, 1, 400))
    y = 0.02 * x**1.3 * np.exp(0.3 * chance.standard_normal(x.size))
    columns = {"intensity": x, "drift": y}
    found = rwmf.fragility(columns, 0.03, method="cloud", resamples=50)
    b, a = np.polyfit(np.log(x), np.log(y), 1)
    rest = np.log(y) - a - b * np.log(x)
    sigma = math.sqrt(np.sum(rest**2) / (x.size - 2))
    assert float(found["median"]) == pytest.approx(math.exp((math.log(0.03) - a) / b), rel=1e-9)
    assert float(found["dispersion"]) == pytest.approx(sigma / b, rel=1e-9)
    # collapse above a drift: the censored fit recovers the law, dropping the runs would not
    down = y > 0.04
    censored = columns | {
        "drift": np.where(down, 0.04, y),
        "status": np.where(down, "collapsed", "ok"),
    }
    again = rwmf.fragility(censored, 0.03, method="cloud", resamples=0)
    assert float(again["median"]) == pytest.approx(float(found["median"]), rel=0.03)


def test_capacities_margins_and_dispersions() -> None:
    """Geometric mean of capacities; total dispersion; P-695's table to its digits."""
    capacity = np.array([0.5, 0.8, 1.1, 1.6])
    rows: dict[str, Any] = {"record": [], "intensity": [], "status": []}
    for i, c in enumerate(capacity):
        for level, word in ((c / 1.001, "ok"), (c * 1.001, "collapsed")):
            rows["record"].append(str(i))
            rows["intensity"].append(level)
            rows["status"].append(word)
    found = rwmf.fragility(rows, method="capacities", dispersions=[0.3, 0.4], mce=0.7,
                           shape_factor=(2.0, 8.0, "Dmax"))  # fmt: skip
    logs = np.log(capacity)
    assert float(found["median"]) == pytest.approx(math.exp(logs.mean()), rel=1e-9)
    assert float(found["dispersion"]) == pytest.approx(logs.std(ddof=1), rel=1e-9)
    total = math.hypot(logs.std(ddof=1), 0.5)
    assert float(found["dispersion_total"]) == pytest.approx(total)
    ratio = math.exp(logs.mean()) / 0.7
    assert float(found["margin_ratio"]) == pytest.approx(ratio)
    chance = 0.5 * math.erfc(math.log(ratio) / total / math.sqrt(2))
    assert float(found["probability_at_mce"]) == pytest.approx(chance)
    assert float(found["shape_factor"]) == pytest.approx(1.61, abs=0.005)


def test_example_of_risk() -> None:
    found = rwmf.risk((0.9, 0.4), {"k0": 2e-4, "k": 2.5})
    exact = 4.291122997679e-4
    assert float(found["closed_form"]) == pytest.approx(exact, rel=1e-12)
    assert float(found["annual_frequency"]) == pytest.approx(exact, rel=1e-10)
    assert float(found["contribution"].sum()) == pytest.approx(1.0)


@pytest.mark.parametrize(("median", "beta", "k"), [(0.3, 0.1, 1.0), (2.0, 0.9, 4.0), (1.0, 0, 3)])
def test_quadrature_of_other_laws(median: float, beta: float, k: float, tmp_path: Path) -> None:
    """Power laws, given as such, as points and as a file."""
    exact = 1e-4 * median**-k * math.exp(0.5 * (k * beta) ** 2)
    x = np.geomspace(1e-3, 1e2, 7)
    path = tmp_path / "hazard.csv"
    lines = [f"{a!r},{1e-4 * a**-k!r}" for a in x.tolist()]
    path.write_text("intensity,frequency\n" + "\n".join(lines) + "\n", encoding="ascii")
    for hazard in ((1e-4, k), {"intensity": x, "frequency": 1e-4 * x**-k}, path):
        found = rwmf.risk({"median": median, "dispersion": beta}, hazard, levels=[0.1, 0.5, 1.0])
        assert float(found["annual_frequency"]) == pytest.approx(exact, rel=1e-10)


def test_broken_hazard_by_quadrature() -> None:
    """A hazard of three power laws, and each bin of its deaggregation."""
    x, rates = np.array([0.05, 0.2, 0.8, 2.0]), np.array([0.1, 8e-3, 3e-4, 1e-6])
    median, beta, levels = 0.7, 0.45, [0.1, 0.3, 0.5, 1.2]
    found = rwmf.risk((median, beta), {"intensity": x, "frequency": rates}, levels=levels)
    u = np.linspace(math.log(median) - 14 * beta, math.log(median) + 14 * beta, 400_001)
    k = -np.diff(np.log(rates)) / np.diff(np.log(x))
    part = np.clip(np.searchsorted(np.log(x), u) - 1, 0, 2)
    hazard = rates[part] * (x[part] / np.exp(u)) ** k[part]
    z = (u - math.log(median)) / beta
    total = np.trapezoid(hazard * np.exp(-0.5 * z**2), z) / math.sqrt(2 * math.pi)
    assert float(found["annual_frequency"]) == pytest.approx(total, rel=1e-8)
    assert float(found["closed_form"]) == pytest.approx(float(found["annual_frequency"]), rel=1e-12)
    steps = k[part] * hazard * [0.5 * math.erfc(-v / math.sqrt(2)) for v in z]
    ends = np.searchsorted(u, [-math.inf, *np.log(levels), math.inf])
    shares = [np.trapezoid(steps[a : b + 1], u[a : b + 1]) for a, b in itertools.pairwise(ends)]
    assert found["contribution"].values == pytest.approx(np.array(shares) / total, abs=1e-4)


def _phi(z: Any) -> Any:  # noqa: ANN401 (a number or an array)
    return np.vectorize(lambda x: 0.5 * math.erfc(-x / math.sqrt(2)))(z)


def test_results_of_one_power_law() -> None:
    """Period, probability and bins in closed form; the edges are round and around the median."""
    median, beta, k = 0.9, 0.4, 2.5
    rate = 2e-4 * median**-k * math.exp(0.5 * (k * beta) ** 2)
    found = rwmf.risk((median, beta), (2e-4, k))
    assert float(found["return_period"]) == pytest.approx(1 / rate)
    assert float(found["probability_50_years"]) == pytest.approx(1 - math.exp(-50 * rate))
    assert float(found["extrapolated"]) == 0
    edges = found["intensity_high"].values[:-1]
    assert found["intensity_low"].values.tolist() == [0.0, *edges]
    ends = median * np.exp([-3 * beta, 2 * beta])
    assert edges.tolist() == [float(f"{x:.2g}") for x in np.geomspace(*ends, 11)]
    z = np.log(edges / median) / beta
    below = _phi(z + k * beta) - _phi(z) * 2e-4 * edges**-k / rate
    assert found["contribution"].values.cumsum()[:-1] == pytest.approx(below, abs=1e-10)


@pytest.mark.parametrize(("beta", "width"), [(0.0, 0.2), (0.05, 0.2), (0.5, 0.5), (20.0, 10.0)])
def test_bins_of_narrow_and_wide_curves(beta: float, width: float) -> None:
    edges = rwmf.risk((0.5, beta), (1e-4, 1e-3))["intensity_high"].values[:-1]
    assert edges[[0, -1]] == pytest.approx(0.5 * np.exp([-3 * width, 2 * width]), rel=0.05)


@pytest.mark.parametrize(
    ("beta", "ends", "warns"),
    [(0.4, (0.25, 1.6), True), (0.4, (0.2, 2.0), False), (0.0, (0.2, 2.0), False),
     (0.0, (1.0, 2.0), True)],
)  # fmt: skip
def test_share_from_outside_the_points(beta: float, ends: tuple[float, float], warns: bool) -> None:
    median, k = 0.9, 2.5
    x = np.geomspace(*ends, 5)
    found = rwmf.risk((median, beta), {"intensity": x, "frequency": 2e-4 * x**-k})
    z = np.log(np.array(ends) / median) / (beta or 1e-9) + k * beta
    share = 1 - float(np.diff(_phi(z))[0])
    assert float(found["extrapolated"]) == pytest.approx(share, rel=1e-9, abs=1e-12)
    text = f"{100 * share:.3g} % of the annual frequency is from outside the hazard's points"
    assert found.attrs["warnings"] == (text if warns else "")


def test_band_of_resamples() -> None:
    """An infinite median has no frequency; a resample without a fit is left out."""
    k, further = 2.5, 0.3
    medians, betas = np.array([0.8, 0.9, 1.1, np.inf, np.nan]), np.array([0.3, 0.5, 0.4, 0.4, 0.4])
    curves = xr.Dataset(
        {
            "median": 0.9,
            "dispersion": 0.4,
            "dispersion_total": math.hypot(0.4, further),
            "median_resampled": ("resample", medians),
            "dispersion_resampled": ("resample", betas),
        },
        attrs={"confidence": 0.9},
    )
    found = rwmf.risk(curves, (2e-4, k))
    rates = 2e-4 * medians**-k * np.exp(0.5 * k**2 * (betas**2 + further**2))
    ends = np.quantile(rates[:-1], [0.05, 0.95])
    assert found["annual_frequency_band"].values == pytest.approx(ends, rel=1e-12)
    assert found["quantile"].values == pytest.approx([0.05, 0.95])
    assert float(found["dispersion"]) == 0.5


test_fragilities_and_hazards_that_are_refused = refusals(
    lambda words: rwmf.risk(*words),
    (((0.0, 0.4), (1e-4, 2.0)), "median = 0.0: must be a finite number > 0"),
    (((0.5, -0.1), (1e-4, 2.0)), "dispersion = -0.1: must be >= 0"),
    ((([0.5, -1.0], [0.4, 0.4]), (1e-4, 2.0)), "fragility of 2: median = -1.0"),
    ((([0.5, 0.6], [0.4]), (1e-4, 2.0)), "differ in their length"),
    (((0.5, 0.4, 0.3), (1e-4, 2.0)), "must be a dataset of rwmf.fragility"),
    ((xr.Dataset({"median": 0.5}), (1e-4, 2.0)), "has no median and dispersion"),
    (((0.5, 0.4), np.ones((2, 3))), "must be the path of a CSV file"),
    (((0.5, 0.4), (1e-4, 2.0, 3.0)), "must be the path of a CSV file"),
    (((0.5, 0.4), {"k0": 1e-4}), "must be the path of a CSV file"),
    (((0.5, 0.4), {"intensity": [0.1, 0.2], "poe_50": [0.1]}), "2 intensities and 1 frequencies"),
    (((0.5, 0.4), np.array([[0.1, 0.1], [0.2, 0.0]])), "row 1: frequency = 0: .* of no frequency"),
    (((0.5, 0.4), 3.0), "must be the path of a CSV file"),
)


def test_a_table_of_hazard_and_its_bins() -> None:
    x = np.geomspace(0.05, 5, 9)
    table = np.column_stack([x, 2e-4 * x**-2.5])
    columns = {"intensity": x, "frequency": table[:, 1]}
    assert rwmf.risk((0.9, 0.4), table).identical(rwmf.risk((0.9, 0.4), columns))
    poe = np.append(1.0, -np.expm1(-50 * table[:, 1]))
    found = rwmf.risk((0.9, 0.4), {"intensity": np.append(0.01, x), "poe_50": poe})
    assert found.attrs["warnings"] == "hazard: 1 point of probability 1 left out"
    with pytest.raises(InputError, match=r"levels = .* must ascend"):
        rwmf.risk((0.9, 0.4), table, levels=[0.5, 0.5])


def test_designs_in_one_table(table: xr.Dataset) -> None:
    curves = rwmf.fragility(table, resamples=100)
    found = rwmf.risk(curves, (1e-4, 2.3))
    assert found["design"].values.tolist() == ["frame", "stronger"]
    weak, strong = found["annual_frequency"].values
    assert weak > strong
    for i, value in enumerate((weak, strong)):
        low, high = found["annual_frequency_band"].values[i]
        assert low < value < high


test_degenerate_data_say_why = refusals(
    lambda arguments: rwmf.fragility(**arguments),
    (BAKER | {"exceeded": [0] * 8}, "no run collapses: the median is above the highest"),
    (BAKER | {"exceeded": [40] * 8}, "every run collapses: the median is below the lowest"),
    (BAKER | {"exceeded": [9, 8, 7, 6, 5, 4, 3, 2]}, "does not grow with the intensity"),
    (BAKER | {"exceeded": [0.5] * 8}, "exceeded = 0.5 of runs = 40 at intensity 0.2"),
    (BAKER | {"runs": 10}, "exceeded = 13 of runs = 10 at intensity 0.8"),
    ({"levels": [0.1], "exceeded": [5], "runs": 10}, "at one intensity, 0.1"),
    (BAKER | {"levels": [math.nan, *BAKER["levels"][1:]]}, "levels = nan"),
    (BAKER | {"shape_factor": 1.2}, "shape_factor: needs mce"),
    (BAKER | {"mce": 1, "shape_factor": (1, 4, "E")}, "must be one of B, C, Dmin, Dmax"),
    (BAKER | {"mce": 1, "shape_factor": (1, 0.5, "B")}, "ductility = 0.5: must be >= 1"),
    ({"table": {"intensity": [0.1], "d": [1.0]}, "limit": 2, "quantities": "e"}, "has d"),
    ({"table": {"d": [1.0]}, "limit": 2}, "no column intensity, only d"),
    (BAKER | {"quantities": "u_s_max"}, "counts take no limit, no quantity"),
    ({"table": {"intensity": [0.1], "d": [1.0]}, "runs": 40}, "with exceeded and runs, not both"),
)


@pytest.mark.parametrize(
    ("exceeded", "message"),
    [
        ((0, 0, 1), "no finite fit .*0 of 10, 1 of 10.*above the highest intensity 0.3"),
        ((0, 0, 9), "at the highest intensity 0.3"),
        ((9, 10, 10), "below the lowest intensity 0.1"),
        ((1, 10, 10), "at the lowest intensity 0.1"),
        ((5, 5, 5), "does not grow"),
    ],
)
@pytest.mark.parametrize("form", ["counts", "rows", "file"])
def test_one_fraction_at_an_end_has_no_fit(
    exceeded: tuple[int, ...], message: str, form: str, tmp_path: Path
) -> None:
    given: dict[str, Any] = {"levels": [0.1, 0.2, 0.3], "exceeded": exceeded, "runs": 10}
    if form != "counts":
        pairs = list(zip(given["levels"], exceeded, strict=True))
        rows = [(x, i, "collapsed" if i < k else "ok") for x, k in pairs for i in range(10)]
        columns = dict(zip(("intensity", "record", "status"), zip(*rows, strict=True), strict=True))
        given = {"table": columns}
    if form == "file":
        lines = [",".join(columns), *(",".join(map(str, row)) for row in rows)]
        given = {"table": tmp_path / "t.csv"}
        given["table"].write_text("\n".join(lines))
    with pytest.raises(InputError, match=message):
        rwmf.fragility(**given)


@pytest.mark.parametrize(
    ("levels", "exceeded", "side"),
    [
        ([0.1, 0.2, 0.3], [3, 3, 4], "1.252 is extrapolated far above the highest intensity 0.3"),
        ([0.1, 0.2, 0.3], [6, 7, 7], "below the lowest intensity 0.1"),
        ([0.1, 0.2, 0.3], [500, 500, 501], "is large: the probability hardly grows"),
        ([0.1, 0.2, 0.3], [1, 3, 5], ""),
    ],
)
def test_a_median_far_outside_the_levels_warns(
    levels: list[float], exceeded: list[int], side: str
) -> None:
    """The warning is that of the result, of the frequency, and of Python."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        runs = 10 if exceeded[0] < 10 else 1000
        found = rwmf.fragility(levels=levels, exceeded=exceeded, runs=runs, resamples=0)
        told = rwmf.risk(found, (1e-4, 1e-3)).attrs["warnings"]
    texts = [str(item.message) for item in caught if item.category is rwmf.RwmfWarning]
    lines = found.attrs["warnings"].splitlines()
    assert told.splitlines()[: len(lines)] == lines
    assert texts == [*lines, *told.splitlines()]
    assert side in found.attrs["warnings"]
    assert bool(found.attrs["warnings"]) == bool(side)


_ROWS: dict[str, Any] = {"intensity": [0.1, 0.1, 0.2, 0.2], "d": [1.0, 2.0, 2.5, 3.0]}


@pytest.mark.parametrize("word", ["Collapse", "collapsed", " OVERTURNED ", "overturning"])
def test_words_of_collapse(word: str) -> None:
    rows = _ROWS | {"d": [1.0, 2.0, 2.5, 1.0], "status": ["ok", "survived", "ok", word]}
    found = rwmf.fragility(rows, 2.2, resamples=0)
    assert found["exceeded"].values.tolist() == [0, 2]


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"status": ["ok", "failed", "ok", "ok"]}, "row 2: status = 'failed': must be one of ok"),
        ({"status": ["ok", "ok", "", "ok"]}, "row 3: status = ''"),
        ({"status": [0, 0, 1, 1]}, "row 1: status = '0'"),
        ({"status": [False, False, True, True]}, "row 1: status = 'False'"),
        ({"weight": [1.0] * 4}, "weight: rows have no weights"),
        ({"collapsed": [0, 0, 1, 1]}, "collapsed: state the ends of runs in the column status"),
        ({"intensity": np.array([0.1, 0.0, 1, 1])}, "row 2: intensity = 0: must be finite"),
        *(
            ({name: np.ma.array(values, mask=[0, 0, 1, 0])}, "the value at position 2 is masked")
            for name, values in {**_ROWS, "status": ["ok"] * 4, "design": ["a"] * 4}.items()
        ),
    ],
)
def test_tables_that_are_refused(columns: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        rwmf.fragility(_ROWS | columns, 2.2)
    assert "np." not in str(caught.value)


def test_a_file_names_the_line_of_an_unknown_status(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("# of another program\nintensity;status\n0,1;ok\n\n0,2;fell\n")
    with pytest.raises(InputError, match=r"t.csv.* line 5: status = 'fell'"):
        rwmf.fragility(path)


@pytest.mark.parametrize("names", [("#1", "b"), ("# a,b", ' "x";y'), ("a", "#"), ("#", "#r")])
def test_names_with_marks_keep_their_rows(names: tuple[str, str], tmp_path: Path) -> None:
    """As written by the program, and unquoted where the columns tell it from a comment."""
    from rwmf.assess.table import read_table, write_table

    rows = {"design": np.repeat(names, 2), "record": ["#1", "#2"] * 2, "intensity": [0.1] * 4,
            "status": ["ok"] * 4}  # fmt: skip
    path = tmp_path / "t.csv"
    write_table(read_table(rows), path)
    found = read_table(path)
    assert found["record"].values.tolist() == rows["record"]
    assert [name.strip() for name in found["design"].values] == [
        name.strip() for name in rows["design"]
    ]
    if not set(",;") & set("".join(names)):
        lines = [",".join(map(str, row)) for row in zip(*rows.values(), strict=True)]
        path.write_text("\n".join(["# a comment", ",".join(rows), "# another, too", *lines]))
        assert read_table(path)["design"].values.tolist() == rows["design"].tolist()


_X = np.geomspace(0.02, 5.0, 25)
_RATE = 1e-4 * _X**-2.3
_HAZARDS = {
    "intensity,frequency": (_X, _RATE),
    "annual rate,Sa(1.0s) [g]": (_RATE, _X),
    "frequency [1/year],iml": (_RATE, _X),
    "PGA (m/s2),annual_frequency": (9.81 * _X, _RATE),
    "pga [cm/s2];MAFE": (981 * _X, _RATE),
    "PGA_gal,mean annual frequency of exceedance": (981 * _X, _RATE),
    "PGA (%g),lambda": (100 * _X, _RATE),
    "intensity,return_period": (_X, 1 / _RATE),
    "Return period (years);Sa (g)": (1 / _RATE, _X),
    "intensity,poe_50": (_X, -np.expm1(-50 * _RATE)),
    "intensity,poe_10 [%]": (_X, -100 * np.expm1(-10 * _RATE)),
    "im,probability of exceedance in 50 years": (_X, -np.expm1(-50 * _RATE)),
    "im,annual probability of exceedance": (_X, -np.expm1(-_RATE)),
}


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("head", _HAZARDS)
def test_hazards_are_read_by_their_names(head: str, order: int, tmp_path: Path) -> None:
    """In any unit, quantity and order; a file with semicolons has decimal commas."""
    mark = ";" if ";" in head else ","
    columns = [values[::order] for values in _HAZARDS[head]]
    path = tmp_path / "hazard.csv"
    lines = [mark.join(map(repr, row)) for row in zip(*(x.tolist() for x in columns), strict=True)]
    text = "\n".join([head, *(line.replace(".", ",") if mark == ";" else line for line in lines)])
    path.write_text(text)
    exact = float(rwmf.risk((0.5, 0.4), (1e-4, 2.3))["annual_frequency"])
    for hazard in (path, dict(zip(head.split(mark), columns, strict=True))):
        found = rwmf.risk((0.5, 0.4), hazard)
        assert float(found["annual_frequency"]) == pytest.approx(exact, rel=1e-9)


# the layout of OpenQuake 3.18, from the page of its manual on classical PSHA
_OQ = "#,,,,,\"generated_by='OpenQuake engine 3.18.0', start_date='2023-10-03T06:09:08', "
_OQ += "checksum=2107362341, kind='mean', investigation_time={}, imt='{}'\"\n"


def _openquake(years: float, imt: str, levels: Sequence[float], *rows: Sequence[float]) -> str:
    lines = [",".join(["lon,lat,depth", *(f"poe-{level:.7f}" for level in levels)])]
    lines += [",".join(["0.0,0.0,-0.1", *(f"{p:.12E}" for p in row)]) for row in rows]
    return _OQ.format(years, imt) + "\n".join(lines) + "\n"


@pytest.mark.parametrize(("imt", "years"), [("PGA", 1.0), ("SA(1.0)", 10.0), ("AvgSA", 10.0)])
def test_hazard_curves_of_openquake(imt: str, years: float, tmp_path: Path) -> None:
    path = tmp_path / "hazard_curve-mean-PGA_1.csv"
    # the digits of the levels
    x = np.round(_X, 7)
    path.write_text(_openquake(years, imt, [*x, 20.0], [*-np.expm1(-years * 1e-4 * x**-2.3), 0.0]))
    exact = float(rwmf.risk((0.5, 0.4), (1e-4, 2.3))["annual_frequency"])
    found = rwmf.risk((0.5, 0.4), path)
    assert float(found["annual_frequency"]) == pytest.approx(exact, rel=1e-9)
    assert found.attrs["warnings"].splitlines()[0] == "hazard: 1 point of probability 0 left out"
    # the header of earlier versions
    text = path.read_text().splitlines()
    text[0] = f"# source_model_tree_path=('b1',), investigation_time={years},imt=\"{imt}\""
    path.write_text("\n".join(text))
    assert float(rwmf.risk((0.5, 0.4), path)["annual_frequency"]) == pytest.approx(exact, rel=1e-9)


test_hazards_that_are_refused = refused_files(
    "hazard.csv",
    lambda path: rwmf.risk((0.5, 0.4), path),
    ("a,b\n0.1,1\n1,0.1", "line 1: the columns are a, b"),
    ("intensity,poe\n0.1,1\n1,0.1", "line 1: the column poe states no years"),
    ("intensity,poe_50\n0.1,10\n1,2", "line 2: probability = 10: must be in"),
    ("intensity,frequency [%]\n0.1,1\n1,0.1", "line 1: the columns are"),
    ("intensity,frequency [Hz]\n0.1,1\n1,0.1", "line 1: the columns are"),
    ("log10(PGA),frequency\n0.1,1\n1,0.1", "line 1: the columns are"),
    ("PGV (cm/s),frequency\n0.1,1\n1,0.1", "line 1: .* in cm/s, that of the fragility in g"),
    ("PGA [furlong/s2],frequency\n0.1,1\n1,0.1", "line 1: the columns are"),
    ("PGA furlongs,frequency\n0.1,1\n1,0.1", "line 1: the columns are"),
    ("intensity,annual poe_50\n0.1,1\n1,0.1", "line 1: .* states no years"),
    ("# probability in 50 years\nintensity,frequency\n0.1,1\n1,0.1", "line 1: states prob"),
    ("0.1,1\n1,0.1", "line 1: has numbers instead of the names"),
    ("# of a site\n\na,b\n0.1,1\n1,0.1", "line 3: the columns are a, b"),
    ("intensity,frequency\n0.1,1\n0.1,0.5", "line 3: intensity = 0.1: is given twice"),
    ("intensity,frequency\n0.1,1\n0.2,2", "line 3: frequency = 2: must not grow"),
    ("intensity,return_period\n0.1,475\n0.2,100", "line 3: frequency = 0.01: must not grow"),
    ("intensity,return_period\n0.1,0\n0.2,100", "line 2: return_period = 0"),
    ("intensity,poe_50\n0.1,1\n0.2,1", "has 0 point"),
    ("intensity,poe_0\n0.1,0.1\n1,0.01", "line 1: the column poe_0 states no years"),
    ("intensity,frequency\n0.1,-1\n1,0.1", "line 2: frequency = -1: must be .* number > 0$"),
    (_openquake(1.0, "PGA", [0.1, 1.0], [0.1, 0.01], [0.1, 0.01]), "has 2 sites"),
    (_openquake(1.0, "IA", [0.1, 1.0], [0.1, 0.01]), "line 1: must state .* PGA, SA, AvgSA"),
    (_openquake(1.0, "PGV", [0.1, 1.0], [0.1, 0.01]), "PGV is in cm/s, .* fragility in g"),
    (_openquake(0.0, "PGA", [0.1, 1.0], [0.1, 0.01]), "investigation_time = 0.0: must be"),
    (_openquake(1.0, "PGA", [0.1, 1.0], [0.1, 1.01]), "poe-1.0000000: probability = 1.01"),
    (_openquake(1.0, "PGA", [0.1, 1.0], [0.1, 0.0]), "has 1 point: must have at least 2"),
    (_openquake(1.0, "PGA", [0.1, 1.0], [0.1, 0.2]), "must not grow"),
    ("lon,lat,depth,poe-0.1,poe-1\n0,0,0,0.1,0.01\n", "line 1: must state investigation_time"),
    (_OQ.format(1.0, "PGA") + "lon,lat,poe-a,poe-1\n0,0,0.1,0.01\n", "column poe-a names no"),
)


@pytest.mark.parametrize(
    ("fragility", "hazard", "message"),
    [
        ("0.5,0.4", "1e-4,1e300", "k = 1e[+]300: must be a finite number > 0 and < 100"),
        ("0.5,0.4", "1e-300,300", "k = 300.0: must be a finite number"),
        ("1e300,0.4", "1e-4,3", "annual frequency is 0 for median = 1e[+]300"),
        ("1e-300,0.4", "1e-4,3", "annual frequency is inf for median = 1e-300"),
        ("0.5,1e300", "1e-4,3", "annual frequency is inf for .*dispersion = 1e[+]300"),
    ],
)
def test_numbers_beyond_the_range(
    fragility: str, hazard: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["risk", fragility, "--hazard", hazard]) == 2
    assert re.search(message, capsys.readouterr().err)
    with pytest.raises(InputError, match=r"no finite fit|does not grow"):
        rwmf.fragility(levels=[1e-300, 1e300], exceeded=[3, 4], runs=10)


def test_warnings_of_runs_reach_the_frequency() -> None:
    """One line for each design, through analysis, fit and integral, and as warnings of Python."""
    designs = {name: coupled(impact={"e": e}) for name, e in (("w1", 0.9), ("w2", 0.8))}
    with pytest.warns(rwmf.RwmfWarning, match="w1: e = 0.9 is below"):
        table = rwmf.ida(designs, suite(2), [0.05, 0.2], tolerance=0.5, limits={"u_s_max": 0.05})
    lines = table.attrs["warnings"].splitlines()
    assert [line.partition(":")[0] for line in lines] == ["w1", "w2"]
    with pytest.warns(rwmf.RwmfWarning, match="w2: e = 0.8 is below"):
        curves = rwmf.fragility(table, 0.05, "u_s_max", resamples=0)
    with pytest.warns(rwmf.RwmfWarning, match="w2: e = 0.8 is below"):
        found = rwmf.risk(curves, (1e-4, 2.3))
    for result in (curves, found):
        assert result.attrs["warnings"].splitlines()[:2] == lines


def test_frequencies_above_one_warn() -> None:
    found = rwmf.risk((0.5, 0.4), {"intensity": [0.1, 1.0], "frequency": [20.0, 2.0]})
    assert "hazard: annual frequencies above 1 (up to 20 in 2 of 2 points)" in found.warnings
    assert "the annual frequency" in found.warnings
    # a return period states that it is one
    short = rwmf.risk((0.5, 0.4), {"intensity": [0.1, 1.0], "return_period": [0.05, 0.5]})
    assert float(short["annual_frequency"]) == pytest.approx(float(found["annual_frequency"]))
    assert "are they frequencies" not in short.warnings


def test_a_step_at_an_edge_of_the_bins() -> None:
    """Shares of the bins are those of the hazard above the step, and none is negative."""
    found = rwmf.risk((0.6, 0.0), (2e-4, 2.5), levels=[0.3, 0.6, 0.9])
    share = (0.9 / 0.6) ** -2.5
    assert found["contribution"].values == pytest.approx([0.0, 0.0, 1 - share, share], rel=1e-12)
    assert float(found["annual_frequency"]) == pytest.approx(2e-4 * 0.6**-2.5, rel=1e-12)


def test_step_has_no_dispersion() -> None:
    found = rwmf.fragility(levels=[0.1, 0.2], exceeded=[0, 10], runs=10)
    assert float(found["dispersion"]) == 0.0
    assert 0.1 < float(found["median"]) < 0.2
    assert "for want of levels between" in found.attrs["warnings"]


def test_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:  # noqa: ANN401
    """From namelists to annual frequency, in four commands; tables and figures are files."""
    monkeypatch.chdir(tmp_path)
    frame().to_namelist("weak.nml")
    frame(0.09).to_namelist("strong.nml")
    for motion in suite(3):
        times = np.column_stack([motion.times, motion.values])
        np.savetxt(f"{motion.name}.csv", times, fmt="%.17g", delimiter=",")
    how = "--records r0.csv r1.csv r2.csv --unit m/s2 --intensity pseudo_acceleration:1.2@0.05"
    two = f"weak.nml strong.nml {how}"
    for words in (
        f"ida {two} --levels 0.1,0.3 --tolerance 0.2 --out ida.csv --out ida.png",
        f"stripes {two} --levels 0.1,0.2,0.4 --out stripes.nc --pelicun demands",
        f"cloud {two} --factors 0.02,0.1 --out cloud.csv --out cloud.png",
        "fragility ida.csv --mce 0.2 --dispersions 0.3 --resamples 20 --out f.nc --out f.xml "
        "--out f.png --shape-factor 1.2,4,Dmax",
        "risk f.nc --hazard 1e-4,2.3 --out r.nc --out r.png",
    ):
        assert cli.main(words.split()) == 0, capsys.readouterr().err
        out = capsys.readouterr().out
        assert "weak" in out
        assert "strong" in out
        is_result = words.startswith(("fragility", "risk"))
        assert ("recentres by construction" in out) == is_result
    assert cli.main(["risk", "0.9,0.4", "--hazard", "2e-4,2.5", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["annual_frequency"] == pytest.approx(4.291122997679e-4, rel=1e-10)
    assert "sliding" in found["not_in_model"]
    model = ElementTree.parse("f.xml").getroot()[0]
    (params, *_) = [item for item in model.iter() if item.tag.endswith("params")]
    mean, deviation = float(params.attrib["mean"]), float(params.attrib["stddev"])
    with xr.open_dataset("f.nc", engine="h5netcdf") as curves:
        assert {"cases", "records", "version"} <= set(curves.attrs)
        beta = math.sqrt(math.log1p((deviation / mean) ** 2))
        assert beta == pytest.approx(float(curves["dispersion_total"][0]))
    _check_demands(Path("demands"))
    for words in ("fragility none.csv", "risk f.nc --hazard none.csv", "risk ida.csv --hazard 1,2"):
        assert cli.main(words.split()) == 2


def _check_demands(folder: Path) -> None:
    """Tables of pelicun: a row of units, numbers, collapsed rows apart."""
    files = sorted(path.name for path in folder.iterdir())
    assert "weak_0.1g.csv" in files
    assert "weak_0.4g_collapsed.csv" in files
    n = 0  # all records are in one of the files
    for name in (item for item in files if item.startswith("weak_0.4g")):
        with (folder / name).open(encoding="ascii") as file:
            head, units, *rows = csv.reader(file)
        assert "1-PID-1-1" in head
        assert units[0] == "Units"
        assert all(math.isfinite(float(item)) for row in rows for item in row)
        n += len(rows)
    assert n == 3
