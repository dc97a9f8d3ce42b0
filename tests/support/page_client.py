"""Client of the server of `rwmf explore` that acts as its page, without a browser."""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from typing import Any

from rwmf import Case
from rwmf.explorer.server import PageServer

# a run that takes minutes
ENDLESS = {"solver": {"t_end": 1e7, "method": "dop853"}, "impact": {"e": 1.0, "rule": "constant"},
           "frame": {"T_s": 0.05, "gamma": 5.0, "xi_s": 0.0}}  # fmt: skip


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


def text_of(client: Client, path: str, question: object, **headers: str) -> bytes:
    """Write a request byte by byte."""
    body = json.dumps(question).encode()
    words = {"Host": f"127.0.0.1:{client.port}", "X-Token": client.token,
             "Content-Length": str(len(body)), "Connection": "close"} | headers  # fmt: skip
    lines = [f"POST {path} HTTP/1.1", *(f"{name}: {word}" for name, word in words.items())]
    return "\r\n".join(lines).encode() + b"\r\n\r\n" + body


@contextmanager
def asked(client: Client, path: str, question: object) -> Iterator[socket.socket]:
    """Ask, and keep the connection without reading."""
    with socket.create_connection(("127.0.0.1", client.port), 30) as raw:
        raw.sendall(text_of(client, path, question))
        yield raw


def received(raw: socket.socket) -> bytes:
    """Read up to the end of a connection."""
    return b"".join(iter(lambda: raw.recv(65536), b""))


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
