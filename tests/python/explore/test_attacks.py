"""The server of `rwmf explore` against long questions, crashes, signals and rude clients."""

from __future__ import annotations

import http.client
import json
import math
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest
from explorer_page import FIG12
from page_client import ENDLESS, Client, asked, received, served, text_of
from rwmf import Case
from rwmf.explorer import server as server_module
from rwmf.explorer import workers as workers_module
from rwmf.explorer.server import Folder, PageServer
from rwmf.run.quantities import find

# within which a page expects its answer while others compute, on a loaded machine [s]
SOON = 5.0


def _endless(state: dict[str, Any]) -> dict[str, Any]:
    return {"groups": {name: keys | ENDLESS.get(name, {}) for name, keys in state.items()}}


def _until(holds: Callable[[], bool], seconds: float = 10.0) -> bool:
    until = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def test_a_quantity_has_several_names() -> None:
    """Key, name and capitals of each quantity are the same question."""
    case = Case.from_namelist(FIG12.with_name("fig06_mild_frame_alone_one_sine.nml"))
    with served(case) as (_, client):
        question = {"groups": client.ask("/api/start", {})["state"], "points": 2}
        keys = case.kernel.applicable()
        for key in keys:
            expected = client.ask("/api/spectrum", question | {"quantity": key})
            for word in {key.upper(), *find(key).names("ordinate")} - {key}:
                found = client.ask("/api/spectrum", question | {"quantity": word})
                assert found["quantity"]["key"] == key
                assert (word, found["values"]) == (word, expected["values"])
    assert len(keys) > 10


def test_a_long_question_blocks_nobody(client: Client, state: dict[str, Any]) -> None:
    endless = _endless(state)
    with asked(client, "/api/spectrum", endless), asked(client, "/api/cost", endless):
        time.sleep(0.3)
        begun = time.perf_counter()
        client.ask("/api/history", {"groups": state})
        client.ask("/api/spectrum", {"groups": state, "points": 3})
        assert time.perf_counter() - begun < SOON


def test_long_questions_of_all_processes_give_way(
    state: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers_module, "_MOST", 2)
    monkeypatch.setattr(workers_module, "_LONG", 1.0)
    with served(Case.from_namelist(FIG12)) as (_, client):
        endless = _endless(state)
        with asked(client, "/api/history", endless) as one:
            # the longest computation is stopped, so the first must start first
            time.sleep(0.7)
            with asked(client, "/api/cost", endless):
                time.sleep(0.3)
                client.ask("/api/history", {"groups": state})
                status, _, body = received(one).partition(b"\r\n")
                assert status == b"HTTP/1.1 503 Service Unavailable"
                assert b"because other pages wait" in body
                # the first in the queue is the first that is served
                client.ask("/api/history", {"groups": state})


@pytest.mark.parametrize("path", ["/api/history", "/api/spectrum", "/api/cost"])
def test_every_question_has_a_limit(
    client: Client, state: dict[str, Any], monkeypatch: pytest.MonkeyPatch, path: str
) -> None:
    """A stiff case without end gets an answer even where no other question waits."""
    monkeypatch.setattr(workers_module, "_LIMITS", dict.fromkeys(workers_module._LIMITS, 0.5))
    endless = _endless(state)
    endless["groups"]["damper"] = {"c_over_m_w": 2147483647.0}
    with asked(client, path, endless) as raw:
        answer = received(raw)
    assert b"stopped after 0.5 s, the limit of a page: shorten t_end" in answer
    assert answer.startswith(b"HTTP/1.1 200" if path == "/api/cost" else b"HTTP/1.1 503")


def _workers(process: int) -> list[int]:
    """List the processes that a server has started."""
    found = subprocess.run(["pgrep", "-P", str(process), "-f", "rwmf.explorer.worker"],
                           capture_output=True, text=True, check=False)  # fmt: skip
    return [int(word) for word in found.stdout.split()]


def test_a_crash_ends_one_answer(state: dict[str, Any]) -> None:
    number = signal.SIGSEGV
    with served(Case.from_namelist(FIG12)) as (server, client):
        client.ask("/api/history", {"groups": state})
        (worker,) = (one.process.pid for one in server.workers._all)
        with asked(client, "/api/history", _endless(state)) as raw:
            time.sleep(0.3)
            os.kill(worker, number)
            answer = received(raw)
        assert answer.startswith(b"HTTP/1.1 500")
        assert number.name.encode() in answer
        # another process has taken its place; one that dies without a question is not noticed
        client.ask("/api/history", {"groups": state})
        (worker,) = (one.process.pid for one in server.workers._all)
        os.kill(worker, number)
        time.sleep(0.2)
        client.ask("/api/history", {"groups": state})


