"""Client of the server of `rwmf explore` that acts as its page, without a browser."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from typing import Any

from rwmf import Case
from rwmf.explorer.server import PageServer


class Client:
    """One page.

    Parameters
    ----------
    port : int
        Of the server.
    token : str
        Of the server.
    """

    def __init__(self, port: int, token: str) -> None:
        self.port = port
        self.token = token

    def post(self, path: str, body: bytes, **headers: str | None) -> tuple[int, bytes]:
        """Send a request unchanged; a header that is None is omitted."""
        words = {"X-Token": self.token} | {
            name.replace("_", "-"): value for name, value in headers.items()
        }
        return self.request("POST", path, body, words)

    def request(
        self, method: str, path: str, body: bytes | None, headers: dict[str, str | None]
    ) -> tuple[int, bytes]:
        """Send a request; status and content of the answer."""
        connection = HTTPConnection("127.0.0.1", self.port, timeout=60)
        try:
            connection.putrequest(method, path, skip_host="Host" in headers)
            if body is not None and "Content-Length" not in headers:
                headers = headers | {"Content-Length": str(len(body))}
            for name, value in headers.items():
                if value is not None:
                    connection.putheader(name, value)
            connection.endheaders(body)
            answer = connection.getresponse()
            return answer.status, answer.read()
        finally:
            connection.close()

    def ask(self, path: str, question: object) -> dict[str, Any]:
        """Send a request that must be answered."""
        status, content = self.post(path, json.dumps(question).encode())
        assert status == 200, content
        found: dict[str, Any] = json.loads(content)
        return found

    def problem(self, path: str, question: object) -> tuple[int, str]:
        """Send a request that must be refused; return status and message."""
        status, content = self.post(path, json.dumps(question).encode())
        assert status != 200
        return status, json.loads(content)["error"]


@contextmanager
def served(case: Case) -> Iterator[tuple[PageServer, Client]]:
    """Serve a case from a thread of this process.

    Parameters
    ----------
    case : Case
        The case.

    Yields
    ------
    PageServer
        The server.
    Client
        Name of the requesting page.
    """
    server = PageServer(case)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    try:
        yield server, Client(server.server_port, server.token)
    finally:
        server.shutdown()
        thread.join()
        server.end()
