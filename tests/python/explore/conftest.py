"""Fixtures: a server with its client, the page in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import pytest
from explorer_page import DESK, FIG12, Open, Opened
from page_client import Client, served
from rwmf import Case
from rwmf.explorer.server import PageServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="module")
def both() -> Iterator[tuple[PageServer, Client]]:
    with served(Case.from_namelist(FIG12)) as found:
        yield found


@pytest.fixture(scope="module")
def server(both: tuple[PageServer, Client]) -> PageServer:
    return both[0]


@pytest.fixture(scope="module")
def client(both: tuple[PageServer, Client]) -> Client:
    return both[1]


@pytest.fixture(scope="module")
def start(client: Client) -> dict[str, Any]:
    return client.ask("/api/start", {})


@pytest.fixture(scope="module")
def state(start: dict[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = start["state"]
    return found


@pytest.fixture
def show(browser: Browser, server: PageServer) -> Iterator[Open]:
    """Open the page; at the end nothing may stand in its console, nothing may have been fetched."""
    opened: list[Opened] = []

    def show(address: str = "", **words: object) -> Opened:
        words = {"viewport": DESK, "reduced_motion": "reduce"} | words
        found = Opened(browser.new_context(**words), address or server.address)
        opened.append(found)
        return found

    yield show
    for found in opened:
        assert (found.console, found.foreign) == ([], [])
        found.page.context.close()
