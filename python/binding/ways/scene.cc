#include "freshet/ways/scene.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_scene(py::module_& module) {
  static const SceneOptions kDefault;
  py::class_<SceneFilm>(module, "SceneFilm", "An iterator of frames. Same files, same bytes.")
      .def_property_readonly("size", &SceneFilm::size, "(width, height), px.")
      .def_property_readonly("fps", &SceneFilm::fps, "Frames per second.")
      .def_property_readonly("layers", &SceneFilm::layers, "list[str]: names, nearest first.")
      .def_property_readonly("notices", &SceneFilm::notices, "What was guessed or left out, for a person.")
      .def("layer", &SceneFilm::layer, "i"_a, Unlocked(),
           "One layer of the frame that was given last, alone: (height, width, 4), float32: sRGB code times "
           "alpha, "
           "and alpha, 0 to 1.")
      .def("__len__", &SceneFilm::frames)
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](SceneFilm& film) {
        cv::Mat frame;
        if (!run_for(py::none(), [&](const Job&) { return film.next(frame); })) throw py::stop_iteration();
        return frame;
      });
  module.def(
      "scene",
      [](const std::filesystem::path& scene, bool as_printed, bool light, const py::object& progress) {
        return run_for(progress, [&](const Job& job) {
          return std::make_unique<SceneFilm>(scene, SceneOptions{.as_printed = as_printed, .light = light},
                                             job);
        });
      },
      "scene"_a, py::kw_only(), "as_printed"_a = kDefault.as_printed, "light"_a = kDefault.light,
      "progress"_a = py::none(),
      R"(A picture's layers, all moved by one wind (Chuang et al. 2005): SceneFilm, an iterator of frames,
(height, width, 3), uint8 BGR.

scene       A scene file (.toml); `freshet synth scene --keys` explains it. Layers that give options to the program are
            refused.
as_printed  The method as its paper prints it, whole.
light       Frames are (height, width, 4), float32: sRGB code times alpha, and alpha, 0 to 1.
progress    Called with (stage, done, of).)");
}

}  // namespace freshet::python
