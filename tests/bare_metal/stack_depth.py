# SPDX-License-Identifier: Apache-2.0
"""The deepest stack of the odometry's two calls: as GCC's call graphs bound it, and as a painted stack on the board saw it.
Both against docs/developer/memory.md, the bound against a ceiling.
stack_depth.py GRAPHS PAGE CEILING PROGRAM… runs PROGRAM…; stack_depth.py GRAPHS shows the deepest paths."""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "budget"))
import budget
from call_graph import CallGraph

# The form of track without a prior calls the form with one.
ROOTS = {"init": r"^_ZN4plvo8Odometry4initE\w*(\.|$)", "track": r"^_ZN4plvo8Odometry5trackERKNS_9RgbdFrameE(\.|$)"}


def show(graph, depths):
    for call, (depth, path) in depths.items():
        print(f"{call}: {depth} bytes at most")
        for function, frame in path:
            print(f"  {frame:6d}  {graph.name(function)[:150]}")
    print("indirect calls, with targets as call_graph.py names them:")
    for function in sorted(graph.indirect):
        print("  " + graph.name(function)[:150])


def main():
    graph = CallGraph().read(sys.argv[1])
    depths = {call: graph.deepest(root) for call, root in ROOTS.items()}
    errors = sorted(set(graph.errors))
    show(graph, depths)
    if len(sys.argv) > 2:
        page, ceiling, program = sys.argv[2], int(sys.argv[3]), sys.argv[4:]
        out = subprocess.run(program, capture_output=True, text=True, check=True).stdout
        seen = {call: int(depth) for call, depth in re.findall(r"(init|track) (\d+)", out)}
        figures = []
        for call in ROOTS:
            bound = depths[call][0]
            if seen[call] > bound:
                errors.append(f"{call} was seen to use {seen[call]} bytes of stack, beyond its bound of {bound}")
            figures += [(f"`{call}`, bound", bound, ceiling), (f"`{call}`, seen", seen[call], None)]
        if budget.check(page, figures):
            errors.append("the page and the figures differ")
    print("\n".join(errors) if errors else "no recursion, no frame of unknown size")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())
