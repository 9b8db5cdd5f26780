# SPDX-License-Identifier: Apache-2.0
"""Names and words that were replaced by standard terms stay out of code, comments and pages (docs/theory/notation.md has the terms).
CHANGELOG.md may name them, as may golden files, the fuzzers' seeds, and the tests of this check."""
import pathlib
import re
import sys

import sources

# Old word -> the term to use.
# Names: parts of identifiers as they are written here (a word in snake_case also in CamelCase). In prose they may have a plain meaning.
NAMES = {
    "kNobody": "kNoFrame", "MidExposure": "RowTimeCompensation", "own_surface": "depth_mask", "house": "plvo, the modules, or architecture",
    "TrackResult::returned": "relocalised", "turning_rad_per_s": "angular_rate_error_rad_per_s", "new_piece": "restarted",
    "sensed_motion": "PropagatedPrior", "held_pose": "PoseWithCovariance", "gravity_hold": "GravityFilter",
}
# Words: in prose and in names, with a hyphen, in snake_case or in CamelCase; with the endings of a noun or a verb; across the end of a line.
WORDS = {
    "front door": "public API", "carve": "allocate", "lane": "SIMD vector, or an element of one", "small code": "size-optimised code",
    "side by side": "in parallel, or adjacent, or in one table", "shared error": "nuisance parameter", "repeated share": "common-mode share",
    "look back": "relocalise", "piece of the trajectory": "restart", "never move": "zero-motion baseline", "unseen": "unobserved, or process noise",
    "errs": "has an error", "erred": "had an error", "convince": "is accepted", "luggage": "what is carried",
    "clock of the wall": "real time", "walk": "sequence, or recording",
}
# What is meant as it is said: the mathematical term, the person of the simulator, a case of the bench that docs/results repeats.
BETWEEN = r"(?:\s|//|#)+"
MEANT = re.compile(f"(?:random|gyro{BETWEEN}offset){BETWEEN}walk|walking{BETWEEN}person|a person walks ahead")
SUFFIXES = (*sources.CODE, *sources.SCRIPTS, ".pyi", ".js", ".html", ".in", ".txt", ".yaml", ".json")
NOT_SEARCHED = ("CHANGELOG.md", "tests/architecture/words.py", "tests/golden/golden.txt", "tests/fuzz/seeds/", "tests/architecture/self_test.py")


def name_pattern(name):
    forms = [("" if name[0].isupper() else "(?<![A-Za-z0-9])") + re.escape(name)]
    if name.islower():
        forms.append("".join(part.capitalize() for part in name.split("_")))
    return re.compile(f"(?:{'|'.join(forms)})(?![a-z0-9])")


def word_pattern(words):
    def inflected(word):
        return word[:-1] + "(?:e|es|ed|ing)" if word.endswith("e") else word + "(?:s|es|ed|ing)?"
    return re.compile(r"\b" + BETWEEN.join(map(inflected, words.split())) + r"\b")


def in_words(text):
    """Returns the text in small letters, with a space between the words of a name; the ends of the lines do not change."""
    return MEANT.sub(lambda meant: "\n" * meant[0].count("\n"), re.sub(r"[_-]|(?<=[a-z0-9])(?=[A-Z])", " ", text).lower())


def pages_and_lists(root):
    yield from sorted((*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("docs/**/*.ipynb"), *root.glob("debian/*.*"), *root.glob("*.txt"), *root.glob("*.json")))


def check(root):
    root = pathlib.Path(root)
    names = [(name, term, name_pattern(name)) for name, term in NAMES.items()]
    words = [(word, term, word_pattern(word)) for word, term in WORDS.items()]
    errors = []
    for path in (*sources.files(root, suffixes=SUFFIXES), *pages_and_lists(root)):
        file = path.relative_to(root).as_posix()
        if file.startswith(NOT_SEARCHED):
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        for searched, patterns in ((text, names), (in_words(text), words)):
            for old, term, pattern in patterns:
                for match in pattern.finditer(searched):
                    errors.append(f"{file}:{searched.count(chr(10), 0, match.start()) + 1}: \"{old}\": say {term}")
    return errors


if __name__ == "__main__":
    sys.exit(sources.report(check(sys.argv[1]), "no word that was replaced is back"))
