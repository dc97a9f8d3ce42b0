"""Server of `rwmf explore`: authorisation, requests and answers."""

from __future__ import annotations

import base64
import json
import socket
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from checkout import ROOT, Runner
from explorer_page import FIG12
from page_client import ENDLESS, Client, asked, received, served
from rwmf import Case
from rwmf.explorer import model
from rwmf.explorer.questions import Question, case_of_preset, given
from rwmf.explorer.server import PageServer
from rwmf.run import simulation as _simulation

# the kernel is told to stop every 0.05 s, and polls between its steps [s]
SOON = 2.0


def _with(start: dict[str, Any], **groups: dict[str, Any] | None) -> dict[str, Any]:
    """Build a question about the case with other keys."""
    state = {name: dict(keys) for name, keys in start["state"].items()}
    for name, keys in groups.items():
        if keys is None:
            state.pop(name)
        else:
            state.setdefault(name, {}).update(keys)
    return {"groups": state}


def _floats(text: str) -> np.ndarray[Any, Any]:
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 200),
        ({"X_Token": None}, 403),
        ({"X_Token": "x" * 32}, 403),
        ({"X_Token": "\xe9"}, 403),
        ({"Host": "rocking.example:80"}, 403),
        ({"Host": None}, 403),
        ({"Origin": "http://rocking.example"}, 403),
        ({"Origin": "null"}, 403),
        ({"Sec_Fetch_Site": "cross-site"}, 403),
        ({"Sec_Fetch_Site": "same-site"}, 403),
        ({"Sec_Fetch_Site": "same-origin"}, 200),
        ({"Content_Length": "70000"}, 413),
        ({"Content_Length": "9" * 5000}, 413),
        ({"Content_Length": "-1"}, 411),
        ({"Content_Length": None}, 411),
        ({"Transfer_Encoding": "chunked"}, 411),
    ],
)
def test_only_the_page_itself_is_answered(
    client: Client, headers: dict[str, str | None], status: int
) -> None:
    assert client.post("/api/start", b"{}", **headers)[0] == status


def test_own_origin_is_answered(client: Client) -> None:
    for host in ("127.0.0.1", "localhost"):
        origin = f"http://{host}:{client.port}"
        assert client.post("/api/start", b"{}", Origin=origin)[0] == 200


@pytest.mark.parametrize(
    "path",
    ["/../server.py", "/%2e%2e/server.py", "/vendor/../../server.py", "//etc/passwd", "/vendor",
     "/presets/block.nml", "/index.html/", "/\\..\\server.py", "/api/start", "/%00"],
)  # fmt: skip
def test_files_of_the_page_and_no_others(client: Client, path: str) -> None:
    assert client.request("GET", path, None, {})[0] == 404


def test_files_need_the_right_host(client: Client) -> None:
    assert client.request("GET", "/", None, {"Host": "rocking.example"})[0] == 403
    for path in ("/", "/index.html", "/main.js", "/vendor/uPlot.iife.js", "/app.css?x=1"):
        assert client.request("GET", path, None, {})[0] == 200


def test_other_methods_are_not_there(client: Client) -> None:
    for method in ("PUT", "DELETE", "OPTIONS", "HEAD", "TRACE"):
        status, content = client.request(method, "/", None, {})
        assert status == 501
        assert content == b"" if method == "HEAD" else method in json.loads(content)["error"]


