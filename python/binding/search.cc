#include "freshet/search.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

py::array areas_of(const Search& search) {
  cv::Mat areas(static_cast<int>(search.pieces()), 4, CV_64F);
  for (int piece = 0; piece < areas.rows; ++piece) {
    const cv::Rect2d area = search.area(static_cast<std::size_t>(piece));
    auto* row = areas.ptr<double>(piece);
    row[0] = area.x, row[1] = area.y, row[2] = area.width, row[3] = area.height;
  }
  return array_of(areas);
}

void bind_results(py::module_& module) {
  py::class_<Candidate>(module, "Candidate", "A patch that looks like a piece.")
      .def_readonly("clip", &Candidate::clip, "Name of its clip.")
      .def_readonly("score", &Candidate::score, "Likeness, 0 to 1; above 0.2 is good.")
      .def("__repr__", [](const Candidate& candidate) {
        return py::str("<freshet.Candidate {} {:.3f}>").format(candidate.clip, candidate.score);
      });
  py::class_<PatchTable>(module, "PatchTable", "Patches for each of several questions, best first.")
      .def_readonly("patches", &PatchTable::patches,
                    "(questions, most found), int32: numbers through the store (Store.first_patches); -1 "
                    "where there are fewer.")
      .def_readonly("scores", &PatchTable::scores, "(questions, most found), float32: likeness, 0 to 1.");
  py::class_<Search>(module, "Search", "What a search found. Keeps its store open.")
      .def("__len__", &Search::pieces, "Number of pieces.")
      .def_property_readonly(
          "areas", &areas_of,
          "(pieces, 4), float64: x, y, width, height, px of the picture; may stand over its border.")
      .def_property_readonly("table", py::overload_cast<>(&Search::candidates, py::const_),
                             "PatchTable of all pieces.")
      .def(
          "candidates",
          [](const Search& search, std::size_t piece) {
            if (piece >= search.pieces()) throw py::index_error("no such piece");
            return search.candidates(piece);
          },
          "piece"_a, "list[Candidate] of one piece, best first.")
      .def_property_readonly(
          "notices", &Search::notices,
          "list[str]: what was guessed, which clips are too short, where candidates were few.");
}

}  // namespace

void bind_search(py::module_& module) {
  bind_results(module);
  static const SearchOptions kDefault;
  module.def(
      "search",
      [](const Store& store, const cv::Mat& picture, const cv::Mat& matte, const std::string& class_name,
         std::optional<double> direction_deg, bool narrow, double direction_tolerance_deg,
         const MotionGuide* guide, bool horizon, bool guess, int candidates,
         std::optional<double> piece_scale, int frames, double fps,
         const std::vector<std::string>& excluded_clips, const cv::Mat& held, const py::object& progress) {
        const SearchOptions options{.class_name = class_name,
                                    .direction_deg = direction_deg,
                                    .narrow = narrow,
                                    .direction_tolerance_deg = direction_tolerance_deg,
                                    .guide = guide ? *guide : MotionGuide{},
                                    .horizon = horizon,
                                    .guess = guess,
                                    .candidates = candidates,
                                    .piece_scale = piece_scale,
                                    .frames = frames,
                                    .fps = fps,
                                    .excluded_clips = excluded_clips,
                                    .held = held};
        return run_for(progress,
                       [&](const Job& job) { return freshet::search(store, picture, matte, options, job); });
      },
      "store"_a, "picture"_a, "matte"_a = py::none(), py::kw_only(), "class_name"_a = kDefault.class_name,
      "direction_deg"_a = py::none(), "narrow"_a = kDefault.narrow,
      "direction_tolerance_deg"_a = kDefault.direction_tolerance_deg, "guide"_a = py::none(),
      "horizon"_a = kDefault.horizon, "guess"_a = kDefault.guess, "candidates"_a = kDefault.candidates,
      "piece_scale"_a = py::none(), "frames"_a = kDefault.frames, "fps"_a = kDefault.fps,
      "excluded_clips"_a = kDefault.excluded_clips, "held"_a = py::none(), "progress"_a = py::none(),
      R"(Cuts a picture into pieces and finds the patches that look like each.

picture        (height, width, 3), uint8 BGR.
matte          (height, width), uint8, 255 where the fluid is; None: everywhere.
class_name     Only clips of this class; "any": of all; "": of the class that the picture looks most like, or, where the
               store has none of it, of all.
direction_deg  Where the fluid goes as seen: 0 right, 90 up, 180 left, 270 down; None: any, or guessed (guess).
narrow         Only patches that move so, within direction_tolerance_deg (degrees to either side), or the guide's.
guide          MotionGuide: where and how fast, pixel by pixel.
horizon        Whether find_horizon is asked where the guide has none.
candidates     Per piece, 1 to 10000.
piece_scale    What the picture's sides are divided by before it is cut, 1 to 16; None: near 1280 px.
frames, fps    Of the animation: shorter clips without a loop are left out. At least 1; 1 to 240.
held           (height, width), uint8, 255 where something stands before the fluid.
progress       Called with (stage, done, of).

The first search of a store opens its index (1.6 us and 620 bytes a patch), which others share.)");
  module.def(
      "search_many",
      [](const Store& store, const std::vector<cv::Mat>& pictures, const py::kwargs& options) {
        py::list found;
        const py::object search = py::module_::import("freshet._freshet").attr("search");
        for (const cv::Mat& picture : pictures) found.append(search(store, picture, **options));
        return found;
      },
      "store"_a, "pictures"_a,
      "list[Search]: search() of each of several pictures with the same options; the index is opened once.");
  module.def(
      "nearest_by_words",
      [](const Store& store, const cv::Mat& words, int k) {
        return run_for(py::none(), [&](const Job&) { return nearest_by_words(store, words, k); });
      },
      "store"_a, "words"_a, "k"_a = 100,
      "PatchTable for words of one's own: (questions, 81), uint8 or uint16, a grid of 9 x 9 (the column "
      "patch.words).");
  module.def(
      "nearest_by_histograms",
      [](const Store& store, const cv::Mat& histograms, int k) {
        return run_for(py::none(), [&](const Job&) { return nearest_by_histograms(store, histograms, k); });
      },
      "store"_a, "histograms"_a, "k"_a = 100,
      R"(PatchTable for histograms of one's own: (questions, bins), uint8, as histograms_of() gives them.

All patches are scanned: some 1 us a patch and question.)");
  module.def("histograms_of", &histograms_of, "store"_a, "words"_a,
             "(questions, bins), uint8: spatial pyramids of words, 21 cells of the store's words.",
             Unlocked());
}

}  // namespace freshet::python
