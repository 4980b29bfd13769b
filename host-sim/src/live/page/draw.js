// The picture: cells, skeleton, path, trails, scan, robot. Colours that colour-blind eyes tell
// apart; every mark also has a shape of its own.

const COLOUR = {
  unknown: "#cdd3da", free: "#ffffff", obstacle: "#1d232b", negative: "#8a5a3b",
  skeleton: "#6fb0d8", path: "#a3327d", believed: "#0067a5", true: "#e07b00", scan: "#00956c",
  loop: "#a01c28", fence: "#1d232b", left: "#f0d93a", grid: "#e6e9ed", ink: "#1d232b",
};
const CELLS = [[205, 211, 218], [255, 255, 255], [29, 35, 43], [138, 90, 59]];
const TILE = 32, CELL_M = 0.1, TILE_M = TILE * CELL_M;

// Text grows with that of the page: on a projector too.
let UNIT = 1;
const font = (size, weight) => `${weight || 400} ${size * UNIT}px system-ui, sans-serif`;

// The cells of the map as an image that grows with it.
class CellImage {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.box = null;
  }

  paint(history) {
    if (!history.dirty.size) return;
    this.reach(history);
    const context = this.canvas.getContext("2d");
    for (const key of history.dirty) {
      const [x, y] = key.split(",").map(Number), tile = history.shown.tiles.get(key);
      const left = (x - this.box[0]) * TILE, top = (this.box[3] - y) * TILE;
      if (!tile) { context.clearRect(left, top, TILE, TILE); continue; }
      const image = context.createImageData(TILE, TILE);
      for (let i = 0; i < TILE * TILE; i++) {
        const kind = tile[i >> 2] >> 2 * (i & 3) & 3;
        const to = 4 * ((TILE - 1 - (i >> 5)) * TILE + (i & 31));
        image.data.set(CELLS[kind], to);
        image.data[to + 3] = kind ? 255 : 0;
      }
      context.putImageData(image, left, top);
    }
    history.dirty.clear();
  }

  // Grows to hold every tile; then all tiles are drawn anew.
  reach(history) {
    const box = this.box ? [...this.box] : [Infinity, Infinity, -Infinity, -Infinity];
    for (const key of history.dirty) {
      const [x, y] = key.split(",").map(Number);
      box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
    }
    if (this.box && box.every((side, i) => side === this.box[i])) return;
    this.box = box;
    this.canvas.width = (box[2] - box[0] + 1) * TILE;
    this.canvas.height = (box[3] - box[1] + 1) * TILE;
    for (const key of history.shown.tiles.keys()) history.dirty.add(key);
  }

  draw(context, view) {
    if (!this.box) return;
    const [left, top] = view.spot(this.box[0] * TILE_M, (this.box[3] + 1) * TILE_M);
    const scale = view.scale * CELL_M;
    context.imageSmoothingEnabled = scale < 1;
    context.drawImage(this.canvas, left, top, this.canvas.width * scale, this.canvas.height * scale);
  }
}

// Metres to pixels: y is up.
class View {
  constructor() { this.scale = 30; this.x = 0; this.y = 0; this.fits = true; }

  size(width, height) { this.width = width; this.height = height; }

