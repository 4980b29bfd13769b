// Words and numbers beside the picture, the curve over the time line, the legend.

const $ = id => document.getElementById(id);
const say = (id, words) => { const at = $(id); if (at.textContent !== words) at.textContent = words; };
const QUALITY = ["odometry", "tracking", "degenerate", "lost", "standing"];
const QUALITY_MEANS = ["The pose is that of the odometry", "The scan holds the pose",
  "In some direction only odometry holds the pose", "The scan contradicts the map",
  "The robot stands, and the pose is carried by the odometry"];

function clock(ms) {
  const s = Math.floor(ms / 1000), pad = n => String(n).padStart(2, "0");
  return s < 3600 ? Math.floor(s / 60) + ":" + pad(s % 60)
    : Math.floor(s / 3600) + ":" + pad(Math.floor(s / 60) % 60) + ":" + pad(s % 60);
}

function words(status) {
  return status.replace("(", ": ").replace(")", "").replaceAll("-", " ");
}

function showNumbers(history) {
  const step = history.steps[history.at], run = history.run;
  if (run) {
    say("title", `${run.world} · ${run.strategy} · ${run.link} · seed ${run.seed}`);
    document.title = `${run.world} – Fieldline live`;
  }
  if (!step) return;
  say("known-of", again(run) ? "Replayed" : "Known");
  say("known", (100 * step.known).toFixed(1) + " %");
  say("second-pose", second(run));
  say("driven", step.driven.toFixed(1) + " m");
  say("speed", step.v.toFixed(2) + " m/s");
  say("quality", QUALITY[step.quality]);
  $("quality").title = QUALITY_MEANS[step.quality];
  $("quality").className = step.quality === 2 || step.quality === 3 ? "bad" : "";
  showPoses(step);
  showBudget(step, run);
  const loops = [step.flags & 1 ? "closing a loop" : "", step.closed ? step.closed + " closed" : "",
    step.given_up ? step.given_up + " given up" : ""].filter(part => part).join(", ");
  $("loops").hidden = !loops;
  say("loops", "Loops: " + loops);
  const last = history.steps[history.steps.length - 1];
  say("clock", clock(step.ms) + " of " + clock(last.ms));
}

function showPoses(step) {
  for (const which of ["believed", "true"]) {
    const cells = document.querySelectorAll(`#poses .${which} td`), [x, y, yaw] = step[which];
    const degrees = (yaw * 180 / Math.PI).toFixed(0).replace("-0", "0") + "°";
    [x.toFixed(2), y.toFixed(2), degrees].forEach((text, i) => { cells[i].textContent = text; });
  }
  const off = Math.hypot(step.believed[0] - step.true[0], step.believed[1] - step.true[1]);
  document.querySelector("#poses thead th").textContent = off.toFixed(2) + " m apart";
}

function showBudget(step, run) {
  const period = run ? run.period_ms : 200, ms = us => us < 1e4 ? (us / 1e3).toFixed(2) : (us / 1e3).toFixed(0);
  const instructions = step.instructions ? `, ${(step.instructions / 1e6).toFixed(2)} M instructions` : "";
  say("budget-words", `Step ${ms(step.us)} ms, longest ${ms(step.longest_us)}, of ${period} ms` + instructions);
  // A tenth of a millisecond to the period, by its logarithm.
  const share = us => Math.max(0, Math.min(1, Math.log(us / 100) / Math.log(period * 10)));
  $("budget-bar").style.width = 100 * share(Math.max(step.us, 101)) + "%";
  $("budget-most").style.left = `calc(${100 * share(Math.max(step.longest_us, 101))}% - 3px)`;
}

function showStatus(history) {
  const status = history.shown.status, end = history.end;
  const isEnd = end && history.at >= history.steps.length - 1;
  say("status", isEnd ? words(end.status) + ": " + words(end.reason) : words(status));
  const bad = isEnd ? !/^(explored|covered|at-home|replayed)$/.test(end.reason) : /^(fault|emergency|unreach)/.test(status);
  const good = isEnd ? !bad : /^(finished|arrived)/.test(status);
  const stands = /^(paused|no-scan|idle)/.test(status);
  $("status").className = "pill" + (bad ? " bad" : good ? " good" : stands ? " stands" : "");
}

// What the robot does at the shown step, and what it did before, the newest first.
function showDoings(history) {
  const step = history.steps[history.at], list = $("doings");
  const until = step ? step.ms / 1e3 + 1e-6 : 0;
  const told = history.doings.filter(doing => doing.time_s <= until);
  const shown = `${told.length} of ${history.doings.length}`;
  if (list.dataset.shown === shown) return;
  list.dataset.shown = shown;
  list.replaceChildren(...told.slice(-6).reverse().map(doing => {
    const item = document.createElement("li"), time = document.createElement("time");
    time.textContent = clock(doing.time_s * 1e3) + " ";
    const why = (doing.events || []).join("; ");
    item.append(time, why ? `${words(doing.doing)}: ${why}` : words(doing.doing));
    return item;
  }));
}

function showNotes(history) {
  const list = $("notes");
  if (list.dataset.shown === String(history.notes.length)) return;
  list.dataset.shown = history.notes.length;
  list.replaceChildren(...history.notes.slice(-5).reverse().map(note => {
    const item = document.createElement("li"), time = document.createElement("time");
    time.textContent = clock(note.time_ms) + " ";
    const who = note.viewer ? ` (viewer ${note.viewer})` : "";
    item.className = note.done ? "" : "refused";
    item.append(time, note.done ? `${note.request} → ${words(note.answer)}${who}`
      : `${note.request} refused: ${note.answer}${who}`);
    return item;
  }));
}

