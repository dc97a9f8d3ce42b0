"""A real browser for tests of pages: Debian's chromium, headless, driven by playwright."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserType


@contextmanager
def chromium() -> Iterator[Browser]:
    """Start chromium, and end it.

    Skips the test where chromium or playwright is missing.

    Yields
    ------
    Browser
        Of playwright, without any page.
    """
    playwright = pytest.importorskip("playwright.sync_api")
    with playwright.sync_playwright() as driver:
        browser = launch(driver.chromium)
        try:
            yield browser
        finally:
            browser.close()


def launch(kind: BrowserType) -> Browser:
    """Start a chromium with an empty profile.

    Skips the test where chromium is missing.

    Parameters
    ----------
    kind : BrowserType
        Of playwright, for example that of a running browser.

    Returns
    -------
    Browser
        The browser, to be closed by the caller.
    """
    program = shutil.which("chromium-headless-shell")
    if program is None:
        pytest.skip("chromium is not installed")
    arguments = ["--disable-dev-shm-usage", "--disable-gpu"]
    if os.geteuid() == 0:
        # as root chromium ends at once with its sandbox
        arguments.append("--no-sandbox")
    return kind.launch(executable_path=program, args=arguments)
