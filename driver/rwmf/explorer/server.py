"""Server of the page, from Python's standard library, for this machine only.

Other web sites in the same browser and other users must not use it. Every request needs the token,
which is in the fragment of the address; browsers do not send fragments. The server refuses foreign
host names that resolve to this machine, and requests that another page triggered. A page of
another server of this machine may show this one in a frame if the server was started in a notebook.
Without the token the frame answers nothing.
"""

from __future__ import annotations

import atexit
import fcntl
import hmac
import json
import math
import os
import secrets
import select
import shutil
import signal
import socket
import sys
import tempfile
import threading
import time
import traceback
import webbrowser
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from rwmf.case import Case
from rwmf.case.arguments import case_of, checked
from rwmf.errors import OutputError, RwmfError
from rwmf.explorer.model import as_files, encode, start
from rwmf.explorer.questions import FIRST, BadQuestionError, case_of_preset, read
from rwmf.explorer.workers import BrokenError, BusyError, Workers
from rwmf.kernel.progress import in_notebook
from rwmf.motion.records import UNIT, find

_PREFIX = "rwmf-explore-"


class Folder:
    """A new temporary folder, locked until this process ends.

    The operating system releases the lock of the folder with the process. A folder without a lock
    therefore belongs to a terminated server.
    """

    def __init__(self) -> None:
        self._lock: int | None = None
        for left in Path(tempfile.gettempdir()).glob(f"{_PREFIX}*"):
            lock = _locked(left)
            if lock is not None:
                _remove(left, lock)
        while self._lock is None:
            # between creation and lock another server may take the folder for an abandoned one
            self.path = Path(tempfile.mkdtemp(prefix=_PREFIX))
            self._lock = _locked(self.path)

    def remove(self) -> None:
        """Remove the folder with its contents; further calls have no effect."""
        if self._lock is not None:
            _remove(self.path, self._lock)
            self._lock = None


def _locked(path: Path) -> int | None:
    """Lock a folder of this user."""
    try:
        found = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return None
    with suppress(OSError):
        if os.fstat(found).st_uid == os.geteuid():
            fcntl.flock(found, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # another process may have removed it before the lock
            if os.path.samestat(os.fstat(found), os.lstat(path)):
                return found
    os.close(found)
    return None


def _remove(path: Path, lock: int) -> None:
    shutil.rmtree(path, ignore_errors=True)
    os.close(lock)


_HOST = "127.0.0.1"
_PAGE = Path(__file__).parent / "page"
_TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css"}
# a request lists every key of a case; a record has at most millions of samples [bytes]
_MOST_QUESTION = 64 * 1024
_MOST_RECORD = 32 * 1024 * 1024
# largest number of uploaded records
_MOST_RECORDS = 100
# largest number of connections; a browser opens six for a page
_MOST_CONNECTIONS = 200
# height of the page in a notebook [pixel]
_HEIGHT = 800
# time limit for receiving a request [s]
_ARRIVAL = 60.0
_ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors "
)
# servers of notebooks on this machine; a port is part of every address
_NOTEBOOKS = f"http://{_HOST}:* http://localhost:*"
_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}


# status of an answer by the error
_STATUSES = {BadQuestionError: 400, RwmfError: 422, BusyError: 503, BrokenError: 500}


class _GoneError(Exception):
    """The client has closed the connection."""


class _RefusedError(Exception):
    """A request to be answered with an error status and one line."""

    def __init__(self, status: int, message: str) -> None:
        super().__init__(message)
        self.status = status


