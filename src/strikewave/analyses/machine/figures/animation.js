"use strict";
const run = JSON.parse(document.getElementById("run").textContent);
const [whole, close, traces, play, viewChoice, slowedChoice, slider, reading, magnified] =
  ["whole", "close", "traces", "play", "view", "slowed", "time", "reading", "magnified"].map((id) =>
    document.getElementById(id));
const GRAVITY = 9.80665, PLAYING_TIME = 12, STEPS = 2000, INK = "#1a1f24", SOFT = "#4d5760";
const ORDER = ["disc", "striker", "nose", "hub", "ground", "carriage", "stop", "body", "body 2", "face"];

function unpack(text, bytes) {
  const raw = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)), view = new DataView(raw.buffer);
  const read = bytes === 8 ? (k) => view.getFloat64(8 * k, true) : (k) => view.getFloat32(4 * k, true);
  return Float64Array.from({ length: raw.length / bytes }, (_, k) => read(k));
}
function history(packed, begin) {
  return { time: unpack(packed.time, 4).map((since) => since + begin), values: unpack(packed.values, 4) };
}
const motion = { time: unpack(run.motion.time, 8) };
for (const name of ["angle", "speed", "nose", "assembly", "carriage"]) motion[name] = unpack(run.motion[name], 4);
const last = motion.time[motion.time.length - 1];
const shapes = run.shapes.map(([group, look, points]) => ({ group, look, points }))
  .sort((a, b) => ORDER.indexOf(a.look) - ORDER.indexOf(b.look));
const views = { whole: { begin: 0, end: last, ...sides(run.train, 0) } };
run.near.forEach((one, k) => { views[k] = { begin: one.begin, end: one.end, ...sides(one, one.begin) }; });

function sides(packed, begin) {
  return { force: history(packed.force, begin), acceleration: history(packed.acceleration, begin) };
}
const panels = [
  { name: "contact force", unit: "kN", decimals: 3, scale: 1e3, colour: "#0072b2", of: (view) => view.force },
  { name: "rigid-body acceleration", unit: "g", decimals: 1, scale: GRAVITY, colour: "#d55e00",
    of: (view) => view.acceleration },
  { name: "turntable speed", unit: "r/min", decimals: 2, scale: Math.PI / 30, colour: "#6e6e6e",
    of: () => ({ time: motion.time, values: motion.speed }) },
];

let view = views.whole, time = 0, playing = false, before = null;

function place(times, at) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= at) low = middle; else high = middle;
  }
  return low;
}
function valueAt(track, at) {
  const { time: times, values } = track, size = times.length;
  if (size === 0) return 0;
  if (size === 1 || at <= times[0]) return values[0];
  if (at >= times[size - 1]) return values[size - 1];
  const k = place(times, at), step = times[k + 1] - times[k];
  return values[k] + (step > 0 ? (values[k + 1] - values[k]) * ((at - times[k]) / step) : 0);
}
const moved = (name, at) => valueAt({ time: motion.time, values: motion[name] }, at);
function poseAt(at) {
  return { disc: moved("angle", at) - run.blowAngle, nose: moved("nose", at), assembly: moved("assembly", at),
    carriage: moved("carriage", at), ground: 0 };
}

function niceStep(range, most) {
  const raw = range / most, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}
const fixed = (value, decimals) => (Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value).toFixed(decimals);
const written = (value, digits = 4) => String(Number(value.toPrecision(digits)));

function sheet(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  const pen = canvas.getContext("2d");
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = '13px system-ui, "DejaVu Sans", sans-serif';
  return { pen, width, height };
}

