# SPDX-License-Identifier: Apache-2.0
"""Reads the call graphs that GCC writes beside its objects (-fcallgraph-info=su,da, one .ci file a source) and finds the
deepest stack that a function can need. What has no bound is an error: recursion, arrays of a size known only at run time,
a function without a call graph, an indirect call without stated targets."""
import pathlib
import re

# What the graphs have no frames of: the compiler's own arithmetic and the five block functions. Their largest frame, of
# libgcc's 64-bit division, is 48 bytes on the Cortex-M7; this is what is counted for any of them.
LEAF_BYTES = 64
LEAVES = re.compile(r"__(?:aeabi_|u?div|u?mod|float|fix)\w*$|(?:memcpy|memmove|memset|memcmp|bcmp|strlen)$")

# (which callers, which functions they may reach through a pointer or a virtual table; None: the user's own, not counted)
INDIRECT = [
    (re.compile(r"StageTimer"), None),  # Config::stage_clock
    (re.compile(r"Executor5start"), None),  # Config::executor: the second core has a stack of its own
    (re.compile(r"LevenbergMarquardt.*@lines"), re.compile(r"LmAnyProblem.*EndDepths.*_FUN")),
    (re.compile(r"LevenbergMarquardt"), re.compile(r"LmAnyProblem.*MotionProblem.*_FUN")),
    (re.compile(r"plvo10contradict"), re.compile(r"11contradicts")),
    (re.compile(r"Ransac|MotionProblem|estimate_motion|5solveESt4span|5count|8estimate|11find_shifts|8shift_of"), re.compile(r"_ZNK?4plvo\d+[A-Z]\w*Constraints?S?\d")),
]

# (caller, callee, mark): what it calls from there is not what it calls from elsewhere, so it counts as a function of its own.
APART = [(re.compile(r"fit_line3d"), re.compile(r"LevenbergMarquardt.*3run"), "@lines")]

# A function that one file alone knows has its object's name before its own.
NODE = re.compile(r'node: \{ title: "(?:[^"]*:)?([^":]+)" label: "(.*?)"( shape : ellipse)? \}')
EDGE = re.compile(r'edge: \{ sourcename: "(?:[^"]*:)?([^":]+)" targetname: "(?:[^"]*:)?([^":]+)"')
FRAME = re.compile(r"(\d+) bytes \(([^)]*)\)")


class CallGraph:
    def __init__(self):
        self.frame, self.calls, self.names, self.errors = {}, {}, {}, []
        self.indirect = set()

    def read(self, path):
        self.read_text(pathlib.Path(path).read_text(encoding="utf-8"))
        return self

    def read_text(self, text):
        for title, label, outside in NODE.findall(text):
            if outside:
                continue
            size, kind = FRAME.search(label).groups()
            if kind != "static":
                self.errors.append(f"{label.splitlines()[0]}: its frame is {kind}")
            # A function that several sources instantiated: any of its copies may be the one that is linked.
            self.frame[title] = max(int(size), self.frame.get(title, 0))
            self.names[title] = label.split("\\n")[0]
        for source, target in EDGE.findall(text):
            self.calls.setdefault(source, set()).add(target)
        for caller, callee, mark in APART:
            for source in [name for name in self.calls if caller.search(name)]:
                for target in [name for name in self.calls[source] if callee.search(name)]:
                    self.calls[source] = self.calls[source] - {target} | {target + mark}
                    for table in (self.frame, self.names, self.calls):
                        table[target + mark] = table[target]

    def body(self, function):
        """The complete constructor or destructor that a call names is the base object's, when nothing is virtual."""
        if function not in self.frame:
            for complete, base in (("C1E", "C2E"), ("D1E", "D2E")):
                if function.replace(complete, base, 1) in self.frame:
                    return function.replace(complete, base, 1)
        return function

    def targets(self, function):
        for target in sorted(self.calls.get(function, ())):
            if target != "__indirect_call":
                yield self.body(target)
                continue
            self.indirect.add(function)
            rule = next(((caller, to) for caller, to in INDIRECT if caller.search(function)), None)
            if rule is None:
                self.errors.append(f"{self.name(function)}: an indirect call; name its targets in INDIRECT")
            elif rule[1] is not None:
                found = [name for name in self.frame if rule[1].search(name)]
                if not found:
                    self.errors.append(f"{self.name(function)}: no function matches the targets of its indirect call")
                yield from found

    def name(self, function):
        return self.names.get(function, function)

    def deepest(self, root):
        """(bytes, [(function, its frame) from the root down]); fills errors."""
        known, path = {}, []

        def visit(function):
            if function in path:
                ring = path[path.index(function):] + [function]
                self.errors.append("recursion: " + " -> ".join(self.name(f) for f in ring))
                return 0, []
            if function in known:
                return known[function]
            if function not in self.frame:
                if LEAVES.match(function):
                    return LEAF_BYTES, [(function, LEAF_BYTES)]
                self.errors.append(f"{function}: called by {self.name(path[-1])}, but in no call graph")
                return 0, []
            path.append(function)
            below = max((visit(target) for target in self.targets(function)), key=lambda r: r[0], default=(0, []))
            path.pop()
            known[function] = (self.frame[function] + below[0], [(function, self.frame[function]), *below[1]])
            return known[function]

        roots = [name for name in self.frame if re.search(root, name)]
        if len(roots) != 1:
            raise SystemExit(f"{root}: {len(roots)} functions of that name")
        return visit(roots[0])
