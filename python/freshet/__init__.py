"""A patch database engine for fluid video: stores, search, animation.

    import freshet
    store = freshet.Store("water.store")
    picture = freshet.read_picture("fall.png").bgr
    search = freshet.search(store, picture, class_name="water")
    for frame in freshet.animate(freshet.label(search)):
        ...  # (height, width, 3), uint8, BGR

Pictures are NumPy arrays, BGR. What is returned is read-only and owns its samples. Failures raise freshet.Error. Long
calls release the interpreter, heed Ctrl-C, and tell a `progress` callable of (stage, done, of).
"""
import json as _json

from . import _freshet
from ._freshet import (
    AnimateReport, Candidate, Clip, Error, FlowLine, FlowLines, FlowLinesFrame, Footage, Frames, IngestedClip,
    Labelling, Matte, MotionGuide, PatchTable, PatchVariant, Picture, SampledPatch, Sampler, SceneFilm, Search,
    SearchProblem, SimulatedFrame, Simulation, StillsFilm, StillsRegion, Store, Tour, TourFrame, UsedClip,
    VideoWriter, __version__, animate, find_horizon, flowlines, histograms_of, ingest, label, nearest_by_histograms,
    nearest_by_words, read_matte, read_picture, read_strokes, recall, scene, search, search_many, search_problem,
    simulate, simulation_presets, stills, tour, tour_moves, transfer, write_animation)


def benchmark(store, index, pictures=(), **options):
    """Measures an index of one's own beside Freshet's, as `freshet query bench` does: dict, as its --json has it.

    index     An object with `build(patches)` and `search(questions, k)`. patches is (N, bins), uint8; near is a small L1
              distance. search returns (questions, k) rows of patches, -1 for none. Its `name`, or its class's, names it.
    pictures  (name, bgr, matte or None) of each; none: one clip's average image, without that clip's patches.

    Options: pieces, rows (0: all), build_limit_s, setting_limit_s (s of one core), label, filters (whether labelling and
    searches under conditions are measured too), progress. docs/benchmark.md explains the figures.
    """
    return _json.loads(_freshet._benchmark(store, index, list(pictures), **options))


__all__ = [
    "AnimateReport", "Candidate", "Clip", "Error", "FlowLine", "FlowLines", "FlowLinesFrame", "Footage", "Frames",
    "IngestedClip", "Labelling", "Matte", "MotionGuide", "PatchTable", "PatchVariant", "Picture", "SampledPatch",
    "Sampler", "SceneFilm", "Search", "SearchProblem", "SimulatedFrame", "Simulation", "StillsFilm", "StillsRegion",
    "Store", "Tour", "TourFrame", "UsedClip", "VideoWriter", "animate", "benchmark", "find_horizon", "flowlines",
    "histograms_of", "ingest", "label", "nearest_by_histograms", "nearest_by_words", "read_matte", "read_picture",
    "read_strokes", "recall", "scene", "search", "search_many", "search_problem", "simulate", "simulation_presets",
    "stills", "tour", "tour_moves", "transfer", "write_animation"]
