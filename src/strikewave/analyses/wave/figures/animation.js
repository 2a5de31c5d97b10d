"use strict";
const field = JSON.parse(document.getElementById("field").textContent);
const canvas = document.getElementById("picture");
const pen = canvas.getContext("2d");
const [play, speed, timeSlider, placeSlider, reading] = ["play", "speed", "time", "place", "reading"].map((id) =>
  document.getElementById(id));
const places = field.position.length, frames = field.time.length;
const end = field.layers[field.layers.length - 1].end;
const SECONDS = 12, INK = "#1a1f24", SOFT = "#4d5760", FILLS = ["rgba(0,114,178,.3)", "rgba(213,94,0,.3)"];

function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Int16Array.from({ length: bytes.length / 2 }, (_, k) => view.getInt16(2 * k, true));
}
const panels = field.panels.map((panel) => ({ ...panel, counts: unpack(panel.data) }));
const at = (panel, frame, place) => (panel.counts[frame * places + place] / 32767) * panel.peak;

let frame = 0, place = 0, playing = false, before = null, shown = 0;

function niceStep(range, most) {
  const raw = range / most, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}
const written = (value) => String(Number(value.toPrecision(3)));

function clipped(text, width) {
  if (pen.measureText(text).width <= width) return text;
  let kept = text;
  while (kept && pen.measureText(kept + "…").width > width) kept = kept.slice(0, -1);
  return kept.length > 1 ? kept + "…" : "";
}

function box() {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  const left = 52, right = width - 10, each = (height - 86) / 2;
  return { width, height, left, right, each, x: (mm) => left + (mm / end) * (right - left) };
}

function drawLayers(b, top, named) {
  for (const layer of field.layers) {
    const from = b.x(layer.begin), to = b.x(layer.end);
    pen.fillStyle = `rgb(${layer.grey},${layer.grey},${layer.grey})`;
    pen.fillRect(from, top, to - from, b.each);
    if (layer.begin > 0) {
      const wide = layer.joint === "thick" ? 2.4 : 1, gap = layer.joint === "dashed" ? 4 : 0;
      pen.fillStyle = layer.joint ? "#333333" : "#8a8a8a";
      for (let y = 0; y < b.each; y += gap ? 10 : b.each) {
        pen.fillRect(from - 0.5 * wide, top + y, wide, Math.min(gap ? 6 : b.each, b.each - y));
      }
    }
    if (named) {
      pen.fillStyle = SOFT;
      pen.textAlign = "center";
      pen.fillText(clipped(layer.name, to - from - 6), (from + to) / 2, top + 14);
    }
  }
}

function drawAxis(b, top, panel, y) {
  pen.fillStyle = SOFT;
  pen.textAlign = "right";
  const step = niceStep(2 * panel.peak, 6);
  for (let k = Math.ceil(-panel.peak / step); k * step <= panel.peak; k += 1) {
    pen.fillText(written(k * step), b.left - 6, y(k * step) + 4);
    pen.fillRect(b.left - 4, y(k * step) - 0.5, 4, 1);
  }
  pen.fillStyle = "#8a8a8a";
  pen.fillRect(b.left, y(0) - 0.5, b.right - b.left, 1);
  pen.fillStyle = INK;
  pen.textAlign = "left";
  pen.fillText(clipped(panel.label, b.right - 6), 6, top - 7);
}

function drawCurve(b, panel, y) {
  let from = 0;
  while (from < places) {
    let to = from;
    while (to + 1 < places && field.layer[to + 1] === field.layer[from]) to += 1;
    for (const [side, fill] of FILLS.entries()) {
      pen.beginPath();
      pen.moveTo(b.x(field.position[from]), y(0));
      for (let k = from; k <= to; k += 1) {
        const value = at(panel, frame, k);
        pen.lineTo(b.x(field.position[k]), y(side === 0 ? Math.max(value, 0) : Math.min(value, 0)));
      }
      pen.lineTo(b.x(field.position[to]), y(0));
      pen.fillStyle = fill;
      pen.fill();
    }
    pen.beginPath();
    for (let k = from; k <= to; k += 1) pen.lineTo(b.x(field.position[k]), y(at(panel, frame, k)));
    pen.strokeStyle = INK;
    pen.lineWidth = 1.5;
    pen.stroke();
    from = to + 1;
  }
}

