// The page: one question to the server at a time, and the newest state of the sliders next. No
// queue can build up, however fast a hand moves and however slow a case is.

import { ask, unpack } from "./bridge.js";
import { Controls } from "./controls.js";
import { CostPanel } from "./cost.js";
import { panel, sheet } from "./figure.js";
import { byId, element, save, short } from "./format.js";
import { showNamelist, showNumbers, showProblem, showWarnings } from "./numbers.js";
import { Pictures, bare } from "./pictures.js";
import { Scene } from "./scene.js";
import { Stage } from "./wall.js";

const FULL = 200; // periods of a spectrum
const COARSE = 16; // and the fewest while a hand moves
const BUDGET = 0.06; // time of a spectrum while a hand moves [s]
const OLD = 1000; // what takes longer greys the pictures of before [ms]
const LONG = 0.2; // a spectrum that takes longer is shown in few periods first [s]
// what is not wanted any more may go on so long before it is called off [ms]
const PATIENCE = { history: 600, spectrum: 120 };

class Explorer {
  constructor(description) {
    this.version = 1;
    this.uploads = 0;
    this.shown = { history: 0, spectrum: 0 };
    this.running = false;
    this.perPeriod = 0;
    this.quantity = "";
    this.scene = new Scene(description, (anew) => this.touch(anew));
    this.controls = new Controls(this.scene);
    this.cost = new CostPanel(this.scene);
    this.pictures = new Pictures((t) => this.clock.seek(t), (T) => this.pickPeriod(T));
    this.stage = new Stage(byId("stage"), byId("factor"));
    this.clock = new Clock((t) => { this.pictures.mark(t); this.stage.draw(t); });
    byId("name").textContent = `explore ${description.name}`;
    document.title = `${description.name} – rwmf explore`;
    this.buttons();
    this.controls.build();
    this.touched = 0;
    this.run();
  }

  buttons() {
    byId("reset").addEventListener("click",
      () => {
        this.controls.ranges.clear();
        this.file = null;
        this.uploads++;
        byId("upload").reset();
        byId("upload-state").textContent = "";
        this.compare(false);
        this.scene.reset();
      });
    byId("save").addEventListener("click", () => this.saveNamelist());
    byId("copy").addEventListener("click", (event) => this.copy(event.target));
    byId("figure").addEventListener("click", () => this.saveFigure());
    byId("compare").addEventListener("click", () => {
      this.compare(!this.comparing);
      this.touch(false);
    });
    byId("quantity").addEventListener("change", (event) => {
      this.quantity = event.target.value;
      this.touch(false);
    });
    // the same file may be chosen again: it may be another by then
    byId("file").addEventListener("click", (event) => { event.target.value = ""; });
    byId("file").addEventListener("change", (event) => {
      this.file = event.target.files[0] ?? this.file;
      this.upload();
    });
    byId("upload").addEventListener("submit", (event) => event.preventDefault());
    for (const name of ["unit", "interval"]) byId(name)
      .addEventListener("change", () => this.upload());
    if (matchMedia("(max-width: 760px)").matches) byId("panel").open = false;
  }

  compare(both) {
    this.comparing = both;
    byId("compare").setAttribute("aria-pressed", String(both));
  }

  // Something has changed. `anew`: other controls than the one under the hand as well.
  touch(anew) {
    this.version++;
    this.touched = performance.now();
    if (anew) this.controls.build();
    this.cost.age();
    clearTimeout(this.remembering);
    this.remembering = setTimeout(() => this.scene.remember(), 300);
    this.hurry();
    if (!this.running) this.run();
  }

  // What is being asked is not wanted any more.
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
        // what cannot be shown is not asked again
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
    // what stands there is of another state; the answer takes the mark away
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

  otherFormulation() {
    const own = this.scene.get("model.formulation") ?? "exact";
    const question = this.scene.question();
    question.groups.model = { ...question.groups.model,
      formulation: own === "exact" ? "published" : "exact" };
    return question;
  }

