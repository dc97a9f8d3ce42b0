// Interstorey drift (IDR) and peak floor acceleration (PFA) over the height, beside the moving
// picture and at its scale: peaks as outlines, the present values filled.

import { colour, dot, short, textSize } from "./format.js";

const GAP = 12; // between the two panels [px]

// `left` and `width` in pixels; `Y` turns a height [m] into pixels.
export function drawProfile(ctx, motion, ghost, t, left, width, Y) {
  const half = (width - GAP) / 2;
  const { profile } = motion;
  const levels = heightsOf(profile);
  const top = Y(levels.at(-1));
  const most = (name) => Math.max(...profile[name], ...(ghost?.profile[name] ?? []), 1e-12);
  const panels = [
    { title: `IDR ${short(100 * Math.max(...profile.drift), 2)} %`, x: left, most: most("drift") },
    { title: `PFA ${short(Math.max(...profile.acceleration), 2)} g`, x: left + half + GAP,
      most: most("acceleration") },
  ];
  const letters = (size) => { ctx.font = `${size}px system-ui, sans-serif`; };
  letters(textSize());
  // smaller letters where the titles have no room side by side
  const widest = Math.max(...panels.map(({ title }) => ctx.measureText(title).width));
  letters(textSize() * Math.min(1, half / widest));
  panels.forEach((panel) => {
    panel.X = (value) => panel.x + value / panel.most * (half - 4);
    stroke(ctx, "line", [[panel.x, top], [panel.x, Y(0)], [panel.x + half, Y(0)]], 1);
    ctx.fillStyle = colour("ink");
    ctx.fillText(panel.title, panel.x, top - 8);
  });
  const [drifts, floors] = panels;
  bars(ctx, motion, t, levels, drifts, Y);
  stroke(ctx, "c1", steps(profile.drift, levels, drifts, Y), 1.6);
  if (profile.yield.length) {
    // beyond the panel a level of first yield would be no level of these drifts
    stroke(ctx, "bad", steps(profile.yield.map((x) => Math.min(x, drifts.most)), levels, drifts,
      Y), 1, [2, 3]);
  }
  dots(ctx, motion, t, levels, floors, Y);
  stroke(ctx, "c2", profile.acceleration.map((x, i) => [floors.X(x), Y(levels[i + 1])]), 1.6);
  if (!ghost?.profile.heights.length) return;
  const others = heightsOf(ghost.profile);
  stroke(ctx, "alone", steps(ghost.profile.drift, others, drifts, Y), 1.4, [5, 3]);
  stroke(ctx, "alone", ghost.profile.acceleration.map((x, i) => [floors.X(x), Y(others[i + 1])]),
    1.4, [5, 3]);
}

const heightsOf = ({ heights }) => heights.reduce((all, h) => [...all, all.at(-1) + h], [0]);

// One value per storey as a stepped line.
function steps(values, levels, panel, Y) {
  return values.flatMap((x, i) => [[panel.X(x), Y(levels[i])], [panel.X(x), Y(levels[i + 1])]]);
}

function bars(ctx, motion, t, levels, panel, Y) {
  ctx.fillStyle = `${colour("c1")}55`;
  motion.drifts.forEach((column, i) => {
    const width = panel.X(Math.abs(motion.at(column, t))) - panel.x;
    ctx.fillRect(panel.x, Y(levels[i + 1]) + 1, width, Y(levels[i]) - Y(levels[i + 1]) - 2);
  });
}

function dots(ctx, motion, t, levels, panel, Y) {
  ctx.fillStyle = colour("c2");
  motion.profile.acceleration.forEach((most, i) => {
    const column = motion.floors[i];
    for (const [x, size] of [[most, 3], ...(column ? [[Math.abs(motion.at(column, t)), 2]] : [])]) {
      dot(ctx, panel.X(Math.min(x, panel.most)), Y(levels[i + 1]), size);
    }
  });
}

function stroke(ctx, tone, points, wide, dash = []) {
  ctx.beginPath();
  points.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
  ctx.strokeStyle = colour(tone);
  ctx.lineWidth = wide;
  ctx.setLineDash(dash);
  ctx.stroke();
  ctx.setLineDash([]);
}
