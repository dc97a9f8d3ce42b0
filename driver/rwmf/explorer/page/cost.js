// Cost of accuracy: error over time of every method for this case, with the axes of `rwmf cost`.

import { follow } from "./bridge.js";
import { panel } from "./figure.js";
import { byId, element, short } from "./format.js";

// an error of zero is below the digits of a number
const FLOOR = 1e-16;
const EARLIER = "Of an earlier state of the sliders. ";

export class CostPanel {
  constructor(scene) {
    this.scene = scene;
    this.running = null;
    this.of = "";
    byId("measure").addEventListener("click",
      () => (this.running ? this.running.abort() : this.measure()));
  }

  // Mark a result of another case than the one that is shown.
  age() {
    const now = JSON.stringify(this.scene.question());
    byId("cost").classList.toggle("stale", Boolean(this.of) && this.of !== now);
    const text = byId("cost-state");
    text.textContent = text.textContent.replace(EARLIER, "");
    if (this.of && this.of !== now && !this.running) text.textContent = EARLIER + text.textContent;
  }

  async measure() {
    const state = byId("cost-state");
    const button = byId("measure");
    this.running = new AbortController();
    button.textContent = "Cancel";
    state.textContent = "reference in quadruple precision …";
    const question = this.scene.question();
    try {
      const found = await follow("/api/cost", question, this.running.signal,
        ({ done, total }) => { if (done) state.textContent = `${done} of ${total} runs`; });
      this.show(found);
      this.of = JSON.stringify(question);
    } catch (error) {
      state.textContent = error.name === "AbortError" ? "Cancelled." : error.message;
    }
    this.running = null;
    button.textContent = "Measure this case";
    this.age();
  }

  show(found) {
    const good = found.rows.filter((row) => row.status === "ok" && row.relative_error !== null
      && row.seconds > 0);
    const methods = [...new Set(good.map((row) => row.method))];
    const curve = (rows, more) => ({ x: rows.map((row) => row.seconds),
      y: rows.map((row) => Math.max(row.relative_error, FLOOR)), ...more });
    const curves = methods.map((method) =>
      curve(good.filter((row) => row.method === method), { label: method, dots: 2.5 }));
    const practices = found.practices.filter((row) => row.status === "ok"
      && row.relative_error !== null);
    if (practices.length) {
      curves.push(curve(practices, { label: "usual today", colour: "ink", dots: 4, width: 0 }));
    }
    if (found.recommended) {
      curves.push(curve([found.recommended], { label: "cheapest: 1e-6", colour: "bad",
        rings: 7, width: 0 }));
    }
    const { reference, recommended } = found;
    byId("cost-state").textContent = `${reference.method}; ${reference.peak} = ${short(
      reference[reference.peak], 10)}`
      + (recommended
        ? `. Cheapest for 1e-6: ${recommended.method}, rtol = ${recommended.rtol.toExponential(
          0)}, ${short(1e3 * recommended.seconds, 3)} ms`
        : ". No setting has an error of 1e-6.")
      + (found.note && ` Caution: ${found.note}.`);
    const cell = (text) => element("td", {}, text);
    const rows = [...found.practices, ...good]
      .sort((a, b) => (a.relative_error ?? 9) - (b.relative_error ?? 9));
    const same = (row) => recommended && row.method === recommended.method
      && row.rtol === recommended.rtol;
    byId("cost").replaceChildren(
      panel(curves, { width: 560, height: 340, logX: true, logY: true,
        xLabel: "processor time of one run [s]", yLabel: "relative error of the peak" }),
      element("div", { class: "scroll", tabindex: 0, role: "region",
        "aria-label": "Table of methods" },
        element("table", {}, element("thead", {},
          element("tr", {}, ...["method", "rtol", "error", "ms", "evaluations"]
            .map((word) => element("th", { scope: "col" }, word)))),
          element("tbody", {}, ...rows.map((row) =>
            element("tr", { class: same(row) ? "best" : "" },
            element("th", { scope: "row" }, row.method),
              cell(row.rtol === null ? "–" : row.rtol.toExponential(0)),
            cell(row.status === "ok" ? short(row.relative_error, 2) : row.status.slice(0, 40)),
              cell(short(1e3 * (row.seconds ?? NaN), 3)),
            cell(String(row.rhs_evaluations))))))));
  }
}
