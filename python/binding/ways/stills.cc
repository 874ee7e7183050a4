#include "freshet/ways/stills.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_stills(py::module_& module) {
  static const StillsOptions kDefault;
  py::class_<StillsRegion>(module, "StillsRegion", "A part of the scene with an order of its own.")
      .def_readonly("name", &StillsRegion::name)
      .def_readonly("kind", &StillsRegion::kind, "independent or slow.")
      .def_readonly("sequence", &StillsRegion::sequence, "list[str]: file names, as they are shown.");
  py::class_<StillsFilm, std::shared_ptr<StillsFilm>>(
      module, "StillsFilm", "Stills ordered into a film; iterated, its frames, as often as wanted.")
      .def_property_readonly("size", &StillsFilm::size, "(width, height), px.")
      .def_property_readonly("fps", &StillsFilm::fps, "Frames per second.")
      .def_property_readonly("regions", &StillsFilm::regions, "list[StillsRegion].")
      .def_property_readonly("notices", &StillsFilm::notices, "What was left out, aligned, proposed.")
      .def("__len__", &StillsFilm::frames)
      .def("__iter__", [](const std::shared_ptr<StillsFilm>& film) {
        return std::make_unique<Frames>(
            [film](const Frames::Sink& sink, const Job& job) { film->render(sink, job); }, py::none());
      });
  module.def(
      "stills",
      [](const std::filesystem::path& folder, double seconds, double fps, bool loop, bool preview,
         const std::string& camera, const std::string& level,
         const std::optional<std::filesystem::path>& regions,
         const std::optional<std::filesystem::path>& scribbles, bool one_region, int split,
         const std::optional<std::filesystem::path>& edits, double step_s, double speed, double sigma,
         double irregularity, std::uint64_t seed, int flow_side, const py::object& progress) {
        const std::filesystem::path none;
        const StillsOptions options{.seconds = seconds,
                                    .fps = fps,
                                    .loop = loop,
                                    .preview = preview,
                                    .camera = camera,
                                    .level = level,
                                    .regions = regions.value_or(none),
                                    .scribbles = scribbles.value_or(none),
                                    .one_region = one_region,
                                    .split = split,
                                    .edits = edits.value_or(none),
                                    .step_s = step_s,
                                    .speed = speed,
                                    .sigma = sigma,
                                    .irregularity = irregularity,
                                    .seed = seed,
                                    .flow_side = flow_side};
        return run_for(progress,
                       [&](const Job& job) { return std::make_shared<StillsFilm>(folder, options, job); });
      },
      "folder"_a, py::kw_only(), "seconds"_a = kDefault.seconds, "fps"_a = kDefault.fps,
      "loop"_a = kDefault.loop, "preview"_a = kDefault.preview, "camera"_a = kDefault.camera,
      "level"_a = kDefault.level, "regions"_a = py::none(), "scribbles"_a = py::none(),
      "one_region"_a = kDefault.one_region, "split"_a = kDefault.split, "edits"_a = py::none(),
      "step_s"_a = kDefault.step_s, "speed"_a = kDefault.speed, "sigma"_a = kDefault.sigma,
      "irregularity"_a = kDefault.irregularity, "seed"_a = kDefault.seed, "flow_side"_a = kDefault.flow_side,
      "progress"_a = py::none(),
      R"(A moving scene from 2 to 200 stills of one size, in any order (Lin et al. 2007): StillsFilm, whose frames
are (height, width, 3) BGR, uint8, or uint16 where a still is.

folder        Of PNG, JPEG or TIFF files.
seconds       0.04 to 3600.    fps  1 to 240.    loop  The last frame runs into the first.
preview       480 px, 12.5 frames per second at most.
camera        auto: hand-held stills are aligned and cropped; tripod: unchanged; hand: aligned and levelled.
level         auto, on, off: exposure and white balance matched.
regions       An SVG over a still, or a picture of masks. scribbles  A picture: white or green moves, black or red
              stands. one_region  The whole picture. None of them: proposed.
split         1 to 8 parts of each region that follow their neighbours loosely.
edits         TOML; `freshet synth stills --keys` explains it.
step_s        Mean time between stills, s, 0.04 to 60.    speed  0.05 to 20.
sigma         Freedom to leave the paths.    irregularity  0 to 1, that motion turns within a path.
flow_side     px, 64 to 8192, at which flow is computed.
progress      Called with (stage, done, of).)");
}

}  // namespace freshet::python
