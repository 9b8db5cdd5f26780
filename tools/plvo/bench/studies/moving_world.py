#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""moving_world.py PLVO WORK: what plvo makes of a world that moves, mirrors or lies. Simulates hard sequences in three scenes, tracks
them and prints the tables of docs/results/moving_world.md. WORK: a folder for the sequences; what is there is not simulated again."""
import json
import math
import pathlib
import struct
import subprocess
import sys
import zlib

SCENES = ("corridor", "hall", "desk")
SIZE = (320, 240)
SIMULATE = f"--size {SIZE[0]}x{SIZE[1]} --frames 80 --seed 5"
BASE_CAMERA = "0.2 0 0.5 -0.5 0.5 -0.5 0.5".split()
# What `--with bumper` covers: the lowest 15 % of the image.
BUMPER_SHARE = 0.15
IMU, WHEELS, MASK = "with its IMU", "with wheels", "with a mask"
# (case, words of plvo simulate, what aids plvo run)
CASES = [
    ("a world at rest", "", None),
    ("a camera at rest, a board crosses", "--still --with board", None),
    ("a camera at rest, a person crosses", "--still --with person", None),
    ("a board crosses", "--with board", None),
    ("a board crosses", "--with board", IMU),
    ("a board crosses before a robot", "--robot --with board", None),
    ("a board crosses before a robot", "--robot --with board", WHEELS),
    ("a person crosses", "--with person", None),
    ("a person crosses", "--with person", IMU),
    ("a person walks ahead", "--with person-ahead", None),
    ("a part of the robot", "--with bumper", None),
    ("a part of the robot", "--with bumper", MASK),
    ("burnt-in digits", "--with clock", None),
    ("dots of a projector", "--with dots", None),
    ("a mirror", "--with mirror", None),
    ("a mirror before a robot", "--robot --with mirror", None),
    ("a mirror before a robot", "--robot --with mirror", WHEELS),
    ("frozen depth", "--with frozen-depth", None),
    ("repeated frames", "--with repeated-frames", None),
    ("depth with holes", "--with comb", None),
    ("5 frames a second", "--fps 5", None),
    ("the lens covered for 10 frames", "--covered 40:50", None),
    ("the lens covered for 30 frames", "--covered 40:70", None),
]
HEAD = """| case | lost | RPE mm/s | ATE mm | end: error ± SD mm | NEES (6) | inside 95 % |
|---|---:|---:|---:|---:|---:|---:|"""
NOTES = """`plvo simulate --scene SCENE {simulate} …`, then `plvo run` with default settings, with `--imu` (its gyro and
accelerometer), with `--wheels` (its robot's wheels) or with `--mask` (the part of the robot). The camera moves unless it is said to be at rest.

- **lost**: frames without a pose, of 80.
- **RPE**, **ATE**: RMSE of the motion over a second, and of the position after alignment.
- **end**: the error of the last position, and the standard deviation that plvo states for it (the root of the sum over the three axes).
- **NEES**: mean over the poses of the squared error, normalised by the covariance; a true covariance gives 6.
- **inside 95 %**: share of the poses with a normalised error below 12.6; a true covariance keeps 95 % of them there."""


def mask_png():
    """A grey image: black in the rows of the bumper, white elsewhere."""
    width, height = SIZE
    used = round(height * (1 - BUMPER_SHARE))
    rows = b"".join(b"\0" + (b"\xff" if y < used else b"\0") * width for y in range(height))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def simulate(plvo, work, scene, words):
    folder = work / "_".join([scene, *words.replace("--", "").replace(":", "-").split()])
    if not (folder / "calibration.txt").exists():
        subprocess.run([plvo, "simulate", "--scene", scene, *SIMULATE.split(), *words.split(), "--quiet", "--out", folder], check=True)
    return folder


def options(folder, aid):
    """The options of plvo run that hand over the aid."""
    if aid == IMU:
        return ["--imu"]
    if aid == WHEELS:
        return ["--wheels", folder / "wheel_odometry.txt", "--base-camera", *BASE_CAMERA]
    if aid == MASK:
        (folder / "mask.png").write_bytes(mask_png())
        return ["--mask", folder / "mask.png"]
    return []


def end_sd_mm(covariances):
    """Standard deviation of the last position."""
    last = [float(word) for word in covariances.read_text().splitlines()[-1].split()[1:]]
    return 1000 * math.sqrt(last[0] + last[7] + last[14])


def row(plvo, folder, case, aid):
    summary, covariances = folder / "summary.json", folder / "covariances.txt"
    subprocess.run([plvo, "run", folder, "--quiet", "--json", summary, "--covariance", covariances, *options(folder, aid)],
                   check=True, stderr=subprocess.DEVNULL)
    run = json.loads(summary.read_text())
    found = run["evaluation"]
    second = next(of for of in found["rpe"] if of["delta"] == "1s")
    rpe = f"{1000 * second['translation_m']['rmse']:.1f}" if second["pairs"] else "–"
    end = found["end_drift"]["translation_m"]
    name = f"{case}, {aid}" if aid else case
    nees = found["nees_pose"]["mean"]
    return (f"| {name} | {run['lost']} | {rpe} | {1000 * found['ate_m']['rmse']:.1f} | "
            f"{1000 * end:.0f} ± {end_sd_mm(covariances):.0f} | {nees:.{0 if nees >= 100 else 1}f} | "
            f"{100 * found['nees_pose']['inside_95_percent_bound']:.0f} % |")


def main():
    plvo, work = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    print(NOTES.format(simulate=SIMULATE))
    for scene in SCENES:
        print(f"\n## {scene.capitalize()}\n\n{HEAD}")
        for case, words, aid in CASES:
            print(row(plvo, simulate(plvo, work, scene, words), case, aid), flush=True)


if __name__ == "__main__":
    main()
