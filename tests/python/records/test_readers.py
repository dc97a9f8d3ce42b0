"""Readers of published formats: values, stated peaks, damage.

The headers are those of published records, shortened, and the samples are made up. K-NET is AKT013
of 11 August 1996 from the tests of obspy. The others are from the tests of gmprocess: ESM HI.ARS1
of 28 July 2019, COSMOS AK.BMR of 30 November 2018, CGS 89146 of 13 February 2012. CSMNC is station
51BXD of 20 April 2013 from the example of CSMNC2SAC.
"""

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rwmf
from rwmf import cli, records
from rwmf.errors import InputError

_N = 40
_A = np.round(np.sin(np.arange(_N) * 0.7) * np.hanning(_N) * 80, 3)
_PEAK = float(np.abs(_A).max())


def _fixed(values: np.ndarray, per: int, width: int, digits: int) -> str:
    cells = [f"{value:{width}.{digits}f}" for value in values]
    return "\n".join("".join(cells[i : i + per]) for i in range(0, len(cells), per)) + "\n"


def _esm() -> str:
    header = {
        "EVENT_NAME": "GREECE",
        "EVENT_TIME_HHMMSS": "160908",
        "STATION_NAME": "Town Hall,Argos,Argolis,Peloponnese",
        "SAMPLING_INTERVAL_S": "0.005000",
        "NDATA": f"{_N}",
        "STREAM": "HNN",
        "UNITS": "cm/s^2",
        "INSTRUMENT": "sensor = CMG_5TD_ACCELEROMETER_GURALP [Unknown] | digitizer = Unknown",
        "PGA_CM/S^2": f"{_PEAK:.6f}",
        "HEADER_FORMAT": "DYNA 1.2",
        "DATA_TYPE": "ACCELERATION",
        "ORIGINAL_DATA_MEDIATOR": "http://eida.gein.noa.gr/",
        "USER5": "",
    }
    lines = [f"{key}: {value}" for key, value in header.items()]
    return "\n".join([*lines, *(f"{value:.6f}" for value in _A)]) + "\n"


def _knet(direction: str = "E-W") -> str:
    counts = np.round(_A / 2000 * 8388608).astype(int) - 18000
    gal = (counts - counts.mean()) * 2000 / 8388608
    header = [
        "Origin Time       1996/08/11 03:12:00",
        "Lat.              38.920",
        "Long.             140.630",
        "Depth. (km)       7",
        "Mag.              5.9",
        "Station Code      AKT013",
        "Station Lat.      39.6069",
        "Station Long.     140.3213",
        "Station Height(m) 34",
        "Record Time       1996/08/11 03:12:39",
        "Sampling Freq(Hz) 100Hz",
        f"Duration Time(s)  {_N / 100:g}",
        f"Dir.              {direction}",
        "Scale Factor      2000(gal)/8388608",
        f"Max. Acc. (gal)   {np.abs(gal).max():.3f}",
        "Last Correction   1996/08/11 03:00:00",
        "Memo.             ",
    ]
    rows = ["".join(f"{x:8d} " for x in counts[i : i + 8]) for i in range(0, _N, 8)]
    return "\n".join([*header, *rows]) + "\n"


def _cosmos(direction: str = "340 deg", unit: str = "cm/sec2(04)") -> str:
    reals = np.full(100, -999.0)
    reals[[33, 61, 62, 63, 64]] = 0.02, 5.0, 0.2, _PEAK, 0.1
    return (
        "Corrected acceleration    (Format v01.20 with 13 text lines)\n"
        "Record of Point MacKenzie Earthquake of Fri Nov 30, 2018 17:29 UTC\n"
        f"Sta Cha:  1: {direction} (Rcrdr Chan  1) Location: ground\n"
        " 100 Integer-header values follow on  10 lines, Format= (10I8)\n"
        + ("    -999" * 10 + "\n") * 10
        + " 100 Real-header values follow on  20 lines, Format= (5F15.6)\n"
        + _fixed(reals, 5, 15, 6)
        + '   1 Comment line(s) follow, each starting with a "|":\n| none\n'
        f"   {_N} acceleration pts, approx  0 secs, units={unit},Format=(8F10.5)\n"
        + _fixed(_A, 8, 10, 5)
        + f"   {_N} velocity     pts, approx  0 secs, units=cm/sec(05),Format=(8F10.5)\n"
        + _fixed(_A / 10, 8, 10, 5)
        + "End-of-data for Chan  1 acceleration\n"
    )


