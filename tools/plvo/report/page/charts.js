// SPDX-License-Identifier: Apache-2.0
// Time series. All charts share one cursor; a tap moves it, and the frames below follow.
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const palette = [0, 1, 2, 3, 4, 5].map(i => css(`--curve-${i}`));

function element(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

// Returns the drawing context of the canvas in CSS pixels, sharp at any resolution.
function prepare(canvas, width, height) {
  const scale = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  const context = canvas.getContext("2d");
  context.setTransform(scale, 0, 0, scale, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

// Draws when the size of the canvas is set or changes. Only the style determines the size: drawing cannot change it.
function keepDrawn(canvas, draw) {
  new ResizeObserver(draw).observe(canvas);
}

function ticks(low, high, count) {
  const raw = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find(f => f * power >= raw) || 10);
  const result = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; ++k) result.push(k * step);
  return { values: result, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

const cursor = {
  time: null, listeners: [],
  move(time) { this.time = time; for (const listener of this.listeners) listener(time); },
};

// series: [{name, y, colour, band: 3-sigma half-widths or null, stacked: on top of the stacked ones before it}];
// marks: [[begin, end], …] in x, intervals without tracking.
function chart(title, unit, x, series, marks = [], kind = "") {
  const canvas = element("canvas", { role: "img", "aria-label": title });
  const readout = element("div", { class: "readout" });
  const legend = element("div", { class: "legend" });
  for (const s of series) {
    const swatch = element("i");
    swatch.style.background = s.colour;
    legend.append(element("span", {}, swatch, s.name + (s.band ? " (band: 3\u03c3)" : "")));
  }
  const section = element("section", { class: `chart ${kind}` }, element("h2", {}, title, element("small", {}, unit)), canvas,
    legend, readout);
  let floor = x.map(() => 0);
  for (const s of series) {
    if (!s.stacked) continue;
    s.floor = floor;
    floor = s.top = s.y.map((v, i) => floor[i] + (v ?? 0));
  }
  const height = 180, left = 46, right = 8, top = 6, bottom = 22;
  const finite = [];
  for (const s of series) {
    s.y.forEach((v, i) => {
      if (v !== null) finite.push(v);
      if (s.stacked) finite.push(s.top[i]);
      if (v !== null && s.band && s.band[i] !== null) finite.push(s.band[i], -s.band[i]);
    });
  }
  if (series.some(s => s.band)) finite.push(0);
  let low = Math.min(...(finite.length ? finite : [0])), high = Math.max(...(finite.length ? finite : [1]));
  if (low > 0 && low < 0.5 * high) low = 0;
  if (low === high) { low -= 0.5; high += 0.5; }
  const x0 = x[0] ?? 0, x1 = Math.max(x[x.length - 1] ?? 1, x0 + 1e-6);
  let width = 300;
  canvas.style.height = `${height}px`;
  const px = t => left + (t - x0) / (x1 - x0) * (width - left - right);
  const py = v => top + (high - v) / (high - low) * (height - top - bottom);

  function drawStacked(context, s) {
    context.fillStyle = s.colour;
    context.globalAlpha = 0.75;
    context.beginPath();
    x.forEach((t, i) => context[i ? "lineTo" : "moveTo"](px(t), py(s.top[i])));
    [...x.keys()].reverse().forEach(i => context.lineTo(px(x[i]), py(s.floor[i])));
    context.fill();
    context.globalAlpha = 1;
  }
  function drawBand(context, s) {
    context.fillStyle = s.colour;
    context.globalAlpha = 0.18;
    context.beginPath();
    const indices = [...x.keys()].filter(i => s.band[i] !== null && s.band[i] !== undefined);
    indices.forEach((i, k) => context[k ? "lineTo" : "moveTo"](px(x[i]), py(s.band[i])));
    indices.reverse().forEach(i => context.lineTo(px(x[i]), py(-s.band[i])));
    context.fill();
    context.globalAlpha = 1;
  }
  function drawAxes(context) {
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = css("--faint");
    context.strokeStyle = css("--grid");
    context.lineWidth = 1;
    context.textAlign = "right";
    context.textBaseline = "middle";
    const vertical = ticks(low, high, 4);
    for (const v of vertical.values) {
      context.beginPath(); context.moveTo(left, py(v)); context.lineTo(width - right, py(v)); context.stroke();
      context.fillText(v.toFixed(vertical.digits), left - 5, py(v));
    }
    context.textAlign = "center";
    context.textBaseline = "top";
    const horizontal = ticks(x0, x1, Math.max(2, Math.floor(width / 110)));
    for (const t of horizontal.values) context.fillText(`${t.toFixed(horizontal.digits)} s`, px(t), height - bottom + 5);
  }
  function draw() {
    width = canvas.clientWidth || 300;
    const context = prepare(canvas, width, height);
    drawAxes(context);
    context.fillStyle = css("--lost");
    context.globalAlpha = 0.25;
    for (const [a, b] of marks) context.fillRect(px(a) - 1, top, Math.max(px(b) - px(a), 2), height - top - bottom);
    context.globalAlpha = 1;
    for (const s of series) if (s.band) drawBand(context, s);
    for (const s of series) {
      if (s.stacked) { drawStacked(context, s); continue; }
      context.strokeStyle = s.colour;
      context.lineWidth = 1.6;
      context.beginPath();
      let pen = false;
      s.y.forEach((v, i) => {
        if (v === null) { pen = false; return; }
        context[pen ? "lineTo" : "moveTo"](px(x[i]), py(v));
        pen = true;
      });
      context.stroke();
    }
    if (cursor.time !== null && cursor.time >= x0 && cursor.time <= x1) {
      context.strokeStyle = css("--ink");
      context.lineWidth = 1;
      context.beginPath(); context.moveTo(px(cursor.time), top); context.lineTo(px(cursor.time), height - bottom); context.stroke();
      let best = 0;
      x.forEach((t, i) => { if (Math.abs(t - cursor.time) < Math.abs(x[best] - cursor.time)) best = i; });
      readout.textContent = `${x[best].toFixed(3)} s: ` + series.map(s =>
        `${s.name} ${s.y[best] === null ? "\u2013" : Number(s.y[best].toPrecision(4))}`).join(", ");
    }
  }
  const pick = event => {
    const box = canvas.getBoundingClientRect();
    const t = x0 + (event.clientX - box.left - left) / (width - left - right) * (x1 - x0);
    cursor.move(Math.min(Math.max(t, x0), x1));
  };
  canvas.addEventListener("pointerdown", pick);
  canvas.addEventListener("pointermove", event => { if (event.buttons || event.pointerType === "mouse") pick(event); });
  cursor.listeners.push(draw);
  keepDrawn(canvas, draw);
  return section;
}
