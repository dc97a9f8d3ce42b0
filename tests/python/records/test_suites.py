"""Pairs, lists, target spectra and sequences of records."""

import json
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
import rwmf
from refused import refused_files
from rwmf import cli, records
from rwmf.errors import InputError
from scenes import coupled

_DT = 0.02


def _motion(seed: int, n: int = 300) -> rwmf.Motion:
    chance = np.random.default_rng(seed)
    values = chance.standard_normal(n) * np.hanning(n)
    return rwmf.Motion(values, dt=_DT, unit="g", name=f"m{seed}")


def _at2(path: Path, seed: int = 0, n: int = 300) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    head = f"PEER\nName\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= {n}, DT= {_DT} SEC\n"
    path.write_text(head + "\n".join(map(repr, _motion(seed, n).values.tolist())) + "\n")
    return path


_STATIONS = [
    ("ABBAR--L.AT2", "ABBAR--T.AT2", "ABBAR--V.AT2"),
    ("TCU068-N.at2", "TCU068-W.at2", "TCU068-V.at2"),
    ("LYON_HNE.AT2", "LYON_HNN.AT2", "LYON_HNZ.AT2"),
    ("NICE.BNE.at2", "NICE.BNN.at2", "NICE.BNZ.at2"),
    ("ROMA.E.AT2", "ROMA.N.AT2", "ROMA.Z.AT2"),
    ("OSLO-long.at2", "OSLO-tran.at2", "OSLO-vert.at2"),
    ("BONN000.at2", "BONN090.at2", "BONN_UP.at2"),
    ("BERN-1.at2", "BERN-2.at2", "BERN-3.at2"),
    ("RSN6_IMPVALL.I_I-ELC180.AT2", "RSN6_IMPVALL.I_I-ELC270.AT2", "RSN6_IMPVALL.I_I-ELC-UP.AT2"),
    ("RSN77_SFERN_PUL164.AT2", "RSN77_SFERN_PUL254.AT2", "RSN77_SFERN_PULDWN.AT2"),
    ("RSN4040_BAM_BAM-L.AT2", "RSN4040_BAM_BAM-T.AT2", "RSN4040_BAM_BAM-V.AT2"),
    ("NORTHR_SYL090.at2", "NORTHR_SYL360.at2", "NORTHR_SYL-UP.at2"),
    ("HI.ARS1..HNE.D.2019.C.AT2", "HI.ARS1..HNN.D.2019.C.AT2", "HI.ARS1..HNZ.D.2019.C.AT2"),
    ("quake_x.at2", "quake_y.at2", "quake_z.at2"),
]


@pytest.mark.parametrize("names", _STATIONS, ids=lambda names: names[0])
def test_components_by_name(names: tuple[str, str, str], tmp_path: Path) -> None:
    for i, name in enumerate(names):
        _at2(tmp_path / name, i)
    pair = records.pairs([tmp_path])[0]
    assert pair.vertical is not None
    found = [Path(item.path).name for item in (pair.first, pair.second, pair.vertical)]
    assert found == list(names)
    # in a folder and a pattern the vertical component is no ground motion of the suite
    pattern = rwmf.records.find_records([str(tmp_path / "*.[aA][tT]2")])
    assert [Path(item.path).name for item in pattern] == list(names[:2])
    with pytest.warns(rwmf.RwmfWarning, match=f"{names[2]}: is a vertical component, and acts"):
        assert len(rwmf.records.find_records([tmp_path / name for name in names])) == 3
    assert [Path(item.path).name for item in rwmf.records.find_records([tmp_path])] == list(
        names[:2]
    )
    assert rwmf.records.find_records([tmp_path / names[2]])[0].name == Path(names[2]).stem
    (tmp_path / names[1]).unlink()
    with pytest.raises(InputError, match=r"1 horizontal and 1 vertical components .* must be 2"):
        records.pairs([tmp_path])


