// A control for every key: slider and field for numbers, a list of words for choices, a box for yes
// or no, sliders of storeys for lists; keys that the case does not give are below, with their
// defaults.

import { byId, element, fromSi, short, toSi, unit } from "./format.js";
import { Range, STEPS } from "./range.js";

export class Controls {
  constructor(scene) {
    this.scene = scene;
    this.open = new Set(["wall", "frame", "storeys", "cable", "impact", "motion", "model"]);
    this.ranges = new Map();
    // functions that show a value in the controls of a key
    this.views = new Map();
  }

  // Show the values of the scene; a control that the user holds stays the same element.
  refresh() {
    for (const [name, view] of this.views) view(this.scene.get(name));
  }

  // Open a group, or offer to add it.
  goTo(name) {
    byId("panel").open = true;
    this.open.add(name);
    const box = byId(`group-${name}`);
    if (box) box.open = true;
    const target = box?.querySelector("summary") ?? byId(`add-${name}`);
    target?.focus();
    const isPhone = matchMedia("(max-width: 760px)").matches;
    target?.scrollIntoView({ block: isPhone ? "start" : "nearest" });
  }

  // Build the panel again, with the focus on the same control.
  build() {
    const focus = document.activeElement?.id;
    const { scene } = this;
    this.views.clear();
    byId("groups").replaceChildren(
      ...scene.description.groups.filter((group) => scene.has(group.name))
        .map((group) => this.group(group)));
    byId("absent").replaceChildren(
      ...scene.description.groups.filter((group) => group.can_be_added && !scene.has(group.name)).map((group) =>
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
    return this.folding(group.name, { class: "group", id: `group-${group.name}` },
      element("summary", {}, group.title, element("span", { class: "brief" }, `&${group.name}`)),
      ...(group.name === "motion" && scene.get("motion.kind") === "record"
        ? [element("p", { class: "hint" },
          scene.recordName ? `record: ${scene.recordName}` : "Choose one below: Record")]
            : []),
      ...given.map((key) => this.key(group.name, key)),
      this.others(group, others));
  }

  // A part that opens and closes, as before in a new panel.
  folding(name, attributes, ...children) {
    const box = element("details", { ...attributes, open: this.open.has(name) }, ...children);
    box.addEventListener("toggle", () => (box.open ? this.open.add(name) : this.open.delete(name)));
    return box;
  }

  others(group, keys) {
    const { scene } = this;
    return this.folding(`${group.name}?`, { class: "more" },
      element("summary", {}, keys.length
        ? `${keys.length} more ${keys.length > 1 ? "keys" : "key"}` : "More"),
      ...keys.map((key) => element("div", { class: "absent-key", title: key.allowed },
        element("span", {}, `${key.help} `, element("b", {}, key.key),
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
  }

  key(group, key) {
    const { scene } = this;
    const name = `${group}.${key.key}`;
    const label = element("label", { for: name, title: `${key.help}; ${key.allowed}` },
      `${key.help} `, element("b", {}, key.key));
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
    (row.querySelector(".row") ?? row)
      .append(element("span", { class: "unit" }, unit(key.unit)), out);
    return element("div", { class: "key" }, label, row,
      element("p", { class: "wrong", id: `${name}:wrong`, hidden: true, role: "alert" }));
  }

  // Range of a slider; `part` names a storey.
  range(name, key, value, part = "") {
    const own = `${name}${part}`;
    if (!this.ranges.has(own)) this.ranges.set(own, new Range(key, value));
    const range = this.ranges.get(own);
    range.widen(value);
    return range;
  }

  // A slider with its value in words; `moved` receives the value.
  slider(id, label, key, range, value, moved) {
    const inWords = (x) => `${fromSi(x, key.unit)} ${unit(key.unit)}`.trim();
    const slider = element("input", { type: "range", id, min: 0, max: STEPS, step: 1,
      value: range.position(value), "aria-label": label, "aria-valuetext": inWords(value) });
    slider.show = (x) => {
      if (range.position(x) !== Number(slider.value)) slider.value = range.position(x);
      slider.setAttribute("aria-valuetext", inWords(x));
    };
    slider.addEventListener("input", () => {
      const found = range.value(Number(slider.value));
      slider.setAttribute("aria-valuetext", inWords(found));
      moved(found);
    });
    return slider;
  }

  // A field for text, with a place for a message below.
  field(name, value, more = {}) {
    return element("input", { type: "text", class: "field", id: name, value, autocomplete: "off",
      "aria-describedby": `${name}:wrong`, ...more });
  }

  number(name, key) {
    const value = this.scene.get(name);
    const range = this.range(name, key, value);
    const text = (x) => shown(fromSi(x, key.unit));
    const digits = (x) => String(fromSi(x, key.unit));
    const field = this.field(name, text(value), { inputmode: "decimal", title: digits(value) });
    const slider = this.slider(`${name}:slider`, `${key.key}: ${key.help}`, key, range, value,
      (found) => {
        field.value = text(found);
        field.title = digits(found);
        this.complain(field, "");
        this.scene.set(name, found);
      });
    this.views.set(name, (x) => {
      if (digits(x) === field.title) return;
      range.widen(x);
      slider.show(x);
      field.value = text(x);
      field.title = digits(x);
      this.complain(field, "");
    });
    // all digits during editing; a typed digit replaces the selected number
    field.addEventListener("focus", () => {
      if (field.value !== shown(Number(field.title))) return;
      field.value = field.title;
      field.select();
    });
    field.addEventListener("blur", () => {
      const [typed, set] = [read(field), Number(field.title)].map((x) => toSi(x, key.unit));
      if (typed === set) field.value = text(set);
    });
    field.addEventListener("change", () => {
      const found = toSi(read(field), key.unit);
      if (!Number.isFinite(found) || (range.whole && !Number.isInteger(found))) {
        this.complain(field,
          `must be a ${range.whole ? "whole " : ""}number${key.allowed ? `, ${key.allowed}` : ""}`);
        return;
      }
      this.complain(field, "");
      // a number far away does not leave its range to those after it
      Object.assign(range, new Range(key, found));
      slider.show(found);
      field.title = digits(found);
      this.scene.set(name, found);
    });
    return element("div", { class: "row" }, slider, field);
  }

  choice(name, key) {
    const select = element("select",
      { id: name, class: "field", onchange: () => this.scene.set(name, select.value) },
      ...key.words.map((word) => element("option", { selected: word === this.scene.get(name) },
        word)));
    this.views.set(name, (x) => { select.value = x; });
    return element("div", { class: "row wide" }, select);
  }

  box(name) {
    const box = element("input", { type: "checkbox", id: name, checked: this.scene.get(name) });
    box.addEventListener("change", () => this.scene.set(name, box.checked));
    this.views.set(name, (x) => { box.checked = x; });
    return element("div", { class: "row wide" }, element("span", {}, box));
  }

  word(name) {
    this.views.set(name, (x) => { byId(name).value = x; });
    const field = this.field(name, this.scene.get(name));
    field.addEventListener("change", () => {
      const found = field.value.trim();
      const wrong = !/^\w{1,60}$/.test(found);
      this.complain(field, wrong ? "must be a word of letters, digits and _" : "");
      if (!wrong) this.scene.set(name, found);
    });
    return element("div", { class: "row wide" }, field);
  }

  list(name, key) {
    const text = (items) => items.map((x) => (key.kind === "real list" ? fromSi(x, key.unit) : x))
      .join(", ");
    const items = this.scene.get(name);
    const field = this.field(name, text(items), { title: text(items) });
    field.addEventListener("change", () => {
      field.title = field.value;
      const words = field.value.split(/[\s,;]+/).filter(Boolean);
      const found = key.kind === "real list" ? words.map((x) => toSi(Number(x), key.unit)) : words;
      const wrong = !found.length || (key.kind === "real list" && !found.every(Number.isFinite));
      const what = key.kind === "real list" ? "numbers" : "words";
      this.complain(field, wrong ? `must be ${what} with commas between them` : "");
      if (!wrong) this.scene.set(name, found);
    });
    const rows = key.low === undefined ? null : this.storeys(name, key);
    const count = items.length;
    this.views.set(name, (now) => {
      // other sliders for another number of storeys
      if (rows && now.length !== count) return this.build();
      if (document.activeElement !== field) field.value = field.title = text(now);
      rows?.show(now);
    });
    const wide = element("div", { class: "row wide" }, field);
    return rows ? element("div", { class: "list" }, wide, ...rows.parts) : wide;
  }

  // A slider that scales all values of a list, and one for each storey, the roof on top.
  storeys(name, key) {
    const { scene } = this;
    const items = scene.get(name);
    const mean = (all) => all.reduce((a, x) => a + x, 0) / all.length;
    // the proportions that the common slider keeps
    let pattern = items.map((x) => x / mean(items));
    const common = this.slider(`${name}:slider`, `${key.key} of all storeys: ${key.help}`, key,
      this.range(name, key, mean(items)), mean(items), (found) =>
        scene.set(name, pattern.map((part) => Number((part * found).toPrecision(6)))));
    const sliders = items.map((value, i) => this.slider(`${name}:slider:${i + 1}`,
      `${key.key} of storey ${i + 1}`, key, this.range(name, key, value, i), value, (found) => {
        const changed = scene.get(name).map((x, j) => (j === i ? found : x));
        pattern = changed.map((x) => x / mean(changed));
        scene.set(name, changed);
      }));
    const values = items.map((x) => element("output", {}, short(fromSi(x, key.unit))));
    const label = (text) => element("span", { class: "unit" }, text);
    const parts = [element("div", { class: "storey" }, label(items.length > 1 ? "all" : ""),
      common)];
    if (items.length > 1) {
      parts.push(this.folding(`${name}?`, { class: "more" },
        element("summary", {}, "Each storey"),
        ...sliders.map((slider, i) => element("div", { class: "storey" }, label(String(i + 1)),
          slider, values[i])).reverse()));
    }
    return { parts, show: (now) => {
      if (document.activeElement !== common) {
        common.show(mean(now));
        pattern = now.map((x) => x / mean(now));
      }
      now.forEach((x, i) => {
        sliders[i].show(x);
        values[i].textContent = short(fromSi(x, key.unit));
      });
    } };
  }

  // Show a message below a control, '' for none.
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
