"""Names of files that are markup, code or signs of a format: no writer takes them as such."""

import ast
import csv
import io
import json
import random
import sys
import zipfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
import rwmf
import xarray as xr
from checkout import run_words
from rwmf import cli
from rwmf.assess.loss import nrml_text, write_pelicun
from rwmf.assess.table import table_of, write_dataset
from rwmf.explorer.model import encode, start
from rwmf.kernel.names import readable, xml_text

# signs of Python, shells, formats, HTML, XML, CSV and comments
MARKUP = "-q\"\"\"+open('pwned','w').name+'''\\<script>x<&amp;]]>%(y)s{z},;#é"
# separators of lines for some readers of text
LINES = "a\u2028b\x85c"
# bytes that are not UTF-8, and control characters, which namelists refuse
BYTES = "a\udcff\x1b[31m\x01b"
CASE = """&wall h = 5.0, b = 1.2, m_w = 40e3 /
&frame m_s = 40e3, T_s = 0.5, xi_s = 0.05 /
&cable eta_0 = 1.0 /
&impact rule = 'coupled' /
&motion kind = 'record', file = '{}', unit = 'g' /
&solver method = 'dop853', rtol = 1e-4, t_end = 0.4 /
&spectrum T_s = 0.5, 1.0 /
"""
HEAD = ['# rwmf {"intensity": "peak_acceleration"}', "design,intensity,u_s_max,status"]
SUITE = ["--records", "./{n}.txt", "--unit", "g"]


def _python(path: Path, name: str) -> None:
    plain, found = (
        ast.parse(item.read_text(encoding="utf-8")) for item in (path.with_name("plain.py"), path)
    )
    assert [ast.dump(x) for x in found.body[1:]] == [ast.dump(x) for x in plain.body[1:]]
    assert str(ast.get_docstring(found)).startswith(f"Building of ./{name}.open.nml, written by")


def _xml(path: Path, name: str) -> None:
    found = ElementTree.parse(path)
    assert not [item for item in found.iter() if item.tag.lower().endswith("script")]


def _nrml(path: Path, name: str) -> None:
    ids = [item.get("id") for item in ElementTree.parse(path).iter() if "Function" in item.tag]
    assert ids == [xml_text(readable(name))]


def _fmu(path: Path, name: str) -> None:
    with zipfile.ZipFile(path) as archive:
        found = ElementTree.fromstring(archive.read("modelDescription.xml"))
        assert found.get("modelName") == xml_text(name)
        assert all(part.isascii() for part in archive.namelist())


