#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""map.py MAP_STUDY WORK [--quick | --measured]: what the map does in simulated rooms. Runs map_study for each room, prints the tables of
docs/results/map.md, and draws map_recall.svg into WORK. WORK: a folder for what is measured; what is there is not measured again.
--quick: a small part of all, to see whether it runs. --measured: only what WORK has already."""
import json
import os
import pathlib
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

PICTURE = "map_recall.svg"
# Scene, light, seed and width of the image in pixels; then the amount: in full, and with --quick. The longest first.
PATROLS = [("hall", "constant", 21, 320), ("hall", "varying", 22, 320), ("hall", "constant", 21, 160), ("hall", "varying", 21, 160),
           ("hall", "constant", 22, 160), ("desk", "constant", 22, 160), ("desk", "varying", 22, 160), ("corridor", "constant", 21, 320),
           ("corridor", "varying", 22, 320), ("corridor", "constant", 21, 160), ("corridor", "varying", 22, 160),
           ("staircase", "constant", 21, 160)]
# Tables and picture are of the first six; the others show what a smaller image does.
ROOMS = [(scene, light, 3, width) for scene, width in (("hall", 320), ("corridor", 320), ("desk", 160)) for light in ("constant", "varying")]
SMALL = [(scene, light, 3, 160) for scene in ("hall", "corridor") for light in ("constant", "varying")]
CARRIED = [(scene, light, 3, width) for width in (640, 320) for scene in ("hall", "desk", "corridor") for light in ("constant", "varying")] + [
    ("hall", "constant", 3, 240), ("desk", "constant", 3, 160), ("desk", "varying", 3, 160), ("corridor", "constant", 3, 160)]
COSTS = [("hall", "constant", 3, 640), ("hall", "constant", 3, 240), ("staircase", "constant", 3, 160)]
SOAKS = [("desk", "constant", 3, 160)]
AMOUNTS = {"patrol": (3000, 100), "soak": (100000, 2000), "carried": (50, 3), "recall": (10, 2), "cost": (200, 60)}
LARGE, CARRIED_LARGE = 640, 17  # images that take long to render, and so fewer trials; none with --quick

SHARES = [0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1]
METRES = [0, 0.1, 0.2, 0.4, 0.7, 1, 1.5, 2.5]
DEGREES = [0, 10, 20, 30, 45, 60]
LEAST_PAIRS = 10  # of which a share is told


def jobs(quick):
    """Yields (study, room, amount)."""
    # Times come last, when nothing else runs.
    for study, rooms in (("patrol", PATROLS), ("soak", SOAKS), ("carried", CARRIED), ("recall", ROOMS + SMALL), ("cost", COSTS)):
        for room in rooms:
            if room[3] < LARGE:
                yield study, room, AMOUNTS[study][quick]
            elif not quick:
                yield study, room, CARRIED_LARGE if study == "carried" else AMOUNTS[study][quick]


def words_of(job):
    study, room, amount = job
    return [study, *map(str, room), str(amount)]


def path_of(work, job):
    return work / ("_".join(words_of(job)) + ".json")


def measure(program, work, job):
    words, path = words_of(job), path_of(work, job)
    if not path.exists():
        print(" ".join(words), file=sys.stderr, flush=True)
        path.write_text(subprocess.run([program, *words], stdout=subprocess.PIPE, text=True, check=True).stdout, encoding="utf-8")
    return json.loads(path.read_text(encoding="utf-8"))


def table(head, rows, words=1):
    """words: columns at the left that are no figures."""
    print("\n| " + " | ".join(head) + " |")
    print("|---" * words + "|---:" * (len(head) - words) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")


def percent(part, whole):
    return f"{100 * part / whole:.0f} %" if whole else "–"


def names(room):
    scene, light, seed, width = room
    return [scene, light, str(seed), f"{width}×{width * 3 // 4}"]


def patrols(found, frames):
    print(f"""## Patrols

Sequences of {frames} frames at 30 Hz, several rounds of the hall and the corridor, to and fro in the others, with `--map 256`.

- **lost**: frames without a pose. The images are small, and the hall is 13 × 10 m with a depth camera that sees 5 m: with 160×120 the
  camera is lost for a tenth to a fifth of the frames in the hall and the corridor, and most of the error is of the ways that were not
  seen. The patrols of 320×240, and those at the desk and on the stairs, say more about the map.
