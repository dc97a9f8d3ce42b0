// The motion of one state: values of its history at a time, for the moving picture.

const VISIBLE = 0.12; // a rotation that a person sees [rad]

// 1, 2, 5 or 10 times a power of ten, 1 for large rotations.
export function magnification(largest) {
  if (!(largest > 0) || largest >= VISIBLE) return 1;
  const wanted = VISIBLE / largest;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  return decade * Math.max(...[1, 2, 5, 10].filter((step) => step * decade <= wanted));
}

export const sum = (values) => values.reduce((a, x) => a + x, 0);
export const peak = (values) => (values ?? []).reduce((a, x) => Math.max(a, Math.abs(x ?? 0)), 0);
const last = (column, i) => { while (i > 0 && column[i] === null) i--; return column[i] ?? 0; };

export class Motion {
  // `columns` and `ground` are arrays over the rows of the history, `impacts` instants.
  constructor(answer, columns, ground, impacts) {
    const { scene, profile } = answer;
    Object.assign(this, { scene, profile, columns, ground, impacts });
    // a frame without height is drawn 4 m tall
    this.height = scene.h ? 2 * scene.h : sum(profile.heights) || 4;
    this.rotation = columns.theta ? peak(columns.theta) : peak(columns.u_s) / this.height;
    // the modes of a wall that bends; each is 1 at the top
    this.modes = (scene.shapes ?? []).map((_, i) => columns[`q_${i + 1}`]);
    this.deflection = peak(Array.from(columns.time,
      (_, i) => sum(this.modes.map((q) => q[i] ?? 0))));
    this.drifts = this.driftColumns();
    this.floors = profile.acceleration.map((_, i) => columns[`floor_${i + 1}_acceleration_g`]);
    this.yieldTimes = profile.yield.map((level, i) => {
      const row = this.drifts[i].findIndex((x) => Math.abs(x ?? 0) > level);
      return row < 0 ? Infinity : columns.time[row];
    });
  }

  // Drift of each storey over its height; a frame with one storey has its displacement.
  driftColumns() {
    const { heights } = this.profile;
    const { columns } = this;
    return heights.map((h, i) => columns[`storey_${i + 1}_drift`]
      ?? Array.from(columns.u_s, (x) => (x === null ? null : x / h)));
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

  // The initial state of a rotation: the wall takes along the floors that are linked to it.
  tilted(theta) {
    const { coupling, heights } = this.scene;
    const drifts = this.drifts.map((_, i, all) => (coupling === "every_floor" ? theta
      : coupling === "full" && i === all.length - 1 ? theta * this.height / heights[i] : 0));
    return Object.assign(Object.create(this), { ground: null,
      at: (column) => (column === this.columns.theta ? theta
        : drifts[this.drifts.indexOf(column)] ?? 0) });
  }

  // Deflections of the wall at equal distances from foot to top [m]; two zeros for a rigid wall.
  deflections(t) {
    const { shapes } = this.scene;
    if (!this.modes.length) return [0, 0];
    const q = this.modes.map((column) => this.at(column, t));
    return shapes[0].map((_, k) => sum(q.map((qi, i) => qi * shapes[i][k])));
  }
}
