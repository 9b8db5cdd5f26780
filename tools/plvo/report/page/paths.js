// SPDX-License-Identifier: Apache-2.0
// The trajectory from above, from the side, and in space. World: the first camera (x right, y down, z forward).
function pathBounds(paths) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const path of paths) {
    for (const p of path.points) {
      for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); }
    }
  }
  const centre = low.map((v, k) => (v + high[k]) / 2);
  const size = Math.max(...low.map((v, k) => high[k] - v), 0.02);
  const reach = p => Math.hypot(...p.map((v, k) => v - centre[k]));
  const radius = Math.max(...paths.flatMap(path => path.points.map(reach)), 0.01);
  return { centre, size, radius };
}

// The box around the middle 96 % of the points in each direction: a few far ones do not make the rest small.
function sceneBounds(points) {
  const sides = [0, 1, 2].map(k => {
    const values = points.map(p => p[k]).sort((a, b) => a - b);
    return [0.02, 0.98].map(share => values[Math.round(share * (values.length - 1))]);
  });
  const size = Math.max(...sides.map(([low, high]) => high - low), 0.02);
  return { centre: sides.map(([low, high]) => (low + high) / 2), size, radius: 0.5 * Math.hypot(...sides.map(([low, high]) => high - low)) };
}

// Draws the paths through `project`, which maps a point relative to the centre to right and up, in metres; without it, in
// space: the view is turned by hand, and the scene is drawn behind the paths.
function pathView(name, paths, times, project, scene) {
  const canvas = element("canvas", { role: "img", "aria-label": `Trajectory, ${name}` });
  const colours = { estimate: "--estimate", truth: "--truth" };
  const view = project ? null : turntable(canvas, () => draw());
  const map = project || (p => { const [right, down] = view.turned(p); return [right, -down]; });
  if (view) {
    canvas.className = "turn";
    view.yaw = widestYaw();
  }
  // Returns the angle, of six, at which the paths fill most of the view.
  function widestYaw() {
    const area = angle => {
      view.yaw = angle;
      const seen = paths.flatMap(path => path.points.map(map));
      const extent = k => Math.max(...seen.map(p => p[k])) - Math.min(...seen.map(p => p[k]));
      return extent(0) * extent(1);
    };
    const angles = [0.6, 1.1, 1.6, 2.1, 2.6, 3.1];
    const areas = angles.map(area);
    return angles[areas.indexOf(Math.max(...areas))] ?? 0.6;
  }
  function draw() {
    const { centre, size, radius } = view && scene.fitted() ? scene.bounds : pathBounds(paths);
    const side = canvas.clientWidth || 240;
    const context = prepare(canvas, side, side);
    const scale = view ? side * 0.47 / radius * view.zoom : side * 0.84 / size;
    const middle = view ? [side * (0.5 + view.right), side * (0.5 + view.down)] : [side / 2, side / 2];
    const at = p => {
      const [right, up] = map(p.map((v, k) => v - centre[k]));
      return [middle[0] + right * scale, middle[1] - up * scale];
    };
    if (view && scene.shown()) drawScene(context, at);
    drawRuler(context, side, scale);
    if (view) drawAxes(context, at, 0.18 * size);
    for (const path of paths) {
      context.strokeStyle = css(colours[path.name]);
      context.lineWidth = path.name === "truth" ? 3 : 1.8;
      context.globalAlpha = path.name === "truth" ? 0.6 : 1;
      context.beginPath();
      path.points.forEach((p, i) => context[i ? "lineTo" : "moveTo"](...at(p)));
      context.stroke();
      context.globalAlpha = 1;
    }
    const estimate = paths[0].points;
    if (!estimate.length) return;
    dot(context, at(estimate[0]), css("--faint"), 4);
    let best = estimate.length - 1;
    if (cursor.time !== null) {
      best = 0;
      times.forEach((t, i) => { if (Math.abs(t - cursor.time) < Math.abs(times[best] - cursor.time)) best = i; });
    }
    dot(context, at(estimate[best]), css("--estimate"), 5);
  }
  function dot(context, [x, y], colour, radius) {
    context.fillStyle = colour;
    context.beginPath(); context.arc(x, y, radius, 0, 2 * Math.PI); context.fill();
  }
  function drawRuler(context, side, scale) {
    const longest = side * 0.35 / scale, power = 10 ** Math.floor(Math.log10(longest));
    const length = [5, 2, 1].find(f => f * power <= longest) * power;
    context.strokeStyle = context.fillStyle = css("--faint");
    context.lineWidth = 2;
    context.beginPath(); context.moveTo(10, side - 12); context.lineTo(10 + length * scale, side - 12); context.stroke();
    context.font = "11px system-ui, sans-serif";
    context.fillText(length >= 1 ? `${length} m` : `${Number((length * 100).toPrecision(3))} cm`, 10, side - 18);
    context.fillText(name, 10, 18);
  }
  function drawAxes(context, at, length) {
    const origin = paths[0].points[0] || [0, 0, 0];
    ["x", "y", "z"].forEach((label, k) => {
      const end = origin.map((v, i) => v + (i === k ? length : 0));
      context.strokeStyle = context.fillStyle = palette[[1, 2, 0][k]];
      context.lineWidth = 1.5;
      context.beginPath(); context.moveTo(...at(origin)); context.lineTo(...at(end)); context.stroke();
      context.fillText(label, at(end)[0] + 3, at(end)[1]);
    });
  }
  function drawScene(context, at) {
    context.globalAlpha = 0.55;
    context.fillStyle = css("--seen");
    for (const p of scene.points) {
      const [x, y] = at(p);
      context.fillRect(x - 0.6, y - 0.6, 1.2, 1.2);
    }
    context.strokeStyle = css("--line");
    context.lineWidth = 1;
    context.beginPath();
    for (const [a, b] of scene.lines) { context.moveTo(...at(a)); context.lineTo(...at(b)); }
    context.stroke();
    context.globalAlpha = 1;
  }
  cursor.listeners.push(draw);
  keepDrawn(canvas, draw);
  return canvas;
}

