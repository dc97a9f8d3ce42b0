// Wall, frame, cable and ground at the time of the clock, on a canvas. Rotations and the deflection
// of a wall that bends are drawn larger than they are, by the factors that rwmf animate takes.

const FLASH = 0.12; // how long an impact stays marked [s]
const VISIBLE = 0.12; // a rotation that a person sees [rad]

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`)
  .trim();

// 1, 2, 5 or 10 times a power of ten, 1 for large rotations.
export function magnification(largest) {
  if (!(largest > 0) || largest >= VISIBLE) return 1;
  const wanted = VISIBLE / largest;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return decade * Math.max(...[1, 2, 5, 10].filter((step) => step * decade <= wanted));
}

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
    this.answer = null;
    new ResizeObserver(() => this.draw(this.t ?? 0)).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)")
      .addEventListener("change", () => this.draw(this.t ?? 0));
  }

  // `columns` and `ground` are arrays over the rows of the history, `impacts` instants.
  show(scene, columns, ground, impacts) {
    Object.assign(this, { scene, columns, ground, impacts });
    this.height = scene.h ? 2 * scene.h : scene.heights ? sum(scene.heights) : 4;
    const largest = columns.theta ? peak(columns.theta) : peak(columns.u_s) / this.height;
    this.factor = magnification(largest);
    // the modes of a wall that bends; each is 1 at the top
    this.modes = (scene.shapes ?? []).map((_, i) => columns[`q_${i + 1}`]);
    const deflection = peak(columns.time.map((_, i) => sum(this.modes.map((q) => q[i] ?? 0))));
    this.bend = this.modes.length
      ? Math.max(this.factor, magnification(deflection / this.height)) : this.factor;
    // what stands left and right of the middle of the base, moving with roof and ground
    const sway = this.bend * deflection + this.factor * (columns.theta
      ? this.height * peak(columns.theta) : peak(columns.u_s));
    const moves = sway + peak(ground) + 0.08 * this.height;
    this.left = moves + (scene.h ? scene.b + (scene.frame ? 1.1 * this.height : 0)
      : 0.3 * this.height);
    this.right = moves + (scene.h ? scene.b : 0.3 * this.height);
    const drawn = [[this.factor, "rotations drawn"],
      [this.modes.length ? this.bend : 1, "deflection of the wall"]];
    this.factorPlace.textContent = drawn.filter(([factor]) => factor > 1)
      .map(([factor, what]) => `${what} ${factor} times`).join(", ");
  }

  // Value of a column at a time, between its rows.
  at(column, t) {
    const times = this.columns.time;
    const n = times.length;
    const x = (t - times[0]) / (times[n - 1] - times[0] || 1) * (n - 1);
    const i = Math.min(n - 1, Math.max(0, Math.floor(x)));
    const j = Math.min(n - 1, i + 1);
    const [a, b] = [column[i], column[j]];
    return a === null || b === null ? (a ?? last(column, i)) : a + (b - a) * (x - i);
  }

  draw(t) {
    this.t = t;
    if (!this.columns) return;
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== width * ratio || canvas.height !== height * ratio) {
      canvas.width = width * ratio;
      canvas.height = height * ratio;
    }
    const ctx = this.ctx = canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.clearRect(0, 0, width, height);
    const H = this.height;
    const scale = Math.min(width / (this.left + this.right), height / (1.25 * H));
    ctx.translate((width - (this.right - this.left) * scale) / 2, height - 0.08 * H * scale);
    ctx.scale(scale, -scale);
    this.pixel = 1 / scale;
    const ground = this.ground ? this.at(this.ground, t) : 0;
    this.soil(ground, H);
    if (this.scene.h) this.wall(t, ground);
    else this.frame(ground, this.factor * this.at(this.columns.u_s, t), null, t);
  }

  // Deflections of the wall at equal distances from foot to top [m]; two zeros for a rigid wall.
  deflections(t) {
    const { shapes } = this.scene;
    if (!this.modes.length) return [0, 0];
    const q = this.modes.map((column) => this.at(column, t));
    return shapes[0].map((_, k) => sum(q.map((qi, i) => qi * shapes[i][k])));
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
    // a wall that is far wider than high has no more strokes than can be seen
    const step = Math.max(0.12 * H, (this.left + this.right) / 200);
    for (let x = ground - this.left; x <= ground + this.right; x += step) {
      this.path([[x, y], [x - 0.05 * H, y - 0.05 * H]], "alone", 1);
    }
  }

  wall(t, ground) {
    const { h, b, pinned, frame, cable } = this.scene;
    const theta = this.at(this.columns.theta, t);
    const angle = this.factor * theta;
    const box = corners(h, b, angle, pinned).map(([x, y]) => [x + ground, y]);
    // points of a line along the wall, displaced by its deflection
    const w = this.deflections(t);
    const bent = (foot, top) => w.map((wi, i) => {
      const share = i / (w.length - 1);
      return [foot[0] + share * (top[0] - foot[0]) + this.bend * wi * Math.cos(angle),
        foot[1] + share * (top[1] - foot[1]) - this.bend * wi * Math.sin(angle)];
    });
    const face = bent(box[0], box[3]);
    if (frame) this.frame(ground - b, face.at(-1)[0] - (ground - b), face, t, w);
    this.path([...face, ...bent(box[1], box[2]).reverse(), box[0]], "ink", 1.6, "wall");
    if (cable) {
      const top = [(box[2][0] + box[3][0]) / 2, (box[2][1] + box[3][1]) / 2];
      this.path(bent([ground, 0], top), "c2", 2);
    }
    for (const [name, tone] of [["fuse", "c4"], ["damper", "c3"], ["inerter", "c5"]]) {
      if (this.scene[name]) for (const corner of [box[0], box[1]]) this.path(
        [[corner[0], 0], corner], tone, 3);
    }
    const hit = this.impacts.some((instant) => t >= instant && t - instant < FLASH);
    if (hit) {
      const [x, y] = theta > 0 ? box[1] : box[0];
      const { ctx } = this;
      ctx.beginPath();
      ctx.arc(x, y, 7 * this.pixel, 0, 2 * Math.PI);
      ctx.fillStyle = colour("c1");
      ctx.fill();
    }
  }

  // Portal whose roof follows the face of the wall (`face`, points from foot to top), or its own
  // displacement; each link is drawn. `w`: deflections of the wall.
  frame(foot, sway, face, t, w = [0, 0]) {
    const H = this.height;
    const right = face ? foot - 0.5 * H : foot + 0.3 * H;
    const left = right - 0.6 * H;
    const floors = this.scene.heights ? levels(this.scene.heights) : [H];
    const linked = ["every_floor", "springs"].includes(this.scene.coupling);
    // where links hold the frame along the wall it bends with it; elsewhere in a straight line
    const bent = (y) => (this.bend - this.factor) * (linked ? between(w, y / H)
      : y / H * w.at(-1));
    let moved = 0;
    const moves = floors.map((y, i) => {
      const drift = this.columns[`storey_${i + 1}_drift`];
      if (!drift) return sway * y / H;
      moved += this.factor * this.at(drift, t) * this.scene.heights[i];
      return moved + bent(y);
    });
    const shape = this.scene.heights
      ? [[0, 0], ...floors.map((y, i) => [moves[i], y])]
      // clamped at the foot, guided at the roof
      : Array.from({ length: 13 }, (_, i) =>
        [sway * (3 * (i / 12) ** 2 - 2 * (i / 12) ** 3), H * i / 12]);
    for (const x of [left, right]) this.path(shape.map(([u, y]) => [x + u, y]), "c0", 3);
    floors.forEach((y, i) => this.path([[left + moves[i], y], [right + moves[i], y]], "c0", 4));
    if (!face) return;
    for (let i = linked ? 0 : floors.length - 1; i < floors.length; i++) {
      const end = [0, 1].map((k) => between(face.map((point) => point[k]), floors[i] / H));
      this.path([[right + moves[i], floors[i]], end], "ink", 1.2);
    }
  }
}

const sum = (values) => values.reduce((a, x) => a + x, 0);
const peak = (values) => (values ?? []).reduce((a, x) => Math.max(a, Math.abs(x ?? 0)), 0);
// Value at a share of the way along evenly spaced values.
function between(values, share) {
  const x = Math.min(1, Math.max(0, share)) * (values.length - 1);
  const i = Math.min(values.length - 2, Math.floor(x));
  return values[i] + (values[i + 1] - values[i]) * (x - i);
}
const levels = (heights) => heights.reduce((all, x) => [...all, (all.at(-1) ?? 0) + x], []);
const last = (column, i) => { while (i > 0 && column[i] === null) i--; return column[i] ?? 0; };
