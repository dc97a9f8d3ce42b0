"""Unit, interval and quantity that files state, in about 800 variants of headers and encodings."""

import itertools
from pathlib import Path

import numpy as np
import pytest
import rwmf
from record_variants import DT, SAMPLES, N, Variant, variants
from rwmf import cli, records
from rwmf.errors import InputError
from rwmf.kernel import tables

_UNITS = {None: None, "g": 9.81, "m/s2": 1.0, "cm/s2": 0.01}
_KEYS = [*itertools.product(_UNITS, (None, DT)), ("g", 2 * DT)]
_VARIANTS = variants()


def _read(variant: Variant, unit: str | None, dt: float | None) -> bool:
    """Read a file with given keys; False when it is refused."""
    try:
        found = tables.read_record(variant.content, unit, dt)
    except InputError as error:
        assert "\n" not in str(error)
        return False
    assert variant.is_record
    assert len(found) == 1
    channel = found[0]
    size = variant.unit
    if size is None:
        # without a statement the samples are in the unit of the key
        size = _UNITS[unit]
        assert size is not None
    assert channel.values.size == N
    factor = {"g": 9.81, "m/s2": 1.0, "cm/s2": 0.01}[channel.unit]
    np.testing.assert_allclose(
        channel.values * factor, SAMPLES / variant.written * size, rtol=1e-8, atol=1e-9
    )
    step = variant.dt or dt
    times = channel.times
    if times is None:
        times = np.arange(N) * (channel.dt or 0.0)
    np.testing.assert_allclose(times, np.arange(N) * (step or 0.0), rtol=1e-9, atol=1e-12)
    return True


@pytest.mark.parametrize("i", range(0, len(_VARIANTS), 50))
def test_no_file_is_read_otherwise_than_it_says(i: int) -> None:
    for variant in _VARIANTS[i : i + 50]:
        try:
            reads = [_read(variant, *keys) for keys in _KEYS]
        except AssertionError as error:
            raise AssertionError(f"{variant.name}: {error}") from error
        assert any(reads) == variant.is_record or not variant.is_read, variant.name


@pytest.mark.parametrize("i", range(0, len(_VARIANTS), 100))
def test_namelist_and_records_agree(i: int, tmp_path: Path) -> None:
    """Each twentieth variant by `&motion` and `rwmf.records`: the same motion, or both refuse."""
    for k, variant in enumerate(_VARIANTS[i : i + 100 : 20]):
        path = tmp_path / f"record {k}.txt"
        path.write_bytes(variant.content)
        keys: dict[str, object] = {}
        if variant.unit is None:
            keys["unit"] = "g"
        if variant.dt is None:
            keys["dt"] = DT
        motion = {"kind": "record", "file": str(path)} | keys
        try:
            case = rwmf.Case(frame={"T_s": 1.0, "xi_s": 0.05}, motion=motion)
        except InputError as error:
            assert str(path) in str(error)
            with pytest.raises(InputError) as caught:
                records.read(path, **keys)  # type: ignore[arg-type]
            assert str(path) in str(caught.value)
            continue
        read = records.read(path, **keys)  # type: ignore[arg-type]
        same = rwmf.Case(frame={"T_s": 1.0, "xi_s": 0.05}, motion=read)
        assert case.kernel.peak_of_motion() == same.kernel.peak_of_motion()
        assert case.kernel.end_of_motion() == pytest.approx(same.kernel.end_of_motion(), rel=1e-15)


