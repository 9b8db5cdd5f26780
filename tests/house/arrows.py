# SPDX-License-Identifier: Apache-2.0
"""Reads every #include and names each arrow between rooms that the design forbids.

tools -> platform -> hal -> core; inside the core odometry -> points | lines | surfaces | motion -> image -> camera -> math
-> base. An arrow may skip floors downwards. Points, lines, surfaces and motion do not know each other. No circle anywhere.
A path on disk is the include: "plvo/<room>/<file>.hpp" is the file <floor>/plvo/<room>/<file>.hpp of exactly one floor.
"""
import pathlib
import sys

import sources

# A room of the core may include the rooms named here and itself.
BELOW = {"base": []}
BELOW["math"] = ["base"]
BELOW["camera"] = ["base", "math"]
BELOW["image"] = ["base", "math", "camera"]
for _middle in ("points", "lines", "surfaces", "motion"):
    BELOW[_middle] = ["base", "math", "camera", "image"]
BELOW["odometry"] = ["base", "math", "camera", "image", "points", "lines", "surfaces", "motion"]
BELOW["inertial"] = [*BELOW["odometry"], "odometry"]

# Made by CMake from a page of HTML.
GENERATED = {"plvo/view/page.hpp"}

HEIGHT = {"core": 0, "hal": 1, "platform": 2, "tools": 3, "tests": 4}


FLOORS = ("core", "hal", "platform", "tools")


def rooms_of(root):
    """room name -> floor, as an include names it: plvo/<room>/..."""
    rooms = {}
    for floor in FLOORS:
        folder = pathlib.Path(root) / floor / "plvo"
        if folder.is_dir():
            rooms.update({path.name: floor for path in sorted(folder.iterdir()) if path.is_dir()})
    return rooms


def room_of(root, path):
    parts = path.relative_to(root).parts
    return parts[0], (parts[2] if len(parts) > 3 and parts[1] == "plvo" else parts[0])


def forbidden(floor, room, target_floor, target):
    """Why `room` may not include `target`, or None."""
    if room == target:
        return None
    if floor == "core":
        if target_floor != "core":
            return f"the core must not know {target_floor}/"
        if room not in BELOW:
            return f"room core/{room} is not in the design; give it a place in BELOW"
        if target not in BELOW[room]:
            return "the arrow runs up or sideways"
        return None
    if HEIGHT[target_floor] > HEIGHT[floor]:
        return f"{floor}/ must not know {target_floor}/"
    return None


def circle(graph):
    """A list of rooms that include each other in a ring, or None."""
    done, path = set(), []

    def visit(room):
        if room in path:
            return path[path.index(room):] + [room]
        if room in done:
            return None
        path.append(room)
        for target in sorted(graph.get(room, ())):
            found = visit(target)
            if found:
                return found
        path.pop()
        done.add(room)
        return None

    for room in sorted(graph):
        found = visit(room)
        if found:
            return found
    return None


def check(root):
    root = pathlib.Path(root)
    rooms, graph, errors = rooms_of(root), {}, []
    for path in sources.files(root, FLOORS):
        floor, room = room_of(root, path)
        for number, kind, header in sources.includes(path.read_text(encoding="utf-8")):
            where = f"{path.relative_to(root)}:{number}: {header}: "
            if not header.startswith("plvo/"):
                if kind == "quote" and not (path.parent / header).is_file():
                    errors.append(where + 'a header of the house is included as "plvo/<room>/<file>.hpp"')
                elif kind == "quote" and floor in ("core", "hal"):
                    errors.append(where + 'include it as "plvo/<room>/<file>.hpp"')
                continue
            target = header.split("/")[1]
            if kind == "angle":
                errors.append(where + "a header of the house is included with quotes")
            if target not in rooms:
                errors.append(where + "there is no such room")
                continue
            if not (root / rooms[target] / header).is_file() and header not in GENERATED:
                errors.append(where + f"there is no file {rooms[target]}/{header}")
            why = forbidden(floor, room, rooms[target], target)
            if why:
                errors.append(where + why)
            if target != room:
                graph.setdefault(room, set()).add(target)
    ring = circle(graph)
    if ring:
        errors.append("a circle of rooms: " + " -> ".join(ring))
    return errors


def main():
    errors = check(sys.argv[1])
    print("\n".join(errors) if errors else "every arrow runs down")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
