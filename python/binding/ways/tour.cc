#include "freshet/ways/tour.h"

#include "python/binding/calls.h"

namespace freshet::python {

void bind_tour(py::module_& module) {
  py::class_<TourFrame>(module, "TourFrame", "One frame of a tour.")
      .def_readonly("picture", &TourFrame::picture, "(height, width, 3), uint8 BGR.")
      .def_readonly(
          "depth", &TourFrame::depth,
          "(height, width), float32: along the camera's axis, in heights of the picture's camera above the "
          "floor; 1e10 is the sky.");
  py::class_<Tour>(module, "Tour", "An iterator of TourFrame. Same film and options, same bytes.")
      .def_property_readonly("size", &Tour::size, "(width, height), px.")
      .def_property_readonly("fps", &Tour::fps, "Frames per second.")
      .def_property_readonly("notices", &Tour::notices, "What was narrowed or guessed, for a person.")
      .def("__len__", &Tour::frames)
      .def("__iter__", [](py::object self) { return self; })
      .def("__next__", [](Tour& tour) {
        TourFrame frame;
        if (!run_for(py::none(), [&](const Job&) { return tour.next(frame); })) throw py::stop_iteration();
        return frame;
      });
  module.def("tour_moves", &tour_moves, "list[str]: paths for tour() that need no file.");
  module.def(
      "tour",
      [](const std::filesystem::path& film, const std::optional<std::filesystem::path>& plan,
         const std::string& move, std::optional<double> amount, std::optional<double> horizon, int frames,
         double fps, cv::Size size, const std::string& film_end) {
        return run_for(py::none(), [&](const Job& job) {
          return std::make_unique<Tour>(film,
                                        TourOptions{.plan = plan.value_or(std::filesystem::path()),
                                                    .move = move,
                                                    .amount = amount,
                                                    .horizon = horizon,
                                                    .frames = frames,
                                                    .fps = fps,
                                                    .size = size,
                                                    .film_end = film_end},
                                        job);
        });
      },
      "film"_a, "plan"_a = py::none(), py::kw_only(), "move"_a = "", "amount"_a = py::none(),
      "horizon"_a = py::none(), "frames"_a = 0, "fps"_a = 0.0, "size"_a = cv::Size(), "film_end"_a = "repeat",
      R"(A camera that goes through a film or a picture: Tour.

film      A video, a folder or a pattern of pictures, or one picture.
plan      A tour file (docs/tour.md): planes, things, path; None: the middle row is the horizon.
move      One of tour_moves(); "": the plan's, or "in".    amount  How far it goes.
horizon   Its row, px from above; None: the plan's, or the middle.
frames    0: the path's, or the film's, or 4 s.    fps  0: the film's.    size  (width, height), px; (0, 0): the film's.
film_end  Where the film is shorter: "repeat", "ping-pong" or "hold".)");
}

}  // namespace freshet::python