def _cgs_1() -> str:
    return "".join(
        "Uncorrected Accelerogram Data             Processed: 07/06/19, CGS  ciclc--f    \n"
        f"Chan  {i}: {name}                                       \n"
        "Units of uncor data are sec and g.         "
        f"Max  =  {np.abs(factor * _A).max() / 1000:.3f} g, at    9.999 sec.    \n"
        f" {_N} Accelerogram points at 100 pts/sec in units of g.       Format: (8f9.6)  \n"
        + _fixed(factor * _A / 1000, 8, 9, 6)
        + f"/&  ----------  End of Data for Station Channel   {i}  ----------\n"
        for i, (name, factor) in enumerate([(" 90 Deg", 1), ("360 Deg", -0.5), (" Up", 0.3)], 1)
    )


def _cgs_2() -> str:
    return (
        "Corrected accelerogram   89146-L2500-12044.02       Chan  1: 360 Deg     from   \n"
        "Uncorrected Accelerogram Data             Processed: 02/13/12, CGS  146be002    \n"
        "Chan  1: 360 Deg                                                                \n"
        f" {_N} points of instrument- and baseline-corrected accel, veloc and displ data \n"
        f"Peak acceleration =    {_PEAK:.3f}    cm/sec/sec  at   30.585   sec.            \n"
        "89146-L2500-12044.02      Willow Creek    Chan  1: 360 Deg                      \n"
        f" {_N} points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.3)    \n"
        + _fixed(_A, 8, 10, 3)
        + f" {_N} points of veloc data equally spaced at  .005 sec, in cm/sec.  (8f10.6)    \n"
        + _fixed(_A / 20, 8, 10, 6)
    )


def _table() -> str:
    rows = "\n".join(f"{0.02 * i:.2f},{a},{-a / 2},{a / 4}" for i, a in enumerate(_A / 100))
    return f"Time [s],H1 [m/s2],H2 [m/s2],UP [m/s2]\n{rows}\n"


def _csmnc() -> str:
    cells = [f"{value:13.6E}" for value in _A]
    lines = [" ".join(cells[i : i + 8]) for i in range(0, _N, 8)]
    return (
        "051BXD130420080201\n0130420080246 2013-04-20 8:2:46 BTM\n"
        "LUSHAN EARTHQUAKE, LUSHAN,CHN\nEPICENTER  30.300N 103.000E DEPTH 13 KM\n"
        "MAGNITUDE  7.0(Ms)\nSTATION: 51BXD 30.400N 102.800E\nSITE CONDITION: ROCK\n"
        "INSTRUMENT TYPE: MR2002/SLJ-100\nOBSERVING POINT: GROUND\nCOMP. EW\n"
        "UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\n"
        f"NO. OF POINTS:  {_N}  EQUALLY SPACED INTERVALS OF:  0.005  SEC\n"
        f"PEAK VALUE:    {_PEAK:9.3f}   AT   26.35 SEC    DURATION:  60 SEC\n"
        "PRE-EVENT TIME:  20  SEC\nCSMNC\n\n" + " \n".join(lines) + " \n"
    )


_FILES: dict[str, tuple[Callable[[], str], str, float]] = {
    "HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC": (_esm, "cm/s2", 0.005),
    "AKT0139608110312.EW": (_knet, "cm/s2", 0.01),
    "us1000hyfh.acc.V2c": (_cosmos, "cm/s2", 0.005),
    "ua0001.dat": (_csmnc, "cm/s2", 0.005),
    "CICLC.v1": (_cgs_1, "g", 0.01),
    "CE89146.V2": (_cgs_2, "cm/s2", 0.005),
    "table.csv": (_table, "m/s2", 0.02),
}


def _write(folder: Path, name: str, text: str | None = None) -> Path:
    path = folder / name
    path.write_text(_FILES[name][0]() if text is None else text, encoding="latin-1")
    return path