@pytest.mark.parametrize(
    ("names", "left"),
    [
        (["S_00", "S_90", "S_UP"], 2),
        (["SL", "ST", "SVERT"], 2),
        (["090", "180", "DWN"], 2),
        (["q_1", "q_2", "q_3", "q_4"], 4),
        (["EQ1", "EQ2", "EQ3", "EQ4"], 4),
        (["made_up"], 1),
        (["A-UP", "B-UP"], 2),
        (["A_x", "__MACOSX/._A_x", "__MACOSX/A_x", "._A_x", ".ipynb_checkpoints/A_x"], 1),
    ],
)
def test_horizontal_components_of_a_folder(names: list[str], left: int, tmp_path: Path) -> None:
    """Vertical components beside them and remains of archives are no motions of the suite."""
    for i, name in enumerate(names):
        path = _at2(tmp_path / f"{name}.AT2", i)
        if "._" in name or "__MACOSX" in name:
            path.write_bytes(b"\0\5\26\7")
    (tmp_path / "Thumbs.db").write_bytes(b"\0")
    found = rwmf.records.find_records([tmp_path])
    assert [item.name for item in found] == [Path(name).name for name in names[:left]]
    if "__MACOSX" in names[-1] or len(names) == 5:
        # as the shell expands a pattern
        assert rwmf.records.find_records(sorted(tmp_path.glob("[!.]*"))) == found
        assert rwmf.records.find_records([str(tmp_path / "*.AT2")]) == found


def test_stations_of_a_folder_stay_apart(tmp_path: Path) -> None:
    for i, names in enumerate(_STATIONS):
        for name in names:
            _at2(tmp_path / f"event{i % 2}" / name)
    assert len(records.pairs([tmp_path])) == len(_STATIONS)


_PEER = """ -- Summary of PEER Ground Motion Database Search Criteria --
Spectral Ordinate:,SRSS

 -- Summary of Metadata of Selected Records --
 Result ID, Spectral Ordinate, Record Sequence Number, MSE, Scale Factor, Earthquake Name,\
 Horizontal-1 Acc. Filename, Horizontal-2 Acc. Filename, Vertical Acc. Filename
1,SRSS,6,0.0511,1.2500,"Imperial Valley-02", RSN6_A180.AT2, RSN6_A270.AT2, RSN6_A-UP.AT2
2,SRSS,77,0.0600,0.5000,"San Fernando", RSN77_B164.AT2, RSN77_B254.AT2,-----

These records were obtained from the NGA-West2 On-Line Ground-Motion Database Tool
"""
_CS = (
    "To download the time series, see the documentation \n \nof the data base \n \n"
    "Record Number \t Record Sequence Number \t Scale Factor \t File Name Dir. 1 \t"
    " File Name Dir. 2 \t URL 1 \t URL 2 \n"
    "1 \t 6 \t   1.25 \t IMP/RSN6_A180.AT2 \t IMP/RSN6_A270.AT2 \t http://a \t http://b \n"
    "2 \t 77 \t   0.50 \t RSN77_B164.AT2 \t RSN77_B254.AT2 \t http://a \t http://b \n"
)
_LIST = "file,factor,set\nRSN6_A180.AT2,1.25,6\nRSN6_A270.AT2,1.25,6\nsub/RSN77_B164.AT2,0.5,77\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for i, name in enumerate(("RSN6_A180", "RSN6_A270", "RSN6_A-UP", "sub/RSN77_B164")):
        _at2(tmp_path / f"{name}.AT2", i)
    _at2(tmp_path / "sub" / "RSN77_B254.AT2", 9)
    return tmp_path


@pytest.mark.parametrize("text", [_PEER, _CS, _LIST], ids=["PEER", "CS_Selection", "own"])
def test_lists(text: str, folder: Path) -> None:
    path = folder / "_SearchResults.csv"
    path.write_text(text)
    found = rwmf.records.find_records([path])
    wanted = [("RSN6_A180", 1.25), ("RSN6_A270", 1.25), ("RSN77_B164", 0.5), ("RSN77_B254", 0.5)]
    assert [(item.name, item.scale) for item in found] == wanted[: len(found)]
    assert len(found) == (3 if text is _LIST else 4)
    if text is not _LIST:
        assert [(p.first.name, p.second.scale) for p in records.pairs([path])] == [
            ("RSN6_A180", 1.25),
            ("RSN77_B164", 0.5),
        ]
    # factors reach the runs
    swept = rwmf.sweep(coupled(cable={"eta_alpha": 1.0}), {"scale": [1.0]}, found)
    assert "times 1.25" in str(swept["record_format"].values[0])


