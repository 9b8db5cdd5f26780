# SPDX-License-Identifier: Apache-2.0
"""The checks of the budget must be able to fail."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "bare_metal"))
import budget
import instructions
from call_graph import CallGraph

PAGE = "| what | bytes |\n|---|---:|\n| text | 1,000 |\n"


def node(name, frame, kind="static"):
    return f'node: {{ title: "{name}" label: "{name}\\nfile:1:1\\n{frame} bytes ({kind})\\n0 dynamic objects" }}\n'


def edge(source, target):
    return f'edge: {{ sourcename: "{source}" targetname: "{target}" label: "file:1:1" }}\n'


class Budget(unittest.TestCase):
    def test_three_percent_either_way(self):
        for value, right in ((1000, True), (1030, True), (970, True), (1031, False), (969, False)):
            self.assertEqual(budget.judge(PAGE, "text", value) is None, right, value)

    def test_ceiling_and_unknown_row(self):
        self.assertIn("ceiling", budget.judge(PAGE, "text", 1001, 1000))
        self.assertIn("no row", budget.judge(PAGE, "stack", 1000))


class Instructions(unittest.TestCase):
    def test_medians_of_the_frames_between_marks(self):
        marks = [100, 110, 200, 230, 300, 320, 1000, 1001, 2000, 2003, 3000, 3002]
        self.assertEqual(instructions.of_marks(["vga", "qvga"], marks), [("vga", 20), ("qvga", 2)])

    def test_what_a_program_counted_itself(self):
        self.assertEqual(instructions.of_words(["qvga 7", "qvga, tiny 5"]), [("qvga", 7), ("qvga, tiny", 5)])


class Stack(unittest.TestCase):
    def measure(self, text):
        graph = CallGraph()
        graph.read_text(text)
        return graph.deepest("^root$")[0], graph.errors

    def test_the_deepest_path_counts(self):
        text = node("root", 8) + node("a", 100) + node("b", 40) + node("c", 80) + edge("root", "a") + edge("root", "b") + edge("b", "c")
        self.assertEqual(self.measure(text), (8 + 40 + 80, []))

    def test_what_has_no_bound_is_named(self):
        root = node("root", 8)
        for text, word in (
                (edge("root", "root"), "recursion"),
                (node("a", 8) + edge("root", "a") + edge("a", "root"), "recursion"),
                (node("a", 8, "dynamic") + edge("root", "a"), "dynamic"),
                (edge("root", "malloc"), "in no call graph"),
                (edge("root", "__indirect_call"), "indirect")):
            errors = self.measure(root + text)[1]
            self.assertTrue(any(word in error for error in errors), (text, errors))

    def test_targets_of_an_indirect_call_are_followed(self):
        caller = "_ZN4plvo6Ransac5judgeEv"
        text = node("root", 8) + node(caller, 16) + node("_ZN4plvo15LineConstraints9linearizeEv", 500)
        text += edge("root", caller) + edge(caller, "__indirect_call")
        self.assertEqual(self.measure(text), (524, []))


if __name__ == "__main__":
    unittest.main()