class PageServer(ThreadingHTTPServer):
    """HTTP server of the page and its requests about a case."""

    daemon_threads = True
    # the browser may keep connections open after the end
    block_on_close = False
    # queue of connections; with the default of five, several pages would wait a second
    request_queue_size = 128

    def __init__(self, case: Case, port: int = 0, in_frame: bool = False) -> None:
        self._is_stopped = False
        self.in_frame = in_frame
        self.folder = Folder()
        try:
            self.case, self.made = as_files(case, self.folder.path)
            self.token = secrets.token_urlsafe(24)
            self.ending = threading.Event()
            # deadlines of requests that are still incomplete
            self.arriving: dict[socket.socket, float] = {}
            # connections that have sent the token
            self.trusted: set[socket.socket] = set()
            self._records = 0
            self._lock = threading.Lock()
            # no name in a request becomes a path: only these files exist
            self.files = {
                f"/{path.relative_to(_PAGE).as_posix()}": path
                for path in _PAGE.rglob("*")
                if path.suffix in _TYPES
            }
            self.files["/"] = _PAGE / "index.html"
            try:
                super().__init__((_HOST, port), _Handler)
            except OSError as error:
                raise OutputError(
                    f"port {port} cannot be used ({error.strerror}): --port 0 takes a free one"
                ) from error
            self.workers = Workers(self.case, self.folder.path)
        except BaseException:
            self.folder.remove()
            raise

    @property
    def address(self) -> str:
        """Address of the page, with the token in its fragment."""
        return f"http://{_HOST}:{self.server_port}/#{self.token}"

    def handle_error(self, request: object, client_address: object) -> None:
        """Ignore broken connections; show unexpected errors."""
        error = sys.exc_info()[1]
        if not isinstance(error, OSError | _GoneError):
            traceback.print_exc()

    def verify_request(self, request: Any, client_address: Any) -> bool:  # noqa: ANN401
        """Make room for a connection when there are too many.

        An incomplete request ends, the oldest one without the token first, so that idle
        connections of other programs do not keep the page out.
        """
        if len(self.arriving) >= _MOST_CONNECTIONS:
            waiting = [
                (connection in self.trusted, until, connection)
                for connection, until in list(self.arriving.items())
                if until < math.inf
            ]
            if not waiting:
                return False
            *_, oldest = min(waiting, key=lambda item: item[:2])
            self.arriving.pop(oldest, None)
            with suppress(OSError):
                oldest.shutdown(socket.SHUT_RDWR)
        self.arriving[request] = time.monotonic() + _ARRIVAL
        return True

    def shutdown_request(self, request: Any) -> None:  # noqa: ANN401
        """Close a connection."""
        self.arriving.pop(request, None)
        self.trusted.discard(request)
        super().shutdown_request(request)

    def stop(self, number: int, frame: object) -> None:
        """Handle a signal: ask `serve_forever` to end, with a KeyboardInterrupt."""
        self._is_stopped = True

    def service_actions(self) -> None:
        """Close connections with overdue requests."""
        if self._is_stopped:
            raise KeyboardInterrupt
        now = time.monotonic()
        for connection, until in list(self.arriving.items()):
            if now > until:
                with suppress(OSError):
                    connection.shutdown(socket.SHUT_RDWR)

    def new_record(self, content: bytes, name: str) -> str:
        """Store the file of a record."""
        # a namelist ignores blanks at the ends of a name
        plain = Path(name.replace("\\", "/")).name.strip()
        if not plain.isprintable() or not 0 < len(plain.encode()) <= 120 or plain in (".", ".."):
            raise BadQuestionError("the name of the record is no name of a file")
        with self._lock:
            if self._records == _MOST_RECORDS:
                raise _RefusedError(
                    507, f"{_MOST_RECORDS} records have been uploaded: start rwmf explore again"
                )
            self._records += 1
            number = str(self._records)
        folder = self.folder.path / number
        try:
            folder.mkdir()
            (folder / plain).write_bytes(content)
        except OSError as error:
            self.drop_record(number)
            raise _RefusedError(507, f"the record cannot be kept: {error.strerror}") from error
        return number

    def drop_record(self, number: str) -> None:
        """Remove the file of a refused record."""
        shutil.rmtree(self.folder.path / number, ignore_errors=True)
        with self._lock:
            # reuse only the last number
            self._records -= number == str(self._records)

    def end(self) -> None:
        """Stop computations; release port and folder."""
        self.ending.set()
        self.workers.end()
        self.server_close()
        self.folder.remove()


