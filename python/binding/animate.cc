#include "freshet/animate.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

constexpr const char* kOptions = R"(
loop            The last frame runs into the first without a seam.
speed           0.05 to 20: 1 as filmed, 0.5 slow motion; None: at the pace.
pace            slow, natural, fast: as the kind of fluid goes; auto: half-way from as filmed to natural, or as
                filmed where speeds are asked.
retiming_map    (height, width, 3), uint8, times that: black 0.5, mid-grey 1, white 2; None: the same everywhere.
moving_outline  The fluid carries its outline along, with softer rims.
background      (height, width, 3): what lies behind a moving outline; None: guessed.
deep            Picture.deep of the picture that was searched with: frames are then of its type.
memory_bytes    That frames in the making may take.
progress        Called with (stage, done, of).)";

AnimateOptions options_of(bool loop, std::optional<double> speed, const std::string& pace,
                          const cv::Mat& retiming_map, bool moving_outline, const cv::Mat& background,
                          const cv::Mat& deep, std::size_t memory_bytes) {
  return {.loop = loop,
          .speed = speed,
          .pace = pace,
          .retiming_map = retiming_map,
          .moving_outline = moving_outline,
          .background = background,
          .deep = deep,
          .memory_bytes = memory_bytes};
}

}  // namespace

void bind_animate(py::module_& module) {
  static const AnimateOptions kDefault;
  const std::string text = kOptions;
  py::class_<AnimateReport>(module, "AnimateReport", "What an animation took.")
      .def_readonly("frames", &AnimateReport::frames)
      .def_readonly("clips", &AnimateReport::clips)
      .def_readonly("pieces", &AnimateReport::pieces)
      .def_readonly("seconds", &AnimateReport::seconds, "Wall clock.");
  module.def(
      "animate",
      [](const Labelling& labelling, bool loop, std::optional<double> speed, const std::string& pace,
         const cv::Mat& retiming_map, bool moving_outline, const cv::Mat& background, const cv::Mat& deep,
         std::size_t memory_bytes, const py::object& progress) {
        const AnimateOptions options =
            options_of(loop, speed, pace, retiming_map, moving_outline, background, deep, memory_bytes);
        return std::make_unique<Frames>(
            [labelling, options](const Frames::Sink& sink, const Job& job) {
              freshet::animate(labelling, sink, options, job);
            },
            progress);
      },
      "labelling"_a, py::kw_only(), "loop"_a = kDefault.loop, "speed"_a = py::none(),
      "pace"_a = kDefault.pace, "retiming_map"_a = py::none(), "moving_outline"_a = kDefault.moving_outline,
      "background"_a = py::none(), "deep"_a = py::none(), "memory_bytes"_a = kDefault.memory_bytes,
      "progress"_a = py::none(),
      ("Frames of the picture animated: (height, width, 3), uint8 BGR, as many as the search was for.\n\n"
       "Where the matte is 0, a frame is the picture, to the bit.\n" +
       text)
          .c_str());
  module.def(
      "write_animation",
      [](const Labelling& labelling, const std::filesystem::path& path, bool loop,
         std::optional<double> speed, const std::string& pace, const cv::Mat& retiming_map,
         bool moving_outline, const cv::Mat& background, const cv::Mat& deep, std::size_t memory_bytes,
         const py::object& progress) {
        const AnimateOptions options =
            options_of(loop, speed, pace, retiming_map, moving_outline, background, deep, memory_bytes);
        return run_for(progress,
                       [&](const Job& job) { return freshet::animate(labelling, path, options, job); });
      },
      "labelling"_a, "path"_a, py::kw_only(), "loop"_a = kDefault.loop, "speed"_a = py::none(),
      "pace"_a = kDefault.pace, "retiming_map"_a = py::none(), "moving_outline"_a = kDefault.moving_outline,
      "background"_a = py::none(), "deep"_a = py::none(), "memory_bytes"_a = kDefault.memory_bytes,
      "progress"_a = py::none(),
      ("The same into a file, as VideoWriter makes it; none is left where this raises.\n" + text).c_str());
}

}  // namespace freshet::python
