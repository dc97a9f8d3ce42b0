// Files that the page saves, and the namelist in the clipboard.

import { ask } from "./bridge.js";
import { sheet } from "./figure.js";
import { byId, save } from "./format.js";

export async function copyNamelist(button) {
  try {
    await navigator.clipboard.writeText(byId("namelist").textContent);
    button.textContent = "Copied";
  } catch {
    getSelection().selectAllChildren(byId("namelist"));
    button.textContent = "Selected: Ctrl-C";
  }
  setTimeout(() => { button.textContent = "Copy"; }, 1500);
}

// With the records of a case made from arrays, which no file contains.
export async function saveNamelist(scene) {
  save("explored.nml", "text/plain", byId("namelist").textContent);
  if (!scene.description.made.length) return;
  const files = Object.entries(await ask("/api/made", {}));
  for (const [name, text] of files) save(name, "text/plain", text);
}

export function saveFigure({ spectrum, charts }, name) {
  const named = { Spectrum: spectrum, "Displacement of the frame": charts.u_s,
    "Rotation of the wall": charts.theta, "Ground acceleration": charts.ground,
    "Drifts of the storeys": charts.drifts };
  const panels = Object.entries(named).filter(([, chart]) => chart.plot).map(([title, chart]) =>
    [chart.curves(), { title, xLabel: chart.labels[0], yLabel: chart.labels[1] }]);
  save("explored.svg", "image/svg+xml", sheet(panels, `rwmf: ${name}`));
}