def test_headers_forbid_everything_foreign(both: tuple[PageServer, Client]) -> None:
    with socket.create_connection(("127.0.0.1", both[1].port), 10) as raw:
        host = f"127.0.0.1:{both[1].port}"
        raw.sendall(f"GET / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
        text = received(raw).decode()
    head, _, body = text.partition("\r\n\r\n")
    with socket.create_connection(("127.0.0.1", both[1].port), 10) as raw:
        raw.sendall(b"PUT / HTTP/1.1\r\nHost: x\r\n\r\n")
        refused = received(raw).decode()
    assert refused.startswith("HTTP/1.1 501")
    assert "default-src 'none'" in refused
    for word in ("default-src 'none'", "frame-ancestors 'none'", "nosniff", "no-referrer",
                 "Cross-Origin-Resource-Policy: same-origin"):  # fmt: skip
        assert word in head
    assert "unsafe" not in head
    # the token is in the address of the page and in no served file
    assert both[1].token not in text
    assert "http" not in body.replace("http-equiv", "")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "JSON"),
        (b"\xff\xfe", "JSON"),
        (b"[" * 30000, "JSON"),
        (b'{"groups": {"frame": {"T_s": NaN}}}', "JSON"),
        (b"[]", "object"),
        (b"{}", "groups"),
        (b'{"groups": {}, "script": 1}', "script"),
        (b'{"groups": {"frames": {}}}', "no group"),
        (b'{"groups": {"frame": 1}}', "no group"),
        (b'{"groups": {"motion": {"file": "/etc/passwd"}}}', "'file'"),
        (b'{"groups": {"vertical": {"file": "/etc/passwd"}}}', "'file'"),
        (b'{"groups": {"frame": {"b": 1}}}', "'b'"),
        (b'{"groups": {"frame": {"T_s": "1"}}}', "frame.T_s"),
        (b'{"groups": {"frame": {"T_s": true}}}', "frame.T_s"),
        (b'{"groups": {"frame": {"T_s": 1e999}}}', "frame.T_s"),
        (b'{"groups": {"frame": {"T_s": [1]}}}', "frame.T_s"),
        (b'{"groups": {"output": {"energy": 1}}}', "output.energy"),
        (b'{"groups": {"solver": {"max_steps": 1.5}}}', "solver.max_steps"),
        (b'{"groups": {"model": {"formulation": "wrong"}}}', "model.formulation"),
        (b'{"groups": {"solver": {"accuracy_of": ["x"]}}}', "solver.accuracy_of"),
        (b'{"groups": {"solver": {"accuracy_of": "a b"}}}', "solver.accuracy_of"),
        (b'{"groups": {"spectrum": {"T_s": []}}}', "spectrum.T_s"),
        (b'{"groups": {"spectrum": {"quantities": ["a\'/ &wall"]}}}', "spectrum.quantities"),
        (b'{"groups": {}, "points": 100000}', "points"),
        (b'{"groups": {}, "quick": 1}', "quick"),
        (b'{"groups": {}, "record": "9"}', "record"),
        (b'{"groups": {}, "record": "../1"}', "record"),
        (b'{"groups": {}, "record": "\\u0661"}', "an uploaded record"),
        (b'{"groups": {}, "record": "97"}', "upload it again"),
        (b'{"groups": {}, "groups": {}}', "twice"),
        (b'{"groups": {"frame": {"T_s": 1, "T_s": 2}}}', "twice"),
        (b'{"groups": {"frame": {"T_S": 1}}}', "'T_S'"),
        (b'{"groups": {"FRAME": {"T_s": 1}}}', "no group"),
        (b'{"groups": {"solver": {"max_steps": 2147483648}}}', "solver.max_steps"),
    ],
)
def test_garbage_is_refused(client: Client, body: bytes, words: str) -> None:
    status, content = client.post("/api/history", body)
    assert status == 400
    assert words in json.loads(content)["error"]


@pytest.mark.parametrize(
    ("groups", "words"),
    [
        ({"frame": {"T_s": -1.0}}, "&frame: T_s = -1.0: must be"),
        ({"link": {"L": 1.0}}, "&link: must not be given"),
        ({"frame": None}, "&"),
        ({"motion": {"kind": "record"}}, "&motion"),
    ],
)
def test_what_the_kernel_refuses_is_said_in_its_words(
    client: Client, start: dict[str, Any], groups: dict[str, Any], words: str
) -> None:
    status, message = client.problem("/api/history", _with(start, **groups))
    assert status == 422
    assert message.startswith(words)
    assert "line" not in message
    assert "fig12" not in message


def test_a_quantity_that_is_none_is_refused(client: Client, start: dict[str, Any]) -> None:
    status, message = client.problem("/api/spectrum", _with(start) | {"quantity": "x'y"})
    assert (status, "x'y" in message) == (422, True)


CASES = ("fig13_elcentro_slender_wall", "storeys_full", "study_block",
         "fig06_mild_frame_alone_one_sine", "p_delta_collapse")  # fmt: skip


def _summary(path: Path) -> dict[str, Any]:
    """Return the output of `rwmf run --json`."""
    with _simulation.start(Case.from_namelist(path)) as run:
        return run.summary()


