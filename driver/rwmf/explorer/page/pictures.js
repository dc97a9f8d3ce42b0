// Spectrum and histories, drawn by uPlot; one clock, shown as a line in all of them.

import { unpack } from "./bridge.js";
import { byId, colour, dot, element, fromSi, short, textSize, unit } from "./format.js";

const line = (label, name, more = {}) =>
  ({ label, tone: name, stroke: () => colour(name), width: 1.6, points: { show: false },
    value: (_, x) => (x === null || x === undefined ? "–" : short(x, 4)), ...more });

// A range that is never empty: axis marks of an empty one have no end.
function padded(_, low, high) {
  if (low === null || high === null || !Number.isFinite(low) || !Number.isFinite(high)) return [0,
    1];
  const size = Math.max(Math.abs(low), Math.abs(high)) || 1;
  const pad = Math.max(0.06 * (high - low), 1e-6 * size);
  return [low === 0 ? 0 : low - pad, high + pad];
}

function exact(_, low, high) {
  return low === null || !(high > low) ? [low ?? 0, (low ?? 0) + 1] : [low, high];
}

class Chart {
  constructor(place, height, labels, hooks = {}, sync = undefined) {
    Object.assign(this, { place, height, labels, hooks, sync, shape: "", plot: null });
    new ResizeObserver(() => this.resize()).observe(place);
    matchMedia("(prefers-color-scheme: dark)")
      .addEventListener("change", () => this.plot?.redraw());
  }

  resize() {
    const width = this.place.clientWidth;
    if (this.plot && width > 0 && Math.abs(this.plot.width - width) > 1) {
      this.plot.setSize({ width, height: this.height });
    }
  }

  // Put data in; the plot is made anew only when there are other lines.
  draw(series, data, bands = []) {
    Object.assign(this, { series, data, bands });
    const shape = JSON.stringify([series.map((item) => item.label), this.labels]);
    if (shape !== this.shape) this.make(series, data, bands, shape);
    else this.plot.setData(data);
  }

  // Again, with texts of another size.
  remake() {
    if (this.plot) this.make(this.series, this.data, this.bands, this.shape);
  }

  make(series, data, bands, shape) {
    this.plot?.destroy();
    this.shape = shape;
    // an empty place is not shown, and has no width
    this.place.replaceChildren(element("span"));
    const font = `${textSize()}px system-ui, sans-serif`;
    const axis = { stroke: () => colour("soft"), font, labelFont: font,
      grid: { stroke: () => colour("line"), width: 1 },
        ticks: { stroke: () => colour("line"), width: 1 } };
    const options = {
      width: Math.max(this.place.clientWidth, 200), height: this.height, bands,
      series: [{ label: this.labels[0],
        value: (_, x) => (x === null || x === undefined ? "–" : short(x, 4)) }, ...series],
      axes: [{ ...axis, label: this.labels[0], labelSize: 18, size: 34 },
        { ...axis, label: this.labels[1], labelSize: 18, space: this.height < 150 ? 16 : 30,
          // digits are about 7.7 wide
          size: (_, texts) => Math.max(62, 12 + 7.7 * longest(texts)),
          values: (_, all) => all.map((x) => short(x, 5)) }],
      scales: { x: { time: false, range: exact }, y: { range: padded } },
      cursor: { drag: { setScale: false, x: false, y: false }, points: { size: 6 },
        ...(this.sync ? { sync: { key: this.sync } } : {}) },
      // scales are known when the first picture is drawn
      hooks: { draw: [...(this.hooks.draw ?? []), () => this.ondraw?.()] },
    };
    this.place.replaceChildren();
    this.plot = new uPlot(options, data, this.place);
    this.plot.over.addEventListener("click", () => {
      if (this.plot.cursor.left >= 0) this.onpick?.(this.plot.posToVal(this.plot.cursor.left, "x"));
    });
    this.now = null;
  }

  // Curves for a figure in a file.
  curves() {
    return this.series.map(({ label, tone, dash }, i) => ({ x: this.data[0], y: this.data[i + 1],
      label: this.series.length > 1 ? label : "", colour: tone, dash: dash?.join(" ") }));
  }

  clear() {
    this.plot?.destroy();
    this.plot = null;
    this.shape = "";
    this.place.replaceChildren();
  }

