"""What the tests of the Python module share: one small store, and which test covers which public name."""
import atexit
import inspect
import os
import pathlib
import shutil
import subprocess
import tempfile

import freshet

FRESHET = os.environ.get("FRESHET_EXECUTABLE", "")
ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = (192, 144)  # px
COVERED = {}  # public name: the test that covers it


def covers(*names):
    """Marks a test: it is the one of these public names, and uses each of them."""
    def mark(test):
        text = inspect.getsource(test).split("def ", 1)[1]
        for name in names:
            last = name.split(".")[-1]
            word = {"__len__": "len(", "__getitem__": "[", "__next__": "next(", "__iter__": "for ",
                    "__enter__": "with ", "__exit__": "with ", "__init__": "("}.get(last, last)
            assert word in text, f"{test.__name__} says that it covers {name}"
            COVERED[name] = test.__name__
        return test
    return mark


def write_clip(path, seed, frames=32):
    """A simulated waterfall; its first frame."""
    clip = freshet.simulate("waterfall", size=SIZE, frames=frames, seed=seed)
    first = None
    with freshet.VideoWriter(path, clip.size, frames=frames, fps=clip.fps) as video:
        for frame in clip:
            first = first or frame
            video.write(frame.picture)
    return first


class Scene:
    """A folder with a store of two clips, a still and its matte; made once, by the module itself."""
    made = None

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        atexit.register(shutil.rmtree, self.folder)
        self.clips = self.folder / "clips"
        (self.clips / "fall").mkdir(parents=True)
        for seed in (1, 2):
            write_clip(self.clips / "fall" / f"{seed}.mkv", seed)
        still = write_clip(self.folder / "own.mkv", 7, frames=1)
        self.store = self.folder / "my.store"
        self.progress = []
        self.ingested = freshet.ingest(self.store, [self.clips], licence="CC0",
                                       progress=lambda *at: self.progress.append(at))
        for name, picture in (("fall.png", still.picture), ("fall_matte.png", still.alpha)):
            with freshet.VideoWriter(self.folder / name, SIZE, frames=1) as writer:
                writer.write(picture)
        self.picture = freshet.read_picture(self.folder / "fall.png").bgr
        self.matte = freshet.read_matte(self.folder / "fall_matte.png", SIZE).alpha

    @staticmethod
    def get():
        Scene.made = Scene.made or Scene()
        return Scene.made


def program(*arguments):
    return subprocess.run([FRESHET, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def search(scene, **options):
    options = {"class_name": "fall", "frames": 8, **options}
    return freshet.search(freshet.Store(scene.store), scene.picture, scene.matte, **options)