function drawMachine(canvas, limits, pose) {
  const { pen, width, height } = sheet(canvas), [left, right, bottom, top] = limits;
  const scale = Math.min(width / (right - left), height / (top - bottom));
  const x = (m) => width / 2 + (m - (left + right) / 2) * scale, y = (m) => height / 2 - (m - (bottom + top) / 2) * scale;
  pen.strokeStyle = SOFT;
  pen.lineWidth = 1;
  pen.setLineDash([8, 3, 2, 3]);
  pen.beginPath();
  pen.arc(x(0), y(0), run.radius * scale, 0, 2 * Math.PI);
  pen.stroke();
  pen.setLineDash([]);
  pen.lineJoin = "round";
  for (const [groups, ends, lines] of run.connections) {
    const [begin, end] = [0, 1].map((k) => ends[k] + pose[groups[k]]);
    pen.strokeStyle = "#4a4a4a";
    pen.lineWidth = 1.3;
    for (const line of lines) {
      pen.beginPath();
      for (let k = 0; k < line.length; k += 2) pen.lineTo(x(begin + line[k] * (end - begin)), y(line[k + 1]));
      pen.stroke();
    }
  }
  const cosine = Math.cos(pose.disc), sine = Math.sin(pose.disc);
  for (const { group, look, points } of shapes) {
    const [fill, edge, thick] = run.looks[look];
    pen.beginPath();
    for (let k = 0; k < points.length; k += 2) {
      const [a, b] = [points[k], points[k + 1]];
      if (group === "disc") pen.lineTo(x(a * cosine - b * sine), y(a * sine + b * cosine));
      else pen.lineTo(x(a + pose[group]), y(b));
    }
    pen.closePath();
    pen.fillStyle = fill;
    pen.fill();
    pen.strokeStyle = edge;
    pen.lineWidth = thick;
    pen.stroke();
  }
  return scale;
}

const box = (width) => ({ left: 58, right: width - 12 });
function drawTraces() {
  const { pen, width, height } = sheet(traces), { left, right } = box(width), span = view.end - view.begin;
  const each = (height - 42) / panels.length, x = (at) => left + ((at - view.begin) / span) * (right - left);
  panels.forEach((panel, row) => {
    const { time: times, values } = panel.of(view), top = row * each + 20, bottom = (row + 1) * each;
    const from = place(times, view.begin), to = Math.min(place(times, view.end) + 1, times.length - 1);
    let low = Infinity, high = -Infinity;
    for (let k = from; k <= to; k += 1) {
      low = Math.min(low, values[k] / panel.scale);
      high = Math.max(high, values[k] / panel.scale);
    }
    if (row < 2) low = Math.min(low, 0);
    const least = row < 2 ? 1 : 0.01 * Math.abs(high);
    if (!(high - low >= least)) [low, high] = [low - (row < 2 ? 0 : least / 2), low + least];
    const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
    pen.fillStyle = SOFT;
    pen.textAlign = "right";
    const step = niceStep(high - low, Math.max(3, each / 34));
    for (let k = Math.ceil(low / step); k * step <= high; k += 1) {
      pen.fillText(written(k * step, 5), left - 6, y(k * step) + 4);
      pen.globalAlpha = 0.25;
      pen.fillRect(left, y(k * step) - 0.5, right - left, 1);
      pen.globalAlpha = 1;
    }
    pen.textAlign = "left";
    pen.fillStyle = INK;
    pen.fillText(`${panel.name} (${panel.unit})`, left, top - 6);
    pen.beginPath();
    for (let k = from; k <= to; k += 1) pen.lineTo(Math.max(x(times[k]), left), y(values[k] / panel.scale));
    pen.strokeStyle = panel.colour;
    pen.lineWidth = 1.3;
    pen.stroke();
  });
  pen.fillStyle = SOFT;
  pen.textAlign = "center";
  const bottom = height - 42, step = niceStep(span * 1e3, Math.max(3, width / 130));
  for (let k = Math.ceil((view.begin * 1e3) / step); k * step <= view.end * 1e3; k += 1) {
    pen.fillRect(x((k * step) / 1e3) - 0.5, bottom, 1, 5);
    pen.fillText(written(k * step, 7), Math.min(Math.max(x((k * step) / 1e3), left), right - 8), bottom + 18);
  }
  pen.fillText("time after the valve signal (ms)", (left + right) / 2, height - 4);
  pen.fillStyle = INK;
  pen.fillRect(x(time) - 0.75, 4, 1.5, bottom - 2);
}

