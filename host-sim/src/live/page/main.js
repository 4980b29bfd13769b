// The page: its connection, its time line, its buttons and keys.

const history_ = new History(), view = new View(), cells = new CellImage();
const show = { true: true, skeleton: true, aim: null };
let socket = null, follows = true, plays = null, aims = false, sure = 0, refusal = null, isDirty = true;
let pace = { factor: 0, held: false }, viewers = 0;

function connect() {
  socket = new WebSocket("ws://" + location.host + "/ws" + location.search);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => { isDirty = true; };
  socket.onmessage = ({ data }) => {
    if (typeof data === "string") hear(JSON.parse(data)); else take(new Uint8Array(data));
    isDirty = true;
  };
  socket.onclose = () => {
    socket = null;
    isDirty = true;
    setTimeout(connect, 1000);
  };
}

// Takes bytes: the next records, all records anew, or the newest scan.
function take(bytes) {
  const records = bytes.subarray(1);
  if (bytes[0] === 2) {
    const view = new DataView(records.buffer, records.byteOffset + 5, records.byteLength - 5);
    history_.newest = { ranges: readScan(view), step: history_.steps.length - 1 };
    return;
  }
  if (bytes[0] === 1) { history_.clear(); cells.box = null; follows = true; }
  const had = history_.run;
  history_.enter(records);
  if (history_.run && history_.run !== had) drawLegend(history_.run);
}

function hear(told) {
  if (told.pace) { pace = told.pace; viewers = told.viewers; }
  if (told.refused) { refusal = { words: told.refused, until: performance.now() + 6000 }; }
}

function ask(message) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function banner(words) {
  const at = $("banner");
  at.hidden = !words;
  if (words) at.textContent = words;
}

function showState() {
  const isOpen = socket && socket.readyState === WebSocket.OPEN, isOver = Boolean(history_.end);
  for (const button of document.querySelectorAll("#simulation button, #robot button")) {
    button.disabled = !isOpen || isOver;
  }
  for (const button of document.querySelectorAll("[data-factor]")) {
    button.classList.toggle("on", !pace.held && pace.factor === Number(button.dataset.factor));
  }
  $("hold").classList.toggle("on", pace.held);
  say("hold", pace.held ? "Go on" : "Hold");
  $("go-to").classList.toggle("on", aims);
  $("go-to").setAttribute("aria-pressed", aims);
  $("map").classList.toggle("aims", aims);
  $("stop").classList.toggle("sure", sure > performance.now());
  say("stop", sure > performance.now() ? "Stop: sure?" : "Stop");
  $("follow").classList.toggle("on", follows);
  say("play", plays ? "❚❚ Stop playing" : "▶ Play");
  say("link-state", !isOpen ? "not connected" : viewers > 1 ? viewers + " viewers" : "connected");
  const isPast = !follows && history_.at < history_.steps.length - 1;
  if (refusal && refusal.until > performance.now()) banner("Refused: " + refusal.words);
  else if (!isOpen) banner(history_.steps.length ? "The program has ended or cannot be reached. What came stays here." : "Connecting …");
  else if (aims) banner("Click where the robot is to go; Escape leaves it");
  else if (isPast) banner("Looking back: " + clock(history_.steps[Math.max(0, history_.at)].ms) + ". End or Latest follows the run");
  else if (pace.held) banner("The clock is held");
  else banner("");
}

function frame(now) {
  requestAnimationFrame(frame);
  if (plays) { play(now); isDirty = true; }
  if (!isDirty && !(refusal && refusal.until > now - 100) && !(sure && sure > now - 100)) return;
  isDirty = false;
  const last = history_.steps.length - 1;
  if (follows) history_.seek(last);
  const slider = $("slider");
  slider.max = Math.max(0, last);
  slider.value = Math.max(0, history_.at);
  UNIT = parseFloat(getComputedStyle(document.documentElement).fontSize) / 16;
  const [context, width, height] = fitted($("map"));
  view.size(width, height);
  if (view.fits) view.fit(history_);
  drawAll(context, view, history_, cells, show);
  drawCurve(history_);
  showNumbers(history_);
  showStatus(history_);
  showDoings(history_);
  showNotes(history_);
  showEnd(history_);
  showState();
}

function seek(step) {
  history_.seek(step);
  follows = history_.at >= history_.steps.length - 1;
  isDirty = true;
}

// Plays the time line from where it is, or from the start.
function togglePlay() {
  if (plays) { plays = null; isDirty = true; return; }
  if (history_.at >= history_.steps.length - 1) history_.seek(0);
  const step = history_.steps[Math.max(0, history_.at)];
  if (!step) return;
  plays = { at: performance.now(), ms: step.ms };
  follows = false;
}

function play(now) {
  const factor = Number($("play-speed").value);
  plays.ms += Math.max(0, now - plays.at) * factor;
  plays.at = now;
  history_.seek(history_.stepAt(plays.ms));
  if (history_.at >= history_.steps.length - 1) { plays = null; follows = true; }
}