@pytest.mark.parametrize("name", CASES)
def test_numbers_are_those_of_a_run(name: str, tmp_path: Path, record_folder: Path) -> None:
    """The namelist that is saved gives `rwmf run` the same digits."""
    del record_folder
    with served(Case.from_namelist(ROOT / "inputs" / f"{name}.nml")) as (_, client):
        state = client.ask("/api/start", {})["state"]
        if "frame" in state and "T_s" in state["frame"]:
            state["frame"]["T_s"] = 0.83
        found = client.ask("/api/history", {"groups": state})
        spectrum = client.ask("/api/spectrum", {"groups": state, "points": 20})
    path = tmp_path / "explored.nml"
    path.write_text(found["namelist"], encoding="utf-8")
    expected = _summary(path)
    shown = {key: text for key, text, *_ in found["numbers"]}
    same = [key for key in shown if key in expected]
    assert len(same) >= 3
    for key in same:
        value = expected[key]
        text = ("yes" if value else "no") if isinstance(value, bool) else repr(value)
        assert shown[key] == text, key
    assert np.isfinite(_floats(found["columns"]["time"])).all()
    assert _floats(spectrum["T"]).size == _floats(spectrum["values"]).size == 20


def test_spectrum_is_that_of_the_package(client: Client, start: dict[str, Any]) -> None:
    found = client.ask("/api/spectrum", _with(start) | {"points": 40})
    case = Case.from_namelist(FIG12)
    periods = np.linspace(0.05, 3.0, 40)
    expected = rwmf.spectrum(case, T_s=periods, gamma=5.0)["u_s_max"].values.ravel()
    np.testing.assert_array_equal(_floats(found["values"]), expected.astype(np.float32))
    bare = case.replace(wall=None, cable=None, impact=None, spectrum=None, frame={"gamma": None})
    alone = rwmf.spectrum(bare, T_s=periods)["u_s_max"].values
    np.testing.assert_array_equal(_floats(found["alone"]), alone.astype(np.float32))
    # the frame alone is kept, and does not depend on the wall
    again = client.ask("/api/spectrum", _with(start, wall={"b": 0.7}) | {"points": 40})
    assert again["alone"] == found["alone"]
    other = client.ask("/api/spectrum", _with(start, frame={"xi_s": 0.1}) | {"points": 40})
    assert other["alone"] != found["alone"]


def test_axis_and_gaps_of_a_block() -> None:
    """The axis is that of the kernel; the peak of a run that ended early is a gap."""
    case = case_of_preset("block")
    with served(case) as (_, client):
        state = client.ask("/api/start", {})["state"]
        found = client.ask("/api/spectrum", {"groups": state, "points": 41})
        headline = dict(client.ask("/api/history", {"groups": state})["headline"])
    assert found["axis"] == ["2π/p of the block", "its size follows, its slenderness stays"]
    assert headline["residual drift"] == "none: the wall returns"
    T, values, down = (_floats(found[name]) for name in ("T", "values", "overturned"))
    own = case.kernel.axes()["T_s"].value
    assert T[0] == pytest.approx(0.5 * own, rel=1e-6)
    assert T[-1] == pytest.approx(3 * own, rel=1e-6)
    assert 0 < down.size < 20
    assert np.array_equal(np.isnan(values), np.isin(T, down))
    assert np.nanmax(values) < 1.5


def test_a_frame_alone_is_what_returns() -> None:
    text = "&frame T_s = 1.0, xi_s = 0.05 / &motion kind = 'one_sine', a_max_g = 0.1, T_p = 1.0 /"
    found = rwmf.simulate(Case.from_text(f"{text} &solver t_end = 2.0 /"))
    assert "none: the frame returns" in found.headline()