- **placed**: share of the poses of which the map knows the place in the end. The ATE of both are of these poses.
- **loops**: those that joined the graph; each was compared with the true poses when it joined. **wrong**: farther from the truth than
  0.15 m or 0.1 rad.
- **odometry**, **map**: RMSE of the position after alignment.""")
    rows, loops, wrong, better = [], 0, 0, []
    for room, one in found:
        ratio = one["map_ate_m"] / one["odometry_ate_m"] if one["odometry_ate_m"] else 1
        if one["recognised"]:
            better.append(ratio)
        loops += one["judged"]
        wrong += one["wrong"]
        rows.append([*names(room), f"{one['lost']}", percent(one["placed"], one["posed"]), f"{one['keyframes']}", f"{one['recognised']}",
                     f"{one['loops']}", f"{one['wrong']}",
                     f"{1000 * one['loop_median_m']:.0f} / {1000 * one['loop_max_m']:.0f}" if one["judged"] else "–",
                     f"{1000 * one['odometry_ate_m']:.0f}", f"{1000 * one['map_ate_m']:.0f}", f"{ratio:.2f}"])
    table(["room", "light", "seed", "image", "lost", "placed", "keyframes", "times seen again", "loops", "wrong", "error of a loop: median / max mm",
           "ATE odometry mm", "ATE map mm", "map / odometry"], rows, 2)
    print(f"\nOf {loops} loops {wrong} are wrong. Of {len(found)} patrols {len(better)} saw a place again; in {sum(r <= 1 / 3 for r in better)} of "
          f"these the ATE of the map is at most a third of the odometry's, in {sum(r > 1 for r in better)} it is greater.")


def bins(pairs, column, edges):
    """(distance bin, angle bin) -> the pairs."""
    cells = {}
    for pair in pairs:
        d = sum(pair[column] >= edge for edge in edges) - 1
        a = min(sum(pair[2] >= edge for edge in DEGREES), len(DEGREES) - 1) - 1
        if d < len(edges) - 1:
            cells.setdefault((d, a), []).append(pair)
    return cells


def recall_table(pairs, column, edges, unit):
    cells = bins(pairs, column, edges)
    rows = []
    for d in range(len(edges) - 1):
        row = [f"{edges[d]:g} to {edges[d + 1]:g}{unit}"]
        for a in range(len(DEGREES) - 1):
            some = cells.get((d, a), [])
            row.append(percent(sum(p[3] for p in some), len(some)) if len(some) >= LEAST_PAIRS else "–")
        rows.append(row)
    table(["distance", *(f"{DEGREES[a]} to {DEGREES[a + 1]}°" for a in range(len(DEGREES) - 1))], rows)


def recall(found, views):
    print(f"""
## Which views are recognised

`LoopCheck` compares a view of a sequence with another one of the same room: up to a whole depth of the scene away, in any direction
that is free, and turned about the vertical by up to 60°. The depth of the scene is the median of the view's points. {views} views of each
sequence, a pair in each cell. The camera sees 63° of the room: turned by 30°, half of the view is a new one. Under the varying light the second view is of another time, when the lamp hangs otherwise. Shares of fewer than
{LEAST_PAIRS} pairs are left out. In the map three pairs must agree, so a place is recognised less often than a pair is accepted.

