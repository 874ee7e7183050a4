#include "freshet/ways/simulate.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_simulate(py::module_& module) {
  py::class_<SimulatedFrame>(module, "SimulatedFrame", "One frame of a simulation.")
      .def_readonly("picture", &SimulatedFrame::picture, "(height, width, 3), uint8 BGR.")
      .def_readonly("alpha", &SimulatedFrame::alpha,
                    "(height, width), uint8: how much the fluid covers, straight.")
      .def_readonly("motion", &SimulatedFrame::motion,
                    "(height, width, 2), float32: px to the next frame, x right, y down.")
      .def_readonly("emitters", &SimulatedFrame::emitters,
                    "(height, width), uint8: 255 where a design's emitters hold fluid.");
  py::class_<Simulation>(module, "Simulation", "An iterator of SimulatedFrame. Same options, same bytes.")
      .def_property_readonly("size", &Simulation::size, "(width, height), px.")
      .def_property_readonly("fps", &Simulation::fps, "Frames per second.")
      .def("__len__", &Simulation::frames)
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](Simulation& simulation) {
        SimulatedFrame frame;
        if (!run_for(py::none(), [&](const Job&) { return simulation.next(frame); }))
          throw py::stop_iteration();
        return frame;
      });
  module.def("simulation_presets", &simulation_presets, "list[str]: scenes for simulate(), designs first.");
  module.def(
      "simulate",
      [](const std::string& scene, std::optional<cv::Size> size, std::optional<int> frames,
         std::optional<double> fps, std::optional<std::uint64_t> seed) {
        return std::make_unique<Simulation>(
            SimulationOptions{.scene = scene, .size = size, .frames = frames, .fps = fps, .seed = seed});
      },
      "scene"_a = SimulationOptions{}.scene, py::kw_only(), "size"_a = py::none(), "frames"_a = py::none(),
      "fps"_a = py::none(), "seed"_a = py::none(), Unlocked(),
      R"(A fluid's designed motion, or a rendered clip of one: Simulation.

scene   One of simulation_presets(), or the path of a scene file (.toml).
size    (width, height), px, 16 to 4096 each way; None, here and below: the scene's.
frames  At least 1.    fps  1 to 240.    seed  Another seed, another scene of the same kind.)");
}

}  // namespace freshet::python
