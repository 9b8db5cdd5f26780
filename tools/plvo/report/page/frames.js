// SPDX-License-Identifier: Apache-2.0
// The recorded frames with their features drawn on top, and their depth, selected by a slider. Rows, lengths in tenths of a
// pixel: keypoints u, v, level; tracks u, v, reference u, reference v, inlier; segments au, av, bu, bv, kind and the same
// four of the reference. Kinds: 0 plain, 1 segment with 3D, 2 outlier, 3 inlier.
const pens = {  // widths as in drawing.cpp
  plain: [css("--seen"), 1.2], with3d: [css("--line-3d"), 1.6], outlier: [css("--rejected"), 2], inlier: [css("--line"), 3],
  followed: [css("--point"), 1.2],
};
const segmentPens = [pens.plain, pens.with3d, pens.outlier, pens.inlier];
const legendTexts = [["followed", "point, with a stroke to where it was in the reference"], ["inlier", "matched line"],
  ["with3d", "segment with 3D, unmatched"], ["outlier", "rejected"], ["plain", "keypoint, or segment without 3D"]];

function stroke(context, x0, y0, x1, y1, [colour, width]) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.beginPath(); context.moveTo(x0, y0); context.lineTo(x1, y1); context.stroke();
}

function dot(context, x, y, radius, colour) {
  context.fillStyle = colour;
  context.beginPath(); context.arc(x, y, radius, 0, 2 * Math.PI); context.fill();
}

function drawSegments(context, rows, matched, withReference) {
  for (let i = 0; i < rows.length; i += 9) {
    const kind = rows[i + 4];
    if ((kind >= 2) !== matched) continue;
    const ends = k => rows.slice(i + k, i + k + 4).map(v => v / 10);
    stroke(context, ...ends(0), segmentPens[kind]);
    if (!withReference || kind < 2) continue;
    context.setLineDash([4, 3]);
    context.globalAlpha = 0.6;
    stroke(context, ...ends(5), [segmentPens[kind][0], 1]);
    context.globalAlpha = 1;
    context.setLineDash([]);
  }
}

function drawFeatures(context, frame, show) {
  context.lineCap = "round";
  if (show.keypoints)
    for (let i = 0; i < frame.k.length; i += 3) dot(context, frame.k[i] / 10, frame.k[i + 1] / 10, 1.5, pens.plain[0]);
  if (show.segments) for (const matched of [false, true]) drawSegments(context, frame.s, matched, show.matches);
  if (!show.matches) return;
  for (let i = 0; i < frame.m.length; i += 5) {
    const [u, v, ru, rv] = frame.m.slice(i, i + 4).map(x => x / 10);
    const colour = (frame.m[i + 4] ? pens.followed : pens.outlier)[0];
    stroke(context, u, v, ru, rv, [colour, 1.2]);
    dot(context, u, v, 1.8, colour);
  }
}

function framesLegend() {
  const legend = element("div", { class: "legend" });
  for (const [pen, text] of legendTexts) {
    const swatch = element("i");
    swatch.style.background = pens[pen][0];
    legend.append(element("span", {}, swatch, text));
  }
  return legend;
}

function framesSection(data) {
  const frames = data.frames;
  const canvas = element("canvas", { role: "img", "aria-label": "Image with keypoints, segments and matches", id: "frame" });
  const depth = element("img", { alt: "Depth: near is light, far is dark, none is black", id: "depth" });
  const slider = element("input", { type: "range", min: 0, max: frames.length - 1, value: 0, step: 1, id: "scrubber",
    "aria-label": "Frame" });
  const text = element("div", { class: "readout", id: "frame-text" });
  const play = element("button", { type: "button", id: "play" }, "Play");
  const counts = element("tbody");
  const show = { keypoints: true, segments: true, matches: true };
  const boxes = Object.keys(show).map(name => {
    const box = element("input", { type: "checkbox", checked: "" });
    box.addEventListener("change", () => { show[name] = box.checked; draw(); });
    return element("label", {}, box, ` ${name}`);
  });
  const image = new Image();
  let shown = -1;
  function draw() {
    const frame = frames[slider.value];
    canvas.width = frame.w;
    canvas.height = frame.h;
    const context = canvas.getContext("2d");
    context.fillStyle = "#000";
    context.fillRect(0, 0, frame.w, frame.h);
    context.globalAlpha = 0.7;  // dims the image below the features
    if (image.complete && image.naturalWidth) context.drawImage(image, 0, 0, frame.w, frame.h);
    context.globalAlpha = 1;
    drawFeatures(context, frame, show);
  }
  image.addEventListener("load", draw);
  function select(index, moveCursor = true) {
    slider.value = index;
    if (index === shown) return;
    shown = index;
    const frame = frames[index];
    image.src = `data:image/jpeg;base64,${frame.image}`;
    depth.src = `data:image/jpeg;base64,${frame.depth}`;
    text.textContent = `frame ${frame.i}, ${frame.t.toFixed(3)} s: ${frame.state}${frame.reason ? ` (${frame.reason})` : ""}`;
    counts.replaceChildren(...["points", "lines"].map(name =>
      element("tr", {}, ...[name, ...frame[name]].map(v => element("td", {}, String(v))))));
    draw();
    if (moveCursor) cursor.move(frame.t);
  }
  slider.addEventListener("input", () => select(Number(slider.value)));
  cursor.listeners.push(time => {
    if (time === null) return;
    let best = 0;
    frames.forEach((f, i) => { if (Math.abs(f.t - time) < Math.abs(frames[best].t - time)) best = i; });
    select(best, false);
  });
  let timer = null;
  play.addEventListener("click", () => {
    if (timer) { clearInterval(timer); timer = null; play.textContent = "Play"; return; }
    play.textContent = "Stop";
    timer = setInterval(() => select((Number(slider.value) + 1) % frames.length), 200);
  });
  select(Math.max(0, frames.findIndex(f => f.state === "tracking")), false);
  const [near, far] = data.depth_range;
  const scale = element("div", { class: "scale" }, `${near} m`, element("i"), `${far} m`, element("span", {}, "black: no depth"));
  return element("section", { class: "wide", id: "frames" }, element("h2", {}, "Frames"),
    element("div", { class: "controls" }, play, slider, ...boxes), text,
    element("div", { class: "frames" }, element("div", {}, canvas, framesLegend()), element("div", {}, depth, scale, element("table", {},
      element("thead", {}, element("tr", {}, ...["", "detected", "matched", "inliers"].map(h => element("th", {}, h)))), counts))));
}