![share of accepted pairs over the distance, one curve for each angle]({PICTURE})""")
    for light in ("constant", "varying"):
        rooms = [(room, one) for room, one in found if room in ROOMS and room[1] == light]
        pairs = [pair for _, one in rooms for pair in one["pairs"]]
        print(f"\n### {light.capitalize()} light\n\n{len(pairs)} pairs of "
              + ", ".join(f"{room[0]} ({room[3]}×{room[3] * 3 // 4})" for room, _ in rooms) + ", by the distance as a share of the scene's depth:")
        recall_table(pairs, 0, SHARES, "")
        print("\nThe same by the distance in metres:")
        recall_table(pairs, 1, METRES, " m")
    print("\nRoom by room. **near**: pairs within 0.2 of the depth and 20°. **wrong**: accepted pairs farther from the truth than 0.15 m or 0.1 rad, "
          "before any other test of the map. A smaller image has fewer points, and a loop needs 20 inliers.")
    rows = []
    for room, one in found:
        near = [pair for pair in one["pairs"] if pair[0] < 0.2 and pair[2] < 20]
        accepted = [pair for pair in one["pairs"] if pair[3]]
        rows.append([room[0], room[1], f"{room[3]}×{room[3] * 3 // 4}", percent(sum(pair[3] for pair in near), len(near)), f"{len(one['pairs'])}",
                     f"{len(accepted)}", f"{sum(pair[4] for pair in accepted)}"])
    table(["room", "light", "image", "near: accepted", "pairs", "accepted", "wrong"], rows, 2)


def draw(found, path):
    """The curves of both lights, in two plots."""
    width, height, left, top = 330, 230, 46, 34
    colours = ["#1b4f9c", "#2a9d8f", "#c98a00", "#d1495b", "#7a5195"]
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * (width + left) + 30} {height + top + 74}" font-family="sans-serif" '
             'font-size="12">', '<rect width="100%" height="100%" fill="white"/>']
    for panel, light in enumerate(("constant", "varying")):
        x0 = left + panel * (width + left + 14)
        x, y = (lambda share: x0 + width * share), (lambda part: top + height * (1 - part))
        parts.append(f'<text x="{x0 + width / 2:.0f}" y="20" text-anchor="middle" font-weight="bold">{light} light</text>')
        for part in (0, 0.25, 0.5, 0.75, 1):
            parts.append(f'<line x1="{x0}" x2="{x0 + width}" y1="{y(part):.1f}" y2="{y(part):.1f}" stroke="#ddd"/>'
                         f'<text x="{x0 - 6}" y="{y(part) + 4:.1f}" text-anchor="end">{100 * part:.0f} %</text>')
        for share in (0, 0.2, 0.4, 0.6, 0.8, 1):
            parts.append(f'<text x="{x(share):.1f}" y="{top + height + 16}" text-anchor="middle">{share:g}</text>')
        parts.append(f'<text x="{x0 + width / 2:.0f}" y="{top + height + 34}" text-anchor="middle">distance / depth of the scene</text>')
        cells = bins([pair for room, one in found if room in ROOMS and room[1] == light for pair in one["pairs"]], 0, SHARES)
        for a, colour in enumerate(colours):
            points = [((SHARES[d] + SHARES[d + 1]) / 2, statistics.fmean(p[3] for p in cells[d, a]))
                      for d in range(len(SHARES) - 1) if len(cells.get((d, a), [])) >= LEAST_PAIRS]
            line = " ".join(f"{x(share):.1f},{y(part):.1f}" for share, part in points)
            parts.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
            parts += [f'<circle cx="{x(share):.1f}" cy="{y(part):.1f}" r="3" fill="{colour}"/>' for share, part in points]
    for a, colour in enumerate(colours):
        x0, y0 = left + 120 * a, top + height + 58
        parts.append(f'<line x1="{x0}" x2="{x0 + 24}" y1="{y0 - 4}" y2="{y0 - 4}" stroke="{colour}" stroke-width="3"/>'
                     f'<text x="{x0 + 30}" y="{y0}">{DEGREES[a]}° to {DEGREES[a + 1]}°</text>')
    path.write_text("\n".join([*parts, "</svg>\n"]), encoding="utf-8")


def carried(found, trials):
    print(f"""
## Carried to a mapped place