class _Tags(HTMLParser):
    """Tags of a text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, _: object) -> None:
        self.found.add(tag)


def _html(path: Path, name: str) -> None:
    assert "script" not in _Tags(path.read_text(encoding="utf-8")).found


def _csv(path: Path, name: str) -> None:
    with path.open(encoding="utf-8", newline="") as stream:
        lines = stream.read().split("\n")
    rows = list(csv.reader(line for line in lines if line and not line.startswith("#")))
    assert len(rows) > 1
    assert {len(row) for row in rows} == {len(rows[0])}


def _netcdf(path: Path, name: str) -> None:
    with xr.open_dataset(path, engine="h5netcdf") as found:
        assert found.sizes


def _any(path: Path, name: str) -> None:
    assert path.stat().st_size > 100


# words of a command, its file and the check of that file
EXPORTERS: dict[str, tuple[list[str], str, Callable[[Path, str], None]]] = {
    "script": (["export", "./{n}.open.nml", "--out", "./{n}.py"], "{n}.py", _python),
    "unit": (["export", "./{n}.nml", "--out", "./{n}.fmu"], "{n}.fmu", _fmu),
    "film": (["animate", "./{n}.nml", "--out", "./{n}.gif", "--fps", "2"], "{n}.gif", _any),
    "figure": (["run", "./{n}.nml", "--out", "./{n}.svg"], "{n}.svg", _xml),
    "loops": (["run", "./{n}.nml", "--loops", "./{n}.svg"], "{n}.svg", _xml),
    "tables": (["run", "./{n}.nml", "--out", "."], "{n}.summary.csv", _csv),
    "spectrum": (["spectrum", "./{n}.nml", "--out", "./{n}.csv"], "{n}.csv", _csv),
    "curve": (["pushover", "./{n}.nml", "--out", "./{n}.csv"], "{n}.csv", _csv),
    "facts": (["records", "info", "./{n}.txt", "--unit", "g", "--out", "./{n}.svg"],
              "{n}.svg", _xml),
    "runs": (["stripes", "./{n}.nml", *SUITE, "--levels", "0.1", "--out", "./{n}.csv",
              "--out", "./{n}.svg"], "{n}.csv", _csv),
    "study": (["study", "wall", "./{n}.nml", *SUITE, "--T_s", "0.5,1", "--out", "./{n}.nc"],
              "{n}.nc", _netcdf),
    "design": (["design", "./{n}.nml", *SUITE, "--vary", "b=1:2", "--target", "u_s_max=9@50",
                "--cost", "b=1", "--designs", "4", "--out", "./{n}.html"], "{n}.html", _html),
    "fragility": (["fragility", "./{n}.runs.csv", "--out", "./{n}.xml", "--limit", "0.01",
                   "--out", "./{n}.svg"], "{n}.xml", _nrml),
}  # fmt: skip


def _prepare(folder: Path, name: str) -> None:
    record = "".join(f"{0.02 * i:.2f} {0.3 * (-1) ** (i // 10)}\n" for i in range(40))
    file = name if name != BYTES else "record"
    for item in (name, file, "plain"):
        (folder / f"{item}.txt").write_text(record, encoding="utf-8")
    for item in (name, "plain"):
        text = CASE.format(f"{file}.txt".replace("'", "''"))
        (folder / f"{item}.nml").write_text(text, encoding="utf-8")
        without_spectrum = text.partition("&spectrum")[0]
        (folder / f"{item}.open.nml").write_text(without_spectrum, encoding="utf-8")
        quoted = readable(name).replace('"', '""')
        rows = [f'"{quoted}",{x},{u},ok' for x, u in ((1, 0.005), (2, 0.02), (3, 0.008), (4, 0.03))]
        (folder / f"{item}.runs.csv").write_text("\n".join([*HEAD, *rows, ""]), encoding="utf-8")


def _run(words: list[str]) -> tuple[int, str]:
    """Return status and error output of a command; other texts than UTF-8 are possible there."""
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()) as error:
        return cli.main(words), error.getvalue()


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(MARKUP, id="markup"),
        pytest.param(LINES, id="lines", marks=pytest.mark.slow),
        pytest.param(BYTES, id="bytes", marks=pytest.mark.slow),
    ],
)
@pytest.mark.parametrize("exporter", EXPORTERS)
def test_no_writer_takes_a_name_for_markup(
    exporter: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    words, file, check = EXPORTERS[exporter]
    monkeypatch.chdir(tmp_path)
    _prepare(tmp_path, name)
    if exporter == "script":
        assert _run([word.format(n="plain") for word in words]) == (0, "")
    status, error = _run([word.format(n=name) for word in words])
    if status == 2:
        # tables name their records: one line refuses a name that is not printable
        assert not name.isprintable(), error
        assert set(words) & {"--records", "info"}
        assert error.count("\n") == 1
    else:
        assert status == 0, error
        check(tmp_path / file.format(n=name), name)
    assert not (tmp_path / "pwned").exists()


def test_names_in_notebooks_and_in_the_explorer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    _prepare(tmp_path, MARKUP)
    case = rwmf.Case.from_namelist(f"{MARKUP}.nml")
    for shown in (case, case.motion, rwmf.simulate(case)):
        assert "script" not in _Tags(shown._repr_html_()).found
    found = encode(start(case, []))
    assert (found.isascii(), json.loads(found)["name"]) == (True, f"{MARKUP}.nml")


def test_a_name_does_not_steer_the_terminal(tmp_path: Path) -> None:
    """Control characters are printed as numbers."""
    done = run_words([sys.executable, "-m", "rwmf", "check", "missing\x1b[31m\x9b.nml"], tmp_path)
    assert done.returncode == 2
    assert "missing\\x1b[31m\\x9b.nml: the file does not exist" in done.stderr


def test_datasets_with_any_name_are_written(tmp_path: Path) -> None:
    """NetCDF holds UTF-8: bytes of a name that are not appear as their numbers."""
    curves = rwmf.fragility(
        {"design": [BYTES] * 4 + ["other"] * 4, "intensity": [1.0, 2.0, 3.0, 4.0] * 2,
         "u": [0.005, 0.02, 0.008, 0.03] * 2, "status": ["ok"] * 8}, 0.01
    )  # fmt: skip
    curves.attrs["warnings"] = f"{BYTES}: a warning"
    write_dataset(curves, tmp_path / "curves.nc")
    with xr.open_dataset(tmp_path / "curves.nc", engine="h5netcdf") as found:
        assert found["design"].values.tolist() == [readable(BYTES), "other"]
        assert found.attrs["warnings"] == readable(f"{BYTES}: a warning")
        xr.testing.assert_equal(found["median"].drop_vars("design"),
                                curves["median"].drop_vars("design"))  # fmt: skip


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("words", [["fragility", "t.nc", "--limit", "1"],
                                   ["risk", "t.nc", "--hazard", "1e-3,2"],
                                   ["sweep", "s.nml", "--out", "t.nc"]])  # fmt: skip
def test_a_damaged_file_is_an_error_of_input(
    words: list[str], seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bytes of a NetCDF file that have changed: one line that names the file."""
    monkeypatch.chdir(tmp_path)
    _prepare(tmp_path, "case")
    Path("s.nml").write_text("&sweep case = 'case.nml' /\n&grid b = 1.2, 1.3 /\n", "ascii")
    values = {"intensity": [1.0, 2.0], "u": [0.1, 0.2], "status": ["ok", "ok"]}
    write_dataset(table_of(values, {}), "t.nc")
    content = bytearray(Path("t.nc").read_bytes())
    rng = random.Random(seed)
    for _ in range(40):
        content[rng.randrange(len(content))] = rng.randrange(256)
    Path("t.nc").write_bytes(content)
    status, error = _run(words)
    assert status == 2
    assert "t.nc" in error.splitlines()[-1]