class _Handler(BaseHTTPRequestHandler):
    """Connection of a browser."""

    server: PageServer
    protocol_version = "HTTP/1.1"
    server_version = "rwmf"
    sys_version = ""
    # malformed requests also get a status line
    default_request_version = "HTTP/1.0"
    # send headers and body together, without delay between them
    wbufsize = -1
    disable_nagle_algorithm = True
    # idle connections are closed after this time [s]
    timeout = 60

    def handle_one_request(self) -> None:
        """Serve a request within a time limit for its arrival."""
        self.server.arriving[self.connection] = time.monotonic() + _ARRIVAL
        super().handle_one_request()

    def do_GET(self) -> None:
        """Serve a file of the page."""
        self._guarded(self._send_file)

    def do_POST(self) -> None:
        """Answer a request for a computation."""
        self._guarded(self._answer)

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Answer an invalid request, with the headers of all answers."""
        self._fail(code, explain or message or "this is no request of the page")

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: the terminal belongs to the user."""

    def _guarded(self, serve: Callable[[], None]) -> None:
        """Check the client, and answer errors with a status and one line."""
        try:
            # a persistent connection may outlast the server
            self._check_connection()
            self._check_sender()
            serve()
        except _RefusedError as error:
            self._fail(error.status, str(error))
        except tuple(_STATUSES) as error:
            kinds = (kind for kind in _STATUSES if isinstance(error, kind))
            self._fail(_STATUSES[next(kinds)], str(error))
        except (_GoneError, ConnectionError, TimeoutError):
            self.close_connection = True
        except Exception as error:
            traceback.print_exc()
            self._fail(500, f"unexpected {type(error).__name__}: {error}")

    def _check_sender(self) -> None:
        """Refuse requests that the page of this server does not send."""
        hosts = [f"{name}:{self.server.server_port}" for name in (_HOST, "localhost")]
        for name in ("Host", "Origin", "X-Token", "Content-Length"):
            if len(self.headers.get_all(name, [])) > 1:
                raise _RefusedError(400, f"the header {name} is there twice")
        if self.headers.get("Host") not in hosts:
            raise _RefusedError(403, "this server answers to its own address only")
        origin = self.headers.get("Origin")
        if origin is not None and origin not in [f"http://{host}" for host in hosts]:
            raise _RefusedError(403, "this server answers its own page only")
        if self.headers.get("Sec-Fetch-Site", "none") in ("same-origin", "none"):
            return
        # the notebook's page opens the frame; all later requests come from the frame itself
        opens = self.headers.get("Sec-Fetch-Dest") == "iframe" and self.command == "GET"
        if not (self.server.in_frame and opens and self.path == "/"):
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
        self.server.trusted.add(self.connection)
        url = urlsplit(self.path)
        server = self.server
        if url.path == "/api/record":
            answer = self._add_record(url.query)
        elif url.path == "/api/start":
            self._body(_MOST_QUESTION)
            answer = encode(start(server.case, server.made))
        elif url.path == "/api/made":
            self._body(_MOST_QUESTION)
            answer = encode({path.name: path.read_text(encoding="ascii") for path in server.made})
        elif url.path in ("/api/history", "/api/spectrum", "/api/cost"):
            question = read(_json(self._body(_MOST_QUESTION)))
            name = url.path.removeprefix("/api/")
            ask = partial(server.workers.ask, name, (question,), self._check_connection)
            if name == "cost":
                self._stream(ask)
                return
            answer = ask()
        else:
            raise _RefusedError(404, "there is no such question")
        self._send(200, "application/json", answer)

    def _add_record(self, query: str) -> bytes:
        words = parse_qs(query, keep_blank_values=True)
        for key, values in words.items():
            if key not in ("name", "unit", "dt", "shipped") or len(values) > 1:
                raise BadQuestionError(f"a record has no {key[:40]!r}, or has it twice")
        content = self._body(_MOST_RECORD)
        dt = words.get("dt", [None])[0]
        try:
            interval = None if dt is None else float(dt)
        except ValueError:
            raise BadQuestionError(f"dt = {dt}: must be a number > 0 [s]") from None
        name, unit = words.get("name", [""])[0], words.get("unit", [None])[0]
        if "shipped" in words:
            record, path = find(words["shipped"][0])
            content, name, unit = path.read_bytes(), record.name + path.suffix.lower(), UNIT
        number = self.server.new_record(content, name)
        try:
            arguments = (number, unit, interval)
            return self.server.workers.ask("add_record", arguments, self._check_connection)
        except BaseException:
            self.server.drop_record(number)
            raise

    def _body(self, most: int) -> bytes:
        """Read the body of the request."""
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()) or "Transfer-Encoding" in self.headers:
            raise _RefusedError(411, "the request has no valid Content-Length")
        # reject more digits than any valid length has
        if len(length) > 12 or int(length) > most:
            raise _RefusedError(413, f"too long: at most {most // 1024} KiB are taken")
        content = self.rfile.read(int(length))
        if len(content) < int(length):
            raise _GoneError
        # computing the answer is not limited by the deadline of the request
        self.server.arriving[self.connection] = math.inf
        return content

    def _check_connection(self) -> None:
        """Stop the computation when the browser has closed the connection."""
        if self.server.ending.is_set():
            raise _GoneError
        poll = select.poll()
        poll.register(self.connection, select.POLLRDHUP)
        for _, events in poll.poll(0):
            if events & (select.POLLERR | select.POLLHUP) or not self._is_held():
                raise _GoneError

    def _is_held(self) -> bool:
        """Check whether a process still holds the other end of a half-closed connection.

        A client may close its sending direction and wait for the answer. The socket alone cannot
        distinguish this from a closed client; the connection table of the system can.
        """
        ends = (f"{self.client_address[1]:04X}", f"{self.server.server_port:04X}")
        for table in ("/proc/net/tcp", "/proc/net/tcp6"):
            with suppress(OSError):
                for line in Path(table).read_text(encoding="ascii").splitlines()[1:]:
                    words = line.split()
                    if tuple(word[-4:] for word in words[1:3]) == ends:
                        # an entry without a process has no inode
                        return words[9] != "0"
        return False

    def _stream(self, compute: Callable[[Callable[[int, int], None]], bytes]) -> None:
        """Answer line by line: progress, then the result."""
        self._head(200, "application/x-ndjson", None)
        self.close_connection = True
        last = (-1, -1)

        def report(done: int, total: int) -> None:
            nonlocal last
            self._check_connection()
            if (done, total) != last:
                last = (done, total)
                self._line(encode({"done": done, "total": total}))

        try:
            self._line(b'{"result": ' + compute(report) + b"}")
        except tuple(_STATUSES) as error:
            self._line(encode({"error": str(error)}))

    def _line(self, text: bytes) -> None:
        self.wfile.write(text + b"\n")
        self.wfile.flush()

    def _fail(self, status: int, message: str) -> None:
        # the rest of the request would be read as the next one
        self.close_connection = True
        with suppress(OSError):
            self._send(status, "application/json", encode({"error": message}))
            # a connection closed before the end of an upload is reset, and the answer is lost
            self.server.arriving[self.connection] = time.monotonic() + _ARRIVAL
            self.connection.shutdown(socket.SHUT_WR)
            while self.connection.recv(_MOST_QUESTION):
                pass

    def _send(self, status: int, kind: str, content: bytes) -> None:
        self._head(status, kind, len(content))
        if self.command != "HEAD":
            self.wfile.write(content)
        self.wfile.flush()

    def _head(self, status: int, kind: str, length: int | None) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        frames = _NOTEBOOKS if self.server.in_frame else "'none'"
        self.send_header("Content-Security-Policy", _POLICY + frames)
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        if length is not None:
            self.send_header("Content-Length", str(length))
        if length is None or self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()


