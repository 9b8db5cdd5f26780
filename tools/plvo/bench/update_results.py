#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the pages of docs/results: runs the programs of the bench and puts what they print under a stamp with the commit, the date,
the machine and the command. `cmake --build build/release --target update_results` measures all of them, which takes hours;
`update_results.py --bench build/release/bin --data DIR --work DIR NAME…` measures those named. What the bench has measured
already (in --work) is not measured again."""
import argparse
import datetime
import os
import pathlib
import platform
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]
FR1, FR3, CORRIDORS = "fr1_rpy_150=tum-fr1", "fr3_notexture_120=tum-fr3", "corridor_constant corridor_varying"

# page -> (title, command; names of sequences are those of folders in --data, {work} is a folder for what is measured, {bin} that of
# the programs; a script is one of tools/plvo/bench/studies)
# What PEERS names is a row of the page: without it the program was built without that peer.
PEERS = {"recordings": "opencv-rgbd", "table2": "opencv-rgbd", "lighting": "opencv-rgbd", "detectors": "EDLines"}
PAGES = {
    "recordings": ("Recorded sequences: every system",
                   f"plvo_bench run {FR1} {FR3} {CORRIDORS} --systems ours,paper,opencv --repeats 3 --out {{work}}/recordings"),
    "table2": ("TUM fr1, beside the paper's Table 2", f"plvo_bench tum {FR1} --systems ours,peers --out {{work}}/table2"),
    "lighting": ("Simulated sequences under two lights", "plvo_bench lighting --seeds 1 --frames 90 --jobs 2 --discard-images --systems ours,opencv --out {work}/lighting"),
    "stages": ("Instructions and time of each stage", f"plvo_bench stages {FR1} --instructions --out {{work}}/stages"),
    "growth": ("How the cost of a frame grows", f"plvo_bench growth {FR1} --frames 6 --jobs 2 --out {{work}}/growth"),
    "detectors": ("Detectors beside those of OpenCV", f"plvo_bench detectors {FR1} {FR3} --frames 30 --out {{work}}/detectors"),
    "moving_world": ("A world that moves, mirrors and lies", "moving_world.py {bin}/plvo {work}/moving_world"),
    "map": ("What a map corrects, and what it recognises", "map.py {bin}/map_study {work}/map"),
}
# page -> pictures that its command draws into {work}/<page>; they stand beside the page.
PICTURES = {"map": ["map_recall.svg"]}


def commit():
    git = ["git", "-C", str(ROOT)]
    head = subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    changed = subprocess.run([*git, "status", "--porcelain", "--untracked-files=no"], capture_output=True, text=True, check=True).stdout
    return head + (" with uncommitted changes" if changed.strip() else "")


def machine():
    processor = platform.processor() or platform.machine()
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            processor = line.split(":", 1)[1].strip()
            break
    return f"{processor}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"


def page(title, stamp, text):
    """The page: title, stamp (a dictionary) and what the program printed."""
    lines = "\n".join(f"- {name}: {value}" for name, value in stamp.items())
    return f"<!-- SPDX-License-Identifier: Apache-2.0 -->\n# {title}\n\n{lines}\n\n{text.strip()}\n"


def measure(name, bench, data, work):
    """Runs the program and returns the page."""
    title, command = PAGES[name]
    program, *words = command.format(work=work, bin=bench).split()
    start = [sys.executable, str(ROOT / "tools/plvo/bench/studies" / program)] if program.endswith(".py") else [str(bench / program)]
    run = subprocess.run([*start, *words], cwd=data, stdout=subprocess.PIPE, text=True, check=True)
    if (peer := PEERS.get(name, "")) not in run.stdout:
        sys.exit(f"update_results.py: {name}: {program} measured no {peer}: build it where OpenCV with contrib is installed "
                 "(sudo apt install libopencv-contrib-dev); the page stays as it was")
    stamp = {"commit": commit(), "date": datetime.date.today().isoformat(), "machine": machine(),
             "command": f"`{command.format(work='results', bin='bin')}`", "written": "by `tools/plvo/bench/update_results.py`"}
    return page(title, stamp, run.stdout)


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bench", type=pathlib.Path, required=True, help="folder of plvo_bench and plvo")
    parser.add_argument("--data", type=pathlib.Path, required=True, help="folder of the recorded sequences")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for what is measured")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs/results", help="folder of the pages")
    parser.add_argument("names", nargs="*", help=f"pages to write, of {', '.join(PAGES)} (default: all)")
    arguments = parser.parse_args(words)
    if unknown := set(arguments.names) - set(PAGES):
        parser.error(f"no such page: {' '.join(sorted(unknown))}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name in arguments.names or PAGES:
        text = measure(name, arguments.bench.resolve(), arguments.data, arguments.work.resolve())
        (arguments.out / f"{name}.md").write_text(text, encoding="utf-8")
        for picture in PICTURES.get(name, ()):
            shutil.copyfile(arguments.work / name / picture, arguments.out / picture)
        print(f"{name}.md is written", file=sys.stderr)


if __name__ == "__main__":
    main()
