# SPDX-License-Identifier: Apache-2.0
"""Tests that the checks of plvo can fail: each check gets a synthetic tree that breaks its rule."""
import pathlib
import tempfile
import unittest

import dependencies
import figures
import links
import paths
import ran
import rules
import words

LICENCE = "// SPDX-License-Identifier: Apache-2.0\n"


class Tree:
    """A small source tree in a temporary folder."""

    def __init__(self, contents):
        self._folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self._folder.name)
        for name, text in contents.items():
            path = self.root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")

    def __enter__(self):
        return self.root

    def __exit__(self, *_):
        self._folder.cleanup()


def include(*headers):
    return LICENCE + "".join(f'#include "{header}"\n' for header in headers)


GOOD = {
    "core/plvo/base/status.hpp": include(),
    "core/plvo/math/se3.hpp": include("plvo/base/status.hpp"),
    "core/plvo/points/match.hpp": include("plvo/math/se3.hpp"),
    "core/plvo/lines/match.hpp": include("plvo/base/status.hpp"),
    "core/plvo/odometry/odometry.hpp": include("plvo/points/match.hpp", "plvo/lines/match.hpp", "plvo/base/status.hpp"),
    "hal/plvo/hal/clock.hpp": include("plvo/base/status.hpp"),
    "platform/plvo/replay/replay.hpp": include("plvo/hal/clock.hpp", "plvo/odometry/odometry.hpp"),
    "tools/plvo/cli/main.cpp": include("plvo/replay/replay.hpp", "plvo/base/status.hpp"),
}


class Dependencies(unittest.TestCase):
    def found(self, extra):
        with Tree({**GOOD, **extra}) as root:
            return dependencies.check(root)

    def test_a_good_tree_passes(self):
        self.assertEqual(self.found({}), [])

    def test_every_forbidden_dependency_is_named(self):
        bad = {
            "core/plvo/base/up.hpp": "plvo/math/se3.hpp",
            "core/plvo/points/sideways.cpp": "plvo/lines/match.hpp",
            "core/plvo/lines/sideways.cpp": "plvo/points/match.hpp",
            "core/plvo/motion/sideways.cpp": "plvo/points/match.hpp",
            "core/plvo/math/far_up.cpp": "plvo/odometry/odometry.hpp",
            "core/plvo/base/to_hal.cpp": "plvo/hal/clock.hpp",
            "core/plvo/odometry/to_platform.cpp": "plvo/replay/replay.hpp",
            "hal/plvo/hal/to_platform.hpp": "plvo/replay/replay.hpp",
            "platform/plvo/replay/to_tools.cpp": "plvo/cli/run.hpp",
            "core/plvo/unlisted/new_module.cpp": "plvo/base/status.hpp",
            "tools/plvo/cli/nowhere.cpp": "plvo/missing/missing.hpp",
        }
        for path, header in bad.items():
            errors = self.found({path: include(header), "tools/plvo/cli/run.hpp": include()})
            self.assertTrue(any(error.startswith(path + ":2:") for error in errors), (path, errors))

    def test_unusual_spellings_are_found(self):
        for text in ('#include "../odometry/odometry.hpp"', '#include "odometry.hpp"', '# include <plvo/odometry/odometry.hpp>',
                     '  #  include   "plvo/odometry/odometry.hpp"  // why not'):
            self.assertTrue(self.found({"core/plvo/math/clever.cpp": LICENCE + text + "\n"}), text)

    def test_a_comment_is_not_an_include(self):
        text = LICENCE + '// #include "plvo/odometry/odometry.hpp"\n/* \n#include "plvo/lines/match.hpp"\n*/\n'
        self.assertEqual(self.found({"core/plvo/math/prose.cpp": text}), [])

    def test_a_cycle_between_modules_of_one_layer_is_named(self):
        errors = self.found({"platform/plvo/replay/a.cpp": include("plvo/host/b.hpp"),
                             "platform/plvo/host/b.hpp": include("plvo/replay/replay.hpp")})
        self.assertTrue(any("cycle" in error for error in errors), errors)