def test_a_process_has_no_more_than_half_of_the_memory(
    client: Client, state: dict[str, Any]
) -> None:
    # an answer shows that a process has started completely
    client.ask("/api/history", {"groups": state})
    worker, *_ = _workers(os.getpid())
    limits = Path(f"/proc/{worker}/limits").read_text(encoding="ascii").splitlines()
    (line,) = (line for line in limits if line.startswith("Max data size"))
    half = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    assert int(line.split()[3]) <= half


def test_a_client_that_says_no_more_gets_its_answer(client: Client, state: dict[str, Any]) -> None:
    slow = {name: dict(keys) for name, keys in state.items()}
    slow["solver"] |= {"t_end": 20000.0, "method": "dop853"}
    with asked(client, "/api/spectrum", {"groups": slow, "points": 3}) as raw:
        raw.shutdown(socket.SHUT_WR)
        answer = received(raw)
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 200 OK")
    assert json.loads(body)


@pytest.mark.parametrize(
    ("lines", "status"),
    [
        (b"GET / HTTP/9.9\r\n\r\n", b"505"),
        (b"GET /\r\n\r\n", b"403"),
        (b"\x00\xff\r\n\r\n", b"400"),
        (b"GET " + b"x" * 70000 + b" HTTP/1.1\r\n\r\n", b"414"),
        (b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 200 + b"\r\n", b"431"),
        (b"GET / HTTP/1.1\r\nA: " + b"x" * 70000 + b"\r\n\r\n", b"431"),
        (b"GET / HTTP/1.1\r\nHost: 127.0.0.1:PORT\r\nHost: 127.0.0.1:PORT\r\n\r\n", b"400"),
    ],
)
def test_what_is_no_request(client: Client, lines: bytes, status: bytes) -> None:
    with socket.create_connection(("127.0.0.1", client.port), 10) as raw:
        raw.sendall(lines.replace(b"PORT", str(client.port).encode()))
        raw.shutdown(socket.SHUT_WR)
        assert status in received(raw)[:200]


@pytest.mark.parametrize("query", ["name=a&name=b", "name=a&file=b", "name=a&unit=g&dt=", "name="])
def test_a_query_of_a_record_is_read_strictly(client: Client, query: str) -> None:
    assert client.post(f"/api/record?{query}", b"0 0\n1 1\n")[0] == 400


