# SPDX-License-Identifier: Apache-2.0
"""Checks the rules of plvo that need only the text: licence lines; the headers and functions that core and hal may use; no
internal names of Eigen; no path of a developer's machine. Also prints a report of file sizes."""
import pathlib
import re
import statistics
import sys

import sources

SPDX = "SPDX-License-Identifier: Apache-2.0"

# Headers that need neither an operating system nor a heap.
STANDARD_HEADERS = {
    "algorithm", "array", "bit", "cassert", "compare", "concepts", "cstddef", "cstdint", "cstring", "initializer_list",
    "iterator", "limits", "new", "numeric", "optional", "span", "string_view", "tuple", "type_traits", "utility",
}
EIGEN_HEADERS = {"Eigen/Core", "Eigen/LU", "Eigen/Cholesky", "Eigen/Geometry", "Eigen/SVD", "Eigen/Eigenvalues", "Eigen/QR"}

FORBIDDEN = {
    r"\b(?:malloc|calloc|realloc|aligned_alloc|posix_memalign)\s*\(": "takes memory from the heap",
    r"(?<![\w.>])free\s*\(": "gives memory to the heap",
    r"\bnew\b(?!\s*\()": "takes memory from the heap (placement new is the only one allowed)",
    r"\bdelete\b(?<!= delete)": "gives memory to the heap",
    r"\b(?:throw|try|catch)\b": "exceptions",
    r"\b(?:dynamic_cast|typeid)\b": "run-time type information",
    r"\b(?:v?s?n?f?printf|puts|fopen|getenv|abort|exit|errno|time|rand|srand)\s*\(": "needs an operating system",
    r"\bstd::(?:vector|string|function|map|set|unordered_\w+|list|deque|unique_ptr|shared_ptr|stringstream|cout|cerr|any)\b":
        "takes memory from the heap",
    r"\bstd::(?:stable_sort|inplace_merge|stable_partition)\b": "takes memory from the heap",
    r"\bstd::(?:thread|mutex|atomic\w*|chrono)\b": "the core is single-threaded and reads no clock",
    r"\bthread_local\b": "state outside the caller's block",
    r"\bstd::(?:sin|cos|tan|asin|acos|atan2?|sinh|cosh|tanh|exp2?|expm1|log(?:2|10|1p)?|pow|cbrt|hypot|erfc?|[lt]gamma|fma)f?\b":
        "differs from one C library to the next: use plvo/math/trigonometry.hpp",
    r"\b__m(?:128|256|512)|\bfloat32x4_t\b|\b_mm\d*_": "intrinsics of one processor",
    r"\b(?:noexcept\s*\(\s*false)": "exceptions",
}

# Names of a library that it may change in any release. A specialisation of them in some files alone would be undefined.
INTERNALS = {
    r"\bEigen\s*::\s*internal\b": "Eigen's own names: use what its documentation describes",
    r"\bnamespace\s+Eigen\b": "specialises or adds to Eigen: use what its documentation describes",
}

# Split so that this file does not match itself.
TRACES = re.compile("/" + r"(?:home|root|Users|tmp/(?:wt|bash|hub)|work)/")


def check_licences(root):
    for path in sources.files(root, suffixes=sources.CODE + sources.SCRIPTS + ("CMakeLists.txt",)):
        head = path.read_text(encoding="utf-8").splitlines()[:2]
        if not any(SPDX in line for line in head):
            yield f"{path.relative_to(root)}:1: the first line must say {SPDX}"


def check_core(root):
    for path in sources.files(root, ("core", "hal")):
        name = path.relative_to(root).as_posix()
        text = path.read_text(encoding="utf-8")
        for number, kind, header in sources.includes(text):
            allowed = STANDARD_HEADERS | EIGEN_HEADERS
            if kind == "angle" and header not in allowed:
                yield f"{name}:{number}: <{header}> is not for core and hal"
        for number, line in enumerate(sources.code_only(text).splitlines(), 1):
            line = re.sub(r"^\s*#\s*include.*", "", line)
            for pattern, why in FORBIDDEN.items():
                match = re.search(pattern, line)
                if match and not (match.group(0) == "delete" and re.search(r"=\s*delete", line)):
                    yield f"{name}:{number}: {match.group(0).strip()}: {why}"


def check_internals(root):
    for path in sources.files(root):
        for number, line in enumerate(sources.code_only(path.read_text(encoding="utf-8")).splitlines(), 1):
            for pattern, why in INTERNALS.items():
                if re.search(pattern, line):
                    yield f"{path.relative_to(root)}:{number}: {why}"


def check_traces(root):
    for path in sources.files(root, suffixes=sources.CODE + sources.SCRIPTS + ("CMakeLists.txt", ".md", ".html", ".js")):
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if TRACES.search(line):
                yield f"{path.relative_to(root)}:{number}: a path of one machine: {line.strip()}"


def check(root):
    root = pathlib.Path(root)
    return [*check_licences(root), *check_core(root), *check_internals(root), *check_traces(root)]


def sizes(root):
    """Returns a report, not a rule: the design aims at a median of 110 to 150 lines and few files above 400."""
    count = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in sources.files(root)}
    if not count:
        return "no files"
    lines = [f"{len(count)} files, {sum(count.values())} lines, median {statistics.median(count.values()):.0f}"]
    long = sorted((n, path) for path, n in count.items() if n > 400)
    lines += [f"  {n:5d} lines: {path.relative_to(root)}" for n, path in reversed(long)]
    return "\n".join(lines)


def main():
    code = sources.report(check(sys.argv[1]), "every rule is kept")
    print(sizes(sys.argv[1]))
    return code


if __name__ == "__main__":
    sys.exit(main())
