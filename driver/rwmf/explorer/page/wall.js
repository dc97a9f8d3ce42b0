// Wall, frame, tendon and ground at the time of the clock, on a canvas, with the profile over the
// height. Rotations and the deflection of a wall that bends are magnified, by the factors of
// `rwmf animate`. A pinned state is a ghost at the same factors. A hand can hold the wall.

import { byId, colour, dot, textSize } from "./format.js";
import { magnification, peak } from "./motion.js";
import { drawProfile } from "./profile.js";

const FLASH = 0.12; // how long an impact stays marked [s]
const HINGE = 0.12; // distance of a hinge from the end of its column, over the height
const GHOST = 0.35; // opacity of a pinned state
const MOST = 0.95; // a wall let go from beyond overturns at once [of the slenderness]
const PUSH = 0.05; // rotation by one key [of the slenderness]
const ROOM = [0.5, 1.1]; // for a frame beside the wall, over its height

// Corners of the wall turned about the one that is down: left bottom, right bottom, right top, left
// top.
function corners(h, b, theta, pinned) {
  const pivot = pinned ? 0 : theta > 0 ? b : -b;
  const [sine, cosine] = [Math.sin(theta), Math.cos(theta)];
  return [[-b, 0], [b, 0], [b, 2 * h], [-b, 2 * h]].map(([x, y]) =>
    [pivot + (x - pivot) * cosine + y * sine, y * cosine - (x - pivot) * sine]);
}