function stop() {
  if (sure > performance.now()) { ask({ do: "stop" }); sure = 0; } else sure = performance.now() + 3000;
  isDirty = true;
}

function aim(on) { aims = on; isDirty = true; }

function leave() { plays = null; isDirty = true; }

const ACTIONS = {
  hold: () => ask({ do: "hold", on: !pace.held }), step: () => ask({ do: "step" }),
  pause: () => ask({ do: "pause" }), resume: () => ask({ do: "resume" }),
  home: () => ask({ do: "home" }), "go-to": () => aim(!aims), stop,
  play: togglePlay, follow: () => { leave(); seek(history_.steps.length); },
  fit: () => { view.fits = true; isDirty = true; },
  "zoom-in": () => zoomMiddle(1.3), "zoom-out": () => zoomMiddle(1 / 1.3),
};
for (const [id, act] of Object.entries(ACTIONS)) $(id).addEventListener("click", act);
for (const button of document.querySelectorAll("[data-factor]")) {
  button.addEventListener("click", () => setSpeed(Number(button.dataset.factor)));
}

function setSpeed(factor) {
  if (pace.held) ask({ do: "hold", on: false });
  ask({ do: "speed", factor });
}

function zoomMiddle(factor) { view.zoom(factor, view.width / 2, view.height / 2); isDirty = true; }

$("slider").addEventListener("input", event => { leave(); seek(Number(event.target.value)); });
$("curve").addEventListener("pointerdown", event => {
  const box = event.target.getBoundingClientRect();
  leave();
  seek(Math.round((event.clientX - box.left - 8) / (box.width - 16) * (history_.steps.length - 1)));
});

const KEYS = {
  " ": "hold", ".": "step", p: "pause", r: "resume", h: "home", g: "go-to", s: "stop", f: "fit",
  "+": "zoom-in", "=": "zoom-in", "-": "zoom-out", Enter: "play", End: "follow",
};
document.addEventListener("keydown", event => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.tagName === "SELECT") return;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const isOnButton = /^(BUTTON|SUMMARY)$/.test(event.target.tagName);
  if (isOnButton && (key === " " || key === "Enter")) return;
  const moves = { ArrowLeft: -5, ArrowRight: 5, PageUp: -50, PageDown: 50, Home: -Infinity }[key];
  if (moves) { leave(); seek(Math.max(0, history_.at + moves)); }
  else if (KEYS[key] && !$(KEYS[key]).disabled) $(KEYS[key]).click();
  else if (/^[014]$/.test(key)) { if (!$("hold").disabled) setSpeed(Number(key)); }
  else if (key === "t") show.true = !show.true;
  else if (key === "k") show.skeleton = !show.skeleton;
  else if (key === "l") $("legend").open = !$("legend").open;
  else if (key === "Escape") aim(false);
  else return;
  event.preventDefault();
  isDirty = true;
});

// Drag, pinch and wheel move the map; a click goes to a place while that is wanted.
const pointers = new Map();
let moved = 0;
$("map").addEventListener("pointerdown", event => {
  pointers.set(event.pointerId, [event.offsetX, event.offsetY]);
  $("map").setPointerCapture(event.pointerId);
  moved = 0;
});
$("map").addEventListener("pointermove", event => {
  const at = [event.offsetX, event.offsetY], before = pointers.get(event.pointerId);
  if (aims) { show.aim = view.place(...at); isDirty = true; }
  if (!before) return;
  const others = [...pointers].filter(([id]) => id !== event.pointerId);
  const [dx, dy] = [at[0] - before[0], at[1] - before[1]];
  moved += Math.abs(dx) + Math.abs(dy);
  pointers.set(event.pointerId, at);
  if (moved < 6) return;
  if (others.length === 1) {
    const other = others[0][1], far = p => Math.max(10, Math.hypot(p[0] - other[0], p[1] - other[1]));
    view.zoom(far(at) / far(before), (at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
  } else { view.x -= dx / view.scale; view.y += dy / view.scale; view.fits = false; }
  isDirty = true;
});
function lift(event) {
  if (event.type === "pointerup" && aims && moved < 6 && pointers.size === 1) {
    const [x, y] = view.place(event.offsetX, event.offsetY);
    ask({ do: "go-to", x: Math.round(x * 100) / 100, y: Math.round(y * 100) / 100 });
    aim(false);
  }
  if (!aims) show.aim = null;
  pointers.delete(event.pointerId);
  isDirty = true;
}
$("map").addEventListener("pointerup", lift);
$("map").addEventListener("pointercancel", lift);
$("map").addEventListener("wheel", event => {
  event.preventDefault();
  view.zoom(Math.exp(-event.deltaY / 500), event.offsetX, event.offsetY);
  isDirty = true;
}, { passive: false });
window.addEventListener("resize", () => { isDirty = true; });

connect();
requestAnimationFrame(frame);
