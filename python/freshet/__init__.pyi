"""Types of the module freshet; docstrings are those of the module itself."""
from os import PathLike
from typing import Any, Callable, Iterator, Optional, Protocol, Sequence, Tuple, Union

import numpy
from numpy.typing import NDArray

__version__: str

_Array = NDArray[Any]
_U8 = NDArray[numpy.uint8]
_I32 = NDArray[numpy.int32]
_F32 = NDArray[numpy.float32]
_Path = Union[str, "PathLike[str]"]
_Size = Tuple[int, int]
_Line = Tuple[float, float, float, float]
_Progress = Optional[Callable[[str, int, int], Any]]
_BenchmarkPicture = Tuple[str, _U8, Optional[_U8]]

class Error(RuntimeError):
    kind: str

class Clip:
    name: str
    class_name: str
    licence: str
    width: int
    height: int
    frames: int
    fps: float
    patches: int

class PatchVariant:
    scale: float
    rotation_deg: float
    flip: bool

class Store:
    path: PathLike[str]
    clips: list[Clip]
    first_patches: NDArray[numpy.int64]
    variants: list[PatchVariant]
    def __init__(self, path: _Path) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, clip: str) -> Footage: ...
    def digest(self) -> str: ...
    def verify(self) -> list[str]: ...

class Footage:
    clip: Clip
    pixel_format: str
    flow_step: int
    columns: list[str]
    cell_maps: list[str]
    def __init__(self, store: Store, clip: str) -> None: ...
    def planes(self, first: int = 0, count: Optional[int] = None) -> list[_Array]: ...
    def bgr(self, first: int = 0, count: Optional[int] = None) -> _U8: ...
    def luma(self, first: int = 0, count: Optional[int] = None) -> _U8: ...
    def flow(self, first: int = 0, count: Optional[int] = None) -> _F32: ...
    def average(self) -> _U8: ...
    def column(self, name: str) -> _Array: ...
    def cells(self, name: str) -> _F32: ...

class Picture:
    bgr: _U8
    deep: _Array
    notices: list[str]

class Matte:
    alpha: _U8
    notices: list[str]

def read_picture(path: _Path) -> Picture: ...
def read_matte(path: _Path, size: _Size) -> Matte: ...

class VideoWriter:
    def __init__(self, path: _Path, size: _Size, *, frames: int = 96, fps: float = 25) -> None: ...
    def write(self, frame: _Array) -> None: ...
    def finish(self) -> None: ...
    def __enter__(self) -> VideoWriter: ...
    def __exit__(self, type: Any, value: Any, traceback: Any) -> None: ...

class MotionGuide:
    direction: _F32
    speed: _F32
    tolerance_deg: float
    speed_ratio: float
    min_speed_px_per_s: float
    horizon: Optional[_Line]
    def __init__(self, *, direction: Optional[_F32] = None, speed: Optional[_F32] = None, tolerance_deg: float = 30,
                 speed_ratio: float = 1.5, min_speed_px_per_s: float = 2.5,
                 horizon: Optional[_Line] = None) -> None: ...

def read_strokes(path: _Path, size: _Size, horizon: Optional[_Line] = None) -> MotionGuide: ...
def find_horizon(picture: _U8, matte: _U8, class_name: str = "") -> Optional[_Line]: ...

class Candidate:
    clip: str
    score: float

class PatchTable:
    patches: _I32
    scores: _F32

class Search:
    areas: NDArray[numpy.float64]
    table: PatchTable
    notices: list[str]
    def __len__(self) -> int: ...
    def candidates(self, piece: int) -> list[Candidate]: ...

def search(store: Store, picture: _U8, matte: Optional[_U8] = None, *, class_name: str = "",
           direction_deg: Optional[float] = None, narrow: bool = False, direction_tolerance_deg: float = 30,
           guide: Optional[MotionGuide] = None, horizon: bool = True, guess: bool = True,
           candidates: int = 100, piece_scale: Optional[float] = None, frames: int = 96, fps: float = 25,
           excluded_clips: Sequence[str] = ..., held: Optional[_U8] = None, progress: _Progress = None) -> Search: ...
def search_many(store: Store, pictures: Sequence[_U8], **options: Any) -> list[Search]: ...
def nearest_by_words(store: Store, words: _U8, k: int = 100) -> PatchTable: ...
def nearest_by_histograms(store: Store, histograms: _U8, k: int = 100) -> PatchTable: ...
def histograms_of(store: Store, words: _U8) -> _U8: ...

class UsedClip:
    name: str
    class_name: str
    licence: str
    pieces: int

class Labelling:
    search: Search
    patches: _I32
    clips: list[UsedClip]
    energy: float
    gap: float
    def __len__(self) -> int: ...
    def chosen(self, piece: int) -> Candidate: ...
    def write(self, path: _Path) -> None: ...

def label(search: Search, *, lambda_: float = 0.01, max_iterations: int = 100,
          progress: _Progress = None) -> Labelling: ...

class Frames(Iterator[_Array]):
    def __next__(self) -> _Array: ...
    def __enter__(self) -> Frames: ...
    def __exit__(self, *args: Any) -> None: ...
    def close(self) -> None: ...

class AnimateReport:
    frames: int
    clips: int
    pieces: int
    seconds: float

def animate(labelling: Labelling, *, loop: bool = False, speed: Optional[float] = None, pace: str = "auto",
            retiming_map: Optional[_U8] = None, moving_outline: bool = False, background: Optional[_Array] = None, deep: Optional[_Array] = None,
            memory_bytes: int = ..., progress: _Progress = None) -> Frames: ...
