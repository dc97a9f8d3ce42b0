// The case of the sliders: groups with the given keys. Every change goes through here and applies
// the server's tables of exclusions and requirements.

import { copy } from "./format.js";

export class Scene {
  constructor(description, changed) {
    this.description = description;
    this.keys = new Map();
    for (const group of description.groups) {
      for (const key of group.keys) this.keys.set(`${group.name}.${key.key}`, key);
    }
    this.changed = () => {};
    this.restore(null);
    this.changed = changed;
  }

  // State for the address: groups, uploaded record and preset; null for the case itself.
  state() {
    const same = JSON.stringify(this.description.state) === JSON.stringify(this.groups);
    if (same && !this.record && !this.preset) return null;
    const { groups, record, recordName, recordMotion, preset } = this;
    return copy({ groups, ...(record ? { record, recordName, recordMotion } : {}),
      ...(preset ? { preset } : {}) });
  }

  // Take a state of the address; null and a damaged one give the case itself.
  restore(state) {
    const { description } = this;
    const found = this.fits(state?.groups) ? copy(state) : { groups: copy(description.state) };
    this.groups = found.groups;
    const hasRecord = /^[0-9]{1,9}$/.test(found.record ?? "")
      && this.fits({ motion: found.recordMotion });
    this.record = hasRecord ? String(found.record) : "";
    this.recordName = hasRecord ? String(found.recordName) : description.record;
    this.preset = description.presets.some(({ name }) => name === found.preset) ? found.preset : "";
    this.recordMotion = hasRecord ? found.recordMotion
      : description.record ? copy(description.state.motion) : null;
    this.changed(true);
  }

  // True for groups of known keys whose values have the right types.
  fits(groups) {
    const isObject = (x) => typeof x === "object" && x !== null && !Array.isArray(x);
    const types = { real: "number", integer: "number", logical: "boolean" };
    const typed = (key, value) => (key?.kind.endsWith("list") ? Array.isArray(value)
      : key && typeof value === (types[key.kind] ?? "string"));
    return isObject(groups) && Object.entries(groups).every(([group, keys]) => isObject(keys)
      && this.group(group) && Object.entries(keys).every(([key, value]) =>
        typed(this.keys.get(`${group}.${key}`), value)));
  }

  has(group) { return group in this.groups; }

  get(name) {
    const [group, key] = name.split(".");
    return this.groups[group]?.[key];
  }

  question(more = {}) { return { groups: copy(this.groups), record: this.record, ...more }; }

  // The case itself, or a preset.
  load(name) {
    const preset = this.description.presets.find((item) => item.name === name);
    this.restore(preset ? { groups: preset.state, preset: name } : null);
  }

  // Set a number, word or list. Other keys need other controls (`anew`).
  set(name, value) {
    const before = this.names();
    if (name === "wall.h" && this.has("storeys")) this.stretchStoreys(value);
    this.setKey(name, value);
    if (name === "storeys.height" && this.has("wall")) this.stretchWall();
    this.settle();
    this.changed(name in this.description.belonging || this.names() !== before);
  }

  // Set a key to its first value.
  begin(name) { this.set(name, this.startOf(name)); }

  unset(name) {
    this.leave(name);
    this.settle();
    this.changed(true);
  }

  // The given keys in one text.
  names() {
    const { groups } = this;
    return Object.keys(groups).map((group) => `${group} ${Object.keys(groups[group])}`).join();
  }

  // Set a key, remove keys of the same quantity and add the keys that it requires.
  setKey(name, value) {
    const [group, key] = name.split(".");
    this.groups[group][key] = value;
    this.bring(name);
    for (const other of this.others(name)) this.leave(other);
    if (name === "storeys.distribution") this.oneStiffness();
    if (name in this.description.belonging) this.follow(name, value);
    this.unpublish(name, `${name}=${value}`);
  }

  bring(name) {
    for (const needed of this.description.brings[name] ?? []) {
      const either = this.either(needed);
      if (either.some((other) => this.get(other) !== undefined)) continue;
      const first = either.find((other) => this.possible(other));
      if (first && this.has(first.split(".")[0])) this.setKey(first, this.startOf(first));
    }
  }

  // Remove a key and those that require it.
  leave(name) {
    if (!this.drop(name)) return;
    for (const [other, needed] of Object.entries(this.description.brings)) {
      if (this.get(other) !== undefined && needed.map((keys) => this.either(keys)).some((either) =>
        either.includes(name) && either.every((key) => this.get(key) === undefined))) this.leave(
        other);
    }
    this.refill(name);
  }

