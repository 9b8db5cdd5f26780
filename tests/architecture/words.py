# SPDX-License-Identifier: Apache-2.0
"""Names and words that were replaced by standard terms stay out of code, comments and pages (docs/theory/notation.md has the terms).
CHANGELOG.md may name them, as may golden files and the fuzzers' seeds."""
import pathlib
import re
import sys

import sources

# Old name or words, and the term to use. Identifiers match as whole words, also within snake_case.
IDENTIFIERS = {
    "kNobody": "kNoFrame", "SensedMotion": "PropagatedPrior", "HeldPose": "PoseWithCovariance", "GravityHold": "GravityFilter",
    "SharedErrors": "NuisanceParameters", "MidExposure": "RowTimeCompensation", "own_surface": "depth_mask",
    "side_by_side": "executor", "SideBySide": "Executor", "house_arrows": "dependencies", "tests/house": "tests/architecture",
    "TrackResult::returned": "relocalised", "look_back": "relocalisation", "repeated_share": "common_mode_share",
    "turning_rad_per_s": "angular_rate_error_rad_per_s", "unseen": "unobserved, or process noise", "new_piece": "restarted",
}
# Prose, in capitals or not, also across the end of a line.
PHRASES = {
    "front door": "public API", "carve": "allocate", "the house": "plvo, or the modules",
    "lane": "element of a SIMD vector", "lanes": "SIMD vector, or its elements", "small code": "size-optimised code",
    "side by side": "in parallel, or adjacent, or in one table", "shared errors": "nuisance parameters", "repeated share": "common-mode share",
    "look back": "relocalise", "looks back": "relocalises", "looked back": "relocalised",
    "piece of the trajectory": "restart", "pieces of the trajectory": "restarts",
    "a walk": "a sequence", "simulated walk": "simulated sequence", "simulated walks": "simulated sequences",
    "camera walks": "camera moves", "walking camera": "moving camera", "never moves": "zero-motion baseline",
    "errs": "has an error", "convinces": "is accepted", "luggage": "what is carried", "clock of the wall": "real time",
}
SUFFIXES = (*sources.CODE, *sources.SCRIPTS, ".js", ".html", ".in", ".txt", ".yaml", ".json")
NOT_SEARCHED = ("CHANGELOG.md", "tests/architecture/words.py", "tests/golden/golden.txt", "tests/fuzz/seeds/")


def patterns():
    for word, term in IDENTIFIERS.items():
        yield word, term, re.compile(rf"(?<![A-Za-z0-9]){re.escape(word)}(?![A-Za-z0-9])")
    for words, term in PHRASES.items():
        yield words, term, re.compile(r"\b" + r"(?:\s|//|#)+".join(words.split()) + r"\b", re.I)


def pages_and_lists(root):
    yield from sorted((*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("*.txt"), *root.glob("*.json")))


def check(root):
    root = pathlib.Path(root)
    searched = list(patterns())
    errors = []
    for path in (*sources.files(root, suffixes=SUFFIXES), *pages_and_lists(root)):
        name = path.relative_to(root).as_posix()
        if name.startswith(NOT_SEARCHED):
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        for words, term, pattern in searched:
            for match in pattern.finditer(text):
                errors.append(f"{name}:{text.count(chr(10), 0, match.start()) + 1}: \"{words}\": say {term}")
    return errors


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "no word that was replaced is back"))