  // The line of the clock: an element above the canvas, so that moving it draws nothing.
  mark(t) {
    if (!this.plot) return;
    if (!this.now) {
      this.now = element("div", { class: "now-line" });
      this.plot.over.append(this.now);
    }
    const x = this.plot.valToPos(t, "x");
    this.now.style.transform = `translateX(${x - 1}px)`;
  }
}

// parts of the energy: name and colour, the same in every scene
const PARTS = { kinetic: ["kinetic", "c0"], strain: ["frame springs", "c1"],
  gravity: ["gravity", "c2"],
  cable: ["cable", "c3"], effects: ["fuses, others", "c4"], viscous: ["viscous", "c5"],
  hysteretic: ["yielding", "alone"], impact: ["impacts", "bad"],
  bending: ["bending of the wall", "soft"],
  bending_damping: ["damping of the wall's modes", "warn"] };

export class Pictures {
  constructor(onTime, onPeriod) {
    this.impacts = [];
    this.marker = null;
    this.overturned = [];
    this.spectrum = new Chart(byId("spectrum"), 330, ["period [s]", ""],
      { draw: [(u) => this.drawMarker(u)] });
    this.spectrum.onpick = onPeriod;
    const ticks = { draw: [(u) => this.drawImpacts(u)] };
    this.charts = {
      u_s: new Chart(byId("u_s"), 190, ["t [s]", "u_s [m]"], {}, "time"),
      theta: new Chart(byId("theta"), 190, ["t [s]", "θ [rad]"], ticks, "time"),
      ground: new Chart(byId("ground"), 130, ["t [s]", "ground [g]"], {}, "time"),
      drifts: new Chart(byId("drifts"), 190, ["t [s]", "IDR [%]"], {}, "time"),
      energies: new Chart(byId("energies"), 210, ["t [s]", "energy [J/kg]"], {}, "time"),
    };
    for (const chart of Object.values(this.charts)) {
      chart.onpick = onTime;
      chart.ondraw = () => chart.mark(this.t ?? 0);
    }
  }

  remake() {
    for (const chart of [this.spectrum, ...Object.values(this.charts)]) chart.remake();
  }

  mark(t) {
    this.t = t;
    for (const chart of Object.values(this.charts)) chart.mark(t);
  }

  // `rival`: answer and columns of the second curve with `labels` of both, or null.
  drawHistory(answer, columns, rival) {
    this.columns = columns;
    this.impacts = unpack(answer.impacts);
    this.scene = answer.scene;
    this.labels = rival?.labels ?? null;
    const second = rival && mapValues(rival.columns,
      (column) => resample(rival.columns.time, column, columns.time));
    this.lines("u_s", columns, second, "u_s", "u_s");
    this.lines("theta", columns, second, "theta", "θ");
    if (columns.u_g_ddot?.some(Boolean)) {
      const g = Array.from(columns.u_g_ddot, (x) => (x === null ? null : x / answer.scene.g));
      this.charts.ground.draw([line("ü_g", "c2", { width: 1 })], [columns.time, g]);
    } else this.charts.ground.clear();
    const drifts = Object.keys(columns).filter((name) => /^storey_\d+_drift$/.test(name));
    if (drifts.length) {
      this.charts.drifts.draw(drifts.map((name, i) => line(`storey ${i + 1}`, `c${i % 6}`)),
        [columns.time, ...drifts.map((name) => percent(columns[name]))]);
    } else this.charts.drifts.clear();
    this.energies(columns);
  }

  lines(chart, columns, second, name, label) {
    if (!(name in columns)) return this.charts[chart].clear();
    const series = [line(this.labels?.[0] ?? label, "c0")];
    const data = [columns.time, columns[name]];
    if (second && name in second) {
      series.push(line(this.labels[1], "c1", { dash: [6, 4] }));
      data.push(second[name]);
    }
    this.charts[chart].draw(series, data);
  }

  // Stacked parts; their sum is the work of the ground.
  energies(columns) {
    const parts = Object.keys(columns)
      .filter((name) => name.startsWith("energy_") && name !== "energy_input");
    if (!parts.length) return this.charts.energies.clear();
    const sums = [];
    for (const name of parts) {
      const below = sums.at(-1);
      sums.push(Array.from(columns[name],
        (x, i) => (x === null ? null : x + (below ? below[i] : 0))));
    }
    const looks = parts.map((name) => PARTS[name.slice(7)] ?? [name.slice(7), "ink"]);
    const own = (i) => (_, x, __, row) => short(this.columns[parts[i]]?.[row] ?? NaN, 3);
    const series = looks.map(([label, tone], i) => line(label, tone, { width: 1, value: own(i) }));
    const bands = looks.slice(1).map(([, tone], i) =>
      ({ series: [i + 2, i + 1], fill: alpha(tone) }));
    series[0].fill = alpha(looks[0][1]);
    this.charts.energies.draw([...series, line("input", "ink", { dash: [2, 3], width: 1.2 })],
      [columns.time, ...sums, columns.energy_input], bands);
  }