class Rules(unittest.TestCase):
    def found(self, name, text):
        with Tree({name: text}) as root:
            return rules.check(root)

    def test_a_good_file_passes(self):
        text = LICENCE + ('// new and delete, malloc() and std::vector in prose\n#include <array>\n#include <Eigen/Core>\n'
                          'const char* text = "throw";\nA(const A&) = delete;\nnew (first + i) T;\ndouble y = sqrt(x);\n')
        self.assertEqual(self.found("core/plvo/base/a.hpp", text), [])

    def test_a_missing_licence_is_named(self):
        for name in ("core/plvo/base/a.hpp", "tools/x.py", "platform/CMakeLists.txt", "tests/a_test.cpp", "tools/setup/x.sh"):
            self.assertTrue(self.found(name, "\n"), name)

    def test_every_forbidden_word_is_named(self):
        for line in ("#include <vector>", "#include <cmath>", "#include <iostream>", "#include <stdlib.h>", "p = malloc(8);",
                     "free(p);", "int* p = new int;", "auto p = new T[3];", "delete p;", "throw 1;", "try {", "printf(text);",
                     "std::vector<int> v;", "std::string s;", "std::function<void()> f;", "std::stable_sort(a, b);", "x = std::sin(y);",
                     "x = std::pow(y, 2);", "dynamic_cast<A*>(b);", "abort();", "thread_local int x;", "__m128 v;"):
            self.assertTrue(self.found("core/plvo/base/a.cpp", LICENCE + line + "\n"), line)
            self.assertTrue(self.found("hal/plvo/hal/a.hpp", LICENCE + line + "\n"), line)

    def test_other_layers_may_use_them(self):
        self.assertEqual(self.found("platform/plvo/host/a.cpp", LICENCE + "#include <vector>\nauto p = new int;\n"), [])

    def test_internals_of_eigen_are_named_in_every_layer(self):
        for line in ("Eigen::internal::traits<T> t;", "namespace Eigen::internal {", "namespace Eigen { namespace internal {",
                     "namespace Eigen {", "using namespace Eigen::internal;", "Eigen :: internal::evaluator<T> e;"):
            for name in ("core/plvo/math/a.hpp", "hal/plvo/hal/a.hpp", "platform/plvo/c/a.cpp", "tools/plvo/eval/a.cpp", "tests/math/a.cpp"):
                self.assertTrue(self.found(name, LICENCE + line + "\n"), (name, line))

    def test_public_names_of_eigen_pass(self):
        text = LICENCE + "// Eigen::internal in prose\nEigen::Matrix<double, 3, 3> M;\nnamespace plvo {}\n"
        self.assertEqual(self.found("core/plvo/math/a.hpp", text), [])

    def test_a_path_of_one_machine_is_named(self):
        self.assertTrue(self.found("tools/plvo/cli/a.cpp", LICENCE + 'auto p = "/' + 'home/somebody/data";\n'))


def entry(name, status="run", output=""):
    return f'<testcase name="{name}" status="{status}"><system-out>{output}</system-out></testcase>'


SKIPPED = entry("a_test", "notrun", """[  SKIPPED ] A.Here (12 ms)
[  PASSED  ] 3 tests.
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] A.Here
[  SKIPPED ] Kinds/A.There/0
""")


