import subprocess
import sys
import unittest

import freshet
import numpy

from harness import FRESHET, ROOT, SIZE, Scene, covers, program, search


class Searches(unittest.TestCase):
    def setUp(self):
        self.scene = Scene.get()

    @covers("read_picture", "read_matte", "Picture", "Picture.bgr", "Picture.deep", "Picture.notices", "Matte",
            "Matte.alpha", "Matte.notices", "VideoWriter", "VideoWriter.write", "VideoWriter.finish",
            "VideoWriter.__enter__", "VideoWriter.__exit__", "VideoWriter.__init__")
    def test_pictures_go_out_and_in(self):
        picture = numpy.random.default_rng(1).integers(0, 65536, (*SIZE[::-1], 3), numpy.uint16)
        path = self.scene.folder / "deep.png"
        with freshet.VideoWriter(path, SIZE, frames=1) as writer:
            writer.write(picture)
            writer.finish()
        read = freshet.read_picture(path)
        self.assertIsInstance(read, freshet.Picture)
        numpy.testing.assert_array_equal(read.deep, picture)
        self.assertEqual((read.bgr.dtype, read.notices), (numpy.uint8, []))
        matte = freshet.read_matte(self.scene.folder / "fall_matte.png", SIZE)
        self.assertIsInstance(matte, freshet.Matte)
        self.assertEqual(matte.alpha.shape, SIZE[::-1])
        self.assertIsInstance(matte.notices, list)
        with self.assertRaises(ZeroDivisionError):
            with freshet.VideoWriter(self.scene.folder / "never.png", SIZE, frames=1):
                1 / 0
        self.assertFalse((self.scene.folder / "never.png").exists())

    @covers("search", "Search", "Search.areas", "Search.table", "Search.candidates", "Search.notices",
            "Search.__len__", "Candidate", "Candidate.clip", "Candidate.score", "PatchTable", "PatchTable.patches",
            "PatchTable.scores")
    def test_candidates_are_those_of_the_library(self):
        found = search(self.scene, candidates=20)
        self.assertIsInstance(found, freshet.Search)
        store = freshet.Store(self.scene.store)
        table = found.table
        self.assertIsInstance(table, freshet.PatchTable)
        self.assertEqual(table.patches.shape, table.scores.shape)
        self.assertEqual(len(table.patches), len(found))
        self.assertGreaterEqual(table.patches.shape[1], 20)  # neighbours' continuations join
        self.assertEqual(found.areas.shape, (len(found), 4))
        self.assertIsInstance(found.notices, list)
        for piece in (0, len(found) - 1):
            candidates = found.candidates(piece)
            self.assertIsInstance(candidates[0], freshet.Candidate)
            patches = table.patches[piece, :len(candidates)]
            clips = numpy.searchsorted(store.first_patches, patches, "right") - 1
            self.assertEqual([store.clips[clip].name for clip in clips], [one.clip for one in candidates])
            numpy.testing.assert_allclose(table.scores[piece, :len(candidates)], [one.score for one in candidates])
        with self.assertRaises(IndexError):
            found.candidates(len(found))

    @covers("search_many")
    def test_many_pictures_are_searched_as_one_each(self):
        store = freshet.Store(self.scene.store)
        pictures = [self.scene.picture, self.scene.picture[:, ::-1]]
        found = freshet.search_many(store, pictures, frames=8)
        for one, picture in zip(found, pictures):
            numpy.testing.assert_array_equal(one.table.patches, freshet.search(store, picture, frames=8).table.patches)

    @covers("nearest_by_words", "nearest_by_histograms", "histograms_of")
    def test_own_descriptions_find_the_patches_that_have_them(self):
        store = freshet.Store(self.scene.store)
        words = store["fall/2.mkv"].column("patch.words")[5:9]
        by_words = freshet.nearest_by_words(store, words, k=7)
        numpy.testing.assert_allclose(by_words.scores[:, 0], 1)
        histograms = freshet.histograms_of(store, words)
        self.assertEqual(set(histograms.sum(axis=1)), {81 * 4})
        by_histograms = freshet.nearest_by_histograms(store, histograms, k=7)
        numpy.testing.assert_array_equal(by_words.patches, by_histograms.patches)
        numpy.testing.assert_array_equal(by_words.scores, by_histograms.scores)
        with self.assertRaises(freshet.Error):
            freshet.nearest_by_words(store, words[:, :80])

    @covers("MotionGuide", "MotionGuide.direction", "MotionGuide.speed", "MotionGuide.tolerance_deg",
            "MotionGuide.speed_ratio", "MotionGuide.min_speed_px_per_s", "MotionGuide.horizon", "MotionGuide.__init__",
            "read_strokes")
    def test_a_guide_comes_from_strokes_or_from_arrays(self):
        strokes = self.scene.folder / "lines.svg"
        strokes.write_text('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 192 144">'
                           '<path d="M 96 10 L 96 130" data-speed="40"/></svg>')
        read = freshet.read_strokes(strokes, SIZE)
        self.assertEqual(read.direction.shape, (144, 192, 2))
        numpy.testing.assert_allclose(read.direction[70, 96], (0, 1), atol=1e-3)
        self.assertAlmostEqual(float(read.speed[70, 96]), 40, 3)
        own = freshet.MotionGuide(direction=read.direction, tolerance_deg=20, speed_ratio=2, min_speed_px_per_s=1)
        self.assertEqual((own.tolerance_deg, own.speed_ratio, own.min_speed_px_per_s), (20, 2, 1))
        self.assertEqual(own.speed.size, 0)
        self.assertIsNone(own.horizon)
        self.assertEqual(tuple(freshet.MotionGuide(horizon=(0, 20, 192, 22)).horizon), (0, 20, 192, 22))
        self.assertGreater(len(search(self.scene, guide=own, narrow=True)), 0)

    @covers("label", "Labelling", "Labelling.search", "Labelling.patches", "Labelling.clips", "Labelling.energy",
            "Labelling.gap", "Labelling.chosen", "Labelling.write", "Labelling.__len__", "UsedClip", "UsedClip.name",
            "UsedClip.class_name", "UsedClip.licence", "UsedClip.pieces")
    def test_a_labelling_chooses_among_the_candidates(self):
        found = search(self.scene)
        chosen = freshet.label(found, lambda_=0)
        self.assertIsInstance(chosen, freshet.Labelling)
        self.assertEqual(len(chosen), len(chosen.search))
        for piece, patch in enumerate(chosen.patches):
            self.assertIn(patch, found.table.patches[piece])
            self.assertIn(chosen.chosen(piece).clip, ("fall/1.mkv", "fall/2.mkv"))
        used = chosen.clips
        self.assertIsInstance(used[0], freshet.UsedClip)
        self.assertEqual(sum(clip.pieces for clip in used), len(chosen))
        self.assertEqual((used[0].class_name, used[0].licence, used[0].name[:5]), ("fall", "CC0", "fall/"))
        self.assertGreaterEqual(chosen.gap, 0)
        self.assertGreater(chosen.energy, 0)
        chosen.write(self.scene.folder / "own.json")
        self.assertIn("freshet-assignment", (self.scene.folder / "own.json").read_text())

    @covers("animate", "Frames", "Frames.__next__", "Frames.__iter__", "Frames.__enter__", "Frames.__exit__",
            "Frames.close", "write_animation", "AnimateReport", "AnimateReport.frames", "AnimateReport.clips",
            "AnimateReport.pieces", "AnimateReport.seconds")
    def test_frames_are_the_programs_to_the_bit(self):
        folder = self.scene.folder
        arguments = ["animate", self.scene.store, folder / "fall.png"]
        program("synth", *arguments, "--matte", folder / "fall_matte.png", "--class", "fall", "--frames", 8, "-o",
                folder / "program.mkv")
        example = ROOT / "python" / "examples" / "animate.py"
        self.assertLessEqual(len(example.read_text().splitlines()), 15)
        subprocess.run([sys.executable, example, self.scene.store, folder / "fall.png", folder / "fall_matte.png",
                        folder / "example.mkv"], check=True)
        self.assertEqual((folder / "example.mkv").read_bytes(), (folder / "program.mkv").read_bytes())

        labelling = freshet.label(search(self.scene))
        report = freshet.write_animation(labelling, folder / "written.mkv")
        self.assertEqual((folder / "written.mkv").read_bytes(), (folder / "program.mkv").read_bytes())
        self.assertIsInstance(report, freshet.AnimateReport)
        self.assertEqual((report.frames, report.pieces), (8, len(labelling)))
        self.assertGreater(report.seconds, 0)
        self.assertLessEqual(report.clips, 2)
        with freshet.animate(labelling) as frames:
            self.assertIsInstance(frames, freshet.Frames)
            first = next(frames)
            rest = [frame for frame in frames]
        self.assertEqual((len(rest), first.shape), (7, (144, 192, 3)))
        still = self.scene.matte == 0
        numpy.testing.assert_array_equal(rest[3][still], self.scene.picture[still])
        half = freshet.animate(labelling, loop=True, speed=0.5)
        next(half)
        half.close()
        self.assertEqual(list(half), [])

    @covers("simulate", "simulation_presets", "Simulation", "Simulation.size", "Simulation.fps",
            "Simulation.__len__", "Simulation.__next__", "Simulation.__iter__", "SimulatedFrame", "SimulatedFrame.picture",
            "SimulatedFrame.alpha", "SimulatedFrame.motion", "SimulatedFrame.emitters", "transfer")
    def test_a_design_gets_a_look(self):
        self.assertIn("plume", freshet.simulation_presets())
        folder = self.scene.folder / "design"
        program("synth", "simulate", "plume", "--size", "96x80", "--frames", 4, "-o", folder)
        design = freshet.simulate("plume", size=(96, 80), frames=4)
        self.assertIsInstance(design, freshet.Simulation)
        self.assertEqual((design.size, len(design)), ((96, 80), 4))
        self.assertGreater(design.fps, 0)
        first = next(design)
        self.assertIsInstance(first, freshet.SimulatedFrame)
        self.assertEqual((first.picture.shape, first.motion.shape), ((80, 96, 3), (80, 96, 2)))
        self.assertEqual((first.alpha.shape, first.emitters.shape), ((80, 96), (80, 96)))
        self.assertEqual(sum(1 for _ in design), 3)
        frames = list(freshet.transfer(folder / "alpha", folder / "flow", self.scene.folder / "fall.png",
                                       self.scene.folder / "fall_matte.png", frames=2))
        self.assertEqual([(frame.shape, frame.dtype) for frame in frames], 2 * [((80, 96, 4), numpy.float32)])
        look = (folder / "alpha", folder / "flow", self.scene.folder / "fall.png", self.scene.folder / "fall_matte.png")
        bent = list(freshet.transfer(*look, frames=2, curvature=4))
        self.assertTrue((bent[1] != frames[1]).any())
        with self.assertRaisesRegex(freshet.Error, "does not move"):
            list(freshet.transfer(*look, frames=2, stabilise=True))

    @covers("tour", "tour_moves", "Tour", "Tour.size", "Tour.fps", "Tour.notices", "Tour.__len__", "Tour.__next__",
            "Tour.__iter__", "TourFrame", "TourFrame.picture", "TourFrame.depth")
    def test_a_camera_goes_through_a_picture(self):
        self.assertIn("truck", freshet.tour_moves())
        made = freshet.tour(self.scene.folder / "fall.png", move="truck", horizon=50, frames=4, size=(96, 72))
        self.assertIsInstance(made, freshet.Tour)
        self.assertEqual((made.size, len(made), made.fps), ((96, 72), 4, 25))
        self.assertTrue(any("narrowed" in notice for notice in made.notices))
        first = next(made)
        self.assertIsInstance(first, freshet.TourFrame)
        self.assertEqual((first.picture.shape, first.depth.shape), ((72, 96, 3), (72, 96)))
        self.assertEqual(first.depth.max(), numpy.float32(1e10))  # the sky
        rest = [frame.picture for frame in made]
        self.assertEqual(len(rest), 3)
        self.assertTrue((rest[2] != first.picture).any())
        with self.assertRaises(freshet.Error):
            freshet.tour(self.scene.folder / "fall.png", move="spin")

    def test_wrong_pictures_are_refused(self):
        store = freshet.Store(self.scene.store)
        for picture, matte in ((self.scene.matte, None), (self.scene.picture, self.scene.matte[:-1])):
            with self.assertRaises(freshet.Error) as raised:
                freshet.search(store, picture, matte)
            self.assertEqual(raised.exception.kind, "usage")
        with self.assertRaises(TypeError):
            freshet.search(store, "fall.png")
