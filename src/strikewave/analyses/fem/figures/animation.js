"use strict";
const run = JSON.parse(document.getElementById("run").textContent);
const [body, traces, play, speed, slider, reading] = ["body", "traces", "play", "speed", "time", "reading"].map((id) =>
  document.getElementById(id));
const frames = run.time.length, end = run.time[frames - 1] || 1;
const SECONDS = 9, INK = "#1a1f24", SOFT = "#4d5760", PALE = "#cfd4d8";

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)), view = new DataView(bytes.buffer);
  return Float64Array.from({ length: bytes.length / 4 }, (_, k) => view.getFloat32(4 * k, true));
}
const panels = run.traces.map((trace) => ({
  ...trace,
  curves: trace.curves.map((curve) => ({ ...curve, time: unpack(curve.time), values: unpack(curve.values) })),
}));
for (const panel of panels) {
  const all = panel.curves.map((curve) => curve.values);
  panel.low = Math.min(0, ...all.map((values) => values.reduce((a, b) => Math.min(a, b), 0)));
  panel.high = Math.max(0, ...all.map((values) => values.reduce((a, b) => Math.max(a, b), 0)));
  if (!(panel.high > panel.low)) panel.high = panel.low + 1;
}
let frame = 0, playing = false, before = null, shown = 0;
const pictures = run.pictures.map((address, k) => {
  const picture = new Image();
  picture.addEventListener("load", () => { if (k === frame) drawBody(); });
  picture.src = address;
  return picture;
});

function niceStep(range, most) {
  const raw = range / most, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}
const written = (value, digits = 4) => String(Number(value.toPrecision(digits)));
const unitOf = (time) => (end < 5000 ? `${written(time)} µs` : `${written(time / 1000)} ms`);

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
function clipped(pen, text, width) {
  if (pen.measureText(text).width <= width) return text;
  let kept = text;
  while (kept && pen.measureText(kept + "…").width > width) kept = kept.slice(0, -1);
  return kept.length > 1 ? kept + "…" : "";
}

function drawScale(pen, left, right, top) {
  const { limits: [low, high], colours, extend, label } = run.scale, each = (right - left) / colours.length;
  colours.forEach((colour, k) => {
    pen.fillStyle = colour;
    pen.fillRect(left + k * each, top, each + 0.6, 12);
  });
  const tips = [["min", left, -9, colours[0]], ["max", right, 9, colours[colours.length - 1]]];
  for (const [side, x, way, colour] of tips) {
    if (extend !== side && extend !== "both") continue;
    pen.fillStyle = colour;
    pen.beginPath();
    pen.moveTo(x, top);
    pen.lineTo(x + way, top + 6);
    pen.lineTo(x, top + 12);
    pen.fill();
  }
  pen.fillStyle = SOFT;
  pen.textAlign = "center";
  const step = niceStep(high - low, Math.max(2, (right - left) / 60));
  for (let k = Math.ceil(low / step); k * step <= high * 1.0001; k += 1) {
    const x = left + ((k * step - low) / (high - low)) * (right - left);
    pen.fillRect(x - 0.5, top + 12, 1, 4);
    pen.fillText(written(k * step), x, top + 28);
  }
  pen.fillStyle = INK;
  pen.fillText(clipped(pen, label, right - left + 40), (left + right) / 2, top + 45);
}

function drawBody() {
  if (body.parentElement.className === "") {
    body.style.height = `${Math.min(body.clientWidth * (run.size[1] / run.size[0]) + 88, 0.7 * window.innerHeight)}px`;
    body.style.minHeight = "0";
  }
  const { pen, width, height } = sheet(body), picture = pictures[frame], [w, h] = run.size;
  const scale = Math.min(width / w, (height - 88) / h), across = w * scale;
  if (picture.complete && picture.naturalWidth) {
    pen.imageSmoothingQuality = "high";
    pen.drawImage(picture, (width - across) / 2, 20, across, h * scale);
  }
  pen.fillStyle = INK;
  pen.textAlign = "left";
  pen.fillText(`t = ${unitOf(run.time[frame])}`, 4, 14);
  const half = Math.min(0.5 * width - 24, 190);
  drawScale(pen, width / 2 - half, width / 2 + half, Math.min(36 + h * scale, height - 50));
  const wanted = 0.25 * run.width, power = 10 ** Math.floor(Math.log10(wanted));
  const length = power * [5, 2, 1].find((factor) => factor * power <= wanted * 1.0001);
  const left = (width - across) / 2 + 8, bar = (length / run.width) * across;
  pen.fillStyle = INK;
  pen.fillRect(left, 21 + h * scale, bar, 2);
  pen.textAlign = "left";
  pen.fillText(`${written(length)} mm`, left + bar + 6, 26 + h * scale);
}