class Ran(unittest.TestCase):
    def errors(self, entries, may_skip=(), names=()):
        return list(ran.check(f"<testsuite>{''.join(entries)}</testsuite>", may_skip, names))

    def test_tests_that_ran_pass(self):
        self.assertEqual(self.errors([entry("a_test"), entry("fuzz_bag", output="no test was skipped")], names=["fuzz_bag"]), [])

    def test_tests_that_were_not_built_are_named(self):
        self.assertEqual(self.errors([entry("golden_test")], names=["golden_test", "fuzz_bag"]), ["fuzz_bag did not run"])

    def test_skipped_tests_did_not_run(self):
        self.assertIn("a_test did not run", self.errors([entry("a_test", "notrun")], may_skip=["a_test"], names=["a_test"]))

    def test_a_skip_that_the_list_does_not_name_is_named(self):
        errors = self.errors([SKIPPED], may_skip=["A.Here", "a_test"])
        self.assertEqual(len(errors), 1, errors)
        self.assertTrue(errors[0].startswith("Kinds/A.There/0 was skipped (a_test)"), errors)
        self.assertEqual(self.errors([SKIPPED], may_skip=["A.Here", "*/A.There/*"]), [])

    def test_skips_without_googletest_are_named(self):
        for skipped in (entry("b_test", "notrun", "SKIPPED: no Chromium here"), entry("b_test", "disabled"),
                        entry("b_test", output="sss  [100%]\n3 skipped in 0.01s"),
                        entry("b_test", output="..s  [100%]\n2 passed, 1 skipped in 0.01s")):
            self.assertEqual(len(self.errors([skipped])), 1, skipped)
            self.assertEqual(self.errors([skipped], may_skip=["b_test"]), [])

    def test_rows_of_the_list_apply_under_their_condition(self):
        text = "# why\nalways A.A  # why\nasan *.B\nno-shared C.C\n"
        self.assertEqual(ran.allowed(text, {"always", "release"}), {"A.A"})
        self.assertEqual(ran.allowed(text, {"always", "asan", "no-shared"}), {"A.A", "*.B", "C.C"})

    def test_every_row_of_the_list_is_a_test(self):
        tests = pathlib.Path(__file__).parent.parent
        text = "".join(path.read_text(encoding="utf-8") for path in tests.rglob("*") if path.suffix in (".cpp", ".txt")
                       and path != ran.ALLOWED)
        presets = ("asan", "tsan", "armhf", "armhf-neon", "no-shared", "no-root", "no-mount", "always")
        for name in ran.allowed(ran.ALLOWED.read_text(encoding="utf-8"), presets):
            suite, _, test = name.removeprefix("*/").partition(".")
            self.assertRegex(text, rf"{suite}, {test}\)" if test not in ("", "*") else rf"\b{suite}\b", name)


README = """
| sequence | plvo, mm per s | plvo, ° per s | best peer | its mm per s | time |
|---|---:|---:|---|---:|---:|
| rpy | 7.5 | 0.89 | OpenCV B | 20.0 | 0.17 |
| mean, constant | 1.4 | – | OpenCV B | 85.7 | – |
"""
RECORDINGS = """
| sequence | system | mm per s | ° per s | mm per frame | ° per frame | time |
|---|---|---:|---:|---:|---:|---:|
| rpy | *never moves* | 86.0 | 38 | 3 | 1 | – |
| rpy | **plvo, both** | 7.5 | 0.89 | 2.80 | 0.261 | 0.17 |
| rpy | OpenCV A | 36.2 | 2.32 | 7.45 | 0.441 | 1.00 |
| rpy | OpenCV B | 20.0 | 1.00 | 4.00 | 0.300 | 2.00 |

| sequence | system | mm/frame | °/frame | mm/s | °/s |
|---|---|---:|---:|---:|---:|
| rpy | plvo-both | 2.8 | 0.26 | 7.5 | 0.89 |
"""
LIGHTING = """
| site | light | *never moves* | plvo, points | **plvo, both** | A | B |
|---|---|---:|---:|---:|---:|---:|
| mean | constant | 504.5 | 1.3 | 1.4 | 113.1 | 85.7 |
"""


class Figures(unittest.TestCase):
    def found(self, readme=README, recordings=RECORDINGS, lighting=LIGHTING, **more):
        files = {"README.md": readme, "docs/results/recordings.md": recordings, "docs/results/lighting.md": lighting}
        with Tree({**files, **{f"docs/{name}.md": text for name, text in more.items()}}) as root:
            return figures.check(root)

    def test_equal_copies_and_a_page_that_refers_pass(self):
        self.assertEqual(self.found(memory="`track` takes 24,516 bytes of stack", porting="a [stack](memory.md#stack)"), [])

    def test_a_figure_on_another_page_is_named(self):
        for text in ("3. a stack: on a Cortex-M7\n20.9 KiB for `track`", "118 kB of flash", "code size (121 kB)",
                     "`Limits::tiny()` (489 KiB)", "0.4 of the\ninstructions", "a frame of 320×240 is 52 million instructions",
                     "The covariance is honest about it"):
            errors = self.found(porting="\n" + text + "\n")
            self.assertEqual(len(errors), 1, (text, errors))
            self.assertTrue(errors[0].startswith("docs/porting.md:2:"), errors)

    def test_a_copy_that_differs_is_named(self):
        for row in ("| 7.5 | 0.89 | OpenCV B", "| 0.17 |", "mean, constant | 1.4"):
            self.assertIn(row, README)
            self.assertEqual(len(self.found(readme=README.replace(row, row.replace("7", "8").replace("1.4", "1.5")))), 1, row)
        self.assertEqual(len(self.found(recordings=RECORDINGS.replace("0.26 ", "0.27 "))), 1)

    def test_a_peer_that_is_not_the_best_is_named(self):
        self.assertEqual(len(self.found(recordings=RECORDINGS.replace("36.2", "19.9"))), 2, "its name and its error")
        self.assertEqual(len(self.found(lighting=LIGHTING.replace("113.1", "80.0"))), 2)

    def test_a_sequence_that_is_not_in_the_results_is_named(self):
        self.assertEqual(len(self.found(readme=README.replace("| rpy", "| other"))), 1)

    def test_no_comparison_is_a_failure(self):
        self.assertTrue(self.found(readme="", recordings=""))