function showEnd(history) {
  const end = history.end;
  $("report").hidden = !end;
  say("headline", end ? end.short || end.headline : "");
  if (end) say("report-text", end.text);
}

// The share that is known over time, changes of the status, and viewers' requests.
function drawCurve(history) {
  const canvas = $("curve"), [context, width, height] = fitted(canvas);
  context.clearRect(0, 0, width, height);
  const steps = history.steps, count = steps.length;
  if (count < 2) return;
  const inset = 8, x = i => inset + (width - 2 * inset) * i / (count - 1);
  const y = known => height - 2 - (height - 6) * Math.max(0, Math.min(1, known));
  const every = Math.max(1, Math.floor(count / width));
  context.beginPath();
  context.moveTo(x(0), height);
  for (let i = 0; i < count; i += every) context.lineTo(x(i), y(steps[i].known));
  context.lineTo(x(count - 1), y(steps[count - 1].known));
  context.lineTo(x(count - 1), height);
  context.fillStyle = "#cfe0ec";
  context.fill();
  context.fillStyle = COLOUR.path;
  for (const [step] of history.marks.slice(1)) context.fillRect(x(Math.min(step, count - 1)) - 1, 0, 2, height);
  for (const note of history.notes) {
    diamond(context, [x(Math.max(0, history.stepAt(note.time_ms))), 7], 5, note.done ? COLOUR.scan : COLOUR.loop, "#fff");
  }
  context.fillStyle = COLOUR.ink;
  context.fillRect(x(Math.max(0, history.at)) - 1, 0, 2, height);
  context.font = font(13);
  context.textAlign = "left";
  context.fillText(again(history.run) ? "replayed" : "known area over time", inset + 4, 14 * UNIT);
}

// A session that is made again has no truth: odometry stands in its place.
function again(run) { return Boolean(run && run.again); }
function second(run) { return again(run) ? "odometry" : "true"; }

// Returns the context of a canvas in page pixels, and its size, for a sharp picture.
function fitted(canvas) {
  const ratio = window.devicePixelRatio || 1, box = canvas.getBoundingClientRect();
  const wide = Math.round(box.width * ratio), high = Math.round(box.height * ratio);
  if (canvas.width !== wide || canvas.height !== high) { canvas.width = wide; canvas.height = high; }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  return [context, box.width, box.height];
}

const square = (fill, stroke) => context => {
  context.fillStyle = fill;
  context.fillRect(4, 2, 18, 16);
  context.strokeStyle = stroke || "#7a8490";
  context.strokeRect(4.5, 2.5, 17, 15);
};
const stroke = (colour, width, dash) => context => {
  context.setLineDash(dash || []);
  context.lineWidth = width;
  context.strokeStyle = colour;
  context.beginPath();
  context.moveTo(1, 10);
  context.lineTo(25, 10);
  context.stroke();
};
const arrow = which => context => {
  context.beginPath();
  for (const [x, y] of [[5, 4], [16, 4], [23, 10], [16, 16], [5, 16]]) context.lineTo(x, y);
  context.closePath();
  context.fillStyle = context.strokeStyle = COLOUR[which];
  context.lineWidth = 3;
  if (which === "believed") context.fill(); else context.stroke();
};
const LEGEND = [
  ["free", square(COLOUR.free)], ["obstacle", square(COLOUR.obstacle)],
  ["unknown", square(COLOUR.unknown)], ["hole, cliff", square(COLOUR.negative), "uneven"],
  ["robot, believed", arrow("believed")], ["robot, true", arrow("true"), "truth"],
  ["robot, odometry", arrow("true"), "again"], ["way, believed", stroke(COLOUR.believed, 2)],
  ["way, true", stroke(COLOUR.true, 3, [7, 5]), "truth"],
  ["way, odometry", stroke(COLOUR.true, 3, [7, 5]), "again"],
  ["scan", context => { square(COLOUR.scan + "22", "#0000")(context); context.fillStyle = COLOUR.scan;
    for (const [x, y] of [[6, 4], [13, 3], [19, 6]]) context.fillRect(x, y, 4, 4); }],
  ["skeleton", stroke(COLOUR.skeleton, 2), "inside"],
  ["path and goal", context => { stroke(COLOUR.path, 3.5)(context); diamond(context, [18, 10], 7, COLOUR.path, "#fff"); }, "inside"],
  ["local goal", context => diamond(context, [13, 10], 6, "#fff", COLOUR.path), "inside"],
  ["left at the end", context => { context.fillStyle = COLOUR.left; context.fillRect(8, 5, 10, 10);
    context.strokeRect(8, 5, 10, 10); }],
  ["tractor, shield", context => { stroke(COLOUR.loop, 4)(context); }, "ouroboros"],
  ["bounds, no-go", stroke(COLOUR.fence, 2, [5, 4]), "fence"],
];

function drawLegend(run) {
  const has = { again: again(run), truth: !again(run), uneven: run.uneven, inside: run.inside, ouroboros: run.strategy === "ouroboros", fence: run.fence.length };
  $("legend-list").replaceChildren(...LEGEND.filter(([, , of]) => !of || has[of]).map(([name, draw]) => {
    const item = document.createElement("li"), canvas = document.createElement("canvas");
    canvas.width = 52;
    canvas.height = 40;
    const context = canvas.getContext("2d");
    context.scale(2, 2);
    draw(context);
    item.append(canvas, name);
    return item;
  }));
}
