import unittest

import freshet
import numpy

from harness import SIZE, Scene, covers, program

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 192 144">{}</svg>'


def write(path, frames, size=SIZE):
    frames = list(frames)
    with freshet.VideoWriter(path, size, frames=len(frames)) as video:
        for frame in frames:
            video.write(frame)
    return path.read_bytes()


class Ways(unittest.TestCase):
    """Other ways to synthesise, each beside the program's bytes."""

    def setUp(self):
        self.scene = Scene.get()
        self.folder = self.scene.folder

    def made(self, *arguments):
        out = self.folder / "program.mkv"
        program("synth", *arguments, "--overwrite", "-o", out)
        return out.read_bytes()

    @covers("find_horizon")
    def test_water_has_the_programs_horizon_and_pace(self):
        store = self.folder / "water.store"
        freshet.ingest(store, [self.scene.clips], class_name="water")
        matte = numpy.zeros(SIZE[::-1], numpy.uint8)
        matte[60:] = 255
        write(self.folder / "sea.png", [matte])
        lines = self.folder / "sea.svg"
        lines.write_text(SVG.format('<path d="M 10 120 L 180 120"/>'))
        horizon = freshet.find_horizon(self.scene.picture, matte, "water")
        self.assertEqual((horizon[1], horizon[3]), (60, 60))
        self.assertIsNone(freshet.find_horizon(self.scene.picture, matte, "fire"))
        opened = freshet.Store(store)
        guides = {None: None, lines: freshet.read_strokes(lines, SIZE, horizon)}
        films = set()
        for strokes, guide in guides.items():
            found = freshet.search(opened, self.scene.picture, matte, class_name="water", guide=guide, frames=6)
            film = write(self.folder / "sea.mkv", freshet.animate(freshet.label(found)))
            self.assertEqual(film, self.made("animate", store, self.folder / "fall.png", "--matte", self.folder / "sea.png",
                                             "--class", "water", "--frames", 6,
                                             *(() if strokes is None else ("--strokes", strokes))))
            films.add(film)
        for pace in ("slow", "natural", "fast"):
            film = write(self.folder / "sea.mkv", freshet.animate(freshet.label(found), pace=pace))
            self.assertEqual(film, self.made("animate", store, self.folder / "fall.png", "--matte", self.folder / "sea.png",
                                             "--class", "water", "--frames", 6, "--strokes", lines, "--speed", pace))
            films.add(film)
        self.assertEqual(len(films), 5)
        with self.assertRaises(freshet.Error):
            list(freshet.animate(freshet.label(found), pace="lively"))

    @covers("stills", "StillsFilm", "StillsFilm.size", "StillsFilm.fps", "StillsFilm.regions", "StillsFilm.notices",
            "StillsFilm.__len__", "StillsFilm.__iter__", "StillsRegion", "StillsRegion.name", "StillsRegion.kind",
            "StillsRegion.sequence")
    def test_stills_become_a_film(self):
        folder = self.folder / "stills"
        folder.mkdir()
        for i, frame in enumerate(freshet.Store(self.scene.store)["fall/1.mkv"].bgr()[::5]):
            write(folder / f"{i}.png", [frame])
        film = freshet.stills(folder, seconds=1, fps=8, one_region=True, seed=3)
        self.assertIsInstance(film, freshet.StillsFilm)
        self.assertEqual((film.size, len(film), film.fps), (SIZE, 8, 8))
        region = film.regions[0]
        self.assertIsInstance(region, freshet.StillsRegion)
        self.assertEqual((region.name, region.kind), ("1", "independent"))
        self.assertTrue(set(region.sequence) <= {f"{i}.png" for i in range(7)})
        self.assertIsInstance(film.notices, list)
        frames = [frame for frame in film]
        numpy.testing.assert_array_equal(frames[5], list(film)[5])  # as often as wanted
        with freshet.VideoWriter(self.folder / "own_stills.mkv", SIZE, frames=8, fps=8) as video:
            for frame in frames:
                video.write(frame)
        self.assertEqual((self.folder / "own_stills.mkv").read_bytes(),
                         self.made("stills", folder, "--seconds", 1, "--fps", 8, "--one-region", "--seed", 3))
        for wrong in ({"camera": "drone"}, {"speed": 0}, {"one_region": True, "regions": self.folder / "fall.png"}):
            with self.assertRaises(freshet.Error):
                freshet.stills(folder, **wrong)

    @covers("scene", "SceneFilm", "SceneFilm.size", "SceneFilm.fps", "SceneFilm.layers", "SceneFilm.notices",
            "SceneFilm.layer", "SceneFilm.__len__", "SceneFilm.__next__", "SceneFilm.__iter__")
    def test_layers_move_under_one_wind(self):
        text = ('picture = "fall.png"\nframes = 6\n[[layer]]\nname = "lake"\nmatte = "lake.png"\nmotion = "water"\n'
                'horizon = [0, 60, 192, 60]\ntile = 64\n[[layer]]\nname = "fall"\nmatte = "fall_matte.png"\n'
                'motion = "patches"\nstore = "my.store"\nclass = "fall"\n')
        lake = numpy.zeros(SIZE[::-1], numpy.uint8)
        lake[100:] = 255
        write(self.folder / "lake.png", [lake])
        toml = self.folder / "scene.toml"
        toml.write_text(text)
        film = freshet.scene(toml)
        self.assertIsInstance(film, freshet.SceneFilm)
        self.assertEqual((film.size, len(film), film.fps), (SIZE, 6, 25))
        self.assertEqual(film.layers[:2], ["lake", "fall"])
        self.assertIsInstance(film.notices, list)
        with self.assertRaises(freshet.Error):
            film.layer(0)
        frames = []
        for frame in film:
            frames.append(frame)
        alone = film.layer(0)
        self.assertEqual((alone.shape, alone.dtype), ((144, 192, 4), numpy.float32))
        self.assertEqual((alone[20, 20, 3], alone[130, 90, 3]), (0, 1))
        self.assertEqual(write(self.folder / "own_scene.mkv", frames), self.made("scene", toml))
        light = next(freshet.scene(toml, light=True))
        self.assertLess(numpy.abs(light[..., :3] * 255 - frames[0]).max(), 0.6)
        toml.write_text(text + 'options = ["--speed", "2"]\n')
        with self.assertRaisesRegex(freshet.Error, "options"):
            freshet.scene(toml)
        with self.assertRaises(freshet.Error):
            freshet.scene(toml, as_printed=True)

    @covers("flowlines", "FlowLines", "FlowLines.size", "FlowLines.fps", "FlowLines.lines", "FlowLines.notices",
            "FlowLines.write_lines", "FlowLines.__len__", "FlowLines.__next__", "FlowLines.__iter__", "FlowLine",
            "FlowLine.name", "FlowLine.points", "FlowLinesFrame", "FlowLinesFrame.picture", "FlowLinesFrame.fluid")
    def test_a_clip_goes_on_along_its_lines(self):
        clip = self.scene.clips / "fall" / "1.mkv"
        film = freshet.flowlines(clip, frames=40)
        self.assertIsInstance(film, freshet.FlowLines)
        self.assertEqual((film.size, len(film)), (SIZE, 40))
        self.assertGreater(film.fps, 0)
        self.assertIsInstance(film.notices, list)
        line = film.lines[0]
        self.assertIsInstance(line, freshet.FlowLine)
        self.assertEqual(line.points.shape[1], 2)
        self.assertTrue(line.name)
        drawn = self.folder / "lines.svg"
        film.write_lines(drawn)
        frames = []
        for frame in film:
            self.assertIsInstance(frame, freshet.FlowLinesFrame)
            frames.append(frame.picture)
            self.assertEqual((frame.fluid.shape, frame.fluid.dtype), (SIZE[::-1], numpy.float32))
        with freshet.VideoWriter(self.folder / "own_lines.mkv", SIZE, frames=40, fps=film.fps) as video:
            for frame in frames:
                video.write(frame)
        own = (self.folder / "own_lines.mkv").read_bytes()
        self.assertEqual(own, self.made("flowlines", clip, "--frames", 40))
        stored = freshet.flowlines("fall/1.mkv", freshet.Store(self.scene.store), frames=1)
        self.assertEqual(len(stored.lines), len(film.lines))
        edited = next(freshet.flowlines(clip, frames=1, lines=drawn, edited=drawn, blend="feather", in_turn=True))
        self.assertEqual(edited.picture.shape, (144, 192, 3))
        for wrong in ({"blend": "mix"}, {"patch_px": 1}, {"lines": self.folder / "none.svg"}):
            with self.assertRaises(freshet.Error):
                freshet.flowlines(clip, **wrong)


if __name__ == "__main__":
    unittest.main()
