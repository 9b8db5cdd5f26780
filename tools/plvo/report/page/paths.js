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

// Draws the paths through `project`, which maps a point relative to the centre to right and up, in metres.
function pathView(name, paths, times, project, turning) {
  const canvas = element("canvas", { role: "img", "aria-label": `Trajectory, ${name}` });
  const colours = { estimate: "--estimate", truth: "--truth" };
  let yaw = 0.6, pitch = 0.45;
  const rotated = ([x, y, z]) => {
    const a = Math.cos(yaw) * x + Math.sin(yaw) * z, b = -Math.sin(yaw) * x + Math.cos(yaw) * z;
    return [a, -y * Math.cos(pitch) + b * Math.sin(pitch)];
  };
  const map = turning ? rotated : project;
  if (turning) yaw = widestYaw();
  // Returns the angle, of six, at which the paths fill most of the view.
  function widestYaw() {
    const area = angle => {
      yaw = angle;
      const seen = paths.flatMap(path => path.points.map(rotated));
      const extent = k => Math.max(...seen.map(p => p[k])) - Math.min(...seen.map(p => p[k]));
      return extent(0) * extent(1);
    };
    const angles = [0.6, 1.1, 1.6, 2.1, 2.6, 3.1];
    const areas = angles.map(area);
    return angles[areas.indexOf(Math.max(...areas))] ?? 0.6;
  }
  function draw() {
    const { centre, size, radius } = pathBounds(paths);
    const side = canvas.clientWidth || 240;
    const context = prepare(canvas, side, side);
    const scale = turning ? side * 0.47 / radius : side * 0.84 / size;
    const at = p => {
      const [right, up] = map(p.map((v, k) => v - centre[k]));
      return [side / 2 + right * scale, side / 2 - up * scale];
    };
    drawRuler(context, side, scale);
    if (turning) drawAxes(context, at, 0.18 * size);
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
      context.strokeStyle = context.fillStyle = ["#d64545", "#2a9d4a", "#3b78e7"][k];
      context.lineWidth = 1.5;
      context.beginPath(); context.moveTo(...at(origin)); context.lineTo(...at(end)); context.stroke();
      context.fillText(label, at(end)[0] + 3, at(end)[1]);
    });
  }
  if (turning) {
    canvas.className = "turn";
    canvas.addEventListener("pointerdown", event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", event => {
      if (!event.buttons) return;
      yaw += event.movementX * 0.01;
      pitch = Math.max(-1.5, Math.min(1.5, pitch + event.movementY * 0.01));
      draw();
    });
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
  const views = element("div", { class: "views" },
    pathView("above: x \u2192, z \u2191", paths, data.trajectory.t, ([x, , z]) => [x, z], false),
    pathView("side: z \u2192, y \u2193", paths, data.trajectory.t, ([, y, z]) => [z, -y], false),
    pathView("in space: drag to turn", paths, data.trajectory.t, null, true));
  const legend = element("div", { class: "legend" });
  for (const path of paths) {
    const swatch = element("i");
    swatch.style.background = `var(--${path.name})`;
    legend.append(element("span", {}, swatch, path.name === "truth" ? "ground truth, laid " : "estimate"));
  }
  if (truth) legend.append(truthChoice(data, truth));
  return element("section", { class: "wide", id: "trajectory" }, element("h2", {}, "Trajectory"), views, legend);
}
