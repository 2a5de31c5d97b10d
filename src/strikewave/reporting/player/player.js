"use strict";
// The page is described in page.py: what each name of the document means stands there.
const element = (id) => document.getElementById(id);
const run = JSON.parse(element("run").textContent);
const [play, slider, clock, speed, slowed, loop, reading, viewChoice, placeSlider] =
  ["play", "time", "now", "speed", "slowed", "loop", "reading", "view", "place"].map(element);
const { smooth, views, places, playing_seconds: PLAYING_SECONDS } = run, STEPS = Number(slider.max);
const INK = "#1a1f24", SOFT = "#4d5760", PALE = "#bcc3c9", LAYER_EDGE = "#8a8a8a", JOINT = "#333333";
const FONT = '13px system-ui, "DejaVu Sans", sans-serif', LEFT = 58, RIGHT = 12, TITLE = 20, LEGEND = 15, GAP = 10, FOOT = 38;
const LEAST_PLOT = 34; // px: of a panel, however low the window
const LONGEST_WAIT = 0.1; // s: a page that was hidden goes on where it was

// ---- data ----

const READERS = { f8: [8, "getFloat64"], f4: [4, "getFloat32"], i2: [2, "getInt16"] };
function unpack(text, kind) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)), data = new DataView(bytes.buffer);
  const [size, read] = READERS[kind];
  return Float64Array.from({ length: bytes.length / size }, (_, k) => data[read](size * k, true));
}
const tracks = Object.fromEntries(Object.entries(run.tracks).map(([name, text]) =>
  [name, unpack(text, name === "time" ? "f8" : "f4")]));
const shapes = run.shapes.map((shape) => ({ ...shape, points: unpack(shape.points, "f4") }));
for (const canvas of run.canvases) {
  canvas.element = element(canvas.id);
  canvas.caption = canvas.element.parentElement.querySelector("figcaption");
  for (const curve of canvas.panels?.flatMap((panel) => panel.curves) ?? []) {
    if (curve.counts) curve.counts = unpack(curve.counts, "i2");
    curve.histories = curve.histories?.map(({ begin, time, values }) =>
      ({ time: unpack(time, "f4").map((since) => since + begin), values: unpack(values, "f4") }));
  }
}
const pictures = run.pictures.map((address, k) => {
  const picture = new Image();
  picture.addEventListener("load", () => { if (k === frame) draw(); });
  picture.src = address;
  return picture;
});

// the moment that is shown: a position from 0 to the last of the view's times, its time in s, its whole frame
let view = views[0], position = 0, now = 0, frame = 0, place = places?.start ?? 0, playing = false, before = null;
const last = () => view.time.length - 1;

function interval(times, at) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= at) low = middle; else high = middle;
  }
  return low;
}
function valueAt(times, values, at) {
  const size = times.length;
  if (size === 0) return 0;
  if (size === 1 || at <= times[0]) return values[0];
  if (at >= times[size - 1]) return values[size - 1];
  const k = interval(times, at), step = times[k + 1] - times[k];
  return values[k] + (step > 0 ? (values[k + 1] - values[k]) * ((at - times[k]) / step) : 0);
}
const tracked = (name) => (name ? valueAt(tracks.time, tracks[name], now) : 0);
function historyOf({ track, histories }) {
  if (track) return { time: tracks.time, values: tracks[track] };
  return histories[Math.min(views.indexOf(view), histories.length - 1)];
}
const fieldAt = (curve, k) => (curve.counts[frame * places.position.length + k] / 32767) * curve.peak;
function current(curve, panel) {
  if (curve.counts) return fieldAt(curve, place);
  const { time, values } = historyOf(curve);
  return valueAt(time, values, now) / panel.per;
}

// ---- numbers ----

function niceStep(range, most) {
  const raw = range / most, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
}
function* ticks(low, high, most) {
  const step = niceStep(high - low, most);
  for (let k = Math.ceil(low / step - 1e-4); k * step <= high + 1e-4 * step; k += 1) yield k * step;
}
const written = (value, digits = 4) => String(Number(value.toPrecision(digits)));
const fixed = (value, decimals) => (Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value).toFixed(decimals);
const instant = () => `${(now / run.clock.per).toFixed(run.clock.decimals)} ${run.clock.unit}`;

// ---- drawing ----

