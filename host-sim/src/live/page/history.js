// The history of the run: records into steps, and the state of the map at any step.
//
// A change keeps what was before it and what is after it, so the time line is walked either way.

const KIND = { run: 1, step: 2, status: 3, rows: 4, skeleton: 5, scan: 6, path: 7, note: 8, end: 9,
  doing: 10 };
const NO_PATH = { cells: [], goals: [], tractor: null, shield: null };

class History {
  constructor() { this.clear(); }

  clear() {
    this.run = null;
    this.end = null;
    this.steps = [];
    this.notes = [];
    this.doings = [];         // the log of the mission
    this.marks = [];          // changes of the status: [step, words]
    this.changes = [];        // of each step: [part, key, before, after]
    this.pending = [];        // changes before their step has come
    this.last = { tiles: new Map(), skeletons: new Map(), path: NO_PATH, status: "idle", scan: null };
    this.rest = new Uint8Array(0);
    this.at = -1;             // the step that is shown
    this.shown = { tiles: new Map(), skeletons: new Map(), path: NO_PATH, status: "idle", scan: null };
    this.dirty = new Set();   // tiles whose picture is old
    this.newest = null;
    this.longest_us = 0;
  }

  // Enters bytes of the history: whole records.
  enter(bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    for (let at = 0; at + 5 <= bytes.byteLength;) {
      const kind = view.getUint8(at), length = view.getUint32(at + 1, true);
      this.record(kind, bytes.subarray(at + 5, at + 5 + length));
      at += 5 + length;
    }
  }

  record(kind, bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const text = () => new TextDecoder().decode(bytes);
    if (kind === KIND.run) this.run = JSON.parse(text());
    else if (kind === KIND.step) this.step(view);
    else if (kind === KIND.status) this.status(text());
    else if (kind === KIND.rows) this.rows(view, bytes);
    else if (kind === KIND.skeleton) this.skeleton(view);
    else if (kind === KIND.scan) this.scan(readScan(view));
    else if (kind === KIND.path) this.change("path", "", readPath(view));
    else if (kind === KIND.note) this.notes.push(JSON.parse(text()));
    else if (kind === KIND.doing) this.doings.push(JSON.parse(text()));
    else if (kind === KIND.end) this.end = JSON.parse(text());
  }

  change(part, key, after) {
    const of = this.last[part];
    const before = of instanceof Map ? of.get(key) : of;
    this.pending.push([part, key, before, after]);
    if (of instanceof Map) of.set(key, after); else this.last[part] = after;
  }

  step(view) {
    let at = 0;
    const f = () => { at += 4; return view.getFloat32(at - 4, true); };
    const u = () => { at += 4; return view.getUint32(at - 4, true); };
    const step = { ms: u(), believed: [f(), f(), f()], true: [f(), f(), f()], v: f(), w: f(),
      known: f(), driven: f(), us: u(), instructions: u() };
    step.quality = view.getUint8(at);
    step.flags = view.getUint8(at + 1);
    step.closed = view.getUint16(at + 2, true);
    step.given_up = view.getUint16(at + 4, true);
    at += 6;
    step.covariance = [f(), f(), f()];
    this.longest_us = Math.max(this.longest_us, step.us);
    step.longest_us = this.longest_us;
    this.steps.push(step);
    this.changes.push(this.pending);
    this.pending = [];
  }

  status(words) {
    this.marks.push([this.steps.length, words]);
    this.change("status", "", words);
  }

  rows(view, bytes) {
    const key = view.getInt16(0, true) + "," + view.getInt16(2, true);
    const mask = view.getUint32(4, true);
    const tile = new Uint8Array(this.last.tiles.get(key) || 256);
    for (let row = 0, at = 8; row < 32; row++) {
      if (mask >>> row & 1) { tile.set(bytes.subarray(at, at + 8), row * 8); at += 8; }
    }
    this.change("tiles", key, tile);
  }

  skeleton(view) {
    const key = view.getInt16(0, true) + "," + view.getInt16(2, true);
    const rows = new Uint16Array(16);
    for (let row = 0; row < 16; row++) rows[row] = view.getUint16(4 + 2 * row, true);
    this.change("skeletons", key, rows);
  }

  // A scan follows its step.
  scan(ranges) {
    const changes = this.changes[this.changes.length - 1];
    if (!changes) return;
    changes.push(["scan", "", this.last.scan, { ranges, step: this.steps.length - 1 }]);
    this.last.scan = changes[changes.length - 1][3];
  }

  // Shows another step.
  seek(to) {
    to = Math.max(-1, Math.min(to, this.steps.length - 1));
    while (this.at < to) for (const change of this.changes[++this.at]) this.apply(change, 3);
    while (this.at > to) {
      const changes = this.changes[this.at--];
      for (let i = changes.length - 1; i >= 0; i--) this.apply(changes[i], 2);
    }
  }

  apply(change, which) {
    const [part, key] = change, value = change[which], of = this.shown[part];
    if (!(of instanceof Map)) { this.shown[part] = value; return; }
    if (value === undefined) of.delete(key); else of.set(key, value);
    if (part === "tiles") this.dirty.add(key);
  }

  // Returns the last step at or before a time.
  stepAt(ms) {
    let low = 0, high = this.steps.length - 1;
    while (low < high) {
      const middle = low + high + 1 >> 1;
      if (this.steps[middle].ms <= ms) low = middle; else high = middle - 1;
    }
    return high < 0 ? -1 : low;
  }

  // Returns the scan to draw, and the step at whose pose it was taken.
  shownScan() {
    if (this.newest && this.at === this.newest.step) return this.newest;
    const scan = this.shown.scan;
    return scan && this.at - scan.step < 3 ? scan : null;
  }
}

function readScan(view) {
  const ranges = new Uint16Array(view.byteLength / 2);
  for (let i = 0; i < ranges.length; i++) ranges[i] = view.getUint16(2 * i, true);
  return ranges;
}

function readPath(view) {
  let at = 1;
  // A roadmap cell of 20 cm, named by its least map cell of 10 cm: its middle.
  const place = () => {
    at += 4;
    return [(view.getInt16(at - 4, true) + 1) / 10, (view.getInt16(at - 2, true) + 1) / 10];
  };
  const flags = view.getUint8(0);
  const path = { cells: [], goals: [], tractor: null, shield: null };
  if (flags & 1) path.tractor = place();
  if (flags & 2) path.shield = [place(), place()];
  const cells = view.getUint16(at, true);
  at += 2;
  for (let i = 0; i < cells; i++) path.cells.push(place());
  for (; at + 8 <= view.byteLength; at += 8) {
    path.goals.push([view.getFloat32(at, true), view.getFloat32(at + 4, true)]);
  }
  return path;
}
