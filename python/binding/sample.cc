#include "freshet/sample.h"

#include <utility>

#include "python/binding/calls.h"

namespace freshet::python {

void bind_sample(py::module_& module) {
  py::class_<SampledPatch>(module, "SampledPatch", "Where a drawn video comes from.")
      .def_readonly("clip", &SampledPatch::clip, "Name of its clip.")
      .def_readonly("patch", &SampledPatch::patch, "Row of the clip's columns.")
      .def_readonly("first", &SampledPatch::first, "Its first frame.");
  static const SamplerOptions kDefault;
  py::class_<Sampler>(module, "Sampler",
                      R"(Videos of patches, drawn by chance: every patch once, each at a moment of its own.

Sampler(store, seed) has a length; sampler[i] is one video, (frames, side, side, 3), uint8 BGR, and read() many. The
same store, seed and number give the same video on any number of threads. Keeps its store open.

frames      Length of a video. Patches of shorter clips are left out.
class_name  Only clips of this class; "": all.
colour      Without it videos are luminance, (frames, side, side), and read about twice as fast.
shard       (i, n): part i, from 0, of n. Parts share nothing and are together what one would be.)")
      .def(py::init([](const Store& store, std::uint64_t seed, int frames, const std::string& class_name,
                       bool colour, std::pair<std::size_t, std::size_t> shard) {
             return Sampler(store, {.seed = seed,
                                    .frames = frames,
                                    .class_name = class_name,
                                    .colour = colour,
                                    .shard = shard.first,
                                    .shards = shard.second});
           }),
           "store"_a, "seed"_a = kDefault.seed, py::kw_only(), "frames"_a = kDefault.frames,
           "class_name"_a = kDefault.class_name, "colour"_a = kDefault.colour,
           "shard"_a = std::make_pair(kDefault.shard, kDefault.shards), Unlocked())
      .def_property_readonly("side", &Sampler::side, "px, of the square videos.")
      .def("__len__", &Sampler::size)
      .def("at", &Sampler::at, "i"_a, "SampledPatch: where a video comes from.")
      .def("__getitem__",
           [](const Sampler& sampler, std::size_t i) {
             if (i >= sampler.size()) throw py::index_error("no such video");
             const cv::Mat videos =
                 run_for(py::none(), [&](const Job& job) { return sampler.read(i, 1, job); });
             return py::reinterpret_steal<py::object>(PySequence_GetItem(array_of(videos).ptr(), 0));
           })
      .def(
          "read",
          [](const Sampler& sampler, std::size_t first, std::size_t count) {
            return run_for(py::none(), [&](const Job& job) { return sampler.read(first, count, job); });
          },
          "first"_a, "count"_a, "(count, frames, side, side, 3), uint8 BGR, or without the 3. All threads.");
}

}  // namespace freshet::python