def test_designs_with_similar_names_keep_their_files(tmp_path: Path) -> None:
    """Names that differ in signs only do not overwrite each other, nor leave the folder."""
    names = ["a b", "a/b", "../a;b"]
    table = table_of(
        {"design": names, "intensity": [1.0] * 3, "storey_1_drift_max": [0.01, 0.02, 0.03]}, {}
    )
    written = [path for path, _ in write_pelicun(table, tmp_path / "demands")]
    assert sorted(written) == sorted((tmp_path / "demands").iterdir())
    drifts = [float(path.read_text("utf-8").split(",")[-1]) for path in written]
    assert drifts == [0.01, 0.02, 0.03]


def test_texts_of_a_model_for_openquake_are_escaped() -> None:
    """Attributes of a foreign file: a quantity becomes a word, the version a text."""
    curves = rwmf.fragility(
        {"design": ["a<b"] * 4, "intensity": [1.0, 2.0, 3.0, 4.0],
         "u": [0.005, 0.02, 0.008, 0.03], "status": ["ok"] * 4}, 0.01
    )  # fmt: skip
    curves.attrs |= {"quantity": 'u"<x> y', "version": "<1>\x01", "intensity": "peak_acceleration"}
    found = ElementTree.fromstring(nrml_text(curves))
    texts = {item.tag.partition("}")[2]: item for item in found.iter()}
    assert texts["description"].text == "rwmf <1>\\x01"
    assert texts["limitStates"].text == texts["params"].get("ls") == "u_x_y_0.01"
    assert texts["fragilityFunction"].get("id") == "a<b"
