// Wall, frame, tendon and ground at the time of the clock, on a canvas, with the profile over the
// height. Rotations and the deflection of a wall that bends are magnified, by the factors of
// `rwmf animate`. A pinned state is a ghost at the same factors.

import { colour } from "./format.js";
import { magnification, peak } from "./motion.js";
import { drawProfile } from "./profile.js";

const FLASH = 0.12; // how long an impact stays marked [s]
const HINGE = 0.12; // distance of a hinge from the end of its column, over the height
const GHOST = 0.35; // opacity of a pinned state

// Corners of the wall turned about the one that is down: left bottom, right bottom, right top, left
// top.
function corners(h, b, theta, pinned) {
  const pivot = pinned ? 0 : theta > 0 ? b : -b;
  const [sine, cosine] = [Math.sin(theta), Math.cos(theta)];
  return [[-b, 0], [b, 0], [b, 2 * h], [-b, 2 * h]].map(([x, y]) =>
    [pivot + (x - pivot) * cosine + y * sine, y * cosine - (x - pivot) * sine]);
}

export class Stage {
  constructor(canvas, factorPlace) {
    this.canvas = canvas;
    this.factorPlace = factorPlace;
    new ResizeObserver(() => this.draw(this.t ?? 0)).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)")
      .addEventListener("change", () => this.draw(this.t ?? 0));
  }

  // `motion` and `ghost`: the state, and the pinned one or null.
  show(motion, ghost) {
    Object.assign(this, { motion, ghost });
    this.factor = magnification(motion.rotation);
    this.bend = motion.modes.length
      ? Math.max(this.factor, magnification(motion.deflection / motion.height)) : this.factor;
    this.height = Math.max(motion.height, ghost?.height ?? 0);
    const sides = [motion, ghost].filter(Boolean).map((each) => this.reach(each));
    this.left = Math.max(...sides.map(([left]) => left));
    this.right = Math.max(...sides.map(([, right]) => right));
    const drawn = [[this.factor, "rotations drawn"],
      [motion.modes.length ? this.bend : 1, "deflection of the wall"]];
    const texts = drawn.filter(([factor]) => factor > 1)
      .map(([factor, what]) => `${what} ${factor} times`);
    if (motion.yieldTimes.some(Number.isFinite)) texts.unshift("● yielded");
    if (ghost) texts.unshift("faint: pinned");
    this.factorPlace.textContent = texts.join(", ");
  }

  // Distances left and right of the middle of the base, moving with roof and ground.
  reach({ scene, columns, ground, height, deflection }) {
    const sway = this.bend * deflection + this.factor * (columns.theta
      ? height * Math.min(peak(columns.theta), Math.PI / 2) : peak(columns.u_s));
    const moves = sway + peak(ground) + 0.08 * height;
    const [left, right] = scene.ends ?? [-0.3 * height, 0.3 * height];
    return [moves - left + (scene.h && scene.frame ? 1.1 * height : 0), moves + right];
  }

  draw(t) {
    this.t = t;
    if (!this.motion) return;
    const { canvas, motion } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== width * ratio || canvas.height !== height * ratio) {
      canvas.width = width * ratio;
      canvas.height = height * ratio;
    }
    const ctx = this.ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const { heights } = motion.profile;
    // one storey needs less room
    const beside = heights.length ? Math.min(heights.length > 1 ? 210 : 150, 0.42 * width) : 0;
    const H = this.height;
    const scale = Math.min((width - beside) / (this.left + this.right), height / (1.25 * H));
    const base = height - 0.08 * H * scale - 4;
    if (beside) {
      drawProfile(ctx, motion, this.ghost, t, width - beside + 6, beside - 10,
        (y) => base - y * scale);
    }
    ctx.translate((width - beside - (this.right - this.left) * scale) / 2, base);
    ctx.scale(scale, -scale);
    this.pixel = 1 / scale;
    this.soil(motion.ground ? motion.at(motion.ground, t) : 0, H);
    if (this.ghost) {
      ctx.globalAlpha = GHOST;
      this.structure(this.ghost, Math.min(t, this.ghost.columns.time.at(-1)));
      ctx.globalAlpha = 1;
    }
    this.structure(motion, t);
  }

  structure(motion, t) {
    const ground = motion.ground ? motion.at(motion.ground, t) : 0;
    if (motion.scene.h) this.wall(motion, t, ground);
    else this.frame(motion, ground, this.factor * motion.at(motion.columns.u_s, t), null, t);
  }

  path(points, name, wide, fill = null) {
    const { ctx } = this;
    ctx.beginPath();
    points.forEach(([x, y], i) => (i ? ctx.lineTo(x, y) : ctx.moveTo(x, y)));
    if (fill) {
      ctx.closePath();
      ctx.fillStyle = colour(fill);
      ctx.fill();
    }
    ctx.strokeStyle = colour(name);
    ctx.lineWidth = wide * this.pixel;
    ctx.lineJoin = "round";
    ctx.stroke();
  }

  soil(ground, H) {
    const y = -0.015 * H;
    this.path([[ground - this.left, y], [ground + this.right, y]], "alone", 3);
    // at most 200 strokes, also for a wall far wider than high
    const step = Math.max(0.12 * H, (this.left + this.right) / 200);
    for (let x = ground - this.left; x <= ground + this.right; x += step) {
      this.path([[x, y], [x - 0.05 * H, y - 0.05 * H]], "alone", 1);
    }
  }

  // Settlement under a base that gives, as its pressure; the largest is a tenth of the height deep.
  pressure({ columns, height }, b, foot, sine, middle) {
    const deepest = peak(Array.from(columns.theta,
      (theta, i) => b * Math.abs(Math.sin(theta)) - columns.base_height[i]));
    const below = Array.from({ length: 81 }, (_, i) => {
      const x = b * (i / 40 - 1);
      return [foot + x, -0.1 * height * Math.max(0, x * sine - middle) / deepest];
    });
    this.path([[foot - b, 0], ...below, [foot + b, 0]], "c1", 1, "c1");
  }

  wall(motion, t, ground) {
    const { scene, impacts } = motion;
    const { h, b, pinned, frame, axes } = scene;
    const theta = motion.at(motion.columns.theta, t);
    const angle = this.factor * theta;
    const { base_height: middle, base_slip: slip } = motion.columns;
    const foot = ground + (slip ? motion.at(slip, t) : 0);
    const box = corners(h, b, angle, pinned).map(([x, y]) => [x + foot, y]);
    if (middle) this.pressure(motion, b, foot, Math.sin(theta), motion.at(middle, t));
    // points of a line along the wall, displaced by its deflection
    const w = motion.deflections(t);
    const bent = (foot, top) => w.map((wi, i) => {
      const share = i / (w.length - 1);
      return [foot[0] + share * (top[0] - foot[0]) + this.bend * wi * Math.cos(angle),
        foot[1] + share * (top[1] - foot[1]) - this.bend * wi * Math.sin(angle)];
    });
    const face = bent(box[0], box[3]);
    if (frame) this.frame(motion, ground - b, face.at(-1)[0] - (ground - b), face, t, w);
    const outline = [...face, ...bent(box[1], box[2]).reverse(), box[0]];
    for (const axis of axes) this.path(outline.map(([x, y]) => [x + axis, y]), "ink", 1.6, "wall");
    // a point of a wall, or of the ground
    const place = ([wall, x, y]) => (wall < 0 ? [ground + x, y] : [0, 1].map((k) => box[0][k]
      + (x + b) * (box[1][k] - box[0][k]) / (2 * b) + y * (box[3][k] - box[0][k]) / (2 * h)
      + (k ? 0 : axes[wall])));
    for (const [kind, tone, ends] of scene.lines) {
      const [from, to] = ends.map(place);
      // the tendon follows a wall that bends
      if (kind === "cable") this.path(bent(from, to), "c2", 2);
      else this.path([from, to], tone === null ? "alone" : `c${tone}`, 3);
    }
    if (!impacts.some((instant) => t >= instant && t - instant < FLASH)) return;
    const [x, y] = theta > 0 ? box[1] : box[0];
    const { ctx } = this;
    ctx.fillStyle = colour("c1");
    for (const axis of axes) {
      ctx.beginPath();
      ctx.arc(x + axis, y, 7 * this.pixel, 0, 2 * Math.PI);
      ctx.fill();
    }
  }

  // Dots at the ends of the columns of storeys that have yielded.
  hinges({ yieldTimes, scene }, t, feet, levels, moves) {
    const { ctx } = this;
    const lean = (k) => (scene.heights ? k : bow(k));
    ctx.fillStyle = colour("bad");
    yieldTimes.forEach((since, i) => {
      if (t < since) return;
      for (const foot of feet) for (const k of [HINGE, 1 - HINGE]) {
        ctx.beginPath();
        ctx.arc(foot + moves[i] + lean(k) * (moves[i + 1] - moves[i]),
          levels[i] + k * (levels[i + 1] - levels[i]), 3.5 * this.pixel, 0, 2 * Math.PI);
        ctx.fill();
      }
    });
  }

  // Portal whose roof follows the face of the wall (`face`, points from foot to top), or its own
  // displacement; each link is drawn. `w`: deflections of the wall.
  frame(motion, foot, sway, face, t, w = [0, 0]) {
    const { scene, columns } = motion;
    const H = motion.height;
    // beside the columns that restrain the wall
    const right = face ? foot + scene.b + scene.ends[0] - 0.5 * H : foot + 0.3 * H;
    const left = right - 0.6 * H;
    const floors = scene.heights ? levels(scene.heights) : [H];
    const linked = ["every_floor", "springs"].includes(scene.coupling);
    // where links hold the frame along the wall it bends with it; elsewhere in a straight line
    const bent = (y) => (this.bend - this.factor) * (linked ? between(w, y / H)
      : y / H * w.at(-1));
    let moved = 0;
    const moves = floors.map((y, i) => {
      const drift = columns[`storey_${i + 1}_drift`];
      if (!drift) return sway * y / H;
      moved += this.factor * motion.at(drift, t) * scene.heights[i];
      return moved + bent(y);
    });
    const shape = scene.heights
      ? [[0, 0], ...floors.map((y, i) => [moves[i], y])]
      : Array.from({ length: 13 }, (_, i) =>
        [sway * bow(i / 12), H * i / 12]);
    for (const x of [left, right]) this.path(shape.map(([u, y]) => [x + u, y]), "c0", 3);
    floors.forEach((y, i) => this.path([[left + moves[i], y], [right + moves[i], y]], "c0", 4));
    this.hinges(motion, t, [left, right], [0, ...floors], [0, ...moves]);
    if (!face) return;
    for (let i = linked ? 0 : floors.length - 1; i < floors.length; i++) {
      const end = [0, 1].map((k) => between(face.map((point) => point[k]), floors[i] / H));
      this.path([[right + moves[i], floors[i]], end], "ink", 1.2);
    }
  }
}

// Value at a share of the way along evenly spaced values.
function between(values, share) {
  const x = Math.min(1, Math.max(0, share)) * (values.length - 1);
  const i = Math.min(values.length - 2, Math.floor(x));
  return values[i] + (values[i + 1] - values[i]) * (x - i);
}
// Shape of a column that is clamped at the foot and guided at the roof.
const bow = (share) => 3 * share ** 2 - 2 * share ** 3;
const levels = (heights) => heights.reduce((all, x) => [...all, (all.at(-1) ?? 0) + x], []);
