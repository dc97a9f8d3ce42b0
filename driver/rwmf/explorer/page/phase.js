// Phase portrait of the wall: angular velocity over rotation, with a point at the time of the clock.

import { panel } from "./figure.js";
import { byId, textSize } from "./format.js";

export class Phase {
  // `rival`: columns of the second curve, or null.
  show(motion, rival) {
    this.motion = motion;
    this.curves = [motion.columns, rival].filter((columns) => columns?.theta)
      .map(({ theta, theta_dot }, i) =>
        ({ x: theta, y: theta_dot, ...(i ? { dash: "6 4" } : {}) }));
    this.make();
  }

  make() {
    const place = byId("phase");
    place.closest(".card").hidden = !this.curves.length;
    // text of the panel is 12 high
    const width = (place.clientWidth || 360) * 12 / textSize();
    this.svg = this.curves.length
      ? panel(this.curves, { width, xLabel: "θ [rad]", yLabel: "θ′ [rad/s]" }) : null;
    place.replaceChildren(...(this.svg ? [this.svg] : []));
    this.now = null;
  }

  mark(t) {
    if (!this.svg) return;
    const { theta, theta_dot } = this.motion.columns;
    this.now?.remove();
    this.now = this.svg.point(this.motion.at(theta, t), this.motion.at(theta_dot, t));
    this.svg.append(this.now);
  }
}