function words() {
  const done = run.blows.filter((blow) => blow[2] <= time), blow = done[done.length - 1];
  const since = blow && `${written((time - blow[2]) * 1e3)} ms after ${blow[1] === "missed" ? "its pass" : "first touch"}`;
  const [force, acceleration, speed] = panels.map((panel) =>
    `${panel.name} ${fixed(valueAt(panel.of(view), time) / panel.scale, panel.decimals)} ${panel.unit}`);
  const retreat = (moved("nose", time) - run.rest) * 1e3;
  return `t = ${(time * 1e3).toFixed(3)} ms, ${blow ? `blow ${blow[0]} (${blow[1]}), ${since}` : "no blow yet"}: ${force}, ` +
    `${acceleration}, ${speed}, face ${fixed(retreat, 2)} mm behind its place at rest, ` +
    `carriage ${fixed(moved("carriage", time) * 1e3, 2)} mm back`;
}

function draw() {
  const pose = poseAt(time), scale = drawMachine(whole, run.limits.whole, pose);
  const enlarged = drawMachine(close, run.limits.close, pose);
  magnified.textContent = `the strike, close up: ${written(enlarged / scale, 2)} times the picture of the whole machine`;
  drawTraces();
  reading.textContent = words();
  slider.value = Math.round(((time - view.begin) / (view.end - view.begin)) * STEPS);
  slider.setAttribute("aria-valuetext", `${(time * 1e3).toFixed(3)} milliseconds`);
}

function go(to) {
  time = Math.min(Math.max(to, view.begin), view.end);
  draw();
}
function show(key) {
  viewChoice.value = key;
  view = views[key];
  const wanted = PLAYING_TIME / (view.end - view.begin);
  const choices = [...slowedChoice.options].map((option) => Number(option.value));
  slowedChoice.value = String(choices.reduce((best, one) =>
    Math.abs(Math.log(one / wanted)) < Math.abs(Math.log(best / wanted)) ? one : best));
  go(view.begin);
}
function neighbour(step) {
  const keys = [...viewChoice.options].map((option) => option.value);
  const to = keys.indexOf(viewChoice.value) + step;
  if (to >= 0 && to < keys.length) show(keys[to]);
}
function tick(now) {
  if (!playing) return;
  if (before !== null) {
    const to = time + (now - before) / 1000 / Number(slowedChoice.value);
    go(to > view.end ? view.begin : to);
  }
  before = now;
  requestAnimationFrame(tick);
}
function start(on) {
  playing = on;
  before = null;
  play.textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (time >= view.end) go(view.begin);
  requestAnimationFrame(tick);
}

const keys = {
  " ": () => start(!playing), Home: () => go(view.begin), End: () => go(view.end),
  ArrowRight: (step) => go(time + step), ArrowLeft: (step) => go(time - step),
  PageDown: () => neighbour(1), PageUp: () => neighbour(-1),
};
document.addEventListener("keydown", (event) => {
  if ([viewChoice, slowedChoice].includes(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (!(event.key in keys)) return;
  event.preventDefault();
  if (!event.key.startsWith("Page") && event.key !== " ") start(false);
  keys[event.key]((view.end - view.begin) / (event.shiftKey ? STEPS : 200));
});
document.getElementById("controls").addEventListener("submit", (event) => event.preventDefault());
play.addEventListener("click", () => start(!playing));
viewChoice.addEventListener("change", () => show(viewChoice.value));
slider.addEventListener("input", () => {
  start(false);
  go(view.begin + (Number(slider.value) / STEPS) * (view.end - view.begin));
});
traces.addEventListener("pointerdown", (event) => {
  const { left, right } = box(traces.clientWidth);
  start(false);
  go(view.begin + ((event.offsetX - left) / (right - left)) * (view.end - view.begin));
});
new ResizeObserver(draw).observe(traces);

// machine.html#view=0&time=42.1 opens the first blow at 42.1 ms
function follow() {
  const asked = new URLSearchParams(location.hash.slice(1)), at = Number(asked.get("time"));
  show(Object.hasOwn(views, asked.get("view")) ? asked.get("view") : "whole");
  if (asked.has("time") && Number.isFinite(at)) {
    start(false);
    go(at / 1e3);
  }
  return asked.has("time");
}
window.addEventListener("hashchange", follow);
const stays = follow();
start(!stays && !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
