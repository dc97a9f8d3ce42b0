// Force over displacement of every spring.

import { unpack } from "./bridge.js";
import { panel } from "./figure.js";
import { byId, element } from "./format.js";

// title and abscissa of a kind of spring
const KINDS = { frame: ["Frame", "u_s [mm]"], storey: ["Storeys", "storey drift [mm]"],
  cable: ["Tendon", "elongation [mm]"], fuse: ["Fuses", "stroke [mm]"],
  coupling: ["Couplings", "stroke [mm]"], restraint: ["Restraints", "stroke [mm]"] };

export function showLoops(loops) {
  const kinds = Map.groupBy(loops, (loop) => loop.kind);
  byId("loops").replaceChildren(...[...kinds].map(([kind, all]) => panel(all.map((loop) => ({
    x: Array.from(unpack(loop.displacement), (x) => (x === null ? null : 1e3 * x)),
    y: unpack(loop.force),
    label: all.length > 1 ? loop.spring.replace(kind, "").trim() : "" })),
    { title: KINDS[kind][0], xLabel: KINDS[kind][1], yLabel: all[0].label })));
  if (!loops.length) byId("loops").replaceChildren(
    element("p", { class: "hint" }, "This scene has no tendon, no fuse and no yielding frame."));
}