  // After a key is removed, another key of the same quantity may be required.
  refill(name) {
    for (const other of this.others(name)) {
      const [group, key] = other.split(".");
      if (!this.has(group) || !this.possible(other)) continue;
      if (this.keys.get(other).default === "required"
        || this.group(group).needed_too.includes(key) || this.chosen(group, key)) this.start(other);
    }
  }

  // True if the value of a choice requires this key or another one of the same quantity.
  chosen(group, key) {
    return Object.entries(this.description.belonging).some(([choice, table]) =>
      choice.startsWith(`${group}.`) && Object.entries(table[this.get(choice)] ?? {})
        .some(([keys, needed]) => needed && keys.split("|").includes(key)));
  }

  either(keys) {
    const [group, words] = keys.split(".");
    return words.split("|").map((key) => `${group}.${key}`);
  }

  // Other keys of the same quantity.
  others(name) {
    return this.description.alternatives.filter((same) => same.includes(name)).flat()
      .filter((other) => other !== name);
  }

  // True if a group of this scene replaces the key.
  replaced(name) {
    return Object.entries(this.description.instead_of)
      .some(([group, keys]) => this.has(group) && keys.includes(name));
  }

  // Test a condition: 'group.key', 'group.key=value', or '!group.key' for an absent key.
  holds(condition) {
    if (condition.startsWith("!")) return this.get(condition.slice(1)) === undefined;
    const [name, value] = condition.split("=");
    const own = this.get(name);
    return value === undefined ? own !== undefined : String(own) === value;
  }

  // True if a key may be set beside the others.
  possible(name) {
    const { belonging, implied, only_beside: beside, only_with: groups } = this.description;
    const [group, key] = name.split(".");
    if (this.replaced(name)) return false;
    for (const other in implied) if (this.has(other) && implied[other][name] === null) return false;
    if (beside[name] && !beside[name].some((condition) => this.holds(condition))) return false;
    if (groups[name] && !groups[name][0].every((other) => this.has(other))) return false;
    for (const [choice, table] of Object.entries(belonging)) {
      if (choice.split(".")[0] !== group) continue;
      const lists = (keys) => Object.keys(keys ?? {}).some((item) => item.split("|").includes(key));
      // a rule of impact follows from its numbers
      const own = this.get(choice) ?? (group === "impact" ? null : this.keys.get(choice).default);
      if (own !== null && Object.values(table).some(lists) && !lists(table[own])) return false;
    }
    return true;
  }

  // Remove keys that the present scene excludes.
  settle() {
    this.neighbours();
    for (const name of Object.keys(this.description.only_beside)) {
      if (this.get(name) === undefined || this.possible(name)) continue;
      this.drop(name);
      this.refill(name);
    }
  }

  // Keys that the published equation excludes select the exact one.
  unpublish(...names) {
    if (this.get("model.formulation") === "published"
      && names.some((name) => this.description.not_published.includes(name))) {
      this.groups.model.formulation = "exact";
    }
  }

  // A distribution spreads the stiffness of the lowest storey.
  oneStiffness() {
    for (const key of ["k", "k_over_m_w"]) {
      const list = this.groups.storeys[key];
      if (list) this.groups.storeys[key] = list.slice(0, 1);
    }
  }

  drop(name) {
    const [group, key] = name.split(".");
    if (!(key in (this.groups[group] ?? {}))) return false;
    delete this.groups[group][key];
    return true;
  }

  start(name) {
    if ([name, ...this.others(name)].some((same) => this.get(same) !== undefined)) return;
    const [group, key] = name.split(".");
    this.groups[group][key] = this.startOf(name);
  }

  startOf(name) {
    const start = copy(this.keys.get(name).start);
    const { storeys, cable } = this.groups;
    const eta = cable?.eta_0 ?? this.keys.get("cable.eta_0").start;
    const n = storeys?.n ?? storeys?.height?.length;
    if (name === "storeys.n" && n) return n;
    if (/^storeys\.[mk](_|$)/.test(name) && n) {
      const one = storeys.distribution && name.startsWith("storeys.k");
      return Array(one ? 1 : n).fill(start[0]);
    }
    // a cable has a stiffness by growing, and yields beyond its prestress
    if (name === "cable.eta_alpha") return 2 * eta + 1;
    if (name === "cable.eta_y") return Math.max(start, 2 * (cable.eta_alpha ?? eta));
    return start;
  }

  // The heights of storeys sum to that of the wall; one value holds for n storeys.
  stretchStoreys(h) {
    const { height } = this.groups.storeys;
    const sum = this.sumOfHeights();
    this.groups.storeys.height = height.map((x) => Number((x * 2 * h / sum).toPrecision(12)));
  }