class NotebookPage:
    """Page in the output of a notebook's cell, served until `close` or the end of the kernel."""

    def __init__(self, server: PageServer) -> None:
        self._server = server
        self._is_open = True
        self.address = server.address
        threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True).start()
        atexit.register(self.close)

    def close(self) -> None:
        """Stop computations; release port and folder. Further calls have no effect."""
        if self._is_open:
            self._is_open = False
            atexit.unregister(self.close)
            self._server.shutdown()
            self._server.end()

    def __repr__(self) -> str:
        """Name the address."""
        return f"explorer at {self.address}" if self._is_open else "explorer, closed"

    def _repr_html_(self) -> str:
        if not self._is_open:
            return repr(self)
        frame = (
            f'<iframe src="{self.address}" title="explorer" width="100%" height="{_HEIGHT}" '
            'allow="fullscreen" style="border: 1px solid #999"></iframe>'
        )
        link = f'<a href="{self.address}" target="_blank" rel="noopener">Open in another tab</a>'
        return frame + link


def _json(content: bytes) -> object:
    def refuse(word: str) -> None:
        raise ValueError(word)

    def once(pairs: list[tuple[str, object]]) -> dict[str, object]:
        found = dict(pairs)
        if len(found) < len(pairs):
            raise BadQuestionError("a question has a key twice")
        return found

    try:
        return json.loads(content, parse_constant=refuse, object_pairs_hook=once)
    except BadQuestionError:
        raise
    except (ValueError, RecursionError):
        raise BadQuestionError("a question is JSON") from None


