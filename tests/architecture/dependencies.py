# SPDX-License-Identifier: Apache-2.0
"""Reads every #include and names each dependency between modules that the design forbids.

tools -> platform -> hal -> core; inside the core odometry -> points | lines | surfaces | motion -> image -> camera -> math
-> base. A dependency may skip layers downwards. Points, lines, surfaces and motion do not know each other. No cycle anywhere.
A path on disk is the include: "plvo/<module>/<file>.hpp" is the file <layer>/plvo/<module>/<file>.hpp of exactly one layer.
"""
import pathlib
import sys

import sources

# A module of the core may include the modules named here and itself.
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


LAYERS = ("core", "hal", "platform", "tools")


def modules_of(root):
    """module name -> layer, as an include names it: plvo/<module>/..."""
    modules = {}
    for layer in LAYERS:
        folder = pathlib.Path(root) / layer / "plvo"
        if folder.is_dir():
            modules.update({path.name: layer for path in sorted(folder.iterdir()) if path.is_dir()})
    return modules


def module_of(root, path):
    parts = path.relative_to(root).parts
    return parts[0], (parts[2] if len(parts) > 3 and parts[1] == "plvo" else parts[0])


def forbidden(layer, module, target_floor, target):
    """Why `module` may not include `target`, or None."""
    if module == target:
        return None
    if layer == "core":
        if target_floor != "core":
            return f"the core must not know {target_floor}/"
        if module not in BELOW:
            return f"module core/{module} is not in the design; give it a place in BELOW"
        if target not in BELOW[module]:
            return "the dependency runs up or sideways"
        return None
    if HEIGHT[target_floor] > HEIGHT[layer]:
        return f"{layer}/ must not know {target_floor}/"
    return None


def cycle(graph):
    """A list of modules that include each other in a ring, or None."""
    done, path = set(), []

    def visit(module):
        if module in path:
            return path[path.index(module):] + [module]
        if module in done:
            return None
        path.append(module)
        for target in sorted(graph.get(module, ())):
            found = visit(target)
            if found:
                return found
        path.pop()
        done.add(module)
        return None

    for module in sorted(graph):
        found = visit(module)
        if found:
            return found
    return None


def check(root):
    root = pathlib.Path(root)
    modules, graph, errors = modules_of(root), {}, []
    for path in sources.files(root, LAYERS):
        layer, module = module_of(root, path)
        for number, kind, header in sources.includes(path.read_text(encoding="utf-8")):
            where = f"{path.relative_to(root)}:{number}: {header}: "
            if not header.startswith("plvo/"):
                if kind == "quote" and not (path.parent / header).is_file():
                    errors.append(where + 'a header of plvo is included as "plvo/<module>/<file>.hpp"')
                elif kind == "quote" and layer in ("core", "hal"):
                    errors.append(where + 'include it as "plvo/<module>/<file>.hpp"')
                continue
            target = header.split("/")[1]
            if kind == "angle":
                errors.append(where + "a header of plvo is included with quotes")
            if target not in modules:
                errors.append(where + "there is no such module")
                continue
            if not (root / modules[target] / header).is_file() and header not in GENERATED:
                errors.append(where + f"there is no file {modules[target]}/{header}")
            why = forbidden(layer, module, modules[target], target)
            if why:
                errors.append(where + why)
            if target != module:
                graph.setdefault(module, set()).add(target)
    ring = cycle(graph)
    if ring:
        errors.append("a cycle of modules: " + " -> ".join(ring))
    return errors


def main():
    errors = check(sys.argv[1])
    print("\n".join(errors) if errors else "every dependency runs down")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