def _zipped(folder: Path, path: Path, **further: str) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(folder.rglob("*")):
            archive.write(file, file.relative_to(folder))
        for name, text in further.items():
            archive.writestr(name, text)
    return path


def test_an_archive_of_peer(
    folder: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The download is the suite of its list; names in it stay in the cache."""
    place = tmp_path_factory.mktemp("downloads")
    monkeypatch.setenv("XDG_CACHE_HOME", str(place / "cache"))
    (folder / "_SearchResults.csv").write_text(_PEER)
    (folder / "_readME.txt").write_text("PEER")
    expected = rwmf.records.find_records([folder / "_SearchResults.csv"])
    path = _zipped(folder, place / "PEERNGARecords_Scaled.zip", **{"../../out.AT2": "lost"})
    for _ in range(2):
        found = rwmf.records.find_records([path])
        assert [(item.name, item.scale, item.crc32) for item in found] == [
            (item.name, item.scale, item.crc32) for item in expected
        ]
    assert all(Path(item.path).is_relative_to(place / "cache" / "rwmf") for item in found)
    assert not list(place.glob("*.AT2")) + list((place / "cache").glob("*.AT2"))
    # without the list it is a folder
    (folder / "_SearchResults.csv").unlink()
    path = _zipped(folder, place / "records.zip")
    names = [item.name for item in rwmf.records.find_records([folder])]
    assert [item.name for item in rwmf.records.find_records([path])] == names
    # a changed byte
    content = bytearray(path.read_bytes())
    content[60:90] = bytes(30)
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"records.zip: the archive cannot be read"):
        rwmf.records.find_records([path])


_BLANK = "," * 8
_REORDERED = "set;factor ; file\n6;1,25;RSN6_A180.AT2\n;;\n6;1.25;RSN6_A270.AT2\n"
_VARIANTS = {
    "blank rows of PEER": (_PEER.replace("\n2,SRSS", f"\n\n{_BLANK}\n2,SRSS"), 4),
    "title behind PEER's rows": (_PEER + '"-- Spectra --",,,,,,,,\n0.01,1,2\n0.02,1,2\n', 4),
    "blank rows of CS_Selection": (_CS.replace("2 \t 77", " \t \t\n\n2 \t 77"), 4),
    "two factors": (_CS.replace("Scale Factor", "Scale Factor (H) \t Scale Factor (V)")
                    .replace("1.25 \t", "1.25 \t 9 \t").replace("0.50 \t", "0.50 \t 9 \t"), 4),
    "PEER with semicolons": (_PEER.replace(",", ";").replace("1.2500", "1,25"), 4),
    "byte order mark": ("\ufeff" + _LIST, 3),
    "blank rows": (_LIST.replace("\nsub", "\n\n,,\n , ,\nsub"), 3),
    "semicolons, decimal commas, order": (_REORDERED + "77;0,5;sub/RSN77_B164.AT2", 3),
    "tabs": (_LIST.replace(",", "\t"), 3),
    "quotes and blanks": ('"File" , Factor,"set"\n"RSN6_A180.AT2" ,"1.25",6 \nRSN6_A270.AT2, 1.25,'
                          "6\n sub/RSN77_B164.AT2,0.5,77,\n", 3),
    "comments": ("# my suite\n" + _LIST.replace("\nsub", "\n# another station\nsub"), 3),
    "two columns": ("factor,file\n1.25,RSN6_A180.AT2\n1.25,RSN6_A270.AT2\n.5,RSN77_B164.AT2\n", 3),
}  # fmt: skip


@pytest.mark.parametrize("kind", _VARIANTS)
def test_variants_of_lists(kind: str, folder: Path) -> None:
    """Every row counts, whatever the separator and the order of the columns."""
    text, count = _VARIANTS[kind]
    path = folder / "list.csv"
    path.write_text(text, encoding="utf-8")
    wanted = [("RSN6_A180", 1.25), ("RSN6_A270", 1.25), ("RSN77_B164", 0.5), ("RSN77_B254", 0.5)]
    assert [(item.name, item.scale) for item in rwmf.records.find_records([path])] == wanted[:count]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (_LIST.replace("1.25,6", "1,25,6", 1), "line 2: 4 columns where the header has 3"),
        (_LIST.replace("1.25,6", '"1,25",6', 1), "line 2: .*factor = '1,25'"),
        (_LIST.replace("1.25,6", "125 %,6", 1), "line 2: .*factor = '125 %'"),
        (_LIST.replace("factor", "factor (%)"), "line 1: the list has no column factor"),
        (_LIST.replace("file", "path"), "line 1: the list has no column file"),
        (_LIST.replace("set", "factor"), "line 1: the column factor is given twice"),
        (_LIST.replace("set", "weight"), "line 1: the list has the column weight"),
        (_LIST.replace("set", "unit"), "line 1: the list has the column unit"),
        (_LIST + "list.csv,1,8\n", "is a list in a list"),
        ("file;factor\nRSN6_A180.AT2;1.234,5\n", "line 2: .*'1.234,5'"),
        (_CS.replace("Scale Factor", "Scale Factor (V)"), "no column Scale Factor"),
        (_PEER.replace("\nThese", "\nThese\n3,SRSS,8,0,1,Kobe,RSN6_A180.AT2,-,-\nX"),
         "line 10: names a record below the end of the list, line 9"),
        (_LIST.replace("sub/RSN77_B164", "twice"), "twice.AT2: .* differ: name one"),
        (_PEER.replace("1.2500", "abc"), "line 6: the header has Scale Factor = 'abc'"),
        (_PEER.replace("1.2500", "-1"), "line 6: .*must be a number > 0"),
        (_PEER.replace("A270", "X"), "line 6: RSN6_X.AT2: the file is not in the folder"),
        (_PEER.replace("RSN77_B164.AT2, RSN77_B254.AT2", "-----,-----"), "line 7: names no file"),
        (_PEER.replace(',"San Fernando", RSN77_B164.AT2, RSN77_B254.AT2,-----', ""),
         "line 7: 5 columns"),
        (_PEER.replace(" Scale Factor,", ""), "no column Scale Factor"),
    ],
)  # fmt: skip
def test_lists_that_are_refused(text: str, message: str, folder: Path) -> None:
    for i in range(2):
        _at2(folder / f"f{i}" / "twice.AT2", i)
    path = folder / "list.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message) as caught:
        rwmf.records.find_records([path])
    assert str(path) in str(caught.value)


def _target(tmp_path: Path) -> Path:
    path = tmp_path / "target.csv"
    path.write_text("T (s),Sa (g)\n0.1,1.5\n0.5,1.5\n2.0,0.4\n")
    return path


# rows of the target above in other quantities and units
_G = 9.81
_TARGETS: dict[str, tuple[float, float, float]] = {
    # header: period or frequency of 1 s or 1 Hz, its power; acceleration of 1 g
    "": (1.0, 1, 1.0),
    "Period (s),Sa (m/s2)": (1.0, 1, _G),
    "T [s],PSA [cm/s^2]": (1.0, 1, 100 * _G),
    "T;Sa (M/SEC/SEC)": (1.0, 1, _G),
    "T_s,Sa_m_s2": (1.0, 1, _G),
    "Period (s) Spectral acceleration (gal)": (1.0, 1, 100 * _G),
    "# T (s), Sa (%g)": (1.0, 1, 100.0),
    "Period (ms),Sa (g)": (1000.0, 1, 1.0),
    "f (Hz),Sa (g)": (1.0, -1, 1.0),
    "frequency,PSA": (1.0, -1, 1.0),
    "omega (rad/s),Sa": (2 * math.pi, -1, 1.0),
    "T,Sa(5%)\ns,m/s2": (1.0, 1, _G),
    "# 5 % damping\nT,UHS": (1.0, 1, 1.0),
}


@pytest.mark.parametrize(
    ("head", "is_swapped"),
    [
        *((head, False) for head in _TARGETS),
        *((head, True) for head in _TARGETS if "," in head and "#" not in head),
    ],
)
def test_targets_are_read_by_their_units(head: str, is_swapped: bool, tmp_path: Path) -> None:
    mark = ";" if ";" in head else ","
    time, power, unit = _TARGETS[head]
    rows = [(time * t**power, unit * sa) for t, sa in ((0.1, 1.5), (0.5, 1.2), (2.0, 0.4))]
    if is_swapped:
        head = "\n".join(",".join(reversed(line.split(","))) for line in head.split("\n"))
        rows = [row[::-1] for row in rows]
    path = tmp_path / "target.csv"
    lines = [mark.join(f"{value!r}" for value in row) for row in rows]
    text = "\n".join([*([head] if head else []), *lines])
    path.write_text(text.replace(".", ",") if mark == ";" else text)
    given = [[0.1, 0.5, 2.0], [1.5, 1.2, 0.4]]
    wanted, found = (records.select([_motion(1)], target, (0.2, 1.5), limits=(1e-3, 1e3))
                     for target in (given, path))  # fmt: skip
    np.testing.assert_allclose(found.target, wanted.target, rtol=1e-12)
    assert found.records[0].scale == pytest.approx(wanted.records[0].scale, rel=1e-12)


test_targets_that_are_refused = refused_files(
    "target.csv",
    lambda path: records.select([_motion(1)], path, (1.1, 1.5)),
    *((f"{head}\n1,1\n2,1", "line 1: the columns are ") for head in (
        "T,log10(Sa)", "log10(T),Sa", "T,ln Sa", "T,PSV (cm/s)", "T,Sd", "T,Sa [furlong]",
        "T (m),Sa (g)", "# Vibration period (weeks), Sa (g)", "T,Sa furlongs", "T,sigma lnSa",
    )),
    ("# period in ms\nT,Sa (g)\n1,1\n2,1", "line 1: states ms"),
    ("# all in m/s2\n1,1\n2,1", "line 1: states m/s2"),
    ("T,Sa (2% damped)\n1,1\n2,1", "line 1: states 2 % damping, where damping = 0.05"),
    ("x,y\n1,1\n2,1", "line 1: the columns are x,y"),
    ("T,Sa,Sa84\n1,1,1\n2,1,1", "line 2: has 3 columns|line 1: the columns"),
    ("T,Sa\n1,1\nnan,2\n2,1", "line 3: nan,2"),
    ("T,Sa\n1,1\nT,PSV\n2,1", "line 3: T,PSV"),
    ("T,Sa\n1,1\n1,2\n2,1", "the period 1 s is given twice, again in line 3"),
    ("1,5,0,3\n", "line 1: has 4 columns"),
    ("T,Sa\n0,1\n1,1", "line 2: 0,1: must be two finite numbers > 0"),
)  # fmt: skip


def test_a_target_of_many_g_warns() -> None:
    with pytest.warns(rwmf.RwmfWarning, match="largest pseudo-acceleration is 9 g: is it in g"):
        records.select([_motion(1)], [[0.1, 2.0], [9.0, 8.0]], (0.2, 1.5), limits=(1e-3, 1e3))


@pytest.mark.parametrize("is_paired", [False, True])
def test_the_mean_over_the_band_is_the_target(is_paired: bool, tmp_path: Path) -> None:
    motions = [_motion(seed) for seed in range(6)]
    named = [
        rwmf.Motion(item.values * (1 + i), dt=_DT, unit="g", name=f"q{i // 2}_{'xy'[i % 2]}")
        for i, item in enumerate(motions)
    ]
    found = records.select(named, _target(tmp_path), (0.2, 1.5), is_paired=is_paired,
                           limits=(1e-3, 1e3))  # fmt: skip
    assert len(found.records) == 6
    group = 2 if is_paired else 1
    logs = np.log(found.spectra / found.target).reshape(-1, group, found.periods.size).mean(axis=1)
    np.testing.assert_allclose(logs.mean(axis=1), 0, atol=1e-12)
    assert found.misfit == pytest.approx(math.sqrt((logs.mean(axis=0) ** 2).mean()), rel=1e-9)
    # the spectra are those of the scaled records
    sa = rwmf.records.intensity(
        found.records[0], "pseudo_acceleration", period=float(found.periods[7])
    )
    assert found.spectra[0, 7] == pytest.approx(sa / 9.81, rel=1e-12)
    if is_paired:
        factors = [item.scale for item in found.records]
        assert factors[0::2] == factors[1::2]


def test_the_choice_is_greedy(tmp_path: Path) -> None:
    """Each prefix of a choice is the choice of fewer; a record like the target comes first."""
    target = _target(tmp_path)
    motions = [_motion(seed) for seed in range(7)]
    chosen = records.select(motions, target, (0.2, 1.5), 5, limits=(1e-3, 1e3))
    for n in (1, 3):
        fewer = records.select(motions, target, (0.2, 1.5), n, limits=(1e-3, 1e3))
        assert fewer.names == chosen.names[:n]
    alone = [records.select([item], target, (0.2, 1.5), limits=(1e-3, 1e3)).misfit
             for item in motions]  # fmt: skip
    assert chosen.names[0] == motions[int(np.argmin(alone))].name


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"band": (0.01, 1.0)}, r"band = \(0.01, 1\): must be within the periods of the target"),
        ({"band": (1.0, 0.5)}, "band = .*the smaller first"),
        ({"limits": (0.5, 1.0, 2.0)}, "limits = .*must be two numbers"),
        ({"damping": 1.5}, r"damping = 1.5: must be in \[0, 1\)"),
        ({"damping": -0.1}, r"damping = -0.1: must be in \[0, 1\)"),
        ({"target_spectrum": [[0.1, np.float64(0.0)], [1, 1]]}, "target = 0.0 at position 1"),
        ({"limits": (100.0, 200.0)}, "0 of 3 records need factors within"),
        ({"n": 4, "limits": (1e-3, 1e3)}, "3 of 3 records"),
        ({"target_spectrum": [[0.1, 2.0], [1.0, -1.0]]}, "target"),
    ],
)
def test_refused_choices(options: dict[str, object], message: str, tmp_path: Path) -> None:
    given: dict[str, object] = {"target_spectrum": _target(tmp_path), "band": (0.2, 1.5)}
    with pytest.raises(InputError, match=message):
        records.select([_motion(i) for i in range(3)], **given | options)  # type: ignore[arg-type]


def test_the_commands(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    suite, picture = folder / "out" / "suite.csv", folder / "p.png"
    suite.parent.mkdir()
    words = [
        "records",
        "select",
        str(folder),
        "--target",
        str(_target(folder)),
        "--band",
        "0.2,1.5",
    ]
    options = ["--n", "1", "--pairs", "--limits", "0.001,1000", "--out", str(suite), "--out",
               str(picture), "--json"]  # fmt: skip
    assert cli.main([*words, *options]) == 0
    told = json.loads(capsys.readouterr().out)
    found = rwmf.records.find_records([suite])
    assert [(item.path, item.scale) for item in found] == [
        (item["file"], item["factor"]) for item in told["records"]
    ]
    assert picture.stat().st_size > 1000
    assert cli.main(["records", "info", *(item.path for item in found), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)["records"]
    for item, fact in zip(found, facts, strict=True):
        for key, kind in {
            "peak_acceleration_m_s2": "peak_acceleration",
            "peak_velocity_m_s": "peak_velocity",
            "peak_displacement_m": "peak_displacement",
            "arias_m_s": "arias",
            "duration_5_95_s": "duration_5_95",
            "cav_m_s": "cav",
        }.items():
            assert fact[key] == rwmf.records.intensity(item.path, kind)
        assert (fact["dt_s"], fact["samples"]) == (_DT, 300)
    assert cli.main(["records", "info", str(suite.parent), "--json"]) == 2
    assert cli.main([*words, "--out", str(folder / "target.csv")]) == 2


@pytest.mark.parametrize("pause", [0.5, 10.0, 7.77])
def test_a_sequence_keeps_its_parts(pause: float) -> None:
    main, after = _motion(1), _motion(2, 150)
    joined = records.sequence(main, after, pause, (1.2, -0.7))
    grid = np.unique(np.concatenate([main.times, main.times[-1] + pause + after.times]))
    wanted = 1.2 * np.interp(grid, main.times, main.values, right=0) - 0.7 * np.interp(
        grid - main.times[-1] - pause, after.times, after.values, left=0, right=0
    )
    np.testing.assert_allclose(np.interp(grid, joined.times, joined.values), wanted, atol=1e-9)
    assert (joined.dt == _DT) == (pause != 7.77)
    assert joined.times[-1] == pytest.approx(main.times[-1] + pause + after.times[-1])
    quiet = (joined.times > main.times[-1] + 0.1) & (joined.times < main.times[-1] + pause - 0.1)
    assert not joined.values[quiet].any()


def test_a_sequence_of_different_files(tmp_path: Path) -> None:
    slow = rwmf.Motion([0.0, 100.0, 0.0], dt=0.05, unit="cm/s2")
    fast = rwmf.Motion([0.0, 3.0, 0.0], times=[1.0, 1.01, 1.03], unit="m/s2")
    joined = records.sequence(slow, fast, 2.0)
    assert (joined.unit, joined.dt) == ("m/s2", None)
    np.testing.assert_allclose(joined.times, [0, 0.05, 0.1, 0.15, 2.09, 2.1, 2.11, 2.13])
    np.testing.assert_allclose(joined.values, [0, 1, 0, 0, 0, 0, 3, 0])
    with pytest.raises(InputError, match="one motion is in g, the other is not"):
        records.sequence(slow, _motion(1), 2.0)
    with pytest.raises(InputError, match=r"pause = 0.01: must be at least"):
        records.sequence(slow, fast, 0.01)
    files = _at2(tmp_path / "a.AT2", 1), _at2(tmp_path / "b.AT2", 2)
    out = tmp_path / "sequence.txt"
    records.sequence(*files, 4.0, (1.0, 0.5)).write(out)
    joined = records.sequence(_motion(1), _motion(2), 4.0, (1.0, 0.5))
    assert np.array_equal(records.read(out, unit="g", dt=_DT).values, joined.values)


_YIELDING = {"F_y_over_m_s_g": 0.08, "hardening": 0.05}


def _frame(motion: rwmf.Motion) -> rwmf.Case:
    return rwmf.Case(
        frame={"T_s": 0.6, "xi_s": 0.05},
        yielding=_YIELDING,
        motion=motion,
        solver={"method": "dop853", "rtol": 1e-8},
    )


def test_the_state_continues_through_a_sequence() -> None:
    """Residual drift of the main shock remains in the pause and is where the aftershock starts."""
    main = _motion(3)
    main = rwmf.Motion(main.values * 0.6, dt=_DT, unit="g")
    pause = 60.0
    both = rwmf.simulate(_frame(records.sequence(main, main, pause)), dt=_DT)
    alone = rwmf.simulate(_frame(main), dt=_DT)
    n = alone.sizes["time"]
    np.testing.assert_allclose(both["u_s"][:n], alone["u_s"], rtol=0, atol=1e-7)
    begin = float(main.times[-1]) + pause
    residual = float(both["u_s"].sel(time=begin, method="nearest"))
    assert abs(residual) > 1e-3
    # a fresh structure would repeat its displacements, and the damaged one does not
    later = both["u_s"].sel(time=slice(begin - 1e-9, None)).values
    assert abs(later[:n] - alone["u_s"].values[: later.size]).max() > 1e-3


def test_a_wall_that_rests_in_the_pause_lifts_again() -> None:
    """The run goes on at rest; an elastic structure answers the aftershock as a fresh one."""
    shock = rwmf.Motion(_motion(5).values, dt=_DT, unit="g")
    case = coupled(cable={"eta_alpha": 1.0}, impact={"e": 0.5}).replace(motion=shock)
    case = case.replace(solver={"t_end": None})
    alone = rwmf.simulate(case, dt=_DT)
    both = rwmf.simulate(case.replace(motion=records.sequence(shock, shock, 100.0)), dt=_DT)
    assert int(both["lift_offs"]) > int(alone["lift_offs"])
    begin = float(shock.times[-1]) + 100.0
    before = both["theta"].sel(time=begin, method="nearest")
    assert float(before) == 0.0
    second = both["u_s"].sel(time=slice(begin - 1e-9, None)).values
    np.testing.assert_allclose(second, alone["u_s"].values[: second.size], rtol=0, atol=1e-6)
