import os
import signal
import threading
import time
import unittest

import freshet

from harness import Scene, search


def threads():
    return len(os.listdir("/proc/self/task"))


class Calls(unittest.TestCase):
    """How long calls behave."""

    def setUp(self):
        self.labelling = freshet.label(search(Scene.get(), frames=60))

    def interrupt(self, call):
        timer = threading.Timer(0.2, signal.raise_signal, (signal.SIGINT,))
        timer.start()
        begin = time.monotonic()
        try:
            with self.assertRaises(KeyboardInterrupt):
                call()
        finally:
            timer.join()
        return time.monotonic() - begin

    def test_ctrl_c_ends_a_call(self):
        path = Scene.get().folder / "stopped.mkv"

        def call():
            while True:
                freshet.write_animation(self.labelling, path)
        self.assertLess(self.interrupt(call), 10)
        self.assertFalse(path.exists() and path.stat().st_size == 0)

    def test_ctrl_c_ends_waiting_for_a_frame(self):
        def call():
            while True:
                for _ in freshet.animate(self.labelling):
                    pass
        self.assertLess(self.interrupt(call), 10)

    def test_what_progress_raises_ends_the_call(self):
        def progress(stage, done, of):
            raise LookupError(stage)
        with self.assertRaises(LookupError):
            search(Scene.get(), progress=progress)
        with self.assertRaises(LookupError):
            list(freshet.animate(self.labelling, progress=progress))

    def test_others_run_meanwhile(self):
        counted = []
        done = threading.Event()

        def count():
            while not done.wait(0.001):
                counted.append(1)
        counter = threading.Thread(target=count)
        counter.start()
        freshet.write_animation(self.labelling, Scene.get().folder / "meanwhile.mkv")
        done.set()
        counter.join()
        self.assertGreater(len(counted), 5)

    def test_frames_that_are_dropped_end_their_computation(self):
        next(freshet.animate(self.labelling))  # the library's own threads stay
        before = threads()
        for _ in range(5):
            next(freshet.animate(self.labelling))
        self.assertEqual(threads(), before)
