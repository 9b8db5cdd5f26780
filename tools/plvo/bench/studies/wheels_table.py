#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""wheels_table.py PLVO WORK: what wheels bring. Simulates a robot in several rooms, tracks each sequence without and with its wheels,
and prints the table of docs/decisions/wheels.md: medians over the seeds. WORK: a folder for the sequences; what is there is not
simulated again."""
import json
import pathlib
import statistics
import subprocess
import sys

CASES = [
    ("the hall", "--scene hall"),
    ("the bare room", "--scene bare"),
    ("… under a swinging lamp", "--scene bare --light varying"),
    ("… three frames a second", "--scene bare --fps 3 --frames 40"),
    ("a hand over the lens for 10 frames", "--scene hall --covered 60:70"),
    ("… for 30 frames", "--scene hall --covered 60:90"),
]
SEEDS = (1, 2, 3)
FRAMES = "120"
BASE_CAMERA = "0.2 0 0.5 -0.5 0.5 -0.5 0.5".split()


def track(plvo, folder, *words):
    summary = folder / "summary.json"
    subprocess.run([plvo, "run", folder, "--quiet", "--json", summary, *words], check=True)
    return json.loads(summary.read_text())


def figures(run):
    evaluation = run["evaluation"]
    frame, second = (of for of in evaluation["rpe"] if of["delta"] in ("1f", "1s"))
    return {
        "lost": run["lost"],
        "frame_mm": 1000 * frame["translation_m"]["rmse"],
        "frame_deg": frame["rotation_deg"]["rmse"],
        "second_mm": 1000 * second["translation_m"]["rmse"],
        "second_deg": second["rotation_deg"]["rmse"],
        "ate_mm": 1000 * evaluation["ate_m"]["rmse"],
        "nees": evaluation["nees_pose"]["mean"],
    }


def main():
    plvo, work = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    print("| `plvo simulate --robot --frames 120 …` | lost | frame to frame | drift per second | ATE | NEES (6) |")
    print("|---|---:|---:|---:|---:|---:|")
    for name, words in CASES:
        found = ([], [])
        for seed in SEEDS:
            folder = work / ("_".join(words.replace("--", "").replace(":", "-").split()) + f"_{seed}")
            if not (folder / "calibration.txt").exists():
                frames = [] if "--frames" in words else ["--frames", FRAMES]
                subprocess.run([plvo, "simulate", "--robot", "--quiet", "--out", folder, "--seed", str(seed), *words.split(), *frames],
                               check=True)
            found[0].append(figures(track(plvo, folder)))
            found[1].append(figures(track(plvo, folder, "--wheels", folder / "wheel_odometry.txt", "--base-camera", *BASE_CAMERA)))
        without, with_wheels = ({key: statistics.median(run[key] for run in runs) for key in runs[0]} for runs in found)
        both = lambda text: f"{text.format(**without)} \\| {text.format(**with_wheels)}"
        print(f"| {name}: `{words}` | {both('{lost:g}')} | {both('{frame_mm:.1f} mm, {frame_deg:.3f}°')} | "
              f"{both('{second_mm:.1f} mm, {second_deg:.2f}°')} | {both('{ate_mm:.1f}')} mm | {both('{nees:.1f}')} |", flush=True)


if __name__ == "__main__":
    main()