def write_animation(labelling: Labelling, path: _Path, *, loop: bool = False, speed: Optional[float] = None,
                    pace: str = "auto", retiming_map: Optional[_U8] = None, moving_outline: bool = False,
                    background: Optional[_Array] = None, deep: Optional[_Array] = None, memory_bytes: int = ...,
                    progress: _Progress = None) -> AnimateReport: ...

class IngestedClip:
    name: str
    outcome: str
    reasons: list[str]
    frames: int
    patches: int

def ingest(store: _Path, paths: Sequence[_Path], *, class_name: str = "", licence: str = "", force: bool = False,
           progress: _Progress = None) -> list[IngestedClip]: ...

class SimulatedFrame:
    picture: _U8
    alpha: _U8
    motion: _F32
    emitters: _U8

class Simulation(Iterator[SimulatedFrame]):
    size: _Size
    fps: float
    def __len__(self) -> int: ...
    def __next__(self) -> SimulatedFrame: ...

def simulation_presets() -> list[str]: ...
def simulate(scene: str = "plume", *, size: Optional[_Size] = None, frames: Optional[int] = None,
             fps: Optional[float] = None, seed: Optional[int] = None) -> Simulation: ...

class TourFrame:
    picture: _U8
    depth: _F32

class Tour(Iterator[TourFrame]):
    size: _Size
    fps: float
    notices: list[str]
    def __len__(self) -> int: ...
    def __next__(self) -> TourFrame: ...

def tour_moves() -> list[str]: ...
def tour(film: _Path, plan: Optional[_Path] = None, *, move: str = "", amount: Optional[float] = None,
         horizon: Optional[float] = None, frames: int = 0, fps: float = 0, size: _Size = (0, 0),
         film_end: str = "repeat") -> Tour: ...

class StillsRegion:
    name: str
    kind: str
    sequence: list[str]

class StillsFilm:
    size: _Size
    fps: float
    regions: list[StillsRegion]
    notices: list[str]
    def __len__(self) -> int: ...
    def __iter__(self) -> Frames: ...

def stills(folder: _Path, *, seconds: float = 8, fps: float = 25, loop: bool = False, preview: bool = False,
           camera: str = "auto", level: str = "auto", regions: Optional[_Path] = None,
           scribbles: Optional[_Path] = None, one_region: bool = False, split: int = 1, edits: Optional[_Path] = None,
           step_s: float = 0.5, speed: float = 1, sigma: float = 0.1, irregularity: float = 0.2, seed: int = 1,
           flow_side: int = 960, progress: _Progress = None) -> StillsFilm: ...

class SceneFilm(Iterator[_Array]):
    size: _Size
    fps: float
    layers: list[str]
    notices: list[str]
    def __len__(self) -> int: ...
    def __next__(self) -> _Array: ...
    def layer(self, i: int) -> _F32: ...

def scene(scene: _Path, *, as_printed: bool = False, light: bool = False, progress: _Progress = None) -> SceneFilm: ...

class FlowLine:
    name: str
    points: _F32

class FlowLinesFrame:
    picture: _U8
    fluid: _F32

class FlowLines(Iterator[FlowLinesFrame]):
    size: _Size
    fps: float
    lines: list[FlowLine]
    notices: list[str]
    def __len__(self) -> int: ...
    def __next__(self) -> FlowLinesFrame: ...
    def write_lines(self, svg: _Path) -> None: ...

def flowlines(clip: _Path, store: Optional[Store] = None, *, frames: int = 500, fps: float = 0, loop: bool = False,
              from_: int = 0, input_frames: int = 0, memory_bytes: int = ..., moving_camera: bool = False,
              lines: Optional[_Path] = None, matte: Optional[_Path] = None, spacing_px: float = 0, patch_px: float = 0,
              dynamics: str = "auto", entries: int = 0, in_turn: bool = False, strand_px: float = -1,
              blend: str = "cut", seed: int = 1, edited: Optional[_Path] = None, correspondence: str = "equal",
              join_px: float = 0, ground: str = "none", background: Optional[_Path] = None,
              on_background: bool = False, progress: _Progress = None) -> FlowLines: ...

def transfer(alpha: _Path, flow: _Path, exemplar: _Path, exemplar_alpha: Optional[_Path] = None, *, frames: int = 0,
             patch: int = 5, lambda_: float = 0.2, curvature: float = 0, divergence: float = 0, stabilise: bool = False,
             motion_blur: float = 0, seed: int = 1, progress: _Progress = None) -> Frames: ...

class SampledPatch:
    clip: str
    patch: int
    first: int

class Sampler:
    side: int
    def __init__(self, store: Store, seed: int = 1, *, frames: int = 96, class_name: str = "", colour: bool = True,
                 shard: Tuple[int, int] = (0, 1)) -> None: ...
    def __len__(self) -> int: ...
    def __getitem__(self, i: int) -> _U8: ...
    def at(self, i: int) -> SampledPatch: ...
    def read(self, first: int, count: int) -> _U8: ...

class OwnIndex(Protocol):
    def build(self, patches: _U8) -> Any: ...
    def search(self, questions: _U8, k: int) -> _Array: ...

def benchmark(store: Store, index: OwnIndex, pictures: Sequence[_BenchmarkPicture] = (), **options: Any) -> dict[str, Any]: ...

class SearchProblem:
    patches: _U8
    questions: _U8
    neighbours: _I32
    distances: _F32
    def __init__(self, patches: _U8, questions: _U8, neighbours: _I32, distances: _F32) -> None: ...

def search_problem(store: Store, k: int = 100, pictures: Sequence[_BenchmarkPicture] = ..., *, pieces: int = 200,
                   rows: int = 0) -> SearchProblem: ...
def recall(problem: SearchProblem, found: _I32, k: int) -> float: ...