function drawPlace(b, top, panel, y) {
  const x = b.x(field.position[place]);
  pen.strokeStyle = SOFT;
  pen.setLineDash([3, 3]);
  pen.lineWidth = 1;
  pen.beginPath();
  pen.moveTo(x, top);
  pen.lineTo(x, top + b.each);
  pen.stroke();
  pen.setLineDash([]);
  pen.fillStyle = INK;
  pen.beginPath();
  pen.arc(x, y(at(panel, frame, place)), 4, 0, 7);
  pen.fill();
}

function drawFoot(b) {
  const bottom = b.height - 26;
  pen.fillStyle = SOFT;
  pen.textAlign = "center";
  const step = niceStep(end, Math.max(3, b.width / 110));
  for (let k = 0; k * step <= end * 1.0001; k += 1) {
    pen.fillText(written(k * step), Math.min(b.x(k * step), b.width - 12), bottom + 8);
    pen.fillRect(b.x(k * step) - 0.5, bottom - 8, 1, 4);
  }
  for (const tap of field.taps) pen.fillText("▲", b.x(tap.position), bottom - 6);
  pen.fillStyle = INK;
  pen.fillText("distance from the loaded face (mm)", (b.left + b.right) / 2, b.height - 3);
}

function draw() {
  const b = box();
  pen.clearRect(0, 0, b.width, b.height);
  pen.font = '13px system-ui, "DejaVu Sans", sans-serif';
  panels.forEach((panel, row) => {
    const top = 20 + row * (b.each + 26), y = (value) => top + b.each * (0.5 - 0.46 * (value / panel.peak));
    drawLayers(b, top, row === 0);
    drawAxis(b, top, panel, y);
    drawCurve(b, panel, y);
    drawPlace(b, top, panel, y);
  });
  drawFoot(b);
  const layer = field.layers[field.layer[place]].name;
  const tap = field.taps.find((one) => Math.abs(one.position - field.position[place]) < 1e-3 * end);
  const values = panels.map((panel) => `${panel.name} ${written(at(panel, frame, place))} ${panel.unit}`);
  reading.textContent = `t = ${field.time[frame].toFixed(field.decimals)} µs, at ${written(field.position[place])} mm in ` +
    `${layer}${tap ? `, tap ${tap.name}` : ""}: ${values.join(", ")}`;
  timeSlider.value = frame;
  placeSlider.value = place;
  timeSlider.setAttribute("aria-valuetext", `${written(field.time[frame])} microseconds`);
  placeSlider.setAttribute("aria-valuetext", `${written(field.position[place])} millimetres, in ${layer}`);
}

function go(to) {
  shown = frame = Math.min(Math.max(Math.round(to), 0), frames - 1);
  draw();
}
function move(to) {
  place = Math.min(Math.max(to, 0), places - 1);
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

const keys = {
  " ": () => start(!playing), Home: () => go(0), End: () => go(frames - 1),
  ArrowRight: () => go(frame + 1), ArrowLeft: () => go(frame - 1),
  ArrowUp: () => move(place - 1), ArrowDown: () => move(place + 1),
};
document.addEventListener("keydown", (event) => {
  if (event.target === speed || event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
  event.preventDefault();
  if (event.key !== " " && event.key !== "ArrowUp" && event.key !== "ArrowDown") start(false);
  keys[event.key]();
});
document.getElementById("controls").addEventListener("submit", (event) => event.preventDefault());
play.addEventListener("click", () => start(!playing));
timeSlider.addEventListener("input", () => { start(false); go(Number(timeSlider.value)); });
placeSlider.addEventListener("input", () => move(Number(placeSlider.value)));
canvas.addEventListener("pointerdown", (event) => {
  const b = box(), mm = ((event.offsetX - b.left) / (b.right - b.left)) * end;
  let near = 0;
  for (let k = 1; k < places; k += 1) if (Math.abs(field.position[k] - mm) < Math.abs(field.position[near] - mm)) near = k;
  move(near);
});
new ResizeObserver(draw).observe(canvas);
move(field.start);
start(!window.matchMedia("(prefers-reduced-motion: reduce)").matches);