  stretchWall() {
    this.groups.wall.h = Number((this.sumOfHeights() / 2).toPrecision(12));
  }

  sumOfHeights() {
    const { height, n } = this.groups.storeys;
    const sum = height.reduce((a, x) => a + x, 0);
    return height.length === 1 ? sum * (n ?? 1) : sum;
  }

  // Remove keys of other values of a choice, and add those that this value requires.
  follow(name, value) {
    const [group] = name.split(".");
    const table = this.description.belonging[name];
    if (name === "motion.kind" && value === "record" && this.recordMotion) {
      // unit and interval belong to the file, which is still there
      this.groups.motion = copy(this.recordMotion);
      return true;
    }
    const mine = table[value] ?? {};
    const allowed = new Set(Object.keys(mine).flatMap((keys) => keys.split("|")));
    for (const keys of Object.values(table).flatMap(Object.keys)) {
      for (const key of keys.split("|")) if (!allowed.has(key)) this.drop(`${group}.${key}`);
    }
    for (const [keys, needed] of Object.entries(mine)) {
      const either = keys.split("|").map((key) => `${group}.${key}`);
      if (needed && either.every((key) => this.get(key) === undefined)) this.start(either[0]);
    }
    return true;
  }

  group(name) { return this.description.groups.find((group) => group.name === name); }

  add(name) {
    this.put(name);
    this.changed(true);
  }

  put(name) {
    if (this.has(name)) return;
    const group = this.group(name);
    const { either, implied } = this.description;
    for (const pair of either.filter((names) => names.includes(name))) {
      for (const other of pair) this.take(other);
    }
    for (const need of group.needs) this.put(need);
    this.groups[name] = {};
    for (const key of group.keys) if (key.default === "required") this.start(`${name}.${key.key}`);
    for (const key of group.needed_too) {
      if (this.possible(`${name}.${key}`)) this.start(`${name}.${key}`);
    }
    for (const key of this.description.instead_of[name] ?? []) this.drop(key);
    if (name === "storeys" && this.has("wall")) this.stretchStoreys(this.groups.wall.h);
    if (name === "p_delta" && !this.has("wall") && !this.has("storeys")) this.start("p_delta.h_f");
    for (const [key, value] of Object.entries(implied[name] ?? {})) {
      if (value === null) this.leave(key);
      else if (!(Number(value) <= this.get(key))) { // further walls remain
        this.put(key.split(".")[0]);
        this.setKey(key, value);
      }
    }
    this.neighbours();
    this.unpublish(name);
  }

  // Let the wall go from a rotation, over its slenderness, while the ground rests.
  release(share) {
    this.put("initial");
    this.groups.initial = { theta_over_alpha: share };
    this.take("vertical");
    if (this.has("motion")) this.setKey("motion.kind", "none");
    // a record set the end of the run
    this.put("solver");
    this.start("solver.t_end");
    this.settle();
    this.changed(true);
  }

  remove(name) {
    this.take(name);
    this.changed(true);
  }

  take(name) {
    if (!this.has(name)) return;
    delete this.groups[name];
    for (const group of this.description.groups) if (group.needs.includes(name)) this.take(
      group.name);
    for (const key of this.description.instead_of[name] ?? []) {
      const [group, word] = key.split(".");
      if (this.has(group) && this.group(group).needed_too.includes(word)) this.start(key);
    }
    if (name === "wall" && this.has("p_delta") && !this.has("storeys")) this.start("p_delta.h_f");
    this.neighbours();
  }

  // Keys that exist only beside another group.
  neighbours() {
    for (const [name, [beside, needed]] of Object.entries(this.description.only_with)) {
      const [group] = name.split(".");
      if (!this.has(group)) continue;
      if (!beside.every((other) => this.has(other)) || this.replaced(name)) this.drop(name);
      else if (needed) this.start(name);
    }
    for (const name of Object.keys(this.description.brings)) {
      if (this.get(name) !== undefined) this.bring(name);
    }
  }

  useRecord(answer) {
    this.record = answer.record;
    this.recordName = answer.name;
    this.groups.motion = copy(answer.motion);
    this.recordMotion = copy(answer.motion);
    // a run lasts as long as its record; a slider makes it longer
    if (this.has("solver") && answer.end > 0) this.groups.solver.t_end = answer.end;
    // a vertical record belongs to the removed one
    if (this.has("vertical") && this.get("vertical.ratio") === undefined) delete this.groups
      .vertical;
    this.changed(true);
  }
}
