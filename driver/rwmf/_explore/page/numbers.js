// Key numbers, warnings, namelist: what the kernel says in words.

import { byId, element, short, unit } from "./format.js";

// those that stand first, in bold
const MAIN = ["u_s_max_m", "theta_max_over_alpha", "cable_force_increment_max_over_m_w_g",
  "base_shear_max_over_weight",
  "storey_drift_max", "impacts", "overturned", "collapsed", "ductility", "energy_balance_relative"];

// A cell's title has all digits: those that rwmf run prints.
export function showNumbers(answer) {
  const rank = (key) => (MAIN.includes(key) ? MAIN.indexOf(key) : MAIN.length);
  const rows = answer.numbers.map((row, i) => [...row, i])
    .sort((a, b) => rank(a[0]) - rank(b[0]) || a[4] - b[4]);
  byId("numbers").tBodies[0].replaceChildren(...rows.map(([key, text, of, help]) => {
    const number = Number(text);
    const shown = Number.isFinite(number) && !/^(yes|no)$/.test(text) ? short(number, 5) : text;
    return element("tr", { class: MAIN.includes(key) ? "main" : "" },
      // a meaning that refers to its neighbours in the table of all quantities says nothing alone
      element("th", { scope: "row", title: key },
        / them\b/.test(help) ? key.replaceAll("_", " ") : help),
      element("td", { title: text, "data-key": key, "data-exact": text }, shown),
      element("td", {}, unit(of)));
  }));
  byId("method").textContent = answer.method;
}

export function showWarnings(answer, other, problemOfOther) {
  const texts = [...answer.warnings];
  if (problemOfOther) texts.push(`The other formulation: ${problemOfOther}`);
  else if (other) texts.push(...other.warnings.filter((text) => !texts.includes(text))
    .map((text) => `${other.scene.formulation}: ${text}`));
  byId("warnings").replaceChildren(...texts.map((text) => element("li", {}, text)));
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
