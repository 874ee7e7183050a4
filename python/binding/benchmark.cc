#include "freshet/benchmark.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

using Asked = std::tuple<std::string, cv::Mat, cv::Mat>;

std::vector<BenchmarkPicture> pictures_of(const std::vector<Asked>& pictures) {
  std::vector<BenchmarkPicture> asked;
  for (const auto& [name, bgr, matte] : pictures) asked.push_back({name, bgr, matte});
  return asked;
}

// Borrowed by both sides: an index may keep the patches, so it is given an array that owns them.
OwnIndex index_of(const py::object& index) {
  const std::string name = py::hasattr(index, "name") ? index.attr("name").cast<std::string>()
                                                      : index.get_type().attr("__name__").cast<std::string>();
  return {.name = name,
          .build =
              [&index](const cv::Mat& patches) {
                const py::gil_scoped_acquire locked;
                index.attr("build")(array_of(patches));
              },
          .search =
              [&index](const cv::Mat& questions, int k) {
                const py::gil_scoped_acquire locked;
                const py::object found = py::module_::import("numpy").attr("ascontiguousarray")(
                    index.attr("search")(array_of(questions), k), "int32");
                return found.cast<cv::Mat>();
              }};
}

}  // namespace

void bind_benchmark(py::module_& module) {
  static const BenchmarkOptions kDefault;
  module.def(
      "_benchmark",
      [](const Store& store, const py::object& index, const std::vector<Asked>& pictures, std::size_t pieces,
         std::size_t rows, double build_limit_s, double setting_limit_s, bool label, bool filters,
         const py::object& progress) {
        const std::vector<BenchmarkPicture> asked = pictures_of(pictures);
        const BenchmarkOptions options{.pieces = pieces,
                                       .rows = rows,
                                       .build_limit_s = build_limit_s,
                                       .setting_limit_s = setting_limit_s,
                                       .label = label,
                                       .filters = filters};
        const OwnIndex own = index_of(index);
        return run_for(progress,
                       [&](const Job& job) { return freshet::benchmark(store, own, asked, options, job); });
      },
      "store"_a, "index"_a, "pictures"_a, py::kw_only(), "pieces"_a = kDefault.pieces,
      "rows"_a = kDefault.rows, "build_limit_s"_a = kDefault.build_limit_s,
      "setting_limit_s"_a = kDefault.setting_limit_s, "label"_a = kDefault.label,
      "filters"_a = kDefault.filters, "progress"_a = py::none());
  py::class_<SearchProblem>(module, "SearchProblem",
                            "The benchmark's questions as data, with their true answers.")
      .def(py::init([](const cv::Mat& patches, const cv::Mat& questions, const cv::Mat& neighbours,
                       const cv::Mat& distances) {
             return SearchProblem{patches, questions, neighbours, distances};
           }),
           "patches"_a, "questions"_a, "neighbours"_a, "distances"_a)
      .def_readonly("patches", &SearchProblem::patches,
                    "(N, bins), uint8: spatial pyramids; near is a small L1.")
      .def_readonly("questions", &SearchProblem::questions, "(Q, bins), uint8.")
      .def_readonly("neighbours", &SearchProblem::neighbours,
                    "(Q, k), int32: rows of patches, nearest first.")
      .def_readonly("distances", &SearchProblem::distances, "(Q, k), float32: L1.");
  module.def(
      "search_problem",
      [](const Store& store, int k, const std::vector<Asked>& pictures, std::size_t pieces,
         std::size_t rows) {
        const std::vector<BenchmarkPicture> asked = pictures_of(pictures);
        return run_for(py::none(), [&](const Job&) {
          return search_problem(store, k, asked, {.pieces = pieces, .rows = rows});
        });
      },
      "store"_a, "k"_a = 100, "pictures"_a = py::list(), py::kw_only(), "pieces"_a = kDefault.pieces,
      "rows"_a = kDefault.rows,
      R"(SearchProblem of a store, for other programs: what benchmark() asks.

pictures  list of (name, bgr, matte or None); empty: one clip's average image, without that clip's patches.
pieces    Asked, at most.    rows  Patches searched among; 0: all.)");
  module.def("recall", &recall, "problem"_a, "found"_a, "k"_a,
             "Fraction of the k nearest that answers (Q, k), int32, hold, mean; as near as the k-th counts.",
             Unlocked());
}

}  // namespace freshet::python