def test_too_many_records(
    client: Client, both: tuple[PageServer, Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_module, "_MOST_RECORDS", both[0]._records + 1)
    assert client.post("/api/record?name=a.csv&unit=g", b"0 0\n1 1\n")[0] == 200
    status, content = client.post("/api/record?name=a.csv&unit=g", b"0 0\n1 1\n")
    assert (status, b"start rwmf explore again" in content) == (507, True)


def test_a_record_that_cannot_be_kept(
    client: Client, both: tuple[PageServer, Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(both[0].folder, "path", Path("/proc/nowhere"))
    status, content = client.post("/api/record?name=a.csv&unit=g", b"0 0\n1 1\n")
    assert (status, b"cannot be kept" in content) == (507, True)


def test_many_connections_and_slow_ones(
    state: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(server_module, "_MOST_CONNECTIONS", 20)
    monkeypatch.setattr(server_module, "_ARRIVAL", 2.0)
    with served(Case.from_namelist(FIG12)) as (server, client):
        raws = [socket.create_connection(("127.0.0.1", client.port), 10) for _ in range(40)]
        assert _until(lambda: len(server.arriving) == 20)
        for raw in raws:
            threading.Thread(target=_trickle, args=(raw,), daemon=True).start()
        # those that never finish their request are closed, however often they send a byte
        assert _until(lambda: not server.arriving)
        client.ask("/api/history", {"groups": state})
        for raw in raws:
            raw.close()


def test_idle_connections_do_not_keep_the_page_out(
    state: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those without the token give way; a page that waits for its answer keeps its connection."""
    monkeypatch.setattr(server_module, "_MOST_CONNECTIONS", 20)
    with served(Case.from_namelist(FIG12)) as (server, client), ExitStack() as stack:
        waiting = stack.enter_context(asked(client, "/api/history", _endless(state)))
        assert _until(lambda: math.inf in server.arriving.values())
        kept = http.client.HTTPConnection("127.0.0.1", client.port, timeout=10)
        headers = {"Host": f"127.0.0.1:{client.port}", "X-Token": client.token}

        def ask() -> int:
            kept.request("POST", "/api/start", b"{}", headers)
            answer = kept.getresponse()
            answer.read()
            return answer.status

        assert ask() == 200
        used = kept.sock
        for _ in range(30):
            raw = socket.create_connection(("127.0.0.1", client.port), 10)
            stack.callback(raw.close)
        begun = time.monotonic()
        client.ask("/api/start", {})
        assert time.monotonic() - begun < SOON
        assert (ask(), kept.sock) == (200, used)
        assert len(server.arriving) <= 20
        waiting.settimeout(0.1)
        with pytest.raises(TimeoutError):
            waiting.recv(1)


@pytest.mark.parametrize(
    ("path", "token", "status"),
    [("/api/record?name=a.csv&unit=g", True, 413), ("/api/start", True, 413),
     ("/api/record?name=a.csv&unit=g", False, 403), ("/api/nothing", True, 404)],
)  # fmt: skip
def test_a_refused_upload_gets_its_answer(
    client: Client, path: str, token: bool, status: int
) -> None:
    """Also a client that sends everything before it reads, as browsers do."""
    content = b"0" * (server_module._MOST_RECORD + 1)
    headers = {"X-Token": client.token if token else "another"}
    line = f"HTTP/1.1 {status}".encode()
    with socket.create_connection(("127.0.0.1", client.port), 30) as raw:
        head, _, _ = text_of(client, path, {}, **headers).partition(b"Content-Length: 2")
        raw.sendall(head + b"Content-Length: %d\r\n\r\n" % len(content) + content)
        answer = received(raw)
    assert answer.startswith(line), answer[:200]
    assert json.loads(answer.partition(b"\r\n\r\n")[2])["error"]


def _trickle(raw: socket.socket) -> None:
    try:
        for byte in b"POST /api/start HTTP/1.1\r\n" + b"x" * 1000:
            raw.send(bytes([byte]))
            time.sleep(0.1)
    except OSError:
        pass


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give temporary files of commands a folder of this test."""
    found = tmp_path / "temporary"
    found.mkdir()
    monkeypatch.setenv("TMPDIR", str(found))
    return found


@contextmanager
def _command() -> Iterator[tuple[subprocess.Popen[str], Client]]:
    words = [sys.executable, "-m", "rwmf", "explore", str(FIG12), "--no-browser"]
    pipe = subprocess.PIPE
    with subprocess.Popen(words, stdout=pipe, stderr=pipe, text=True) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            assert process.stdout.readline() == "Ctrl-C ends it\n"
            port, token = address.removeprefix("http://127.0.0.1:").split("/#")
            yield process, Client(int(port), token)
        finally:
            process.kill()


RECORD = "/api/record?name=own.csv&unit=g"


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGINT])
def test_signals_leave_nothing_behind(
    place: Path, state: dict[str, Any], number: signal.Signals
) -> None:
    with _command() as (process, client):
        assert client.post(RECORD, b"0 0\n1 1\n")[0] == 200
        workers = _workers(process.pid)
        with asked(client, "/api/history", _endless(state)):
            time.sleep(0.2)
            # an impatient user sends it twice
            process.send_signal(number)
            process.send_signal(number)
            out, error = process.communicate(timeout=10)
    assert (process.returncode, out, error) == (0, "ended\n", "")
    assert list(place.iterdir()) == []
    assert workers
    assert _until(lambda: not any(Path(f"/proc/{worker}").exists() for worker in workers))


@pytest.mark.slow
def test_the_next_server_cleans_up_after_one_that_was_killed(
    place: Path, state: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    with _command() as (_, living):
        assert living.post(RECORD, b"0 0\n1 1\n")[0] == 200
        (kept,) = place.iterdir()
        with _command() as (process, client):
            assert client.post(RECORD, b"0 0\n1 1\n")[0] == 200
            with asked(client, "/api/history", _endless(state)):
                time.sleep(0.2)
                workers = _workers(process.pid)
                process.kill()
                process.wait()
                # its computation ends with it
                assert workers
                assert _until(lambda: not any(Path(f"/proc/{x}").exists() for x in workers))
        (left,) = set(place.iterdir()) - {kept}
        with _command() as (process, _):
            assert not left.exists()
            process.terminate()
            process.wait(10)
        # a server that lives keeps its records
        assert list(place.iterdir()) == [kept]
        living.ask("/api/history", {"groups": state})
    # foreign things of that name stay: a link, a file
    target = place.parent / "target"
    target.mkdir()
    (place / "rwmf-explore-link").symlink_to(target)
    (place / "rwmf-explore-file").touch()
    monkeypatch.setattr("tempfile.tempdir", str(place))
    folder = Folder()
    assert not kept.exists()
    folder.remove()
    folder.remove()
    assert {path.name for path in place.iterdir()} == {"rwmf-explore-link", "rwmf-explore-file"}
