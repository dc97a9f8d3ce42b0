"""Read-only copy of the page for the site: opened from files, with the numbers of the package."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import rwmf
from checkout import ROOT
from explorer_page import DESK, Opened
from rwmf._explore.presets import case_of_preset

if TYPE_CHECKING:
    from playwright.sync_api import Browser


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the copy."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        from pages.explorer import write
    finally:
        sys.path.remove(str(ROOT / "tools"))
    folder = tmp_path_factory.mktemp("site") / "explorer"
    write(folder)
    return folder


@pytest.mark.parametrize("width", [1400, 390])
def test_the_copy_shows_three_cases_from_files(browser: Browser, copy: Path, width: int) -> None:
    context = browser.new_context(
        viewport=DESK | {"width": width}, reduced_motion="reduce", offline=True
    )
    opened = Opened(context, (copy / "index.html").as_uri())
    # a page of files may load its own folder only
    own = copy.as_uri()
    assert [url for url in opened.foreign if not url.startswith(own)] == []
    for name, key in (
        ("", "storey_drift_max"),
        ("wall_and_frame", "u_s_max_m"),
        ("block", "theta_max_over_alpha"),
    ):
        opened.page.select_option("#preset", name)
        opened.settle()
        opened.page.wait_for_timeout(400)
        assert opened.problem == ""
        case = case_of_preset(name or "six_storeys")
        run = rwmf.simulate(case.replace(output={"reactions": True}))
        assert opened.number(key) == repr(float(run[key.removesuffix("_m")]))
        assert opened.page.locator("#sentence").text_content() != ""
        assert opened.page.locator("#u_s canvas").count() == (name != "block")
    # comparison and history work, sliders do not
    opened.page.locator("#undo").click()
    opened.page.wait_for_timeout(200)
    opened.settle()
    assert opened.page.locator("#preset").input_value() == "wall_and_frame"
    opened.page.locator("#pin").click()
    opened.page.select_option("#preset", "")
    opened.settle()
    assert opened.page.evaluate("explorer.stage.ghost !== null")
    fields = opened.page.locator("#groups :is(input, select, button)")
    assert fields.count() > 20
    assert all(field.is_disabled() for field in fields.all())
    assert not opened.page.locator("#upload").is_visible()
    assert not opened.page.locator("#measure").is_visible()
    assert opened.console == []
    context.close()
