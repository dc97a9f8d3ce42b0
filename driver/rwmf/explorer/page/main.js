// The page: one question to the server at a time, then the newest state of the sliders, so that no
// queue builds up.

import { Address } from "./address.js";
import { ask, unpack } from "./bridge.js";
import { Clock } from "./clock.js";
import { Controls } from "./controls.js";
import { CostPanel } from "./cost.js";
import { copyNamelist, saveFigure, saveNamelist } from "./files.js";
import { byId, element, short } from "./format.js";
import { showLoops } from "./loops.js";
import { Motion } from "./motion.js";
import { showCaptions, showNamelist, showNumbers, showProblem, showWarnings } from "./numbers.js";
import { Phase } from "./phase.js";
import { Pictures, bare, mapValues } from "./pictures.js";
import { Rival } from "./rival.js";
import { Scene } from "./scene.js";
import { Upload } from "./upload.js";
import { Stage } from "./wall.js";

const FULL = 200; // periods of a spectrum
const COARSE = 16; // and the fewest while a slider moves
const BUDGET = 0.06; // time of a spectrum while a slider moves [s]
const SKIPPED = 2; // spectra left out in turn while a slider moves, if one takes longer
const OLD = 1000; // a longer computation greys the earlier pictures [ms]
const LONG = 0.2; // a longer spectrum is shown in few periods first [s]
const PAUSE = 300; // rest of the sliders that ends a step of the history [ms]
// an outdated computation is stopped after this time [ms]
const PATIENCE = { history: 600, spectrum: 120 };

class Explorer {
  constructor(description) {
    this.version = 1;
    this.shown = { history: 0, spectrum: 0 };
    this.running = false;
    this.perPeriod = 0;
    this.skipped = 0;
    this.quantity = "";
    this.scene = new Scene(description, (anew) => this.touch(anew));
    this.controls = new Controls(this.scene);
    this.cost = new CostPanel(this.scene);
    this.upload = new Upload(this.scene);
    this.rival = new Rival(this.scene, () => this.touch(false));
    this.pictures = new Pictures((t) => this.clock.seek(t), (T) => this.pickPeriod(T));
    this.phase = new Phase();
    this.stage = new Stage(byId("stage"), byId("factor"), () => this.clock.pause(),
      description.read_only ? null : (share) => this.letGo(share));
    this.clock = new Clock((t) => {
      for (const picture of [this.pictures, this.phase]) picture.mark(t);
      this.stage.draw(t);
    });
    this.address = new Address((state) => this.restore(state));
    document.title = `${description.name} – rwmf explore`;
    this.offerPresets(description);
    this.buttons();
    if (description.read_only) this.forbidChanges();
    this.restore(this.address.read());
  }

  buttons() {
    const press = (name, action) => byId(name).addEventListener("click", action);
    press("reset", () => {
      this.controls.ranges.clear();
      this.upload.reset();
      this.rival.clear();
      this.quantity = "";
      this.scene.load("");
    });
    press("undo", () => this.go(-1));
    press("redo", () => this.go(1));
    press("save", () => saveNamelist(this.scene));
    press("copy", (event) => copyNamelist(event.target));
    press("figure", () => saveFigure(this.pictures, this.scene.description.name));
    press("lecture", () => this.lecture(!document.documentElement.matches(".lecture")));
    document.addEventListener("fullscreenchange", () => {
      if (!document.fullscreenElement) this.lecture(false);
    });
    byId("quantity").addEventListener("change", (event) => {
      this.quantity = event.target.value;
      this.touch(false);
    });
    addEventListener("keydown", (event) => {
      // a text field has its own undo
      if (!(event.ctrlKey || event.metaKey) || event.target.matches("input:not([type=range])")) {
        return;
      }
      const key = event.key.toLowerCase();
      if (key === "z") this.go(event.shiftKey ? 1 : -1);
      else if (key === "y") this.go(1);
      else return;
      event.preventDefault();
    });
    // what sticks below the header must not lie under it
    const header = document.querySelector("header");
    new ResizeObserver(() => document.documentElement.style
      .setProperty("--header", `${header.offsetHeight}px`)).observe(header);
    const phone = matchMedia("(max-width: 760px)");
    byId("panel").addEventListener("toggle", ({ target }) => {
      document.body.classList.toggle("sliding", target.open);
      // the sliders cover the lower half: the picture moves to the top
      if (phone.matches && target.open) byId("stage").closest(".card").scrollIntoView();
    });
    if (phone.matches) byId("panel").open = false;
  }

  letGo(share) {
    this.clock.rewind();
    this.scene.release(share);
  }

