import os
import re
import unittest

import freshet
import numpy
from freshet import hdf5

from harness import ROOT, Scene, covers


class LastRows:
    """An index that answers any question with its last rows."""

    def build(self, patches):
        self.rows = len(patches)

    def search(self, questions, k):
        return numpy.tile(numpy.arange(self.rows - k, self.rows), (len(questions), 1))


class Benchmarks(unittest.TestCase):
    def setUp(self):
        self.store = freshet.Store(Scene.get().store)

    @covers("benchmark")
    def test_an_own_index_has_a_row_beside_ours(self):
        said = []
        report = freshet.benchmark(self.store, LastRows(), pieces=12, setting_limit_s=0.02,
                                   progress=lambda *at: said.append(at[0]))
        rows = {index["name"]: index for index in report["indexes"]}
        self.assertEqual(list(rows), ["exact", "scan", "LastRows"])
        self.assertEqual(rows["exact"]["settings"][0]["recall_100"], 1)
        own = rows["LastRows"]["settings"][0]
        self.assertLess(own["recall_10"], 0.9)
        self.assertGreaterEqual(own["energy_loss"], 0)
        self.assertEqual(len(rows["LastRows"]["filters"]), len(rows["exact"]["filters"]))
        self.assertEqual(report["wrong"], 0)
        self.assertIn("LastRows: building", said)

    def test_what_an_own_index_raises_is_raised(self):
        class Broken(LastRows):
            def search(self, questions, k):
                raise LookupError("mine")
        with self.assertRaisesRegex(LookupError, "mine"):
            freshet.benchmark(self.store, Broken(), pieces=5, label=False, filters=False)

    @covers("search_problem", "recall", "SearchProblem", "SearchProblem.patches", "SearchProblem.questions",
            "SearchProblem.neighbours", "SearchProblem.distances", "SearchProblem.__init__")
    def test_a_problem_goes_through_ann_benchmarks_layout(self):
        problem = freshet.search_problem(self.store, k=10, pieces=6)
        self.assertIsInstance(problem, freshet.SearchProblem)
        distances = numpy.abs(problem.patches.astype(int)[None] - problem.questions.astype(int)[:, None]).sum(axis=2)
        self.assertEqual(distances.shape, (6, len(problem.patches)))
        numpy.testing.assert_array_equal(numpy.sort(distances)[:, :10], problem.distances)
        self.assertEqual(freshet.recall(problem, problem.neighbours, 10), 1)
        none = numpy.full((6, 10), -1, numpy.int32)
        none[:, 0] = problem.neighbours[:, 0]
        self.assertAlmostEqual(freshet.recall(problem, none, 10), 0.1)
        path = Scene.get().folder / "problem.hdf5"
        hdf5.write_problem(problem, path)
        read = hdf5.read_problem(path)
        for name in ("patches", "questions", "neighbours", "distances"):
            numpy.testing.assert_array_equal(getattr(read, name), getattr(problem, name))
        again = freshet.SearchProblem(read.patches, read.questions, read.neighbours, read.distances)
        self.assertEqual(freshet.recall(again, read.neighbours, 3), 1)

    def test_a_problem_of_another_distance_is_refused(self):
        import h5py
        path = Scene.get().folder / "euclidean.hdf5"
        with h5py.File(path, "w") as file:
            file.attrs["distance"] = "euclidean"
        with self.assertRaisesRegex(ValueError, "manhattan"):
            hdf5.read_problem(path)


class Page(unittest.TestCase):
    def test_its_blocks_run_in_order(self):
        text = (ROOT / "docs" / "python.md").read_text()
        before, names = os.getcwd(), {}
        os.chdir(Scene.get().folder)
        try:
            for block in re.findall(r"```python\n(.*?)```", text, re.S):
                exec(compile(block, "docs/python.md", "exec"), names)
        finally:
            os.chdir(before)
        self.assertEqual(names["batch"].shape, (4, 16, 48, 48, 3))
        numpy.testing.assert_array_equal(names["same"], names["batch"][2])
        self.assertEqual(freshet.recall(names["problem"], names["found"], 10), 1)
        self.assertEqual([index["settings"][0]["recall_100"] for index in names["report"]["indexes"]], [1, 1, 1])
