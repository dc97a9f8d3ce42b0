"""Fixtures of the page in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest
from explorer_page import DESK, FIG12, Open, Opened
from page_client import served
from rwmf import Case
from rwmf.explorer.server import PageServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="module")
def server() -> Iterator[PageServer]:
    with served(Case.from_namelist(FIG12)) as (found, _):
        yield found


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
