// The case that the sliders say: groups with the keys that are given. Every change goes through
// here, so that what excludes or needs each other follows, by the tables of the server.

const copy = (value) => JSON.parse(JSON.stringify(value));

export class Scene {
  constructor(description, changed) {
    this.description = description;
    this.changed = changed;
    this.groups = copy(description.state);
    this.record = "";
    this.recordName = description.record;
    this.keys = new Map();
    for (const group of description.groups) {
      for (const key of group.keys) this.keys.set(`${group.name}.${key.key}`, key);
    }
    this.restore();
  }

  // What the fragment of the address remembers beyond the token.
  restore() {
    const [, text] = location.hash.slice(1).split("&");
    if (!text) return;
    try {
      this.groups = JSON.parse(decodeURIComponent(text));
    } catch { /* a fragment that somebody has cut: the case itself */ }
  }

  remember() {
    const token = location.hash.slice(1).split("&")[0];
    const own = JSON.stringify(this.description.state) === JSON.stringify(this.groups)
      || this.record;
    const text = own ? "" : `&${encodeURIComponent(JSON.stringify(this.groups))}`;
    history.replaceState(null, "", `#${token}${text}`);
  }

  has(group) { return group in this.groups; }

  get(name) {
    const [group, key] = name.split(".");
    return this.groups[group]?.[key];
  }

  question(more = {}) { return { groups: copy(this.groups), record: this.record, ...more }; }

  reset() {
    this.groups = copy(this.description.state);
    this.record = "";
    this.recordName = this.description.record;
    this.changed(true);
  }

  // A number, word or list. What a hand does to a slider changes no other control (`anew`).
  set(name, value) {
    const [group, key] = name.split(".");
    const before = this.groups[group];
    let anew = !(key in before);
    if (name === "wall.h" && this.has("storeys")) anew = this.stretchStoreys(value) || anew;
    before[key] = value;
    for (const same of this.description.alternatives) {
      if (same.includes(name)) for (const other of same) if (other !== name) anew = this.drop(
        other) || anew;
    }
    if (name in this.description.belonging) anew = this.follow(name, value) || anew;
    this.changed(anew);
  }

  unset(name) {
    this.drop(name);
    this.changed(true);
  }

  drop(name) {
    const [group, key] = name.split(".");
    if (!(key in (this.groups[group] ?? {}))) return false;
    delete this.groups[group][key];
    return true;
  }

  start(name) {
    if (this.get(name) !== undefined) return;
    const [group, key] = name.split(".");
    this.groups[group][key] = copy(this.keys.get(name).start);
  }

  // The heights of storeys sum to that of the wall.
  stretchStoreys(h) {
    const heights = this.groups.storeys.height;
    const sum = heights.reduce((a, x) => a + x, 0);
    this.groups.storeys.height = heights.map((x) => x * 2 * h / sum);
    return true;
  }

  // Keys that belong to other values of a choice leave, those that this value needs come.
  follow(name, value) {
    const [group] = name.split(".");
    const table = this.description.belonging[name];
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
    for (const need of group.needs) this.put(need);
    this.groups[name] = {};
    for (const key of group.keys) if (key.default === "required") this.start(`${name}.${key.key}`);
    for (const key of group.needed_too) this.start(`${name}.${key}`);
    for (const key of this.description.instead_of[name] ?? []) this.drop(key);
    if (name === "storeys" && this.has("wall")) this.stretchStoreys(this.groups.wall.h);
    if (name === "p_delta" && !this.has("wall") && !this.has("storeys")) this.start("p_delta.h_f");
    this.neighbours();
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
      const replaced = Object.entries(this.description.instead_of)
        .some(([other, keys]) => this.has(other) && keys.includes(name));
      if (!beside.every((other) => this.has(other)) || replaced) this.drop(name);
      else if (needed) this.start(name);
    }
  }

  useRecord(answer) {
    this.record = answer.record;
    this.recordName = answer.name;
    this.groups.motion = copy(answer.motion);
    this.changed(true);
  }
}
