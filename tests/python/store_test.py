import gc
import shutil
import unittest

import cv2
import freshet
import numpy

from harness import Scene, covers, program


class Stores(unittest.TestCase):
    def setUp(self):
        self.scene = Scene.get()
        self.store = freshet.Store(self.scene.store)

    @covers("ingest", "IngestedClip", "IngestedClip.name", "IngestedClip.outcome", "IngestedClip.reasons",
            "IngestedClip.frames", "IngestedClip.patches")
    def test_ingest_adds_clips_once(self):
        clips = self.scene.ingested
        self.assertIsInstance(clips[0], freshet.IngestedClip)
        self.assertEqual([(clip.name, clip.outcome, clip.reasons, clip.frames) for clip in clips],
                         [("fall/1.mkv", "added", [], 32), ("fall/2.mkv", "added", [], 32)])
        self.assertGreater(clips[0].patches, 10)
        self.assertTrue(any(done > 0 for _, done, _ in self.scene.progress))
        copy = self.scene.folder / "copy.store"  # a process has a store open once
        shutil.copy(self.scene.store, copy)
        again = freshet.ingest(copy, [self.scene.clips])
        self.assertEqual({clip.outcome for clip in again}, {"already there"})

    @covers("Store", "Store.path", "Store.clips", "Store.first_patches", "Store.variants", "Store.digest",
            "Store.verify", "Store.__len__", "Store.__getitem__", "Store.__init__")
    def test_a_store_says_what_the_program_says(self):
        store = freshet.Store(self.scene.store)
        self.assertEqual(store.path, self.scene.store)
        self.assertEqual(len(store), 2)
        self.assertEqual(store.digest(), program("store", "digest", store.path).split()[0])
        self.assertEqual(store.verify(), [])
        patches = [clip.patches for clip in store.clips]
        self.assertEqual(store.first_patches.tolist(), [0, patches[0], sum(patches)])
        self.assertEqual(store["fall/2.mkv"].clip.name, "fall/2.mkv")
        self.assertEqual(len(store.variants), 18)

    @covers("Clip", "Clip.name", "Clip.class_name", "Clip.licence", "Clip.width", "Clip.height", "Clip.frames",
            "Clip.fps", "Clip.patches", "PatchVariant", "PatchVariant.scale", "PatchVariant.rotation_deg",
            "PatchVariant.flip")
    def test_clips_and_variants_are_described(self):
        clip = self.store.clips[0]
        self.assertIsInstance(clip, freshet.Clip)
        self.assertEqual((clip.name, clip.class_name, clip.licence), ("fall/1.mkv", "fall", "CC0"))
        self.assertEqual((clip.width, clip.height, clip.frames, clip.fps), (192, 144, 32, 25))
        self.assertGreater(clip.patches, 10)
        self.assertIn("fall/1.mkv", repr(clip))
        variant = self.store.variants[-1]
        self.assertIsInstance(variant, freshet.PatchVariant)
        self.assertEqual((variant.scale, variant.rotation_deg, variant.flip), (0.5, 22.5, True))

    @covers("Footage", "Footage.clip", "Footage.pixel_format", "Footage.planes", "Footage.bgr", "Footage.luma",
            "Footage.average", "Footage.__init__")
    def test_frames_are_those_of_the_source(self):
        footage = freshet.Footage(self.store, "fall/1.mkv")
        self.assertEqual(footage.clip.frames, 32)
        video = cv2.VideoCapture(str(self.scene.clips / "fall" / "1.mkv"))
        source = numpy.array([video.read()[1] for _ in range(32)])
        bgr = footage.bgr()
        self.assertEqual(bgr.shape, source.shape)
        self.assertLess(numpy.abs(bgr.astype(int) - source).mean(), 1)
        numpy.testing.assert_array_equal(footage.bgr(first=5, count=2), bgr[5:7])
        self.assertEqual(footage.bgr(first=32).shape, (0, 144, 192, 3))
        planes = footage.planes(first=3, count=2)
        self.assertIn(footage.pixel_format, ("bgr0", "gbrp", "yuv420p", "yuv444p"))
        self.assertEqual(planes[0].shape[:2], (2, 144))
        luma = footage.luma()
        self.assertEqual(luma.shape, (32, 144, 192))
        grey = cv2.cvtColor(bgr[0], cv2.COLOR_BGR2GRAY)
        self.assertLess(numpy.abs(luma[0].astype(int) - grey).max(), 4)
        self.assertLess(numpy.abs(footage.average() - luma.mean(axis=0)).max(), 2)

    @covers("Footage.flow", "Footage.flow_step", "Footage.columns", "Footage.column", "Footage.cell_maps",
            "Footage.cells")
    def test_motion_and_columns_have_the_shapes_that_are_said(self):
        footage = self.store["fall/1.mkv"]
        flow = footage.flow()
        step = footage.flow_step
        self.assertEqual(flow.shape, (31, -(-144 // step), -(-192 // step), 2))
        self.assertEqual(flow.dtype, numpy.float32)
        self.assertGreater(flow[..., 1].mean(), 0)  # it falls
        patches = footage.clip.patches
        types = {name: footage.column(name) for name in footage.columns}
        self.assertEqual(types["patch.words"].shape, (patches, 81))
        self.assertEqual(types["patch.motion"].shape, (patches, 2))
        self.assertEqual(types["patch.x"].dtype, numpy.uint16)
        self.assertEqual(types["patch.coverage"].shape, (patches,))
        numpy.testing.assert_allclose(numpy.diff(types["frame.time"]), 0.04, atol=1e-3)
        self.assertLess(types["patch.variant"].max(), 18)
        for name in footage.cell_maps:
            cells = footage.cells(name)
            self.assertEqual((cells.ndim, cells.dtype), (3, numpy.float32))
        self.assertIn("motion", footage.cell_maps)

    def test_a_list_of_stores_is_one_store(self):
        folder = self.scene.folder
        for seed in (1, 2):
            freshet.ingest(folder / f"part{seed}.store", [self.scene.clips / f"fall/{seed}.mkv"], class_name="fall")
        (folder / "all.stores").write_text("part1.store\npart2.store\n")
        program("index", folder / "all.stores")
        both = freshet.Store(folder / "all.stores")
        self.assertEqual([clip.name for clip in both.clips], ["1.mkv", "2.mkv"])
        numpy.testing.assert_array_equal(both["2.mkv"].bgr(count=2), self.store["fall/2.mkv"].bgr(count=2))
        words = self.store["fall/1.mkv"].column("patch.words")[:3]
        numpy.testing.assert_array_equal(freshet.nearest_by_words(both, words, k=5).patches,
                                         freshet.nearest_by_words(self.store, words, k=5).patches)

    def test_views_are_read_only_and_outlive_their_store(self):
        store = freshet.Store(self.scene.store)
        footage = store["fall/1.mkv"]
        words, frames = footage.column("patch.words"), footage.bgr(count=1)[0]
        copies = words.copy(), frames.copy()
        with self.assertRaises(ValueError):
            words[0, 0] = 1
        del store, footage
        gc.collect()
        numpy.testing.assert_array_equal(words, copies[0])
        numpy.testing.assert_array_equal(frames, copies[1])

    @covers("Error", "Error.kind")
    def test_failures_say_their_kind(self):
        cases = {"input": lambda: freshet.Store(self.scene.folder / "none.store"),
                 "not_found": lambda: self.store["no clip"],
                 "usage": lambda: self.store["fall/1.mkv"].bgr(first=31, count=2),
                 "io": lambda: freshet.VideoWriter("/no/such/folder/a.mkv", (64, 64))}
        for kind, call in cases.items():
            with self.assertRaises(freshet.Error) as raised:
                call()
            self.assertEqual(raised.exception.kind, kind)
            self.assertIn(":", str(raised.exception))
        damaged = self.scene.folder / "damaged.store"
        damaged.write_bytes(self.scene.store.read_bytes()[:20000])
        with self.assertRaises(freshet.Error) as raised:
            freshet.Store(damaged).verify()
        self.assertEqual(raised.exception.kind, "damaged")

    @covers("Sampler", "Sampler.side", "Sampler.__len__", "Sampler.at", "Sampler.__getitem__", "Sampler.read",
            "Sampler.__init__", "SampledPatch", "SampledPatch.clip", "SampledPatch.patch", "SampledPatch.first")
    def test_a_sampler_draws_each_patch_once_and_shards_share_nothing(self):
        options = {"seed": 5, "frames": 12}
        whole = freshet.Sampler(self.store, **options)
        self.assertEqual(len(whole), self.store.first_patches[-1])
        drawn = [(at.clip, at.patch, at.first) for at in map(whole.at, range(len(whole)))]
        self.assertIsInstance(whole.at(0), freshet.SampledPatch)
        self.assertEqual(len({(clip, patch) for clip, patch, _ in drawn}), len(whole))
        self.assertGreater(len({first for _, _, first in drawn}), 15)
        shards = [freshet.Sampler(self.store, shard=(i, 3), **options) for i in range(3)]
        parts = [[(at.clip, at.patch, at.first) for at in map(part.at, range(len(part)))] for part in shards]
        self.assertEqual([drawn[i::3] for i in range(3)], parts)
        videos = whole.read(0, 9)
        self.assertEqual(videos.shape, (9, 12, whole.side, whole.side, 3))
        numpy.testing.assert_array_equal(videos[4], whole[4])
        numpy.testing.assert_array_equal(videos[[0, 3, 6]], shards[0].read(0, 3))
        self.assertNotEqual(whole.at(0).patch, freshet.Sampler(self.store, seed=6, frames=12).at(0).patch)

    def test_a_sampled_video_is_the_clips_own(self):
        sampler = freshet.Sampler(self.store, seed=1, frames=8)
        grey = freshet.Sampler(self.store, seed=1, frames=8, colour=False)
        seen = set()
        for i in range(len(sampler)):
            at = sampler.at(i)
            footage = self.store[at.clip]
            variant = self.store.variants[footage.column("patch.variant")[at.patch]]
            if variant.scale != 1 or variant.rotation_deg != 0 or variant.flip in seen:
                continue
            seen.add(variant.flip)
            x, y = (int(footage.column("patch." + axis)[at.patch]) for axis in "xy")
            for frames, video in ((footage.bgr(at.first, 8), sampler[i]), (footage.luma(at.first, 8), grey[i])):
                shown = frames[:, :, ::-1] if variant.flip else frames
                numpy.testing.assert_array_equal(video, shown[:, y:y + 48, x:x + 48])
        self.assertEqual(seen, {False, True})

    def test_a_turned_or_reduced_patch_is_what_its_variant_shows(self):
        sampler = freshet.Sampler(self.store, seed=1, frames=1, colour=False)
        seen = {}
        for i in range(len(sampler)):
            at = sampler.at(i)
            footage = self.store[at.clip]
            variant = self.store.variants[footage.column("patch.variant")[at.patch]]
            kind = (variant.scale, variant.rotation_deg)
            if kind in seen or variant.flip:
                continue
            frame = footage.luma(at.first, 1)[0].astype(numpy.float32)
            x, y = (float(footage.column("patch." + axis)[at.patch]) for axis in "xy")
            angle = numpy.deg2rad(variant.rotation_deg)
            turn = variant.scale * numpy.array([[numpy.cos(angle), numpy.sin(angle)],
                                                [-numpy.sin(angle), numpy.cos(angle)]])
            reach = abs(turn) @ (192, 144)
            sides = numpy.ceil(reach - 1e-6)
            back = numpy.linalg.inv(turn)
            middle = numpy.array([x, y]) + 23.5 - (sides - 1) / 2
            source = back @ middle + (numpy.array([192, 144]) - 1) / 2
            # The middle quarter of the patch, as a mean: it does not depend on how samples lie.
            grid = numpy.mgrid[-12:12:0.5, -12:12:0.5].reshape(2, -1)[::-1]
            columns, rows = numpy.rint(back @ grid + source[:, None]).astype(int)
            seen[kind] = abs(frame[rows, columns].mean() - sampler[i][0, 12:36, 12:36].mean())
        self.assertEqual(len(seen), 9)
        self.assertLess(max(seen.values()), 3, seen)