@pytest.mark.parametrize(
    ("text", "keys", "message"),
    [
        ("t [s],a [cm/s2]\n0,1\n1,2\n", {"unit": "g"}, "1: unit = 'g': the header says 'cm/s2'"),
        ("t,a [%g]\n0,1\n1,2\n", {"unit": "g"}, "line 1: unit = 'g': the header says '%g'"),
        ("# dt = 0.02 s\n1\n2\n", {"unit": "g", "dt": 0.01},
         "line 1: dt = 0.01 s: the file says 0.02 s"),
        ("# dt = 0.5 s\n0 1\n1 2\n", {"unit": "g"}, "intervals of 1.0 s where line 1 says 0.5 s"),
        ("# NPTS = 3\n1\n2\n", {"unit": "g", "dt": 0.01}, "2 samples where line 1 says 3"),
        ("PEER\nUNITS OF G\nNPTS= 2\n1 2\n", {}, "3: 'NPTS= 2' does not give NPTS > 0 and DT"),
        ("# unit = g\n# unit = gal\n1\n2\n", {"dt": 1.0}, "line 2: the unit 'gal' contradicts 'g'"),
        ("# dt = 1\n# dt = 2\n1\n2\n", {"unit": "g"}, "2: the interval 2.0 s contradicts 1.0 s"),
        ("0 UNKNOWN\n*\n", {"unit": "g"}, r"the format SMC .USGS. is not read"),
        ("PK\3\4", {"unit": "g"}, "is a zip archive: extract the record"),
        ("one\ntwo\n1\n2\n", {"unit": "g"}, "line 2: 'two' is not a finite number; known formats"),
        ("Corrected accelerogram 20160214 GNS Science\n", {}, r"GeoNet .New Zealand. is not read"),
        ("Response and Fourier Amplitude Spectra\n", {}, r"CSMIP volume 3 .spectra. is not read"),
        ("\n   ARCHIVO ESTANDAR DE ACELERACION ASA\n", {}, r"UNAM/ASA .Mexico. is not read"),
        ("STRONG GROUND MOTION RECORDS OF TURKIYE\n", {}, r"AFAD .Turkey. is not read"),
        ("#K-NET CSV\n", {}, "the format K-NET CSV, which the command 'rwmf records convert'"),
        ("t,h1 [g],h2 [g]\n0,1,2\n1,2,3\n", {}, "has 2 columns of accelerations"),
    ],
)  # fmt: skip
def test_contradictions_by_every_door(
    text: str, keys: dict[str, object], message: str, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    path = tmp_path / "record.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        rwmf.Case(frame={"T_s": 1.0, "xi_s": 0.05},
                  motion={"kind": "record", "file": str(path)} | keys)  # fmt: skip
    assert str(path) in str(caught.value)
    if "K-NET" in text or "h1" in text:
        return
    words = [str(keys.get("unit", "")), *([str(keys["dt"])] if "dt" in keys else [])]
    options = ["--unit", ",".join(words)] if keys else []
    assert cli.main(["records", "info", str(path), *options]) == 2
    shown = capsys.readouterr().err
    assert str(path) in shown
    assert "line" in shown or "says" in shown or "format" in shown or "zip" in shown


def test_csv_of_k_net(tmp_path: Path) -> None:
    head = ["#K-NET CSV", "#SamplingFrequency(Hz)", "#100", "#DurationTime(s)", "#0.2",
            "#Time,RelativeTime(s),N-S(gal),E-W(gal),U-D(gal)"]  # fmt: skip
    rows = [f"2020/01/01 00:00:{i / 100:05.2f},{i / 100:.2f},{i},{-i},1" for i in range(20)]
    path = tmp_path / "knet.csv"
    path.write_text("\n".join([*head, *rows]) + "\n")
    names = [record.name for record in rwmf.records.find_records([path])]
    assert names == ["knet-N-S", "knet-E-W"]
    east = records.read(path, channel=2)
    assert (east.unit, east.dt, east.values[3]) == ("cm/s2", 0.01, -3.0)
    path.write_text(path.read_text().replace("#0.2", "#0.3"))
    with pytest.raises(InputError, match="20 numbers where its header says DurationTime"):
        records.read(path, channel=1)


@pytest.mark.parametrize(
    "words",
    [
        ["gradient", "case.nml", "--parameters", "frame.gamma", "--quantities", "u_s_max_m"],
        ["study", "wall", "case.nml", "--T_s", "0.5"],
        ["design", "case.nml", "--vary", "frame.gamma=2:8", "--target", "u_s_max_m=0.6@50",
         "--cost", "frame.gamma=1", "--left-out", "second.txt", "--out", "design.nml"],
    ],
    ids=lambda words: words[0],
)  # fmt: skip
def test_the_interval_of_a_column_by_every_command(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the interval a single column is no record."""
    monkeypatch.chdir(tmp_path)
    Path("case.nml").write_text(
        "&wall h = 2.0, b = 0.5 /\n&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
        "&motion kind = 'one_sine', a_max_g = 0.3, T_p = 1.0 /\n&solver t_end = 1.0 /\n"
    )
    for name, size in (("first.txt", 0.3), ("second.txt", 0.31)):
        np.savetxt(name, size * np.sin(0.06 * np.arange(100)))
    suite = [*words, "--records", "first.txt", "--unit"]
    assert cli.main([*suite, "g"]) == 2
    assert cli.main([*suite, "g,0.01"]) == 0