function sheet(canvas) {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  const pen = canvas.getContext("2d");
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = FONT;
  pen.lineJoin = "round";
  return { pen, width, height };
}
function setHeight(canvas, height) {
  if (canvas.style.height !== `${height}px`) canvas.style.height = `${height}px`;
}
function write(pen, text, x, y, { width = Infinity, align = "left", colour = SOFT } = {}) {
  let shown = text;
  while (shown && pen.measureText(shown === text ? text : shown + "…").width > width) shown = shown.slice(0, -1);
  pen.textAlign = align;
  pen.fillStyle = colour;
  if (shown.length > 1 || shown === text) pen.fillText(shown === text ? text : shown + "…", x, y);
}
function bar(pen, x, y, width, height, colour) {
  pen.fillStyle = colour;
  pen.fillRect(x, y, width, height);
}
function trace(pen, points, { fill, edge, width = 1, dashes = [], closed = false }) {
  pen.beginPath();
  for (const [x, y] of points) pen.lineTo(x, y);
  if (closed) pen.closePath();
  if (fill) {
    pen.fillStyle = fill;
    pen.fill();
  }
  if (!edge) return;
  pen.strokeStyle = edge;
  pen.lineWidth = width;
  pen.setLineDash(dashes);
  pen.stroke();
  pen.setLineDash([]);
}
function dot(pen, x, y, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, 4, 0, 7);
  pen.fill();
}

// ---- a scene: things in space, undistorted ----

function* placed({ points, turn, ends }) {
  if (turn) {
    const cosine = Math.cos(tracked(turn)), sine = Math.sin(tracked(turn));
    for (let k = 0; k < points.length; k += 2) {
      yield [points[k] * cosine - points[k + 1] * sine, points[k] * sine + points[k + 1] * cosine];
    }
    return;
  }
  const [begin, end] = ends.map(([at, track]) => at + tracked(track));
  for (let k = 0; k < points.length; k += 2) yield [begin + points[k] * (end - begin), points[k + 1]];
}
function drawColourScale(pen, { limits: [low, high], colours, extend, label }, left, right, top) {
  const gradient = pen.createLinearGradient(left, 0, right, 0);
  colours.forEach((colour, k) => gradient.addColorStop(k / (colours.length - 1), colour));
  bar(pen, left, top, right - left, 12, gradient);
  const tips = [["min", left, -9, colours[0]], ["max", right, 9, colours[colours.length - 1]]];
  for (const [side, x, tip, colour] of tips) {
    if (extend === side || extend === "both") trace(pen, [[x, top], [x + tip, top + 6], [x, top + 12]], { fill: colour });
  }
  for (const value of ticks(low, high, Math.max(2, (right - left) / 60))) {
    const x = left + ((value - low) / (high - low)) * (right - left);
    bar(pen, x - 0.5, top + 12, 1, 4, SOFT);
    write(pen, written(value), x, top + 28, { align: "center" });
  }
  write(pen, label, (left + right) / 2, top + 45, { width: right - left + 40, align: "center", colour: INK });
}
function drawScene(canvas, firstScale) {
  const [left, right, bottom, top] = canvas.limits, foot = canvas.colour_scale ? 68 : 0;
  const across = right - left, high = top - bottom;
  if (!canvas.element.closest(".beside")) {
    setHeight(canvas.element, Math.min(canvas.element.clientWidth * (high / across) + foot, 0.4 * window.innerHeight));
  }
  const { pen, width, height } = sheet(canvas.element), scale = Math.min(width / across, (height - foot) / high);
  const x = (m) => width / 2 + (m - (left + right) / 2) * scale;
  const y = (m) => (height - foot) / 2 - (m - (bottom + top) / 2) * scale, under = y(bottom);
  const picture = pictures[frame];
  if (picture?.complete && picture.naturalWidth) {
    pen.imageSmoothingQuality = "high";
    pen.drawImage(picture, x(left), y(top), across * scale, high * scale);
  }
  for (const shape of shapes) trace(pen, [...placed(shape)].map(([a, b]) => [x(a), y(b)]), shape);
  if (canvas.colour_scale) {
    const half = Math.min(0.5 * width - 24, 190), wanted = 250 * across, power = 10 ** Math.floor(Math.log10(wanted));
    const length = power * [5, 2, 1].find((factor) => factor * power <= wanted * 1.0001);
    bar(pen, x(left) + 8, under + 1, length * 1e-3 * scale, 2, INK);
    write(pen, `${written(length)} mm`, x(left) + 14 + length * 1e-3 * scale, under + 6, { colour: INK });
    drawColourScale(pen, canvas.colour_scale, width / 2 - half, width / 2 + half, under + 16);
  }
  if (canvas.caption && firstScale) {
    canvas.caption.textContent = `${canvas.title}: ${written(scale / firstScale, 2)} times as large as the first picture`;
  }
  return scale;
}

// ---- a chart: panels over one axis, time or place ----