export class Stage {
  // `grabbed` is called at the beginning, `released` with the rotation over the slenderness.
  constructor(canvas, factorPlace, grabbed, released) {
    Object.assign(this, { canvas, factorPlace, grabbed, released });
    this.holdByPointer();
    canvas.addEventListener("keydown", ({ key }) => this.holdByKey(key));
    canvas.addEventListener("blur", () => this.hold(null));
    byId("flash").addEventListener("change", () => this.draw(this.t));
    new ResizeObserver(() => this.draw(this.t ?? 0)).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)")
      .addEventListener("change", () => this.draw(this.t ?? 0));
  }

  // `motion` and `ghost`: the state, and the pinned one or null.
  show(motion, ghost) {
    Object.assign(this, { motion, ghost, held: null });
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
    this.caption = texts.join(", ");
    this.offer();
  }

  // A wall can be held; a frame alone is only a picture.
  offer() {
    const { canvas, held } = this;
    const can = this.canHold;
    canvas.tabIndex = can ? 0 : -1;
    canvas.style.cursor = can ? "grab" : "";
    canvas.setAttribute("role", can ? "slider" : "img");
    canvas.setAttribute("aria-label",
      "Wall, frame, profile over the height and ground at the time of the clock"
      + (can ? ". Arrow keys tilt the wall, Enter lets it go" : ""));
    canvas.title = can ? "Grab the wall and let it go" : "";
    canvas.setAttribute("aria-valuenow", held ?? 0);
    this.factorPlace.textContent = held === null ? this.caption || canvas.title
      : `held at ${held.toFixed(2)} of its slenderness`;
    canvas.setAttribute("aria-valuetext", this.factorPlace.textContent);
  }

  get canHold() { return Boolean(this.released && this.motion?.scene.h); }

  get alpha() { return Math.atan2(this.motion.scene.b, this.motion.scene.h); }

  // Hold the wall at a rotation over its slenderness, null for none.
  hold(share) {
    if (this.held === share || !this.canHold) return;
    if (share !== null && this.held === null) this.grabbed();
    this.held = share === null ? null : Math.max(-MOST, Math.min(MOST, share));
    this.offer();
    this.draw(this.t);
  }

  letGo() {
    const share = Number(this.held.toFixed(2));
    if (share) this.released(share);
    else this.hold(null);
  }

  holdByPointer() {
    const { canvas } = this;
    const place = (event) => {
      const { left, top } = canvas.getBoundingClientRect();
      return [(event.clientX - left - this.origin[0]) / this.scale,
        (this.origin[1] - event.clientY + top) / this.scale];
    };
    canvas.addEventListener("pointerdown", (event) => {
      const [x, y] = place(event);
      const [left, right] = this.motion?.scene.ends ?? [0, 0];
      const near = 0.15 * this.height;
      if (!this.canHold || y < 0 || x < left - near || x > right + near + y) return;
      canvas.setPointerCapture(event.pointerId);
      // the grabbed point follows the hand
      this.from = [x, Math.max(y, 0.3 * this.height)];
      this.hold(0);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (this.from) this.hold((place(event)[0] - this.from[0]) / this.from[1] / this.alpha);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => {
      if (this.from && this.held !== null) this.letGo();
      this.from = null;
    });
  }

  holdByKey(key) {
    const push = { ArrowRight: PUSH, ArrowLeft: -PUSH }[key];
    if (push) this.hold((this.held ?? 0) + push);
    else if (this.held !== null && key === "Enter") this.letGo();
    else if (key === "Escape") this.hold(null);
  }

  // Distances left and right of the middle of the base, moving with roof and ground; without the
  // frame beside a wall.
  reach({ scene, columns, ground, height, deflection }) {
    const sway = this.bend * deflection + this.factor * (columns.theta
      ? height * Math.min(peak(columns.theta), Math.PI / 2) : peak(columns.u_s));
    const moves = sway + peak(ground) + 0.08 * height;
    const [left, right] = scene.ends ?? [-0.3 * height, 0.3 * height];
    return [moves - left, moves + right];
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
    const wide = (heights.length > 1 ? 210 : 150) * textSize() / 12;
    const beside = heights.length ? Math.min(wide, 0.42 * width) : 0;
    const H = this.height;
    // the frame takes the room that the wall leaves at full height
    const full = height / (1.25 * H);
    const free = (width - beside) / full - this.left - this.right;
    this.room = motion.scene.h && motion.scene.frame
      ? Math.max(ROOM[0] * H, Math.min(ROOM[1] * H, free)) : 0;
    const left = this.left + this.room;
    const scale = this.scale = Math.min((width - beside) / (left + this.right), full);
    const base = height - 0.08 * H * scale - 4;
    if (beside) {
      drawProfile(ctx, motion, this.ghost, t, width - beside + 6, beside - 10,
        (y) => base - y * scale);
    }
    this.origin = [(width - beside - (this.right - left) * scale) / 2, base];
    ctx.translate(...this.origin);
    ctx.scale(scale, -scale);
    // lines are wider where texts are larger
    this.pixel = textSize() / 12 / scale;
    if (this.held !== null) {
      this.soil(0, left, H);
      this.structure(motion.tilted(this.held * this.alpha), -1);
      return;
    }
    this.soil(motion.ground ? motion.at(motion.ground, t) : 0, left, H);
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

  soil(ground, left, H) {
    const y = -0.015 * H;
    this.path([[ground - left, y], [ground + this.right, y]], "alone", 3);
    // at most 200 strokes, also for a wall far wider than high
    const step = Math.max(0.12 * H, (left + this.right) / 200);
    for (let x = ground - left; x <= ground + this.right; x += step) {
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
    const angle = (this.held === null ? this.factor : 1) * theta;
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
    const since = t - (impacts.findLast((instant) => instant <= t) ?? -1);
    if (since > FLASH || this.held !== null || !byId("flash").checked) return;
    const [x, y] = theta > 0 ? box[1] : box[0];
    for (const axis of axes) this.flash(x + axis, y, since / FLASH);
  }

  // A dot at a corner, and a ring that spreads.
  flash(x, y, share) {
    const { ctx, pixel } = this;
    ctx.fillStyle = ctx.strokeStyle = colour("c1");
    ctx.lineWidth = 2 * pixel;
    dot(ctx, x, y, 7 * pixel);
    ctx.globalAlpha = 1 - share;
    ctx.beginPath();
    ctx.arc(x, y, (7 + 18 * share) * pixel, 0, 2 * Math.PI);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }

  // Dots at the ends of the columns of storeys that have yielded.
  hinges({ yieldTimes, scene }, t, feet, levels, moves) {
    const { ctx } = this;
    const lean = (k) => (scene.heights ? k : bow(k));
    ctx.fillStyle = colour("bad");
    yieldTimes.forEach((since, i) => {
      if (t < since) return;
      for (const foot of feet) for (const k of [HINGE, 1 - HINGE]) {
        dot(ctx, foot + moves[i] + lean(k) * (moves[i + 1] - moves[i]),
          levels[i] + k * (levels[i + 1] - levels[i]), 3.5 * this.pixel);
      }
    });
  }

  // Portal whose roof follows the face of the wall (`face`, points from foot to top), or its own
  // displacement; each link is drawn. `w`: deflections of the wall.
  frame(motion, foot, sway, face, t, w = [0, 0]) {
    const { scene, columns } = motion;
    const H = motion.height;
    // beside the columns that restrain the wall
    const right = face ? foot + scene.b + scene.ends[0] - 0.45 * this.room : foot + 0.3 * H;
    const left = right - (face ? 0.55 * this.room : 0.6 * H);
    const floors = scene.heights ? levels(scene.heights) : [H];
    const linked = ["every_floor", "springs"].includes(scene.coupling);
    // where links hold the frame along the wall it bends with it; elsewhere in a straight line
    const bent = (y) => (this.bend - this.factor) * (linked ? between(w, y / H)
      : y / H * w.at(-1));
    let moved = 0;
    const moves = floors.map((y, i) => {
      const drift = columns[`storey_${i + 1}_drift`];
      if (!drift) return sway * y / H;
      moved += (this.held === null ? this.factor : 1) * motion.at(drift, t) * scene.heights[i];
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