@pytest.mark.parametrize("name", _FILES)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_samples(name: str, end: str, tmp_path: Path) -> None:
    make, unit, dt = _FILES[name]
    path = tmp_path / name
    path.write_bytes(make().replace("\n", end).encode())
    found = rwmf.records.find_records([path])
    motion = found[0].array
    assert motion is not None
    assert (motion.unit, motion.times[1]) == (unit, pytest.approx(dt, rel=1e-12))
    factor = {"cm/s2": 1.0, "g": 1e-3, "m/s2": 1e-2}[unit]
    wanted = _A - (_A.mean() if "AKT" in name else 0)
    np.testing.assert_allclose(motion.values, wanted * factor, rtol=0, atol=2e-4 * factor)
    assert found[0].path == str(path)
    # the kernel runs it
    case = rwmf.Case(frame={"T_s": 0.1, "xi_s": 0.05}, motion=motion)
    assert float(rwmf.simulate(case)["u_s_max"]) > 0
    swept = rwmf.sweep(case, {}, found)
    assert list(swept["record"].values) == [record.name for record in found]


@pytest.mark.parametrize("name", _FILES)
def test_truncated_files(name: str, tmp_path: Path) -> None:
    """Every cut that loses a digit or more is an error with the file's name."""
    whole = _FILES[name][0]()
    end = len(whole.rstrip())
    if name == "us1000hyfh.acc.V2c":
        end = whole.index(" velocity") - 5
    elif name == "CICLC.v1":
        end = whole.rindex("/&") - 1
    elif name == "CE89146.V2":
        end = whole.index(" points of veloc") - 4
    chance = random.Random(7)
    # a table does not state its length
    cuts = sorted(chance.sample(range(1, end - 2), 60)) if name != "table.csv" else [3, 20]
    for cut in cuts:
        path = _write(tmp_path, name, whole[:cut])
        try:
            found = rwmf.records.info(path, unit="g", dt=0.01)
        except InputError:
            try:
                found = rwmf.records.info(path)
            except InputError as error:
                assert str(path) in str(error)
                assert "\n" not in str(error)
                continue
        # a cut between two channels leaves whole ones
        assert name == "CICLC.v1"
        assert len(found) < 3


@pytest.mark.parametrize("name", _FILES)
def test_damaged_files(name: str, tmp_path: Path) -> None:
    """Random bytes give an error or a record, never another exception."""
    whole = _FILES[name][0]().encode("latin-1")
    chance = random.Random(len(name))
    errors = 0
    for _ in range(80):
        content = bytearray(whole)
        for _ in range(chance.choice([1, 3, 30])):
            content[chance.randrange(len(content))] = chance.randrange(256)
        path = tmp_path / name
        path.write_bytes(content)
        try:
            rwmf.records.find_records([path])
        except InputError:
            errors += 1
    assert errors > 10


_PLAIN = {
    "at2": "PEER\nName\nUNITS OF G\nNPTS= 12, DT= .02 SEC\n" + _fixed(_A[:12] / 100, 5, 15, 8),
    "one": "\n".join(map(str, _A[:12])) + "\n",
    "two": "# note\ntime,a\n" + "\n".join(f"{0.02 * i:.2f},{a}" for i, a in enumerate(_A[:12])),
}


@pytest.mark.parametrize("kind", _PLAIN)
def test_samples_are_those_of_the_kernel(kind: str, tmp_path: Path) -> None:
    """Of all damaged files that the kernel accepts, by peak and end."""
    chance = random.Random(kind)
    path = tmp_path / "record"
    marks = b" \t\n\r,;#-+.0123456789eEdDaNx_=\xef\xbb\xbf\0"
    read = 0
    for _ in range(150):
        content = bytearray(_PLAIN[kind].encode())
        for _ in range(chance.choice([0, 1, 1, 3])):
            i = chance.randrange(len(content))
            content[i : i + chance.randrange(2)] = bytes([chance.choice(marks)])
        path.write_bytes(content)
        given: dict[str, object] = {} if kind == "at2" else {"unit": "g"}
        given |= {"dt": 0.02} if kind == "one" else {}
        try:
            motion = records.read(path, **given)  # type: ignore[arg-type]
        except InputError as error:
            assert str(path) in str(error)
            continue
        read += 1
        case = rwmf.Case(frame={"T_s": 1.0, "xi_s": 0.05},
                         motion={"kind": "record", "file": str(path)} | given)  # fmt: skip
        assert case.kernel.end_of_motion() == pytest.approx(motion.times[-1], rel=1e-12)
    assert read > 30


