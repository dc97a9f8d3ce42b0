"""States of the page of `rwmf explore`: examples, undo, links, pinned states, keyboard, phone."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest
import rwmf
from browser import launch
from explorer_page import DESK, PHONE, Open, Opened
from rwmf import Case
from rwmf.explorer.questions import PRESETS, Preset, case_of_preset

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# longer than the pause that ends a step of the history [ms]
REST = 400


def _numbers(opened: Opened) -> dict[str, str]:
    """Return all key numbers with all digits."""
    cells = opened.page.locator("#groups-of-numbers [data-key]")
    found: dict[str, str] = cells.evaluate_all(
        "(cells) => Object.fromEntries(cells.map((x) => [x.dataset.key, x.dataset.exact]))"
    )
    return found


def _set(opened: Opened, name: str, value: object) -> None:
    """Type a value and rest, so that it is one step of the history."""
    opened.set(name, str(value))
    opened.page.wait_for_timeout(REST)


def _press(opened: Opened, name: str) -> None:
    opened.page.get_by_role("button", name=name, exact=True).click()
    opened.page.wait_for_timeout(100)
    opened.settle()


@pytest.mark.parametrize("preset", PRESETS, ids=lambda preset: preset.name)
def test_an_example_is_its_namelist(show: Open, preset: Preset) -> None:
    """The page computes the numbers of the shipped file, and shows the sentence."""
    opened = show()
    opened.choose("preset", preset.name)
    assert opened.page.locator("#sentence").text_content() == preset.sentence
    case = case_of_preset(preset.name)
    text = opened.page.locator("#namelist").text_content()
    assert Case.from_text(text) == case
    expected = rwmf.simulate(case)
    key = "u_s_max_m" if case.frame is not None else "theta_max_over_alpha"
    assert opened.number(key) == repr(float(expected[key.removesuffix("_m")]))


def test_the_sentence_of_the_block_is_true() -> None:
    case = case_of_preset("block")
    assert case.motion.a_max_g == 0.35
    assert not rwmf.simulate(case).overturned
    assert rwmf.simulate(case.replace(motion={"a_max_g": 0.40})).overturned


def test_ten_steps_back_and_forth(show: Open) -> None:
    """Values, choices, groups, quantity, pinned state and examples are undone and redone."""
    opened = show()
    page = opened.page
    seen = [_numbers(opened)]

    def step(action: Callable[[], object]) -> None:
        action()
        opened.settle()
        page.wait_for_timeout(REST)
        seen.append(_numbers(opened))

    step(lambda: _set(opened, "wall.b", 0.61))
    step(lambda: _set(opened, "frame.T_s", 0.7))
    step(lambda: opened.field("model.formulation").select_option("exact"))
    step(lambda: opened.page.locator("#add-yielding").click())
    step(lambda: page.locator("#pin").click())
    step(lambda: _set(opened, "motion.a_max_g", 0.55))
    step(lambda: page.select_option("#quantity", "theta_max_over_alpha"))
    step(lambda: opened.page.select_option("#preset", "block"))
    step(lambda: _set(opened, "motion.a_max_g", 0.4))
    step(lambda: page.get_by_role("button", name="Reset").click())
    assert len({str(numbers) for numbers in seen}) >= 7
    for numbers in reversed(seen[:-1]):
        _press(opened, "Undo")
        assert _numbers(opened) == numbers
    assert page.locator("#undo").is_disabled()
    assert page.url == page.url.split("&")[0]
    for numbers in seen[1:]:
        _press(opened, "Redo")
        assert _numbers(opened) == numbers
    assert page.locator("#redo").is_disabled()
    # the browser's own button and the keyboard take the same steps
    page.go_back()
    opened.settle()
    assert _numbers(opened) == seen[-2]
    page.locator("#play").focus()
    page.keyboard.press("Control+z")
    page.wait_for_timeout(100)
    opened.settle()
    assert _numbers(opened) == seen[-3]
    page.keyboard.press("Control+y")
    page.wait_for_timeout(100)
    opened.settle()
    assert _numbers(opened) == seen[-2]
    # a change drops the steps that were undone
    _set(opened, "wall.b", 0.45)
    assert page.locator("#redo").is_disabled()


def test_a_link_opens_the_same_state_in_another_browser(show: Open, browser: Browser) -> None:
    opened = show()
    opened.choose("preset", "six_storeys")
    opened.page.locator("#pin").click()
    _set(opened, "motion.a_max_g", 0.25)
    opened.choose("quantity", "storey_drift_max")
    opened.page.wait_for_timeout(REST)
    # a second program with an empty profile
    other = launch(browser.browser_type)
    second = Opened(other.new_context(viewport=DESK, reduced_motion="reduce"), opened.page.url)
    assert _numbers(second) == _numbers(opened)
    assert second.page.locator("#preset").input_value() == "six_storeys"
    assert second.page.locator("#quantity").input_value() == "storey_drift_max"
    assert second.page.locator("#pin").get_attribute("aria-pressed") == "true"
    lines = "explorer.pictures.spectrum.data.map((x) => Array.from(x))"
    assert second.page.evaluate(lines) == opened.page.evaluate(lines)
    assert (second.console, second.foreign) == ([], [])
    other.close()


def test_a_link_with_an_uploaded_record(show: Open) -> None:
    opened = show()
    t = np.arange(0.0, 4.0, 0.01)
    content = "\n".join(f"{x:.6g},{0.4 * math.sin(6 * x) * (x < 2):.6g}" for x in t).encode()
    before = _numbers(opened)
    opened.page.locator("#file").set_input_files(
        {"name": "own.csv", "mimeType": "text/csv", "buffer": content}
    )
    opened.page.get_by_text("own.csv: 3.99 s").wait_for()
    opened.settle()
    opened.page.wait_for_timeout(REST)
    with_record = _numbers(opened)
    _press(opened, "Undo")
    assert _numbers(opened) == before
    _press(opened, "Redo")
    assert _numbers(opened) == with_record
    second = show(opened.page.url)
    assert _numbers(second) == with_record
    assert "own.csv" in str(second.page.locator("#place").text_content())


def test_a_pinned_state_stays(show: Open) -> None:
    opened = show()
    alone = opened.page.evaluate("Array.from(explorer.pictures.charts.u_s.data[1])")
    opened.page.locator("#pin").click()
    opened.settle()
    _set(opened, "frame.T_s", 0.6)
    # another end of the run, another axis of time
    opened.open_all()
    _set(opened, "solver.t_end", 5)
    time, now, pinned = opened.page.evaluate(
        "explorer.pictures.charts.u_s.data.map((x) => Array.from(x))"
    )
    assert time[-1] == pytest.approx(5.0)
    expected = np.interp(time, np.linspace(0, 10, len(alone)), alone)
    assert np.allclose(pinned, expected, atol=1e-3 * max(alone))
    assert not np.allclose(now, pinned, atol=0.1 * max(alone))
    assert opened.page.evaluate("explorer.stage.ghost !== null")
    legend = opened.page.locator("#spectrum .u-legend").text_content()
    assert "pinned" in str(legend)
    # one comparison at a time
    opened.page.locator("#compare").click()
    opened.settle()
    assert opened.page.locator("#pin").get_attribute("aria-pressed") == "false"
    assert opened.page.evaluate("explorer.stage.ghost") is None


def test_lists_of_storeys_have_sliders(show: Open) -> None:
    opened = show()
    opened.choose("preset", "six_storeys")
    opened.open_all()
    before = opened.page.evaluate("explorer.scene.get('storeys.k')")
    third = opened.page.locator('[id="storeys.k:slider:3"]')
    third.focus()
    opened.page.keyboard.press("ArrowLeft")
    opened.settle()
    after = opened.page.evaluate("explorer.scene.get('storeys.k')")
    assert [i for i in range(6) if after[i] != before[i]] == [2]
    assert opened.field("storeys.k").input_value().split(", ")[2] == f"{after[2] / 1e3:g}"
    opened.page.locator('[id="storeys.k:slider"]').focus()
    for _ in range(3):
        opened.page.keyboard.press("ArrowRight")
    opened.settle()
    scaled = opened.page.evaluate("explorer.scene.get('storeys.k')")
    assert np.allclose(np.divide(scaled, after), scaled[0] / after[0], rtol=1e-5)
    assert scaled[0] > after[0]
    # heights and the height of the wall follow each other
    opened.page.locator('[id="storeys.height:slider:1"]').focus()
    opened.page.keyboard.press("ArrowRight")
    opened.settle()
    assert opened.problem == ""
    heights = opened.page.evaluate("explorer.scene.get('storeys.height')")
    assert opened.page.evaluate("explorer.scene.get('wall.h')") == pytest.approx(sum(heights) / 2)
    _set(opened, "wall.h", 12)
    assert opened.problem == ""
    assert sum(opened.page.evaluate("explorer.scene.get('storeys.height')")) == pytest.approx(24)


def test_six_storeys_show_the_numbers_of_the_run(show: Open) -> None:
    """Headline, groups, profile and hinges are those of the package; forces in kN, stresses in MPa.

    The key numbers have the words of `rwmf run`; a ratio gives way to its force in N.
    """
    opened = show()
    opened.choose("preset", "six_storeys")
    headline = str(opened.page.locator("#numbers").text_content())
    case = case_of_preset("six_storeys")
    run = rwmf.simulate(case.replace(output={"reactions": True}), dt=0.01)
    assert "interstorey drift (IDR)" in str(run)
    for line in str(run).splitlines()[1:7]:
        assert line[26:].strip() in headline, line
    shown = _numbers(opened)
    assert "tendon_force_max_N" in shown
    assert "tendon_force_max_over_m_w_g" not in shown
    profile, times = opened.page.evaluate(
        "[explorer.stage.motion.profile, explorer.stage.motion.yieldTimes.map(String)]"
    )
    assert profile["drift"] == pytest.approx(run.storeys_drift_max.values, rel=1e-12)
    assert profile["acceleration"] == pytest.approx(run.floors_acceleration_max_g.values, rel=1e-12)
    ductility = run.storeys_ductility.values
    assert np.divide(profile["drift"], profile["yield"]) == pytest.approx(ductility, rel=1e-9)
    drifts = np.abs(run.storeys_drift.transpose("time", "storey").values)
    for i, (text, ratio) in enumerate(zip(times, ductility, strict=True)):
        assert (text == "Infinity") == (ratio <= 1.0)
        if ratio > 1.0:
            first = run.time.values[np.argmax(drifts[:, i] > profile["yield"][i])]
            assert float(text) == pytest.approx(first, abs=0.02)
    opened.open_all()
    assert opened.field("fuse.F_y").input_value() == "120"
    assert opened.field("cable.initial_stress").input_value() == "500"
    _set(opened, "fuse.F_y", "150.3")
    assert "F_y = 150300.0" in str(opened.page.locator("#namelist").text_content())
    units = opened.page.locator(".key .unit").all_text_contents()
    assert {"kN", "MPa", "kN/m"} <= set(units)
    assert not {"N", "Pa", "N/m"} & set(units)
    cell = opened.page.locator('[data-key="tendon_force_max_N"]')
    newtons = float(str(cell.get_attribute("data-exact")))
    assert float(str(cell.text_content())) == pytest.approx(1e-3 * newtons, rel=1e-4)
    assert " kN" in str(cell.locator("..").text_content())
    opened.choose("quantity", "base_shear_max_N")
    assert opened.page.evaluate("explorer.pictures.spectrum.labels[1]").endswith("[kN]")
    marked = opened.page.evaluate("explorer.pictures.marker.value")
    assert marked == pytest.approx(1e-3 * float(opened.number("base_shear_max_N")))


def test_the_picture_stays_visible_on_a_phone(show: Open) -> None:
    opened = show(viewport=PHONE, has_touch=True)
    opened.choose("preset", "six_storeys")
    opened.page.get_by_text("Sliders", exact=True).click()
    opened.open_all()
    opened.page.wait_for_timeout(200)
    for name in ("wall.b:slider", "storeys.k:slider:6", "solver.t_end:slider"):
        slider = opened.page.locator(f'[id="{name}"]')
        slider.scroll_into_view_if_needed()
        canvas, panel = (opened.page.locator(x).bounding_box() for x in ("#stage", "aside"))
        box = slider.bounding_box()
        assert panel["y"] <= box["y"] < PHONE["height"]
        assert canvas["y"] >= 0
        assert canvas["y"] + canvas["height"] <= panel["y"]
    # also where the page is scrolled to the histories
    opened.page.locator("#theta").scroll_into_view_if_needed()
    canvas, panel = (opened.page.locator(x).bounding_box() for x in ("#stage", "aside"))
    assert 0 <= canvas["y"] <= canvas["y"] + canvas["height"] <= panel["y"]
