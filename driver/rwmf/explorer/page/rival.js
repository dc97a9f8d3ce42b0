// The second curve: a pinned state, or the other formulation of the equations.

import { byId, copy } from "./format.js";



export class Rival {
  constructor(scene, changed) {
    this.scene = scene;
    this.clear();
    byId("compare").addEventListener("click", () => {
      this.take(this.kind === "formulation" ? "" : "formulation");
      changed();
    });
    byId("pin").addEventListener("click", () => {
      const { groups, record } = scene.question();
      this.take(this.isPinned ? "" : "pinned", { groups, record });
      changed();
    });
  }

  clear() { this.take(""); }

  take(kind, pinned = null) {
    Object.assign(this, { kind, pinned: kind === "pinned" ? pinned : null, answer: null,
      spectra: {} });
    byId("compare").setAttribute("aria-pressed", String(kind === "formulation"));
    byId("pin").setAttribute("aria-pressed", String(kind === "pinned"));
  }

  get active() { return this.kind !== ""; }

  get isPinned() { return this.kind === "pinned"; }

  // Part of the page's state in the address, and back.
  state() {
    return this.isPinned ? { pinned: copy(this.pinned) } : this.active ? { both: true } : {};
  }

  restore(state) {
    const found = state?.pinned;
    if (this.isPinned && JSON.stringify(found) === JSON.stringify(this.pinned)) return;
    if (this.scene.fits(found?.groups)) {
      this.take("pinned", { groups: found.groups, record: String(found.record ?? "") });
    } else this.take(state?.both === true ? "formulation" : "");
  }

  question() {
    if (this.isPinned) return copy(this.pinned);
    const question = this.scene.question();
    question.groups.model = { ...question.groups.model,
      formulation: this.own === "exact" ? "published" : "exact" };
    return question;
  }

  get own() { return this.scene.get("model.formulation") ?? "exact"; }

  labels(answer, other) {
    return this.isPinned ? ["now", "pinned"]
      : [answer.scene.formulation, other.scene.formulation];
  }

  // Answers for the second curve. `ask` sends a question; a pinned history is computed once.
  async history(ask) {
    if (!this.isPinned) return ask(this.question());
    const { pinned } = this;
    const answer = this.answer ?? await ask(this.question());
    if (this.pinned === pinned) this.answer = answer;
    return answer;
  }

  // Null where the other scene has no such quantity, and while a slider moves. The spectrum of a
  // pinned state is computed once for a quantity.
  async spectrum(more, isFull, ask) {
    const { pinned, spectra } = this;
    if (this.isPinned && more.quantity in spectra) return spectra[more.quantity];
    if (!isFull) return null;
    let answer = null;
    try {
      answer = await ask({ ...this.question(), ...more });
    } catch (error) {
      if (error.status !== 422) throw error;
    }
    if (pinned) spectra[more.quantity] = answer;
    return answer;
  }
}