  async updateHistory(version, touched) {
    const answer = await this.question("history", this.scene.question(), version);
    let other = null;
    let refused = "";
    if (this.comparing && this.version === version) {
      try {
        other = await this.question("history", this.otherFormulation(), version);
      } catch (error) {
        if (error.status !== 422) throw error;
        refused = error.message;
      }
    }
    this.answer = answer;
    this.other = other;
    showProblem("");
    this.controls.blame("");
    this.pictures.drawHistory(answer, other);
    const { columns, impacts } = this.pictures;
    this.stage.show(answer.scene, columns, answer.ground ? unpack(answer.ground) : null, impacts);
    this.clock.follow(columns, impacts);
    this.drawLoops(answer.loops);
    showNumbers(answer);
    showWarnings(answer, other, refused);
    showNamelist(answer, this.scene);
    this.shown.history = version;
    this.report("history", answer, touched);
  }

  async updateSpectrum(version, touched) {
    // a hand that moves on gets what it can have in time; the full spectrum comes when it stops
    const moving = this.version !== version;
    const slow = this.perPeriod * FULL > LONG && this.coarse !== version;
    const afford = this.perPeriod > 0 ? Math.floor(BUDGET / this.perPeriod) : FULL;
    const points = moving || slow ? Math.min(FULL, Math.max(COARSE, afford)) : FULL;
    const more = { points, quantity: this.quantity };
    let answer;
    try {
      answer = await this.question("spectrum", this.scene.question(more), version);
    } catch (error) {
      if (error.status !== 422) throw error;
      byId("spectrum").parentElement.classList.remove("stale");
      if (this.quantity) {
        // a quantity that this scene does not have
        this.quantity = "";
        return;
      }
      byId("failed").textContent = error.message;
      this.pictures.spectrum.clear();
      this.shown.spectrum = version;
      return;
    }
    let other = null;
    if (this.comparing && this.other && points === FULL) {
      other = await this.question("spectrum", { ...this.otherFormulation(), ...more }, version);
    }
    byId("spectrum").parentElement.classList.remove("stale");
    this.perPeriod = answer.kernel_seconds / points;
    this.coarse = version;
    const { key } = answer.quantity;
    const own = this.answer.numbers.find((row) => row[0] === key);
    this.pictures.drawSpectrum(answer, other,
      { T: this.answer.scene.T, value: own ? Number(own[1]) : NaN });
    this.offer(answer);
    const failed = Object.entries(answer.failed)
      .map(([status, n]) => `${n} ${status.replaceAll("_", " ")}`).join(", ");
    byId("failed").textContent = `${points} periods${failed && `, of these ${failed}`}.`
      + (this.scene.get("frame.T_s") === undefined ? "" : " A click sets the period.");
    if (points === FULL || this.version !== version) this.shown.spectrum = version;
    this.report("spectrum", answer, touched, points);
  }

