#include "freshet/motion.h"

#include "python/binding/binding.h"

namespace freshet::python {

void bind_motion(py::module_& module) {
  py::class_<MotionGuide>(module, "MotionGuide", "Where and how fast the fluid is to go, pixel by pixel.")
      .def(py::init([](const cv::Mat& direction, const cv::Mat& speed, double tolerance_deg,
                       double speed_ratio, double min_speed) {
             return MotionGuide{direction, speed, tolerance_deg, speed_ratio, min_speed};
           }),
           py::kw_only(), "direction"_a = py::none(), "speed"_a = py::none(),
           "tolerance_deg"_a = MotionGuide{}.tolerance_deg, "speed_ratio"_a = MotionGuide{}.speed_ratio,
           "min_speed_px_per_s"_a = MotionGuide{}.min_speed_px_per_s)
      .def_readonly(
          "direction", &MotionGuide::direction,
          "(height, width, 2), float32: unit vectors, x right, y down; (0, 0): not asked. Or empty.")
      .def_readonly("speed", &MotionGuide::speed,
                    "(height, width), float32, px/s; negative: not asked. Or empty.")
      .def_readonly("tolerance_deg", &MotionGuide::tolerance_deg, "Degrees to either side, 0 to 180.")
      .def_readonly("speed_ratio", &MotionGuide::speed_ratio,
                    "From asked / ratio to asked * ratio; at least 1.")
      .def_readonly("min_speed_px_per_s", &MotionGuide::min_speed_px_per_s,
                    "Slower patches have no direction that counts.");
  module.def(
      "read_strokes",
      [](const std::filesystem::path& path, cv::Size size) { return read_strokes(path, size); }, "path"_a,
      "size"_a, "The guide that lines drawn over a picture make: SVG or JSON. size: (width, height), px.",
      Unlocked());
}

}  // namespace freshet::python
