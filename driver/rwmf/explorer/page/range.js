// Position of a slider and value of its key.

export const STEPS = 500;

export class Range {
  constructor(key, value) {
    this.low = key.low;
    this.high = key.high;
    this.log = key.log;
    this.whole = key.kind === "integer";
    this.widen(value);
  }

  // A value of the case is never outside.
  widen(value) {
    if (this.log) {
      while (value > 0 && value < this.low) this.low /= 10;
      while (value > this.high) this.high *= 10;
    } else {
      if (value < this.low) this.low = value < 0 ? 1.5 * value : 0.5 * value;
      if (value > this.high) this.high = value > 0 ? 1.5 * value : 0.5 * value;
    }
  }

  value(position) {
    const part = position / STEPS;
    if (part === 0 && !this.log) return this.whole ? Math.round(this.low) : this.low;
    if (part === 1) return this.whole ? Math.round(this.high) : this.high;
    const raw = this.log ? this.low * (this.high / this.low) ** part : this.low
      + part * (this.high - this.low);
    if (this.whole) return Math.round(raw);
    if (this.log) return Number(raw.toPrecision(3));
    // as many decimals as the step has, so that a namelist stays readable
    const decimals = Math.max(0, 1 - Math.floor(Math.log10((this.high - this.low) / STEPS)));
    return Number(raw.toFixed(Math.min(decimals, 12)));
  }

  position(value) {
    const part = this.log ? Math.log(value / this.low) / Math.log(this.high / this.low)
      : (value - this.low) / (this.high - this.low);
    return Math.round(Math.min(1, Math.max(0, part)) * STEPS);
  }
}
