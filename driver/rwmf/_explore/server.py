"""The server of the page: Python's own, for this machine only.

Another site in the same browser, or another user, must not use it. Whoever asks needs the token,
which stands in the fragment of the address: browsers send that to nobody. A name that somebody
else lets point to this machine is refused, as is a question that another page has made the browser
ask.
"""

from __future__ import annotations

import hmac
import json
import os
import secrets
import select
import signal
import socket
import sys
import tempfile
import threading
import traceback
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from rwmf._arguments import case_of, checked
from rwmf._explore.model import Model
from rwmf._explore.questions import BadQuestionError, read
from rwmf.case import Case
from rwmf.errors import InputError, OutputError, RwmfError

__all__ = ["PageServer", "explore"]

_HOST = "127.0.0.1"
_PAGE = Path(__file__).parent / "page"
_START = Path(__file__).parent / "start.nml"
_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
# a question names every key of a case; a record has millions of samples at most [bytes]
_MOST_QUESTION = 64 * 1024
_MOST_RECORD = 32 * 1024 * 1024
# how long the end waits for the kernel [s]
_PATIENCE = 2.0
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "connect-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}


class _GoneError(Exception):
    """Nobody waits for the answer any more."""


class _RefusedError(Exception):
    """A request that is answered with a status and one line."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


class PageServer(ThreadingHTTPServer):
    """Serves the page, and answers its questions about a case.

    Parameters
    ----------
    case : Case
        What the page begins with.
    port : int
        Of this machine; 0 for a free one.

    Raises
    ------
    OutputError
        When the port cannot be had.
    """

    daemon_threads = True
    # at the end the browser may still hold its connections
    block_on_close = False

    def __init__(self, case: Case, port: int = 0) -> None:
        self.folder = tempfile.TemporaryDirectory(prefix="rwmf-explore-")
        self.token = secrets.token_urlsafe(24)
        self.model = Model(case, Path(self.folder.name))
        self.ending = threading.Event()
        # no name of a request becomes a path: these are all there are
        self.files = {
            f"/{path.relative_to(_PAGE).as_posix()}": path
            for path in _PAGE.rglob("*")
            if path.suffix in _TYPES
        }
        self.files["/"] = _PAGE / "index.html"
        try:
            super().__init__((_HOST, port), _Handler)
        except OSError as error:
            self.folder.cleanup()
            raise OutputError(
                f"port {port} cannot be used ({error.strerror}): --port 0 takes a free one"
            ) from error

    @property
    def address(self) -> str:
        """The page's address, with the token in its fragment."""
        return f"http://{_HOST}:{self.server_port}/#{self.token}"

    def handle_error(self, request: object, client_address: object) -> None:
        """Say nothing of connections that break off; show what was not foreseen.

        Parameters
        ----------
        request : socket
            The connection.
        client_address : tuple
            Who has opened it.
        """
        error = sys.exc_info()[1]
        if not isinstance(error, OSError | _GoneError):
            traceback.print_exc()

    def end(self) -> None:
        """Stop what the kernel computes, and give back port and folder."""
        self.ending.set()
        # whoever waits for a turn behind this one sees that it has ended
        if self.model.turns.take(_PATIENCE):
            self.model.turns.give()
        self.server_close()
        self.folder.cleanup()