function drawChart(canvas) {
  const { panels, axis, label } = canvas, overPlace = axis === "place", { unit, per } = overPlace ? places : run.clock;
  const [begin, end] = overPlace ? [0, places.bands[places.bands.length - 1].end] : [view.time[0], view.time[last()]];
  const legends = panels.map((panel) => LEGEND * panel.curves.filter((curve) => curve.name).length);
  const around = FOOT + legends.reduce((sum, legend) => sum + legend + TITLE + GAP, 0);
  // what the window leaves when all else, down to the controls, is in view
  const others = element("controls").getBoundingClientRect().bottom + window.scrollY - canvas.element.clientHeight + 6;
  const plot = Math.max(Math.min(canvas.height, (window.innerHeight - others - around) / panels.length), LEAST_PLOT);
  setHeight(canvas.element, Math.round(around + plot * panels.length));
  const { pen, width, height } = sheet(canvas.element), right = width - RIGHT;
  const x = (value) => LEFT + ((value - begin) / (end - begin || 1)) * (right - LEFT);
  canvas.valueAt = (pixel) => begin + ((pixel - LEFT) / (right - LEFT)) * (end - begin);
  const here = overPlace ? places.position[place] : now;
  let top = 0;
  panels.forEach((panel, row) => {
    write(pen, panel.label, 4, top + 13, { width: right - 4, colour: INK });
    const box = { pen, x, right, begin, end, top: top + TITLE + legends[row], bottom: top + TITLE + legends[row] + plot };
    panel.curves.filter((curve) => curve.name).forEach((curve, k) => {
      bar(pen, LEFT, top + TITLE + 4 + LEGEND * k, 16, 3, curve.colour);
      write(pen, curve.name, LEFT + 22, top + TITLE + 10 + LEGEND * k, { width: right - LEFT - 22 });
    });
    if (overPlace) drawBands(box, row === 0);
    drawPanel(box, panel, overPlace);
    trace(pen, [[x(here), box.top], [x(here), box.bottom]], { edge: INK, dashes: overPlace ? [3, 3] : [] });
    for (const curve of panel.curves) dot(pen, x(here), box.y(current(curve, panel)), curve.colour);
    top = box.bottom + GAP;
  });
  for (const value of ticks(begin / per, end / per, Math.max(4, width / 110))) {
    bar(pen, x(value * per) - 0.5, top - GAP + 2, 1, 5, SOFT);
    const text = written(value, 7), half = pen.measureText(text).width / 2;
    write(pen, text, Math.min(x(value * per), width - half), top - GAP + 21, { align: "center" });
  }
  if (overPlace) for (const mark of places.marks) write(pen, "▲", x(mark.position), top - GAP + 11, { align: "center", colour: INK });
  write(pen, `${label} (${unit})`, (LEFT + right) / 2, height - 5, { width: right, align: "center" });
}
function drawBands({ pen, x, top, bottom }, named) {
  for (const { begin, end, grey, joint, name } of places.bands) {
    bar(pen, x(begin), top, x(end) - x(begin), bottom - top, `rgb(${grey},${grey},${grey})`);
    if (begin > 0) {
      trace(pen, [[x(begin), top], [x(begin), bottom]],
        { edge: joint ? JOINT : LAYER_EDGE, width: joint === "thick" ? 2.4 : 1, dashes: joint === "dashed" ? [6, 4] : [] });
    }
    if (named) write(pen, name, (x(begin) + x(end)) / 2, top + 14, { width: x(end) - x(begin) - 6, align: "center" });
  }
}
function limitsOf(panel, begin, end) {
  if (panel.limits) return panel.limits;
  let [low, high] = panel.zero ? [0, 0] : [Infinity, -Infinity];
  for (const curve of panel.curves) {
    const { time, values } = historyOf(curve);
    const to = time.length && Math.min(interval(time, end) + 2, time.length);
    for (let k = time.length && interval(time, begin); k < to; k += 1) {
      low = Math.min(low, values[k] / panel.per);
      high = Math.max(high, values[k] / panel.per);
    }
  }
  if (!(low <= high)) [low, high] = [0, 0];
  if (high - low > panel.least) return [low, high];
  const least = panel.least || 1;
  return panel.zero ? [low, low + least] : [(low + high - least) / 2, (low + high + least) / 2];
}
function drawPanel(box, panel, overPlace) {
  const { pen, x, right, top, bottom, begin, end } = box, [low, high] = limitsOf(panel, begin, end);
  const y = box.y = (value) => bottom - ((value - low) / (high - low)) * (bottom - top);
  for (const value of ticks(low, high, Math.max(3, (bottom - top) / 26))) {
    write(pen, written(value, 5), LEFT - 6, y(value) + 4, { align: "right" });
    pen.globalAlpha = value === 0 ? 0.7 : 0.2;
    bar(pen, LEFT, y(value) - 0.5, right - LEFT, 1, SOFT);
    pen.globalAlpha = 1;
  }
  pen.save();
  pen.beginPath();
  pen.rect(LEFT, top - 2, right - LEFT, bottom - top + 4);
  pen.clip();
  for (const curve of panel.curves) (overPlace ? drawField : drawHistory)(pen, x, y, curve, panel, begin, end);
  pen.restore();
  if (!panel.curves.length) write(pen, "nothing to show", LEFT + 6, (top + bottom) / 2);
}
function drawHistory(pen, x, y, curve, panel, begin, end) {
  const { time, values } = historyOf(curve);
  if (!time.length) return;
  const line = [], past = [];
  for (let k = interval(time, begin); k < Math.min(interval(time, end) + 2, time.length); k += 1) {
    line.push([x(time[k]), y(values[k] / panel.per)]);
    if (time[k] <= now) past.push(line[line.length - 1]);
  }
  past.push([x(Math.min(now, time[time.length - 1])), y(current(curve, panel))]);
  trace(pen, line, { edge: PALE });
  trace(pen, past, { edge: curve.colour, width: 1.6 });
}
function drawField(pen, x, y, curve) {
  const { position: at, band } = places;
  for (let from = 0, to = 0; from < at.length; from = to + 1) {
    for (to = from; to + 1 < at.length && band[to + 1] === band[from];) to += 1;
    const line = [];
    for (let k = from; k <= to; k += 1) line.push([x(at[k]), y(fieldAt(curve, k))]);
    for (const [limit, fill] of [[Math.min, curve.above], [Math.max, curve.below]]) {
      const side = line.map(([px, py]) => [px, limit(py, y(0))]);
      trace(pen, [[line[0][0], y(0)], ...side, [line[line.length - 1][0], y(0)]], { fill });
    }
    trace(pen, line, { edge: curve.colour, width: 1.5 });
  }
}