  // Seconds of the kernel beside those from hand to screen.
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
        element("option", { value: key, title: help }, bare(key))));
    }
    select.value = answer.quantity.key;
  }

  drawLoops(loops) {
    const kinds = new Map();
    for (const loop of loops) {
      const kind = loop.spring.split(" ").at(-1);
      kinds.set(kind, [...(kinds.get(kind) ?? []), loop]);
    }
    const abscissa = { frame: "u_s [mm]", cable: "elongation [mm]",
      fuse: "uplift of its corner [mm]" };
    byId("loops").replaceChildren(...[...kinds].map(([kind, all]) => panel(all.map((loop) => ({
      x: Array.from(unpack(loop.displacement), (x) => (x === null ? null : 1e3 * x)),
        y: unpack(loop.force),
      label: all.length > 1 ? loop.spring : "" })),
        { title: kind, xLabel: abscissa[kind], yLabel: all[0].label })));
    if (!loops.length) byId("loops")
      .replaceChildren(element("p", { class: "hint" },
        "No cable, fuse or yielding frame in this scene."));
  }

  pickPeriod(T) {
    if (this.scene.get("frame.T_s") === undefined) return;
    this.scene.set("frame.T_s", Number(T.toPrecision(3)));
    this.controls.build();
  }

  async copy(button) {
    try {
      await navigator.clipboard.writeText(byId("namelist").textContent);
      button.textContent = "Copied";
    } catch {
      getSelection().selectAllChildren(byId("namelist"));
      button.textContent = "Selected: Ctrl-C";
    }
    setTimeout(() => { button.textContent = "Copy"; }, 1500);
  }

  // With the records that no file has, where the case came from arrays.
  async saveNamelist() {
    save("explored.nml", "text/plain", byId("namelist").textContent);
    if (!this.scene.description.made.length) return;
    const files = Object.entries(await ask("/api/made", {}));
    for (const [name, text] of files) save(name, "text/plain", text);
  }

  saveFigure() {
    const { spectrum, charts } = this.pictures;
    const named = { Spectrum: spectrum, "Displacement of the frame": charts.u_s,
      "Rotation of the wall": charts.theta, "Ground acceleration": charts.ground, "Drifts of the storeys": charts.drifts };
    const panels = Object.entries(named).filter(([, chart]) => chart.plot).map(([title, chart]) =>
      [chart.curves(), { title, xLabel: chart.labels[0], yLabel: chart.labels[1] }]);
    save("explored.svg", "image/svg+xml", sheet(panels, `rwmf: ${this.scene.description.name}`));
  }

  async upload() {
    const { file } = this;
    if (!file) return;
    const state = byId("upload-state");
    const words = new URLSearchParams({ name: file.name, unit: byId("unit").value });
    const interval = byId("interval").value.trim();
    if (interval) words.set("dt", interval);
    state.className = "";
    state.textContent = `reading ${file.name} …`;
    const mine = ++this.uploads;
    try {
      const answer = await ask(`/api/record?${words}`, file);
      // another file, or the case as it was, is wanted by now
      if (mine !== this.uploads) return;
      state.textContent = `${answer.name}: ${answer.facts}`;
      this.scene.useRecord(answer);
    } catch (error) {
      if (mine !== this.uploads) return;
      state.className = "wrong";
      state.textContent = error.message;
    }
  }
}

// One time for all pictures; it runs, stands, or waits at the largest rotation.
class Clock {
  constructor(moved) {
    this.moved = moved;
    this.t = 0;
    this.end = 1;
    this.impacts = [];
    this.playing = false;
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
    // one pass by itself shows what rocking is; not for those who want nothing to move
    this.first = !this.still.matches;
    this.slider = byId("clock");
    this.slider.addEventListener("input", () => this.seek(this.slider.value / 1000 * this.end));
    byId("play").addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    byId("next").addEventListener("click", () => this.step());
  }

  follow(columns, impacts) {
    const times = columns.time;
    this.end = times.at(-1) || 1;
    this.impacts = impacts;
    const shown = columns.theta ?? columns.u_s;
    let best = 0;
    shown.forEach((x, i) => { if (Math.abs(x ?? 0) > Math.abs(shown[best] ?? 0)) best = i; });
    this.peak = times[best];
    if (this.first) {
      this.first = false;
      this.play();
    }
    if (!this.playing && !this.placed) this.t = this.peak;
    this.set(Math.min(this.t, this.end));
  }

  set(t) {
    this.t = t;
    this.slider.value = Math.round(1000 * t / this.end);
    this.slider.setAttribute("aria-valuetext", `${t.toFixed(2)} s`);
    byId("now").textContent = `${t.toFixed(2)} s`;
    this.moved(t);
  }

  seek(t) {
    this.pause();
    this.placed = true;
    this.set(Math.min(this.end, Math.max(0, t)));
  }

  step() {
    const next = this.impacts.find((t) => t > this.t + 1e-6) ?? this.impacts[0];
    if (next !== undefined) this.seek(next);
  }

  play() {
    this.playing = true;
    this.placed = true;
    byId("play").textContent = "Pause";
    if (this.t >= this.end - 1e-6) this.t = 0;
    let before = null;
    const frame = (instant) => {
      if (!this.playing) return;
      const passed = before === null ? 0 : Math.min(0.1, (instant - before) / 1000);
      before = instant;
      const t = this.t + passed * Number(byId("speed").value);
      if (t >= this.end) {
        this.pause();
        this.placed = false;
        this.set(this.peak);
      } else {
        this.set(t);
        requestAnimationFrame(frame);
      }
    };
    requestAnimationFrame(frame);
  }

  pause() {
    this.playing = false;
    byId("play").textContent = "Play";
  }
}

try {
  window.explorer = new Explorer(await ask("/api/start", {}));
} catch (error) {
  showProblem(error.message);
}
