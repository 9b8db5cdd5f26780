#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `plvo live --view` in headless Chromium while the virtual device plays a simulated sequence: three pages at once
receive updates in order, draw, rotate the view, fit a phone's screen, and show an unplugged sensor. The test uses only
Python's standard library and controls the browser through the pipe of its debugging protocol. With --rate, on an idle
machine, each page must get ten updates a second while the odometry keeps its rate; without it the test judges no timing.
usage: live_browser_test.py [--rate] PLVO VIRTUAL_FRAMES OPENNI2_FOLDER [FOLDER FOR SCREENSHOTS]
exit code 77: no browser, skipped
"""
import base64
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

VIEWERS = 3
UPDATES = 20  # updates of each page before the checks
RATE_SECONDS = 4.0
FRAMES = 40
PATIENCE_S = 180  # time limit, so that a hang fails with a message; no timing is judged by it


class Browser:
    """Chromium, controlled by JSON messages, each ended by a zero byte: it reads from descriptor 3 and answers on 4."""

    def __init__(self, program, folder):
        to_browser, self.write_end = os.pipe()
        self.read_end, from_browser = os.pipe()

        def arrange():
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self.process = subprocess.Popen(
            [program, "--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe",
             "--no-first-run", f"--user-data-dir={folder}/profile", "--window-size=1280,960", "about:blank"],
            preexec_fn=arrange, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.pending, self.number, self.events = b"", 0, []

    def receive(self):
        while b"\0" not in self.pending:
            got = os.read(self.read_end, 1 << 16)
            if not got:
                raise RuntimeError("the browser has ended")
            self.pending += got
        message, self.pending = self.pending.split(b"\0", 1)
        return json.loads(message)

    def ask(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.write_end, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def open(self, address):
        target = self.ask("Target.createTarget", url="about:blank", newWindow=True)["targetId"]
        session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.ask("Runtime.enable", session)
        self.ask("Log.enable", session)
        self.ask("Page.navigate", session, url=address)
        return session

    def value(self, session, expression):
        result = self.ask("Runtime.evaluate", session, expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(json.dumps(result["exceptionDetails"]))
        return result["result"].get("value")

    def screenshot(self, session, path):
        picture = self.ask("Page.captureScreenshot", session, format="png", captureBeyondViewport=True)["data"]
        with open(path, "wb") as f:
            f.write(base64.b64decode(picture))

    def problems(self):
        """Returns the errors that the pages have reported."""
        found = []
        for event in self.events:
            parameters = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                found.append(parameters["exceptionDetails"].get("text", "exception"))
            if event.get("method") == "Runtime.consoleAPICalled" and parameters.get("type") in ("error", "warning"):
                found.append(str(parameters.get("args")))
            if event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] in ("error", "warning"):
                found.append(parameters["entry"]["text"])
        return found

    def close(self):
        self.process.kill()
        self.process.wait()


COLOURS = """(id => {
  const canvas = document.getElementById(id), d = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let i = 0; i < d.length; i += 4) seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]);
  return seen.size;
})"""


def check(condition, message):
    if not condition:
        sys.exit("FAILED: " + message)


def wait_for(what, message):
    end = time.monotonic() + PATIENCE_S
    while not what():
        check(time.monotonic() < end, message)
        time.sleep(0.05)


def look(browser, address, control, screenshots):
    pages = [browser.open(address) for _ in range(VIEWERS)]
    for page in pages:
        wait_for(lambda: browser.value(page, "window.plvo && window.plvo.images > 2"), "a page shows no image")
    # The updates arrive in order: the data of a page never get older.
    newest = [(0, 0, 0)] * VIEWERS
    while min(seen[0] for seen in newest) < UPDATES:
        for i, page in enumerate(pages):
            now = tuple(browser.value(page, "[plvo.updates, plvo.last.sequence, plvo.last.image]"))
            check(all(a >= b for a, b in zip(now, newest[i])), f"page {i} went back from {newest[i]} to {now}")
            newest[i] = now
        time.sleep(0.05)
    errors = [browser.value(page, "window.plvo.errors") for page in pages]
    check(errors == [0] * VIEWERS, f"the pages lost their connection {errors} times")
    page = pages[0]
    for name, least in (("image", 200), ("depth", 50), ("space", 4), ("covariance", 5)):
        colours = browser.value(page, f"{COLOURS}('{name}')")
        check(colours >= least, f"{name} has only {colours} colours")
    last = browser.value(page, "window.plvo.last")
    wait_for(lambda: browser.value(page, "window.plvo.last.state") == "tracking", "the page never says that it tracks")
    wait_for(lambda: browser.value(page, "window.plvo.last.viewers") == VIEWERS, "not every viewer is counted")
    check(browser.value(page, "path.points.length") >= 9, "no trajectory is drawn")
    wait_for(lambda: browser.value(page, "window.plvo.last.map.way.length") >= 3, "no keyframe of the map is drawn")
    numbers = browser.value(page, "document.getElementById('numbers').textContent")
    check("maplocated, " in numbers and " loops closed" in numbers, f"the page does not tell of the map: {numbers}")
    check(last["points"] and last["segments"], "no features are drawn")
    turned = browser.value(page, """(() => { const before = space.toDataURL();
        eye.touched = true; eye.yaw += 1; drawSpace(); return space.toDataURL() !== before; })()""")
    check(turned, "the trajectory does not turn")
    pinched = browser.value(page, """(() => {
        space.setPointerCapture = () => {};
        const press = (type, pointerId, clientX) => space.dispatchEvent(new PointerEvent(type, { pointerId, clientX, clientY: 200 }));
        press("pointerdown", 1, 700); press("pointerdown", 2, 800); press("pointermove", 2, 900);
        press("pointerup", 1, 700); press("pointerup", 2, 900);
        return eye.zoom; })()""")
    check(abs(pinched - 2) < 1e-9, f"fingers twice as far apart magnify {pinched} times")
    fitted = browser.value(page, """(() => { space.dispatchEvent(new MouseEvent("dblclick"));
        return [eye.zoom, eye.right, eye.down]; })()""")
    check(fitted == [1, 0, 0], f"a double tap does not fit the view: {fitted}")
    if screenshots:
        browser.screenshot(page, os.path.join(screenshots, "live.png"))
    # On a phone, no element is wider than the screen.
    browser.ask("Emulation.setDeviceMetricsOverride", page, width=390, height=844, deviceScaleFactor=2, mobile=True)
    wait_for(lambda: browser.value(page, "window.innerWidth") == 390, "the page does not notice the phone")
    width = browser.value(page, "document.documentElement.scrollWidth")
    check(width <= 390, f"the page is {width} px wide on a phone of 390")
    if screenshots:
        browser.screenshot(page, os.path.join(screenshots, "live_phone.png"))
    # The sensor is unplugged: the page shows it.
    with open(control, "w", encoding="utf-8") as f:
        f.write("unplug\n")
    wait_for(lambda: "unplugged" in browser.value(page, "document.getElementById('camera').textContent"),
             "the page does not say that the sensor is unplugged")
    state = "document.getElementById('state').textContent"
    wait_for(lambda: browser.value(page, state) == "waiting", "without a sensor the page does not say that it waits")
    if screenshots:
        browser.screenshot(page, os.path.join(screenshots, "live_unplugged.png"))
    with open(control, "w", encoding="utf-8") as f:
        f.write("plug\n")
    wait_for(lambda: browser.value(page, state) == "tracking", "the page does not go on after the replug")
    check(not browser.problems(), "errors on the page: " + "; ".join(browser.problems()))
    return pages


def updates_per_second(browser, pages):
    ask = "[performance.now(), window.plvo.updates]"
    before = [browser.value(page, ask) for page in pages]
    time.sleep(RATE_SECONDS)
    after = [browser.value(page, ask) for page in pages]
    rates = [1000 * (b[1] - a[1]) / (b[0] - a[0]) for a, b in zip(before, after)]
    print("updates per second:", " ".join(f"{rate:.1f}" for rate in rates))
    return rates


def main():
    rate = "--rate" in sys.argv
    plvo, frames_maker, openni2, *rest = [argument for argument in sys.argv[1:] if argument != "--rate"]
    screenshots = rest[0] if rest else None
    program = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if program is None:
        print("SKIPPED: no Chromium here (apt install chromium)")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="plvo_live_") as folder:
        raw, recording, control, log, summary = (os.path.join(folder, n) for n in ("raw", "sequence", "control", "log", "summary.json"))
        subprocess.run([frames_maker, raw, recording, str(FRAMES)], check=True)
        os.mkfifo(control)
        environment = dict(os.environ, LD_LIBRARY_PATH=openni2, PLVO_VIRTUAL_FRAMES=raw, PLVO_VIRTUAL_CONTROL=control,
                           PLVO_VIRTUAL_START="to_and_fro 1")
        with open(log, "w", encoding="utf-8") as errors:
            live = subprocess.Popen([plvo, "live", "--mode", "320x240", "--calibration", os.path.join(recording, "calibration.txt"),
                                     "--view", "0", "--json", summary, "--map", "32"], env=environment, stdout=subprocess.DEVNULL, stderr=errors)
        browser = Browser(program, folder)
        try:
            found = lambda: re.search(r"http://[\d.]+:\d+/", open(log, encoding="utf-8").read())
            wait_for(found, "plvo live names no address")
            pages = look(browser, found().group(0), control, screenshots)
            rates = updates_per_second(browser, pages) if rate else []
        finally:
            browser.close()
            live.send_signal(2)
            code = live.wait(PATIENCE_S)
        check(code == 0, f"plvo live ended with {code}: " + open(log, encoding="utf-8").read())
        told = json.load(open(summary, encoding="utf-8"))
        print(f"odometry: {told['frames']} of {told['camera_frames']} frames, latency {told['latency_ms']['median']:.1f} ms median,"
              f" {told['latency_ms']['p95']:.1f} p95, CPU {told['cpu_ms']['total']['median']:.1f} ms a frame")
        if rate:
            # The browser draws three pages on the same processors; this checks that the odometry does not wait for
            # them.
            check(told["latency_ms"]["median"] < 100, "the viewers slow the odometry down")
            check(min(rates) >= 10, f"only {min(rates):.1f} updates per second")
    print("the live view loads, draws, turns, fits a phone and tells an unplug")


main()