// ---- what is shown, in words ----

function placeWords() {
  const at = places.position[place], end = places.bands[places.bands.length - 1].end;
  const mark = places.marks.find((each) => Math.abs(each.position - at) < 1e-3 * end);
  return `${written(at / places.per)} ${places.unit} in ${places.bands[places.band[place]].name}${mark ? `, tap ${mark.name}` : ""}`;
}
function eventWords() {
  const happened = run.events.filter((event) => event.time <= now), event = happened[happened.length - 1];
  return event ? `${event.label}, ${written((now - event.time) / run.clock.per)} ${run.clock.unit} after ${event.since}` : run.no_event;
}
function panelWords(panel) {
  const values = panel.curves.map((curve) => {
    const value = current(curve, panel), [low, high] = limitsOf(panel, view.time[0], view.time[last()]);
    const text = panel.decimals === null ? written(Math.abs(value) < 1e-4 * (high - low) ? 0 : value, 3) : fixed(value, panel.decimals);
    return `${curve.name ? `${curve.name} ` : ""}${text} ${panel.unit}`;
  });
  return values.length ? [`${panel.name}${panel.curves.some((curve) => curve.name) ? ":" : ""} ${values.join(", ")}`] : [];
}
function readoutWords({ name, unit, per, decimals, track, zero }) {
  return `${name} ${fixed((tracked(track) - zero) / per, decimals)} ${unit}`;
}
function writeReading() {
  const when = [`t = ${instant()}`, ...(run.no_event ? [eventWords()] : []), ...(places ? [`at ${placeWords()}`] : [])];
  const values = run.canvases.flatMap((canvas) => canvas.panels ?? []).flatMap(panelWords);
  reading.textContent = `${when.join(", ")}: ${[...values, ...run.readouts.map(readoutWords)].join("; ")}`;
}

function writeSlowing() {
  const k = Math.min(frame, last() - 1), step = view.time[k + 1] - view.time[k];
  const times = PLAYING_SECONDS / (span() * Number(speed.value) * step);
  slowed.textContent = step > 0 ? `slowed ${Number(times.toPrecision(2)).toLocaleString("en")} times` : "";
}

function draw() {
  let firstScale = 0;
  for (const canvas of run.canvases) {
    if (canvas.kind === "chart") drawChart(canvas);
    else {
      const scale = drawScene(canvas, firstScale);
      firstScale ||= scale;
    }
  }
  writeReading();
  writeSlowing();
  clock.textContent = instant();
  slider.value = smooth ? Math.round((position / last()) * STEPS) : frame;
  slider.setAttribute("aria-valuetext", instant());
  if (!places) return;
  placeSlider.value = place;
  placeSlider.setAttribute("aria-valuetext", placeWords());
}

