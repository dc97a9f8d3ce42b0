// Shipped record, or upload of a file; its state in one line.

import { ask } from "./bridge.js";
import { byId, element } from "./format.js";

export class Upload {
  constructor(scene) {
    this.scene = scene;
    this.count = 0;
    // the same file may be chosen again: its content may have changed
    byId("file").addEventListener("click", (event) => { event.target.value = ""; });
    byId("file").addEventListener("change", (event) => {
      this.file = event.target.files[0] ?? this.file;
      this.send();
    });
    byId("upload").addEventListener("submit", (event) => event.preventDefault());
    const { records } = scene.description;
    byId("shipped").append(...Object.entries(records).map(([name, title]) =>
      element("option", { value: name }, title)));
    byId("shipped").addEventListener("change", ({ target }) => {
      this.file = null;
      if (target.value) this.add(target.value, { shipped: target.value }, "");
    });
    for (const name of ["unit", "interval"]) byId(name)
      .addEventListener("change", () => this.send());
  }

  reset() {
    this.file = null;
    this.count++;
    byId("upload").reset();
    byId("upload-state").textContent = "";
  }

  async send() {
    const { file } = this;
    if (!file) return;
    const interval = byId("interval").value.trim();
    byId("shipped").value = "";
    await this.add(file.name, { name: file.name, unit: byId("unit").value,
      ...(interval ? { dt: interval } : {}) }, file);
  }

  async add(name, words, content) {
    const state = byId("upload-state");
    state.className = "";
    state.textContent = `reading ${name} …`;
    const mine = ++this.count;
    try {
      const answer = await ask(`/api/record?${new URLSearchParams(words)}`, content);
      // another file or a reset has replaced this upload
      if (mine !== this.count) return;
      state.textContent = `${answer.name}: ${answer.facts}`;
      this.scene.useRecord(answer);
    } catch (error) {
      if (mine !== this.count) return;
      state.className = "wrong";
      state.textContent = error.message;
    }
  }
}