function triples(flat) {
  return Array.from({ length: flat.length / 3 }, (_, i) => flat.slice(3 * i, 3 * i + 3));
}

// Selects the alignment of ground truth and estimate. The error charts always start from the first pose.
function truthChoice(data, truth) {
  const ways = { best: "best fit, as for the ATE", first: "onto the first pose" };
  const select = element("select", { "aria-label": "Ground truth laid" },
    ...Object.entries(ways).map(([value, text]) => element("option", { value }, text)));
  select.addEventListener("change", () => {
    truth.points = triples(data.truth[select.value]);
    cursor.move(cursor.time);
  });
  return select;
}

function trajectorySection(data) {
  const paths = [{ name: "estimate", points: triples(data.trajectory.p) }];
  const truth = data.truth && { name: "truth", points: triples(data.truth.best) };
  if (truth) paths.push(truth);
  const box = element("input", { type: "checkbox", checked: "", id: "scene" });
  const fit = element("select", { "aria-label": "The view in space fits", id: "fit" }, element("option", { value: "path" }, "fits the path"),
    element("option", { value: "scene" }, "fits the scene"));
  const ends = data.scene ? triples(data.scene.lines) : [];
  const scene = { points: data.scene ? triples(data.scene.points) : [], lines: [], shown: () => box.checked,
    fitted: () => fit.value === "scene" };
  for (let i = 0; i < ends.length; i += 2) scene.lines.push([ends[i], ends[i + 1]]);
  scene.bounds = scene.points.length ? sceneBounds(scene.points) : pathBounds(paths);
  for (const control of [box, fit]) control.addEventListener("change", () => cursor.move(cursor.time));
  const views = element("div", { class: "views" },
    pathView("above: x \u2192, z \u2191", paths, data.trajectory.t, ([x, , z]) => [x, z]),
    pathView("side: z \u2192, y \u2193", paths, data.trajectory.t, ([, y, z]) => [z, -y]),
    pathView("in space: drag, wheel, pinch", paths, data.trajectory.t, null, scene));
  const legend = element("div", { class: "legend" });
  for (const path of paths) {
    const swatch = element("i");
    swatch.style.background = `var(--${path.name})`;
    legend.append(element("span", {}, swatch, path.name === "truth" ? "ground truth, laid " : "estimate"));
  }
  if (truth) legend.append(truthChoice(data, truth));
  if (data.scene) legend.append(element("label", {}, box, ` ${scene.points.length} points and ${scene.lines.length} lines of the keyframes`), fit);
  return element("section", { class: "wide", id: "trajectory" }, element("h2", {}, "Trajectory"), views, legend);
}
