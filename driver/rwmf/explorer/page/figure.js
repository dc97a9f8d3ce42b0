// Line pictures as SVG: loops and cost on the page, and the figure that is saved. A saved figure
// has its colours in it, on white, whatever the page looks like.

import { short } from "./format.js";

const SPACE = "http://www.w3.org/2000/svg";
const PRINT = { ink: "#1b1f24", soft: "#57606a", line: "#d3d9df", paper: "#ffffff",
  alone: "#67707c",
  c0: "#0072b2", c1: "#c04a00", c2: "#00795a", c3: "#956600", c4: "#a0517f", c5: "#2674a0" };

function node(name, attributes, ...children) {
  const found = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) found.setAttribute(key, value);
  found.append(...children);
  return found;
}

// Round numbers in a range, at most `most`.
function marks(low, high, most) {
  const rough = (high - low) / most;
  const decade = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((x) => x * decade).find((x) => x >= rough) ?? 10 * decade;
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step;
  i++) found.push(i * step);
  return found;
}

function decades(low, high) {
  const found = [];
  const every = Math.max(1, Math.ceil((Math.log10(high) - Math.log10(low)) / 7));
  for (let i = Math.ceil(Math.log10(low)); i <= Math.log10(high); i += every) found.push(10 ** i);
  return found;
}

function extent(curves, axis, log) {
  let [low, high] = [Infinity, -Infinity];
  for (const curve of curves) {
    for (const value of curve[axis]) {
      if (value === null || !Number.isFinite(value) || (log && value <= 0)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (low > high) return log ? [1e-3, 1] : [0, 1];
  if (log) return [low / 1.5, high * 1.5];
  const pad = 0.05 * (high - low) || 0.05 * Math.abs(high) || 1;
  return [low - pad, high + pad];
}

// One panel. curves: {x, y, colour, dash, label, dots, rings}; options: title, xLabel, yLabel,
// logX, logY, width, height, print (own colours instead of the page's).
export function panel(curves, options) {
  const { width = 360, height = 240, print = false, logX = false, logY = false } = options;
  const tone = (name) => (print ? PRINT[name] : `var(--${name})`);
  const [x0, x1] = extent(curves, "x", logX);
  const [y0, y1] = extent(curves, "y", logY);
  const levels = logY ? decades(y0, y1) : marks(y0, y1, 5);
  const longest = Math.max(0, ...levels.map((y) => short(y, 4).length));
  const [left, right, top, bottom] = [Math.max(62, 28 + 7.7 * longest), width - 10, 26,
    height - 40];
  const scale = (low, high, from, to, log) => (log
    ? (v) => from + Math.log(v / low) / Math.log(high / low) * (to - from)
    : (v) => from + (v - low) / (high - low) * (to - from));
  const X = scale(x0, x1, left, right, logX);
  const Y = scale(y0, y1, bottom, top, logY);
  const text = (x, y, words, more = {}) =>
    node("text", { x, y, fill: tone("soft"), "font-size": 12, ...more }, words);
  const body = node("g", { "font-family": "system-ui, 'DejaVu Sans', sans-serif" });
  for (const x of logX ? decades(x0, x1) : marks(x0, x1, 5)) {
    // the last number may have no room
    const words = X(x) > width - 18 ? "" : short(x, 4);
    body.append(node("path", { d: `M${X(x)} ${top}V${bottom}`, stroke: tone("line"),
      fill: "none" }),
      text(X(x), bottom + 15, words, { "text-anchor": "middle" }));
  }
  for (const y of levels) {
    body.append(node("path", { d: `M${left} ${Y(y)}H${right}`, stroke: tone("line"),
      fill: "none" }),
      text(left - 6, Y(y) + 4, short(y, 4), { "text-anchor": "end" }));
  }
  body.append(text((left + right) / 2, height - 8, options.xLabel, { "text-anchor": "middle" }),
    text(14, (top + bottom) / 2, options.yLabel,
      { "text-anchor": "middle", transform: `rotate(-90 14 ${(top + bottom) / 2})` }));
  if (options.title) body.append(
    text(left, 15, options.title, { fill: tone("ink"), "font-weight": 600 }));
  curves.forEach((curve, i) => body.append(...drawn(curve, i, X, Y, tone)));
  body.append(...key(curves, right, tone));
  const svg = node("svg", { xmlns: SPACE, viewBox: `0 0 ${width} ${height}`, width, height,
    role: "img",
    "aria-label": `${options.title ?? ""} ${options.yLabel} over ${options.xLabel}`.trim() }, body);
  // a point of the panel that moves
  svg.point = (x, y) => node("circle", { cx: X(x), cy: Y(y), r: 5, fill: tone("c1") });
  return svg;
}

function drawn(curve, i, X, Y, tone) {
  const colour = tone(curve.colour ?? `c${i % 6}`);
  let d = "";
  let pen = "M";
  const dots = [];
  for (let j = 0; j < curve.x.length; j++) {
    const [x, y] = [curve.x[j] === null ? NaN : X(curve.x[j]),
      curve.y[j] === null ? NaN : Y(curve.y[j])];
    if (!Number.isFinite(x) || !Number.isFinite(y)) {
      pen = "M";
      continue;
    }
    d += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
    pen = "L";
    if (curve.dots) dots.push(node("circle",
      { cx: x.toFixed(1), cy: y.toFixed(1), r: curve.dots, fill: colour }));
    if (curve.rings) dots.push(node("circle", { cx: x.toFixed(1), cy: y.toFixed(1),
      r: curve.rings, fill: "none", stroke: colour, "stroke-width": 1.6 }));
  }
  return [node("path", { d: d || "M0 0", fill: "none", stroke: colour,
    "stroke-width": curve.width ?? 1.4,
    "stroke-linejoin": "round", ...(curve.dash ? { "stroke-dasharray": curve.dash } : {}) }),
      ...dots];
}

// Names in a row above the panel, from the right.
function key(curves, right, tone) {
  let x = right;
  return curves.filter((curve) => curve.label).reverse().flatMap((curve) => {
    const colour = tone(curve.colour ?? `c${curves.indexOf(curve) % 6}`);
    const words = node("text", { x, y: 15, "text-anchor": "end", "font-size": 11,
      fill: tone("ink") }, curve.label);
    // letters of this size are at most 6.4 wide on average
    x -= 6.4 * curve.label.length + 5;
    const mark = node("path", { d: `M${x - 12} 11H${x}`, stroke: colour, "stroke-width": 2,
      fill: "none", ...(curve.dash ? { "stroke-dasharray": curve.dash } : {}) });
    x -= 20;
    return [words, mark];
  });
}

// Panels one below the other as the text of a file.
export function sheet(panels, title, width = 720) {
  let y = 34;
  const all = node("svg", { xmlns: SPACE, width });
  all.append(node("rect", { width: "100%", height: "100%", fill: PRINT.paper }),
    node("text", { x: 12, y: 22, "font-size": 14, "font-weight": 600,
      "font-family": "system-ui, 'DejaVu Sans', sans-serif",
      fill: PRINT.ink }, title));
  for (const [curves, options] of panels) {
    const made = panel(curves, { width, height: 230, ...options, print: true });
    made.setAttribute("y", y);
    y += 238;
    all.append(made);
  }
  all.setAttribute("height", y);
  all.setAttribute("viewBox", `0 0 ${width} ${y}`);
  return `<?xml version="1.0" encoding="UTF-8"?>\n${new XMLSerializer().serializeToString(all)}\n`;
}