  drawSpectrum(answer, other, marker) {
    const { wall, frame } = this.scene;
    const { key, unit: of } = answer.quantity;
    const scaled = (text) => Array.from(unpack(text), (x) => (x === null ? null : fromSi(x, of)));
    const what = wall && frame ? "wall and frame" : wall ? "wall" : "frame";
    const T = unpack(answer.T);
    const series = [line(other ? this.labels?.[0] ?? "now" : what, "c0", { width: 2 })];
    const data = [T, scaled(answer.values)];
    if (answer.alone) {
      series.push(line("frame alone", "alone", { dash: [3, 3] }));
      data.push(scaled(answer.alone));
    }
    if (other) {
      series.push(line(this.labels?.[1] ?? "other", "c1", { dash: [6, 4] }));
      data.push(resample(unpack(other.T), scaled(other.values), T));
    }
    this.marker = { T: marker.T, value: fromSi(marker.value, of) };
    this.overturned = unpack(answer.overturned);
    this.spectrum.labels = [`${answer.axis[0]} [s]`, `${bare(key)} [${unit(of) || "-"}]`];
    this.spectrum.draw(series, data);
  }

  drawMarker(u) {
    const { ctx } = u;
    const ratio = devicePixelRatio;
    ctx.save();
    ctx.strokeStyle = colour("bad");
    ctx.lineWidth = 2 * ratio;
    for (const period of this.overturned) {
      const x = u.valToPos(period, "x", true);
      ctx.beginPath();
      ctx.moveTo(x, u.bbox.top + u.bbox.height);
      ctx.lineTo(x, u.bbox.top + u.bbox.height - 8 * ratio);
      ctx.stroke();
    }
    if (this.marker?.T) {
      const x = u.valToPos(this.marker.T, "x", true);
      ctx.strokeStyle = ctx.fillStyle = colour("c1");
      ctx.setLineDash([3 * ratio, 3 * ratio]);
      ctx.lineWidth = ratio;
      ctx.beginPath();
      ctx.moveTo(x, u.bbox.top);
      ctx.lineTo(x, u.bbox.top + u.bbox.height);
      ctx.stroke();
      if (Number.isFinite(this.marker.value)) {
        dot(ctx, x, u.valToPos(this.marker.value, "y", true), 5 * ratio);
      }
    }
    ctx.restore();
  }

  drawImpacts(u) {
    const { ctx } = u;
    const level = u.valToPos(0, "y", true);
    ctx.save();
    ctx.strokeStyle = colour("c1");
    ctx.lineWidth = devicePixelRatio;
    ctx.beginPath();
    let last = -Infinity;
    for (const t of this.impacts) {
      const x = u.valToPos(t, "x", true);
      // ticks of many impacts stay ticks
      if (x - last < 4 * devicePixelRatio) continue;
      last = x;
      ctx.moveTo(x, level - 5 * devicePixelRatio);
      ctx.lineTo(x, level + 5 * devicePixelRatio);
    }
    ctx.stroke();
    ctx.restore();
  }
}

export const bare = (key) => key.replace(/_(m|s|rad_s|rad|J_per_kg|N)$/, "");

const percent = (column) => Array.from(column, (x) => (x === null ? null : 100 * x));

// Values of a line at other abscissas, null outside of it.
function resample(from, values, to) {
  let j = 0;
  return Array.from(to, (x) => {
    while (j < from.length - 2 && from[j + 1] < x) j++;
    if (x < from[0] || x > from[from.length - 1] * (1 + 1e-6)) return null;
    const [a, b] = [values[j], values[j + 1] ?? values[j]];
    const share = (x - from[j]) / (from[j + 1] - from[j] || 1);
    return a === null || b === null ? null : a + share * (b - a);
  });
}

const alpha = (name) => () => colour(name) + "40";

const longest = (texts) => Math.max(0, ...(texts ?? []).map((text) => text.length));

export const mapValues = (object, change) =>
  Object.fromEntries(Object.entries(object).map(([key, x]) => [key, change(x)]));