const sides = (width) => ({ left: 52, right: width - 12 });
function drawTraces() {
  const needed = 42 + panels.reduce((sum, panel) => sum + 118 + 15 * panel.curves.length, 0);
  traces.style.height = `${needed}px`;
  traces.style.maxHeight = "none";
  const { pen, width, height } = sheet(traces), { left, right } = sides(width), now = run.time[frame];
  const each = (height - 42) / panels.length, x = (time) => left + (time / end) * (right - left);
  panels.forEach((panel, row) => {
    const top = row * each + 20 + 15 * panel.curves.length, bottom = (row + 1) * each - 4;
    const y = (value) => bottom - ((value - panel.low) / (panel.high - panel.low)) * (bottom - top);
    pen.fillStyle = SOFT;
    pen.textAlign = "right";
    const step = niceStep(panel.high - panel.low, Math.max(3, (bottom - top) / 26));
    for (let k = Math.ceil(panel.low / step); k * step <= panel.high; k += 1) {
      pen.fillText(written(k * step), left - 6, y(k * step) + 4);
      pen.globalAlpha = k === 0 ? 0.7 : 0.2;
      pen.fillRect(left, y(k * step) - 0.5, right - left, 1);
      pen.globalAlpha = 1;
    }
    pen.textAlign = "left";
    pen.fillStyle = INK;
    pen.fillText(clipped(pen, `${panel.label} (${panel.unit})`, right - 4), 4, row * each + 13);
    panel.curves.forEach((curve, k) => {
      pen.fillStyle = curve.colour;
      pen.fillRect(left, row * each + 24 + 15 * k, 16, 3);
      pen.fillStyle = SOFT;
      pen.fillText(clipped(pen, curve.name, right - left - 22), left + 22, row * each + 30 + 15 * k);
      for (const [until, colour, thick] of [[Infinity, PALE, 1], [now, curve.colour, 1.8]]) {
        pen.beginPath();
        for (let n = 0; n < curve.time.length && curve.time[n] <= until; n += 1) pen.lineTo(x(curve.time[n]), y(curve.values[n]));
        pen.strokeStyle = colour;
        pen.lineWidth = thick;
        pen.stroke();
      }
    });
    if (panel.curves.length === 0) {
      pen.fillStyle = SOFT;
      pen.fillText("nothing to show", left + 6, (top + bottom) / 2);
    }
    pen.fillStyle = INK;
    pen.fillRect(x(now) - 0.5, top, 1, bottom - top);
  });
  pen.fillStyle = SOFT;
  pen.textAlign = "center";
  const bottom = height - 42, shift = end < 5000 ? 1 : 1000, step = niceStep(end / shift, Math.max(3, width / 90));
  for (let k = 0; k * step * shift <= end * 1.0001; k += 1) {
    pen.fillRect(x(k * step * shift) - 0.5, bottom - 2, 1, 5);
    pen.fillText(written(k * step), Math.min(x(k * step * shift), right - 6), bottom + 17);
  }
  pen.fillText(`time (${shift === 1 ? "µs" : "ms"})`, (left + right) / 2, height - 5);
}

function valueAt(curve, now) {
  const { time, values } = curve;
  let k = 0;
  while (k + 1 < time.length && time[k + 1] <= now) k += 1;
  const share = k + 1 < time.length ? (now - time[k]) / (time[k + 1] - time[k]) : 0;
  return values[k] + (share > 0 ? share * (values[k + 1] - values[k]) : 0);
}
function draw() {
  drawBody();
  drawTraces();
  const now = run.time[frame], words = panels.filter((panel) => panel.curves.length).map((panel) => {
    const least = 1e-4 * (panel.high - panel.low), values = panel.curves.map((curve) => {
      const value = valueAt(curve, now);
      return `${curve.name} ${written(Math.abs(value) < least ? 0 : value, 3)} ${panel.unit}`;
    });
    return `${panel.label}: ${values.join(", ")}`;
  });
  reading.textContent = [`t = ${unitOf(now)}`, ...words].join("; ");
  slider.value = frame;
  slider.setAttribute("aria-valuetext", unitOf(now));
}

function go(to) {
  shown = frame = Math.min(Math.max(Math.round(to), 0), frames - 1);
  draw();
}
function tick(now) {
  if (!playing) return;
  if (before !== null) {
    shown += ((now - before) / 1000 / SECONDS) * frames * Number(speed.value);
    if (shown >= frames) shown = 0;
    if (Math.floor(shown) !== frame) {
      frame = Math.floor(shown);
      draw();
    }
  }
  before = now;
  requestAnimationFrame(tick);
}
function start(on) {
  playing = on;
  before = null;
  play.textContent = on ? "Pause" : "Play";
  if (on) {
    if (frame === frames - 1) go(0);
    requestAnimationFrame(tick);
  }
}
function nearest(time) {
  let best = 0;
  run.time.forEach((one, k) => { if (Math.abs(one - time) < Math.abs(run.time[best] - time)) best = k; });
  return best;
}

const keys = {
  " ": () => start(!playing), Home: () => go(0), End: () => go(frames - 1),
  ArrowRight: () => go(frame + 1), ArrowLeft: () => go(frame - 1),
};
document.addEventListener("keydown", (event) => {
  if (event.target === speed || event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
  event.preventDefault();
  if (event.key !== " ") start(false);
  keys[event.key]();
});
document.getElementById("controls").addEventListener("submit", (event) => event.preventDefault());
play.addEventListener("click", () => start(!playing));
slider.addEventListener("input", () => { start(false); go(Number(slider.value)); });
traces.addEventListener("pointerdown", (event) => {
  const { left, right } = sides(traces.clientWidth);
  start(false);
  go(nearest(((event.offsetX - left) / (right - left)) * end));
});
new ResizeObserver(drawBody).observe(body);
new ResizeObserver(drawTraces).observe(traces);

// animation.html#time=42.1 opens the picture nearest to 42.1 us, and stays there
const asked = Number(new URLSearchParams(location.hash.slice(1)).get("time") ?? NaN);
go(Number.isFinite(asked) ? nearest(asked) : 0);
start(!Number.isFinite(asked) && !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