class Links(unittest.TestCase):
    PAGES = {"README.md": "# A\n[b](docs/b.md#two-words-c) [web](https://example.org/x) [here](#a) <a id=\"own\"></a>[there](#own)\n",
             "docs/b.md": "## Two words, `c`\n[up](../README.md) [again](#same-1)\n## Same\n## Same\n```sh\n# no heading\n[no](link.md)\n```\n"}

    def found(self, **changed):
        with Tree({**self.PAGES, **changed}) as root:
            return list(links.check_links(root))

    def test_valid_links_pass(self):
        self.assertEqual(self.found(), [])

    def test_broken_links_are_named(self):
        for bad in ("[x](docs/c.md)", "[x](docs/b.md#three)", "[x](#no-heading)", "[x](docs/b.md#no-heading)"):
            errors = self.found(**{"README.md": "# A\n" + bad})
            self.assertEqual(len(errors), 1, bad)
            self.assertTrue(errors[0].startswith("README.md:2:"), errors)

    def test_missing_links_of_the_readme_are_named(self):
        with Tree(self.PAGES) as root:
            self.assertEqual(len(list(links.check_readme(root))), len(links.FROM_README))


class Paths(unittest.TestCase):
    def found(self, text):
        with Tree({"core/plvo/math/se3.hpp": "", "core/plvo/math/se3.cpp": "", "docs/a.md": text}) as root:
            return paths.check(root)

    def test_paths_that_exist_pass(self):
        self.assertEqual(self.found("`core/plvo/math/` `core/plvo/math/se3.{hpp,cpp}`, `core/plvo/*/se3.hpp` `docs/a.md` `se2.hpp` core/no.hpp\n"
                                    "`core/plvo/NAME/se3.hpp`\n```sh\ncat `core/no.hpp`\n```\n"), [])

    def test_a_path_that_does_not_exist_is_named(self):
        for bad in ("core/plvo/math/se2.hpp", "core/plvo/math/se3.{hpp,h}", "core/plvo/*/so3.hpp", "tests/no_test.cpp", "cat docs/b.md"):
            errors = self.found(f"# A\n`{bad}`\n")
            self.assertEqual(len(errors), 1, (bad, errors))
            self.assertTrue(errors[0].startswith("docs/a.md:2:"), errors)


class Words(unittest.TestCase):
    def found(self, name, text):
        with Tree({name: text}) as root:
            return words.check(root)

    def test_other_words_and_exempt_files_pass(self):
        old = " ".join((*words.IDENTIFIERS, *words.PHRASES))
        self.assertEqual(self.found("CHANGELOG.md", old), [])
        self.assertEqual(self.found("tests/fuzz/seeds/tum/a.txt", old), [])
        self.assertEqual(self.found("tests/host/a_test.cpp", "TEST(A, IdleConnectionsLockNobodyOut) {}  // the houses"), [])

    def test_every_replaced_word_is_named(self):
        for old in (*words.IDENTIFIERS, *words.PHRASES):
            for name in ("docs/a.md", "core/plvo/base/a.hpp", "tests/CMakeLists.txt", "tools/a.py"):
                errors = self.found(name, f"// one\n// ({old}) two\n")
                self.assertEqual(len(errors), 1, (old, name, errors))
                self.assertTrue(errors[0].startswith(f"{name}:2:"), errors)
        self.assertEqual(len(self.found("core/plvo/base/a.hpp", "// by the " + "front" + "\n// door\n")), 1)


if __name__ == "__main__":
    unittest.main()