// ---- playing ----

// positions that a loop passes: whole frames are each shown for their share, the last one too
const span = () => (smooth ? last() : view.time.length);
function go(to) {
  position = Math.min(Math.max(smooth ? to : Math.floor(to), 0), last());
  frame = Math.floor(position);
  const next = Math.min(frame + 1, last());
  now = view.time[frame] + (position - frame) * (view.time[next] - view.time[frame]);
  draw();
}
function positionOf(time) {
  const k = interval(view.time, time), step = view.time[Math.min(k + 1, last())] - view.time[k];
  const exact = k + (step > 0 ? (time - view.time[k]) / step : 0);
  return smooth ? exact : Math.round(exact);
}
function move(to) {
  place = Math.min(Math.max(to, 0), places.position.length - 1);
  draw();
}
function show(key) {
  view = views.find((each) => each.key === key) ?? views[0];
  if (viewChoice) viewChoice.value = view.key;
  go(0);
}
function neighbour(step) {
  const to = views[views.indexOf(view) + step];
  if (to) show(to.key);
}
let reached = 0;
function tick(clockNow) {
  if (!playing) return;
  if (before === null) reached = position;
  else {
    const seconds = Math.min((clockNow - before) / 1000, LONGEST_WAIT);
    reached += (seconds / PLAYING_SECONDS) * span() * Number(speed.value);
    if (reached >= span()) {
      if (!loop.checked) {
        start(false);
        go(last());
        return;
      }
      reached = 0;
    }
    if (smooth || Math.floor(reached) !== frame) go(reached);
  }
  before = clockNow;
  requestAnimationFrame(tick);
}
function start(on) {
  playing = on;
  before = null;
  play.textContent = on ? "Pause" : "Play";
  if (!on) return;
  if (position >= last()) go(0);
  requestAnimationFrame(tick);
}
function pauseAt(to) {
  start(false);
  go(to);
}

const keys = {
  " ": () => start(!playing), Home: () => pauseAt(0), End: () => pauseAt(last()), l: () => { loop.checked = !loop.checked; },
  ArrowRight: (fine) => pauseAt(position + step(fine)), ArrowLeft: (fine) => pauseAt(position - step(fine)),
  ...(places && { ArrowUp: () => move(place - 1), ArrowDown: () => move(place + 1) }),
  ...(viewChoice && { PageDown: () => neighbour(1), PageUp: () => neighbour(-1) }),
};
const step = (fine) => (smooth ? last() / (fine ? STEPS : 200) : 1);
document.addEventListener("keydown", (event) => {
  const key = event.key === "L" ? "l" : event.key, chosen = event.target;
  if (event.ctrlKey || event.metaKey || event.altKey || !Object.hasOwn(keys, key)) return;
  if (chosen === speed || (viewChoice && chosen === viewChoice) || (chosen === loop && key === " ")) return;
  event.preventDefault();
  keys[key](event.shiftKey);
});
element("controls").addEventListener("submit", (event) => event.preventDefault());
play.addEventListener("click", () => start(!playing));
speed.addEventListener("change", writeSlowing);
viewChoice?.addEventListener("change", () => show(viewChoice.value));
placeSlider?.addEventListener("input", () => move(Number(placeSlider.value)));
slider.addEventListener("input", () => pauseAt(smooth ? (Number(slider.value) / STEPS) * last() : Number(slider.value)));
for (const canvas of run.canvases) {
  if (canvas.kind === "chart") {
    canvas.element.addEventListener("pointerdown", (event) => {
      const value = canvas.valueAt(event.offsetX);
      if (canvas.axis === "time") pauseAt(positionOf(value));
      else move(nearestPlace(value));
    });
  }
  new ResizeObserver(draw).observe(canvas.element);
}
function nearestPlace(at) {
  return places.position.reduce((best, each, k) => (Math.abs(each - at) < Math.abs(places.position[best] - at) ? k : best), 0);
}

// page.html#view=0&time=42.1 opens that view at 42.1 of the clock's unit, and stays there
function follow() {
  const asked = new URLSearchParams(location.hash.slice(1)), time = Number(asked.get("time"));
  show(asked.get("view"));
  if (asked.has("time") && Number.isFinite(time)) pauseAt(positionOf(time * run.clock.per));
  return asked.has("time");
}
window.addEventListener("hashchange", follow);
const stays = follow();
start(!stays && !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