A map of 600 frames of a sequence; then {trials} times ({CARRIED_LARGE} times with {LARGE}×{LARGE * 3 // 4}) the camera is put beside this trajectory, up to 0.3 m to each side and ahead, 0.1 m up or down, turned by
up to 10° to the side and 5° otherwise, and moves on. **carried**: it saw the beginning of the sequence, and was covered for a minute. The
odometry may find itself by the keyframe that it kept. **switched on**: the odometry begins there, with the map from a file: the map alone
must find the place. It is found in the first frame in which the map knows its position within 0.1 m (one standard deviation).

- **wrong**: a loop that is farther from the truth than 0.15 m or 0.1 rad.
- **sure too early**: trials in which the stated pose was that far from the truth when the place was found, and for how many frames at most.
- **error**: distance of the camera in the map from the truth, of those that were found; with the drift of the map.""")
    rows, bad, sums = [], 0, {}
    for room, one in found:
        size = f"{room[3]}×{room[3] * 3 // 4}"
        for kind, how in (("dark", "carried"), ("anew", "switched on")):
            some = one[kind]
            seen = sorted(trial[0] for trial in some if trial[0])
            early = [trial for trial in some if trial[4]]
            errors = [trial[5] for trial in some if trial[0]]
            total, in_ten = sums.get(size, (0, 0))
            sums[size] = total + len(some), in_ten + sum(n <= 10 for n in seen)
            bad += sum(trial[1] > 0 for trial in some)
            rows.append([room[0], room[1], how, size, f"{one['keyframes']}",
                         *(percent(sum(n <= most for n in seen), len(some)) for most in (1, 6, 10, 30)),
                         f"{statistics.median(seen):.0f}" if seen else "–",
                         f"{sum(trial[1] > 0 for trial in some)}", f"{len(early)}" + (f" ({max(trial[4] for trial in early)})" if early else ""),
                         f"{1000 * statistics.median(errors):.0f} / {1000 * max(errors):.0f}" if errors else "–"])
    table(["room", "light", "how", "image", "keyframes", "found in frame 1", "within 6", "within 10", "within 30", "median frame", "wrong",
           "sure too early (frames)", "error: median / max mm"], rows, 3)
    each = "; ".join(f"{in_ten} of {total} ({percent(in_ten, total)}) at {size}" for size, (total, in_ten) in sums.items())
    print(f"\nFound within 10 frames: {each}. In {bad} trials a wrong loop joined.")


def soak(found, amount):
    print("""
## Round and round

The images of a round of 400 frames, rendered once, seen again and again. The errors are the RMS distances of the positions from the
truth in the frame of the first pose, of all frames of a round as the map knew them then, without alignment. **memory**: anonymous
resident memory of the process after the round.""")
    for room, one in found:
        rounds = one["rounds"]
        told = sorted({1, 2, 3, 5, 10, 20, 50, 100, 200, len(rounds)} & set(range(1, len(rounds) + 1)))
        print(f"\n{room[0].capitalize()}, {room[3]}×{room[3] * 3 // 4}, {amount} frames, a map of {one['capacity']} keyframes:")
        table(["round", "lost", "keyframes", "loops so far", "odometry mm", "map mm", "memory MB"],
              [[f"{n}", f"{r[1]}", f"{r[2]}", f"{r[3]}", f"{1000 * r[4]:.1f}", f"{1000 * r[5]:.1f}", f"{r[6] / 1e6:.2f}"]
               for n in told for r in [rounds[n - 1]]])
        print(f"\nThe greatest error of a round in the map is {1000 * max(r[5] for r in rounds):.1f} mm. After the second round the memory grew by "
              f"{rounds[-1][6] - rounds[min(1, len(rounds) - 1)][6]} bytes.")


def cost(found, amount):
    print("""
## Time of a frame

A closed trajectory, round after round until a map of 256 keyframes is full or for twenty rounds; then one more round is measured. For that the map
is loaded and the round tracked five times, and of each frame the least CPU time counts: the work is the same to the bit, so what is more was
other work of the machine. After the map is loaded, the camera must first be found, which makes more comparisons than usual. **new**: share of the frames that are a keyframe.""")
    rows = []
    for room, one in found:
        track, one_map, both = one["track"], one["map"], one["both"]
        rows.append([room[0], f"{room[3]}×{room[3] * 3 // 4}", f"{one['keyframes']}", percent(one["joined"], amount),
                     f"{track[0]:.2f}", f"{both[0]:.2f}", f"{both[0] / track[0]:.2f}", f"{both[1] / track[1]:.2f}", f"{track[2] / track[0]:.2f}",
                     f"{both[2] / track[0]:.2f}", f"{both[2] / both[0]:.2f}", f"{one_map[3]:.2f}"])
    table(["room", "image", "keyframes", "new", "median ms, without", "median ms, with", "with / without: median", "mean", "p99 / median, without",
           "p99 with / median without", "p99 / median, with", "the map at most ms"], rows)


def main():
    program, work, options = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3:]
    work.mkdir(parents=True, exist_ok=True)
    quick = "--quick" in options
    todo = [job for job in jobs(quick) if "--measured" not in options or path_of(work, job).exists()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(lambda job: measure(program, work, job), [job for job in todo if job[0] != "cost"]))
    for study, tell in (("patrol", patrols), ("recall", recall), ("carried", carried), ("soak", soak), ("cost", cost)):
        if found := [(job[1], measure(program, work, job)) for job in todo if job[0] == study]:
            tell(found, AMOUNTS[study][quick])
        if study == "recall":
            draw(found, work / PICTURE)


if __name__ == "__main__":
    main()