class _Handler(BaseHTTPRequestHandler):
    """One connection of a browser."""

    server: PageServer
    protocol_version = "HTTP/1.1"
    server_version = "rwmf"
    sys_version = ""
    # headers and body leave together: no delay between them
    wbufsize = -1
    disable_nagle_algorithm = True
    # a connection without a question is closed [s]
    timeout = 60

    def do_GET(self) -> None:
        """Serve a file of the page."""
        self._guarded(self._send_file)

    def do_POST(self) -> None:
        """Answer a question."""
        self._guarded(self._answer)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Answer what is no request of a page, with the headers of all answers.

        Parameters
        ----------
        code : int
            Status.
        message, explain : str, optional
            What is wrong.
        """
        self._fail(code, explain or message or "this is no request of the page")

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: the terminal belongs to whoever started the server."""

    def _guarded(self, serve: Callable[[], None]) -> None:
        """Check who asks, and answer what goes wrong with a status and one line."""
        try:
            # a connection of before may last longer than the server
            self._watch()
            self._check_sender()
            serve()
        except _RefusedError as error:
            self._fail(error.status, str(error))
        except BadQuestionError as error:
            self._fail(400, str(error))
        except RwmfError as error:
            self._fail(422, self.server.model.plainly(error))
        except (_GoneError, ConnectionError, TimeoutError):
            self.close_connection = True
        except Exception as error:
            traceback.print_exc()
            self._fail(500, f"unforeseen {type(error).__name__}: {error}")

    def _check_sender(self) -> None:
        """Refuse what no page of this server sends."""
        hosts = [f"{name}:{self.server.server_port}" for name in (_HOST, "localhost")]
        if self.headers.get("Host") not in hosts:
            raise _RefusedError(403, "this server answers to its own address only")
        origin = self.headers.get("Origin")
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            raise _RefusedError(403, "this server answers its own page only")
        if self.headers.get("Sec-Fetch-Site", "none") not in ("same-origin", "none"):
            raise _RefusedError(403, "this server answers its own page only")

    def _send_file(self) -> None:
        path = self.server.files.get(urlsplit(self.path).path)
        if path is None:
            raise _RefusedError(404, "there is no such file")
        self._send(200, f"{_TYPES[path.suffix]}; charset=utf-8", path.read_bytes())

    def _answer(self) -> None:
        if not hmac.compare_digest(
            self.headers.get("X-Token", "").encode(), self.server.token.encode()
        ):
            raise _RefusedError(403, "the token is missing or that of another run")
        url = urlsplit(self.path)
        if url.path == "/api/record":
            answer: object = self._add_record(url.query)
        elif url.path == "/api/start":
            self._body(_MOST_QUESTION)
            answer = self.server.model.start()
        elif url.path == "/api/made":
            self._body(_MOST_QUESTION)
            answer = self.server.model.made()
        elif url.path in ("/api/history", "/api/spectrum", "/api/cost"):
            question = read(_json(self._body(_MOST_QUESTION)))
            model = self.server.model
            if url.path == "/api/cost":
                self._stream(lambda report: model.cost(question, report))
                return
            ask = model.history if url.path == "/api/history" else model.spectrum
            with model.turns:
                # it may have been a long wait
                self._watch()
                answer = ask(question, self._watch)
        else:
            raise _RefusedError(404, "there is no such question")
        self._send_json(200, answer)

    def _add_record(self, query: str) -> dict[str, Any]:
        words = {key: values[0] for key, values in parse_qs(query).items()}
        content = self._body(_MOST_RECORD)
        dt = words.get("dt")
        try:
            interval = None if dt is None else float(dt)
        except ValueError:
            raise BadQuestionError(f"dt = {dt}: must be a number > 0 [s]") from None
        with self.server.model.turns:
            return self.server.model.add_record(
                content, words.get("name", ""), words.get("unit"), interval
            )

    def _body(self, most: int) -> bytes:
        """Read what is sent with the question."""
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()) or "Transfer-Encoding" in self.headers:
            raise _RefusedError(411, "a question says how long it is")
        # so many digits are no length, whatever they say
        if len(length) > 12 or int(length) > most:
            raise _RefusedError(413, f"too long: at most {most // 1024} KiB are taken")
        content = self.rfile.read(int(length))
        if len(content) < int(length):
            raise _GoneError
        return content

    def _watch(self, _: int = 0) -> None:
        """Stop the kernel when the browser has closed the connection: it wants something newer."""
        if self.server.ending.is_set():
            raise _GoneError
        if select.select([self.connection], [], [], 0)[0]:
            with suppress(BlockingIOError):
                if not self.connection.recv(1, socket.MSG_PEEK | socket.MSG_DONTWAIT):
                    raise _GoneError

    def _stream(self, compute: Callable[[Callable[[int, int], None]], object]) -> None:
        """Answer line by line: progress, then the result."""
        self._head(200, "application/x-ndjson", None)
        self.close_connection = True
        last = (-1, -1)

        def report(done: int, total: int) -> None:
            nonlocal last
            self._watch()
            if (done, total) != last:
                last = (done, total)
                self._line({"done": done, "total": total})

        try:
            self._line({"result": compute(report)})
        except RwmfError as error:
            self._line({"error": self.server.model.plainly(error)})

    def _line(self, value: object) -> None:
        self.wfile.write(_encode(value) + b"\n")
        self.wfile.flush()

    def _fail(self, status: int, message: str) -> None:
        # what is left of the request would be taken for the next one
        self.close_connection = True
        with suppress(ConnectionError, TimeoutError):
            self._send_json(status, {"error": message})

    def _send_json(self, status: int, value: object) -> None:
        self._send(status, "application/json", _encode(value))

    def _send(self, status: int, kind: str, content: bytes) -> None:
        self._head(status, kind, len(content))
        if self.command != "HEAD":
            self.wfile.write(content)
        self.wfile.flush()

    def _head(self, status: int, kind: str, length: int | None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        if length is not None:
            self.send_header("Content-Length", str(length))
        if length is None or self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()


def _json(content: bytes) -> object:
    def refuse(word: str) -> None:
        raise ValueError(word)

    try:
        return json.loads(content, parse_constant=refuse)
    except (ValueError, RecursionError):
        raise BadQuestionError("a question is JSON") from None


def _encode(value: object) -> bytes:
    # a name of a file may hold bytes that are no text
    return json.dumps(value, allow_nan=False).encode("ascii", "replace")


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _interrupted_by_the_end() -> Any:  # noqa: ANN401 (what signal.signal returns)
    """Let whoever ends the process end it as Ctrl-C does: no folder stays behind.

    Returns
    -------
    handler or None
        What was in its place; None in a thread, which has no say in this.
    """
    if threading.current_thread() is not threading.main_thread():
        return None
    return signal.signal(signal.SIGTERM, _interrupt)


@checked
def explore(
    case: Case | str | os.PathLike[str] | None = None,
    port: int = 0,
    open_browser: bool = True,
) -> None:
    """Show a case in the browser, with a slider for every number; Ctrl-C ends it.

    The page is served to this machine only, works without a network and leaves the case as it is:
    what the sliders say is saved from the page as a namelist.

    Parameters
    ----------
    case : Case or path, optional
        What to begin with; otherwise the case of `inputs/fig12_one_sine.nml`.
    port : int
        Port of this machine, 0 for a free one.
    open_browser : bool
        Whether to open the page, or only to print its address.

    Raises
    ------
    InputError
        When the case is not acceptable.
    OutputError
        When the port cannot be had.
    """
    if not 0 <= port <= 65535:
        raise InputError(f"port = {port}: must be in [0, 65535]")
    if case is None:
        # without the place of the package: the case is nobody's file
        case = Case.from_text(_START.read_text(encoding="utf-8"), "fig12_one_sine.nml")
    else:
        case = case_of(case)
    server = PageServer(case, port)
    terminated = _interrupted_by_the_end()
    try:
        print(f"{server.address}\nCtrl-C ends it", flush=True)
        if open_browser:
            # a browser in a terminal returns when it is left
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        server.serve_forever(poll_interval=0.1)
    except KeyboardInterrupt:
        print("ended", flush=True)
    finally:
        server.end()
        if terminated is not None:
            signal.signal(signal.SIGTERM, terminated)
