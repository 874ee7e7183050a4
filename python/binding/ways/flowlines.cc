#include "freshet/ways/flowlines.h"

#include "python/binding/calls.h"

namespace freshet::python {
namespace {

cv::Mat points_of(const FlowLine& line) {
  cv::Mat points(static_cast<int>(line.points.size()), 2, CV_32F);
  for (int i = 0; i < points.rows; ++i) {
    points.at<float>(i, 0) = line.points[static_cast<std::size_t>(i)].x;
    points.at<float>(i, 1) = line.points[static_cast<std::size_t>(i)].y;
  }
  return points;
}

}  // namespace

void bind_flowlines(py::module_& module) {
  static const FlowLinesOptions kDefault;
  py::class_<FlowLine>(module, "FlowLine", "A line that particles of a fluid ride.")
      .def_readonly("name", &FlowLine::name)
      .def_property_readonly(
          "points", &points_of,
          "(points, 2), float32: px, x right, y down; (0, 0) is the middle of the first pixel.");
  py::class_<FlowLinesFrame>(module, "FlowLinesFrame", "One frame along flow lines.")
      .def_readonly("picture", &FlowLinesFrame::picture, "(height, width, 3), uint8 BGR.")
      .def_readonly("fluid", &FlowLinesFrame::fluid,
                    "(height, width), float32: what of it is fluid, 0 to 1.");
  py::class_<FlowLines>(module, "FlowLines",
                        "An iterator of FlowLinesFrame. Same clip and options, same bytes.")
      .def_property_readonly("size", &FlowLines::size, "(width, height), px.")
      .def_property_readonly("fps", &FlowLines::fps, "Frames per second.")
      .def_property_readonly("lines", &FlowLines::lines, "list[FlowLine], given or found.")
      .def_property_readonly("notices", &FlowLines::notices, "What was left out or cut, for a person.")
      .def("write_lines", &FlowLines::write_lines, "svg"_a, "As SVG, to be edited and given again.")
      .def("__len__", &FlowLines::frames)
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](FlowLines& film) {
        FlowLinesFrame frame;
        if (!run_for(py::none(), [&](const Job&) { return film.next(frame); })) throw py::stop_iteration();
        return frame;
      });
  module.def(
      "flowlines",
      [](const std::filesystem::path& clip, const std::optional<Store>& store, int frames, double fps,
         bool loop, int from, int input_frames, std::size_t memory_bytes, bool moving_camera,
         const std::optional<std::filesystem::path>& lines, const std::optional<std::filesystem::path>& matte,
         double spacing_px, double patch_px, const std::string& dynamics, int entries, bool in_turn,
         double strand_px, const std::string& blend, std::uint64_t seed,
         const std::optional<std::filesystem::path>& edited, const std::string& correspondence,
         double join_px, const std::string& ground, const std::optional<std::filesystem::path>& background,
         bool on_background, const py::object& progress) {
        const std::filesystem::path none;
        const FlowLinesOptions options{.frames = frames,
                                       .fps = fps,
                                       .loop = loop,
                                       .from = from,
                                       .input_frames = input_frames,
                                       .memory_bytes = memory_bytes,
                                       .moving_camera = moving_camera,
                                       .lines = lines.value_or(none),
                                       .matte = matte.value_or(none),
                                       .spacing_px = spacing_px,
                                       .patch_px = patch_px,
                                       .dynamics = dynamics,
                                       .entries = entries,
                                       .in_turn = in_turn,
                                       .strand_px = strand_px,
                                       .blend = blend,
                                       .seed = seed,
                                       .edited = edited.value_or(none),
                                       .correspondence = correspondence,
                                       .join_px = join_px,
                                       .ground = ground,
                                       .background = background.value_or(none),
                                       .on_background = on_background};
        return run_for(progress, [&](const Job& job) {
          return store ? std::make_unique<FlowLines>(*store, clip.string(), options, job)
                       : std::make_unique<FlowLines>(clip, options, job);
        });
      },
      "clip"_a, "store"_a = py::none(), py::kw_only(), "frames"_a = kDefault.frames, "fps"_a = kDefault.fps,
      "loop"_a = kDefault.loop, "from_"_a = kDefault.from, "input_frames"_a = kDefault.input_frames,
      "memory_bytes"_a = kDefault.memory_bytes, "moving_camera"_a = kDefault.moving_camera,
      "lines"_a = py::none(), "matte"_a = py::none(), "spacing_px"_a = kDefault.spacing_px,
      "patch_px"_a = kDefault.patch_px, "dynamics"_a = kDefault.dynamics, "entries"_a = kDefault.entries,
      "in_turn"_a = kDefault.in_turn, "strand_px"_a = kDefault.strand_px, "blend"_a = kDefault.blend,
      "seed"_a = kDefault.seed, "edited"_a = py::none(), "correspondence"_a = kDefault.correspondence,
      "join_px"_a = kDefault.join_px, "ground"_a = kDefault.ground, "background"_a = py::none(),
      "on_background"_a = kDefault.on_background, "progress"_a = py::none(),
      R"(A short clip of a fluid, extended to any length or led along new lines (Bhat et al. 2004): FlowLines.

clip            A video, a folder or a pattern of pictures; with a store, the name of one of its clips.
frames          That are made. fps  0: the clip's. loop  The last frame runs into the first.
from_           First frame of the clip that is used. input_frames  How many, at least 16; 0: all that fit.
memory_bytes    For the clip's frames. moving_camera  A clip whose camera moves is taken.
lines           SVG over the clip, in the direction of the flow; None: found. matte  Where, a grey picture.
spacing_px      Between lines that are found. patch_px  Side of a particle's texture. 0, of both: by the size.
dynamics        auto, stationary or non-stationary.
entries         Frames whose particles repeat; 0: chosen. in_turn  In their order, as printed.
strand_px       Width of strands that repeat by themselves; 0: none; below 0: 3 patches.
blend           cut, feather (as printed) or contrast.
edited          SVG of new paths, with the ids of the lines whose texture they show.
correspondence  equal or stretched. join_px  Farthest apart that edited lines are joined; 0: as their input lines.
ground          black (fire) or white (smoke): what makes edited fluid transparent; none.
background      Picture of what lies behind removed fluid; None: guessed. on_background  Fluid over it alone.
progress        Called with (stage, done, of).)");
}

}  // namespace freshet::python
