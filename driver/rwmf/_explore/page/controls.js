// A control for every key: slider and field for numbers, a list of words for choices, a box for yes
// or no, a field for lists; keys that the case does not give stand below with what holds without
// them.

import { byId, element, short, unit } from "./format.js";

const STEPS = 500;

// Position of a slider and value of its key.
class Range {
  constructor(key, value) {
    this.low = key.low;
    this.high = key.high;
    this.log = key.log;
    this.whole = key.kind === "integer";
    this.widen(value);
  }

  // A value of the case is never outside.
  widen(value) {
    if (this.log) {
      while (value > 0 && value < this.low) this.low /= 10;
      while (value > this.high) this.high *= 10;
    } else {
      if (value < this.low) this.low = value < 0 ? 1.5 * value : 0.5 * value;
      if (value > this.high) this.high = value > 0 ? 1.5 * value : 0.5 * value;
    }
  }

  value(position) {
    const part = position / STEPS;
    if (part === 0 && !this.log) return this.whole ? Math.round(this.low) : this.low;
    if (part === 1) return this.whole ? Math.round(this.high) : this.high;
    const raw = this.log ? this.low * (this.high / this.low) ** part : this.low
      + part * (this.high - this.low);
    if (this.whole) return Math.round(raw);
    if (this.log) return Number(raw.toPrecision(3));
    // as many decimals as the step has, so that a namelist stays readable
    const decimals = Math.max(0, 1 - Math.floor(Math.log10((this.high - this.low) / STEPS)));
    return Number(raw.toFixed(Math.min(decimals, 12)));
  }

  position(value) {
    const part = this.log ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return Math.round(Math.min(1, Math.max(0, part)) * STEPS);
  }
}

export class Controls {
  constructor(scene) {
    this.scene = scene;
    this.open = new Set(["wall", "frame", "cable", "impact", "motion", "model"]);
    this.ranges = new Map();
  }

  // Build the panel anew, with the focus where it was.
  build() {
    const focus = document.activeElement?.id;
    const { scene } = this;
    byId("groups").replaceChildren(
      ...scene.description.groups.filter((group) => scene.has(group.name))
        .map((group) => this.group(group)));
    byId("absent").replaceChildren(
      ...scene.description.groups.filter((group) => !scene.has(group.name)).map((group) =>
        element("button", { type: "button", id: `add-${group.name}`, title: `&${group.name}`,
          onclick: () => {
            this.open.add(group.name);
            scene.add(group.name);
            byId(`group-${group.name}`).querySelector("summary").focus();
          } },
            `+ ${group.title}`)));
    if (focus) byId(focus)?.focus();
  }

  group(group) {
    const { scene } = this;
    const given = group.keys.filter((key) => scene.get(`${group.name}.${key.key}`) !== undefined);
    const others = group.keys.filter((key) => !given.includes(key)
      && scene.possible(`${group.name}.${key.key}`));
    const box = element("details",
      { class: "group", id: `group-${group.name}`, open: this.open.has(group.name) },
      element("summary", {}, group.title, element("span", { class: "brief" }, `&${group.name}`)),
      ...(group.name === "motion" && scene.get("motion.kind") === "record"
        ? [element("p", { class: "hint" },
          scene.recordName ? `record: ${scene.recordName}` : "Choose a file below: Own record")]
            : []),
      ...given.map((key) => this.key(group.name, key)),
      this.others(group, others));
    box.addEventListener("toggle",
      () => (box.open ? this.open.add(group.name) : this.open.delete(group.name)));
    return box;
  }

  others(group, keys) {
    const { scene } = this;
    const name = `${group.name}?`;
    const box = element("details", { class: "more", open: this.open.has(name) },
      element("summary", {}, keys.length
        ? `${keys.length} more ${keys.length > 1 ? "keys" : "key"}` : "More"),
      ...keys.map((key) => element("div", { class: "absent-key", title: key.allowed },
        element("span", {}, element("b", {}, key.key), ` ${key.help}`,
          key.default === "none" || key.default === "required" ? ""
            : ` (${`${key.default} ${unit(key.unit)}`.trim()})`),
        element("button", { type: "button", id: `set-${group.name}.${key.key}`,
          "aria-label": `Set ${key.key} of ${group.name}`,
          onclick: () => {
            scene.begin(`${group.name}.${key.key}`);
            byId(`${group.name}.${key.key}`)?.focus();
          } }, "Set"))),
      element("button", { type: "button", class: "take-out",
        onclick: () => { scene.remove(group.name); byId(`add-${group.name}`).focus(); } },
        `Take the whole group &${group.name} out`));
    box.addEventListener("toggle", () => (box.open ? this.open.add(name) : this.open.delete(name)));
    return box;
  }

  key(group, key) {
    const { scene } = this;
    const name = `${group}.${key.key}`;
    const label = element("label", { for: name, title: `${key.help}; ${key.allowed}` },
      element("b", {}, key.key), key.help);
    const parts = { real: "number", integer: "number", choice: "choice", logical: "box",
      text: "word" };
    const row = this[parts[key.kind] ?? "list"](name, key);
    const out = key.default === "required" ? element("span")
      : element("button", { type: "button", class: "out",
        title: "Take this key out: its default holds",
        "aria-label": `Take ${key.key} of ${group} out`,
        onclick: () => {
          scene.unset(name);
          const box = byId(`group-${group}`);
          (box?.querySelector(".more[open] > summary") ?? box?.querySelector("summary"))?.focus();
        } }, "×");
    row.append(element("span", { class: "unit" }, unit(key.unit)), out);
    return element("div", { class: "key" }, label, row,
      element("p", { class: "wrong", id: `${name}:wrong`, hidden: true, role: "alert" }));
  }

