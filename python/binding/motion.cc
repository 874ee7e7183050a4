#include <array>
#include <optional>

#include "freshet/motion.h"

#include "python/binding/binding.h"

namespace freshet::python {

void bind_motion(py::module_& module) {
  py::class_<MotionGuide>(module, "MotionGuide", "Where and how fast the fluid is to go, pixel by pixel.")
      .def(py::init([](const cv::Mat& direction, const cv::Mat& speed, double tolerance_deg,
                       double speed_ratio, double min_speed,
                       const std::optional<std::array<float, 4>>& horizon) {
             MotionGuide guide{direction, speed, tolerance_deg, speed_ratio, min_speed};
             if (horizon) guide.horizon = {{(*horizon)[0], (*horizon)[1]}, {(*horizon)[2], (*horizon)[3]}};
             return guide;
           }),
           py::kw_only(), "direction"_a = py::none(), "speed"_a = py::none(),
           "tolerance_deg"_a = MotionGuide{}.tolerance_deg, "speed_ratio"_a = MotionGuide{}.speed_ratio,
           "min_speed_px_per_s"_a = MotionGuide{}.min_speed_px_per_s, "horizon"_a = py::none())
      .def_readonly(
          "direction", &MotionGuide::direction,
          "(height, width, 2), float32: unit vectors, x right, y down; (0, 0): not asked. Or empty.")
      .def_readonly("speed", &MotionGuide::speed,
                    "(height, width), float32, px/s; negative: not asked. Or empty.")
      .def_readonly("tolerance_deg", &MotionGuide::tolerance_deg, "Degrees to either side, 0 to 180.")
      .def_readonly("speed_ratio", &MotionGuide::speed_ratio,
                    "From asked / ratio to asked * ratio; at least 1.")
      .def_readonly("min_speed_px_per_s", &MotionGuide::min_speed_px_per_s,
                    "Slower patches have no direction that counts.")
      .def_property_readonly(
          "horizon",
          [](const MotionGuide& guide) -> std::optional<std::array<float, 4>> {
            if (!guide.horizon) return std::nullopt;
            return std::array{guide.horizon->from.x, guide.horizon->from.y, guide.horizon->to.x,
                              guide.horizon->to.y};
          },
          "(x, y, x, y), px, from left to right: where a plane of water ends, towards which it goes slower. "
          "Or None.");
  module.def(
      "read_strokes",
      [](const std::filesystem::path& path, cv::Size size) { return read_strokes(path, size); }, "path"_a,
      "size"_a, "The guide that lines drawn over a picture make: SVG or JSON. size: (width, height), px.",
      Unlocked());
}

}  // namespace freshet::python
