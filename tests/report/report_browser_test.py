#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a report in headless Chromium, operates it and checks what it draws. Uses only Python's standard library.

A copy of the page contains two more scripts. The first one catches errors. The last one moves the slider, taps a chart,
rotates the 3D view, reads the canvases and writes its findings into the document, which --dump-dom prints.
usage: report_browser_test.py PLVO    (exit code 77: no browser, skipped)
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

CATCH = """<script>
window.problems = [];
addEventListener("error", e => problems.push("error: " + e.message));
addEventListener("unhandledrejection", e => problems.push("rejection: " + e.reason));
for (const kind of ["error", "warn"]) console[kind] = (...a) => problems.push(kind + ": " + a.join(" "));
</script>
"""

# Name of the folder: a browser that interprets it as HTML shows a blank page.
HOSTILE = "x<!--<script>y & z"

PROBE = """<script>
const wait = ms => new Promise(done => setTimeout(done, ms));
function colours(canvas) {
  const d = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let i = 0; i < d.length; i += 4) seen.add((d[i] << 16 | d[i + 1] << 8 | d[i + 2]) + ":" + (d[i + 3] > 0));
  return seen.size;
}
const print = canvas => canvas.toDataURL();
async function probe() {
  await wait(500);
  const found = { problems, requests: performance.getEntriesByType("resource").filter(r => !r.name.startsWith("data:")).map(r => r.name) };
  found.titles = [...document.querySelectorAll("h2")].map(h => h.textContent);
  found.blank = [...document.querySelectorAll("canvas")].filter(c => colours(c) < 3).map(c => c.getAttribute("aria-label"));
  found.width = document.documentElement.scrollWidth;
  found.window = innerWidth;
  const scrubber = document.getElementById("scrubber");
  if (scrubber) {
    const canvas = document.getElementById("frame"), text = document.getElementById("frame-text");
    const before = [print(canvas), text.textContent, document.getElementById("depth").src];
    scrubber.value = Math.ceil(scrubber.max / 2);  // a frame in which points were looked for
    scrubber.dispatchEvent(new Event("input"));
    await wait(300);
    found.scrubbed = [print(canvas) !== before[0], text.textContent !== before[1], document.getElementById("depth").src !== before[2]];
    found.pictureColours = colours(canvas);
    const full = print(canvas);
    found.toggles = [...document.querySelectorAll("#frames input[type=checkbox]")].map(box => {
      box.click();
      const changed = print(canvas) !== full;
      box.click();
      return changed;
    });
    document.querySelector(".chart canvas").dispatchEvent(new PointerEvent("pointerdown", { clientX: 300, clientY: 0, bubbles: true }));
    await wait(300);
    found.tapMovedTheScrubber = scrubber.value;
  }
  const turn = document.querySelector("canvas.turn"), flat = print(turn);
  turn.setPointerCapture = () => {};
  const press = (type, pointerId, clientX, clientY) => turn.dispatchEvent(new PointerEvent(type, { pointerId, clientX, clientY, bubbles: true }));
  press("pointerdown", 1, 100, 100); press("pointermove", 1, 160, 120); press("pointerup", 1, 160, 120);
  found.turned = print(turn) !== flat;
  const before = print(turn);
  press("pointerdown", 1, 100, 100); press("pointerdown", 2, 140, 100); press("pointermove", 2, 220, 100);
  press("pointerup", 1, 100, 100); press("pointerup", 2, 220, 100);
  found.pinched = print(turn) !== before;
  turn.dispatchEvent(new MouseEvent("dblclick", { bubbles: true }));
  press("pointerdown", 1, 160, 120); press("pointermove", 1, 100, 100); press("pointerup", 1, 100, 100);
  found.fitted = print(turn) === flat;
  const scene = document.getElementById("scene");
  if (data.scene) {
    found.scene = [data.scene.points.length / 3, data.scene.lines.length / 6];
    const fit = document.getElementById("fit");
    const choose = value => { fit.value = value; fit.dispatchEvent(new Event("change")); return print(turn); };
    const whole = choose("scene");
    found.sceneFitted = whole !== flat;
    scene.click();
    found.sceneShown = print(turn) !== whole;
    scene.click();
    choose("path");
  }
  const choice = document.querySelector("#trajectory select"), fitted = print(turn);
  choice.value = "first";
  choice.dispatchEvent(new Event("change"));
  found.truthMoved = print(turn) !== fitted;
  found.tiles = [...document.querySelectorAll(".tiles b")].map(b => b.textContent);
  found.title = document.title;
  const result = document.createElement("pre");
  result.id = "probe";
  result.textContent = JSON.stringify(found);
  document.body.append(result);
}
probe().catch(e => { document.body.append(Object.assign(document.createElement("pre"), { id: "probe", textContent: JSON.stringify({ problems: ["probe: " + e.stack] }) })); });
</script>
"""


