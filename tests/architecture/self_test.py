# SPDX-License-Identifier: Apache-2.0
"""Tests that the checks of plvo can fail: each check gets a synthetic tree that breaks its rule."""
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import dependencies
import figures
import layout
import links
import messages
import paths
import ran
import release
import results
import rules
import words

sys.path.append(str(pathlib.Path(__file__).parents[2] / "tools/plvo/bench"))
import update_results  # noqa: E402

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
| rpy | 7.5 | 0.89 | OpenCV ICPOdometry | 20.0 | 0.17 |
| mean, constant | 1.4 | – | OpenCV ICPOdometry | 85.7 | – |
"""
RECORDINGS = """
| sequence | system | mm/s | °/s | mm/frame | °/frame | time / RgbdOdometry |
|---|---|---:|---:|---:|---:|---:|
| rpy | zero motion | 86.0 | 38 | 3 | 1 | – |
| rpy | plvo-both | 7.5 | 0.89 | 2.80 | 0.261 | 0.17 |
| rpy | opencv-rgbd | 36.2 | 2.32 | 7.45 | 0.441 | 1.00 |
| rpy | opencv-icp | 20.0 | 1.00 | 4.00 | 0.300 | 2.00 |
"""
TABLE2 = """
| sequence | system | mm/frame | °/frame | mm/s | °/s |
|---|---|---:|---:|---:|---:|
| rpy | plvo-both | 2.8 | 0.26 | 7.5 | 0.89 |
"""
LIGHTING = """
| site | light | zero motion | plvo-points | plvo-both | opencv-rgbd | opencv-icp |
|---|---|---:|---:|---:|---:|---:|
| mean | constant | 504.5 | 1.3 | 1.4 | 113.1 | 85.7 |
"""


class Figures(unittest.TestCase):
    def found(self, readme=README, recordings=RECORDINGS, table2=TABLE2, lighting=LIGHTING, **more):
        files = {"README.md": readme, figures.RECORDINGS: recordings, figures.TABLE2: table2, figures.LIGHTING: lighting}
        with Tree({**files, **{f"docs/developer/{name}.md": text for name, text in more.items()}}) as root:
            return figures.check(root)

    def test_equal_copies_and_a_page_that_refers_pass(self):
        self.assertEqual(self.found(memory="`track` takes 24,516 bytes of stack", porting="a [stack](memory.md#stack)"), [])

    def test_a_figure_on_another_page_is_named(self):
        for text in ("3. a stack: on a Cortex-M7\n20.9 KiB for `track`", "118 kB of flash", "code size (121 kB)",
                     "`Limits::tiny()` (489 KiB)", "0.4 of the\ninstructions", "a frame of 320×240 is 52 million instructions",
                     "The covariance is honest about it"):
            errors = self.found(porting="\n" + text + "\n")
            self.assertEqual(len(errors), 1, (text, errors))
            self.assertTrue(errors[0].startswith("docs/developer/porting.md:2:"), errors)

    def test_a_copy_that_differs_is_named(self):
        for row in ("| 7.5 | 0.89 | OpenCV", "| 0.17 |", "mean, constant | 1.4"):
            self.assertIn(row, README)
            self.assertEqual(len(self.found(readme=README.replace(row, row.replace("7", "8").replace("1.4", "1.5")))), 1, row)
        self.assertEqual(len(self.found(table2=TABLE2.replace("0.26 ", "0.27 "))), 1)

    def test_a_peer_that_is_not_the_best_is_named(self):
        self.assertEqual(len(self.found(recordings=RECORDINGS.replace("36.2", "19.9"))), 2, "its name and its error")
        self.assertEqual(len(self.found(lighting=LIGHTING.replace("113.1", "80.0"))), 2)

    def test_a_sequence_that_is_not_in_the_results_is_named(self):
        self.assertEqual(len(self.found(readme=README.replace("| rpy", "| other"))), 1)

    def test_no_comparison_is_a_failure(self):
        self.assertTrue(self.found(readme="", table2=""))


class Results(unittest.TestCase):
    STAMPED = update_results.page("A", {"commit": "0123456789" * 4, "date": "2026-11-27", "machine": "two cores", "command": "`plvo_bench run a`",
                                        "written": "by `tools/plvo/bench/update_results.py`"}, "| a |\n|---|\n")
    INDEX = "[a](a.md)"

    def found(self, page=STAMPED, index=INDEX, decision="# B\n"):
        with Tree({"docs/results/a.md": page, "docs/results/README.md": index, "docs/decisions/b.md": decision,
                   "docs/decisions/README.md": "[b](b.md)"}) as root:
            return results.check(root)

    def test_a_stamped_page_passes(self):
        self.assertEqual(self.found(), [])

    def test_a_missing_entry_of_the_stamp_is_named(self):
        for entry in results.STAMP:
            errors = self.found(self.STAMPED.replace(f"- {entry}: ", f"- no {entry}: "))
            self.assertEqual(len(errors), 1, (entry, errors))
            self.assertIn(f"no {entry}", errors[0])
        self.assertEqual(len(self.found(self.STAMPED.replace("0123456789", "unknown"))), 1)

    def test_a_page_that_the_index_does_not_name_is_an_error(self):
        self.assertEqual(len(self.found(index="")), 1)

    def test_a_long_decision_is_named(self):
        self.assertEqual(self.found(decision="\n" * results.MOST_LINES), [])
        self.assertEqual(len(self.found(decision="\n" * (results.MOST_LINES + 1))), 1)

    def test_update_results_stamps_what_the_bench_prints(self):
        with Tree({"bin/plvo_bench": "#!/bin/sh\necho \"| opencv-rgbd |\"\necho\necho \"| $1 |\"\n", "data/x": "", "docs/results/README.md": "[t](table2.md)",
                   "docs/decisions/b.md": "", "docs/decisions/README.md": "[b](b.md)"}) as root:
            (root / "bin/plvo_bench").chmod(0o755)
            with mock.patch.object(update_results, "commit", lambda: "0123456789" * 4):
                update_results.main(["--bench", str(root / "bin"), "--data", str(root / "data"), "--work", str(root / "work"),
                                     "--out", str(root / "docs/results"), "table2"])
            page = (root / "docs/results/table2.md").read_text(encoding="utf-8")
            self.assertTrue(page.endswith("\n\n| tum |\n"), page)
            self.assertIn("- command: `plvo_bench tum fr1_rpy_150=tum-fr1 --systems ours,peers --out results/table2`", page)
            self.assertEqual(results.check(root), [])

    def test_update_results_keeps_a_page_whose_peers_were_not_measured(self):
        with Tree({"bin/plvo_bench": "#!/bin/sh\necho \"| plvo |\"\n", "data/x": "", "docs/results/table2.md": "as it was"}) as root:
            (root / "bin/plvo_bench").chmod(0o755)
            with self.assertRaisesRegex(SystemExit, "measured no opencv-rgbd: build it where OpenCV"):
                update_results.main(["--bench", str(root / "bin"), "--data", str(root / "data"), "--work", str(root / "work"),
                                     "--out", str(root / "docs/results"), "table2"])
            self.assertEqual((root / "docs/results/table2.md").read_text(encoding="utf-8"), "as it was")


class Links(unittest.TestCase):
    PAGES = {"README.md": "# A\n[b](docs/b.md#two-words-c) [web](https://example.org/x) [here](#a) <a id=\"own\"></a>[there](#own)\n",
             "docs/b.md": "## Two words, `c`\n[again](#same-1)\n## Same\n## Same\n```sh\n# no heading\n[no](link.md)\n```\n"}

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

    def test_a_link_out_of_docs_is_named(self):
        errors = self.found(**{"docs/b.md": self.PAGES["docs/b.md"] + "[x](../README.md)\n"})
        self.assertEqual(len(errors), 1)
        self.assertIn("not installed", errors[0])

    def test_missing_links_of_the_readme_are_named(self):
        with Tree(self.PAGES) as root:
            self.assertEqual(len(list(links.check_readme(root))), len(links.FROM_README))
            (root / "README.md").write_text("\n" * (links.README_LINES + 1), encoding="utf-8")
            self.assertEqual(len(list(links.check_readme(root))), len(links.FROM_README) + 1)


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


    def test_a_page_that_a_comment_names_must_exist(self):
        with Tree({"docs/a.md": "", "core/a.hpp": "// docs/a.md\n// docs/b.md\n"}) as root:
            self.assertEqual(paths.check(root), ["core/a.hpp:2: docs/b.md: there is no such page"])


class Messages(unittest.TestCase):
    SOURCE = 'fail("the file {} has " + n + " rows; "\n  "split it (share/doc/plvo/user/a.md#limits)");\n'
    PAGE = "| message | cause | remedy |\n|---|---|---|\n| `the file … has …`, `rows; split it` | `an option` of it | `no message here` |\n"

    def found(self, source=SOURCE, page=PAGE):
        with Tree({"tools/a.cpp": source + '// "a comment"\nsay("an option");\n', messages.PAGE: page, "docs/user/a.md": "## Limits\n"}) as root:
            return messages.check(root)

    def test_quotes_of_messages_pass(self):
        self.assertEqual(self.found(), [])

    def test_a_quote_that_no_message_has_is_named(self):
        for old, new in (("the file", "the folder"), ("split it", "join it"), ("an option", "a comment")):
            errors = self.found(page=self.PAGE.replace(old, new))
            self.assertEqual(len(errors), 1, (new, errors))
            self.assertTrue(errors[0].startswith(f"{messages.PAGE}:3:"), errors)

    def test_a_message_of_a_status_that_is_not_on_the_page_is_named(self):
        self.assertEqual(self.found(source=self.SOURCE + 'return {StatusCode::kIo, fmt::format("an option {}", x)};\n'), [])
        errors = self.found(source=self.SOURCE + 'return {StatusCode::kIo,\n        "the disk is full"};\n')
        self.assertEqual(len(errors), 1)
        self.assertIn('"the disk is full": give the message a row', errors[0])
        self.assertEqual(len(self.found(source=self.SOURCE + 'status.append("the disk is full");\n')), 1)
        self.assertEqual(self.found(source=self.SOURCE + 'status.append(", while the disk is full");\n'), [])

    def test_a_page_that_is_not_there_is_named(self):
        for new in ("user/b.md#limits", "user/a.md#other"):
            self.assertEqual(len(self.found(source=self.SOURCE.replace("user/a.md#limits", new))), 1, new)
        self.assertEqual(len(self.found(source=self.SOURCE.replace("share/doc/plvo", "docs"))), 1)


class Layout(unittest.TestCase):
    GOOD = {
        "core/plvo/math/se3.hpp": "",
        "tools/plvo/cli/main.cpp": "",
        "tests/math/se3_test.cpp": '#include "plvo/math/se3.hpp"\nTEST(A, B) {}\n',
        "tests/math/a.hpp": '#include "plvo/math/se3.hpp"\n',
        "tests/math/other_test.cpp": '#include "a.hpp"\n',
        "tests/cli/cli_run_test.cpp": "",
        "tests/accuracy/drift_test.py": "",
        "tests/architecture/self_test.py": "",
        "tests/budget/self_test.py": "",
    }
    ENTRIES = ("se3_test", "other_test.Alone", "cli_run_test", "drift_test", "golden_test")

    def found(self, more, entries=None):
        with Tree(self.GOOD | more) as root:
            return layout.check(root, entries)

    def test_a_good_layout_passes(self):
        self.assertEqual(self.found({}), [])
        self.assertEqual(self.found({}, self.ENTRIES), [])

    def test_a_file_without_an_entry_is_named(self):
        for k, name in enumerate(("se3_test", "other_test", "cli_run_test", "drift_test")):
            errors = self.found({}, self.ENTRIES[:k] + self.ENTRIES[k + 1:])
            self.assertEqual(len(errors), 1, errors)
            self.assertTrue(errors[0].endswith(f"there is no ctest entry {name}"), errors)

    def test_bad_places_and_names_are_named(self):
        header = self.GOOD["tests/math/se3_test.cpp"]
        for bad, text, words_of_error in (
                ("tests/tools/a_test.cpp", header, "there is no such module"),
                ("tests/slurm/array.sh", "", "there is no such module"),
                ("tests/math/more/a_test.cpp", header, "directly"),
                ("tests/cli/se3_test.cpp", header, "the same name"),
                ("tests/python/se3_test.py", "", "there is no such module"),
                ("tests/math/a_main.cpp", header, "is called *_test.cpp"),
                ("tests/math/a_test.cpp", '#include "plvo/base/a.hpp"\n', "no header of math")):
            errors = self.found({bad: text})
            self.assertTrue(any(words_of_error in error for error in errors), (bad, errors))


class Words(unittest.TestCase):
    OLD = (*words.NAMES, *words.WORDS)
    # In other forms than the lists have them.
    INFLECTED = ("carved", "carves", "Carving", "a convinced b", "side-by-side", "SideBySide", "run_side_by_side", "front-door", "two lanes",
                 "shared error", "shared errors", "SharedErrors", "RepeatedShare", "LookBack", "looked back", "look_back", "OwnSurface",
                 "Unseen", "kUnseen", "SmallCode", "small_code", "kMidExposure", "InvertsAtMidExposure", "never moved", "NeverMoves",
                 "HeldPose", "held_pose", "house_arrows", "HouseRules", "tests/house",
                 "walks", "--out walk", "walk/rgb.txt", "simulated walks", "walk_0.db3", "struct Walk")
    OTHER = ("IdleConnectionsLockNobodyOut", "the houses", "planes", "PlaneLine", "robot.lan", "small.code", "at_mid_exposure", "mid-exposure",
             "the keypoint's own surface", "gravity holds roll", "colPivHouseholderQr", "run.err", "the error", "a shared tracker", "moves",
             "a random walk", "a random\n// walk", "RandomWalk", "gyro_offset_walk", "WalkingPerson")

    def found(self, name, text):
        with Tree({name: text}) as root:
            return words.check(root)

    def test_other_words_and_exempt_files_pass(self):
        self.assertEqual(self.found("CHANGELOG.md", " ".join(self.OLD)), [])
        self.assertEqual(self.found("tests/fuzz/seeds/tum/a.txt", " ".join(self.OLD)), [])
        for other in self.OTHER:
            self.assertEqual(self.found("tests/host/a_test.cpp", f"// {other}\n"), [], other)

    def test_every_replaced_word_is_named(self):
        for old in (*self.OLD, *self.INFLECTED):
            for name in ("docs/a.md", "core/plvo/base/a.hpp", "tests/CMakeLists.txt", "tools/a.py"):
                errors = self.found(name, f"// one\n// ({old}) two\n")
                self.assertEqual(len(errors), 1, (old, name, errors))
                self.assertTrue(errors[0].startswith(f"{name}:2:"), errors)
        self.assertEqual(len(self.found("core/plvo/base/a.hpp", "// by the front\n// door\n")), 1)


class Release(unittest.TestCase):
    TREE = {
        "CMakeLists.txt": "project(plvo VERSION 1.2.3 LANGUAGES CXX)\n",
        "debian/changelog": "plvo (1.2.3) unstable; urgency=medium\n\n  * x\n\n -- A <a@b.c>  Sat, 28 Nov 2026 00:00:00 +0000\n",
        "CHANGELOG.md": "# Changes\n\n## Unreleased\n\n## 1.2.3 (2026-11-28)\n\n## 1.0.0\n",
        "platform/plvo/ros2/package.xml": "<package>\n  <version>1.2.3</version>\n</package>\n",
        "platform/plvo/ros2/CMakeLists.txt": "find_package(plvo 1.2 REQUIRED)\n",
        "debian/control": "Source: plvo\nBuild-Depends: debhelper-compat (= 13),\n               cmake,\n               a-dev <!cross>\n\nPackage: b\n",
        "tools/setup/packages.sh": 'PLVO_PACKAGES_BUILD="g++ cmake"\nPLVO_PACKAGES_PYTHON=""\nPLVO_PACKAGES_ROS="a-dev"\n',
    }

    def found(self, **changes):
        with Tree({**self.TREE, **{name: self.TREE[name].replace(*change) for name, change in changes.items()}}) as root:
            return release.check(root)

    def test_agreement_is_no_error(self):
        self.assertEqual(self.found(), [])

    def test_another_version_date_or_package_is_one(self):
        for name, change in (("CMakeLists.txt", ("1.2.3", "1.2.4")), ("CHANGELOG.md", ("(2026-11-28)", "")),
                             ("debian/changelog", ("28 Nov", "27 Nov")), ("platform/plvo/ros2/package.xml", ("1.2.3", "1.2.2")),
                             ("platform/plvo/ros2/CMakeLists.txt", ("1.2", "1.1")), ("debian/control", ("a-dev", "b-dev")),
                             ("tools/setup/packages.sh", ("cmake", "cmake c-dev"))):
            self.assertTrue(self.found(**{name: change}), name)


if __name__ == "__main__":
    unittest.main()
