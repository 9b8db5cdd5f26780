// SPDX-License-Identifier: Apache-2.0
// Assembles the report from the data.
const data = JSON.parse(document.getElementById("data").textContent);
const main = document.getElementById("main");

function table(id, title, head, rows, note) {
  const section = element("section", { id }, element("h2", {}, title), element("div", { class: "table" },
    element("table", {}, element("thead", {}, element("tr", {}, ...head.map(h => element("th", {}, h)))),
      element("tbody", {}, ...rows.map(row => element("tr", {}, ...row.map(c => element("td", {}, String(c)))))))));
  if (note) section.append(element("p", { class: "note" }, note));
  return section;
}

const median = values => { const v = [...values].sort((a, b) => a - b); return v[Math.floor(v.length / 2)]; };

// The most important numbers.
function tiles(data) {
  const list = [];
  const s = data.series, m = data.metrics;
  if (s) list.push(["tracked", `${s.state.filter(x => x === "tracking" || x === "initialising").length}/${s.state.length}`, "frames"]);
  const second = m && m.rpe.find(r => r.delta === "1s" && r.pairs) || m && m.rpe.find(r => r.pairs);
  if (second) {
    const per = second.delta === "1s" ? "per s" : `over ${second.delta}`;
    list.push([`error ${per}`, (1e3 * second.translation_m.rmse).toFixed(1), "mm"],
      [`error ${per}`, second.rotation_deg.rmse.toFixed(2), "\u00b0"]);
  }
  if (m) list.push(["ATE", (1e3 * m.ate_m.rmse).toFixed(1), "mm"]);
  if (s) {
    list.push(["inliers", `${median(s.points.inliers)}+${median(s.lines.inliers)}`, "points, lines"],
      ["CPU per frame", median(s.stages.total).toFixed(1), "ms, median"]);
  }
  return element("div", { class: "tiles wide" }, ...list.map(([name, value, unit]) =>
    element("div", {}, element("small", {}, name), element("b", {}, value), element("small", {}, unit))));
}

function metricsSection(m) {
  const mm = v => (1e3 * v).toFixed(2), degrees = v => v.toFixed(3);
  const rows = [];
  for (const r of m.rpe) {
    if (!r.pairs) continue;
    const name = { "1f": "RPE per frame", "1s": "RPE per second" }[r.delta] || `RPE over ${r.delta}`;
    rows.push([name, mm(r.translation_m.rmse), mm(r.identity.translation_m.rmse), degrees(r.rotation_deg.rmse),
      degrees(r.identity.rotation_deg.rmse)]);
  }
  rows.push(["ATE", mm(m.ate_m.rmse), mm(m.ate_m.identity.rmse), "", ""]);
  rows.push(["end-point drift", mm(m.end_drift.translation_m), mm(m.end_drift.identity.translation_m),
    degrees(m.end_drift.rotation_deg), degrees(m.end_drift.identity.rotation_deg)]);
  const errors = { nees_motion: "of the motions", nees_second: "over a second", nees_pose: "of the poses" };
  const nees = Object.keys(errors).filter(k => m[k] && m[k].samples).map(k =>
    `NEES ${errors[k]}: ${m[k].mean.toFixed(2)} (6 is consistent), ` +
    `${(100 * m[k].inside_95_percent_bound).toFixed(0)} % inside the 95 % bound.`).join(" ");
  const section = table("errors-table", "Errors against the ground truth",
    ["RMSE", "mm", "zero motion", "\u00b0", "zero motion"], rows,
    `${m.poses} of ${m.estimate_poses} poses, ${m.duration_s.toFixed(2)} s, ${m.path_m.toFixed(2)} m. ` +
    `\u201cZero motion\u201d is the error of an estimate without any motion. ${nees}`);
  const distances = data.by_distance;
  if (distances && distances.rows.length) section.append(table("by-distance", "Error against distance", distances.head, distances.rows));
  return section;
}

function errorCharts(e, marks) {
  const axes = ["x", "y", "z"];
  const group = (title, unit, first, factor) => axes.map((axis, k) => chart(`${title}, ${axis}`, unit, e.t, [{
    name: "error", y: e.e[first + k].map(v => v * factor), colour: css("--estimate"),
    band: e.s ? e.s[first + k].map(v => v === null ? null : 3 * v * factor) : null }], marks, "third"));
  return [...group("Position error", "mm", 0, 1e3), ...group("Orientation error", "degrees", 3, 180 / Math.PI)];
}

function statusMarks(s) {
  const marks = [];
  s.state.forEach((state, i) => { if (state === "lost" || state === "damaged") marks.push([s.t[i], s.t[i + 1] ?? s.t[i]]); });
  return marks;
}

document.getElementById("title").textContent = data.title;
document.getElementById("subtitle").textContent = data.subtitle;
document.title = data.title;
const marks = data.series ? statusMarks(data.series) : data.lost || [];
main.append(tiles(data), trajectorySection(data));
if (data.frames && data.frames.length) main.append(framesSection(data));
if (data.metrics) main.append(metricsSection(data.metrics));
if (data.summary) main.append(table("summary", "Run", ["", ""], data.summary));
if (data.errors) main.append(...errorCharts(data.errors, marks));
if (data.series) {
  const s = data.series;
  const lines = (names, source) => names.map((name, i) => ({ name, y: source[name], colour: palette[i] }));
  const stages = lines(Object.keys(s.stages), s.stages).map(l => ({ ...l, stacked: l.name !== "total" }));
  main.append(
    chart("Points", "per frame", s.t, lines(["detected", "matched", "inliers"], s.points), marks),
    chart("Lines", "per frame", s.t, lines(["detected", "matched", "inliers"], s.lines), marks),
    chart("CPU time by stage", "ms", s.t, stages, marks),
    chart("Brightness", "mean grey level, 0 to 255", s.t, [{ name: "brightness", y: s.brightness, colour: palette[1] }], marks));
}
if (marks.length) main.append(element("p", { class: "note wide" }, "Vertical stripes in the charts: frames that were lost or damaged."));
// The first drawing, after the layout is complete. A link may end with #t=2.5, the time to show in seconds.
const moment = location.hash.match(/^#t=([0-9.]+)$/);
cursor.move(moment ? Number(moment[1]) : null);