  // Full screen for an audience: wall, phase portrait and sliders, in large letters.
  lecture(on) {
    document.documentElement.classList.toggle("lecture", on);
    byId("lecture").setAttribute("aria-pressed", String(on));
    // a frame of a notebook may not fill the screen
    if (on) document.documentElement.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement) document.exitFullscreen();
    this.pictures.remake();
    this.phase.make();
    this.clock.set(this.clock.t);
  }

  // A copy with stored answers is a film of its examples.
  forbidChanges() {
    document.body.classList.add("read-only");
    this.report = () => {
      byId("status").textContent = "film of stored answers: rwmf explore has sliders";
    };
  }

  offerPresets({ presets, name }) {
    const select = byId("preset");
    select.replaceChildren(element("option", { value: "" }, name),
      ...presets.map((preset) => element("option", { value: preset.name }, preset.title)));
    select.addEventListener("change", () => {
      this.controls.ranges.clear();
      this.quantity = "";
      this.scene.load(select.value);
    });
  }

  // The whole state of the page for the address, null at the beginning.
  state() {
    const { quantity } = this;
    const parts = { ...this.scene.state(), ...(quantity ? { quantity } : {}),
      ...this.rival.state() };
    return Object.keys(parts).length ? parts : null;
  }

  restore(state) {
    clearTimeout(this.remembering);
    const word = state?.quantity;
    this.quantity = typeof word === "string" ? word : "";
    this.rival.restore(state);
    this.restoring = true;
    this.scene.restore(state);
    this.restoring = false;
  }

  // One step in the history of states; an unfinished step is completed first.
  go(step) {
    this.remember();
    if (step < 0 ? this.address.canUndo : this.address.canRedo) history.go(step);
  }

  remember() {
    clearTimeout(this.remembering);
    this.address.write(this.state());
    this.showSteps();
  }

  showSteps() {
    byId("undo").disabled = !this.address.canUndo;
    byId("redo").disabled = !this.address.canRedo;
  }

  // Something has changed. `anew`: it needs other controls.
  touch(anew) {
    this.version++;
    this.touched = performance.now();
    if (anew) {
      this.controls.build();
      // another scene may take longer
      this.perPeriod = 0;
    } else this.controls.refresh();
    const { preset, description } = this.scene;
    byId("preset").value = preset;
    byId("sentence").textContent = description.presets.find(({ name }) => name === preset)
      ?.sentence ?? description.sentence ?? "";
    this.cost.age();
    clearTimeout(this.remembering);
    if (this.restoring) this.showSteps();
    else this.remembering = setTimeout(() => this.remember(), PAUSE);
    this.hurry();
    if (!this.running) this.run();
  }

  // Stop the outdated computation soon.
  hurry() {
    const { flight } = this;
    if (!flight || flight.timer) return;
    flight.timer = setTimeout(() => flight.abort.abort(), PATIENCE[flight.kind]);
  }

  async run() {
    this.running = true;
    while (this.shown.history !== this.version || this.shown.spectrum !== this.version) {
      const { version, touched } = this;
      try {
        if (this.shown.history !== version) await this.updateHistory(version, touched);
        if (this.shown.history === version) await this.updateSpectrum(version, touched);
      } catch (error) {
        if (error.name === "AbortError") continue;
        console.info(error.message);
        this.controls.blame(error.message);
        showProblem(error.message);
        byId("status").textContent = "";
        // do not repeat a refused question
        this.shown = { history: version, spectrum: version };
      }
    }
    this.running = false;
  }

  async question(kind, body, version) {
    const abort = new AbortController();
    this.flight = { kind, abort };
    if (this.version !== version) this.hurry();
    const patience = setTimeout(() => { byId("status").textContent = "computing …"; }, 300);
    // the pictures belong to another state until the answer
    const old = kind === "history" ? byId("pictures") : byId("spectrum").parentElement;
    const aging = setTimeout(() => old.classList.add("stale"), OLD);
    try {
      return await ask(`/api/${kind}`, body, abort.signal);
    } finally {
      clearTimeout(patience);
      clearTimeout(aging);
      clearTimeout(this.flight.timer);
      this.flight = null;
    }
  }

  async updateHistory(version, touched) {
    const answer = await this.question("history", this.scene.question(), version);
    let refused = "";
    let other = null;
    if (this.rival.active && this.version === version) {
      try {
        other = await this.rival.history((body) => this.question("history", body, version));
      } catch (error) {
        if (error.status !== 422) throw error;
        refused = error.message;
      }
    }
    this.answer = answer;
    this.other = other;
    showProblem("");
    this.controls.blame("");
    const columns = mapValues(answer.columns, unpack);
    const own = motionOf(answer, columns);
    const ghost = other && motionOf(other, mapValues(other.columns, unpack));
    const labels = other && this.rival.labels(answer, other);
    this.pictures.drawHistory(answer, columns, ghost && { columns: ghost.columns, labels });
    this.stage.show(own, this.rival.isPinned ? ghost : null);
    this.phase.show(own, ghost?.columns);
    this.clock.follow(columns, own.impacts);
    showLoops(answer.loops);
    showNumbers(answer);
    showCaptions(answer);
    showWarnings(answer, other, refused, (group) => this.controls.goTo(group));
    showNamelist(answer, this.scene);
    this.shown.history = version;
    this.report("history", answer, touched);
  }

  async updateSpectrum(version, touched) {
    // while a slider moves the spectrum has the periods that fit the budget, then all of them
    const moving = this.version !== version;
    const isKnown = this.perPeriod > 0;
    if (moving && this.perPeriod * COARSE > BUDGET && this.skipped < SKIPPED) {
      this.skipped += 1;
      return;
    }
    this.skipped = 0;
    // the first answer leaves out periods with very many steps
    const quick = this.coarse !== version;
    const slow = (!isKnown || this.perPeriod * FULL > LONG) && quick;
    const afford = isKnown ? Math.floor(BUDGET / this.perPeriod) : COARSE;
    const points = moving || slow ? Math.min(FULL, Math.max(COARSE, afford)) : FULL;
    const more = { points, quick, quantity: this.quantity };
    let answer;
    try {
      answer = await this.question("spectrum", this.scene.question(more), version);
    } catch (error) {
      if (error.status !== 422) throw error;
      byId("spectrum").parentElement.classList.remove("stale");
      if (this.quantity) {
        // this scene does not have the quantity
        this.quantity = "";
        return;
      }
      byId("failed").textContent = error.message;
      byId("comparison").textContent = "";
      this.pictures.spectrum.clear();
      this.shown.spectrum = version;
      return;
    }
    const { key } = answer.quantity;
    const isComplete = points === FULL && !(quick && answer.failed.too_many_steps);
    const other = this.other && await this.rival.spectrum({ points, quantity: key },
      isComplete, (body) => this.question("spectrum", body, version));
    byId("spectrum").parentElement.classList.remove("stale");
    this.perPeriod = answer.kernel_seconds / points;
    this.coarse = version;
    // the peak of a run that ended early is none
    const numbers = new Map(this.answer.numbers);
    const isDown = numbers.get("overturned") === "yes" || numbers.get("collapsed") === "yes";
    const value = isDown ? NaN : Number(numbers.get(key) ?? NaN);
    this.pictures.drawSpectrum(answer, other, { T: this.answer.scene.T, value });
    this.offer(answer);
    const failed = Object.entries(answer.failed)
      .map(([status, n]) => `${n} ${status.replaceAll("_", " ")}`).join(", ");
    byId("failed").textContent = `${points} periods${answer.axis[1] ? ` (${answer.axis[1]})` : ""}`
      + `${failed && `, of these ${failed}`}.`
      + (this.canPickPeriod ? " A click sets the period." : "");
    byId("comparison").textContent = answer.caption;
    if (isComplete || this.version !== version) this.shown.spectrum = version;
    this.report("spectrum", answer, touched, points);
  }

  // Time in the kernel, and from the slider to the screen.
  report(what, answer, touched, points) {
    const kernel = 1e3 * answer.kernel_seconds;
    this.seconds = { ...this.seconds, [what]: kernel };
    byId("status").textContent = `kernel: ${Object.entries(this.seconds)
      .map(([name, ms]) => `${name} ${short(ms, 2)} ms`).join(", ")}`;
    requestAnimationFrame(() => performance.measure(what,
      { start: touched, end: performance.now(), detail: { kernel, points } }));
  }

  offer(answer) {
    const select = byId("quantity");
    const keys = answer.quantities.map(([key]) => key).join();
    if (select.dataset.keys !== keys) {
      select.dataset.keys = keys;
      select.replaceChildren(...answer.quantities.map(([key, help]) =>
        element("option", { value: key }, `${help} (${bare(key)})`)));
    }
    select.value = answer.quantity.key;
  }

  get canPickPeriod() {
    return this.scene.get("frame.T_s") !== undefined && !this.scene.description.read_only;
  }

  pickPeriod(T) {
    if (!this.canPickPeriod) return;
    this.scene.set("frame.T_s", Number(T.toPrecision(3)));
  }
}

const motionOf = (answer, columns) => new Motion(answer, columns,
  answer.ground ? unpack(answer.ground) : null, unpack(answer.impacts));

try {
  window.explorer = new Explorer(await ask("/api/start", {}));
} catch (error) {
  showProblem(error.message);
}