@pytest.mark.parametrize(
    ("name", "old", "new", "message"),
    [
        ("HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC", f"NDATA: {_N}", "NDATA: 41",
         "the file has 40 numbers where its header says NDATA = 41"),
        ("HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC", "ACCELERATION", "VELOCITY",
         "DATA_TYPE = VELOCITY: must be ACCELERATION"),
        ("HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC", "cm/s^2", "counts", "UNITS = 'counts'"),
        ("HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC", "0.005000", "nan",
         "SAMPLING_INTERVAL_S = 'nan': must be a number > 0"),
        ("HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC", f"{_PEAK:.6f}\n", "12.5\n",
         "the largest sample is .* where the header says PGA"),
        ("AKT0139608110312.EW", "100Hz", "Hz", r"Sampling Freq\(Hz\)"),
        ("AKT0139608110312.EW", "(gal)/", "(gal)*", "Scale Factor .* must be like"),
        ("AKT0139608110312.EW", "0.4", "0.5", "Duration Time"),
        ("ua0001.dat", "CM/SEC/SEC", "COUNTS", "UNIT = 'COUNTS': must be a unit of accelerations"),
        ("ua0001.dat", "POINTS:  40", "POINTS:  41", "has 40 numbers where its header says NO. OF"),
        ("ua0001.dat", "VALUE:  ", "VALUE:  9", "the largest sample is .* says PEAK VALUE"),
        ("ua0001.dat", "PEAK", "PIQUE", "the header has no UNIT, NO. OF POINTS"),
        ("us1000hyfh.acc.V2c", "v01.20", "v01.00", "version of the format is not 01.20"),
        ("us1000hyfh.acc.V2c", "units=cm/sec2(04)", "units=counts(50)", "units = 'counts.50.'"),
        ("us1000hyfh.acc.V2c", "approx  0 secs", "approx  9 secs", "are not the stated 9 s"),
        ("us1000hyfh.acc.V2c", "acceleration pts", "velocity     pts", "no block of acc"),
        ("CICLC.v1", "points at 100", "points at 0.0", "pts/sec = '0.0': must be a number > 0"),
        ("CICLC.v1", " -.", " x.", "is not a finite number"),
        ("CE89146.V2", "in cm/sec2", "in counts", "unit = 'counts': must be a unit of acc"),
        ("table.csv", "H2 [m/s2]", "H2 [kN]", "column 'H2' has the unit 'kN', which is not known"),
        ("table.csv", "Time [s]", "Period [s]", "the column 'Period' belongs to a spectrum"),
        ("table.csv", "0.02,", "0.02,1,", "line 3: 5 columns where the header has 4"),
    ],
)  # fmt: skip
def test_messages(name: str, old: str, new: str, message: str, tmp_path: Path) -> None:
    text = _FILES[name][0]().replace(" 0.0000", "  .0000").replace("-0.0", " -.0")
    assert old in text
    path = _write(tmp_path, name, text.replace(old, new))
    with pytest.raises(InputError, match=message) as caught:
        rwmf.records.find_records([path])
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"1 UNCORRECTED ACCELEROGRAM\n 1\n", r"the format SMC \(USGS\) is not read"),
        (
            b"Uncorrected accelerogram 20160214_001343_NBLC_20 GNS Science\nSite NBLC\n",
            r"format GeoNet \(New Zealand\) is not read: write two columns",
        ),
        (b"Corrected accelerogram 20160214_001343_NBLC_20 GNS Science\nSite NBLC\n", "GeoNet"),
        (b"Response and Fourier Amplitude Spectra\n1 2 3\n", r"CSMIP volume 3 \(spectra\) is not"),
        (b"\n      ARCHIVO ESTANDAR DE ACELERACION ASA\n1 2 3\n", r"UNAM/ASA \(Mexico\) is not"),
        (b"STRONG GROUND MOTION RECORDS OF TURKIYE\n", r"AFAD \(Turkey\) is not read"),
        (b"#Earthquake Information\n", r"CWB \(Taiwan\) is not read"),
        (b"\0\1\2\3" * 50, "is a binary file"),
        (b"", "the file is empty"),
        (b"Hallo Welt\n", "no numbers"),
    ],
)
def test_formats_that_are_not_read(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "strange.dat"
    path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        records.info(path, unit="g")
    with pytest.raises(InputError, match=r"cannot be read|not a regular file"):
        records.info(tmp_path, unit="g")


@pytest.mark.parametrize(
    ("header", "unit"),
    [
        ("t,a", None),
        ("time (s),acceleration (g)", "g"),
        ("Time [s]; acc [cm/s^2]", "cm/s2"),
        ("t_s,a_m_s2", "m/s2"),
        ("t (s)  a (Gal)", "cm/s2"),
        ("Zeit,Beschleunigung in m", None),
    ],
)
def test_units_of_headers(header: str, unit: str | None, tmp_path: Path) -> None:
    path = tmp_path / "two.csv"
    path.write_text(header + "\n0,1.5\n0.1,-2\n0.2,0\n")
    assert rwmf.records.find_records([path])[0].unit == unit
    if unit is None:
        with pytest.raises(InputError, match=r"two.csv: .*needs the key unit"):
            records.read(path)
        unit = "m/s2"
    else:
        other = "g" if unit != "g" else "m/s2"
        with pytest.raises(InputError, match=f"unit = '{other}': the header says '{unit}'"):
            rwmf.records.find_records([path], unit=other)
    motion = records.read(path, unit=unit)
    assert (motion.unit, list(motion.values)) == (unit, [1.5, -2.0, 0.0])


@pytest.mark.parametrize("text", ["NPTS= 4, DT= .01 SEC", "   4   0.0100   NPTS, DT"])
def test_at2_as_the_kernel_reads_it(text: str, tmp_path: Path) -> None:
    path = tmp_path / "quake.AT2"
    header = "PEER NGA STRONG MOTION DATABASE RECORD\nName\nACCELERATION IN UNITS OF G\n"
    path.write_text(f"{header}{text}\n  .1000E-01 -.25D+00  3.e-1\n 0.0\n")
    motion = records.read(path)
    assert (motion.dt, list(motion.values)) == (0.01, [0.01, -0.25, 0.3, 0.0])
    with pytest.raises(InputError, match=r"quake.AT2: the file has 4 numbers"):
        path.write_text(path.read_text().replace("4", "5", 1))
        records.read(path)


def test_doubts(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    for rows, words in (
        ("0 0\n0.01 1\n0.02 -1\n0.9 0\n0.91 0\n", "gap of 0.88 s behind t = 0.02 s"),
        ("0 0\n1 980\n2 -980\n3 0\n", "peak of 980.0 g is outside the range"),
        ("0 0\n0.01 1\n0.02 -1\n0.03 0\n", "duration of 0.03 s"),
        ("0 0\n1 1\n2 1\n3 1\n", "m/s at the end: the baseline is not corrected"),
    ):
        path.write_text(rows)
        assert any(words in line for line in records.info(path, unit="g")[0]["warnings"])


def test_channels_and_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = _write(tmp_path, "CICLC.v1")
    assert [record.name for record in rwmf.records.find_records([path])] == ["CICLC-1", "CICLC-2"]
    with pytest.raises(InputError, match=r"has 3 channels: 1 .90 Deg., 2 .360 Deg., 3 .Up."):
        records.read(path)
    up = records.read(path, channel=3)
    out = tmp_path / "up.txt"
    assert cli.main(["records", "convert", str(path), "--out", str(out), "--channel", "3"]) == 0
    printed = capsys.readouterr().out
    assert f"unit = 'g', dt = {up.dt!r} /" in printed
    same = records.read(out, unit="g", dt=up.dt)
    assert np.array_equal(same.values, up.values)
    assert cli.main(["records", "convert", str(path), "--out", str(out), "--channel", "3"]) == 2
    assert "is there already; --force replaces it" in capsys.readouterr().err
    assert (
        cli.main(["records", "convert", str(path), "--out", str(path), "--channel", "3", "--force"])
        == 2
    )
