"""The explorer below the cell of a notebook: a frame for servers of this machine alone."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

import pytest
import rwmf
from explorer_page import FIG12, SETTLED
from page_client import Client
from rwmf.explorer import server as explorer

if TYPE_CHECKING:
    from playwright.sync_api import Browser

FRAME = {"Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "navigate", "Sec-Fetch-Dest": "iframe"}


@pytest.fixture(scope="module")
def page() -> Iterator[explorer.NotebookPage]:
    """Call the explorer in a process that is a Jupyter kernel."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explorer, "in_notebook", lambda: True)
        found = rwmf.explore(FIG12, open_browser=False)
    assert found is not None
    yield found
    found.close()


def _client(page: explorer.NotebookPage) -> Client:
    found = re.fullmatch(r"http://127.0.0.1:(\d+)/#(\S+)", page.address)
    assert found
    return Client(int(found[1]), found[2])


@pytest.mark.parametrize(
    ("method", "path", "changes", "status"),
    [
        ("GET", "/", {}, 200),
        ("GET", "/", {"Sec-Fetch-Site": "same-site"}, 200),
        # another page may open the frame and nothing else
        ("GET", "/", {"Sec-Fetch-Dest": "script"}, 403),
        ("GET", "/", {"Sec-Fetch-Dest": "document"}, 403),
        ("GET", "/main.js", {}, 403),
        ("GET", "/", {"Origin": "http://localhost:8888"}, 403),
        ("GET", "/", {"Host": "notebook.example"}, 403),
        ("POST", "/api/start", {}, 403),
        ("POST", "/", {}, 403),
    ],
)
def test_another_page_opens_the_frame_only(
    page: explorer.NotebookPage, method: str, path: str, changes: dict[str, str], status: int
) -> None:
    body = b"{}" if method == "POST" else None
    found, _ = _client(page).request(method, path, body, FRAME | changes)
    assert found == status


def test_the_command_allows_no_frame() -> None:
    """Only a server that a notebook has started may be in a frame."""
    server = explorer.PageServer(rwmf.Case.from_namelist(FIG12))
    try:
        page = explorer.NotebookPage(server)
        assert _client(page).request("GET", "/", None, dict(FRAME))[0] == 403
        assert "frame-ancestors 'none'" in _policy(page)
    finally:
        page.close()


def _policy(page: explorer.NotebookPage) -> str:
    connection = HTTPConnection("127.0.0.1", _client(page).port, timeout=60)
    connection.request("GET", "/")
    found = connection.getresponse().getheader("Content-Security-Policy")
    connection.close()
    assert found
    return found


def test_frames_are_for_this_machine(page: explorer.NotebookPage) -> None:
    assert _policy(page).endswith("frame-ancestors http://127.0.0.1:* http://localhost:*")


@contextmanager
def _notebook(cell: str, host: str) -> Iterator[int]:
    """Serve a page with the output of a cell at an address of this machine; yields the port."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(f"<!DOCTYPE html><title>notebook</title>{cell}".encode())

        def log_message(self, format: str, *args: object) -> None:
            pass

    with ThreadingHTTPServer((host, 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.02,))
        thread.start()
        try:
            yield server.server_port
        finally:
            server.shutdown()
            thread.join()


@pytest.mark.parametrize(
    ("host", "is_shown"), [("localhost", True), ("127.0.0.1", True), ("127.0.0.2", False)]
)
def test_the_frame_in_a_browser(
    page: explorer.NotebookPage, browser: Browser, host: str, is_shown: bool
) -> None:
    """The page works inside a notebook of this machine; another host shows an empty frame."""
    context = browser.new_context(viewport={"width": 1200, "height": 900})
    said: list[str] = []
    try:
        with _notebook(page._repr_html_(), host) as port:
            tab = context.new_page()
            tab.on("console", lambda message: said.append(message.text))
            tab.goto(f"http://{host}:{port}/", wait_until="networkidle")
            numbers = tab.frame_locator("iframe").locator("#numbers td").first
            if is_shown:
                numbers.wait_for()
                tab.frames[1].evaluate(SETTLED)
                assert not [text for text in said if "favicon" not in text]
            else:
                assert "frame-ancestors" in " ".join(said)
                assert numbers.count() == 0
    finally:
        context.close()


def test_the_end_of_a_page() -> None:
    """Port and folder are free again; a second end has no effect."""
    server = explorer.PageServer(rwmf.Case.from_namelist(FIG12), in_frame=True)
    page = explorer.NotebookPage(server)
    assert page.address in page._repr_html_()
    assert repr(page) == f"explorer at {page.address}"
    page.close()
    page.close()
    assert not server.folder.path.exists()
    assert page._repr_html_() == repr(page) == "explorer, closed"
    with pytest.raises(ConnectionRefusedError):
        Client(server.server_port, server.token).request("GET", "/", None, {})
