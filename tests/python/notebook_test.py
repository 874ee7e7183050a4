"""The notebook runs from top to bottom, in an empty folder."""
import importlib.util
import json
import os
import sys
import tempfile
import types
import unittest

import numpy
from harness import ROOT


class Notebook(unittest.TestCase):
    def test_its_cells_run_in_order(self):
        book = json.loads((ROOT / "python/examples/first_film.ipynb").read_text())
        cells = ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]
        self.assertEqual([cell["outputs"] for cell in book["cells"] if cell["cell_type"] == "code"], [[]] * len(cells))
        if importlib.util.find_spec("IPython") is None:  # which shows pictures, where notebooks are shown
            display = types.ModuleType("IPython.display")
            display.Image = str
            sys.modules.update({"IPython": types.ModuleType("IPython"), "IPython.display": display})
        before, names = os.getcwd(), {}
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for cell in cells:
                    exec(compile(cell, "first_film.ipynb", "exec"), names)
                for name in ("footage.png", "film.png", "patches.png", "fall.mkv"):
                    self.assertGreater(os.path.getsize(name), 1000, name)
            finally:
                os.chdir(before)
        film = names["film"]
        self.assertEqual((len(film), film[0].shape), (24, (144, 192, 3)))
        self.assertGreater(numpy.abs(film[12].astype(int) - film[0]).mean(), 1)
        self.assertEqual(names["batch"].shape, (8, 16, 48, 48, 3))