  spot(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  place(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }

  zoom(factor, px, py) {
    const [x, y] = this.place(px, py);
    this.scale = Math.max(2, Math.min(400, this.scale * factor));
    const [x1, y1] = this.place(px, py);
    this.x += x - x1; this.y += y - y1;
    this.fits = false;
  }

  fit(history) {
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const grow = (x, y) => {
      box[0] = Math.min(box[0], x); box[1] = Math.min(box[1], y);
      box[2] = Math.max(box[2], x); box[3] = Math.max(box[3], y);
    };
    for (const [key, tile] of history.last.tiles) growTile(tile, key, grow);
    const step = history.steps[history.steps.length - 1];
    if (step) for (const pose of [step.believed, step.true]) grow(pose[0], pose[1]);
    if (box[0] > box[2]) return;
    // Room for the numbers on the left, the scale and the buttons below.
    const [left, low, margin] = [28 * UNIT, 58 * UNIT, 12];
    const scale = Math.min((this.width - left - margin) / (box[2] - box[0] + 0.4),
      (this.height - low - margin) / (box[3] - box[1] + 0.4));
    this.scale = Math.max(2, Math.min(60, scale));
    this.x = (box[0] + box[2]) / 2 - (left - margin) / 2 / this.scale;
    this.y = (box[1] + box[3]) / 2 - (low - margin) / 2 / this.scale;
  }
}

// Grows a box by the known rows and bytes of a tile.
function growTile(tile, key, grow) {
  const [x, y] = key.split(",").map(Number);
  for (let i = 0; i < 256; i++) {
    if (!tile[i]) continue;
    const left = x * TILE_M + (i & 7) * 0.4, low = y * TILE_M + (i >> 3) * CELL_M;
    grow(left, low); grow(left + 0.4, low + CELL_M);
  }
}

function drawAll(context, view, history, cells, show) {
  context.fillStyle = COLOUR.unknown;
  context.fillRect(0, 0, view.width, view.height);
  cells.paint(history);
  cells.draw(context, view);
  drawGrid(context, view);
  drawFence(context, view, history);
  if (show.skeleton) drawSkeleton(context, view, history.shown.skeletons);
  const step = history.steps[history.at];
  if (step) {
    const scan = history.shownScan();
    if (scan) drawScan(context, view, history, scan);
    if (show.true) drawTrail(context, view, history, "true");
    drawTrail(context, view, history, "believed");
    // A robot that stands follows no path; the last one is still in its memory.
    if (/^(exploring|going)/.test(history.shown.status)) drawPath(context, view, history.shown.path);
    if (history.end && history.at === history.steps.length - 1) drawLeft(context, view, history.end);
    if (show.true) drawRobot(context, view, history, step.true, "true");
    drawCovariance(context, view, step);
    drawRobot(context, view, history, step.believed, "believed");
    drawNames(context, view, history, step, show);
  }
  if (show.aim) drawAim(context, view, show.aim);
  drawScale(context, view);
}

function line(context, view, points, width, colour, dash) {
  context.beginPath();
  let before = null;
  for (const point of points) {
    const at = view.spot(point[0], point[1]);
    // Points within a pixel of each other are one.
    if (before && Math.abs(at[0] - before[0]) + Math.abs(at[1] - before[1]) < 1) continue;
    if (before) context.lineTo(at[0], at[1]); else context.moveTo(at[0], at[1]);
    before = at;
  }
  context.setLineDash(dash || []);
  context.lineJoin = context.lineCap = "round";
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.stroke();
  context.setLineDash([]);
}

function drawGrid(context, view) {
  const every = view.scale > 8 ? 5 : 25;
  const [x0, y1] = view.place(0, 0), [x1, y0] = view.place(view.width, view.height);
  context.globalCompositeOperation = "multiply";
  context.fillStyle = COLOUR.grid;
  for (let x = Math.ceil(x0 / every) * every; x < x1; x += every) {
    context.fillRect(Math.round(view.spot(x, 0)[0]), 0, 1, view.height);
  }
  for (let y = Math.ceil(y0 / every) * every; y < y1; y += every) {
    context.fillRect(0, Math.round(view.spot(0, y)[1]), view.width, 1);
  }
  context.globalCompositeOperation = "source-over";
  context.fillStyle = "#3b4550";
  context.font = font(13);
  context.textAlign = "center";
  for (let x = Math.ceil(x0 / every) * every; x < x1; x += every) {
    context.fillText(x, view.spot(x, 0)[0], view.height - 6 * UNIT);
  }
  context.textAlign = "left";
  for (let y = Math.ceil(y0 / every) * every; y < y1; y += every) {
    const at = view.spot(0, y)[1];
    if (at > 14 && at < view.height - 24 * UNIT) context.fillText(y, 5, at + 4 * UNIT);
  }
}

function drawScale(context, view) {
  const length = [1, 2, 5, 10, 20, 50].filter(m => m * view.scale <= view.width / 4).pop() || 1;
  const wide = length * view.scale, left = 34 * UNIT, top = view.height - 36 * UNIT;
  context.fillStyle = "#ffffffd0";
  context.fillRect(left - 8, top - 12 * UNIT, wide + 56 * UNIT, 24 * UNIT);
  context.fillStyle = COLOUR.ink;
  context.fillRect(left, top - 2, wide, 4);
  context.font = font(14);
  context.textAlign = "left";
  context.fillText(length + " m", left + wide + 6, top + 5 * UNIT);
}

function drawFence(context, view, history) {
  const polygons = history.run ? history.run.fence : [];
  for (const { bounds, corners } of polygons) {
    line(context, view, [...corners, corners[0]], 2.5, COLOUR.fence, bounds ? [10, 6] : [3, 4]);
  }
}

function drawSkeleton(context, view, skeletons) {
  const has = (x, y) => {
    const rows = skeletons.get((x >> 4) + "," + (y >> 4));
    return rows && rows[y & 15] >> (x & 15) & 1;
  };
  context.beginPath();
  for (const [key, rows] of skeletons) {
    const [tx, ty] = key.split(",").map(Number);
    for (let row = 0; row < 16; row++) {
      for (let column = 0, bits = rows[row]; bits; column++, bits >>= 1) {
        if (!(bits & 1)) continue;
        const x = tx * 16 + column, y = ty * 16 + row, at = view.spot((x + 0.5) / 5, (y + 0.5) / 5);
        for (const [dx, dy] of [[1, 0], [0, 1], [1, 1], [-1, 1]]) {
          if (!has(x + dx, y + dy)) continue;
          // A diagonal beside a straight way is no way of its own.
          if (dx && dy && (has(x + dx, y) || has(x, y + dy))) continue;
          context.moveTo(at[0], at[1]);
          context.lineTo(...view.spot((x + dx + 0.5) / 5, (y + dy + 0.5) / 5));
        }
      }
    }
  }
  context.lineWidth = Math.max(1.5, view.scale * 0.04);
  context.strokeStyle = COLOUR.skeleton;
  context.stroke();
}

function drawScan(context, view, history, { ranges, step }) {
  const { laser } = history.run, [x, y, yaw] = history.steps[step].believed;
  const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
  const from = [x + c * laser.x - s * laser.y, y + s * laser.x + c * laser.y];
  const hits = [], rim = [from];
  ranges.forEach((mm, i) => {
    if (!mm) return;
    const far = mm >= laser.no_return_mm, range = (far ? laser.limit_mm : mm) / 1000;
    const at = yaw + laser.first + i * laser.step;
    const point = [from[0] + range * Math.cos(at), from[1] + range * Math.sin(at)];
    rim.push(point);
    if (!far) hits.push(point);
  });
  context.beginPath();
  rim.forEach((point, i) => {
    const at = view.spot(...point);
    if (i) context.lineTo(...at); else context.moveTo(...at);
  });
  context.fillStyle = COLOUR.scan + "22";
  context.fill();
  context.fillStyle = COLOUR.scan;
  const side = Math.max(3, Math.min(6, view.scale * 0.12));
  for (const point of hits) {
    const at = view.spot(...point);
    context.fillRect(at[0] - side / 2, at[1] - side / 2, side, side);
  }
}

function drawTrail(context, view, history, which) {
  const points = history.steps.slice(0, history.at + 1).map(step => step[which]);
  const dash = which === "true" ? [7, 5] : [];
  line(context, view, points, which === "true" ? 3 : 1.8, COLOUR[which] + "b0", dash);
}

function drawPath(context, view, path) {
  if (path.shield) line(context, view, path.shield, 5, COLOUR.loop);
  if (path.tractor) ring(context, view, path.tractor, COLOUR.loop);
  if (path.cells.length) {
    line(context, view, path.cells, 6, "#ffffffc0");
    line(context, view, path.cells, 3.5, COLOUR.path);
    const goal = view.spot(...path.cells[path.cells.length - 1]);
    diamond(context, goal, 9, COLOUR.path, "#ffffff");
  }
  if (path.goals.length) {
    const sum = path.goals.reduce((sum, at) => [sum[0] + at[0], sum[1] + at[1]], [0, 0]);
    const middle = sum.map(all => all / path.goals.length);
    // The cell nearest to the middle: goals may lie on both sides of a wall.
    const off = at => Math.hypot(at[0] - middle[0], at[1] - middle[1]);
    const at = path.goals.reduce((best, goal) => off(goal) < off(best) ? goal : best);
    diamond(context, view.spot(...at), 6, "#ffffff", COLOUR.path);
  }
}

function diamond(context, [x, y], size, fill, stroke) {
  context.beginPath();
  context.moveTo(x, y - size); context.lineTo(x + size, y);
  context.lineTo(x, y + size); context.lineTo(x - size, y);
  context.closePath();
  context.fillStyle = fill;
  context.fill();
  context.lineWidth = 2;
  context.strokeStyle = stroke;
  context.stroke();
}

function ring(context, view, place, colour) {
  const at = view.spot(...place);
  context.beginPath();
  context.arc(at[0], at[1], 8, 0, 2 * Math.PI);
  context.lineWidth = 3;
  context.strokeStyle = colour;
  context.stroke();
}

function drawLeft(context, view, end) {
  for (const left of end.left) {
    const [x, y] = view.spot(left.x_m, left.y_m);
    context.fillStyle = COLOUR.left;
    context.fillRect(x - 5, y - 5, 10, 10);
    context.lineWidth = 1.5;
    context.strokeStyle = COLOUR.ink;
    context.strokeRect(x - 5, y - 5, 10, 10);
  }
}

function drawRobot(context, view, history, [x, y, yaw], which) {
  const hull = history.run ? history.run.hull_m : [0.5, 0.5];
  // It stays visible on a map of a hundred metres.
  const scale = Math.max(view.scale, 16 / hull[0]);
  const [length, width] = hull.map(side => side * scale / 2);
  context.save();
  context.translate(...view.spot(x, y));
  context.rotate(-yaw);
  context.beginPath();
  context.moveTo(-length, -width); context.lineTo(length * 0.5, -width);
  context.lineTo(length, 0); context.lineTo(length * 0.5, width);
  context.lineTo(-length, width);
  context.closePath();
  if (which === "believed") {
    context.fillStyle = COLOUR.believed;
    context.fill();
    context.lineWidth = 1.5;
    context.strokeStyle = "#ffffff";
  } else {
    context.lineWidth = 5;
    context.strokeStyle = COLOUR.true;
  }
  context.stroke();
  context.restore();
}

// The ellipse that holds the true place in 86 of 100 cases: two standard deviations.
function drawCovariance(context, view, step) {
  const [xx, xy, yy] = step.covariance;
  if (xx + yy <= 0) return;
  const middle = (xx + yy) / 2, apart = Math.hypot((xx - yy) / 2, xy);
  const radius = variance => 2 * Math.sqrt(Math.max(0, variance)) * view.scale;
  const at = view.spot(step.believed[0], step.believed[1]);
  context.beginPath();
  context.ellipse(at[0], at[1], radius(middle + apart), radius(middle - apart),
    -Math.atan2(2 * xy, xx - yy) / 2, 0, 2 * Math.PI);
  context.lineWidth = 1.5;
  context.strokeStyle = COLOUR.believed;
  context.stroke();
}

function drawNames(context, view, history, step, show) {
  context.font = font(14, 600);
  const name = (pose, words, colour, dx, dy, align) => {
    const [x, y] = view.spot(pose[0], pose[1]);
    context.textAlign = align;
    context.lineWidth = 4;
    context.lineJoin = "round";
    context.strokeStyle = "#ffffff";
    context.strokeText(words, x + dx, y + dy);
    context.fillStyle = colour;
    context.fillText(words, x + dx, y + dy);
  };
  const off = 10 + 0.25 * view.scale;
  name(step.believed, "believed", COLOUR.believed, off, -off, "left");
  if (show.true) name(step.true, second(history.run), "#b35f00", -off, off + 10, "right");
}

function drawAim(context, view, aim) {
  const [x, y] = view.spot(...aim);
  context.strokeStyle = COLOUR.path;
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(x, y, 10, 0, 2 * Math.PI);
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 5 * dx, y + 5 * dy);
    context.lineTo(x + 16 * dx, y + 16 * dy);
  }
  context.stroke();
}