  number(name, key) {
    const value = this.scene.get(name);
    if (!this.ranges.has(name)) this.ranges.set(name, new Range(key, value));
    const range = this.ranges.get(name);
    range.widen(value);
    const says = (x) => `${x} ${unit(key.unit)}`.trim();
    const field = element("input",
      { type: "text", class: "field", id: name, inputmode: "decimal", value: shown(value),
      "aria-describedby": `${name}:wrong`, autocomplete: "off", title: String(value) });
    const slider = element("input",
      { type: "range", id: `${name}:slider`, min: 0, max: STEPS, step: 1,
      value: range.position(value), "aria-label": `${key.key}: ${key.help}`,
        "aria-valuetext": says(value) });
    slider.addEventListener("input", () => {
      const found = range.value(Number(slider.value));
      field.value = shown(found);
      field.title = String(found);
      slider.setAttribute("aria-valuetext", says(found));
      this.complain(field, "");
      this.scene.set(name, found);
    });
    // all digits while it is edited; another value takes the selection away, with which a typed
    // digit replaces the number
    field.addEventListener("focus", () => {
      if (field.value !== shown(Number(field.title))) return;
      field.value = field.title;
      field.select();
    });
    field.addEventListener("blur",
      () => { if (read(field) === Number(field.title)) field.value = shown(read(field)); });
    field.addEventListener("change", () => {
      const found = read(field);
      if (!Number.isFinite(found)
        || (range.whole && !Number.isInteger(found))) {
        this.complain(field,
          `must be a ${range.whole ? "whole " : ""}number${key.allowed ? `, ${key.allowed}` : ""}`);
        return;
      }
      this.complain(field, "");
      // a number far away does not leave its range to those after it
      Object.assign(range, new Range(key, found));
      slider.value = range.position(found);
      slider.setAttribute("aria-valuetext", says(found));
      field.title = String(found);
      this.scene.set(name, found);
    });
    return element("div", { class: "row" }, slider, field);
  }

  choice(name, key) {
    const select = element("select",
      { id: name, class: "field", onchange: () => this.scene.set(name, select.value) },
      ...key.words.map((word) => element("option", { selected: word === this.scene.get(name) },
        word)));
    return element("div", { class: "row wide" }, select);
  }

  box(name) {
    const box = element("input", { type: "checkbox", id: name, checked: this.scene.get(name) });
    box.addEventListener("change", () => this.scene.set(name, box.checked));
    return element("div", { class: "row wide" }, element("span", {}, box));
  }

  word(name) {
    const field = element("input", { type: "text", class: "field", id: name, autocomplete: "off",
      value: this.scene.get(name), "aria-describedby": `${name}:wrong` });
    field.addEventListener("change", () => {
      const found = field.value.trim();
      const wrong = !/^\w{1,60}$/.test(found);
      this.complain(field, wrong ? "must be a word of letters, digits and _" : "");
      if (!wrong) this.scene.set(name, found);
    });
    return element("div", { class: "row wide" }, field);
  }

  list(name, key) {
    const field = element("input", { type: "text", class: "field", id: name, autocomplete: "off",
      value: this.scene.get(name).join(", "), "aria-describedby": `${name}:wrong`,
      title: this.scene.get(name).join(", ") });
    field.addEventListener("change", () => {
      field.title = field.value;
      const items = field.value.split(/[\s,;]+/).filter(Boolean);
      const found = key.kind === "real list" ? items.map(Number) : items;
      const wrong = !found.length || (key.kind === "real list" && !found.every(Number.isFinite));
      const what = key.kind === "real list" ? "numbers" : "words";
      this.complain(field, wrong ? `must be ${what} with commas between them` : "");
      if (!wrong) this.scene.set(name, found);
    });
    return element("div", { class: "row wide" }, field);
  }

  // Say below a control what is wrong with it, '' for nothing.
  complain(field, text) {
    const line = byId(`${field.id}:wrong`);
    field.setAttribute("aria-invalid", String(Boolean(text)));
    if (!line) return;
    line.hidden = !text;
    line.textContent = text;
  }

  // Mark the key that a message of the kernel names, and nothing else.
  blame(message) {
    const blamed = document.querySelectorAll("#groups [aria-invalid=true]");
    // a text that is no value keeps its mark: the scene does not know it
    for (const field of blamed) if (byId(`${field.id}:wrong`).hidden) this.complain(field, "");
    const found = /&(\w+): (\w+)/.exec(message ?? "");
    const field = found && byId(`${found[1]}.${found[2]}`);
    if (field) field.setAttribute("aria-invalid", "true");
  }
}

// The number in a field, with an exponent as in Fortran too; NaN for none.
function read(field) {
  const text = field.value.trim().replace(/d/i, "e");
  return text ? Number(text) : NaN;
}

// All digits where they fit; 6e8 rather than 600000000.
function shown(value) {
  const text = String(value);
  const brief = short(value, 6);
  const same = text.length > 6 && brief.length < text.length && Number(brief) === value;
  return same || text.length > 10 ? brief : text;
}