def look(browser, page, folder, size):
    """What the probe found in a window of this size."""
    text = open(page, encoding="utf-8").read()
    probed = os.path.join(folder, "probed.html")
    text = text.replace("<head>", "<head>" + CATCH, 1)
    at = text.rindex("</body>")
    with open(probed, "w", encoding="utf-8") as f:
        f.write(text[:at] + PROBE + text[at:])
    dom = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={folder}/profile",
                          f"--window-size={size}", "--virtual-time-budget=8000", "--dump-dom", "file://" + probed],
                         capture_output=True, text=True, timeout=300).stdout
    found = re.search(r'<pre id="probe">(.*?)</pre>', dom, re.S)
    assert found, "the probe wrote nothing; the page may not have run at all"
    text = found.group(1)
    for entity, character in (("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")):
        text = text.replace(entity, character)
    return json.loads(text)


def check(condition, message, found):
    if not condition:
        print(json.dumps(found, indent=1)[:4000])
        sys.exit("FAILED: " + message)


def check_common(found, wanted):
    check(not found["problems"], "errors on the page", found)
    check(not found["requests"], "the page asked for something from elsewhere", found)
    for title in wanted:
        check(any(t.startswith(title) for t in found["titles"]), f"no part '{title}'", found)
    check(not found["blank"], "an empty chart or picture", found)
    check(found["turned"], "the 3D view does not turn", found)
    check(found["pinched"], "two fingers do not magnify the 3D view", found)
    check(found["fitted"], "a double click and the drag back do not give the first view", found)
    check(found["truthMoved"], "the ground truth is laid the same way by both choices", found)
    check(found["tiles"] and not any("NaN" in t or "undefined" in t for t in found["tiles"]), "a key figure is missing", found)
    check(found["width"] <= found["window"] + 1, "the page is wider than its window", found)


def main():
    plvo = sys.argv[1]
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if browser is None:
        print("SKIPPED: no Chromium here (apt install chromium)")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="plvo_report_") as folder:
        run_page, eval_page, estimate = (os.path.join(folder, n) for n in ("run.html", "eval.html", "estimate.txt"))
        recording, covariance = os.path.join(folder, HOSTILE), os.path.join(folder, "covariance.txt")
        subprocess.run([plvo, "simulate", "--scene", "bare", "--size", "320x240", "--frames", "8", "--out", recording, "--quiet"], check=True)
        subprocess.run([plvo, "run", recording, "--quiet", "--out", estimate, "--covariance", covariance, "--report", run_page], check=True)
        subprocess.run([plvo, "eval", "--gt", os.path.join(recording, "groundtruth.txt"), "--est", estimate, "--est-covariance",
                        covariance, "--report", eval_page], check=True, stdout=subprocess.DEVNULL)
        parts = ["Trajectory", "Errors against the ground truth", "Position error, x", "Orientation error, z"]
        for size in ("1280,900", "500,900"):  # a screen; the narrowest window that headless Chromium makes
            found = look(browser, run_page, folder, size)
            check(found["title"] == HOSTILE, "the folder's name is another on the page", found)
            check_common(found, parts + ["Frames", "Run", "Points", "Lines", "CPU time by stage", "Brightness"])
            check(all(found["scrubbed"]), "the scrubber changes nothing", found)
            check(min(found["scene"]) >= 10, "hardly any points and lines in 3D", found)
            check(found["sceneShown"] and found["sceneFitted"], "the scene is not drawn, or not fitted", found)
            check(found["pictureColours"] > 50, "no image under the features", found)
            check(found["toggles"][0] and found["toggles"][2], "the boxes switch nothing", found)
        check_common(look(browser, eval_page, folder, "1280,900"), parts)
    print("the reports load, draw, scrub and turn")


main()
