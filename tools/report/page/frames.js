// SPDX-License-Identifier: Apache-2.0
// The scrubber: recorded frames with what was found in them drawn on top.
// Rows, lengths in tenths of a pixel: keypoints u, v, level; tracks u, v, reference u, reference v, inlier; segments
// au, av, bu, bv, kind and the same four of the reference. Kinds: 0 plain, 1 segment with 3D, 2 outlier, 3 inlier.
const kindColours = ["#9aa3ad", "#ffd23f", "#ff5a36", "#3ddc6d"];
const kindNames = ["keypoint, or segment without 3D", "segment with 3D, unmatched", "matched, outlier", "inlier"];

function drawFeatures(context, frame, show) {
  if (show.segments) {
    for (let i = 0; i < frame.s.length; i += 9) {
      const [au, av, bu, bv, kind] = frame.s.slice(i, i + 5).map((v, k) => k < 4 ? v / 10 : v);
      context.strokeStyle = kindColours[kind];
      context.lineWidth = 2;
      context.beginPath(); context.moveTo(au, av); context.lineTo(bu, bv); context.stroke();
      if (!show.matches || kind < 2) continue;
      const r = frame.s.slice(i + 5, i + 9).map(v => v / 10);
      context.globalAlpha = 0.6;
      context.lineWidth = 1;
      context.setLineDash([4, 3]);
      context.beginPath(); context.moveTo(r[0], r[1]); context.lineTo(r[2], r[3]); context.stroke();
      context.setLineDash([]);
      context.globalAlpha = 1;
    }
  }
  context.lineWidth = 1.3;
  if (show.keypoints) {
    context.strokeStyle = kindColours[0];
    for (let i = 0; i < frame.k.length; i += 3) {
      context.beginPath();
      context.arc(frame.k[i] / 10, frame.k[i + 1] / 10, 2.5 * 2 ** frame.k[i + 2], 0, 2 * Math.PI);
      context.stroke();
    }
  }
  if (!show.matches) return;
  for (let i = 0; i < frame.m.length; i += 5) {
    const [u, v, ru, rv] = frame.m.slice(i, i + 4).map(x => x / 10);
    context.strokeStyle = context.fillStyle = kindColours[frame.m[i + 4] ? 3 : 2];
    context.beginPath(); context.arc(u, v, 2, 0, 2 * Math.PI); context.fill();
    context.beginPath(); context.moveTo(u, v); context.lineTo(ru, rv); context.stroke();
  }
}

function framesSection(data) {
  const frames = data.frames;
  const canvas = element("canvas", { role: "img", "aria-label": "Image with keypoints, segments and matches", id: "frame" });
  const depth = element("img", { alt: "Depth: near is red, far is blue, none is black", id: "depth" });
  const slider = element("input", { type: "range", min: 0, max: frames.length - 1, value: 0, step: 1, id: "scrubber",
    "aria-label": "Frame" });
  const text = element("div", { class: "readout", id: "frame-text" });
  const play = element("button", { type: "button", id: "play" }, "Play");
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
    if (image.complete && image.naturalWidth) context.drawImage(image, 0, 0, frame.w, frame.h);
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
    text.textContent = `frame ${frame.i}, ${frame.t.toFixed(3)} s: ${frame.state}${frame.reason ? ` (${frame.reason})` : ""}; ` +
      `points ${frame.points.join("/")}, lines ${frame.lines.join("/")} (detected/matched/inliers)`;
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
  select(0, false);
  const legend = element("div", { class: "legend" });
  kindNames.forEach((name, kind) => {
    const swatch = element("i");
    swatch.style.background = kindColours[kind];
    legend.append(element("span", {}, swatch, name));
  });
  legend.append(element("span", {}, "a stroke leads from a feature to where it was in the reference"));
  return element("section", { class: "wide", id: "frames" }, element("h2", {}, "Frames"),
    element("div", { class: "controls" }, play, slider, ...boxes), text,
    element("div", { class: "frames" }, canvas, depth), legend);
}
