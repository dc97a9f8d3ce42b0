// Key numbers, captions, warnings and namelist: the parts of an answer in words.

import { byId, element, fromSi, short, unit } from "./format.js";

// groups that are open at first
const OPEN = ["frame", "wall"];

// The headline of `rwmf run`, then every scalar by its group. A cell's title has all digits.
export function showNumbers(answer) {
  const exact = new Map(answer.numbers.map((row) => [row[0], row]));
  const places = byId("groups-of-numbers");
  const open = new Set(places.children.length ? [...places.querySelectorAll("details[open]")]
    .map((box) => box.dataset.title) : OPEN);
  byId("numbers").tBodies[0].replaceChildren(...answer.headline
    .filter(([, text]) => !["no frame", "no tendon"].includes(text))
    .map(([name, text]) => element("tr", {}, element("th", { scope: "row" }, name),
      element("td", {}, text))));
  places.replaceChildren(...answer.groups.map(([title, rows]) => element("details",
    { "data-title": title, open: open.has(title) },
    element("summary", {}, title),
    element("table", {}, element("tbody", {}, ...rows.map((row) => numberRow(row, exact)))))));
  byId("method").textContent = answer.method;
}

// One quantity; those of storeys and floors from the ground up.
function numberRow([meaning, of, keys, times], exact) {
  const cell = (key, digits) => {
    const [, text, own] = exact.get(key);
    const number = Number(text);
    const shown = Number.isFinite(number) ? short(fromSi(number, own), digits) : text;
    return element("span", { title: `${key} = ${text}`, "data-key": key, "data-exact": text },
      shown);
  };
  const values = keys.flatMap((key, i) => [i ? " " : "", cell(key, keys.length > 1 ? 3 : 5)]);
  const instants = times.flatMap((key) => [" at ", cell(key, 4), " s"]);
  return element("tr", {}, element("th", { scope: "row" }, meaning),
    element("td", { class: keys.length > 1 ? "many" : "" }, ...values, ` ${unit(of)}`,
      ...instants));
}

export function showCaptions(answer) {
  byId("captions").textContent = answer.captions.join(" ");
}

// One line, which opens the list. Each group that a warning names is a link to its controls.
export function showWarnings(answer, other, problemOfOther, goTo) {
  const texts = [...answer.warnings];
  if (problemOfOther) texts.push(`The other curve: ${problemOfOther}`);
  else if (other) texts.push(...other.warnings.filter((text) => !texts.includes(text))
    .map((text) => `The other curve: ${text}`));
  const box = byId("warnings");
  box.hidden = !texts.length;
  if (!texts.length) return;
  const count = texts.length > 1 ? `${texts.length} warnings: ` : "Warning: ";
  box.querySelector("summary").textContent = count + texts[0];
  box.querySelector("ul").replaceChildren(...texts.map((text) => element("li", {},
    ...text.split(/(&[a-z_]+)/).map((part) => (part.startsWith("&")
      ? element("button", { type: "button", onclick: () => goTo(part.slice(1)) }, part)
      : part)))));
}

export function showNamelist(answer, scene) {
  byId("namelist").textContent = answer.namelist;
  byId("place").textContent = scene.get("motion.kind") !== "record" ? ""
    : scene.record ? `It names ${scene.recordName}: save it beside that file.`
      : scene.description.made.length ? "Its record is saved with it."
        : "It names the record by its full path on this machine.";
}

export function showProblem(text) {
  const place = byId("problem");
  place.hidden = !text;
  place.textContent = text ?? "";
  byId("pictures").classList.toggle("stale", Boolean(text));
}