def test_a_quick_answer_leaves_out_long_periods(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(model, "_FEW_STEPS", 100)
    case = case_of_preset("fig12_one_sine")
    found = {
        quick: model.Model(case, tmp_path).spectrum(
            Question(given(case), "", 16, "", quick), lambda _: None
        )
        for quick in (False, True)
    }
    whole, first = (_floats(found[quick]["values"]) for quick in (False, True))
    left_out = np.isnan(first)
    assert not found[False]["failed"]
    assert found[True]["failed"] == {"too_many_steps": left_out.sum()}
    assert 0 < left_out.sum() < 16
    # the other periods have the same bits
    np.testing.assert_array_equal(first[~left_out], whole[~left_out])


def test_two_pages_at_once(client: Client, start: dict[str, Any]) -> None:
    """Each client gets the answer to its request."""
    periods = np.linspace(0.3, 2.0, 8)
    alone = [client.ask("/api/history", _with(start, frame={"T_s": T}))["numbers"] for T in periods]
    found: dict[int, Any] = {}

    def page(i: int) -> None:
        found[i] = [client.ask("/api/history", _with(start, frame={"T_s": T}))["numbers"]
                    for T in periods[i::2]]  # fmt: skip

    threads = [threading.Thread(target=page, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert [found[0], found[1]] == [alone[::2], alone[1::2]]


@pytest.mark.parametrize("path", ["/api/history", "/api/cost"])
def test_a_page_that_is_closed_stops_its_run(
    client: Client, start: dict[str, Any], path: str, capfd: pytest.CaptureFixture[str]
) -> None:
    with asked(client, path, _with(start, **ENDLESS)):
        time.sleep(0.4)
    begun = time.perf_counter()
    client.ask("/api/history", _with(start))
    assert time.perf_counter() - begun < SOON
    assert capfd.readouterr().err == ""


def test_what_accuracy_costs_lets_others_in(client: Client, start: dict[str, Any]) -> None:
    question = json.dumps(_with(start, solver={"t_end": 2.0})).encode()
    content: list[bytes] = []
    thread = threading.Thread(target=lambda: content.append(client.post("/api/cost", question)[1]))
    thread.start()
    answered = 0
    while thread.is_alive() and answered < 1000:
        client.ask("/api/history", _with(start))
        answered += 1
    thread.join()
    lines = [json.loads(line) for line in content[0].splitlines()]
    result = lines[-1]["result"]
    assert answered > 5
    assert lines[-2] == {"done": lines[0]["total"], "total": lines[0]["total"]}
    assert result["reference"]["peak"] == "u_s_max_m"
    assert min(row["relative_error"] for row in result["rows"] if row["status"] == "ok") < 1e-10


def _at2(values: np.ndarray[Any, Any], dt: float) -> bytes:
    lines = ["PEER STRONG MOTION", "TEST", "ACCELERATION TIME SERIES IN UNITS OF G",
             f"NPTS= {values.size:6d}, DT= {dt:8.5f} SEC"]  # fmt: skip
    words = [f"{value:15.7E}" for value in values]
    lines += ["".join(words[i : i + 5]) for i in range(0, len(words), 5)]
    return "\n".join(lines).encode() + b"\n"


def _pulse(n: int, dt: float) -> np.ndarray[Any, Any]:
    return 0.4 * np.sin(2 * np.pi * np.arange(n) * dt) * (np.arange(n) * dt < 1.0)


_PAIRS = [(0.01 * i, x) for i, x in enumerate(_pulse(200, 0.01))]
_CUT = _at2(_pulse(50, 0.01), 0.01).replace(b"NPTS=     50", b"NPTS=     90")


@pytest.mark.parametrize(
    ("content", "query"),
    [
        (_at2(_pulse(200, 0.01), 0.01), "name=own.AT2&unit=g"),
        (b"\n".join(b"%.9g" % x for x in _pulse(200, 0.01)), "name=own.csv&unit=g&dt=0.01"),
        (b"\n".join(b"%.9g" % x for x in _pulse(200, 0.01)), "name=l'Aquila.csv&unit=g&dt=0.01"),
        (_at2(_pulse(200, 0.01), 0.01), "name=%20own%20.AT2%20&unit=g"),
        (b"t,a\n" + b"\n".join(b"%.9g,%.9g" % pair for pair in _PAIRS), "name=own.csv&unit=g"),
    ],
)  # fmt: skip
def test_an_own_record(
    client: Client,
    start: dict[str, Any],
    content: bytes,
    query: str,
    tmp_path: Path,
) -> None:
    status, answer = client.post(f"/api/record?{query}", content)
    assert status == 200, answer
    sent = json.loads(answer)
    question = _with(start, motion=None) | {"record": sent["record"]}
    question["groups"]["motion"] = sent["motion"]
    found = client.ask("/api/history", question)
    # the namelist names the record as its owner does, and lies beside it
    (tmp_path / sent["name"]).write_bytes(content)
    path = tmp_path / "explored.nml"
    path.write_text(found["namelist"], encoding="utf-8")
    expected = _summary(path)
    shown = dict(row[:2] for row in found["numbers"])
    assert shown["u_s_max_m"] == repr(expected["u_s_max_m"])


@pytest.mark.parametrize(
    ("content", "query", "status", "words"),
    [
        (b"", "name=own.csv&unit=g", 422, "own.csv"),
        (b"1 2 3\n4 5 6\n", "name=own.csv&unit=g", 422, "own.csv"),
        (b"0 1\n0 2\n", "name=own.csv&unit=g", 422, "own.csv"),
        (b"0 1\n1 nan\n", "name=own.csv&unit=g", 422, "own.csv"),
        (b"0.1\n0.2\n", "name=own.csv&unit=g", 422, "dt"),
        (b"0.1\n0.2\n", "name=own.csv&dt=0.01", 422, "unit"),
        (_CUT, "name=o.AT2&unit=g", 422, "90"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "name=picture.png&unit=g", 422, "picture.png"),
        (b"0 1\n1 2\n", "name=own.csv&unit=furlong", 422, "unit"),
        (b"0 1\n1 2\n", "name=%20%20&unit=g", 400, "name"),
        (b"0.1\n0.2\n", "name=own.csv&unit=g&dt=soon", 400, "dt"),
        (b"0.1\n0.2\n", "name=own.csv&unit=g&dt=-1", 422, "dt"),
        (b"0 1\n1 2\n", "name=..&unit=g", 400, "name"),
        (b"0 1\n1 2\n", "unit=g", 400, "name"),
    ],
)  # fmt: skip
def test_a_damaged_record(
    client: Client, content: bytes, query: str, status: int, words: str
) -> None:
    found, answer = client.post(f"/api/record?{query}", content)
    message = json.loads(answer)["error"]
    assert (found, words in message) == (status, True), message
    assert "/tmp" not in message


def test_a_record_stays_in_its_folder(both: tuple[PageServer, Client]) -> None:
    server, client = both
    status, answer = client.post("/api/record?name=../../own.csv&unit=g", b"0 1\n1 0\n")
    assert (status, json.loads(answer)["name"]) == (200, "own.csv")
    assert not (server.folder.path / ".." / "own.csv").exists()


def test_a_motion_from_arrays(tmp_path: Path) -> None:
    """Its samples are saved with the namelist, which names them."""
    quake = rwmf.Motion(_pulse(200, 0.01), dt=0.01, unit="g", name="made here")
    case = Case.from_namelist(FIG12).replace(motion=quake)
    with served(case) as (_, client):
        start = client.ask("/api/start", {})
        found = client.ask("/api/history", {"groups": start["state"]})
        files = client.ask("/api/made", {})
    assert list(files) == start["made"]
    for name, text in (files | {"explored.nml": found["namelist"]}).items():
        (tmp_path / name).write_text(text, encoding="ascii")
    shown = dict(row[:2] for row in found["numbers"])
    assert shown["u_s_max_m"] == repr(float(rwmf.simulate(case)["u_s_max"]))
    assert shown["u_s_max_m"] == repr(_summary(tmp_path / "explored.nml")["u_s_max_m"])


def test_the_case_of_the_package_is_the_one_of_inputs() -> None:
    package = ROOT / "driver" / "rwmf" / "explorer" / "presets" / "fig12_one_sine.nml"
    assert package.read_bytes() == FIG12.read_bytes()


def test_a_port_in_use(command: Runner, both: tuple[PageServer, Client]) -> None:
    done = command("explore", FIG12, "--port", both[0].server_port, "--no-browser")
    assert done.returncode == 2
    assert done.stderr.startswith(f"rwmf: port {both[0].server_port} cannot be used")
    assert "--port 0" in done.stderr


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["nowhere.nml"], "nowhere.nml: the file does not exist"),
        (["--port", "70000"], "[0, 65535]"),
    ],
)
def test_wrong_words(command: Runner, words: list[str], part: str) -> None:
    done = command("explore", *words, "--no-browser")
    assert (done.returncode, part in done.stderr) == (2, True)