def _interrupt(number: int, frame: object) -> None:
    raise KeyboardInterrupt


def _set_signals(action: Any, numbers: Iterable[int]) -> dict[int, Any]:  # noqa: ANN401
    """Set signal handlers."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    return {number: signal.signal(number, action) for number in numbers}


@checked
def explore(
    case: Case | str | os.PathLike[str] | None = None,
    port: int = 0,
    open_browser: bool = True,
) -> NotebookPage | None:
    """Show a case in the browser, with a slider for every number; Ctrl-C ends it.

    The page is served to this machine only, works without a network and does not change the case.
    You can save the state of the sliders as a namelist from the page. A Jupyter notebook shows the
    page below the cell if the call is the last line of the cell.

    Parameters
    ----------
    case : Case or path, optional
        Initial case; otherwise that of `inputs/fig12_one_sine.nml`.
    port : int
        Port of this machine, 0 for a free one.
    open_browser : bool
        Open the page in a browser, not only print its address; ignored in a notebook.

    Returns
    -------
    object or None
        In a notebook the page, with its ``address`` and ``close()``; the end of the kernel closes
        it, too. Elsewhere None, after Ctrl-C.

    Raises
    ------
    InputError
        When the case is not acceptable.
    OutputError
        When the port cannot be used.
    """
    case = case_of_preset(FIRST.name) if case is None else case_of(case)
    if in_notebook():
        return NotebookPage(PageServer(case, port, in_frame=True))
    _serve(case, port, open_browser)
    return None


def _serve(case: Case, port: int, open_browser: bool) -> None:
    """Serve the page until a signal ends it."""
    # treat termination signals like Ctrl-C, so that the folder is removed. Ignored signals, as with
    # nohup, stay ignored
    ends = [x for x in _ENDS if signal.getsignal(x) is not signal.SIG_IGN]
    before = _set_signals(_interrupt, ends)
    server = None
    try:
        server = PageServer(case, port)
        # not an exception wherever the program is: a second one would interrupt the end
        _set_signals(server.stop, before)
        _say(f"{server.address}\nCtrl-C ends it")
        if open_browser:
            # a terminal browser blocks until its user leaves it
            threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        server.serve_forever(poll_interval=0.1)
    except KeyboardInterrupt:
        # a second signal must not interrupt the clean-up
        _set_signals(signal.SIG_IGN, before)
        _say("ended")
    finally:
        _set_signals(signal.SIG_IGN, before)
        if server is not None:
            server.end()
        for number, action in before.items():
            signal.signal(number, action)


def _say(text: str) -> None:
    # the terminal may be closed
    with suppress(OSError):
        print(text, flush=True)
