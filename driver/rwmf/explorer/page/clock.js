// One time for all pictures: it runs, or stays at a time; first at the largest rotation.

import { byId } from "./format.js";

export class Clock {
  constructor(moved) {
    this.moved = moved;
    this.t = 0;
    this.end = 1;
    this.impacts = [];
    this.playing = false;
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
    // one pass without a click shows rocking, unless the user prefers reduced motion
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

  // Begin anew with the next answer.
  rewind() {
    this.pause();
    this.placed = true;
    this.first = !this.still.matches;
    this.t = 0;
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
